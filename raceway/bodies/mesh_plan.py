"""Predicted size of a scene's mesh, and its mistakes.  Nothing is meshed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from raceway.bodies.meshing import scene_mesher
from raceway.errors import MeshError, Mistake, PluginError
from raceway.framework.sources import blamed
from raceway.scene.scene import Scene
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.core.mesh.quality import Prediction


def mesh_faults(scene: Scene) -> list[Mistake]:
    """Why the table [mesh] cannot be used: sizes that its mesher refuses or the memory does not hold."""
    if scene.mesh is None:
        return []
    try:
        _prediction(scene)
    except MeshError as error:
        return [error.mistake or Mistake("mesh", None, str(error))]
    return []


def unrefined(scene: Scene, who: str) -> list[Mistake]:
    """A mesh without cells along a contact, which some bodies need; ``who``: in words."""
    if scene.mesh is None or refined(scene):
        return []
    why = f"{who} need cells along a contact: take at least 1, or elastic bodies with contact.discretisation = 'resultant'"
    return [Mistake("mesh.nodes_per_semi_axis", 0, why)]


def refined(scene: Scene) -> bool:
    """Whether a structured mesh has cells along a contact ellipse; those of other meshers are not known."""
    return bool(getattr(scene.mesh, "nodes_per_semi_axis", 1))


def predicted_mesh(scene: Scene) -> Tables | None:
    """Predicted size of the scene's mesh.

    Returns
    -------
    dict or None
        ``bodies[{name, cells, bytes}]`` (what each mesh keeps), ``cells`` of all, ``bytes`` at the peak while they are
        made; None without [mesh], and where the mesher cannot tell before it reads or meshes.

    Raises
    ------
    MeshError
        Sizes that cannot work.
    PluginError
        A mesher whose prediction is none, or that raises anything but a ``RacewayError``.
    """
    found = None if scene.mesh is None else _prediction(scene)
    if found is None:
        return None
    from raceway.core.mesh.quality import body_bytes

    bodies = [{"name": name, "cells": cells, "bytes": body_bytes(cells)} for name, cells in found.bodies.items()]
    return {"bodies": bodies, "cells": found.cells, "bytes": found.memory_bytes}


def _prediction(scene: Scene) -> Prediction | None:
    """Prediction by the mesher's ``predict``, if it has one; refused where it would not fit."""
    mesher = scene_mesher(scene)
    if not hasattr(mesher, "predict"):
        return None
    from raceway.core.mesh.quality import Prediction, refuse_memory

    with blamed(f"mesher '{mesher.name}'", "predict()"):
        found = mesher.predict(scene.bearing)
    if found is None:  # it cannot tell before it reads or meshes
        return None
    if isinstance(found, Mapping) and all(isinstance(cells, int) for cells in found.values()):
        found = Prediction.of({str(name): cells for name, cells in found.items()})
    if not isinstance(found, Prediction):
        raise PluginError(
            f"mesher '{mesher.name}': predict() returned {type(found).__name__}; it must be body -> number of cells"
        )
    refuse_memory(found, "mesh.kind", mesher.name, "take larger elements")
    return found
