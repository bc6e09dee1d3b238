"""Numbers of ``result.json`` in this tree and at another commit: every scene of ``SCENES``, number by number.

The base commit's results stay in the user's cache folder, so that only the first comparison with a commit computes them.
"""

import hashlib
import json
import math
import os
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

from platformdirs import user_cache_path

from checks.robustness import Row
from checks.validation.all_kinds import SCENES
from raceway.extend import write_whole

#: Relative difference that is allowed: the last digits, should an order of sums have to change.
_LIMIT = 1e-13
#: Parts of a result that depend on the machine and its load.
_UNSTABLE = ("cost", "environment", "plan.predicted_wall_s", "plan.predicted_at_least", "plan.predicted_bytes")
_HERE = Path(__file__).parents[2]


def rows(base: str = "") -> list[Row]:
    """A row for each scene; ``base`` : commit to compare with; the last tag if empty."""
    base = base or _git("describe", "--tags", "--abbrev=0")
    commit = _git("rev-parse", "--verify", "--quiet", f"{base}^{{commit}}") if base else ""
    if not commit:
        return [Row("base commit", base or "no tag", "a commit: --base COMMIT", False, "git log")]
    folder = user_cache_path("raceway-benchmarks", appauthor=False) / "unchanged" / commit
    _export(commit, folder / "tree")
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(partial(_compared, folder), SCENES))


def _git(*words: str) -> str:
    return subprocess.run(["git", *words], cwd=_HERE, capture_output=True, text=True).stdout.strip()


def _export(commit: str, tree: Path) -> None:
    """The sources of a commit, without an entry in the list of work trees."""
    if tree.exists():
        return
    tree.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=tree.parent) as scratch:
        archived = ["git", "archive", f"--output={scratch}/tar", "--prefix=tree/", commit, "raceway"]
        subprocess.run(archived, cwd=_HERE, check=True)
        subprocess.run(["tar", "-xf", f"{scratch}/tar", "-C", scratch], check=True)
        with suppress(OSError):  # another process was quicker
            Path(scratch, "tree").rename(tree)


def _compared(folder: Path, name: str) -> Row:
    scene, *changes = shlex.split(SCENES[name])
    path = _HERE / "examples" / f"{scene}.toml"
    stored = folder / f"{name}-{hashlib.sha256((path.read_text() + SCENES[name]).encode()).hexdigest()[:12]}.json"
    if not stored.exists():
        write_whole(json.dumps(_result(folder / "tree", path, changes)).encode(), stored)
    before, after = (dict(_numbers(result)) for result in (json.loads(stored.read_text()), _result(_HERE, path, changes)))
    differing = {key: _difference(number, after.get(key)) for key, number in before.items()}
    largest, added = max(differing.values()), len(after.keys() - before.keys())
    first = next((key for key, difference in differing.items() if difference > 0.0), "")
    note = f"{first}: {before[first]} -> {after.get(first, 'absent')}" if first else "bit for bit"
    note += f", {added} are new" if added else ""
    ok = largest <= _LIMIT and after["exit code"] == 0
    return Row(name, largest, f"at most {_LIMIT:g}", ok, f"{len(before)} numbers, {note}")


def _result(tree: Path, scene: Path, changes: list[str]) -> Any:
    """What ``raceway run`` of a tree writes, in a process of its own; the message where it fails."""
    with tempfile.TemporaryDirectory() as out:
        words = [sys.executable, "-m", "raceway", "run", str(scene), "--out", out, "--patience", "inf"]
        environment = {**os.environ, "PYTHONPATH": str(tree)}
        changed = [word for change in changes for word in ("--set", change)]
        done = subprocess.run([*words, *changed], cwd=tree, env=environment, capture_output=True, text=True)
        written = next((path for file in ("result.json", "failure.json") if (path := Path(out, file)).exists()), None)
        result = json.loads(written.read_text()) if written else {"message": done.stderr[-2000:]}
        return {"exit code": done.returncode, **result}


def _numbers(value: Any, path: str = "") -> Iterator[tuple[str, float | None]]:
    """Path and value of every number, flag and null."""
    if path in _UNSTABLE:
        return
    if isinstance(value, dict | list):
        for key, item in value.items() if isinstance(value, dict) else enumerate(value):
            yield from _numbers(item, f"{path}.{key}" if path else str(key))
    elif not isinstance(value, str):
        yield path, value


def _difference(before: float | None, after: float | None) -> float:
    """Relative difference; infinite where only one of the two is a number."""
    if before == after:
        return 0.0
    return math.inf if before is None or after is None else abs(after - before) / max(abs(before), abs(after))
