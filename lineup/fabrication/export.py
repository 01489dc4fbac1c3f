"""Files for a printer: the chain on its plates, its parts, a coupon, a bill (Section 7)."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from ..block import Block, BlockReport, Part, block_parts, check_block, named_block
from ..draw.view import colours
from ..grid import FloatArray
from ..kinematics import Move
from ..solid import Design, Folding, VoxelPath
from ..storage import write_whole
from . import bill as bills
from .coupon import Coupon, coupon
from .files import Painted, write_3mf, write_stl
from .layout import Plate, pieces_on, plates
from .placing import Placed

POSES = ("flat", "folded")
SEGMENTS = 6
"""Colours along the chain: enough to find one's way, and few enough for a printer's filaments."""

_STEEL = "#5f6670"


@dataclass(frozen=True, eq=False)
class Print:
    """What `export_print` wrote.

    Attributes
    ----------
    files : tuple of Path
        In the order written.
    plates : tuple of Plate
        What each of the files of the chain holds.
    block : Block
    report : BlockReport
        What was found of the block.
    bill : DataFrame
        As in parts.csv.
    notes : tuple of str
        Where the motion asks for another block than this one; empty where it does not.
    """

    files: tuple[Path, ...]
    plates: tuple[Plate, ...]
    block: Block
    report: BlockReport
    bill: pd.DataFrame
    notes: tuple[str, ...]


def export_print(
    chain: VoxelPath | Folding | Design,
    folder: str | os.PathLike[str],
    pitch_mm: float = 10.0,
    *,
    block: str | Block = "standard",
    bed_mm: tuple[float, float] = (250.0, 250.0),
    layers: int = 1,
    pose: str = "flat",
    whole_stl: bool = False,
    density_g_cm3: float = 1.13,
    rate_cm3_h: float = 15.0,
) -> Print:
    """Write all that it takes to print a chain (Section 7, Figure 15).

    ================================ ======================================================
    ``chain.3mf``, ``chain-K.3mf``   the chain, laid to and fro on one plate or on several
    ``folded.3mf``                   instead of these, where the folded pose is printed
    ``chain.stl``, ...               the same as triangles, on request: 170 MB for 754 blocks
    ``parts/NAME.stl``               every part on its own
    ``coupon.3mf``                   three small chains that try clearances and snaps
    ``parts.csv``, ``parts.md``      the bill of materials, how to join plates, the block
    ================================ ======================================================

    In the 3MF files every part is stored once in each of the chain's six colours and placed many
    times; a chain on a plate is one object. No piece touches another, in a pose of any simple
    lattice path, so it is printed as one and is free to move.

    Parameters
    ----------
    chain : VoxelPath, Folding or Design
        Of an even number of voxels. A design is one chain; all its shapes are listed.
    folder : path
        Made if it does not exist.
    pitch_mm : float
        Edge of a voxel.
    block : str or Block
        One of `lineup.BLOCKS`, scaled to the pitch, or a block of this pitch.
    bed_mm : (float, float)
        What the printer can print on.
    layers : int
        Layers of voxels of a flat chain. More than one needs a printer without supports.
    pose : str
        "flat", or "folded": the path itself, as it lies.
    whole_stl : bool
    density_g_cm3 : float
        Of the material; 1.13 is that of a usual resin.
    rate_cm3_h : float
        What the printer prints in an hour, for the estimate of hours.

    Raises
    ------
    ValueError
        If the path is no chain, the block is none or fails a check, or the chain does not fit on
        the bed.

    Examples
    --------
    >>> import tempfile, lineup as lu
    >>> path = lu.VoxelPath(np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]))
    >>> made = lu.export_print(path, tempfile.mkdtemp())
    >>> [file.name for file in made.files[:3]], made.bill["count"].tolist()
    (['chain.3mf', 'end.stl', 'groove.stl'], [2, 2, 1, 5])
    """
    _positive(density_g_cm3=density_g_cm3, rate_cm3_h=rate_cm3_h)
    folder = Path(folder)
    measured = _block(block, pitch_mm)
    paths = _paths(chain)
    report = _checked(measured)
    laid = _laid(paths, measured, bed_mm, layers, pose)
    pieces = [pieces_on(plate, measured) for plate in laid]
    test = coupon(measured)
    parts = block_parts(measured)
    (folder / "parts").mkdir(parents=True, exist_ok=True)
    written = _chain_files(folder, pieces, parts, bed_mm, pose, whole_stl)
    written += [_part_file(folder, name, part) for name, part in sorted(parts.items())]
    written.append(_coupon_file(folder, test, bed_mm))
    on_all = [piece for on_one in pieces for piece in on_one]
    table = bills.bill(on_all, parts, measured, density_g_cm3, rate_cm3_h)
    notes = _notes(chain, measured)
    page = bills.page(
        {"Parts": table, "Shapes": _models(chain, measured), "Coupon": test.table},
        laid,
        measured,
        report,
        _assumptions(measured, density_g_cm3, rate_cm3_h),
        notes,
    )
    written.append(write_whole(folder / "parts.csv", table.to_csv(index=False)))
    written.append(write_whole(folder / "parts.md", page))
    return Print(tuple(written), laid, measured, report, table, notes)


def _positive(**numbers: float) -> None:
    for name, value in numbers.items():
        if not (math.isfinite(value) and value > 0):
            raise ValueError(f"{name} must be a positive number, got {value}")


def _block(block: str | Block, pitch_mm: float) -> Block:
    if isinstance(block, str):
        return named_block(block, pitch_mm)
    if block.pitch_mm != pitch_mm:
        raise ValueError(
            f"the block's pitch is {block.pitch_mm:g} mm, and pitch_mm is {pitch_mm:g}; "
            "lineup.block.scaled makes them agree"
        )
    return block


def _checked(block: Block) -> BlockReport:
    report = check_block(block)
    if not report.ok:
        raise ValueError(f"this block is not printable: {report.reason}; change its measures")
    return report


def _paths(chain: object) -> list[VoxelPath]:
    """The path of each shape, the chains all of one length."""
    if isinstance(chain, VoxelPath):
        return [chain]
    if isinstance(chain, Folding):
        return [chain.path]
    if not isinstance(chain, Design):
        raise ValueError(
            f"what is printed is a VoxelPath, Folding or Design, got {type(chain).__name__}"
        )
    paths = [folding.path for folding in chain.foldings]
    lengths = sorted({len(path) for path in paths})
    if len(lengths) != 1:
        raise ValueError(f"a design is one chain, got lengths {lengths}; lineup.trim makes it one")
    return paths


def _laid(
    paths: Sequence[VoxelPath],
    block: Block,
    bed_mm: tuple[float, float],
    layers: int,
    pose: str,
) -> tuple[Plate, ...]:
    if pose not in POSES:
        raise ValueError(f"unknown pose {pose!r}; known: {list(POSES)}")
    n = len(paths[0])
    if n % 2 or not n:
        raise ValueError(
            f"a chain of blocks has an even number of voxels, got {n}; "
            "lineup.trim makes it one less"
        )
    flat = plates(n // 2, block, bed_mm, layers) if pose == "flat" else ()
    if flat:
        return flat
    if len(paths) > 1:
        raise ValueError(
            f"the design has {len(paths)} folded poses; give one of its foldings to print that"
        )
    voxels = paths[0].voxels - paths[0].voxels.min(axis=0)
    size = (voxels.max(axis=0) + 1) * block.pitch_mm
    fits = [(size[[0, 1]] <= bed_mm).all(), (size[[1, 0]] <= bed_mm).all()]
    if not any(fits):
        raise ValueError(
            f"the folded chain is {size[0]:g} x {size[1]:g} mm, and the bed "
            f"{bed_mm[0]:g} x {bed_mm[1]:g}; a smaller pitch_mm, or pose 'flat', would do"
        )
    if not fits[0]:  # a quarter turn about z
        voxels = np.stack([voxels[:, 1].max() - voxels[:, 1], voxels[:, 0], voxels[:, 2]], axis=1)
    return (Plate(0, n // 2, voxels.astype(np.int32)),)


def _shift(
    pieces: Iterable[Placed], parts: Mapping[str, Part], bed_mm: tuple[float, float]
) -> FloatArray:
    """What puts pieces into the middle of the bed, and down on it."""
    pieces = tuple(pieces)
    lows, highs = zip(*(_box(piece, parts[piece.part]) for piece in pieces), strict=True)
    low, high = np.min(lows, axis=0), np.max(highs, axis=0)
    shift: FloatArray = (np.array([*bed_mm, 0.0]) - low - high) / 2
    shift[2] = -low[2]
    return np.round(shift, 4)


def _box(piece: Placed, part: Part) -> tuple[FloatArray, FloatArray]:
    corners = np.stack([part.vertices.min(axis=0), part.vertices.max(axis=0)])
    turned = corners @ piece.rotation.T + piece.offset_mm
    return turned.min(axis=0), turned.max(axis=0)


def _coloured(
    pieces: Sequence[Placed], parts: Mapping[str, Part], n_bars: int
) -> tuple[dict[str, Painted], list[tuple[str, Placed]]]:
    """Objects in the colours of the chain's segments, and the places of pieces among them."""
    palette = [f"#{r:02x}{g:02x}{b:02x}" for r, g, b in colours(SEGMENTS).tolist()]
    places = []
    for piece in pieces:
        if piece.part == "hinge":
            places.append(("hinge", piece))
            continue
        segment = min(max(piece.bar, 0) * SEGMENTS // n_bars, SEGMENTS - 1)
        places.append((f"{piece.part}-{segment + 1}", piece))
    objects = {}
    for key, piece in sorted(places, key=lambda place: place[0]):
        _, _, number = key.partition("-")
        colour = palette[int(number) - 1] if number else _STEEL
        objects[key] = Painted(parts[piece.part], key, colour)
    return objects, places


def _chain_files(
    folder: Path,
    plates: Sequence[Sequence[Placed]],
    parts: Mapping[str, Part],
    bed_mm: tuple[float, float],
    pose: str,
    whole_stl: bool,
) -> list[Path]:
    names = [pose if pose == "folded" else "chain"]
    if len(plates) > 1:
        names = [f"chain-{k}" for k in range(1, len(plates) + 1)]
    n_bars = plates[-1][-1].bar + 1
    written = []
    for name, pieces in zip(names, plates, strict=True):
        shift = _shift(pieces, parts, bed_mm)
        objects, places = _coloured(pieces, parts, n_bars)
        written.append(write_3mf(folder / f"{name}.3mf", name, objects, places, shift))
        if whole_stl:
            written.append(write_stl(folder / f"{name}.stl", parts, pieces, shift))
    return written


def _part_file(folder: Path, name: str, part: Part) -> Path:
    on_its_own = Placed(name, np.eye(3, dtype=np.int32), np.zeros(3), 0)
    shift = -part.vertices.min(axis=0)
    return write_stl(folder / "parts" / f"{name}.stl", {name: part}, [on_its_own], shift)


def _coupon_file(folder: Path, test: Coupon, bed_mm: tuple[float, float]) -> Path:
    objects = {name: Painted(part, name, _STEEL) for name, part in test.parts.items()}
    places = [(piece.part, piece) for piece in test.places]
    shift = _shift(test.places, test.parts, bed_mm)
    return write_3mf(folder / "coupon.3mf", "coupon", objects, places, shift)


def _foldings(chain: VoxelPath | Folding | Design) -> list[Folding]:
    if isinstance(chain, Design):
        return list(chain.foldings)
    return [chain] if isinstance(chain, Folding) else []


def _notes(chain: VoxelPath | Folding | Design, block: Block) -> tuple[str, ...]:
    """What the motions ask of a block that this one does not have."""
    notes = []
    for folding in _foldings(chain):
        motion = folding.motion
        if not len(motion):
            continue
        if block.diameter > motion.diameter + 1e-9:
            notes.append(
                f"the motion is for capsules of {motion.diameter:g} of the pitch, and these are "
                f"{block.diameter:g}"
            )
        if block.bend_deg < motion.max_bend_deg - 1e-9:
            notes.append(
                f"the motion bends joints by {motion.max_bend_deg:g} degrees, and slots end at "
                f"{block.bend_deg:g}"
            )
        if not block.swivel and (motion.moves[:, 0] == Move.PULL).any():
            notes.append("pulls bend joints in any plane, and these capsules do not swivel")
    if not notes:
        return ()
    return (*dict.fromkeys(notes), "block 'pull' is for paths without Us, 'pull120' for any")


def _models(chain: VoxelPath | Folding | Design, block: Block) -> pd.DataFrame:
    """A row for each shape: its size, and the motion that unfolds it."""
    names = [m.name for m in chain.models] if isinstance(chain, Design) else []
    rows = []
    for k, path in enumerate(_paths(chain)):
        size = np.ptp(path.voxels, axis=0) + 1
        row: dict[str, object] = {
            "shape": names[k] if names and names[k] else f"shape {k + 1}",
            "voxels": len(path),
            "size_mm": " x ".join(f"{side:g}" for side in (size * block.pitch_mm).tolist()),
        }
        if foldings := _foldings(chain):
            motion = foldings[k].motion
            row["moves"] = len(motion)
            row["straight"] = "yes" if motion.straight else "no"
        rows.append(row)
    return pd.DataFrame(rows)


def _assumptions(block: Block, density_g_cm3: float, rate_cm3_h: float) -> list[str]:
    return [
        f"Grams at {density_g_cm3:g} g/cm³, without supports.",
        f"Hours at {rate_cm3_h:g} cm³ an hour.",
        "Velcro on the band round each capsule between the ends of its slots; a pair of layers has "
        f"{block.gap_mm:g} mm between two capsules.",
    ]
