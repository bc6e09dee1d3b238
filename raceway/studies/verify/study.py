"""``raceway verify``: reference cases against this program's own numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import attrs

from raceway.errors import Mistake, RacewayError, SceneError
from raceway.framework.options import nearest
from raceway.framework.registry import Registry, default_registry
from raceway.storage.tables import Tables
from raceway.studies.verify.cases import (
    Rows,
    article_pressures,
    ellipse_table,
    impact_of_spheres,
    masta,
    nsk_pair,
    race_ellipse,
    rig_force,
)
from raceway.studies.verify.reference import BASES, Case, Row, reference_cases

OnProgress = Callable[[str, int, int], None]

#: How each case is computed.
COMPUTED: dict[str, Callable[[Case, Registry], Rows]] = {
    "masta-dgbb-1": masta, "masta-dgbb-3": masta, "masta-dgbb-5": masta,
    "harris-mindel-1973-hertz-inner": race_ellipse, "harris-table-6.1": ellipse_table,
    "nsk-7206C-stiffness": nsk_pair, "nsk-7206A-stiffness": nsk_pair,
    "chung-ooi-1-glass": impact_of_spheres, "chung-ooi-3-alumina": impact_of_spheres,
    "seed-unbalance": rig_force, "seed-static-pressures": article_pressures,
}  # fmt: skip


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
    cases, rows, report = _cases(only), list[Row](), on_progress or (lambda *_: None)
    for number, case in enumerate(cases):
        report(case.id, number, len(cases))
        rows += compute(case, registry)
    report("", len(cases), len(cases))
    return Verification(tuple(rows))


def _cases(only: str | Iterable[str] | None) -> list[Case]:
    """The cases to compute, in the file's order."""
    cases = reference_cases()
    checked = {name: case for name, case in cases.items() if case.checked}
    names = list(checked) if only is None else [only] if isinstance(only, str) else list(only)
    faults = []
    for name in names:
        if name not in checked:
            why = f"no such case{nearest(str(name), checked)}; known"
            why = f"is not computed: {cases[name].role}; computed are" if name in cases else why
            faults.append(Mistake("only", name, f"{why}: {', '.join(checked)}"))
    if faults:
        raise SceneError(faults)
    return [case for name, case in checked.items() if name in names]


def compute(case: Case, registry: Registry) -> list[Row]:
    """The rows of one case; a solver that fails makes a row that says why."""
    rows: list[Row] = []
    try:
        for row in COMPUTED[case.id](case, registry):
            rows.append(row)
    except RacewayError as why:
        rows.append(case.row("the rest of the case", None, None, None, str(why)))
    return rows
