"""``python -m checks.mutants [WORD...]``: try the faults whose file or effect holds one of the words, all without words.

Two at a time, each in a copy of its own.  Exit code 1 when a fault survives, or when its tests fail without it.  ``--check`` only
compares the table with the sources.
"""

import argparse
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from checks.mutants.faults import TABLE, Fault, chosen
from checks.mutants.trial import QUICK, Verdict, copied

#: Tests without a fault run in so many processes, one after another in each copy.
PARTS = 12


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
    verdicts = tried(faults, options.quick)
    survived = [verdict for verdict in verdicts if not verdict.caught]
    for verdict in survived:
        _shown(verdict)
    print(f"{len(faults) - len(survived)} of {len(faults)} caught")
    return 1 if survived else 0


def tried(faults: list[Fault], quick: bool) -> list[Verdict]:
    """Verdicts on faults, each put into one of two copies of the sources; shown as they come; SystemExit: a test fails without any."""
    tests = sorted({test for fault in faults for test in fault.tests})
    files = sorted({test.partition("::")[0] for test in tests})
    parts = iter(
        [[test for test in tests if test.partition("::")[0] in files[k::PARTS]] for k in range(min(PARTS, len(files)))]
    )
    waiting = iter(faults)
    with (
        tempfile.TemporaryDirectory() as folder,
        ThreadPoolExecutor() as pool,
        copied(Path(folder)) as one,
        copied(Path(folder), 1) as other,
    ):
        both = one, other  # which take from one iterator
        failing = pool.map(lambda copy: [why for part in parts if (why := copy.unharmed(part, quick))], both)
        if why := [why for half in failing for why in half]:
            sys.exit(f"fails without any fault: {why[0]}")
        shown = pool.map(lambda copy: [_shown(copy.trial(fault, quick)) for fault in waiting], both)
        return [verdict for half in shown for verdict in half]


def _shown(verdict: Verdict) -> Verdict:
    word, fault = "caught  " if verdict.caught else "SURVIVED", verdict.fault
    print(f"{word} {fault.file}: {fault.does} ({verdict.how})", flush=True)
    return verdict


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
