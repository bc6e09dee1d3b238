"""``python -m checks [NAME...]``: the rows of these checks, or of all; exit code 1 where one does not hold."""

import argparse
import os
import sys
from importlib import import_module

from checks.robustness import Row, names, show


def rows_of(name: str) -> list[Row]:
    options = {"base": arguments.base} if name == "unchanged" else {}
    rows: list[Row] = import_module(f"checks.robustness.{name}").rows(**options)
    return rows


parser = argparse.ArgumentParser(prog="python -m checks", description=__doc__)
parser.add_argument("names", nargs="*", metavar="NAME")
parser.add_argument("--base", default="", metavar="COMMIT", help="commit that `unchanged` compares with [the last tag]")
arguments = parser.parse_args()
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as the command line has it; read when numpy is imported
sys.exit(show(arguments.names, names(), rows_of))
