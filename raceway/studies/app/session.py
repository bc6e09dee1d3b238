"""One or two scenes that are looked at: their changes, undone and redone, and what states them outside of the page."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path

import attrs

from raceway.errors import RacewayError, SceneError
from raceway.framework.registry import default_registry
from raceway.scene.changes import told
from raceway.scene.inputs import Given, leaves
from raceway.scene.scene import Scene
from raceway.storage.files import slug, writable, write_whole
from raceway.studies.app.form import value_of

#: Changes that can be undone.
_HISTORY = 200
#: The excitation that a comparison begins with.
_OTHER = {"bidirectional": "unidirectional", "unidirectional": "bidirectional"}


@attrs.define
class Session:
    """The scenes of a page, and how they came about.

    Attributes
    ----------
    scenes : one, or two that are compared
    source : what was opened: a file's name, or empty
    folder : where files are written, and nowhere else
    number : of changes so far
    """

    scenes: tuple[Given, ...]
    source: str
    folder: Path
    number: int = 0
    _past: list[tuple[Given, ...]] = attrs.field(factory=list)
    _future: list[tuple[Given, ...]] = attrs.field(factory=list)

    def change(self, panels: Sequence[int], key: str, text: str, merge: bool = False) -> list[int]:
        """Set a key of some panels; an empty text takes it out; ``merge``: undone together with the change before.

        Returns
        -------
        list of int : panels that have changed

        Raises
        ------
        SceneError
            A key that no scene can have.
        """
        value = value_of(text)
        changed = {panel: self.scenes[panel].changed({key: value}) for panel in panels if panel < len(self.scenes)}
        changed = {panel: scene for panel, scene in changed.items() if scene.merged() != self.scenes[panel].merged()}
        if changed:
            self._become(tuple(_short(changed.get(k, scene)) for k, scene in enumerate(self.scenes)), merge)
        return list(changed)

    def compare(self, on: bool) -> list[int]:
        """Put a second scene beside the first, the other excitation model under the same settings; or take it away."""
        if on == (len(self.scenes) == 2):
            return []
        first = self.scenes[0]
        kind = (first.merged().get("excitation") or {}).get("kind")
        second = first.changed({"excitation.kind": _OTHER[kind]}) if kind in _OTHER else first
        self._become((first, second) if on else (first,))
        return [1] if on else []

    def undo(self, back: bool = True) -> list[int]:
        """To the scenes before the last change, or forward again.

        Returns
        -------
        list of int : panels that have changed
        """
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

    def _become(self, scenes: tuple[Given, ...], merge: bool = False) -> None:
        if not (merge and self._past):
            self._past = [*self._past, self.scenes][-_HISTORY:]
        self._future = []
        self.scenes = scenes
        self.number += 1

    def checked(self, panel: int) -> tuple[Scene | None, list[tuple[str, str]]]:
        """The scene, or its mistakes: path and sentence."""
        try:
            return self.scenes[panel].scene(default_registry()), []
        except SceneError as error:
            return None, [(mistake.path, str(mistake)) for mistake in error.mistakes]
        except RacewayError as error:
            return None, [("", str(error))]

    def command(self, panel: int) -> str:
        """The command line that computes the scene."""
        scene = self.scenes[panel]
        settings = " ".join(f"--set {shlex.quote(f'{key}={told(value)}')}" for key, value in self._changes(scene))
        return f"raceway run {shlex.quote(self.source or 'scene.toml')} {settings}".strip()

    def python(self, panel: int) -> str:
        """Python that computes the scene, from its tables alone."""
        return f"import raceway as rw\n\nresult = rw.run({self.scenes[panel].plain(default_registry())!r})\nprint(result)"

    def _changes(self, scene: Given) -> list[tuple[str, object]]:
        """What differs from the file that was opened; all of a scene that was never saved."""
        if not self.source:
            return []
        old, new = dict(leaves(scene.tables)), dict(leaves(scene.merged()))
        return [(key, new.get(key)) for key in dict.fromkeys((*old, *new)) if old.get(key) != new.get(key)]

    def save(self, panel: int, name: str) -> Path:
        """Write the scene as a TOML file into the folder.

        Raises
        ------
        SceneError
            A name that leads out of the folder.
        RacewayError
            A folder that cannot be written.
        """
        import tomli_w

        path = Path(name or f"{slug(str(self.scenes[panel].merged().get('title', 'scene')))}.toml")
        if path.name != name.strip() and name or path.suffix != ".toml":
            raise SceneError.at("name", name, "must be the name of a .toml file without folders")
        text = tomli_w.dumps(self.scenes[panel].plain(default_registry()))
        return write_whole(text.encode(), writable(self.folder) / path.name)


def _short(scene: Given) -> Given:
    """The same scene, whose changes do not grow with each edit: the last of a key holds."""
    changes: dict[str, object] = {}
    for key, value in scene.changes:
        changes.pop(key, None)
        changes[key] = value
    return attrs.evolve(scene, changes=tuple(changes.items()))
