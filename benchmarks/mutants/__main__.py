"""``python -m benchmarks.mutants [WORD...]``: try the faults whose file or effect holds one of the words, all without words.

Exit code 1 when a fault survives.
"""

from __future__ import annotations

import sys

from benchmarks.mutants.faults import read_faults
from benchmarks.mutants.trial import trials


def main(words: list[str]) -> int:
    chosen = [fault for fault in read_faults() if not words or any(word in f"{fault.file} {fault.does}" for word in words)]
    survived = 0
    for verdict in trials(chosen, min(2, max(len(chosen), 1))):
        survived += not verdict.caught
        print(
            f"{'caught  ' if verdict.caught else 'SURVIVED'} {verdict.fault.file}: {verdict.fault.does} ({verdict.how})",
            flush=True,
        )
    print(f"{len(chosen) - survived} of {len(chosen)} caught")
    return 1 if survived else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
