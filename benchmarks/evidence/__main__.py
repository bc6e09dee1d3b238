"""``python -m benchmarks.evidence [NAME...]``: compute reports, write them, refresh the documents."""

from __future__ import annotations

import argparse
import os
import sys
import time

# One thread of linear algebra, as the commands take; read when numpy is imported, which is later than this.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from benchmarks.evidence import Row, _age, _files, names, report
from benchmarks.evidence._kept import EARLIER

_EPILOG = """\
A report carries a digest of the areas of the package that it measures (benchmarks/evidence/_areas.py), of its own module, and of
what that imports from benchmarks and tests.  When they change, a test fails: make the report again, or list it as older than the
code with --list and a reason; README shows the mark beside it.  Making a report takes it off the list.

examples:
  python -m benchmarks.evidence tangent orders        compute and write two reports
  python -m benchmarks.evidence --older               which reports are older than their code, and why they stand
  python -m benchmarks.evidence --list "elastic bodies are being changed"
  python -m benchmarks.evidence --check tangent       does each row hold as it did when the report was made?

exit code: 1 when a row does not hold, when --older finds a report that its list does not tell right, or when --check finds
another verdict; 2 for a name that does not exist.
"""


def main(words: list[str]) -> int:
    asked = _parser().parse_args(words)
    unknown = [name for name in asked.names if name not in names()]
    if unknown:
        print(f"no report is called {', '.join(unknown)}; there are {', '.join(names())}", file=sys.stderr)
        return 2
    if asked.older:
        return older()
    if asked.reason:
        reports = _files.read()
        outdated = _age.out_of_date(reports)
        _age.put_on_list([name for name in outdated if name not in _age.listed()], asked.reason)
    elif asked.check:
        return max([check(name) for name in asked.names or names()])
    elif not asked.render:
        return max([make(name) for name in asked.names or names()])
    _refresh()
    return 0


def make(name: str) -> int:
    """Compute a report and write it; 1 when a row does not hold."""
    digest = _age.digest(name)
    start = time.perf_counter()
    module = report(name)
    rows = module.rows()
    data = _files.write(name, module.TITLE, rows, time.perf_counter() - start + EARLIER.get(name, 0.0), digest)
    _age.take_off_list([name])
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


def older() -> int:
    """Print the reports that are older than their code; 1 when the list of them is not right."""
    outdated, listed = _age.out_of_date(_files.read()), _age.listed()
    for name in outdated:
        print(f"{name}: {listed.get(name, 'NOT LISTED: make it again, or list it with --list REASON')}")
    for name in listed:
        if name not in outdated:
            print(f"{name}: LISTED, BUT UP TO DATE: remove it from {_age.LISTED.relative_to(_age.ROOT)}")
    print(f"{len(outdated)} of {len(names())} reports are older than their code")
    return 1 if set(outdated) != set(listed) else 0


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
    instead.add_argument("--older", action="store_true", help="tell which reports are older than their code")
    instead.add_argument(
        "--list", dest="reason", metavar="REASON", help="list all reports that are now older than their code"
    )
    return parser


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
