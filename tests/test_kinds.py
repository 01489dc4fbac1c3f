"""An argument of the wrong kind is refused in one line that says what is needed."""

import numpy as np
import pytest
import trimesh

import lineup as lu

SOLID = lu.VoxelSolid(np.ones((2, 2, 1), bool))
PATH = lu.VoxelPath(np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]))
MOTION = lu.unfold(PATH, "peel")
FOLDING = lu.Folding(PATH, MOTION)
DESIGN = lu.Design((), (FOLDING,), (), lu.models())

OBJECTS = {
    "solid": SOLID,
    "path": PATH,
    "motion": MOTION,
    "folding": FOLDING,
    "graph": lu.reeb_graph(SOLID),
    "design": DESIGN,
    "mesh": trimesh.creation.box(),
    "array": np.ones((2, 2, 2)),
    "none": None,
    "number": 3,
    "function": len,
}

# What each takes one of the objects as, and those of them that it takes.
CALLS = {
    "VoxelSolid": (lu.VoxelSolid, ""),
    "VoxelPath": (lu.VoxelPath, ""),
    "Folding of a path": (lambda x: lu.Folding(x, MOTION), "path"),
    "Folding with a motion": (lambda x: lu.Folding(PATH, x), "motion"),
    "Obstacles": (lu.Obstacles, ""),
    "add": (lambda x: lu.add(x, SOLID), "design"),
    "algorithm3": (lu.algorithm3, "solid"),
    "audit": (lu.audit, "solid"),
    "audit_summary": (lu.audit_summary, ""),
    "audit_summary of one": (lambda x: lu.audit_summary([x]), "solid"),
    "certify": (lu.certify, "motion"),
    "certify beside": (lambda x: lu.certify(MOTION, obstacles=x), "none"),
    "certify_path": (lambda x: lu.certify_path(x, SOLID), "path"),
    "certify_path in": (lambda x: lu.certify_path(PATH, x), "solid"),
    "fold": (lambda x: lu.fold(x, rounds=1, trial_rounds=1), "solid"),
    "frames": (lu.frames, "motion"),
    "layered_path": (lu.layered_path, "solid"),
    "lineup": (lu.lineup, "array"),
    "load": (lu.load, ""),
    "mend": (lu.mend, "mesh"),
    "model": (lu.model, ""),
    "path_bound": (lu.path_bound, "solid"),
    "planar_path": (lambda x: lu.planar_path(x, (0, 0), (1, 1)), ""),
    "reeb_graph": (lu.reeb_graph, "solid"),
    "refine": (lambda x: lu.refine(x, 2), "solid"),
    "save": (lambda x: lu.save(x, "no/folder"), "solid path motion folding design"),
    "save as": (lambda x: lu.save(SOLID, x), ""),
    "through_tube": (lambda x: lu.through_tube(None, x, radius=1), "path folding"),
    "transform": (lambda x: lu.transform(x, FOLDING), "motion folding"),
    "transform to": (lambda x: lu.transform(MOTION, x), "motion folding"),
    "traverse": (lu.traverse, "graph"),
    "trim": (lu.trim, ""),
    "trim one": (lambda x: lu.trim([x]), "path folding"),
    "unfold": (lu.unfold, "path"),
    "voxelize": (lambda x: lu.voxelize(x, 8), "mesh"),
}


@pytest.mark.parametrize("name", CALLS)
def test_the_wrong_kind_of_object_is_refused_in_one_line(name):
    call, taken = CALLS[name]
    for kind, value in OBJECTS.items():
        if kind not in taken.split():
            with pytest.raises(ValueError, match=".") as refused:
                call(value)
            assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: lu.certify(FOLDING), "a Motion is needed, got Folding; folding.motion is one"),
        (lambda: lu.fold(np.ones((2, 2, 2), bool)), "got ndarray; lineup.VoxelSolid(occupancy) m"),
        (lambda: lu.unfold(SOLID), "a VoxelPath is needed, got VoxelSolid; lineup.layered_path(s"),
        (lambda: lu.traverse(SOLID), "a ReebGraph is needed, got VoxelSolid; lineup.reeb_graph("),
        (lambda: lu.trim([SOLID]), "a VoxelPath or Folding is needed, got VoxelSolid; lineup.lay"),
        (lambda: lu.trim(PATH), "items must be a list, got VoxelPath alone; put it in brackets"),
        (lambda: lu.lineup(SOLID), "models must be a list, got VoxelSolid alone; put it in br"),
        (lambda: lu.load(SOLID), "a file is named by a text or a path, got VoxelSolid"),
    ],
)
def test_the_refusal_says_how_to_come_by_what_is_needed(call, message):
    with pytest.raises(ValueError) as refused:  # noqa: PT011
        call()
    assert message in str(refused.value)
