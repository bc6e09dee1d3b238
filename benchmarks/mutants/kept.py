"""Verdicts on disk: trials that were cut off go on where they stopped, and an edited test is tried alone.

A verdict counts for the fault, the package, the tests that must catch it and what all tests share.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path

import attrs

from benchmarks.evidence._kept import EARLIER
from benchmarks.mutants.faults import ROOT, Fault
from benchmarks.mutants.trial import Verdict, copied
from raceway.storage.cache_folder import cache_root
from raceway.studies.many.row_store import RowStore


def tried(faults: list[Fault], on_verdict: Callable[[Verdict], None] | None = None) -> tuple[str, list[Verdict]]:
    """What fails of the tests without any fault, or "", and the verdict on each fault; verdicts on disk are not made again."""
    store = RowStore(cache_root() / "evidence" / "mutants.jsonl")
    keys = {fault: _key(fault) for fault in faults}
    found: list[Verdict] = []
    with copied() as copy:
        if failing := copy.unharmed([fault for fault in faults if store.get(keys[fault]) is None]):
            return failing, found
        for fault in faults:
            row = store.get(keys[fault])
            if row is None:
                verdict = copy.trial(fault)
                store.put(keys[fault], attrs.asdict(verdict, filter=lambda field, _: field.name != "fault", recurse=False))
            else:
                verdict = Verdict(fault, **row)
                EARLIER["mutants"] = EARLIER.get("mutants", 0.0) + verdict.seconds
            found.append(verdict)
            if on_verdict is not None:
                on_verdict(verdict)
    return "", found


def _key(fault: Fault) -> str:
    digest = hashlib.sha256(f"{attrs.astuple(fault)} {_shared()}".encode())
    for path in sorted({ROOT / test.partition("::")[0] for test in fault.tests}):
        digest.update(path.read_bytes())
    return digest.hexdigest()


@cache
def _shared() -> str:
    """Of the package, and of what is no test in ``tests`` and ``benchmarks``, less what only makes the trials."""
    digest = hashlib.sha256()
    for path in [
        path for name in ("raceway", "tests", "benchmarks", "validation") for path in sorted((ROOT / name).rglob("*.py"))
    ]:
        if not path.name.startswith("test_") and path.parent != Path(__file__).parent:
            digest.update(path.relative_to(ROOT).as_posix().encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()
