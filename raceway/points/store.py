"""The store of a sweep: a folder with the states and values of all points, which survives whatever stops the sweep.

``points.sqlite`` is written by the one process that runs the sweep, a batch a transaction; ``results.nc`` and
``results.csv`` are made from it.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import sqlite3
import threading
import time
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs

from raceway.errors import RacewayError
from raceway.framework.registry import Registry
from raceway.points.axes import Axis, Design
from raceway.scene.scene import Scene
from raceway.storage.kernel_cache import source_key
from raceway.storage.tables import ReadTables, Tables

if TYPE_CHECKING:
    import xarray

SCHEMA = 4
STATES = ("waiting", "running", "done", "failed")
#: A commit waits for the disk, twice: states of what is running are not worth more than a few of them a second.
_MOMENT_S = 0.2
POINTS, _LOCK = "points.sqlite", ".lock"
_CONTENT = "state, reason, key, content, warnings, cost"
#: What a row that was damaged is read as: the point waits to be computed again.
DAMAGED = "its row in the store is damaged"
_EMPTY: Tables = {
    "status": "waiting", "reason": DAMAGED, "values": {}, "warnings": [], "key": "", "cost": {},
}  # fmt: skip
_TABLES = (
    "CREATE TABLE facts (name TEXT PRIMARY KEY, value TEXT NOT NULL)",
    "CREATE TABLE points (number INTEGER PRIMARY KEY, state TEXT NOT NULL, reason TEXT, key TEXT, content TEXT, "
    "warnings TEXT, cost TEXT, digest TEXT)",
    "CREATE INDEX points_by_state ON points (state)",
)


class Store:
    """A sweep on disk; ``open_store`` reads one, ``written`` writes one.

    Attributes
    ----------
    path : the folder
    facts : scene (all keys, at the first point), design, identity (versions and plug-ins), files, options, schema, created
    """

    def __init__(self, path: Path, connection: sqlite3.Connection) -> None:
        self.path = path
        self._connection = connection
        self._lock = threading.RLock()
        self._committed = -_MOMENT_S
        with self._told():
            records = connection.execute("SELECT name, value FROM facts").fetchall()
        self.facts: Tables = _read_facts(path, dict(records))
        if self.facts.get("schema") != SCHEMA:
            raise RacewayError(
                f"`{path}` is a store of schema {self.facts.get('schema')}, this version reads {SCHEMA}: choose another folder"
            )
        self._origin = facts_digest(dict(records))
        if records and self.facts.pop("digest", None) != self._origin:
            raise _damaged(path)
        self.design = Design.from_dict(self.facts["design"])

    def __enter__(self) -> Store:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        self._connection.close()

    @property
    def title(self) -> str:
        return str(self.facts["scene"]["title"])

    @property
    def scene(self) -> Tables:
        """Every key of the scene at the first point."""
        return dict(self.facts["scene"])

    @property
    def axes(self) -> tuple[Axis, ...]:
        """Of a grid; empty for a list."""
        return self.design.axes

    def status(self) -> dict[str, int]:
        """Number of points in each state, and ``total``."""
        with self._told(), self._lock:
            counts = dict(self._connection.execute("SELECT state, COUNT(*) FROM points GROUP BY state").fetchall())
        return {**{state: counts.get(state, 0) for state in STATES}, "total": self.design.size}

    def rows(self) -> Iterator[Tables]:
        """``{point, status, reason, values, warnings, key, cost}`` of every point, in the order of the design.

        One row a point, whatever the file says: readers put the values of the n-th row at the n-th point.
        """
        at = 0
        for number, *columns, digest in self._lines():
            if not at <= number < self.design.size:
                continue
            for missing in range(at, number):
                yield self._row(missing, None)
            yield self._row(number, columns if self._sound(number, columns[0], tuple(columns[1:]), digest) else None)
            at = number + 1
        for missing in range(at, self.design.size):
            yield self._row(missing, None)

    def _lines(self) -> Iterator[tuple[Any, ...]]:
        query = f"SELECT number, {_CONTENT}, digest FROM points ORDER BY number"
        with self._told(), self._lock:
            cursor = self._connection.execute(query)
        while True:
            with self._told(), self._lock:
                batch = cursor.fetchmany(256)
            if not batch:
                return
            yield from batch

    def _row(self, number: int, stored: list[Any] | None) -> Tables:
        if stored is None:
            return {**_EMPTY, "point": self.design.point(number)}
        state, reason, key, content, warnings, cost = stored
        return {
            "point": self.design.point(number),
            "status": state,
            "reason": reason or "",
            "values": json.loads(content) if content else {},
            "warnings": json.loads(warnings) if warnings else [],
            "key": key or "",
            "cost": json.loads(cost) if cost else {},
        }

    def numbers(self, state: str) -> set[int]:
        """Numbers of the points in a state."""
        with self._told(), self._lock:
            return {n for (n,) in self._connection.execute("SELECT number FROM points WHERE state = ?", (state,))}

    def to_xarray(self) -> xarray.Dataset:
        """The labelled results: a dimension for each axis of a grid, or ``point`` for a list."""
        from raceway.points.dataset import dataset

        return dataset(self)

    def mark(self, numbers: Iterable[int], state: str) -> None:
        """Put points into a state: at once, or with the next rows where the last transaction was a moment ago."""
        with self._told(), self._lock:
            self._connection.executemany("UPDATE points SET state = ? WHERE number = ?", [(state, n) for n in numbers])
            if time.monotonic() - self._committed > _MOMENT_S:
                self._commit()

    def _commit(self) -> None:
        self._connection.commit()
        self._committed = time.monotonic()

    def put(self, rows: Iterable[ReadTables]) -> None:
        """Keep finished rows, all in one transaction.

        Raises
        ------
        RacewayError
            A disk that takes no more; what was kept before stays readable.
        """
        lines = []
        for row in rows:
            columns = (row["reason"], row["key"], *(_text(row[name]) for name in ("values", "warnings", "cost")))
            lines.append((row["state"], *columns, self._digest(row["number"], row["state"], columns), row["number"]))
        statement = "UPDATE points SET state = ?, reason = ?, key = ?, content = ?, warnings = ?, cost = ?, digest = ? WHERE number = ?"
        with self._told(), self._lock:
            try:
                self._connection.executemany(statement, lines)
                self._commit()
            except sqlite3.Error:
                self._connection.rollback()
                raise

    def repair(self) -> set[int]:
        """Let points wait whose rows are missing or are not what was written; their numbers.

        Raises
        ------
        RacewayError
            A file whose pages do not hang together: rows could be found by one way and not by another.
        """
        with self._told(), self._lock:
            if self._connection.execute("PRAGMA integrity_check(1)").fetchone() != ("ok",):
                raise _damaged(self.path, "its pages do not hang together")
            records = self._connection.execute(f"SELECT number, {_CONTENT}, digest FROM points").fetchall()
            sound = {
                number for number, state, *columns, digest in records if self._sound(number, state, tuple(columns), digest)
            }
            bad = set(range(self.design.size)) - sound
            if bad or len(records) != self.design.size:
                self._connection.execute("DELETE FROM points WHERE number < 0 OR number >= ?", (self.design.size,))
                statement = "INSERT OR REPLACE INTO points (number, state) VALUES (?, 'waiting')"
                self._connection.executemany(statement, [(number,) for number in sorted(bad)])
                self._commit()
        return bad

    def wait_again(self, states: Iterable[str]) -> None:
        """Points in these states wait again: those that a killed sweep left running, or failed ones to be tried again."""
        with self._told(), self._lock:
            for state in states:
                self._connection.execute("UPDATE points SET state = 'waiting', reason = NULL WHERE state = ?", (state,))
            self._commit()

    def _digest(self, number: int, state: str, columns: tuple[object, ...]) -> str:
        """Of a finished row as it stands in the file, and of the store's facts: a row of another store fails it."""
        return hashlib.blake2b(repr((self._origin, number, state, *columns)).encode(), digest_size=16).hexdigest()

    def _sound(self, number: int, state: object, columns: tuple[object, ...], digest: object) -> bool:
        """Whether a row says what was written: finished ones have a digest, the others a state alone."""
        if state in ("waiting", "running"):
            return True
        return state in STATES and bool(digest == self._digest(number, state, columns))

    @contextmanager
    def _told(self) -> Iterator[None]:
        with told(self.path):
            yield


def open_store(path: str | Path) -> Store:
    """A store to read; a sweep may be writing to it.

    Raises
    ------
    RacewayError
        No store there, or one of another schema.
    """
    folder = Path(path)
    file = folder / POINTS
    if not file.is_file():
        raise RacewayError(f"`{folder}` is no store of a sweep: it has no {POINTS}. `raceway sweep` makes one")
    with told(folder):
        return Store(
            folder, sqlite3.connect(f"{file.resolve().as_uri()}?mode=rw", uri=True, timeout=30.0, check_same_thread=False)
        )


@contextmanager
def written(folder: Path, facts: ReadTables | None) -> Iterator[Store]:
    """A store to write, for one process at a time; made with ``facts`` where there is none yet.

    Raises
    ------
    RacewayError
        Another process is writing to it, or the disk takes nothing.
    """
    with told(folder):
        folder.mkdir(parents=True, exist_ok=True)
        guard = (folder / _LOCK).open("w")
    with guard:
        try:
            fcntl.flock(guard, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise RacewayError(
                f"`{folder}` is being written by another sweep: wait for it, or choose another --out"
            ) from None
        new = not exists(folder)
        with told(folder):
            connection = sqlite3.connect(folder / POINTS, timeout=30.0, check_same_thread=False)
        try:
            with told(folder):
                connection.execute("PRAGMA journal_mode = TRUNCATE")
                connection.execute("PRAGMA synchronous = NORMAL")
                if facts is not None and not _made(connection):
                    _make(connection, facts)
            store = Store(folder, connection)
            yield store
        finally:
            _leave(folder, connection, new)


def _leave(folder: Path, connection: sqlite3.Connection, new: bool) -> None:
    """Close a store that was written; one that was begun and got nowhere is taken away."""
    with suppress(sqlite3.Error):  # what is wrong with the disk was said when it was written to
        query = "SELECT 1 FROM points WHERE state IN ('done', 'failed') LIMIT 1"
        empty = new and (not _made(connection) or connection.execute(query).fetchone() is None)
        connection.execute("PRAGMA journal_mode = DELETE")
        connection.close()
        if empty:
            with suppress(OSError):
                (folder / POINTS).unlink(missing_ok=True)
                (folder / _LOCK).unlink(missing_ok=True)
                folder.rmdir()
    connection.close()


def exists(folder: Path) -> bool:
    """Whether a folder holds a store: one that was killed while it was made is none."""
    file = folder / POINTS
    if not file.is_file():
        return False
    with told(folder):
        connection = sqlite3.connect(f"{file.resolve().as_uri()}?mode=rw", uri=True, timeout=30.0)
        try:
            return _made(connection)
        finally:
            connection.close()


def _made(connection: sqlite3.Connection) -> bool:
    return connection.execute("SELECT 1 FROM sqlite_master WHERE name = 'facts'").fetchone() is not None


def _make(connection: sqlite3.Connection, facts: ReadTables) -> None:
    """All in one transaction: a store is there with all its points, or not at all."""
    size = Design.from_dict(facts["design"]).size
    all_facts = {**facts, "schema": SCHEMA, "created": datetime.now(UTC).isoformat(timespec="seconds")}
    texts = {name: _text(value) for name, value in all_facts.items()}
    texts["digest"] = _text(facts_digest(texts))
    connection.execute("BEGIN")
    try:
        for table in _TABLES:
            connection.execute(table)
        connection.executemany("INSERT INTO facts VALUES (?, ?)", list(texts.items()))
        waiting = ((number, "waiting") for number in range(size))
        connection.executemany("INSERT INTO points (number, state) VALUES (?, ?)", waiting)
    except BaseException:
        connection.rollback()
        raise
    connection.commit()


def facts_digest(texts: Mapping[str, str]) -> str:
    """Of the facts of a store, as JSON by name."""
    entries = sorted((name, text) for name, text in texts.items() if name != "digest")
    return hashlib.blake2b(repr(entries).encode(), digest_size=16).hexdigest()


def _read_facts(folder: Path, texts: Mapping[str, str]) -> Tables:
    try:
        return {name: json.loads(text) for name, text in texts.items()}
    except (ValueError, TypeError):
        raise _damaged(folder) from None


def _damaged(folder: Path, how: str = "what it says of its scene and design is not what was written") -> RacewayError:
    return RacewayError(f"`{folder / POINTS}` is damaged: {how}. Begin again in another folder with --out")


def _text(value: object) -> str:
    return json.dumps(value, allow_nan=False, separators=(",", ":"))


@contextmanager
def told(folder: Path) -> Iterator[None]:
    """Faults of the disk or of the file, in words."""
    try:
        yield
    except (sqlite3.DatabaseError, UnicodeDecodeError) as why:
        if isinstance(why, sqlite3.OperationalError):
            raise RacewayError(
                f"`{folder}` cannot be written or read: {why}. What is finished is kept: free some space, and go on with "
                "--resume."
            ) from None
        raise RacewayError(f"`{folder / POINTS}` is not a store of a sweep ({why}): choose another folder.") from None
    except OSError as why:
        raise RacewayError(f"`{folder}`: {why.strerror or why}. Choose another folder with --out.") from None


class RowStore:
    """Rows by key; ``path`` None keeps them in memory only."""

    def __init__(self, path: Path | None) -> None:
        self.path = path
        self.rows: dict[str, Tables] = {}
        #: Why rows are no longer written; the study goes on without.
        self.fault: RacewayError | None = None
        if path is not None and os.path.isfile(path):
            self._read(path)

    def _read(self, path: Path) -> None:
        try:
            lines = path.read_bytes().splitlines()
        except OSError as why:
            raise RacewayError(
                f"`{path}` cannot be read: {why.strerror or why}. Choose another folder with --out."
            ) from None
        for line in lines:
            try:
                entry = json.loads(line)
                self.rows[entry["key"]] = entry["row"]
            except (ValueError, KeyError, TypeError):
                continue  # cut off by a full disk, or not ours: that row is run again

    def get(self, key: str) -> Tables | None:
        return self.rows.get(key)

    def put(self, key: str, row: Tables) -> None:
        """Keep a row; a disk that takes no more is remembered in ``fault``, and what it took of the row is removed."""
        self.rows[key] = row
        if self.path is None or self.fault is not None:
            return
        line = json.dumps({"key": key, "row": row}, allow_nan=False).encode() + b"\n"
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with self.path.open("ab") as file:
                end = file.tell()
                try:
                    # A line that a killed run left unfinished must not swallow this one.
                    file.write(line if end == 0 else b"\n" + line)
                    file.flush()
                except OSError:
                    file.truncate(end)
                    raise
        except OSError as why:
            self.fault = RacewayError(
                f"`{self.path}` takes no more rows: {why.strerror or why}. {len(self.rows) - 1} rows may be reused; free "
                "some space and run the command again, or choose another folder with --out."
            )


def row_key(scene: Scene, registry: Registry, extra: object = None, program: str | None = None) -> str:
    """Hash of all that decides the numbers of one scene's run; its title does not.

    Parameters
    ----------
    program : instead of ``program_key(registry)``
    """
    return tables_key(scene.to_dict(), registry, extra, program, files_of(scene))


def tables_key(
    tables: ReadTables, registry: Registry, extra: object = None, program: str | None = None, files: Iterable[str] = ()
) -> str:
    """The same of a scene's tables, and of the files that they name."""
    digest = hashlib.sha256()
    untitled = {name: table for name, table in tables.items() if name != "title"}
    digest.update(json.dumps([untitled, extra], sort_keys=True, default=str).encode())
    digest.update((program or program_key(registry)).encode())
    for name in files:
        path = Path(name)
        digest.update(path.read_bytes() if path.is_file() else b"missing")
    return digest.hexdigest()[:24]


def program_key(registry: Registry, used: Collection[tuple[str, str]] | None = None) -> str:
    """Hash of the program's own sources and of those of third parties' plug-ins: all, or the (kind, name) in ``used``."""
    digest = hashlib.sha256(_own_sources().encode())
    for entry in registry.all():
        if entry.distribution != "raceway" and (used is None or (entry.kind, entry.name) in used):
            digest.update(f"{entry.kind}:{entry.name}:{entry.version}".encode())
            digest.update(_sources_of(entry.plugin.__module__).encode())
    return digest.hexdigest()


@cache
def _own_sources() -> str:
    root = Path(__file__).resolve().parents[2]
    return source_key() + _row_hash(tuple(sorted(root.rglob("*.py"))))


@cache
def _sources_of(name: str) -> str:
    """Hash of a plug-in's module, or of its whole package."""
    import sys

    module = sys.modules.get(name)
    file = getattr(module, "__file__", None)
    if file is None:
        return name
    path = Path(file)
    return _row_hash(tuple(sorted(path.parent.rglob("*.py")))) if getattr(module, "__package__", "") else _row_hash((path,))


def _row_hash(paths: tuple[Path, ...]) -> str:
    digest = hashlib.sha256()
    for path in paths:
        digest.update(path.name.encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


def files_of(scene: Scene) -> list[str]:
    """Files that the plug-ins of a scene read."""
    parts = (scene.excitation, scene.mesh, scene.contact.law, scene.integrator.method, scene.identifier.method)
    return [
        str(getattr(part, field.name))
        for part in parts
        if part is not None
        for field in attrs.fields(type(part))
        if field.metadata.get("path") and getattr(part, field.name)
    ]
