"""Reference cases: what sources state and give, and how a computed number compares with theirs."""

import json
from functools import cache
from importlib.resources import files
from math import isfinite
from typing import Any

import attrs

from raceway.extend import Tables

#: Where the numbers of a case come from: what a document tells numbers of a source from.
BASES = {"published": "published numbers", "closed form": "numbers of closed forms", "own": "internal comparisons"}


@attrs.frozen
class Verified:
    """One computed number beside that of a case, in the unit of the source."""

    case: str
    quantity: str
    reference: float | None
    computed: float | None
    error: float | None  # |computed / reference - 1|
    tolerance: float | None  # largest error allowed
    ok: bool  # whether it is met
    source: str
    basis: str
    note: str = ""  # why there is no computed number (then computed and error are None, and ok is False), or ""


@attrs.frozen
class Case:
    """One case, in the units of its source (they are part of each key: ``Dw_mm``)."""

    id: str
    kind: str
    basis: str  # where ``outputs`` come from, a key of ``BASES``
    title: str
    #: inputs, outputs : what the source states and what it gives
    inputs: Tables
    outputs: Tables
    rel_tol: Any  # relative agreement asked for, one number or one for each group of outputs
    conventions: str  # frame, signs and normalisation of the source, in words
    source: str  # where it was published
    role: str  # "check...", or "information..." for what this program need not compute

    @property
    def checked(self) -> bool:
        """Whether ``raceway verify`` computes it."""
        return self.role.startswith("check")

    def row(
        self, quantity: str, reference: float | None, computed: float | None, tolerance: float | None, note: str = ""
    ) -> Verified:
        """A number beside the case's own; ``note``: why there is none."""
        if computed is not None and not isfinite(computed):
            computed, note = None, f"computed {computed}: not a finite number"
        error = None if computed is None or reference is None else abs(computed - reference) / abs(reference)
        ok = error is not None and tolerance is not None and error <= tolerance
        return Verified(self.id, quantity, reference, computed, error, tolerance, ok, self.source, self.basis, note)


@cache
def reference_cases() -> dict[str, Case]:
    """All cases by id, in the file's order."""
    text = files("raceway_checks").joinpath("data/cases.json").read_text(encoding="utf-8")
    return {case["id"]: Case(**case) for case in json.loads(text)["cases"]}
