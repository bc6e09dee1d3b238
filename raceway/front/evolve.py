"""A scene with changes."""

from __future__ import annotations

from typing import Any

from raceway.scene.given import Change, as_scene
from raceway.scene.scene import Scene


def evolve(scene: Any, *changes: Change) -> Scene:
    """A scene with some keys changed, as ``--set`` does on the command line.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables
    changes : str or mapping
        ``"load.axial=400"`` with the value as TOML, or ``{"load.axial": 400}``; None takes a key or a table out

    Returns
    -------
    Scene : whose title says in its second line what was changed

    Raises
    ------
    SceneError
        With every mistake of the scene and its changes.

    Examples
    --------
    >>> import raceway as rw
    >>> scene = rw.evolve({"bearing": {"preset": "B7206C"}}, "load.axial=400", {"supports.tilt": "free"})
    >>> scene.load.axial, scene.supports.tilt
    (400.0, 'free')
    """
    return as_scene(scene, *changes)
