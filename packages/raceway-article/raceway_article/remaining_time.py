"""When a series of runs will end, by the plan of each and the time of those before it."""

import time
from collections.abc import Callable, Hashable, Mapping


class RemainingTime:
    """Progress over all runs: what one run does, how far it is, and when all will end by plans and the runs before.

    A run that takes longer than planned leaves the end unknown.

    seconds : predicted time by number of every run that is to be made, in their order [s]
    kinds : what is alike in runs by the same number: none takes longer than the one of its kind before
    on_progress : called as ``on_progress(what, done, total)``, in predicted seconds; an exception stops the study
    """

    def __init__(
        self,
        seconds: Mapping[int, float],
        kinds: Mapping[int, Hashable],
        on_progress: Callable[[str, int, int], None] | None,
    ) -> None:
        self._seconds, self._kinds, self._tell = dict(seconds), kinds, on_progress
        self._run, self._name, self._begun = -1, "", time.monotonic()
        self._order = {run: k for k, run in enumerate(self._seconds, 1)}

    def begin(self, run: int, name: str, case: str) -> None:
        """A run starts, and the one before has ended; its ``case`` is shown once, its short ``name`` with all that it does."""
        if self._run in self._seconds:
            elapsed_s = self._seconds[self._run] = time.monotonic() - self._begun
            for later in self._seconds:
                if later > self._run and self._kinds[later] == self._kinds[self._run]:
                    self._seconds[later] = min(self._seconds[later], elapsed_s)
        self._run, self._name, self._begun = run, name, time.monotonic()
        self(case, 0, 0)

    def __call__(self, label: str, done: int, total: int) -> None:
        """Called by the run: ``what`` is done, ``done`` of ``total``, 0 where nobody knows how many."""
        if self._tell is None:
            return
        whole_s, elapsed_s = self._seconds[self._run], time.monotonic() - self._begun
        past_s = sum(s for run, s in self._seconds.items() if run < self._run) + min(elapsed_s, whole_s)
        total_s = sum(self._seconds.values())
        remaining_s = total_s - past_s
        words = f"{remaining_s:.0f} s left" if remaining_s < 90.0 else f"{remaining_s / 60.0:.0f} min left"
        progress = f" {done} of {total}" if total else ""
        # A terminal cuts what is longer than 76 characters: the time first, then what is done.
        head = f"run {self._order[self._run]} of {len(self._order)}: {'end unknown' if elapsed_s > whole_s else words}"
        self._tell(f"{head}, {self._name}: {label}{progress}", round(past_s), round(total_s))
