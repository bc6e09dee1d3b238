"""Condensed bodies: everything that must hold, and error against cost: ``python -m benchmarks.condensed [--json]``.

CPU seconds of one thread (set OMP_NUM_THREADS=1).  The numbers are those of the reports condensed_* of
``python -m benchmarks.evidence``, computed anew; exit code 1 when a row does not hold.
"""

from __future__ import annotations

import argparse
import json
import sys
from typing import Any

import attrs

from benchmarks.evidence import Row, names, report
from benchmarks.evidence._files import shown
from benchmarks.evidence.condensed_cost import table

#: Reports whose rows belong here; the table of error against cost has its own form.
COST = "condensed_cost"


def measure() -> dict[str, Any]:
    """``rows`` by report, and ``table``: error against cost on one scene."""
    reports = [name for name in names() if name.startswith("condensed_") and name != COST]
    rows = {name: [attrs.asdict(row) for row in report(name).rows()] for name in reports}
    return {"rows": rows, "table": table()}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", action="store_true", help="machine-readable")
    as_json = parser.parse_args().json
    found = measure()
    bad = [row for rows in found["rows"].values() for row in rows if not row["ok"]]
    if as_json:
        print(json.dumps(found, indent=1))
        return 1 if bad else 0
    for name, rows in found["rows"].items():
        print(f"\n{report(name).TITLE}")
        for row in (Row(**r) for r in rows):
            print(
                f"  {'holds' if row.ok else 'FAILS'}  {row.quantity}: {shown(row.value)} ({row.limit}) {row.note}".rstrip()
            )
    print(f"\n{report(COST).TITLE}\n  {'':44s}{'error x, y':>11s}{'stiffness':>11s}{'set-up s':>10s}{'solve s':>10s}")
    for line in found["table"]:
        error = "".join(
            f"{'-' if line[k] is None else f'{100 * line[k]:.3g} %':>11s}" for k in ("displacement", "stiffness")
        )
        cost = "".join(f"{'-' if line[k] is None else f'{line[k]:.3g}':>10s}" for k in ("set_up_s", "solve_s"))
        print(f"  {line['setting']:44s}{error}{cost}  {line['note']}".rstrip())
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
