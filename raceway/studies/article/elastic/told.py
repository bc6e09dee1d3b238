"""Progress over all runs, with the time that the plans leave."""

from __future__ import annotations

import time
from collections.abc import Callable, Hashable, Mapping

OnProgress = Callable[[str, int, int], None]


class Told:
    """Tells what one run does, how far it is, and when all of them will end as far as plans and the runs before know.

    A run that takes longer than planned leaves the end unknown.

    Parameters
    ----------
    seconds : predicted time by number of every run that is to be made, in their order [s]
    kinds : what is alike in runs by the same number: none takes longer than the one of its kind before
    on_progress : called as ``on_progress(what, done, total)``, in predicted seconds; an exception stops the study
    """

    def __init__(self, seconds: Mapping[int, float], kinds: Mapping[int, Hashable], on_progress: OnProgress | None) -> None:
        self._seconds, self._kinds, self._tell = dict(seconds), kinds, on_progress
        self._place, self._name, self._begun = -1, "", time.monotonic()
        self._order = {place: k for k, place in enumerate(self._seconds, 1)}

    def begin(self, place: int, name: str, case: str) -> None:
        """A run starts, and the one before has ended; its ``case`` is told once, its short ``name`` with all that it does."""
        if self._place in self._seconds:
            taken = self._seconds[self._place] = time.monotonic() - self._begun
            for later in self._seconds:
                if later > self._place and self._kinds[later] == self._kinds[self._place]:
                    self._seconds[later] = min(self._seconds[later], taken)
        self._place, self._name, self._begun = place, name, time.monotonic()
        self(case, 0, 0)

    def __call__(self, what: str, done: int, total: int) -> None:
        """Told by the run: ``what`` is done, ``done`` of ``total``, 0 where nobody knows how many."""
        if self._tell is None:
            return
        planned, taken = self._seconds[self._place], time.monotonic() - self._begun
        gone = sum(s for place, s in self._seconds.items() if place < self._place) + min(taken, planned)
        whole = sum(self._seconds.values())
        left = "end unknown" if taken > planned else _time_left(whole - gone)
        far = f" {done} of {total}" if total else ""
        # A terminal cuts what is longer than 76 characters: the time first, then what is done.
        run = f"run {self._order[self._place]} of {len(self._order)}"
        self._tell(f"{run}: {left}, {self._name}: {what}{far}", round(gone), round(whole))


def _time_left(left: float) -> str:
    """Seconds that are left, in words."""
    return f"{left:.0f} s left" if left < 90.0 else f"{left / 60.0:.0f} min left"
