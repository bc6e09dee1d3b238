"""Plug-ins swapped by one word: nothing is compiled anew, and what composing costs."""

from __future__ import annotations

from benchmarks.evidence import Row, below
from benchmarks.swapped import in_a_process

TITLE = "Plug-ins swapped by one word"
COUNT, COST = "python -m benchmarks.swapped count", "python -m benchmarks.swapped cost"
#: Asked for: composing costs at most 5 %, and changes nothing beyond rounding.
LIMIT, SAME = 1.05, 1e-12


def rows() -> list[Row]:
    in_a_process("count")  # fills the cache: the second process is the one that counts
    out = []
    for row in in_a_process("count"):
        out.append(below(f"kernels that a second process compiles after `{row['word']}`", row["compiled"], 0, COUNT))
        name = f"signatures that the time loops gain by `{row['word']}`"
        out.append(below(name, row["new_signatures"], 0, COUNT))
    for row in in_a_process("cost"):
        note = f"composing costs {100 * (row['ratio'] - 1):.0f} %: kernels are called by address, where the fused loop has them inlined"
        name = f"composed over hand-fused time loop with the penalty law: {row['name']}"
        out.append(below(name, row["ratio"], LIMIT, COST, note))
        name = f"largest relative difference of displacements, the same loops: {row['name']}"
        out.append(below(name, row["deviation"], SAME, COST))
    return out
