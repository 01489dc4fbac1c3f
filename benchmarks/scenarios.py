"""Section 8's uses as certified runs, with their pictures: `python -m benchmarks.scenarios`."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import pandas as pd
import typer
from PIL import Image

import lineup as lu
from lineup import draw
from lineup.scenarios import Scenario
from lineup.storage import write_whole

COLUMNS = [
    *("scenario", "blocks", "radius", "pulls", "track", "diameter", "bend_deg", "clearance"),
    *("box", "certified", "seconds"),
]

app = typer.Typer(add_completion=False, help=__doc__)


@app.command()
def scenarios(
    before: Annotated[str, typer.Option(help="Model before the wall.")] = "elephant",
    beyond: Annotated[str, typer.Option(help="Model beyond it.")] = "bunny",
    blocks: Annotated[int, typer.Option(help="Blocks of these two.")] = 754,
    voxels: Annotated[int, typer.Option(help="Voxels of these two.")] = 1600,
    capsule: Annotated[tuple[float, float], typer.Option(help="Inner radius, length.")] = (7.5, 21),
    out: Annotated[Path, typer.Option(help="Folder of the table.")] = Path("experiments/results"),
    pictures: Annotated[Path, typer.Option(help="Folder of the pictures.")] = Path("docs"),
) -> None:
    """OUT/scenarios.csv and .md, and PICTURES/tube.png and capsule.png."""
    a, b = (
        lu.fold(lu.model(name, voxels=voxels), "pull", length=2 * blocks)
        for name in (before, beyond)
    )
    length = min(len(a.path), len(b.path))
    if len(a.path) != len(b.path):
        raise typer.BadParameter(f"the shorter of the two paths has {length} voxels only")
    runs: dict[str, tuple[str, Callable[[], Scenario]]] = {
        f"{before} through a tube into {beyond}": ("tube", lambda: lu.through_tube(a, b)),
        f"straight chain through a tube into {beyond}": ("", lambda: lu.through_tube(None, b)),
        "straight chain into a capsule": ("capsule", lambda: lu.into_capsule(*capsule)),
    }
    rows = []
    for name, (file, run) in runs.items():
        started = time.perf_counter()
        scenario = run()
        rows.append(measured(name, scenario, time.perf_counter() - started))
        typer.echo("{scenario}: {certified}, {seconds:.1f} s".format(**rows[-1]))
        if file:
            lighter(draw.save(draw.run(scenario), pictures / f"{file}.png"))
    table = pd.DataFrame(rows, columns=COLUMNS)
    out.mkdir(parents=True, exist_ok=True)
    write_whole(out / "scenarios.csv", table.to_csv(index=False))
    page = table.to_markdown(index=False, floatfmt=".4g") + "\n"
    write_whole(out / "scenarios.md", page)


def lighter(picture: Path) -> None:
    """Half the bytes, and no difference to the eye: 256 colours are enough."""
    Image.open(picture).convert("RGB").quantize(256, dither=Image.Dither.NONE).save(picture)


def measured(name: str, scenario: Scenario, seconds: float) -> dict[str, Any]:
    """The row of one run; the seconds are those of the way, the judge and the capsule's path."""
    motion, verdict = scenario.motion, scenario.certificate
    return {
        "scenario": name,
        "blocks": len(motion.start) // 2,
        "radius": scenario.radius,
        "pulls": len(motion),
        "track": len(motion) + len(motion.start),
        "diameter": motion.diameter,
        "bend_deg": verdict.bend_deg,
        "clearance": verdict.clearance,
        "box": " x ".join(f"{side:.0f}" for side in verdict.extent),
        "certified": verdict.reason,
        "seconds": round(seconds, 1),
    }


if __name__ == "__main__":
    app()
