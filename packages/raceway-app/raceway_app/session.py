"""One or two scenes that are looked at: their changes, undone and redone, and what states them outside of the page."""

import re
import shlex
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import attrs

from raceway import RacewayError, Scene, SceneError
from raceway.extend import (
    Given, ReadTables, Tables, default_registry, leaves, parse_value, scene_schema, slug, told, writable, write_whole,
)  # fmt: skip

#: Tables that no run of one scene reads, or that are no numbers and words.
_WITHOUT = ("rig", "tolerances")
_UNIT = re.compile(r"^(.*?)\s*\[([^\]]+)\]$", re.DOTALL)


@cache
def _schema() -> Tables:
    return scene_schema(default_registry())


def groups(source: Given) -> list[Tables]:
    """Tables of a scene, name and fields (path, unit, help, choices (words, or None), default (text)) that its kinds have."""
    tables, content = source.merged(), []
    for name, schema in _schema()["properties"].items():
        if name not in _WITHOUT:
            content.append({"name": name, "fields": _fields(name, schema, tables.get(name))})
    return content


def _fields(path: str, schema: ReadTables, values: object) -> list[Tables]:
    """Of a table, with those of the tables in it; a key alone is its own field."""
    table = values if isinstance(values, dict) else {}
    properties = dict(schema.get("properties", {}))
    if "oneOf" in schema:
        kind = table.get("kind", properties["kind"].get("default"))
        branch = next((b for b in schema["oneOf"] if b["properties"]["kind"].get("const") == kind), None)
        properties = {**properties, **({k: v for k, v in branch["properties"].items() if k != "kind"} if branch else {})}
    if not properties:
        return [_field(path, schema)]
    return [field for name, key in properties.items() for field in _fields(f"{path}.{name}", key, table.get(name))]


def _field(path: str, schema: ReadTables) -> Tables:
    text = str(schema.get("description", ""))
    words = _UNIT.match(text)
    forms = [schema, *schema.get("anyOf", ())]
    choices = [word for form in forms for word in form.get("enum", ())]
    if any(form.get("type") == "boolean" for form in forms):
        choices = ["true", "false"]
    open_ended = any(form.get("type") in ("number", "integer", "array", "object") for form in forms) or not choices
    return {
        "path": path, "unit": words[2] if words else "", "help": words[1] if words else text,
        "choices": None if open_ended else choices, "hints": choices if open_ended else [],
        "default": told(schema["default"]) if "default" in schema else "",
    }  # fmt: skip


def texts(source: Given, scene: Scene | None) -> tuple[dict[str, str], dict[str, str]]:
    """What is said of each key, and what holds for it, as texts by path; the latter is empty while the scene is refused."""
    input_texts = {path: told(value) for path, value in leaves(source.merged())}
    return input_texts, {} if scene is None else {path: told(value) for path, value in leaves(scene.to_dict())}


def mistakes_of(error: RacewayError) -> list[tuple[str, str]]:
    """Path and sentence of each mistake of a scene; of another failure no path."""
    return [(each.path, str(each)) for each in error.mistakes] if isinstance(error, SceneError) else [("", str(error))]


#: Changes that can be undone.
_HISTORY = 200
#: The excitation that a comparison begins with.
_OTHER = {"bidirectional": "unidirectional", "unidirectional": "bidirectional"}


@attrs.define
class Session:
    """The scenes of a page, and how they came about."""

    scenes: tuple[Given, ...]  # one, or two that are compared
    folder: Path  # where files are written, and nowhere else
    number: int = 0  # of changes so far
    _past: list[tuple[Given, ...]] = attrs.field(factory=list)
    _future: list[tuple[Given, ...]] = attrs.field(factory=list)

    def change(self, panels: Sequence[int], key: str, text: str, merge: bool = False) -> list[int]:
        """Set a key of some panels, and return those that have changed; an empty text takes it out; ``merge``: undone with the change before.

        SceneError: a key that no scene can have.
        """
        value = parse_value(text.strip()) if text.strip() else None
        new_scenes = {panel: self.scenes[panel].changed({key: value}) for panel in panels if 0 <= panel < len(self.scenes)}
        if key.endswith(".kind"):
            new_scenes = {panel: _fitting(scene, key.partition(".")[0]) for panel, scene in new_scenes.items()}
        new_scenes = {panel: scene for panel, scene in new_scenes.items() if scene.merged() != self.scenes[panel].merged()}
        if new_scenes:
            self._set_scenes(tuple(_short(new_scenes.get(k, scene)) for k, scene in enumerate(self.scenes)), merge)
        return list(new_scenes)

    def compare(self, on: bool) -> list[int]:
        """Put a second scene beside the first, the other excitation model under the same settings; or take it away."""
        if on == (len(self.scenes) == 2):
            return []
        first = self.scenes[0]
        kind = (first.merged().get("excitation") or {}).get("kind")
        second = first.changed({"excitation.kind": _OTHER[kind]}) if kind in _OTHER else first
        self._set_scenes((first, second) if on else (first,))
        return [1] if on else []

    def undo(self, back: bool = True) -> list[int]:
        """To the scenes before the last change, or forward again; returns the panels that have changed."""
        old, new = (self._past, self._future) if back else (self._future, self._past)
        if not old:
            return []
        before, now = self.scenes, old.pop()
        new.append(before)
        self.scenes = now
        self.number += 1
        return [k for k, scene in enumerate(now) if k >= len(before) or scene.merged() != before[k].merged()]

    @property
    def can_undo(self) -> tuple[bool, bool]:
        """Whether there is something to undo, and to redo."""
        return bool(self._past), bool(self._future)

    def _set_scenes(self, scenes: tuple[Given, ...], merge: bool = False) -> None:
        if not (merge and self._past):
            self._past = [*self._past, self.scenes][-_HISTORY:]
        self._future = []
        self.scenes = scenes
        self.number += 1

    def checked(self, panel: int) -> tuple[Scene | None, list[tuple[str, str]]]:
        """The scene, or its mistakes: path and sentence."""
        try:
            return self.scenes[panel].scene(default_registry()), []
        except RacewayError as error:
            return None, mistakes_of(error)

    def command(self, panel: int) -> str:
        """The command line that computes the scene; empty where --set cannot say it: no file, a key taken out, tables in a list."""
        scene = self.scenes[panel]
        old, new = dict(leaves(scene.tables)), dict(leaves(scene.merged()))
        changes = {key: new.get(key) for key in dict.fromkeys((*old, *new)) if old.get(key) != new.get(key)}
        if scene.folder is None or any(value is None or "{" in told(value) for value in changes.values()):
            return ""
        settings = [f"--set {shlex.quote(f'{key}={told(value)}')}" for key, value in changes.items()]
        return " ".join(["raceway run", shlex.quote(str(scene.folder / f"{scene.name}.toml")), *settings])

    def python(self, panel: int) -> str:
        """Python that computes the scene, from its tables alone."""
        return f"import raceway as rw\n\nresult = rw.run({self.scenes[panel].plain(default_registry())!r})\nprint(result)"

    def file(self, stem: str, suffix: str, panel: int | None = None) -> Path:
        """A path in the folder that is not there yet, with the name of one of two scenes; RacewayError: it cannot be written."""
        name = stem if panel is None or len(self.scenes) == 1 else f"{stem}-{'AB'[panel]}"
        paths = (writable(self.folder) / f"{name}{count}{suffix}" for count in ("", *(f"-{k}" for k in range(2, 1000))))
        return next(path for path in paths if not path.exists())

    def save(self, panel: int) -> Path:
        """Write the scene as a TOML file into the folder; RacewayError: it cannot be written."""
        import tomli_w

        tables = self.scenes[panel].plain(default_registry())
        return write_whole(tomli_w.dumps(tables).encode(), self.file(slug(str(tables["title"])), ".toml", panel))


def _fitting(scene: Given, table: str) -> Given:
    """Without the keys of a table that its new kind does not have."""
    fields = {field["path"] for group in groups(scene) if group["name"] == table for field in group["fields"]}
    beside = [f"{table}.{path}" for path, _ in leaves(scene.merged().get(table) or {}) if f"{table}.{path}" not in fields]
    return scene.changed(dict.fromkeys(beside)) if beside else scene


def _short(scene: Given) -> Given:
    """The same scene, whose changes do not grow with each edit: the last of a key holds."""
    changes: dict[str, object] = {}
    for key, value in scene.changes:
        changes.pop(key, None)
        changes[key] = value
    return attrs.evolve(scene, changes=tuple(changes.items()))
