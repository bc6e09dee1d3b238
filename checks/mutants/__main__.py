"""``python -m checks.mutants [WORD...]``: try the faults whose file or effect holds one of the words, all without words.

Two at a time, each in a copy of its own.  Exit code 1 when a fault survives, or when its tests fail without it.  ``--check`` only
compares the table with the sources.
"""

import argparse
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from checks.mutants.faults import TABLE, Fault, chosen
from checks.mutants.trial import QUICK, Verdict, copied


def main(words: list[str]) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m checks.mutants", description="Faults of one line: do the tests catch them?"
    )
    parser.add_argument(
        "words", nargs="*", metavar="WORD", help="try the faults whose file or effect holds it; all without words"
    )
    parser.add_argument("--list", action="store_true", help="only show the faults")
    parser.add_argument("--check", action="store_true", help="only show the faults that no longer fit the sources")
    parser.add_argument("--quick", action="store_true", help=f"with the tests that `make test` runs: {QUICK}")
    parser.add_argument("--table", type=Path, default=TABLE, help="a file of other faults: checks/mutants/stranger.toml")
    options = parser.parse_args(words)
    faults = chosen(options.words, options.table)
    if options.check:
        misplaced = [why for fault in faults if (why := fault.misplaced())]
        print("\n".join([*misplaced, f"{len(faults) - len(misplaced)} of {len(faults)} fit the sources"]))
        return 1 if misplaced else 0
    if options.list:
        for fault in faults:
            print(f"{fault.file}: {fault.does} ({', '.join(fault.tests)})")
        return 0
    with ThreadPoolExecutor() as pool:
        parts = list(pool.map(lambda part: tried(part, options.quick), (faults[::2], faults[1::2])))
    survived = [verdict for part in parts for verdict in part if not verdict.caught]
    for verdict in survived:
        _show(verdict)
    print(f"{len(faults) - len(survived)} of {len(faults)} caught")
    return 1 if survived else 0


def tried(faults: list[Fault], quick: bool) -> list[Verdict]:
    """Verdicts on faults, put into a copy of the sources one after another; shown as they come.

    Raises
    ------
    SystemExit
        A test fails without any fault.
    """
    verdicts = []
    with copied() as copy:
        if failing := copy.unharmed(faults, quick):
            sys.exit(f"fails without any fault: {failing}")
        for fault in faults:
            verdicts.append(copy.trial(fault, quick))
            _show(verdicts[-1])
    return verdicts


def _show(verdict: Verdict) -> None:
    word, fault = "caught  " if verdict.caught else "SURVIVED", verdict.fault
    print(f"{word} {fault.file}: {fault.does} ({verdict.how})", flush=True)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
