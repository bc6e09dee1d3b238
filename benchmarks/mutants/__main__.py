"""``python -m benchmarks.mutants [WORD...]``: try the faults whose file or effect holds one of the words, all without words.

Exit code 1 when a fault survives, or when its tests fail without it.
"""

from __future__ import annotations

import argparse
import sys

from benchmarks.mutants.faults import chosen
from benchmarks.mutants.kept import tried
from benchmarks.mutants.trial import Verdict


def main(words: list[str]) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.mutants", description="Faults of one line: do the tests catch them?"
    )
    parser.add_argument(
        "words", nargs="*", metavar="WORD", help="try the faults whose file or effect holds it; all without words"
    )
    parser.add_argument("--list", action="store_true", help="only show the faults")
    asked = parser.parse_args(words)
    faults = chosen(asked.words)
    if asked.list:
        for fault in faults:
            print(f"{fault.file}: {fault.does} ({', '.join(fault.tests)})")
        return 0
    failing, verdicts = tried(faults, _show)
    if failing:
        print(f"fails without any fault: {failing}")
        return 1
    survived = sum(not verdict.caught for verdict in verdicts)
    print(f"{len(faults) - survived} of {len(faults)} caught")
    return 1 if survived else 0


def _show(verdict: Verdict) -> None:
    word, fault = "caught  " if verdict.caught else "SURVIVED", verdict.fault
    print(f"{word} {fault.file}: {fault.does} ({verdict.how}; {verdict.seconds:.0f} CPU-s)", flush=True)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
