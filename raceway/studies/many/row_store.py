"""Finished rows of a study on disk, so that Ctrl-C or a full disk costs one row and not the study.

A file of JSON lines.  A row's key is a hash of all that decides its numbers: the whole scene, the files it names, the
program's own sources and those of third parties' plug-ins; an edit of any of them makes the row new.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Collection, Iterable
from functools import cache
from pathlib import Path

import attrs

from raceway.errors import RacewayError
from raceway.framework.registry import Registry
from raceway.scene.scene import Scene
from raceway.storage.cache_folder import source_key
from raceway.storage.tables import ReadTables, Tables


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
    return source_key() + _hash(tuple(sorted(root.rglob("*.py"))))


@cache
def _sources_of(name: str) -> str:
    """Hash of a plug-in's module, or of its whole package."""
    import sys

    module = sys.modules.get(name)
    file = getattr(module, "__file__", None)
    if file is None:
        return name
    path = Path(file)
    return _hash(tuple(sorted(path.parent.rglob("*.py")))) if getattr(module, "__package__", "") else _hash((path,))


def _hash(paths: tuple[Path, ...]) -> str:
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
