"""``python -m benchmarks.meaning [NAME...]``: the rows of these modules, or of all; exit code 1 where one does not hold."""

from __future__ import annotations

import sys

from benchmarks.evidence import show
from benchmarks.meaning import names, rows_of

sys.exit(show(sys.argv[1:], names(), rows_of))
