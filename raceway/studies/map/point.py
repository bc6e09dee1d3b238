"""One point of the map: a run, and what it says of stiffness, contact and the groove's edges."""

from __future__ import annotations

import numpy as np

from raceway.errors import RacewayError
from raceway.framework.registry import Registry
from raceway.pipeline.result import Result
from raceway.pipeline.run import run
from raceway.scene.inner_ring import shoulder_height
from raceway.scene.scene import Scene
from raceway.storage.tables import Tables


def point_row(scene: Scene, registry: Registry) -> Tables:
    """Run a scene; its numbers, or why there are none.

    Returns
    -------
    row : ``status`` "completed", "failed" (numbers) or "refused" (the scene), ``reason``; with numbers

        - ``stiffness`` K, ``error`` of Z relative, ``small_signal`` stiffness of the tangent at rest [N/m], ``force`` [N]
        - ``lost`` balls that leave the inner race during a turn, ``unseats`` whether a loaded ball's angle falls to zero or below
        - ``reach_inner``, ``reach_outer``: farthest end of a contact ellipse over the groove's edge, both as angles
        - ``largest_load`` [N], ``largest_pressure`` [Pa], ``axial_displacement`` [m]
    """
    try:
        result = run(scene, registry)
    except RacewayError as error:
        status = "failed" if error.exit_code == 1 else "refused"
        return {"status": status, "reason": str(error).splitlines()[0]}
    found, record = result.identification, result.simulation
    if found is None or record is None:
        return {"status": "refused", "reason": "nothing moves: the map needs an excitation and an identifier of its motion"}
    inner, outer, least = _reaches(result)
    loads = record.record.contact_force
    model, z = result.model, result.model.system.ball_count
    most = np.array([[loads[:, :z].max()], [loads[:, z:].max()]])
    peaks = [float(model.bearing.contact_ellipse(model, race, load)[0][0]) for race, load in enumerate(most)]
    return {
        "status": "completed",
        "reason": "",
        "stiffness": float(found.equivalent_stiffness),
        "error": result.error["total"],
        "small_signal": small_signal(result),
        "force": float(found.force_amplitude),
        "lost": int((loads[:, :z] == 0.0).any(axis=0).sum()),
        "unseats": bool(result.model.geometry.contact_angle > 0.0 and least <= 0.0),
        "reach_inner": inner,
        "reach_outer": outer,
        "largest_load": float(loads[:, :z].max()),
        "largest_pressure": max(peaks),
        "axial_displacement": float(record.record.displacement[:, 0].mean()),
    }


def small_signal(result: Result) -> float:
    """Radial stiffness k_yy of the tangent at rest with what the supports leave free let go [N/m]."""
    system = result.model.system
    tangent = result.equilibrium.stiffness_rows_held + system.stiffness
    others = [i for i in (0, 2, 3, 4) if system.free[i] > 0.0]
    if not others:
        return float(tangent[1, 1])
    # Tilts and lengths have different units: scaled, so that the solve stays well conditioned.
    scale = np.array([1.0, 1.0, 1.0, system.arm, system.arm])
    even = tangent / np.outer(scale, scale)
    return float(even[1, 1] - even[1, others] @ np.linalg.solve(even[np.ix_(others, others)], even[others, 1]))


def _reaches(result: Result) -> tuple[float, float, float]:
    """Farthest ends of the inner and outer ellipses over the groove's edge, and the least contact angle [rad], over the record."""
    model, record = result.model, result.simulation.record if result.simulation is not None else None
    assert record is not None
    z, radius = model.system.ball_count, 0.5 * model.geometry.ball_diameter
    edge = float(np.arccos(1.0 - shoulder_height(model.scene) / radius))
    reach, least = [0.0, 0.0], np.inf
    for q, ball, force, t in zip(record.displacement, record.ball, record.contact_force, record.time, strict=True):
        angles = model.bearing.contact_angles(model, q, ball, force, t)
        for lane, (ellipse, angle, load) in enumerate(
            ((model.inner, angles[0], force[:z]), (model.outer, angles[1], force[z:]))
        ):
            half = ellipse.semi_axes(load)[0] / radius
            reach[lane] = max(reach[lane], float(np.nanmax(np.abs(angle) + half, initial=0.0)) / edge)
        least = min(least, float(np.nanmin(angles[0], initial=np.inf)))
    return reach[0], reach[1], least
