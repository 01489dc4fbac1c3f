"""A manual read back: the folding that its rows alone tell of, every entry checked against it."""

from __future__ import annotations

import csv
import io
import os
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

import numpy as np
from pydantic import ValidationError

from .. import grid
from .._files import content
from ..joints import slot_violations
from ..kinematics import Move
from ..motion.plan import DIAMETER, MAX_BEND_DEG, Row, inward_bar
from ..solid import Certificate, Folding, Motion, VoxelPath
from ..storage import first_error
from .actions import AT_ONCE, ENDS, HEAD, HINGE_FIRST, STRAIGHTEN, TAIL
from .assembly import assembly_of
from .build import LYING, Build, build_of
from .documents import READS, Document, document_of
from .rows import BlockRow, rows_of

READ = "straight: read from a manual"
OUTWARD = (-1, 1)
"""The step of the joint index towards the loose end."""

Event: TypeAlias = int | tuple[int, int, int]
"""A joint put in place, or (end, was, loose) of a swing."""


def read_manual(file: str | os.PathLike[str]) -> Folding:
    """The folding that the rows of a manual tell of, as `write_manual` wrote them.

    Only the voxels, the numbers of the actions that put them in place, the swings, and the manners
    in which hinges are bent are followed; whatever else a manual says is worked out anew, and has
    to agree.

    Parameters
    ----------
    file : path
        NAME.manual.json or NAME.manual.csv. A CSV file says nothing of a diameter and a bend;
        those of the planners are then taken.

    Returns
    -------
    Folding
        Its motion unfolds the path; played backwards it is what the hand does. Only `certify`
        says that it is free of collisions, and whether slotted joints let the chain make it.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is no manual, is of another version, or contradicts itself: one line that names the
        row and the entry.

    Examples
    --------
    >>> import numpy as np, tempfile, lineup as lu
    >>> folding = lu.fold(lu.VoxelSolid(np.ones((2, 2, 1), bool)), rounds=20, trial_rounds=5)
    >>> files = lu.write_manual(folding, tempfile.mkdtemp(), name="square")
    >>> again = lu.read_manual(files[1])
    >>> bool((again.motion.moves == folding.motion.moves).all())
    True
    """
    file = Path(file)
    if file.suffix not in (".json", ".csv"):
        raise ValueError(f"{file}: a manual is read from .json or .csv")
    try:
        if file.suffix == ".csv":
            return _followed(_csv_rows(file), DIAMETER, MAX_BEND_DEG)
        document = Document.model_validate_json(content(file))
        folding = _followed(document.rows, document.diameter, document.max_bend_deg)
        _check_document(document, folding)
        return folding
    except ValidationError as error:
        raise ValueError(f"{file}: {first_error(error)}") from None
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from None


def _csv_rows(file: Path) -> list[BlockRow]:
    rows = []
    text = io.StringIO(content(file).decode(), newline="")
    reader = csv.DictReader(text, restkey="beyond", strict=True)
    try:
        names = reader.fieldnames or []
        missing = [name for name in BlockRow.model_fields if name not in names]
        if missing:
            raise ValueError(f"no column {missing[0]}: {READS}")
        for k, entries in enumerate(reader, start=1):
            given = {name: entry for name, entry in entries.items() if entry is not None}
            rows.append(_csv_row(k, given))
    except csv.Error as error:
        raise ValueError(str(error)) from None
    return rows


def _csv_row(k: int, entries: dict[str, str]) -> BlockRow:
    try:
        return BlockRow.model_validate_strings(entries)
    except ValidationError as error:
        raise ValueError(f"row {k}: {first_error(error)}") from None


def _followed(rows: list[BlockRow], diameter: float, max_bend_deg: float) -> Folding:
    """The folding that rows tell of, which must then have just these rows."""
    voxels = _voxels(rows)
    build = _build(rows, voxels)
    moves = _moves(rows, voxels, build)
    motion = Motion(voxels, moves, diameter, max_bend_deg, True, READ)
    folding = Folding(VoxelPath(voxels, method="manual"), motion)
    for given, told in zip(rows, rows_of(assembly_of(folding)), strict=True):
        for name, value in told.model_dump().items():
            if getattr(given, name) != value:
                raise ValueError(
                    f"row {told.order}: {name} is {getattr(given, name)!r}, "
                    f"and by the other entries it would be {value!r}"
                )
    if any(row.manner for row in rows):
        at_once = [row.model_copy(update={"manner": AT_ONCE}) for row in rows]
        _check_manners(rows, replace(motion, moves=_moves(at_once, voxels, build)))
    return folding


def _check_manners(rows: list[BlockRow], at_once: Motion) -> None:
    """Whether only hinges whose peels would twist a piece, if made at once, are bent otherwise."""
    peels = at_once.moves[slot_violations(at_once)[:, 0]].tolist()
    blocks = {joint // 2 + 1 for kind, joint, *_ in peels if kind == Move.PEEL}
    for row in rows:
        if row.manner and row.block not in blocks:
            raise ValueError(
                f"row {row.order}: manner is {row.manner!r}, and slots let this hinge bend at once"
            )


def _voxels(rows: list[BlockRow]) -> grid.IntArray:
    """The path, once it is clear that there is a row for each block, in order."""
    for k, row in enumerate(rows, start=1):
        if row.order != k:
            raise ValueError(f"row {k} has order {row.order}: rows are missing or out of order")
    blocks = sorted(row.block for row in rows)
    if blocks != list(range(1, len(rows) + 1)) or not rows:
        raise ValueError(f"the {len(rows)} rows are not of blocks 1 to {len(rows)}, one of each")
    by_block = sorted(rows, key=lambda row: row.block)
    voxels = np.array([voxel for row in by_block for voxel in row.voxels], np.int32)
    if len(np.unique(voxels, axis=0)) < len(voxels):
        raise ValueError("two blocks have a voxel in common")
    grid.bar_directions(voxels)
    return voxels


def _build(rows: list[BlockRow], voxels: grid.IntArray) -> Build:
    """How the model lies on the base card, as columns, rows and layers tell."""
    late = [2 * row.block - (2 if row.at1 > row.at2 else 1) for row in rows]
    told = np.array([(row.column, row.row, row.layer) for row in rows])
    for down in LYING:
        build = build_of(down, voxels)
        if np.array_equal(build.places(voxels)[late], told):
            return build
    raise ValueError("columns, rows and layers are those of no way to lay these voxels down")


def _events(rows: list[BlockRow], build: Build) -> list[Event]:
    """Actions by number, the base left out: joints put in place, and swings of a loose end."""
    events: dict[int, Event] = {}
    numbers: list[int] = []
    for row in rows:
        for number, joint in ((row.at1, 2 * row.block - 2), (row.at2, 2 * row.block - 1)):
            numbers.append(number)
            events[number] = joint
        for text in row.swings.split():
            at, end, ways = text.split(":")
            was, loose = (build.letters.index(letter) for letter in ways)
            numbers.append(int(at))
            events[int(at)] = (ENDS.index(end), was, loose)
    if sorted(numbers) != [0, *range(len(numbers) - 1)]:
        raise ValueError("the actions are not numbered 0 twice, for the base, and then 1, 2, ...")
    return [events[number] for number in range(1, len(numbers) - 1)]


def _moves(rows: list[BlockRow], voxels: grid.IntArray, build: Build) -> grid.IntArray:
    """The moves of the unfolding: what the events undo, backwards."""
    bars = grid.bar_directions(voxels).tolist()
    base = sorted(
        joint
        for row in rows
        for number, joint in ((row.at1, 2 * row.block - 2), (row.at2, 2 * row.block - 1))
        if number == 0
    )
    if len(base) != 2 or base[1] != base[0] + 1:
        raise ValueError("the base is not two voxels in a row")
    at, loose = base, [(bars[base[0]] + 3) % 6, bars[base[0]]]
    manners = {row.block - 1: row.manner for row in rows}
    moves: list[Row] = []
    for event in _events(rows, build):
        if isinstance(event, tuple):
            end, was, now = event
            beyond = at[end] + OUTWARD[end]
            if was != loose[end] or not 0 <= beyond < len(voxels):
                raise ValueError(f"the {ENDS[end]} has no loose end that points that way to swing")
            moves.append((Move.SWING, at[end], beyond, was))
            loose[end] = now
            continue
        end = HEAD if event < at[HEAD] else TAIL
        if event != at[end] + OUTWARD[end]:
            raise ValueError(f"block {event // 2 + 1} comes before one that it hangs on")
        away = (bars[event] + 3) % 6 if end == HEAD else bars[event - 1]
        if away != loose[end]:
            hinge = min(event, at[end]) % 2 == 0
            manner = manners[event // 2] if hinge else AT_ONCE
            _add(moves, (Move.PEEL, at[end], event, loose[end]), manner, bars)
        at[end] = event
    return np.array(moves[::-1], np.int32).reshape(-1, 4)


def _add(moves: list[Row], peel: Row, manner: str, bars: list[int]) -> None:
    """Add what bends a joint in such a manner, if it can be, in the order of the hand."""
    _, inner, outer, loose = peel
    beyond = 2 * outer - inner
    piece, bar = inward_bar(bars, inner, outer), inward_bar(bars, outer, beyond)
    if manner == HINGE_FIRST and moves and moves[-1][0] == Move.PEEL and moves[-1][2] == inner:
        moves.insert(-1, peel)
        return
    moves.append(peel)
    if manner == STRAIGHTEN and piece % 3 not in (bar % 3, loose % 3):
        moves.append((Move.PEEL, inner, outer, piece))


def _check_document(document: Document, folding: Folding) -> None:
    """Compare all but the rows, the model's name and the verdict, which is the judge's to give."""
    verdict = Certificate(True, "")
    told = document_of(assembly_of(folding), verdict, document.model).model_dump()
    for name, value in document.model_dump().items():
        if name not in ("rows", "verdict") and value != told[name]:
            raise ValueError(f"{name} does not agree with the rows")
