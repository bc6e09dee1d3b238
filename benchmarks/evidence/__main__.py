"""``python -m benchmarks.evidence [NAME...]``: compute reports, write them, refresh the documents."""

from __future__ import annotations

import argparse
import os
import sys
import time

# One thread of linear algebra, as the commands take; read when numpy is imported, which is later than this.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import attrs

from benchmarks.evidence import Row, _files, names, report
from benchmarks.evidence._kept import EARLIER

_EPILOG = """\
examples:
  python -m benchmarks.evidence article article_mesh  compute and write two reports, of a clean commit
  python -m benchmarks.evidence --check article      does each row hold as it did when the report was made?
  pytest --evidence tests/evidence/test_rigid.py      of reports that are tests

exit code: 1 when a row does not hold, or when --check finds another verdict; 2 for a name that does not exist, or uncommitted changes.
"""


def main(words: list[str]) -> int:
    asked = _parser().parse_args(words)
    unknown = [name for name in asked.names if name not in names()]
    if unknown:
        print(f"no report is called {', '.join(unknown)}; there are {', '.join(names())}", file=sys.stderr)
        return 2
    if asked.check:
        return max([check(name) for name in asked.names or names()])
    if not asked.render:
        if _files.commit() is None:
            print("a report is made of a commit: there are uncommitted changes, or there is no repository", file=sys.stderr)
            return 2
        return max([make(name) for name in asked.names or names()])
    _refresh()
    return 0


def make(name: str) -> int:
    """Compute a report and write it; 1 when a row does not hold."""
    start = time.perf_counter()
    module = report(name)
    rows = module.rows()
    seconds = time.perf_counter() - start + EARLIER.get(name, 0.0)
    data = _files.write(
        name, module.TITLE, [attrs.asdict(row) for row in rows], seconds, f"python -m benchmarks.evidence {name}"
    )
    failed = [row for row in rows if not row.ok]
    print(f"{name}: {len(rows) - len(failed)} of {len(rows)} rows hold, {data['seconds']} s", flush=True)
    for row in failed:
        print(f"  does not hold: {row.quantity} = {_files.shown(row.value)}, limit {row.limit}. {row.note}")
    _refresh()
    return 1 if failed else 0


def check(name: str) -> int:
    """Compute a report without writing it; 1 when a row holds that did not, or the other way round, or is not in the report."""
    start = time.perf_counter()
    differences = other_verdicts(_files.read()[name]["rows"], report(name).rows())
    print(f"{name}: {len(differences)} rows other than in the report, {time.perf_counter() - start:.1f} s", flush=True)
    for line in differences:
        print(f"  {line}")
    return 1 if differences else 0


def other_verdicts(before: list[dict[str, object]], now: list[Row]) -> list[str]:
    """Rows whose verdict changed, or that only one of two makings of a report has."""
    old, new = {row["quantity"]: row["ok"] for row in before}, {row.quantity: row for row in now}
    lines = [f"no longer there: {quantity}" for quantity in old if quantity not in new]
    for quantity, row in new.items():
        if quantity not in old:
            lines.append(f"not in the report: {quantity}")
        elif row.ok != old[quantity]:
            held = "holds, did not" if row.ok else "does not hold, did"
            lines.append(f"{held}: {quantity} = {_files.shown(row.value)}, limit {row.limit}. {row.note}")
    return lines


def _refresh() -> None:
    for path in _files.refresh():
        print(f"refreshed {path.relative_to(_files.ROOT)}")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.evidence",
        description="Compute reports, write docs/reports/NAME.json and NAME.md, refresh the tables of README.md and docs.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help="a report; without names all of them")
    instead = parser.add_mutually_exclusive_group()
    instead.add_argument("--render", action="store_true", help="only refresh the documents")
    instead.add_argument(
        "--check", action="store_true", help="compute, write no report, compare each row's verdict with the report's"
    )
    return parser


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
