"""Faults planted all over the core are found by the tests that are there for them."""

import ast

import mutants
import pytest

MUTANTS = {mutant.id: mutant for mutant in mutants.listed()}


def test_the_list_is_one_of_different_mutants():
    assert len(MUTANTS) == len(mutants.listed()) >= 100
    assert len({(m.file, m.old, m.new) for m in MUTANTS.values()}) == len(MUTANTS)


@pytest.mark.parametrize("name", MUTANTS)
def test_a_mutant_can_be_made_and_its_tests_are_there(name):
    mutant = MUTANTS[name]
    ast.parse(mutants.broken(mutant))
    assert mutant.tests
    for test in mutant.tests:
        file, *function = test.partition("[")[0].split("::")
        tree = ast.parse((mutants.ROOT / file).read_text(encoding="utf-8"))
        named = {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)}
        assert set(function) <= named


def test_a_list_out_of_date_is_refused(tmp_path):
    mutant = mutants.Mutant("gone", "", "a.py", "1 < 2", "2 < 1", ("tests/test_mutants.py",))
    for text in ("", "1 < 2 and 1 < 2"):
        (tmp_path / "a.py").write_text(text)
        with pytest.raises(ValueError, match=r"gone: a\.py has '1 < 2' [02] times, not once"):
            mutants.broken(mutant, tmp_path)


def planted(old, new, test="tests/test_bounds.py::test_a_star_has_a_path_of_three"):
    return mutants.Mutant("planted", "", "lineup/bounds.py", old, new, (test,))


@pytest.mark.slow
def test_a_fault_is_caught_and_a_change_that_is_none_survives():
    faults = [
        planted("number) + 1)", "number))"),
        planted("number) + 1)", "number) + 2 - 1)"),
        planted("UNIT = grid.DIRECTIONS[:3]", "UNIT = nothing"),
    ]
    said = [verdict for _, verdict in mutants.verdicts(faults)]
    assert said == [mutants.CAUGHT, mutants.SURVIVED, mutants.NOT_RUN]


@pytest.mark.slow
def test_tests_that_fail_without_a_mutant_prove_nothing():
    with pytest.raises(ValueError, match="without a mutant its tests do not all pass"):
        list(mutants.verdicts([planted("number) + 1)", "number))", "tests/test_bounds.py::none")]))


@pytest.mark.slow
def test_every_mutant_is_caught():
    said = {mutant.id: verdict for mutant, verdict in mutants.verdicts(list(MUTANTS.values()))}
    assert set(said) == set(MUTANTS)
    assert not {name: verdict for name, verdict in said.items() if verdict != mutants.CAUGHT}
