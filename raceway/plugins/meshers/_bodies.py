"""Common parts of meshers of given bodies: names of the bodies, balls from the mesh of one ball."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import attrs

from raceway.errors import MeshError
from raceway.framework.options import option, positive

if TYPE_CHECKING:
    from raceway.core.mesh.hex_mesh import HexMesh
    from raceway.framework.contracts import Mesher
    from raceway.scene.bearing import Bearing

BODIES = ("inner_ring", "outer_ring", "ball")
BALL = "file of one ball about its centre: x rolling, y across, z towards the outer contact"


def ring_path(which: str) -> Any:
    """The option that names the file of a ring."""
    return option(None, help=f"file of the {which} ring, in the bearing's coordinates", path=True)


def ball_path() -> Any:
    """The option that names the file of one ball, from which all are made."""
    return option(None, help=BALL, path=True)


def file_unit(words: str) -> Any:
    """The option that says what one unit of the files is."""
    return option(1.0, unit="m", help=f"one unit of {words}; 1e-3 for millimetres", rule=positive())


def bodies(mesher: Mesher, bearing: Bearing, make: Callable[[str, str], HexMesh]) -> dict[str, HexMesh]:
    """Meshes of the bodies whose paths the mesher's options name; the ball's mesh at each ball's place.

    Parameters
    ----------
    make : (name of the body, path) -> mesh

    Raises
    ------
    MeshError
        A pair of rows, or what ``make`` raises.
    """
    from raceway.core.mesh.place import azimuth, ball_names, placed

    if len(bearing.rows) > 1:
        raise MeshError(f"mesh.kind = '{mesher.name}' makes one row; use 'structured' for a pair of rows")
    out: dict[str, HexMesh] = {}
    for body in BODIES:
        path = getattr(mesher, body)
        if path is None:
            continue
        mesh = make(body, path)
        if body != "ball":
            out[body] = mesh
            continue
        for index, name in enumerate(ball_names(bearing)):
            out[name] = attrs.evolve(mesh, points=placed(mesh.points, bearing, azimuth(bearing, index)))
    return out


def refuse_no_body(mesher: Mesher) -> None:
    """Raise ``ValueError`` when no body has a path."""
    if all(getattr(mesher, body) is None for body in BODIES):
        raise ValueError(f"names no body: give at least one of {', '.join(f'`{b}`' for b in BODIES)}, each a path")


def with_node_sets(mesh: HexMesh) -> HexMesh:
    """The mesh with a node set for each facet set that has none of its name."""
    from raceway.core.mesh.hex_mesh import nodes_of

    more = {name: nodes_of(mesh.cells, f) for name, f in mesh.facet_sets.items() if name not in mesh.node_sets}
    return attrs.evolve(mesh, node_sets={**mesh.node_sets, **more}) if more else mesh
