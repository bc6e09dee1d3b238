"""``raceway verify``: reference cases against this program's own numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from math import isfinite

import attrs

from raceway.errors import Mistake, RacewayError, SceneError
from raceway.framework.options import nearest
from raceway.framework.registry import Registry, default_registry
from raceway.points.engine import BASES, Case, Number, reference_cases
from raceway.storage.tables import Tables
from raceway.studies.verify.cases import (
    article_pressures,
    ellipse_table,
    impact_of_spheres,
    masta,
    nsk_pair,
    race_ellipse,
    rig_force,
)

OnProgress = Callable[[str, int, int], None]

#: How each case is computed.
COMPUTED: dict[str, Callable[[Case, Registry], Iterator[Number]]] = {
    "masta-dgbb-1": masta, "masta-dgbb-3": masta, "masta-dgbb-5": masta,
    "harris-mindel-1973-hertz-inner": race_ellipse, "harris-table-6.1": ellipse_table,
    "nsk-7206C-stiffness": nsk_pair, "nsk-7206A-stiffness": nsk_pair,
    "chung-ooi-1-glass": impact_of_spheres, "chung-ooi-3-alumina": impact_of_spheres,
    "seed-unbalance": rig_force, "seed-static-pressures": article_pressures,
}  # fmt: skip


@attrs.frozen
class Row:
    """One line of the table.

    Attributes
    ----------
    case, quantity : which number, with its unit
    reference, computed : in the unit of the source
    error : |computed / reference - 1|;  tolerance : largest error allowed;  ok : whether it is kept
    source : where the case, or its inputs, were published
    basis : where the reference comes from, a key of ``reference.BASES``
    note : why there is no computed number (then computed and error are None, and ok is False), or ""
    """

    case: str
    quantity: str
    reference: float | None
    computed: float | None
    error: float | None
    tolerance: float | None
    ok: bool
    source: str
    basis: str
    note: str = ""


@attrs.frozen
class Verification:
    """The rows of all cases that were computed."""

    rows: tuple[Row, ...]

    @property
    def passed(self) -> bool:
        """Whether every row keeps its tolerance (and there is at least one)."""
        return bool(self.rows) and all(row.ok for row in self.rows)

    @property
    def kept(self) -> dict[str, dict[str, int]]:
        """By basis how many numbers are within their tolerance, of how many."""
        rows = {basis: [row.ok for row in self.rows if row.basis == basis] for basis in BASES}
        return {basis: {"within": sum(ok), "of": len(ok)} for basis, ok in rows.items() if ok}

    @property
    def worst(self) -> tuple[Row, ...]:
        """Of each case the row that comes closest to its tolerance, or misses it by most."""
        cases = dict.fromkeys(row.case for row in self.rows)
        return tuple(max((row for row in self.rows if row.case == case), key=_strain) for case in cases)

    def to_dict(self) -> Tables:
        return {"passed": self.passed, "kept": self.kept, "rows": [attrs.asdict(row) for row in self.rows]}


def _strain(row: Row) -> float:
    return float("inf") if row.error is None or not row.tolerance else row.error / row.tolerance


def verify(
    only: str | Iterable[str] | None = None, on_progress: OnProgress | None = None, registry: Registry | None = None
) -> Verification:
    """Compute the cases, each within the agreement that its source allows.

    Parameters
    ----------
    only : id of one case, or several; all cases to be checked when None
    on_progress : called as ``on_progress(case, done, total)`` before each case and once at the end
    registry : whose integrators the impacts are run with

    Raises
    ------
    SceneError
        A case that does not exist (with the nearest name) or that is there for information only.
    """
    registry = registry or default_registry()
    cases, rows, tell = _cases(only), list[Row](), on_progress or (lambda *_: None)
    for number, case in enumerate(cases):
        tell(case.id, number, len(cases))
        rows += compute(case, registry)
    tell("", len(cases), len(cases))
    return Verification(tuple(rows))


def _cases(only: str | Iterable[str] | None) -> list[Case]:
    """The cases to compute, in the file's order."""
    every = reference_cases()
    checked = {name: case for name, case in every.items() if case.checked}
    names = list(checked) if only is None else [only] if isinstance(only, str) else list(only)
    faults = []
    for name in names:
        if name not in checked:
            why = f"no such case{nearest(str(name), checked)}; known"
            why = f"is not computed: {every[name].role}; computed are" if name in every else why
            faults.append(Mistake("only", name, f"{why}: {', '.join(checked)}"))
    if faults:
        raise SceneError(faults)
    return [case for name, case in checked.items() if name in names]


def compute(case: Case, registry: Registry) -> list[Row]:
    """The rows of one case; a solver that fails makes a row that says why."""
    rows: list[Row] = []
    try:
        for number in COMPUTED[case.id](case, registry):
            rows.append(_row(case, number))
    except RacewayError as why:
        rows.append(Row(case.id, "the rest of the case", None, None, None, None, False, case.source, case.basis, str(why)))
    return rows


def _row(case: Case, number: Number) -> Row:
    computed, note = number.computed, number.note
    if computed is not None and not isfinite(computed):
        computed, note = None, f"computed {computed}: not a finite number"
    error = None if computed is None else abs(computed - number.reference) / abs(number.reference)
    ok = error is not None and error <= number.tolerance
    numbers = (number.quantity, number.reference, computed, error, number.tolerance, ok)
    return Row(case.id, *numbers, case.source, case.basis, note)
