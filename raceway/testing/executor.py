"""The conformance suite of executors."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import attrs

from raceway.framework.contracts import Batch, Refused
from raceway.testing.suite import Suite, duty, require

if TYPE_CHECKING:
    from raceway.framework.contracts import Executor

_BATCHES = 400
#: Taken from the batches at most before the first is answered.
_AHEAD = 100


@attrs.frozen
class Doubling:
    """Work that doubles numbers; it refuses the batch that holds ``refused`` and breaks at the one that holds ``broken``."""

    refused: int | None = None
    broken: int | None = None

    def fault(self) -> str | None:
        return None

    def __call__(self, points: list[int]) -> Refused | list[int]:
        if self.broken in points:
            raise ArithmeticError("a fault of the work itself")
        return Refused("here", "a trial") if self.refused in points else [2 * point for point in points]


class _Source:
    """Batches of two numbers, counted as they are taken."""

    def __init__(self, total: int) -> None:
        self.taken, self.total = 0, total

    def __iter__(self) -> Iterator[Batch]:
        for number in range(self.total):
            self.taken += 1
            yield number, [2 * number, 2 * number + 1]


class ExecutorSuite(Suite):
    """Duties of ``raceway.framework.contracts.Executor``.  Its work is in processes of its own, and clusters do not survive a fork."""

    kind = "executor"
    apart = False

    @duty("every batch is answered once, by what the work returned; batches are taken as they are needed")
    def test_answers(self, executor: Executor) -> None:
        source, found, ahead = _Source(_BATCHES), dict[int, Any](), None
        for number, answer in executor.compute(Doubling(refused=11), source):
            ahead = source.taken if ahead is None else ahead
            require(number not in found, f"batch {number} is answered twice")
            found[number] = answer
        require(sorted(found) == list(range(_BATCHES)), f"{len(found)} of {_BATCHES} batches are answered")
        wrong = [n for n in found if n != 5 and list(found[n]) != [4 * n, 4 * n + 2]]
        require(not wrong, f"the answer of batch {wrong[:1]} is not what the work returned")
        require(isinstance(found[5], Refused), f"`Refused` is not passed on, but {found[5]!r}")
        require((ahead or 0) <= _AHEAD, f"{ahead} of {_BATCHES} batches are taken before the first is answered")

    @duty("no batches, no answers; what the work raises passes through; closing stops it")
    def test_ends(self, executor: Executor) -> None:
        require(not list(executor.compute(Doubling(), _Source(0))), "answers without a batch")
        try:
            list(executor.compute(Doubling(broken=6), _Source(8)))
        except ArithmeticError as why:
            require("work itself" in str(why), f"another exception passes through: {why}")
        else:
            require(False, "an exception of the work is swallowed")
        source = _Source(_BATCHES)
        answers = executor.compute(Doubling(), source)
        next(answers)
        getattr(answers, "close", lambda: None)()
        require(source.taken <= _AHEAD, f"closing takes all {source.taken} batches")
