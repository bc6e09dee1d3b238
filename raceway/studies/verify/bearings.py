"""Computation of the bearing cases: each through a scene, as a user would write it.

Numbers are in the unit of the source.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import pi
from typing import TYPE_CHECKING

import numpy as np

from raceway.bodies.model import build_model
from raceway.core.contact.hertz import ellipse
from raceway.framework.registry import Registry
from raceway.pipeline.run import run
from raceway.planning.plan import make_plan
from raceway.scene.reading import scene_from_dict
from raceway.scene.scene import Scene
from raceway.studies.many.reference import Case, Number

if TYPE_CHECKING:
    from raceway.framework.contracts import Excitation

INCH, POUND, PSI = 0.0254, 4.4482216152605, 6894.757293168361

Numbers = Iterator[Number]


def masta(case: Case, registry: Registry) -> Numbers:
    """Displacements of a deep-groove bearing with tilts free.

    Notes
    -----
    Frame: the source's radial x is our y, its axial z our x.  Both arms of a tilt are d_m / 2: ``tilt_arm = "pitch"``.
    The source counts the axial displacement from the middle of the axial clearance, we from the first touch: add
    B sin(alpha0).  The source takes the curvatures at a contact angle of zero, we at the free one: worth 4e-5.
    """
    given = case.inputs
    scene = scene_from_dict(
        {
            "title": case.id,
            "bearing": {
                "preset": "DGB7-MASTA",
                "radial_clearance": float(given["Gr_mm"]) * 1e-3,
                "first_ball_azimuth_deg": given["first_ball_angle_deg"],
                "tilt_arm": "pitch",
            },
            "supports": {"tilt": "free"},
            "load": {
                "axial": float(given["Fz_N"]),
                "radial": [float(given["Fx_N"]), 0.0],
                "moment": [given["Mx_Nmm"] * 1e-3, 0.0],
            },
        },
        registry,
    )
    result = run(scene, registry)
    q = result.equilibrium.displacement
    computed = {
        "dr_um": ("radial displacement [um]", 1e6 * float(np.hypot(q[1], q[2]))),
        "da_um": ("axial displacement from mid-clearance [um]", 1e6 * float(q[0] + result.model.geometry.rest[0])),
        "psi_mrad": ("tilt [mrad]", 1e3 * float(np.hypot(q[3], q[4]))),
    }
    for key, reference in case.outputs.items():
        yield Number(computed[key][0], reference, computed[key][1], case.rel_tol)


def race_ellipse(case: Case, registry: Registry) -> Numbers:
    """Ellipse, approach and pressure of the inner race at a given load and contact angle (the loaded one)."""
    given = case.inputs
    scene = scene_from_dict(
        {
            "title": case.id,
            "bearing": {"preset": "ACB21-HARRIS-MINDEL", "contact_angle_deg": given["alpha_deg"]},
            "load": {"axial": 3000.0 * POUND},
        },
        registry,
    )
    inner = build_model(scene, make_plan(scene)).inner
    load = given["Q_lb"] * POUND
    a, b = inner.semi_axes(load)
    computed = {
        "a_in": ("semi-major axis [in]", a / INCH),
        "b_in": ("semi-minor axis [in]", b / INCH),
        "delta_in": ("approach [in]", inner.approach(load) / INCH),
        "pmax_psi": ("peak pressure [psi]", inner.peak_pressure(load) / PSI),
    }
    for key, reference in case.outputs.items():
        yield Number(computed[key][0], reference, float(computed[key][1]), case.rel_tol)


def ellipse_table(case: Case, registry: Registry) -> Numbers:
    """a*, b* and delta* for a column of curvature differences: no bearing, so the Hertz functions themselves."""
    for difference, a_star, b_star, delta_star in case.outputs["rows"]:
        found = ellipse(1.0, difference, 1.0)
        where = f"at F(rho) = {difference:g}"
        yield Number(f"a* {where}", a_star, found.a_star, case.rel_tol)
        yield Number(f"b* {where}", b_star, found.b_star, case.rel_tol)
        yield Number(f"delta* {where}", delta_star, found.delta_star, case.rel_tol)


def nsk_pair(case: Case, registry: Registry) -> Numbers:
    """Stiffness of a mounted duplex pair, tilts locked: twice the tangent of one row at an axial load equal to the
    preload, as the source's conventions say, and from a scene that is the pair itself."""
    for quantity, factor, pair in (("", 2.0, False), (" as pair", 1.0, True)):
        axial, radial = case.outputs["ka_pair_N_per_um"], case.outputs["kr_pair_N_per_um"]
        for preload, ka, kr in zip(case.inputs["preload_N"], axial, radial, strict=True):
            stiffness = run(_nsk_scene(case, float(preload), pair, registry), registry).equilibrium.stiffness
            where = f"of the pair at {preload} N{quantity} [N/um]"
            yield Number(f"axial stiffness {where}", ka, factor * 1e-6 * float(stiffness[0, 0]), case.rel_tol["ka"])
            yield Number(f"radial stiffness {where}", kr, factor * 1e-6 * float(stiffness[1, 1]), case.rel_tol["kr"])


def _nsk_scene(case: Case, preload: float, pair: bool, registry: Registry) -> Scene:
    bearing = {"preset": "7206C-NSK" if case.inputs["alpha_deg"] == 15 else "7206A-NSK"}
    if pair:
        # Locked tilts: the distance of the rows does not count.
        return scene_from_dict(
            {"title": case.id, "bearing": {**bearing, "arrangement": "DB", "preload": preload, "row_distance": 16e-3}},
            registry,
        )
    return scene_from_dict({"title": case.id, "bearing": bearing, "load": {"axial": preload}}, registry)


def rig_force(case: Case, registry: Registry) -> Numbers:
    """The rig's unbalance force, read off what the excitations' compiled kernels put out over a turn."""
    given, out = case.inputs, case.outputs
    moment = given["m_g"] * 1e-3 * given["e_mm"] * 1e-3
    for kind in ("bidirectional", "unidirectional"):
        for rpm, whole, half, frequency in zip(given["rpm"], out["F0_N"], out["Ftr_N"], out["f_Hz"], strict=True):
            where = f"{kind}, {rpm} r/min"
            rotor, bearing = (_excited(kind, rpm, moment, share, registry) for share in (1.0, 0.5))
            yield Number(f"force of the rotor, {where} [N]", whole, _largest_force(rotor.excitation), case.rel_tol)
            yield Number(f"force on each bearing, {where} [N]", half, _largest_force(bearing.excitation), case.rel_tol)
            yield Number(f"frequency, {where} [Hz]", frequency, bearing.excitation.frequency_hz, case.rel_tol)


def _excited(kind: str, rpm: float, moment: float, share: float, registry: Registry) -> Scene:
    excitation = {
        "kind": kind,
        "speed_rpm": float(rpm),
        "amplitude": "unbalance",
        "unbalance": moment,
        "load_share": share,
    }
    tables = {"title": "rig", "bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}, "excitation": excitation}
    return scene_from_dict(tables, registry)


def _largest_force(excitation: Excitation) -> float:
    """Largest radial force [N] over one turn, sampled at eight instants, the first of which is a crest."""
    kernel, params, out = excitation.kernel(), excitation.parameters(), np.zeros(5)
    largest = 0.0
    for phase in np.arange(8) * pi / 4.0:
        kernel(float(phase / (2.0 * pi * excitation.frequency_hz)), params, out)
        largest = max(largest, float(np.hypot(out[1], out[2])))
    return largest
