"""Damaged stores of sweeps, gone on with: the same numbers or one message."""

import multiprocessing
import random
import shutil
import signal
import sqlite3
import tempfile
from collections import Counter
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

from checks.robustness import Row, below
from checks.validation.sweeps import SCENE, rows_of
from raceway import RacewayError
from raceway.extend import open_store
from raceway.points.store import POINTS, SCHEMA

_STORES, _PAGE = 150, 4096
Harm = Callable[[Path, Path, random.Random], None]
#: Damages after which a store goes on: what is not as it was written is computed again.
_MENDED = ("two rows swapped", "row of another store", "digit of a value", "another file's journal")
#: What is acceptable: rows as undisturbed, or one message.
EQUAL, ANSWERED = "the same rows", "one message"
_POINTS, _LOADS = 32, ("400:1200:2", "500:1300:2")


def words(store: Path, loads: str = _LOADS[0]) -> list[str]:
    """The command line of a sweep."""
    axes = ["--grid", f"excitation.speed_rpm=10980:15000:{_POINTS // 2}", "--grid", f"load.axial={loads}"]
    return ["sweep", str(SCENE), "--set", "integrator.kind=quasi_static", *axes, "--out", str(store)]


def _sql(*statements: str) -> Harm:
    """Harm by statements, in which N and M are keys of two points and the other store is attached."""

    def done(path: Path, other: Path, chance: random.Random) -> None:
        n, m = chance.sample(range(_POINTS), 2)
        with closing(sqlite3.connect(path)) as connection:
            connection.execute("ATTACH ? AS foreign_store", (str(other),))
            with connection:
                for statement in statements:
                    connection.execute(statement.format(N=n, M=m, digit=chance.randint(0, 8), older=SCHEMA - 1))

    return done


def _left_journal(path: Path, other: Path, chance: random.Random) -> None:
    """A journal of another file: SQLite rolls it back where its head looks right."""
    path.with_name(f"{path.name}-journal").write_bytes(bytes.fromhex("d9d505f920a163d7") + other.read_bytes()[: 3 * _PAGE])


def _content(change: Callable[[bytes, bytes, random.Random], bytes]) -> Harm:
    """Harm to the content: the file's, another whole one's of its kind, and chance."""

    def done(path: Path, other: Path, chance: random.Random) -> None:
        path.write_bytes(change(path.read_bytes(), other.read_bytes(), chance))

    return done


def _at(begin: int, new: bytes, content: bytes) -> bytes:
    return content[:begin] + new + content[begin + len(new) :]


def _page(content: bytes, chance: random.Random) -> int:
    """Where a page begins."""
    return _PAGE * chance.randrange(-(-len(content) // _PAGE))


def _swapped_pages(content: bytes, other: bytes, chance: random.Random) -> bytes:
    pages = [content[k : k + _PAGE] for k in range(0, len(content), _PAGE)]
    i, j = chance.sample(range(len(pages)), 2)
    pages[i], pages[j] = pages[j], pages[i]
    return b"".join(pages)


_BOTH = "state, reason, content, cost, digest"
#: What disks, power cuts and foreign programs do to a file.
HARMS: dict[str, Harm] = {
    "cut": _content(lambda a, _, chance: a[: chance.randrange(1, len(a))]),
    "one bit": _content(lambda a, _, chance: _at(k := chance.randrange(len(a)), bytes([a[k] ^ 1 << chance.randrange(8)]), a)),
    "page of zeros": _content(lambda a, _, chance: _at(k := _page(a, chance), bytes(len(a[k : k + _PAGE])), a)),
    "zeros to the end": _content(lambda a, _, chance: a[: (k := chance.randrange(1, len(a)))] + bytes(len(a) - k)),
    "two pages swapped": _content(_swapped_pages),
    "page of another store": _content(lambda a, b, chance: _at(k := _page(min(a, b, key=len), chance), b[k : k + _PAGE], a)),
    "another store": _content(lambda a, b, chance: b),
    "another program's file": _content(lambda a, b, chance: b"x,y\n" * chance.randint(1, 5000)),
    "another file's journal": _left_journal,
    "two rows swapped": _sql(
        "UPDATE points SET key = -1 WHERE key = {N}",
        "UPDATE points SET key = {N} WHERE key = {M}",
        "UPDATE points SET key = {M} WHERE key = -1",
    ),
    "row of another store": _sql(
        f"UPDATE points SET ({_BOTH}) = (SELECT {_BOTH} FROM foreign_store.points WHERE key = {{N}}) WHERE key = {{N}}"
    ),
    "digit of a value": _sql("UPDATE points SET content = replace(content, '{digit}', '9') WHERE key = {N}"),
    "scene of another store": _sql(
        "UPDATE facts SET value = (SELECT value FROM foreign_store.facts WHERE name = 'design') WHERE name = 'design'"
    ),
    "older schema": _sql("UPDATE facts SET value = '{older}' WHERE name = 'schema'"),
}  # fmt: skip


def resumed(store: Path, wanted: list[Any], foreign: list[Any]) -> str:
    """Read a store and go on with it: ``EQUAL``, ``ANSWERED``, or what went wrong.  A whole foreign store may be read as itself."""
    from click.testing import CliRunner

    from raceway.cli.main import main as command

    try:
        with open_store(store) as there:
            read = [(row["point"], row["status"], row["reason"], row["values"]) for row in there.rows()]
    except RacewayError:
        read = []
    if any(row[1] == "run" and row not in wanted and row not in foreign for row in read):
        return "other values before it is gone on with"
    done = CliRunner().invoke(command, [*words(store), "--resume"])
    if "Traceback" in done.output or "unexpected" in done.output:
        return f"unexpected: {done.output.splitlines()[-1][:200]}"
    if done.exit_code == 2:
        return ANSWERED if done.stderr.count("error: ") == 1 else f"messages: {done.stderr[:200]}"
    if done.exit_code:
        return f"code {done.exit_code}: {done.stderr[:200]}"
    return EQUAL if rows_of(store) == wanted else "other values"


def in_child(function: Callable[..., Any], *given: Any, limit_s: float = 120.0) -> Any:
    """What it returns; or in words which signal or exception ended it, or that it did not end.  The child is forked: it has
    the modules and the compiled kernels of this process, and its own copy of everything else."""
    context = multiprocessing.get_context("fork")
    here, there = context.Pipe(duplex=False)
    process = context.Process(target=_answer, args=(there, function, given))
    process.start()
    there.close()
    try:
        found = here.recv() if here.poll(limit_s) else f"no end within {limit_s:g} s"
    except EOFError:
        found = ""
    process.join(5.0)
    if process.is_alive():
        process.kill()
        process.join()
    if found == "":
        code = process.exitcode or 0
        found = f"ended by {signal.Signals(-code).name}" if code < 0 else f"ended without an answer, code {code}"
    return found


def _answer(there: Any, function: Callable[..., Any], given: tuple[Any, ...]) -> None:
    try:
        there.send(function(*given))
    except BaseException as why:
        there.send(f"unexpected {type(why).__name__}: {why}")


def tried(count: int, seed: int = 17) -> dict[str, Counter[str]]:
    """Outcomes by harm, each as often as the others."""
    from click.testing import CliRunner

    from raceway.cli.main import main as command

    chance = random.Random(seed)
    found = {name: Counter[str]() for name in HARMS}
    with tempfile.TemporaryDirectory() as folder:
        whole, other = Path(folder) / "whole", Path(folder) / "other"
        for store, loads in zip((whole, other), _LOADS, strict=True):
            done = CliRunner().invoke(command, words(store, loads))
            if done.exit_code:
                raise RuntimeError(done.output)
        wanted, foreign = rows_of(whole), rows_of(other)
        for k in range(count):
            name = list(HARMS)[k % len(HARMS)]
            store = Path(folder) / f"s{k}"
            shutil.copytree(whole, store)
            HARMS[name](store / POINTS, other / POINTS, chance)
            found[name][in_child(resumed, store, wanted, foreign)] += 1
            shutil.rmtree(store)
    return found


def rows() -> list[Row]:
    found = tried(_STORES)
    every = sum(found.values(), Counter[str]())
    equal, told = every[EQUAL], every[ANSWERED]
    other = sum(count for outcome, count in every.items() if outcome.startswith("other values"))
    note = f"{len(HARMS)} damages: {', '.join(HARMS)}"
    mended = sum((found[name] for name in _MENDED), Counter[str]())
    tries = mended.total()
    return [
        below(f"damaged stores, {every.total()}: silently other values", other, 0, note),
        below("of these, other ends than the same rows or one message: tracebacks, signals, hangs",
              every.total() - equal - told - other, 0, f"{equal} the same rows bit for bit, {told} one message"),
        Row("of these, rows that were swapped, foreign or edited, and a foreign journal: the same rows again",
            f"{mended[EQUAL]} of {tries}", "all", mended[EQUAL] == tries),
    ]  # fmt: skip
