"""Whether a scene is right, as an object: mistakes and warnings instead of an exception."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import attrs

from raceway.errors import Mistake, SceneError
from raceway.framework.doors import door
from raceway.framework.shown import Fact, Shown
from raceway.planning.implausible import foreseen, implausible
from raceway.planning.plan import make_plan
from raceway.scene.given import as_scene
from raceway.storage.tables import Tables


@attrs.frozen(repr=False)
class Check(Shown):
    """What is wrong with a scene; true where nothing is.

    Attributes
    ----------
    mistakes : tuple of Mistake, each with ``path``, ``value`` and ``message``; they keep the scene from running
    warnings : tuple of str, values that are possible and unlikely

    Examples
    --------
    >>> import raceway as rw
    >>> rw.check({"bearing": {"preset": "B7206C"}})
    1 mistake
      load.axial  0.0  nothing loads the bearing: there is no stiffness to find
    """

    mistakes: tuple[Mistake, ...] = ()
    warnings: tuple[str, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether the scene can run."""
        return not self.mistakes

    def __bool__(self) -> bool:
        return self.ok

    def _shown(self) -> tuple[str, list[Fact]]:
        count = len(self.mistakes)
        title = "no mistakes" if self.ok else f"{count} mistake{'' if count == 1 else 's'}"
        rows = [(one.path, "" if one.value is None else repr(one.value), one.message) for one in self.mistakes]
        return title, [*rows, *(("warning", "", text) for text in self.warnings)]

    def to_dict(self) -> Tables:
        """Mistakes and warnings as plain tables."""
        return {"errors": [attrs.asdict(one) for one in self.mistakes], "warnings": list(self.warnings)}


@door
def check(scene: Any, *, plugins: Iterable[str | Path] = ()) -> Check:
    """Look for every mistake of a scene; compute nothing.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables
    plugins : files of one-off plug-ins that the scene uses

    Returns
    -------
    Check : also of a scene that cannot be read

    Raises
    ------
    PluginError
        A plug-in file that is missing, fails to import or adds nothing.

    Examples
    --------
    >>> import raceway as rw
    >>> found = rw.check({"bearing": {"preset": "B7206C"}, "load": {"axail": 400}})
    >>> found.ok, found.mistakes[0].path
    (False, 'load.axail')
    """
    try:
        read = as_scene(scene, plugins=plugins)
        make_plan(read)
    except SceneError as error:
        return Check(tuple(error.mistakes))
    return Check(tuple(foreseen(read)), implausible(read))
