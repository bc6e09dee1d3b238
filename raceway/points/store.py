"""The store of finished work: a folder with a row for each point of a sweep or case of a study, which survives whatever stops it.

``points.sqlite`` is written by one process at a time, in transactions; others may read meanwhile.
"""

import fcntl
import hashlib
import io
import json
import sqlite3
import warnings
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import closing, contextmanager, suppress
from datetime import UTC, datetime
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple, Self

import attrs
import numpy as np

from raceway.errors import RacewayError
from raceway.framework.loading.registry import Registry
from raceway.scene.scene import Scene
from raceway.storage.kernel_cache import source_key
from raceway.storage.tables import ReadTables, Tables

SCHEMA = 7
_STATES = ("waiting", "done", "failed")
POINTS, _LOCK = "points.sqlite", ".lock"
_COLUMNS = "key, state, reason, content, cost, digest"
#: What a row that was damaged is read as: it waits to be computed again.
DAMAGED = "the row in the store is damaged"
#: Numbers of points stay numbers, hashes of cases text.
_TABLES = (
    "CREATE TABLE facts (name TEXT PRIMARY KEY, value TEXT NOT NULL)",
    "CREATE TABLE points (key PRIMARY KEY NOT NULL, state TEXT NOT NULL, reason TEXT, content TEXT, cost TEXT, digest TEXT)",
    "CREATE INDEX points_by_state ON points (state)",
)
Key = int | str


class Row(NamedTuple):
    """What is stored of one point or case.

    key : number of a point, or hash of all that decides a case
    reason : why it failed or waits
    content : plain values, or arrays of many points; empty where it waits
    cost : plain values
    """

    key: Key
    state: str
    reason: str
    content: Tables
    cost: Tables


class Store:
    """Rows by key on disk, or in memory; ``written`` makes it.

    path : the folder
    facts : what all rows depend on, schema, created
    fault : why rows are no longer stored; a study goes on without
    """

    def __init__(self, path: Path, connection: sqlite3.Connection) -> None:
        self.path = path
        self.fault: RacewayError | None = None
        self._connection = connection
        with told(path):
            records = dict(connection.execute("SELECT name, value FROM facts").fetchall())
        try:
            self.facts: Tables = {name: json.loads(text) for name, text in records.items()}
        except (ValueError, TypeError):
            raise _damage(path) from None
        if self.facts.get("schema") != SCHEMA:
            why = f"`{path}` is a store of schema {self.facts.get('schema')}, this version reads {SCHEMA}: choose another folder"
            raise RacewayError(why)
        self._origin = facts_digest(records)
        if self.facts.pop("digest", None) != self._origin:
            raise _damage(path)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        self._connection.close()

    def counts(self) -> dict[str, int]:
        """Number of rows in each state."""
        with told(self.path):
            counts = dict(self._connection.execute("SELECT state, COUNT(*) FROM points GROUP BY state").fetchall())
        return {state: counts.get(state, 0) for state in _STATES}

    def get(self, key: Key) -> Row:
        """The row of a key; one that is missing or damaged waits."""
        with told(self.path):
            record = self._connection.execute(f"SELECT {_COLUMNS} FROM points WHERE key = ?", (key,)).fetchone()
        if record is None or not self._sound(*record):
            return Row(key, "waiting", DAMAGED, {}, {})
        _, state, reason, content, cost, _ = record
        if isinstance(content, bytes):
            with np.load(io.BytesIO(content)) as arrays:
                return Row(key, state, reason or "", dict(arrays), json.loads(cost or "{}"))
        return Row(key, state, reason or "", json.loads(content or "{}"), json.loads(cost or "{}"))

    def keys(self, state: str) -> set[Key]:
        """Keys of the rows in a state."""
        with told(self.path):
            return {key for (key,) in self._connection.execute("SELECT key FROM points WHERE state = ?", (state,))}

    def costs(self, kind: type[int] | type[str]) -> list[Tables]:
        """Of finished rows whose keys are of a type."""
        query = f"SELECT cost FROM points WHERE state = 'done' AND typeof(key) = '{'text' if kind is str else 'integer'}'"
        with told(self.path):
            return [json.loads(cost or "{}") for (cost,) in self._connection.execute(query)]

    def put(self, rows: Iterable[Row]) -> None:
        """Store finished rows, all in one transaction.

        RacewayError: A disk that takes no more; what was stored before stays readable.
        """
        lines = list[tuple[object, ...]]()
        for key, state, reason, content, cost in rows:
            memory, arrays = io.BytesIO(), any(isinstance(value, np.ndarray) for value in content.values())
            if arrays:
                np.savez(memory, **content)
            columns = (key, state, reason, memory.getvalue() if arrays else _json_text(content), _json_text(cost))
            lines.append((*columns, self._digest(*columns)))
        self._write(f"INSERT OR REPLACE INTO points ({_COLUMNS}) VALUES (?, ?, ?, ?, ?, ?)", lines)

    def wait(self, keys: Iterable[Key]) -> None:
        """Let these wait to be computed again."""
        self._write("INSERT OR REPLACE INTO points (key, state) VALUES (?, 'waiting')", [(key,) for key in keys])

    def _write(self, statement: str, lines: list[tuple[object, ...]]) -> None:
        with told(self.path), self._connection:
            self._connection.executemany(statement, lines)

    def repair(self, keys: Collection[Key]) -> None:
        """Let rows wait, with a warning, that are missing among ``keys`` or are not what was written.

        RacewayError: A file whose pages do not hang together: rows could be found by one way and not by another.
        """
        with told(self.path):
            if self._connection.execute("PRAGMA integrity_check(1)").fetchone() != ("ok",):
                raise _damage(self.path, "its pages are inconsistent")
            sound = {r[0]: self._sound(*r) for r in self._connection.execute(f"SELECT {_COLUMNS} FROM points")}
        known_keys = set(keys or sound)
        bad = {key for key in known_keys if not sound.get(key, False)}
        strange = {key for key in set(sound) - known_keys if not sound[key]}  # runs of points that a block has left are not
        if bad or strange:
            self._write("DELETE FROM points WHERE key = ?", [(key,) for key in strange])
            self.wait(bad)
            words = f"{max(len(bad), len(strange))} rows of the store are damaged: they are computed again"
            warnings.warn(words, stacklevel=2)

    def _digest(self, *columns: object) -> str:
        """Of a finished row as it stands in the file, and of the store's facts: a row of another store fails it."""
        digest = hashlib.blake2b(digest_size=16)
        for column in (self._origin, *columns):
            digest.update(column if isinstance(column, bytes) else repr(column).encode())
        return digest.hexdigest()

    def _sound(self, key: object, state: object, *columns: object) -> bool:
        """Whether a row says what was written: finished ones have a digest, the others a state alone."""
        return state == "waiting" or (state in _STATES and columns[-1] == self._digest(key, state, *columns[:-1]))


def connected(folder: Path, patience: float = 30.0) -> sqlite3.Connection:
    """To the file of a store that is there; ``patience`` : for another process that writes [s]."""
    return sqlite3.connect(f"{(folder / POINTS).resolve().as_uri()}?mode=rw", uri=True, timeout=patience)


@contextmanager
def written(path: str | Path | None, facts: ReadTables | None = None, keys: Collection[Key] = ()) -> Iterator[Store]:
    """A store to write, for one process at a time; made where there is none yet.  None keeps the rows in memory.

    facts : what all rows depend on;  keys : of all rows that the store will have, where they are known

    RacewayError: Another process is writing to it, it has the rows of another command, or the disk takes nothing.
    """
    if path is None:
        with closing(sqlite3.connect(":memory:")) as connection:
            _make(connection, facts or {}, keys)
            yield Store(Path(), connection)
        return
    folder = Path(path)
    with told(folder):
        folder.mkdir(parents=True, exist_ok=True)
        guard = (folder / _LOCK).open("w")
    with guard:
        try:
            fcntl.flock(guard, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            why = f"`{folder}` is being written by another process: wait for it, or choose another --out"
            raise RacewayError(why) from None
        new = not exists(folder)
        with told(folder):
            connection = sqlite3.connect(folder / POINTS, timeout=30.0)
        try:
            with told(folder):
                connection.execute("PRAGMA journal_mode = TRUNCATE")
                connection.execute("PRAGMA synchronous = NORMAL")
                if new:
                    _make(connection, facts or {}, keys)
            store = Store(folder, connection)
            if store.facts.keys() - {"schema", "created"} != (facts or {}).keys():
                raise RacewayError(f"`{folder}` holds the rows of another command: choose another folder with --out")
            store.repair(keys)
            yield store
            if store.fault is not None:
                warnings.warn(str(store.fault), stacklevel=3)
        finally:
            # Close a store that was written; one that was begun and got nowhere is taken away.
            with suppress(sqlite3.Error):  # what is wrong with the disk was said when it was written to
                empty = new and not _holds_rows(connection)
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
    if not (folder / POINTS).is_file():
        return False
    with told(folder), closing(connected(folder)) as connection:
        return _has_tables(connection)


def _has_tables(connection: sqlite3.Connection) -> bool:
    return connection.execute("SELECT 1 FROM sqlite_master WHERE name = 'facts'").fetchone() is not None


def _holds_rows(connection: sqlite3.Connection) -> bool:
    query = "SELECT 1 FROM points WHERE state IN ('done', 'failed') LIMIT 1"
    return _has_tables(connection) and connection.execute(query).fetchone() is not None


def _make(connection: sqlite3.Connection, facts: ReadTables, keys: Iterable[Key]) -> None:
    """All in one transaction: a store is there with all its rows, or not at all."""
    all_facts = {**facts, "schema": SCHEMA, "created": datetime.now(UTC).isoformat(timespec="seconds")}
    texts = {name: _json_text(value) for name, value in all_facts.items()}
    texts["digest"] = _json_text(facts_digest(texts))
    with connection:
        connection.execute("BEGIN")
        for table in _TABLES:
            connection.execute(table)
        connection.executemany("INSERT INTO facts VALUES (?, ?)", list(texts.items()))
        connection.executemany("INSERT INTO points (key, state) VALUES (?, 'waiting')", ((key,) for key in keys))


def facts_digest(texts: Mapping[str, str]) -> str:
    """Of the facts of a store, as JSON by name."""
    entries = sorted((name, text) for name, text in texts.items() if name != "digest")
    return hashlib.blake2b(repr(entries).encode(), digest_size=16).hexdigest()


def _damage(folder: Path, how: str = "its scene and design differ from those written") -> RacewayError:
    return RacewayError(f"`{folder / POINTS}` is damaged: {how}. Begin again in another folder with --out")


def _json_text(value: object) -> str:
    return json.dumps(value, allow_nan=False, separators=(",", ":"))


@contextmanager
def told(folder: Path) -> Iterator[None]:
    """Faults of the disk or of the file, in words."""
    try:
        yield
    except (sqlite3.DatabaseError, UnicodeDecodeError) as why:
        if isinstance(why, sqlite3.OperationalError):
            outcome, again = "Nothing is stored", "."
            with suppress(sqlite3.Error), closing(connected(folder, 0.0)) as connection:
                if _holds_rows(connection):
                    outcome, again = "Finished points are stored", ", a sweep with --resume."
            raise RacewayError(
                f"`{folder}` cannot be written or read: {why}. {outcome}: free some space, and run the command again{again}"
            ) from None
        raise RacewayError(f"`{folder / POINTS}` is not a store ({why}): choose another folder.") from None
    except OSError as why:
        raise RacewayError(f"`{folder}`: {why.strerror or why}. Choose another folder with --out.") from None


def row_key(scene: Scene, registry: Registry, extra: object = None) -> str:
    """Hash of all that decides the numbers of one scene's run; its title does not."""
    return tables_key(scene.to_dict(), registry, extra, files=files_of(scene))


def tables_key(
    tables: ReadTables, registry: Registry, extra: object = None, program: str | None = None, files: Iterable[str] = ()
) -> str:
    """The same of a scene's tables, and of the files that they name."""
    digest = hashlib.sha256()
    content = {name: table for name, table in tables.items() if name != "title"}
    digest.update(json.dumps([content, extra], sort_keys=True, default=str).encode())
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
            digest.update(_sources_of(entry.place.partition(":")[0]).encode())
    return digest.hexdigest()


@cache
def _own_sources() -> str:
    root = Path(__file__).resolve().parents[1]
    return source_key() + _row_hash(tuple(sorted(root.rglob("*.py"))))


@cache
def _sources_of(name: str) -> str:
    spec = None
    with suppress(ImportError, ValueError):  # no such module, or one that was made by a program
        spec = find_spec(name)
    if spec is None or spec.origin is None:
        return name
    path = Path(spec.origin)
    return _row_hash(tuple(sorted(path.parent.rglob("*.py")))) if spec.parent else _row_hash((path,))


def _row_hash(paths: tuple[Path, ...]) -> str:
    digest = hashlib.sha256()
    for path in paths:
        digest.update(path.name.encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


def files_of(scene: Scene) -> list[str]:
    """Files that the plug-ins of a scene read."""
    parts = (scene.excitation, scene.mesh, scene.contact.law, scene.integrator.method, scene.identifier.method)
    fields = ((part, field) for part in parts if part is not None for field in attrs.fields(type(part)))
    paths = (getattr(part, field.name) for part, field in fields if field.metadata.get("path"))
    return [str(path) for path in paths if path]
