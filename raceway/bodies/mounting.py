"""What a bearing is mounted with: the preload of a pair, an axial displacement that is held.

Both are set at standstill, before anything has grown; speed and temperature then change the forces that they give.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

import attrs
import numpy as np

from raceway.bodies.basis import Basis, first_guess
from raceway.core.ring.changing_speed import ChangingSpeed
from raceway.core.ring.kernels import layout as ring
from raceway.core.ring.ring import Ring, Spin
from raceway.errors import ConvergenceError
from raceway.planning.recording import turns_of
from raceway.scene.inner_ring import radial_growth
from raceway.scene.tables import Scene
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.bodies.equilibrium import Equilibrium
    from raceway.bodies.model import Model

R = TypeVar("R", bound=Ring)
#: The force of a spring is met to this part of the preload.
_TOLERANCE = 1e-9
#: First step of the search for a sprung ring's place, over the distance of the groove centres; steps of that search.
_STEP, _LIMIT = 0.01, 60
#: Times at which the speeds of a run are looked at, and steady speeds that a sprung ring is placed at.
_SAMPLES, _SPEEDS = 1001, 17


def place_ring(scene: Scene, basis: Basis, system: Ring) -> np.ndarray:
    """(5,) first guess of the equilibrium; builds the preload of a pair into the system, finds a held axial displacement."""
    guess = first_guess(scene, basis)
    growth, geometry = radial_growth(scene), basis.geometry
    preloaded = scene.bearing.preload > 0.0
    if preloaded:
        row = _row(system.as_mounted(growth), 0, geometry.ball_count, facing=True)
        start = np.array([0.05 * geometry.centre_distance, 0.0, 0.0, 0.0, 0.0])
        system.table[:, ring.SHIFT] = _under(row, scene.bearing.preload).settle(start)[0][0]
        guess[0] = 0.0
    sprung = preloaded and scene.bearing.preload_kind == "spring"
    if scene.supports.axial == "displacement":
        mounted = _under(system.as_mounted(growth), scene.load.axial)
        start = np.array([guess[0], 0.0, 0.0, 0.0, 0.0])
        guess = _follow_spring(scene, basis, mounted, start) if sprung else mounted.settle(start)[0]
    if sprung:
        if system.spin is not None:
            system.spin = _follow_speed(scene, basis, system, system.spin, guess)
        guess = _follow_spring(scene, basis, system, guess)
    return guess


def _under(system: R, axial: float) -> R:
    """The system under an axial load alone, the other coordinates held."""
    one = np.array([1.0, 0.0, 0.0, 0.0, 0.0])
    return attrs.evolve(system, load=axial * one, free=one)


def _row(system: R, index: int, balls: int, facing: bool = False) -> R:
    """One row of a system; ``facing``: as a single bearing in its own plane, not preloaded, which positive axial motions seat."""
    chosen = slice(index * balls, (index + 1) * balls)
    table = system.table[chosen].copy()
    if facing:
        table[:, [ring.SIDE, ring.LEVER, ring.SHIFT]] = 1.0, 0.0, 0.0
    return system.of_balls(chosen, table)


def _follow_speed(scene: Scene, basis: Basis, system: Ring, spin: Spin, guess: np.ndarray) -> Spin:
    """The changing speed with the second row's shift over the speeds of the run, a cubic spline through those of steady speeds."""
    from scipy.interpolate import CubicSpline

    assert isinstance(spin, ChangingSpeed)
    spin = attrs.evolve(spin, shift=None)
    duration = turns_of(scene) / scene.excitation.frequency_hz
    met = spin.speed(np.linspace(0.0, duration, _SAMPLES))
    speeds = np.linspace(met.min(), met.max(), _SPEEDS)
    shifts = []
    for speed in speeds:
        steady = spin.constants(system, float(speed))
        _follow_spring(scene, basis, steady, guess)
        shifts.append(steady.table[-1, ring.SHIFT])
    return attrs.evolve(spin, shift=CubicSpline(speeds, shifts))


def _follow_spring(scene: Scene, basis: Basis, system: Ring, guess: np.ndarray) -> np.ndarray:
    """(5,) equilibrium at which the second row carries the spring's force; builds that row's place into the system.

    Notes
    -----
    With the shift s of the row, whose force on the ring is f, and K the tangents: its axial force g = side f_x grows by
    dg/ds = k_xx - k_xq K^-1 k_qx, the ring following.  Newton's method in s within a bracket.

    Raises
    ------
    ConvergenceError
        No such place.
    """
    z, wanted = basis.geometry.ball_count, scene.bearing.preload
    side, free = scene.bearing.rows[1][0], system.free > 0.0
    low, high = -np.inf, np.inf
    step = _STEP * basis.geometry.centre_distance
    shift, q = float(system.table[z, ring.SHIFT]), guess
    for _ in range(_LIMIT):
        system.table[z:, ring.SHIFT] = shift
        q, ball, _ = system.settle(q)
        still = system.without(ring.CAGE)
        whole, row = still.evaluate(q, ball=ball), _row(still, 1, z).evaluate(q, ball=ball[z:])
        excess = side * float(row.force[0]) - wanted
        if abs(excess) <= _TOLERANCE * wanted:
            return q
        low, high = (low, shift) if excess > 0.0 else (shift, high)
        tangent = system.reduced(whole.stiffness + system.stiffness)
        follows = np.linalg.lstsq(tangent, row.stiffness[free, 0], rcond=None)[0]
        slope = float(row.stiffness[0, 0] - row.stiffness[0, free] @ follows)
        trial = shift - excess / slope if slope > 0.0 else np.nan
        if not (low < trial < high and abs(trial - shift) < 4.0 * step):
            bounded = np.isfinite(low) and np.isfinite(high)
            trial = 0.5 * (low + high) if bounded else shift - np.copysign(step, excess)
        shift = trial
    raise ConvergenceError(
        f"no place of the second row was found at which it carries the spring of `bearing.preload` = {wanted:g} N under these "
        "loads: raise the preload, or take preload_kind = 'rigid'.",
        {"q": q},
    )


def preload_table(model: Model, equilibrium: Equilibrium) -> Tables | None:
    """``equilibrium.preload`` of result.json; None without preload.

    Notes
    -----
    ``running_n`` is what both rows of the turning, warm pair carry against each other without any load, ``rows_n`` the axial
    forces of the rows under the constant loads.
    """
    bearing = model.scene.bearing
    if bearing.preload == 0.0:
        return None
    running = running_preload(model)
    rows = _row_forces(model, equilibrium.displacement, equilibrium.ball)
    return {"kind": bearing.preload_kind, "mounted_n": bearing.preload, "running_n": running, "rows_n": rows}


def running_preload(model: Model) -> float:
    """What both rows of a turning, warm pair carry against each other without any load [N]; 0 where both are loose."""
    bearing = model.scene.bearing
    if bearing.preload_kind == "spring":
        return bearing.preload
    try:
        q, ball, _ = _under(model.system, 0.0).settle(np.zeros(5))
    except ConvergenceError:
        return 0.0
    return _row_forces(model, q, ball)[0]


def lost_preload(model: Model) -> str:
    """What took the whole preload of a pair and the remedy; empty where some is left, or there was none.

    Notes
    -----
    Centrifugal forces of balls and growth of rings raise a pair's preload: a raceway that shrinks is what takes it.
    """
    bearing, kinematics = model.scene.bearing, model.scene.kinematics
    if bearing.preload == 0.0 or running_preload(model) > 0.0:
        return ""
    return (
        f"The preload of {bearing.preload:g} N is gone: both rows are loose, as the inner raceway has shrunk by "
        f"{-1e6 * radial_growth(model.scene):.3g} um (kinematics.radial_expansion = {kinematics.radial_expansion:g} m) since they "
        "were mounted. Raise bearing.preload, shrink it less, or take preload_kind = 'spring'."
    )


def held_table(model: Model, equilibrium: Equilibrium) -> dict[str, float] | None:
    """``equilibrium.held_axial`` of result.json: the axial force that gave the held displacement, and what it takes now."""
    if model.scene.supports.axial != "displacement":
        return None
    now = model.system.without(ring.CAGE).evaluate(equilibrium.displacement, ball=equilibrium.ball)
    return {"mounted_n": model.scene.load.axial, "running_n": float(now.force[0])}


def _row_forces(model: Model, q: np.ndarray, ball: np.ndarray) -> list[float]:
    """Axial force of each row in its seating direction [N]."""
    z, still = model.scene.bearing.ball_count, model.system.without(ring.CAGE)
    return [
        side * float(_row(still, k, z).evaluate(q, ball=ball[k * z : (k + 1) * z]).force[0])
        for k, (side, _) in enumerate(model.scene.bearing.rows)
    ]
