"""``python -m benchmarks.evidence [NAME...]``: compute reports, write them, refresh the documents.

Exit code 1 when a row does not hold, 2 for a name that does not exist.  ``--render`` only refreshes the documents.
"""

from __future__ import annotations

import sys
import time

from benchmarks.evidence import _files, names, report
from benchmarks.evidence._kept import EARLIER


def main(words: list[str]) -> int:
    only_render = "--render" in words
    asked = [word for word in words if word != "--render"]
    unknown = [word for word in asked if word not in names()]
    if unknown:
        print(f"no report is called {', '.join(unknown)}; there are {', '.join(names())}", file=sys.stderr)
        return 2
    bad = 0
    for name in [] if only_render else asked or names():
        start = time.perf_counter()
        module = report(name)
        rows = module.rows()
        data = _files.write(name, module.TITLE, rows, time.perf_counter() - start + EARLIER.get(name, 0.0))
        failed = [row for row in rows if not row.ok]
        bad += len(failed)
        print(f"{name}: {len(rows) - len(failed)} of {len(rows)} rows hold, {data['seconds']} s", flush=True)
        for row in failed:
            print(f"  does not hold: {row.quantity} = {_files.shown(row.value)}, limit {row.limit}. {row.note}")
    for path in _files.refresh():
        print(f"refreshed {path.relative_to(_files.ROOT)}")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
