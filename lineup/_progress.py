"""How a long command tells where it is: bars on a terminal, plain lines elsewhere."""

from __future__ import annotations

import time
from collections.abc import Callable
from types import TracebackType

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    Task,
    TextColumn,
    TimeElapsedColumn,
)
from rich.text import Text


class Reporter:
    """Shows `total` jobs by name: call it with a name and the stage that job has reached.

    A stage "done", "kept" or "failed: why" ends the job, and "made anew: why" comes before it. The
    time left is told from the time that jobs have taken so far; those that were kept took none.
    """

    def __init__(
        self, total: int, console: Console, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._total = total
        self._n_ended = 0
        self._n_kept = 0
        self._clock = clock
        self._begin = clock()
        self._end: float | None = None
        self._console = console
        self._bars = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            _Left(self.left),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )
        self._all = self._bars.add_task("", total=total)
        self._running: dict[str, str] = {}

    def __enter__(self) -> Reporter:
        self._bars.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._bars.stop()

    def __call__(self, name: str, stage: str) -> None:
        """Job `name` has reached `stage`."""
        ended = stage in ("done", "kept") or stage.startswith("failed: ")
        self._n_ended += ended
        self._n_kept += stage == "kept"
        if ended and stage != "kept":
            each = (self._clock() - self._begin) / (self._n_ended - self._n_kept)
            self._end = self._clock() + each * (self._total - self._n_ended)
        noted = stage.startswith("made anew: ")
        self._running.pop(name, None)
        if not ended and not noted:
            self._running[name] = stage
        if ended or noted or not self._console.is_terminal:
            count = f"[{self._n_ended}/{self._total}]"
            plain = ended and not self._console.is_terminal  # a terminal has it beside the bar
            left = f" ({self.left()})" if plain and self.left() else ""
            self._console.print(f"{count} {name}: {stage}{left}", markup=False, highlight=False)
        shown = list(self._running.items())[:3]
        more = [f"and {len(self._running) - 3} more"] if len(self._running) > 3 else []
        running = ", ".join([*(f"{name}: {stage}" for name, stage in shown), *more])
        self._bars.update(self._all, completed=self._n_ended, description=running)

    def left(self) -> str:
        """The time left in words; "" before the first job has ended, and after the last."""
        if self._end is None or self._n_ended == self._total:
            return ""
        seconds = max(self._end - self._clock(), 1.0)
        if seconds < 90:
            return f"about {seconds:.0f} s left"
        if seconds < 5400:
            return f"about {seconds / 60:.0f} min left"
        return f"about {seconds / 3600:.1f} h left"


class _Left(ProgressColumn):
    """The time left, told anew at every refresh."""

    def __init__(self, left: Callable[[], str]) -> None:
        super().__init__()
        self._left = left

    def render(self, task: Task) -> Text:
        return Text(self._left(), style="progress.remaining")
