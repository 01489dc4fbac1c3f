"""pyproject.toml, constraints.txt and environment.yml ask for the same things."""

import re
import tomllib
from pathlib import Path

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
CONDA_NAMES = {"matplotlib-base": "matplotlib", "igl": "libigl", "ortools-python": "ortools"}
PYPI_ONLY = {"ipctk", "manifold3d"}
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
CONDA = yaml.safe_load((ROOT / "environment.yml").read_text())
PIP_SECTION = next(d["pip"] for d in CONDA["dependencies"] if isinstance(d, dict))


def bounds(lines: list[str]) -> dict[str, str]:
    """Name -> version bounds of requirement lines, whatever the spacing."""
    requirements = [Requirement(line) for line in lines]
    return {canonicalize_name(r.name): str(r.specifier) for r in requirements}


def asked(*extras: str) -> dict[str, str]:
    """What pyproject.toml asks for, with the extras named."""
    lines = [*PROJECT["dependencies"]]
    for extra in extras:
        lines += PROJECT["optional-dependencies"][extra]
    return bounds(lines)


def pins() -> dict[str, str]:
    lines = (ROOT / "constraints.txt").read_text().splitlines()
    return dict(line.split("==") for line in lines if not line.startswith("#"))


def test_conda_asks_for_the_same_bounds():
    lines = [d for d in CONDA["dependencies"] if isinstance(d, str) and d != "pip"]
    conda = bounds(lines)
    python = conda.pop("python")
    conda = {CONDA_NAMES.get(name, name): bound for name, bound in conda.items()}
    from_pip = bounds([line for line in PIP_SECTION if not line.startswith("-")])
    assert set(from_pip) == PYPI_ONLY
    assert conda | from_pip == asked("notebooks", "exact")
    assert set(python.split(",")) == set(PROJECT["requires-python"].split(","))


def test_conda_uses_conda_forge_alone():
    assert CONDA["channels"] == ["conda-forge", "nodefaults"]


def test_every_requirement_is_pinned_within_its_bounds():
    pinned = pins()
    for name, bound in asked("notebooks", "exact", "site", "bench", "video", "test").items():
        assert Requirement(f"{name}{bound}").specifier.contains(pinned[name]), name


def test_constraints_are_pure_pins():
    lines = (ROOT / "constraints.txt").read_text().splitlines()
    bad = [x for x in lines if not re.fullmatch(r"#.*|[a-z0-9.-]+==[0-9][a-z0-9.]*", x)]
    assert not bad
    names = [x.split("==")[0] for x in lines if not x.startswith("#")]
    assert names == sorted(set(names))


@pytest.mark.parametrize("file", ["constraints.txt", "pyproject.toml", "environment.yml"])
def test_no_address_in_the_environment(file):
    assert "://" not in (ROOT / file).read_text()


def test_every_extra_but_the_largest_is_set_up_by_make():
    extras = re.search(r"^EXTRAS := (\S+)$", (ROOT / "Makefile").read_text(), flags=re.M)
    assert set(extras[1].split(",")) == set(PROJECT["optional-dependencies"]) - {"video"}
