"""``raceway verify``: reference cases against this program's own numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import ClassVar

import attrs

from raceway.errors import Mistake, RacewayError, SceneError
from raceway.framework.options import nearest
from raceway.framework.registry import Registry, default_registry
from raceway.framework.shown import Fact, number
from raceway.out.answer import Answer, Part
from raceway.out.table import micro
from raceway.out.wrapping import Words
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


#: Columns of numbers and their significant digits.
_DIGITS = {"reference": 5, "computed": 5, "error": 2, "tolerance": 2}
#: Cases of which every number is shown: the pressures of the article, load by load, with their mesh independence.
_IN_FULL = ("seed-static-pressures",)


@attrs.frozen(eq=False, repr=False, slots=False)
class Verification(Answer):
    """The rows of all cases that were computed; ``every``: whether a screen shows all of them."""

    stem: ClassVar[str] = "verify"

    rows: tuple[Row, ...]
    every: bool = False

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

    def _counts(self) -> list[str]:
        return [f"{count['within']} of {count['of']} {BASES[basis]}" for basis, count in self.kept.items()]

    def _shown(self) -> tuple[str, list[Fact]]:
        misses: list[Fact] = [("off", row.case, f"{row.quantity} {row.note}") for row in self.rows if not row.ok]
        return "Reference cases", [("within their tolerance", "", words) for words in self._counts()] + misses

    def report(self) -> Iterator[Part]:
        """Of each case the worst number and all that are off, or ``every`` one."""
        worst = self.worst
        rows = [row for row in self.rows if self.every or not row.ok or row.case in _IN_FULL or row in worst]
        yield [
            {
                "number": f"{row.case}: {micro(row.quantity)}",
                **{name: number(getattr(row, name), "", digits) for name, digits in _DIGITS.items()},
                "verdict": "ok" if row.ok else f"off {row.note}",
            }
            for row in rows
        ]
        yield Words(f"within their tolerance: {', '.join(self._counts())}", "green" if self.passed else "red")


def _strain(row: Row) -> float:
    return float("inf") if row.error is None or not row.tolerance else row.error / row.tolerance


def verify(
    only: str | Iterable[str] = (),
    every: bool = False,
    *,
    registry: Registry | None = None,
    progress: OnProgress | None = None,
) -> Verification:
    """Compute reference cases; exit code 1 when a number misses its tolerance.

    Published numbers, closed forms, and this program by two ways are counted apart.

    Parameters
    ----------
    only : one case instead of all
    every : show every number, not only the worst of each case
    registry : whose integrators the impacts are run with
    progress : called as ``progress(case, done, total)`` before each case and once at the end

    Raises
    ------
    SceneError
        A case that does not exist (with the nearest name) or that is there for information only.
    """
    registry = registry or default_registry()
    cases, rows, report = _cases(only), list[Row](), progress or (lambda *_: None)
    for count, case in enumerate(cases):
        report(case.id, count, len(cases))
        rows += compute(case, registry)
    report("", len(cases), len(cases))
    return Verification(tuple(rows), every)


def _cases(only: str | Iterable[str]) -> list[Case]:
    """The cases to compute, in the file's order."""
    cases = reference_cases()
    checked = {name: case for name, case in cases.items() if case.checked}
    names = ([only] if isinstance(only, str) else list(only)) or list(checked)
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
