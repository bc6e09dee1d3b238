"""The static state under the constant loads, ball by ball, and what a user should know about it."""

from __future__ import annotations

from collections.abc import Callable

import attrs
import numpy as np

from raceway.bodies.model import Model
from raceway.bodies.mounting import lost_preload
from raceway.core.ring.kernels.layout import CAGE
from raceway.core.ring.system import COORDINATES
from raceway.errors import ConvergenceError
from raceway.scene.inner_ring import load_at_edge, shoulder_height


@attrs.frozen(eq=False)
class Equilibrium:
    """The static state under the constant loads.

    Attributes
    ----------
    displacement : (5,) x, y, z [m], tilts [rad];  stiffness : (5, 5) tangent of the contacts
    ball : (Z, 2) positions in the meridian planes [m]
    gap, contact_force : (2 Z,) inner races first [m, N]
    angle_inner, angle_outer : (Z,) contact angles [rad], nan where a contact is open
    warnings : what a user should know
    """

    displacement: np.ndarray
    stiffness: np.ndarray
    ball: np.ndarray
    gap: np.ndarray
    contact_force: np.ndarray
    angle_inner: np.ndarray
    angle_outer: np.ndarray
    iterations: int
    warnings: tuple[str, ...]


def settle(
    model: Model, on_progress: Callable[[str, int, int], None] | None = None, near: np.ndarray | None = None
) -> Equilibrium:
    """The static equilibrium of a model.

    Parameters
    ----------
    near : (5,) equilibrium of a similar model, which contacts at surface points start from; others take microseconds
    on_progress : called as ``on_progress(what, done, total)`` while elastic bodies settle; ``total`` is 0: nobody knows

    Raises
    ------
    ConvergenceError
        None found, or a motion that nothing holds (named).
    """
    system = model.system
    _refuse_no_load(model)
    if on_progress is not None:
        system.follow(_telling(on_progress))
    if model.scene.bodies.kind == "elastic":
        _foresee_free_motion(model)
    q, ball, iterations = _settled(model, near)
    still = system.without(CAGE)
    now = still.evaluate(q, ball=ball)
    stiffness = still.stiffness_at(q, now)
    _refuse_free_motion(model, stiffness, q)
    inner, outer = contact_angles(model, q, now.ball, now.contact_force)
    refuse_impossible_ellipses(model, now.contact_force, {"q": q, "ball": now.ball})
    warnings = _warnings(model, inner, outer, now.contact_force)
    return Equilibrium(q, stiffness, now.ball, now.gap, now.contact_force, inner, outer, iterations, warnings)


def _settled(model: Model, near: np.ndarray | None) -> tuple[np.ndarray, np.ndarray, int]:
    if near is not None and model.scene.contact.discretisation == "nodal":
        # What is held stays where the model holds it.
        try:
            return model.system.settle(np.where(model.system.free > 0.0, near, model.guess))
        except ConvergenceError:
            pass  # the model's own guess decides whether there is an equilibrium
    return model.system.settle(model.guess)


def _telling(on_progress: Callable[[str, int, int], None]) -> Callable[[float], None]:
    count = iter(range(1, 1_000_000))
    return lambda residual: on_progress(f"equilibrium, residual {residual:.1e}", next(count), 0)


def contact_angles(
    model: Model, q: np.ndarray, ball: np.ndarray, force: np.ndarray, t: np.ndarray | float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Inner and outer contact angles (Z,) [rad]; nan where the contact carries nothing.  Of several states: (n, Z)."""
    z = model.system.ball_count
    centre = model.system.centre_vectors(q, t, ball)[0]
    axial, radial = centre[..., 0], centre[..., 1]
    if model.plan.balls == "weightless" and model.scene.bodies.kind != "elastic":
        inner = outer = np.arctan2(axial, radial)
    else:
        inner = np.arctan2(axial - ball[..., 0], radial - ball[..., 1])
        outer = np.arctan2(ball[..., 0], ball[..., 1])
    return np.where(force[..., :z] > 0, inner, np.nan), np.where(force[..., z:] > 0, outer, np.nan)


def _refuse_no_load(model: Model) -> None:
    loaded = np.any(model.system.load * model.system.free) or model.scene.bearing.preload > 0.0
    if not loaded and model.system.free[0] > 0.0:
        raise ConvergenceError(
            "nothing loads the bearing: every motion is free and there is no stiffness to find. Set `load.axial`, or hold "
            'the ring with supports.axial = "displacement" under an axial load.'
        )


def _foresee_free_motion(model: Model) -> None:
    """What nothing holds shows on the same ring with rigid bodies in milliseconds; elastic ones would iterate for minutes."""
    rigid = model.system.companion
    q, ball, _ = rigid.settle(model.guess)
    now = rigid.evaluate(q, ball=ball)
    _refuse_free_motion(model, rigid.stiffness_at(q, now), q)


def _refuse_free_motion(model: Model, stiffness: np.ndarray, q: np.ndarray) -> None:
    system = model.system
    chosen = np.flatnonzero(system.free > 0.0)
    weight = np.array([1.0, 1.0, 1.0, 1.0 / system.arm, 1.0 / system.arm])[chosen]
    scaled = weight[:, None] * system.reduced(stiffness + system.stiffness) * weight
    values, vectors = np.linalg.eigh(0.5 * (scaled + scaled.T))
    if values[-1] > 0.0 and values[0] > 1e-12 * values[-1]:
        return
    motion = np.abs(vectors[:, 0])
    names = [COORDINATES[chosen[k]] for k in np.argsort(-motion) if motion[k] > 0.3 * motion.max()]
    held = "supports.tilt" if names[0].startswith("tilt") else "an axial load"
    why = lost_preload(model) or f"Hold it ({held}) or load more balls."
    raise ConvergenceError(
        f"the equilibrium is singular: nothing holds the ring against {' with '.join(names)}. {why}",
        {"q": q},
    )


def _braced(model: Model) -> bool:
    return model.scene.load.axial != 0.0 or model.scene.bearing.preload > 0.0


def _warnings(model: Model, inner: np.ndarray, outer: np.ndarray, force: np.ndarray) -> tuple[str, ...]:
    found = []
    if model.geometry.contact_angle > 0.0 and _braced(model) and np.nanmin(inner, initial=np.inf) <= 0.0:
        found.append("the bearing unseats: the contact angle of a loaded ball is zero or negative")
    if any(model.scene.load.moment) and model.scene.supports.tilt == "locked":
        found.append("`load.moment` has no effect: supports.tilt is locked")
    if model.scene.contact.friction > 0.0:
        found.append("friction is on: balls that do not roll add a tangential stiffness which turning bearings do not have")
    return (*found, *beyond_the_groove(model, inner, outer, force))


def beyond_the_groove(model: Model, inner: np.ndarray, outer: np.ndarray, force: np.ndarray) -> list[str]:
    """A sentence for each race whose contact ellipses run over the groove's edge; angles (Z,), forces (2 Z,)."""
    d, depth, edge = model.geometry.ball_diameter, shoulder_height(model.scene), groove_edge(model)
    found = []
    overs = ellipse_ends(model, inner, outer, force)
    for race, ellipse, angle, over in zip(
        ("inner", "outer"), (model.inner, model.outer), (inner, outer), overs, strict=True
    ):
        reach = np.nanmax(over, initial=0.0)
        if reach > edge:
            begins = load_at_edge(ellipse, 0.5 * d, edge - abs(angle[np.nanargmax(over)]))
            assumed = "" if model.scene.bearing.shoulder_height else ", assumed 0.2 D"
            found.append(
                f"the contact ellipse on the {race} race reaches {np.degrees(reach):.1f} deg, beyond the groove's edge at "
                f"{np.degrees(edge):.1f} deg (bearing.shoulder_height = {depth:.3g} m{assumed}): it is cut off there in reality, at this "
                f"contact angle from {begins:.3g} N a ball"
            )
    return found


def groove_edge(model: Model) -> float:
    """Angle from the groove's bottom to its edge, seen from the ball's centre [rad]."""
    return float(np.arccos(1.0 - shoulder_height(model.scene) / (0.5 * model.geometry.ball_diameter)))


def ellipse_ends(model: Model, inner: np.ndarray, outer: np.ndarray, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angle (..., Z) of the far end of each contact ellipse, inner and outer; angles (..., Z), forces (..., 2 Z)."""
    z, radius = model.system.ball_count, 0.5 * model.geometry.ball_diameter
    return (
        np.abs(inner) + model.inner.semi_axes(force[..., :z])[0] / radius,
        np.abs(outer) + model.outer.semi_axes(force[..., z:])[0] / radius,
    )


def refuse_impossible_ellipses(model: Model, force: np.ndarray, state: dict[str, np.ndarray] | None = None) -> None:
    """Loads (2 Z,) [N] that no ball can carry: a contact ellipse longer than half its circumference.

    Raises
    ------
    ConvergenceError
        With ``state``, the solution that says so.
    """
    z, radius = model.system.ball_count, 0.5 * model.geometry.ball_diameter
    for race, ellipse, load in (("inner", model.inner, force[:z]), ("outer", model.outer, force[z:])):
        half = ellipse.semi_axes(load)[0] / radius
        if half.max(initial=0.0) >= 0.5 * np.pi:
            raise ConvergenceError(
                f"the contact ellipse on the {race} race would be {np.degrees(2.0 * half.max()):.0f} deg of the ball long, more than half "
                f"its circumference, under {load[np.argmax(half)]:.3g} N a ball: no such contact exists. Check units and loads "
                "(bearing.rings.young in Pa, lengths in m)",
                state,
            )
