"""What a chain takes: parts, grams, hours, velcro, under stated assumptions."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence

import pandas as pd

from ..block import Block, BlockReport, Part, block_strength
from .layout import Plate
from .placing import Placed

_JOINING = (
    "Slide the tongue at the end of each plate's chain into the groove at the start of the next, "
    "and fix it with a drop of glue or resin. The capsule is then like any other."
)
_STRENGTH = (
    "For a resin of modulus 2600 MPa and compressive strength 38 MPa, friction 0.3; the paper's "
    "figures are of its own block, whose size it does not give."
)


def bill(
    pieces: Sequence[Placed],
    parts: Mapping[str, Part],
    block: Block,
    density_g_cm3: float,
    rate_cm3_h: float,
) -> pd.DataFrame:
    """One row for each part of a chain and one for all.

    Returns
    -------
    DataFrame
        Columns part, count, volume_mm3 of one, and grams, hours and velcro_cm2 of all.
    """
    counts = Counter(piece.part for piece in pieces)
    rows = []
    for name in sorted(counts):
        volume, n = parts[name].volume_mm3, counts[name]
        cm3 = n * volume / 1000
        velcro = n * _velcro_mm2(name, block) / 100
        rows.append((name, n, volume, density_g_cm3 * cm3, cm3 / rate_cm3_h, velcro))
    columns = ["part", "count", "volume_mm3", "grams", "hours", "velcro_cm2"]
    table = pd.DataFrame(rows, columns=columns)
    total = {"part": "all", "count": int(table["count"].sum()), "volume_mm3": math.nan}
    total |= {name: float(table[name].sum()) for name in columns[3:]}
    return pd.concat([table, pd.DataFrame([total])], ignore_index=True).round(3)


def _velcro_mm2(part: str, block: Block) -> float:
    """The band round a capsule between the ends of its slots, or the share of a half of it."""
    if part == "hinge":
        return 0.0
    band = 2 * math.pi * block.radius_mm
    hole = block.hole_mm / 2 / math.sin(math.radians(block.bend_deg))
    behind = hole - block.radius_mm / math.tan(math.radians(block.bend_deg))
    if part == "end":
        return band * (block.radius_mm - behind)
    whole = band * (block.pitch_mm - 2 * behind)
    return whole if part == "middle" else whole / 2


def page(
    tables: Mapping[str, pd.DataFrame],
    plates: Sequence[Plate],
    block: Block,
    report: BlockReport,
    assumptions: Sequence[str],
    notes: Sequence[str],
) -> str:
    """The bill as a page of Markdown, with what else is to be known at the printer.

    Parameters
    ----------
    tables : mapping of str to DataFrame
        "Parts", "Shapes" and "Coupon".
    """
    lines = [
        f"# {plates[-1].stop} blocks of pitch {block.pitch_mm:g} mm",
        *(f"**{note}**" for note in notes),
        "## Parts",
        _markdown(tables["Parts"]),
        "\n".join(f"- {text}" for text in assumptions),
        "## Shapes",
        _markdown(tables["Shapes"]),
        "## Plates",
        _markdown(_plates(plates)),
    ]
    if len(plates) > 1:
        lines.append(_JOINING)
    lines += [
        "## Coupon",
        "Print `coupon.3mf` first.",
        _markdown(tables["Coupon"]),
        "## Block",
        _markdown(_measures(block)),
        f"Checked: {report.reason}, in {report.poses} poses; nothing overlaps, least gap "
        f"{report.gap_mm:.3f} mm, a ball has {report.play_mm:.2f} mm of play at most and cannot "
        "leave its socket.",
        "## Strength, estimated",
        _markdown(block_strength(block)),
        _STRENGTH,
    ]
    return "\n\n".join(lines) + "\n"


def _plates(plates: Sequence[Plate]) -> pd.DataFrame:
    rows = [
        (k, f"{p.start + 1} to {p.stop}", " x ".join(map(str, _size(p))), p.first, p.last)
        for k, p in enumerate(plates, start=1)
    ]
    return pd.DataFrame(rows, columns=["plate", "blocks", "voxels", "starts with", "ends with"])


def _size(plate: Plate) -> list[int]:
    size: list[int] = (plate.voxels.max(axis=0) - plate.voxels.min(axis=0) + 1).tolist()
    return size


def _measures(block: Block) -> pd.DataFrame:
    rows = [
        ("capsule", f"{2 * block.radius_mm:g} mm", f"{block.diameter:g} of the pitch"),
        ("ball", f"{block.ball_mm:g} mm", ""),
        ("bar", f"{block.bar_mm:g} mm", ""),
        ("clearance", f"{block.clearance_mm:g} mm", "all round"),
        ("neck of a slot", f"{block.neck_mm:g} mm", f"snaps by {block.snap_mm:g} mm a side"),
        ("bends", f"{block.bend_deg:g} degrees", "in any plane" if block.swivel else "in slots"),
    ]
    return pd.DataFrame(rows, columns=["measure", "value", "remark"])


def _markdown(table: pd.DataFrame) -> str:
    text: str = table.to_markdown(index=False, floatfmt=".5g").replace("nan", "   ")
    return text
