"""In this process, one batch after the other."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, ClassVar

import attrs

if TYPE_CHECKING:
    from raceway.framework.contracts import Answer, Batch, Work


@attrs.frozen
class Serial:
    """One point after the other, in this process: no start-up, and the debugger's choice."""

    name: ClassVar[str] = "serial"

    def compute(self, work: Work, batches: Iterable[Batch]) -> Iterator[Answer]:
        for number, points in batches:
            yield number, work(points)
