"""The article's static check: peak pressures of a finite-element bearing against exact Hertz in the rigid equilibrium."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from raceway.bodies.model import Model, build_model
from raceway.framework.registry import Registry
from raceway.pipeline.settle import settle
from raceway.planning.plan import make_plan
from raceway.scene.reading import scene_from_dict
from raceway.storage.tables import Tables
from raceway.studies.many.reference import Case, Number


def article_pressures(case: Case, registry: Registry) -> Iterator[Number]:
    """Largest nodal pressure of each race in each load case, and what fewer points would have given.

    Notes
    -----
    The reference is computed, too: exact Hertz at the ball loads of rigid rings, as the article's program does.  The table of
    the article is lost; its text gives the largest deviation, which is the tolerance, and that of the heaviest case.
    """
    given, tolerance = case.inputs, case.rel_tol
    for axial, radial in given["loads_n"]:
        where = f"{axial:g} N axial" + (f", {radial:g} N radial" if radial else "")
        reference = _hertz(_model(axial, radial, None, registry))
        computed = _nodal(_model(axial, radial, int(given["points"]), registry))
        for race in ("inner", "outer"):
            yield Number(
                f"peak pressure, {race} race, {where} [MPa]", reference[race], computed[race], tolerance["pressure"]
            )
    axial, radial = given["loads_n"][int(given["heaviest"])]
    fine, coarse = (_nodal(_model(axial, radial, int(n), registry)) for n in given["independence_points"])
    words = f"{given['independence_points'][1]} points per semi-axis against {given['independence_points'][0]}"
    for race in ("inner", "outer"):
        quantity = f"mesh independence: {race} race, {axial:g} N axial, {words} [MPa]"
        yield Number(quantity, fine[race], coarse[race], tolerance["mesh"])


def _model(axial: float, radial: float, points: int | None, registry: Registry) -> Model:
    """B7206C with rigid bodies and Hertz, or with so many surface points along each semi-axis."""
    tables: Tables = {
        "title": "article, section 3.2",
        "bearing": {"preset": "B7206C"},
        "load": {"axial": float(axial), "radial": [float(radial), 0.0]},
    }
    if points is not None:
        tables["bodies"] = {"kind": "condensed"}
        tables["contact"] = {"kind": "unilateral", "discretisation": "nodal"}
        tables["mesh"] = {"kind": "structured", "nodes_per_semi_axis": points, "element_size": 0.8e-3}
    scene = scene_from_dict(tables, registry)
    return build_model(scene, make_plan(scene))


def _hertz(model: Model) -> dict[str, float]:
    """Largest peak pressure of each race by exact Hertz [MPa]."""
    force, z = settle(model).contact_force, model.system.ball_count
    loads = {"inner": force[:z].max(), "outer": force[z:].max()}
    return {race: 1e-6 * float(getattr(model, race).peak_pressure(load)) for race, load in loads.items()}


def _nodal(model: Model) -> dict[str, float]:
    """Largest pressure at a surface point of each race [MPa]."""
    columns = model.bearing.ball_columns(model, settle(model))
    return {race: 1e-6 * float(np.max(columns[f"peak_pressure_nodal_{race}_pa"])) for race in ("inner", "outer")}
