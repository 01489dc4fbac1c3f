"""The command line: thin doors to the functions of the library.

Exit codes: 0 done, 1 a result fell short (which, and how, is said), 2 bad use. Heavy packages are
imported inside the commands, so that ``lineup --help`` answers at once.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import NoReturn

import typer

from . import (
    chains,
    experiments,
    films,
    kit,
    manual,
    orienting,
    playing,
    printing,
    robot,
    strength,
)
from .experiments import EXPERIMENTS

__all__ = ["EXPERIMENTS", "app", "main", "run"]

app = typer.Typer(
    help="LineUp: fold one chain of blocks into many shapes, and prove that it unfolds.",
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

COMMANDS: dict[str, Callable[..., None]] = {
    "table2": experiments.table2,
    "run": chains.run_models,
    "transform": chains.transform,
    "verify": chains.verify,
    "models": chains.models,
    "voxelize": chains.voxelize,
    "path": chains.path,
    "unfold": chains.unfold,
    "kit": kit.kit,
    "animate": films.animate,
    "play": playing.play,
    "print": printing.print_chain,
    "manual": manual.manual,
    "strength": strength.strength,
    "robot": robot.robot,
    "orient": orienting.orient,
    "sweep": experiments.sweep,
}
for name, command in COMMANDS.items():
    app.command(name)(command)

# Typer has a public name for the common base of its usage errors in late versions only.
_UsageError: type[typer.BadParameter] = typer.BadParameter.__bases__[0]


def main() -> NoReturn:
    """Entry point of the ``lineup`` command."""
    sys.exit(run(sys.argv[1:]))


def run(args: list[str]) -> int:
    """Run one command line and return its exit code; bad use is one line on stderr."""
    try:
        code: int | None = app(args, prog_name="lineup", standalone_mode=False)
    except _UsageError as error:
        return _bad_use(error.format_message())
    except OSError as error:
        where = f": {error.filename}" if error.filename else ""
        return _bad_use(f"{error.strerror}{where}" if error.strerror else str(error))
    except ValueError as error:
        return _bad_use(str(error))
    except MemoryError as error:
        return _bad_use(f"this takes more memory than there is: {error or 'out of memory'}")
    except RecursionError:
        return _bad_use("the input is nested too deeply")
    if code == 130:
        typer.echo("lineup: interrupted; what was finished is kept", err=True)
    return code or 0


def _bad_use(message: str) -> int:
    typer.echo(f"lineup: error: {' '.join(message.split())}", err=True)
    return 2


@app.callback(invoke_without_command=True)
def _help(context: typer.Context) -> None:
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())
