"""The meshes of a scene's bodies: the mesher that [mesh] names, on the scene's bearing, judged before they are handed on."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import attrs

from raceway.bodies.mesh_fit import check_size
from raceway.errors import MeshError, PluginError, SceneError
from raceway.framework.sources import blamed
from raceway.planning.closed_form import axial_approach
from raceway.scene.scene import Scene

if TYPE_CHECKING:
    from raceway.core.mesh.hex_mesh import HexMesh
    from raceway.framework.contracts import Mesher


def scene_mesher(scene: Scene) -> Mesher:
    """The scene's mesher; an option ``ball_load`` that is left out becomes the static load of a ball under the axial load.

    Raises
    ------
    SceneError
        A scene without [mesh].
    """
    if scene.mesh is None:
        raise SceneError.at("mesh", None, 'is required here: for instance [mesh] with kind = "structured"')
    known = {field.name for field in attrs.fields(type(scene.mesh))}
    if "ball_load" in known and scene.mesh.ball_load is None and scene.load.axial != 0.0:
        return attrs.evolve(scene.mesh, ball_load=axial_approach(scene)[1])
    return scene.mesh


def mesh_scene(scene: Scene) -> dict[str, HexMesh]:
    """Meshes by the name of the body, as ``HexMesh``, without inverted or degenerate cells.

    Raises
    ------
    MeshError
        What the mesher refuses, a bad cell, or a body in other units than metres.
    PluginError
        A mesher that returns something else, or raises anything but a ``RacewayError``.
    """
    from raceway.core.mesh.hex_mesh import HexMesh
    from raceway.core.mesh.quality import refuse_bad_cells

    mesher = scene_mesher(scene)
    with blamed(f"mesher '{mesher.name}'", "mesh()"):
        found = mesher.mesh(scene.bearing)
    if not isinstance(found, Mapping) or not found:
        raise PluginError(f"mesher '{mesher.name}': mesh() returned {type(found).__name__}; it must be meshes by name")
    out: dict[str, HexMesh] = {}
    for name, mesh in found.items():
        try:
            parts = mesh.points, mesh.cells, getattr(mesh, "node_sets", {}), getattr(mesh, "facet_sets", {})
            out[str(name)] = mesh if isinstance(mesh, HexMesh) else HexMesh(*parts)
        except (AttributeError, MeshError) as why:
            raise PluginError(f"mesher '{mesher.name}': body '{name}' is no mesh: {why}") from why
        refuse_bad_cells(out[str(name)], str(name))
    check_size(mesher, scene.bearing, out)
    return out
