"""Progress over all runs, with the time that the plans leave."""

from __future__ import annotations

import time
from collections.abc import Callable, Hashable, Mapping

OnProgress = Callable[[str, int, int], None]


class Told:
    """Tells what one run does, how far it is, and when all of them will end as far as plans and the runs before know.

    Parameters
    ----------
    seconds : predicted time by number of every run that is to be made, in their order [s]
    kinds : what is alike in runs by the same number: none takes longer than the one of its kind before
    on_progress : called as ``on_progress(what, done, total)``, in predicted seconds; an exception stops the study
    """

    def __init__(self, seconds: Mapping[int, float], kinds: Mapping[int, Hashable], on_progress: OnProgress | None) -> None:
        self._seconds, self._kinds, self._tell = dict(seconds), kinds, on_progress
        self._place, self._name, self._begun = -1, "", time.monotonic()

    def begin(self, place: int, name: str) -> None:
        """A run starts, and the one before has ended."""
        if self._place in self._seconds:
            taken = self._seconds[self._place] = time.monotonic() - self._begun
            for later in self._seconds:
                if later > self._place and self._kinds[later] == self._kinds[self._place]:
                    self._seconds[later] = min(self._seconds[later], taken)
        self._place, self._name, self._begun = place, name, time.monotonic()
        self("starting", 0, 0)

    def __call__(self, what: str, done: int, total: int) -> None:
        """Told by the run: ``what`` is done, ``done`` of ``total``, 0 where nobody knows how many."""
        if self._tell is None:
            return
        planned = self._seconds[self._place]
        gone = sum(s for place, s in self._seconds.items() if place < self._place) + min(
            time.monotonic() - self._begun, planned
        )
        whole = sum(self._seconds.values())
        far = f" {done} of {total}" if total else ""
        # The time comes before what is done: a terminal cuts long lines.
        self._tell(f"{self._name} ({_words(whole - gone)}): {what}{far}", round(gone), round(whole))


def _words(left: float) -> str:
    """Seconds that are left, in words."""
    if left < 90.0:
        return f"all runs: some {left:.0f} s left"
    return f"all runs: some {left / 60.0:.0f} min left"
