"""The meshes of a scene's bodies: the mesher that [mesh] names, on the scene's bearing, judged before they are handed on."""

import warnings
from collections.abc import Mapping
from math import log10

import attrs
import numpy as np

from raceway.core.fem.mesh.hex_mesh import HexMesh
from raceway.core.fem.mesh.quality import Prediction, body_bytes, refuse_bad_cells, refuse_memory
from raceway.errors import MeshError, Mistake, PluginError, SceneError
from raceway.framework.contracts import Mesher
from raceway.framework.loading.sources import blamed
from raceway.planning.resolve import Problem
from raceway.scene.bearing import Bearing
from raceway.scene.tables import Supports
from raceway.storage.tables import Tables

#: Larger or smaller by more than this is another unit (inches for millimetres are 25), not another bearing.
_OTHER_UNIT = 5.0
#: Facets that elastic bodies need.
_SETS = {
    **{
        f"{ring}_ring": {"raceway": "the groove, on which balls press", "seat": "its fit on the shaft or in the housing"}
        for ring in ("inner", "outer")
    },
    "ball": {"surface": "its complete surface, which presses on the grooves"},
}
#: Coarse facets of a ball may miss its poles by a few percent.
_OTHER_SIZE = 0.05


def _check_size(mesher: Mesher, bearing: Bearing, meshes: Mapping[str, HexMesh]) -> None:
    """Compare rings and balls with the scene's [bearing]; warn of another size.

    meshes : ``inner_ring``, ``outer_ring``, ``ball_...`` are compared, other names are not

    MeshError: a body in other units, with the remedy.
    """
    told_of: set[str] = set()  # all balls but for one are copies: one warning is enough
    for name, mesh in meshes.items():
        for key, expected, measured in _sizes(bearing, name, mesh.points):
            ratio = measured / expected
            if not 1.0 / _OTHER_UNIT < ratio < _OTHER_UNIT:
                words = f"the mesh of '{name}' measures {measured:.4g} m, but {key} of the bearing is {expected:.4g} m"
                raise _refusal(mesher, name, words, ratio)
            if abs(ratio - 1.0) > _OTHER_SIZE and not key.startswith("the size") and key not in told_of:
                told_of.add(key)
                text = f"the mesh of '{name}' measures {measured:.4g} m where {key} of the bearing is {expected:.4g} m"
                warnings.warn(text, stacklevel=3)


def check_sets(mesher: Mesher, meshes: Mapping[str, HexMesh], supports: Supports) -> None:
    """Refuse elastic bodies that are missing, and meshes without the sets on which contacts and seats act.

    MeshError: The key that names the body's file, the set, and the remedy.
    """
    for body, sets in _SETS.items():
        path = getattr(mesher, body, None)
        key, value = ("mesh.kind", mesher.name) if path is None else (f"mesh.{body}", path)
        mesh = next((mesh for name, mesh in meshes.items() if name.startswith(body)), None)
        if mesh is None:
            body_words = "one ball, copied to each azimuth" if body == "ball" else "this ring"
            raise MeshError.at(f"mesh.{body}", path, f"is required with elastic bodies: the file of {body_words}")
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
    rough = [("the size (`pitch_diameter`)", bearing.pitch_diameter, float(reach.max()))]
    if name.startswith("outer_ring"):
        outer = bearing.outer_diameter
        return [("`outer_diameter`", outer, float(reach.max()))] if outer else rough
    if name.startswith("inner_ring"):
        return rough + ([("`bore`", bearing.bore, float(reach.min()))] if bearing.bore and reach.min() > 0.0 else [])
    return []


def _refusal(mesher: Mesher, name: str, fault: str, ratio: float) -> MeshError:
    path = str(getattr(mesher, "ball" if name.startswith("ball") else name, ""))
    if path.lower().endswith((".step", ".stp")):
        return MeshError(f"{fault}: '{path}' states its unit; write it again in the right one")
    present: float | None = getattr(mesher, "scale", None)
    if present is None:
        return MeshError(f"{fault}: mesher '{mesher.name}' must return metres")
    # Powers of ten are units; anything else is told as it is.
    power = round(log10(1.0 / ratio))
    exact = abs(log10(1.0 / ratio) - power) < 0.2
    scale = present * (10.0**power if exact else 1.0 / ratio)
    unit = " (the file is in millimetres)" if abs(scale / 1e-3 - 1.0) < 1e-6 else ""
    return MeshError.at("mesh.scale", present, f"{fault}: write mesh.scale = {scale:.3g}{unit}")


#: Poisson's ratio from which contacts at surface points are too stiff by percents: measured with B7206C, which does not
#: change with the mesh: 2 % at 0.49, 20 % at 0.499, 75 % at 0.4999.  One-point elements with hourglass control: 20 % at 0.45.
_FROM, _ONE_POINT = 0.49, 0.4


def locking(problem: Problem, one_point: bool = False) -> list[str]:
    """A warning for each material that is nearly incompressible; ``one_point`` : of elements with hourglass control."""
    least = _ONE_POINT if one_point else _FROM
    warnings = []
    for part in ("rings", "balls"):
        poisson = getattr(problem.bearing, part).poisson
        if poisson >= least:
            warnings.append(
                f"bearing.{part}.poisson = {poisson:g}: elements lock near 0.5; contacts at surface points are too stiff by "
                f"{'tens of percent' if one_point or poisson > 0.495 else 'percents'} whatever the mesh; use bodies.kind = "
                "'condensed' with contact.discretisation = 'resultant', or rigid bodies, whose contacts are Hertz's"
            )
    return warnings


def mesher_of(problem: Problem) -> Mesher:
    """The scene's mesher; an option ``ball_load`` that is left out becomes the static load of a ball under the axial load.

    SceneError: A scene without [mesh].
    """
    if problem.mesh is None:
        raise SceneError.at("mesh", None, 'is required here: for instance [mesh] with kind = "structured"')
    options = {field.name for field in attrs.fields(type(problem.mesh))}
    if "ball_load" in options and problem.mesh.ball_load is None and problem.load.axial != 0.0:
        return attrs.evolve(problem.mesh, ball_load=problem.axial_approach[1])
    return problem.mesh


def mesh_bodies(problem: Problem) -> dict[str, HexMesh]:
    """Meshes by the name of the body, as ``HexMesh``, without inverted or degenerate cells.

    MeshError: What the mesher refuses, a bad cell, or a body in other units than metres.
    PluginError: A mesher that returns something else, or raises anything but a ``RacewayError``.
    """
    mesher = mesher_of(problem)
    with blamed(f"mesher '{mesher.name}'", "mesh()"):
        meshes = mesher.mesh(problem.bearing)
    if not isinstance(meshes, Mapping) or not meshes:
        raise PluginError(f"mesher '{mesher.name}': mesh() returned {type(meshes).__name__}; it must be meshes by name")
    out: dict[str, HexMesh] = {}
    for name, mesh in meshes.items():
        try:
            parts = mesh.points, mesh.cells, getattr(mesh, "node_sets", {}), getattr(mesh, "facet_sets", {})
            out[str(name)] = mesh if isinstance(mesh, HexMesh) else HexMesh(*parts)
        except (AttributeError, MeshError) as why:
            raise PluginError(f"mesher '{mesher.name}': body '{name}' is no mesh: {why}") from why
        refuse_bad_cells(out[str(name)], str(name))
    _check_size(mesher, problem.bearing, out)
    return out


def mesh_faults(problem: Problem) -> list[Mistake]:
    """Why the table [mesh] cannot be used: sizes that its mesher refuses or the memory does not hold."""
    if problem.mesh is None:
        return []
    try:
        _prediction(problem)
    except MeshError as error:
        return [error.mistake or Mistake("mesh", None, str(error))]
    return []


def unrefined(problem: Problem, who: str) -> list[Mistake]:
    """A mesh without cells along a contact, which some bodies need; ``who``: in words."""
    if problem.mesh is None or refined(problem):
        return []
    why = f"{who} need cells along a contact: use at least 1, or elastic bodies with contact.discretisation = 'resultant'"
    return [Mistake("mesh.nodes_per_semi_axis", 0, why)]


def refined(problem: Problem) -> bool:
    """Whether a structured mesh has cells along a contact ellipse; those of other meshers are not known."""
    return bool(getattr(problem.mesh, "nodes_per_semi_axis", 1))


def predicted_mesh(problem: Problem) -> Tables | None:
    """Predicted size of the scene's mesh.

    ``bodies[{name, cells, bytes}]`` (what each mesh keeps), ``cells`` of all, ``bytes`` at the peak while they are
    made; None without [mesh], and where the mesher cannot predict it before it reads or meshes.

    MeshError: Sizes that cannot work.
    PluginError: A mesher whose prediction is none, or that raises anything but a ``RacewayError``.
    """
    prediction = None if problem.mesh is None else _prediction(problem)
    if prediction is None:
        return None

    bodies = [{"name": name, "cells": cells, "bytes": body_bytes(cells)} for name, cells in prediction.bodies.items()]
    return {"bodies": bodies, "cells": prediction.cells, "bytes": prediction.memory_bytes}


def _prediction(problem: Problem) -> Prediction | None:
    """Prediction by the mesher's ``predict``, if it has one; refused where it would not fit."""
    mesher = mesher_of(problem)
    if not hasattr(mesher, "predict"):
        return None

    with blamed(f"mesher '{mesher.name}'", "predict()"):
        prediction = mesher.predict(problem.bearing)
    if prediction is None:  # it cannot tell before it reads or meshes
        return None
    if isinstance(prediction, Mapping) and all(isinstance(cells, int) for cells in prediction.values()):
        prediction = Prediction.of({str(name): cells for name, cells in prediction.items()})
    if not isinstance(prediction, Prediction):
        why = f"mesher '{mesher.name}': predict() returned {type(prediction).__name__}; it must be body -> number of cells"
        raise PluginError(why)
    refuse_memory(prediction, "mesh.kind", mesher.name, "take larger elements")
    return prediction


def least_step(problem: Problem) -> float:
    """Step that elements have to allow by added mass [s]; 0: none is added."""
    return float(getattr(problem.integrator.method, "least_step", None) or 0.0)
