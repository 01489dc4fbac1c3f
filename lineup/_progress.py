"""How a long command tells where it is: bars on a terminal, plain lines elsewhere."""

from __future__ import annotations

from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn


class Reporter:
    """Shows `total` jobs by name: call it with a name and the stage that job has reached.

    A stage "done", "kept" or "failed: why" ends the job.
    """

    def __init__(self, total: int, console: Console) -> None:
        self._total = total
        self._n_ended = 0
        self._console = console
        self._bars = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
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
        self._running.pop(name, None)
        if not ended:
            self._running[name] = stage
        if ended or not self._console.is_terminal:
            count = f"[{self._n_ended}/{self._total}]"
            self._console.print(f"{count} {name}: {stage}", markup=False, highlight=False)
        shown = list(self._running.items())[:3]
        more = [f"and {len(self._running) - 3} more"] if len(self._running) > 3 else []
        running = ", ".join([*(f"{name}: {stage}" for name, stage in shown), *more])
        self._bars.update(self._all, completed=self._n_ended, description=running)
