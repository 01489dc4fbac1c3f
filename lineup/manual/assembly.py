"""A folding, laid out for a hand: where it lies, what is done in which order, in which steps."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..grid import IntArray
from ..joints import slot_violations
from ..solid import Folding
from ..words import JointWord, joint_word
from .actions import Action, actions_of
from .build import Build, best_build
from .steps import steps_of
from .turns import with_few_turns


@dataclass(frozen=True, eq=False)
class Assembly:
    """All that the files and the booklet of a manual say.

    Attributes
    ----------
    folding : Folding
        With its moves in the order that the manual keeps.
    word : JointWord
        Of its path.
    base : (int, int)
        The two joints that are put on the table first.
    actions : tuple of Action
        What follows, from the straight line to the whole body; action number k is
        ``actions[k - 1]``, and number 0 is the base.
    build : Build
    places : (P, 3) int32
        Column, row and layer of each joint on the base card, from 1.
    steps : tuple of range
        Indices of the actions of each step.
    """

    folding: Folding
    word: JointWord
    base: tuple[int, int]
    actions: tuple[Action, ...]
    build: Build
    places: IntArray
    steps: tuple[range, ...]

    @property
    def n_blocks(self) -> int:
        """Half as many as voxels."""
        return len(self.places) // 2

    @cached_property
    def number(self) -> IntArray:
        """Of the action that puts each joint in place, (P,) int32; 0 for the base."""
        number = np.zeros(len(self.places), np.int32)
        for k, action in enumerate(self.actions, start=1):
            if not action.swings:
                number[action.joint] = k
        return number

    @cached_property
    def twists(self) -> IntArray:
        """Numbers of the actions that would twist a piece in its slots, sorted (`joints`)."""
        twisting = slot_violations(self.folding.motion)[:, 0]
        before = [len(self.folding.motion), *(action.moves for action in self.actions)]
        # An action undoes the moves from the pose after it to the pose before it.
        undoes = [
            k
            for k, (action, moves) in enumerate(zip(self.actions, before, strict=False), start=1)
            if ((action.moves <= twisting) & (twisting < moves)).any()
        ]
        return np.array(undoes, np.int32)

    @property
    def joints(self) -> str:
        """Joints that the motion asks for: "slotted" if it twists no piece, or else "free"."""
        return "free" if len(self.twists) else "slotted"

    @cached_property
    def twisting(self) -> frozenset[Action]:
        """The actions themselves."""
        return frozenset(self.actions[number - 1] for number in self.twists.tolist())


def assembly_of(folding: Folding) -> Assembly:
    """What `write_manual` writes of a folding.

    Raises
    ------
    ValueError
        As `joint_word` for the path, and `actions_of` for the motion.

    Examples
    --------
    >>> import numpy as np, lineup as lu
    >>> from lineup.manual.assembly import assembly_of
    >>> folding = lu.fold(lu.VoxelSolid(np.ones((3, 2, 2), bool)), rounds=20, trial_rounds=5)
    >>> assembly_of(folding).n_blocks
    6
    """
    word = joint_word(folding)
    folding = replace(folding, motion=with_few_turns(folding.motion))
    voxels = folding.path.voxels
    base, actions = actions_of(folding.motion)
    build = best_build(voxels, base, actions)
    places = build.places(voxels)
    steps = tuple(steps_of(places, actions))
    return Assembly(folding, word, base, tuple(actions), build, places, steps)
