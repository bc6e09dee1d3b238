"""A progress bar on standard error, on a terminal, for what takes longer than a second.  Part of ``raceway.cli.main``.

Each new thing that is told of goes to the logger ``raceway``, too, which ``-v`` shows.
"""

from __future__ import annotations

import logging
import re
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from inspect import signature
from typing import TYPE_CHECKING, Annotated, ClassVar, Self

from raceway.framework.doors import reader

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress

_PATIENCE_S = 1.0
#: What a function of the package takes as ``progress``: True for a bar on a terminal, or what is called with what, done, total.
ShowProgress = Annotated[
    bool | Callable[[str, int, int], None] | None,
    reader("True, or a function of (what, done, total)", lambda v: isinstance(v, bool) or signature(v).bind("what", 0, 1)),
]
_LOGGER = logging.getLogger("raceway")
#: What follows in a description is news of the same thing.
_NEWS = re.compile(r"[,:;(]")


class ProgressBar:
    """Shows what runs and how far it is; silent where nobody looks.

    Called as ``bar(what, done, total)``; ``total`` 0 means that nobody knows.  A bar inside another one says what it does in
    that one: a screen has a single bar.

    console : where to draw; standard error when None
    patience : seconds before anything is drawn
    remaining : show how many are done and the time left, too: for parts that take about the same time each
    """

    _current: ClassVar[ProgressBar | None] = None

    def __init__(
        self, label: str, console: Console | None = None, patience: float = _PATIENCE_S, remaining: bool = False
    ) -> None:
        from rich.console import Console

        self.console = console or Console(stderr=True, force_terminal=sys.stderr.isatty())  # whatever FORCE_COLOR says
        self._label, self._remaining = label, remaining
        self._bar: Progress | None = None
        self._around: ProgressBar | None = None
        self._told = ""
        self._over = threading.Event()
        self._lock = threading.Lock()
        self._timer = threading.Timer(patience, self._draw)
        self._timer.daemon = True

    def __enter__(self) -> Self:
        self._around, ProgressBar._current = ProgressBar._current, self
        if self._around is not None:
            self(self._label, 0, 0)
            return self
        self._log(self._label)
        if self.console.is_terminal:
            from rich import progress as rich

            text = rich.TextColumn("{task.description}")
            columns: list[rich.ProgressColumn] = [rich.SpinnerColumn(), text, rich.BarColumn(), rich.TimeElapsedColumn()]
            if self._remaining:
                columns += [rich.MofNCompleteColumn(), rich.TextColumn("left"), rich.TimeRemainingColumn()]
            self._bar = rich.Progress(*columns, console=self.console, transient=True)
            self._task = self._bar.add_task(self._label, total=None)
            self._timer.start()
        return self

    def __exit__(self, *_: object) -> None:
        ProgressBar._current = self._around
        if self._bar is None:
            return
        self._timer.cancel()
        with self._lock:
            self._over.set()
            self._bar.stop()

    def __call__(self, label: str, done: int, total: int) -> None:
        if self._around is not None:
            self._around(label, done, total)
            return
        self._log(label)
        if self._bar is not None:
            self._bar.update(self._task, description=label or self._label, completed=done, total=total or None)

    def _log(self, label: str) -> None:
        thing = _NEWS.split(label)[0]
        if label and thing != self._told:
            self._told = thing
            _LOGGER.info("%s", label)

    def _draw(self) -> None:
        with self._lock:
            if self._bar is not None and not self._over.is_set():
                self._bar.start()


@contextmanager
def telling(progress: ShowProgress, remaining: bool = False) -> Iterator[Callable[[str, int, int], None]]:
    """What is called with the progress of a study.

    progress : True for a bar where standard error is a terminal, None or False for silence, or what is called itself
    """
    if progress is True:
        with ProgressBar("starting", remaining=remaining) as bar:
            yield bar
    else:
        yield progress or (lambda _what, _count, _total: None)
