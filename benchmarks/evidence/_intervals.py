"""Stated intervals against the errors they are stated for: too narrow and too wide are both wrong."""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

from benchmarks.evidence import Row

#: Root mean square of normal errors over the half-width that holds 95 % of them.
RIGHT = 1.0 / 1.96
#: An interval is right within this factor.
FACTOR = 2.0


def width(words: str, ratios: Sequence[float], command: str, note: str = "") -> Row:
    """A row for errors over their stated half-widths at 95 %, whose root mean square is ``RIGHT`` where the intervals are."""
    found = sqrt(sum(ratio**2 for ratio in ratios) / len(ratios))
    low, high = RIGHT / FACTOR, RIGHT * FACTOR
    told = f"intervals {RIGHT / found:.3g} times as wide as the errors ask for" if found else "no error"
    limit = f"{low:.2f} to {high:.2f}"
    quantity = f"{words}: root mean square of error over stated half-width"
    return Row(quantity, found, limit, low <= found <= high, command, f"{told}; {note}" if note else told)
