"""What a bearing is mounted with: the preload of a set, an axial displacement that is held.

Both are set at standstill, before anything has grown; speed and temperature then change the forces that they give.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, TypeVar

import attrs
import numpy as np

from raceway.bodies.basis import Basis, first_guess
from raceway.bodies.running import renew
from raceway.core.ring.changing_speed import ChangingSpeed
from raceway.core.ring.kernels import layout as ring
from raceway.core.ring.ring import Ring, Spin
from raceway.core.ring.system import System
from raceway.errors import ConvergenceError
from raceway.framework.duties import renews
from raceway.planning.recording import turns_of
from raceway.scene.scene import Scene
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
    """(5,) first guess of the equilibrium; builds the preload of a set into the system, finds a held axial displacement."""
    guess = first_guess(scene, basis)
    growth, preloaded = basis.growth, scene.bearing.preloaded
    if preloaded:
        system.table[:, ring.SHIFT] = _mounted_shifts(scene, basis, system.as_mounted(growth))
        guess[0] = 0.0
    sprung = preloaded and scene.bearing.preload_kind == "spring"
    if scene.supports.axial == "displacement":
        mounted = _under(system.as_mounted(growth), scene.load.axial)
        start = np.array([guess[0], 0.0, 0.0, 0.0, 0.0])
        guess = _follow_spring(scene, basis, mounted, start) if sprung else mounted.settle(start)[0]
    place = partial(_follow_spring, scene, basis) if sprung else None
    if renews(scene.contact.law) and isinstance(system, System):
        guess = renew(scene, basis, system, guess, place)
    if sprung and system.spin is not None:
        system.spin = _follow_speed(scene, basis, system, system.spin, guess)
    return guess if place is None else place(system, guess)


def _mounted_shifts(scene: Scene, basis: Basis, mounted: R) -> np.ndarray:
    """(Z,) axial approach of every ball's row that the preload builds in [m].

    Notes
    -----
    Of a set, the rows of either direction approach alike, together under their force; of rows that were ground, each by itself
    under its own.  Rows that differ in nothing are solved for once.
    """
    bearing = scene.bearing
    given = [row.preload for row in bearing.row] or [None] * len(bearing.rows)
    own = [bearing.preload if force is None else force for force in given]
    sides = {side: [k for k, (other, _) in enumerate(bearing.rows) if other == side] for side in (1.0, -1.0)}
    found, known = np.zeros(mounted.ball_count), dict[tuple[object, ...], float]()
    if bearing.preload_of == "row":
        groups = [([k], own[k]) for k in range(len(own))]
    else:
        first = bearing.rows[0][0]
        other = bearing.preload if bearing.second_preload is None else bearing.second_preload
        groups = [(sides[first], bearing.preload), (sides[-first], other)]
    for rows, force in groups:
        same = (len(rows) if bearing.equal_rows else tuple(rows), force)
        balls = np.flatnonzero(np.isin(basis.row, rows))
        if same not in known:
            start = np.array([0.05 * basis.geometry.centre_distance, 0.0, 0.0, 0.0, 0.0])
            known[same] = _under(_some(mounted, balls, facing=True), force).settle(start)[0][0] if force > 0.0 else 0.0
        found[balls] = known[same]
    return found


def _under(system: R, axial: float) -> R:
    """The system under an axial load alone, the other coordinates held."""
    one = np.array([1.0, 0.0, 0.0, 0.0, 0.0])
    return attrs.evolve(system, load=axial * one, free=one)


def _some(system: R, balls: np.ndarray, facing: bool = False) -> R:
    """Some rows of a system; ``facing``: as one bearing in its own plane, not preloaded, which positive axial motions seat.

    Parameters
    ----------
    balls : (n,) indices of theirs
    """
    table = system.table[balls].copy()
    if facing:
        table[:, [ring.SIDE, ring.LEVER, ring.SHIFT]] = 1.0, 0.0, 0.0
    return system.of_balls(balls, table)


def _second(system: Ring) -> np.ndarray:
    """(n,) indices of the balls whose rows face the other way than the first."""
    return np.flatnonzero(system.table[:, ring.SIDE] != system.table[0, ring.SIDE])


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
        shifts.append(steady.table[_second(system)[0], ring.SHIFT])
    return attrs.evolve(spin, shift=CubicSpline(speeds, shifts))


def _follow_spring(scene: Scene, basis: Basis, system: Ring, guess: np.ndarray) -> np.ndarray:
    """(5,) equilibrium at which the rows that face the other way than the first carry the spring's force; builds their place into
    the system.

    Notes
    -----
    With the shift s of these rows, whose force on the ring is f, and K the tangents: their axial force g = side f_x grows by
    dg/ds = k_xx - k_xq K^-1 k_qx, the ring following.  Newton's method in s within a bracket.

    Raises
    ------
    ConvergenceError
        No such place, or one beyond the spring's travel.
    """
    bearing, second = scene.bearing, _second(system)
    wanted = bearing.preload if bearing.second_preload is None else bearing.second_preload
    side, free = float(system.table[second[0], ring.SIDE]), system.free > 0.0
    low, high = -np.inf, np.inf
    step = _STEP * basis.geometry.centre_distance
    apart = system.table[second, ring.SHIFT] - system.table[second[0], ring.SHIFT]
    mounted = shift = float(system.table[second[0], ring.SHIFT])
    q = guess
    for _ in range(_LIMIT):
        system.table[second, ring.SHIFT] = shift + apart
        q, ball, _ = system.settle(q)
        still = system.without(ring.CAGE)
        whole, rows = still.evaluate(q, ball=ball), _some(still, second).evaluate(q, ball=ball[second])
        excess = side * float(rows.force[0]) - wanted
        if abs(excess) <= _TOLERANCE * wanted:
            _refuse_travel(scene, shift - mounted)
            return q
        low, high = (low, shift) if excess > 0.0 else (shift, high)
        tangent = system.reduced(whole.stiffness + system.stiffness)
        follows = np.linalg.lstsq(tangent, rows.stiffness[free, 0], rcond=None)[0]
        slope = float(rows.stiffness[0, 0] - rows.stiffness[0, free] @ follows)
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


def _refuse_travel(scene: Scene, slid: float) -> None:
    """A spring that would have to slide further than it can."""
    travel = scene.bearing.spring_travel
    if travel is not None and abs(slid) > travel:
        raise ConvergenceError(
            f"the rings on the spring would slide {1e6 * abs(slid):.3g} µm from where they were mounted, beyond "
            f"`bearing.spring_travel` = {travel:g} m: they meet their stop, and the preload is no longer the spring's. Give it more "
            "travel, load it less, or take preload_kind = 'rigid'."
        )


def preload_table(model: Model, equilibrium: Equilibrium) -> Tables | None:
    """``equilibrium.preload`` of result.json; None without preload.

    Notes
    -----
    ``mounted_n`` is what the rows of either direction carry against each other at standstill, before anything grows and without
    loads, ``running_n`` the same of the turning, warm set, ``rows_n`` the axial forces of the rows under the constant loads.
    """
    bearing = model.scene.bearing
    if not bearing.preloaded:
        return None
    mounted = bearing.preload
    if bearing.preload_of == "row":
        mounted = _unloaded(model, model.system.as_mounted(model.basis.growth))
    running = running_preload(model)
    rows = _row_forces(model, model.system, equilibrium.displacement, equilibrium.ball)
    return {
        "kind": bearing.preload_kind, "of": bearing.preload_of, "mounted_n": mounted, "running_n": running, "rows_n": rows,
    }  # fmt: skip


def running_preload(model: Model) -> float:
    """What the rows of a turning, warm set carry against each other without any load [N]; 0 where all are loose."""
    bearing = model.scene.bearing
    if bearing.preload_kind == "spring":
        return bearing.preload
    return _unloaded(model, model.system)


def _unloaded(model: Model, system: Ring) -> float:
    """Axial force of the rows that face the first one's way, without any load [N]."""
    try:
        q, ball, _ = _under(system, 0.0).settle(np.zeros(5))
    except ConvergenceError:
        return 0.0
    rows = model.scene.bearing.rows
    forces = _row_forces(model, system, q, ball)
    return sum(force for force, (side, _) in zip(forces, rows, strict=True) if side == rows[0][0])


def lost_preload(model: Model) -> str:
    """What took the whole preload of a pair and the remedy; empty where some is left, or there was none.

    Notes
    -----
    Centrifugal forces of balls and growth of rings raise a pair's preload: a raceway that shrinks is what takes it.
    """
    bearing, kinematics = model.scene.bearing, model.scene.kinematics
    if not bearing.preloaded or running_preload(model) > 0.0:
        return ""
    radial = model.basis.growth.common[1]
    shrunk = f"the inner raceway has shrunk by {-1e6 * radial:.3g} µm (kinematics.radial_expansion = {kinematics.radial_expansion:g} m)"
    warm = ", ".join(
        f"mounting.{key} = {value:g} {'K' if 'temperature' in key else 'm'}"
        for key, value in model.scene.mounting.changes.items()
    )
    return (
        f"The preload of {max(bearing.preload, *(row.preload or 0.0 for row in bearing.row), 0.0):g} N is gone: both rows are loose, as {shrunk if not warm else f'the grooves have grown apart ({warm})'} "
        "since they were mounted. Raise bearing.preload, shrink it less, or take preload_kind = 'spring'."
    )


def held_table(model: Model, equilibrium: Equilibrium) -> dict[str, float] | None:
    """``equilibrium.held_axial`` of result.json: the axial force that gave the held displacement, and what it takes now."""
    if model.scene.supports.axial != "displacement":
        return None
    now = model.system.without(ring.CAGE).evaluate(equilibrium.displacement, ball=equilibrium.ball)
    return {"mounted_n": model.scene.load.axial, "running_n": float(now.force[0])}


def _row_forces(model: Model, system: Ring, q: np.ndarray, ball: np.ndarray) -> list[float]:
    """Axial force of each row in its seating direction [N]."""
    still, found = system.without(ring.CAGE), []
    for k, (side, _) in enumerate(model.scene.bearing.rows):
        balls = np.flatnonzero(model.basis.row == k)
        found.append(side * float(_some(still, balls).evaluate(q, ball=ball[balls]).force[0]))
    return found
