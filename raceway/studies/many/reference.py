"""The reference cases that come with the package, ``raceway/data/cases.json``."""

from __future__ import annotations

import json
from functools import cache
from importlib.resources import files
from typing import Any

import attrs

from raceway.storage.tables import Tables

#: Where the numbers of a case come from: what a document tells numbers of a source from.
BASES = {
    "published": "published numbers",
    "closed form": "numbers of closed forms",
    "own": "numbers of this program by two ways",
}


@attrs.frozen
class Case:
    """One case, in the units of its source (they are part of each key: ``Dw_mm``).

    Attributes
    ----------
    basis : where ``outputs`` come from, a key of ``BASES``
    inputs, outputs : what the source states and what it gives
    rel_tol : relative agreement asked for, one number or one for each group of outputs
    conventions : frame, signs and normalisation of the source, in words
    source : where it was published
    role : "check...", or "information..." for what this program need not compute
    """

    id: str
    kind: str
    basis: str
    title: str
    inputs: Tables
    outputs: Tables
    rel_tol: Any
    conventions: str
    source: str
    role: str

    @property
    def checked(self) -> bool:
        """Whether ``raceway verify`` computes it."""
        return self.role.startswith("check")


@attrs.frozen
class Number:
    """One computed number beside that of the case, both in the source's unit, with the largest relative error allowed.

    ``computed`` is None when ``note`` says why there is none.
    """

    quantity: str
    reference: float
    computed: float | None
    tolerance: float
    note: str = ""


@cache
def reference_cases() -> dict[str, Case]:
    """All cases by id, in the file's order."""
    text = files("raceway").joinpath("data/cases.json").read_text(encoding="utf-8")
    return {case["id"]: Case(**case) for case in json.loads(text)["cases"]}
