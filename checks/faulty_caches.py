"""Files of compiled kernels and kept compliances, damaged and used.  ``python -m checks.faulty_caches kernels|arrays [COUNT]``.

A process of its own for each: it loads no kernel before its children do, each of which reads one damaged cache.
"""

import json
import os
import random
import shutil
import sys
import tempfile
import warnings
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import scipy.optimize  # noqa: F401  # what a run imports, for all children at once

from checks.children import in_child
from checks.validation import harm
from raceway.core import jit

SAME, TOLD = "the same numbers", "the same numbers and a message of one line a file"
_SCENE = {
    "title": "cache", "bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0},
    "excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 3.2e-4},
    "integrator": {"kind": "newmark", "turns": 1},
}  # fmt: skip
_CONDENSED = {"title": "cache", "bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}, "bodies": {"kind": "condensed"}}
#: A try with all kernels of a run costs what compiling some of them does: of the kernels' tries, one in so many.
_RUNS = 15


def _beside(function: harm.Harm, suffix: str) -> harm.Harm:
    """The same harm to a file and to the one beside it, or to that alone."""

    def done(path: Path, other: Path, chance: random.Random) -> None:
        if not suffix:
            function(path, other, chance)
        beside, others = (file.with_name(f"{file.name}.digest") for file in (path, other))
        if beside.is_file() and others.is_file():
            function(beside, others, chance)

    return done


def _folder_instead(path: Path, other: Path, chance: random.Random) -> None:
    path.unlink()
    path.mkdir()


def _missing(path: Path, other: Path, chance: random.Random) -> None:
    path.unlink()


HARMS: dict[str, harm.Harm] = {
    "cut": harm.cut,
    "empty": harm.emptied,
    "zeros": harm.zeroed,
    "zeros to the end": harm.zeroed_tail,
    "page of zeros": harm.zeroed_page,
    "one bit": harm.flipped,
    "swapped with another": harm.another,
    "swapped with another, digest and all": _beside(harm.another, ""),
    "foreign": harm.no_such_file,
    "missing": _missing,
    "a folder instead": _folder_instead,
    "digest of another": _beside(harm.another, ".digest"),
}


def three_kernels() -> list[float]:
    """Force, slope and the rate's, of the three smallest laws."""
    from raceway.extend import linear, square, three_halves

    found, none = [], np.zeros((1, 0))
    for law in (three_halves, square, linear):
        out = [np.empty(1) for _ in range(3)]
        law(np.array([-4e-6]), np.zeros(1), np.array([[1e9]]), none, none, 0.0, *out)
        found += [float(value[0]) for value in out]
    return found


def run_of(tables: dict[str, Any]) -> list[float]:
    """Tangent and dynamic stiffness of a scene."""
    from raceway import scene_from_dict
    from raceway.extend import run

    result = run(scene_from_dict(tables))
    found = [float(value) for value in np.ravel(result.to_dict()["equilibrium"]["stiffness"])]
    if result.identification is not None:
        z = complex(result.identification.dynamic_stiffness)
        found += [z.real, z.imag]
    return found


def used(work: Callable[..., list[float]], given: tuple[Any, ...], root: Path) -> tuple[list[str], list[str]]:
    """Bits of the numbers, with warnings, that the work gives with this cache folder."""
    os.environ["RACEWAY_CACHE_DIR"] = str(root)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = work(*given)
    return [value.hex() for value in found], sorted({str(warning.message) for warning in caught})


def tried(
    work: Callable[..., list[float]], given: tuple[Any, ...], files: str, count: int, most: int, seed: int
) -> Counter[str]:
    """Outcomes of ``count`` tries, in each of which one to ``most`` of the cache's files are harmed."""
    chance, found = random.Random(seed), Counter[str]()
    with tempfile.TemporaryDirectory() as folder:
        whole = Path(folder) / "whole"
        first = in_child(used, work, given, whole, limit_s=300.0)
        second = in_child(used, work, given, whole)
        if isinstance(first, str) or second != first:
            raise RuntimeError(f"without harm: {first}, {second}")
        names = sorted(path.relative_to(whole) for path in whole.rglob(files) if path.is_file())
        for k in range(count):
            root = Path(folder) / f"c{k}"
            shutil.copytree(whole, root)
            name = list(HARMS)[k % len(HARMS)]
            harmed = chance.sample(names, chance.randint(1, most))
            for file in harmed:
                other = chance.choice([one for one in names if one != file and one.suffix == file.suffix] or [file])
                HARMS[name](root / file, whole / other, chance)
            outcome = _word(in_child(used, work, given, root), first[0], len(harmed))
            found[outcome if outcome in (SAME, TOLD) else f"{name}: {outcome}"] += 1
            shutil.rmtree(root)
    return found


def _word(answer: Any, numbers: list[str], harmed: int) -> str:
    if isinstance(answer, str):
        return answer
    found, told = answer
    if found != numbers:
        return f"other numbers: {found[:2]}"
    if len(told) > harmed or any("\n" in message for message in told):
        return f"messages: {told}"
    return TOLD if told else SAME


def kernels(count: int = 150, seed: int = 17) -> dict[str, int]:
    """Outcomes with files of compiled kernels: three small ones, now and then all of a run."""
    few = tried(three_kernels, (), "*.nb[ic]", count - count // _RUNS, 3, seed)
    return few + tried(run_of, (_SCENE,), "*.nb[ic]", count // _RUNS, 1, seed + 1)


def arrays(count: int = 50, seed: int = 19) -> dict[str, int]:
    """Outcomes with kept compliances of condensed bodies, whose kernels are whole."""
    from raceway.extend import run  # noqa: F401  # the command itself, for the same reason: each child would import it anew

    return tried(run_of, (_CONDENSED,), "*.arrays", count, 2, seed)


if __name__ == "__main__":
    if jit.clock["loaded"] + jit.clock["compiled"]:
        raise RuntimeError("kernels are loaded already: the children would not read theirs")
    print(json.dumps({"kernels": kernels, "arrays": arrays}[sys.argv[1]](*map(int, sys.argv[2:])), indent=1))
