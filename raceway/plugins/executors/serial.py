"""In this process, one batch after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Any, ClassVar

import attrs

if TYPE_CHECKING:
    from raceway.framework.contracts import Batch


@attrs.frozen
class Serial:
    """One point after the other, in this process: no start-up, and the debugger's choice."""

    name: ClassVar[str] = "serial"

    def compute(self, work: Callable[[list[Any]], Any], batches: Iterable[Batch]) -> Iterator[tuple[int, Any]]:
        for number, points in batches:
            yield number, work(points)
