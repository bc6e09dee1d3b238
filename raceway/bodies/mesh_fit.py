"""Whether meshes are those of the bearing that they stand for: their size, of which millimetres are the usual mistake, and their sets."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from math import log10
from typing import TYPE_CHECKING

import numpy as np

from raceway.errors import MeshError

if TYPE_CHECKING:
    from raceway.core.mesh.hex_mesh import HexMesh
    from raceway.framework.contracts import Mesher
    from raceway.scene.bearing import Bearing

    #: Larger or smaller by more than this is another unit (inches for millimetres are 25), not another bearing.
    from raceway.scene.tables import Supports

#: Larger or smaller by more than this is another unit (inches for millimetres are 25), not another bearing.
_OTHER_UNIT = 5.0
#: Facets that elastic bodies need.
_SETS = {
    **{
        f"{ring}_ring": {"raceway": "the groove, on which balls press", "seat": "its fit on the shaft or in the housing"}
        for ring in ("inner", "outer")
    },
    "ball": {"surface": "its whole surface, which presses on the grooves"},
}
#: Coarse facets of a ball may miss its poles by a few percent.
_OTHER_SIZE = 0.05


def check_size(mesher: Mesher, bearing: Bearing, meshes: Mapping[str, HexMesh]) -> None:
    """Compare rings and balls with the scene's [bearing]; warn of another size.

    Parameters
    ----------
    meshes : ``inner_ring``, ``outer_ring``, ``ball_...`` are compared, other names are not

    Raises
    ------
    MeshError
        A body in other units, with the remedy.
    """
    told_of: set[str] = set()  # all balls but for one are copies: one warning is enough
    for name, mesh in meshes.items():
        for key, expected, found in _sizes(bearing, name, mesh.points):
            ratio = found / expected
            if not 1.0 / _OTHER_UNIT < ratio < _OTHER_UNIT:
                told = f"the mesh of '{name}' measures {found:.4g} m, but {key} of the bearing is {expected:.4g} m"
                raise _refusal(mesher, name, told, ratio)
            if abs(ratio - 1.0) > _OTHER_SIZE and not key.startswith("the size") and key not in told_of:
                told_of.add(key)
                warnings.warn(
                    f"the mesh of '{name}' measures {found:.4g} m where {key} of the bearing is {expected:.4g} m",
                    stacklevel=3,
                )


def check_sets(mesher: Mesher, meshes: Mapping[str, HexMesh], supports: Supports) -> None:
    """Refuse elastic bodies that are missing, and meshes without the sets on which contacts and seats act.

    Raises
    ------
    MeshError
        The key that names the body's file, the set, and the remedy.
    """
    for body, sets in _SETS.items():
        path = getattr(mesher, body, None)
        key, value = ("mesh.kind", mesher.name) if path is None else (f"mesh.{body}", path)
        mesh = next((mesh for name, mesh in meshes.items() if name.startswith(body)), None)
        if mesh is None:
            what = "one ball, a copy of which stands at each place" if body == "ball" else "this ring"
            raise MeshError.at(f"mesh.{body}", path, f"is required with elastic bodies: the file of {what}")
        held = "seat" if getattr(supports, body.replace("_ring", "_seat"), "") == "rigid" else ""  # its nodes are enough
        for name, where in sets.items():
            try:
                mesh.nodes(name) if name == held else mesh.facets(name)
            except MeshError as why:
                remedy = f'Name the file\'s own: [mesh.sets.{body}] {name} = "..."; or add it to the mesh'
                raise MeshError.at(key, value, f"{why}. '{name}' is {where}. {remedy}") from why


def _sizes(bearing: Bearing, name: str, points: np.ndarray) -> list[tuple[str, float, float]]:
    """What is compared: its name, the bearing's and the mesh's [m]."""
    if name.startswith("ball"):
        return [("`ball_diameter`", bearing.ball_diameter, float(np.ptp(points, axis=0).max()))]
    reach = 2.0 * np.hypot(points[:, 1], points[:, 2])
    if name.startswith("outer_ring"):
        outer = bearing.outer_diameter
        return (
            [("`outer_diameter`", outer, float(reach.max()))]
            if outer
            else [("the size (`pitch_diameter`)", bearing.pitch_diameter, float(reach.max()))]
        )
    if name.startswith("inner_ring"):
        rough = [("the size (`pitch_diameter`)", bearing.pitch_diameter, float(reach.max()))]
        return rough + ([("`bore`", bearing.bore, float(reach.min()))] if bearing.bore and reach.min() > 0.0 else [])
    return []


def _refusal(mesher: Mesher, name: str, told: str, ratio: float) -> MeshError:
    path = str(getattr(mesher, "ball" if name.startswith("ball") else name, ""))
    if path.lower().endswith((".step", ".stp")):
        return MeshError(f"{told}: '{path}' names its own unit; write it again in the right one")
    given: float | None = getattr(mesher, "scale", None)
    if given is None:
        return MeshError(f"{told}: mesher '{mesher.name}' must return metres")
    # Powers of ten are units; anything else is told as it is.
    power = round(log10(1.0 / ratio))
    exact = abs(log10(1.0 / ratio) - power) < 0.2
    scale = given * (10.0**power if exact else 1.0 / ratio)
    unit = " (the file is in millimetres)" if abs(scale / 1e-3 - 1.0) < 1e-6 else ""
    return MeshError.at("mesh.scale", given, f"{told}: write mesh.scale = {scale:.3g}{unit}")
