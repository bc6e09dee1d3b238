"""Damaged stores of sweeps, gone on with; damaged kernels and compliances, used: the same numbers or one message."""

from __future__ import annotations

import json
import subprocess
import sys
from collections import Counter
from concurrent.futures import ThreadPoolExecutor

from checks import damaged_stores
from checks.faulty_caches import SAME, TOLD
from checks.robustness import Row, below

_STORES, _KERNELS, _ARRAYS = 150, 150, 50
#: Damages after which a store goes on: what is not as it was written is computed again.
_MENDED = ("two rows swapped", "row of another store", "digit of a value", "another file's journal")


def rows() -> list[Row]:
    with ThreadPoolExecutor(2) as pool:
        caches = [pool.submit(_caches, "kernels", _KERNELS), pool.submit(_caches, "arrays", _ARRAYS)]
        kernels, arrays = (one.result() for one in caches)
    return [*_stores(), *_of_caches("files of compiled kernels", "kernels", kernels, _KERNELS),
            *_of_caches("kept compliances", "arrays", arrays, _ARRAYS)]  # fmt: skip


def _stores() -> list[Row]:
    command = f"python -m checks.damaged_stores {_STORES}"
    found = damaged_stores.tried(_STORES)
    every = sum(found.values(), Counter[str]())
    equal, told = every[damaged_stores.EQUAL], every[damaged_stores.TOLD]
    other = sum(count for outcome, count in every.items() if outcome.startswith("other values"))
    note = f"{len(damaged_stores.HARMS)} damages: {', '.join(damaged_stores.HARMS)}"
    mended = sum((found[name] for name in _MENDED), Counter[str]())
    tries = mended.total()
    return [
        below(f"damaged stores, {every.total()}: silently other values", other, 0, command, note),
        below("of these, other ends than the same rows or one message: tracebacks, signals, hangs",
              every.total() - equal - told - other, 0, command, f"{equal} the same rows bit for bit, {told} one message"),
        Row("of these, rows that were swapped, foreign or edited, and a foreign journal: the same rows again",
            f"{mended[damaged_stores.EQUAL]} of {tries}", "all", mended[damaged_stores.EQUAL] == tries, command),
    ]  # fmt: skip


def _caches(part: str, count: int) -> Counter[str]:
    """In a process that has loaded no kernel."""
    words = [sys.executable, "-m", "checks.faulty_caches", part, str(count)]
    return Counter(json.loads(subprocess.run(words, capture_output=True, text=True, check=True).stdout))


def _of_caches(words: str, part: str, found: Counter[str], count: int) -> list[Row]:
    bad = {outcome: times for outcome, times in found.items() if outcome not in (SAME, TOLD)}
    signals = sum(times for outcome, times in bad.items() if "ended by" in outcome)
    command = f"python -m checks.faulty_caches {part} {count}"
    note = "; ".join(bad) or f"{found[SAME]} in silence, {found[TOLD]} with a message of one line a file"
    return [
        below(f"{words}, {found.total()} tries: other ends than the same numbers, in silence or with a message",
              found.total() - found[SAME] - found[TOLD], 0, command, note),
        below(f"{words}: ended by a signal", signals, 0, command),
    ]  # fmt: skip
