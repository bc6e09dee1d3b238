"""Every published reference case that the program is held against: the number of each case nearest its tolerance."""

from __future__ import annotations

from benchmarks.evidence import Row
from raceway.studies.verify.study import verify

TITLE = "Published reference cases"
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
        out.append(
            Row(f"largest relative error against its tolerance: {worst.case}", error, limit, not wrong, COMMAND, note)
        )
    good = sum(row.ok for row in found.rows)
    out.append(Row("numbers within their own tolerance", f"{good} of {len(found.rows)}", "all", found.passed, COMMAND))
    return out
