"""Every reference case that the program is held against: the number of each case nearest its tolerance, by where it comes from."""

from __future__ import annotations

from benchmarks.evidence import Row
from raceway.studies.many.reference import BASES
from raceway.studies.verify.study import verify

TITLE = "Reference cases: published numbers, closed forms, this program by two ways"
COMMAND = "raceway verify --all"


def rows() -> list[Row]:
    found = verify()
    out = []
    for worst in found.worst:
        count = sum(row.case == worst.case for row in found.rows)
        wrong = sum(row.case == worst.case and not row.ok for row in found.rows)
        error = float("nan") if worst.error is None else worst.error
        limit = f"at most {worst.tolerance:g}"
        note = f"{worst.quantity}; {count} numbers in this case, {wrong} outside"
        quantity = f"{BASES[worst.basis]}: largest relative error against its tolerance: {worst.case}"
        out.append(Row(quantity, error, limit, not wrong, COMMAND, note))
    for basis, kept in found.kept.items():
        value, ok = f"{kept['within']} of {kept['of']}", kept["within"] == kept["of"]
        out.append(Row(f"{BASES[basis]} within their own tolerance", value, "all", ok, COMMAND))
    return out
