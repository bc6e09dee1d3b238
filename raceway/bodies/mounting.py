"""What a bearing is set with: the preload of a set, an axial displacement that is held.

Both are set *before mounting*: of the loose bearing, at standstill and without fits.  *Mounted*, its fits change the forces that they
give; *running*, speed and temperatures do, too.
"""

from contextlib import suppress
from functools import partial
from typing import TypeVar

import attrs
import numpy as np

from raceway.bodies.basis import Basis, first_guess, growth_of
from raceway.bodies.model import Equilibrium, Model
from raceway.core.contact.geometry import Growth
from raceway.core.contact.hertz import regula_falsi
from raceway.core.ring.kernels import layout as ring
from raceway.core.ring.ring import Evaluation, Ring
from raceway.core.ring.system import System
from raceway.errors import ConvergenceError
from raceway.framework.duties import renews
from raceway.planning.resolve import Problem
from raceway.storage.tables import Tables

R = TypeVar("R", bound=Ring)
#: The force of a spring is met to this part of the preload.
_TOLERANCE = 1e-9
#: First step of the search for a sprung ring's place, over the distance of the groove centres; steps of that search.
_STEP, _LIMIT = 0.01, 60
#: Times at which the speeds of a run are looked at, and steady speeds that a sprung ring is placed at.
_SAMPLES, _SPEEDS = 1001, 17
#: First share of the largest motion that a row is looked for to lift off in.
_LIFTED = 1e-3
_AXIAL = np.array([1.0, 0.0, 0.0, 0.0, 0.0])


def place_ring(problem: Problem, basis: Basis, system: Ring) -> np.ndarray:
    """(5,) first guess of the equilibrium; builds the preload of a set into the system, finds a held axial displacement."""
    growth, seek, shift = basis.growth, None, 0.0
    if problem.bearing.preloaded:
        system.table[:, ring.SHIFT] = _ground_shifts(problem, basis, system.standing(growth))
        shift = float(system.table[:, ring.SHIFT].max())
    guess = first_guess(problem, basis, shift)
    if problem.bearing.preloaded and problem.bearing.preload_kind == "spring":
        system.sliding = np.flatnonzero(system.table[:, ring.SIDE] != system.table[0, ring.SIDE])
        seek = partial(_follow_spring, problem, basis, float(system.table[system.sliding[0], ring.SHIFT]))
    if problem.supports.axial == "displacement":
        loose = _under(system.standing(growth), problem.load.axial)
        start = guess[0] * _AXIAL
        guess = loose.solve_equilibrium(start)[0] if seek is None else seek(loose, start)
    if renews(problem.contact.law) and isinstance(system, System):
        from raceway.bodies.running import renew

        guess = renew(problem, basis, system, guess, seek)
    if seek is not None and system.spin is not None:
        # The changing speed with the second row's shift over the speeds of the run, a cubic spline through those of steady speeds.
        from scipy.interpolate import CubicSpline

        assert system.spin is not None
        spin = attrs.evolve(system.spin, shift=None)
        duration = problem.turns / problem.excitation.frequency_hz
        met = spin.speed(np.linspace(0.0, duration, _SAMPLES))
        speeds = np.linspace(met.min(), met.max(), _SPEEDS)
        shifts = []
        for speed in speeds:
            steady = spin.constants(system, float(speed))
            seek(steady, guess)
            shifts.append(steady.table[steady.sliding, ring.SHIFT][0])
        system.spin = attrs.evolve(spin, shift=CubicSpline(speeds, shifts))
    return guess if seek is None else seek(system, guess)


def _ground_shifts(problem: Problem, basis: Basis, loose: R) -> np.ndarray:
    """(Z,) axial approach of every ball's row that the preload builds in [m].

    Of a set, the rows of either direction approach alike, together under their force; of rows that were ground, each by itself
    under its own.  Rows that differ in nothing are solved for once.
    """
    bearing = problem.bearing
    preloads = [row.preload for row in bearing.row] or [None] * len(bearing.rows)
    row_preloads = [bearing.preload if force is None else force for force in preloads]
    sides = {side: [k for k, (sign, _) in enumerate(bearing.rows) if sign == side] for side in (1.0, -1.0)}
    shifts, shift_of = np.zeros(loose.ball_count), dict[tuple[object, ...], float]()
    if bearing.preload_of == "row":
        groups = [([k], row_preloads[k]) for k in range(len(row_preloads))]
    else:
        first = bearing.rows[0][0]
        groups = [(sides[first], bearing.preload), (sides[-first], bearing.other_preload)]
    for rows, force in groups:
        same = (len(rows) if bearing.equal_rows else tuple(rows), force)
        balls = np.flatnonzero(np.isin(basis.row, rows))
        if same not in shift_of:
            start = 0.05 * basis.geometry.centre_distance * _AXIAL
            facing = _under(_some(loose, balls, facing=True), force)
            shift_of[same] = facing.solve_equilibrium(start)[0][0] if force > 0.0 else 0.0
        shifts[balls] = shift_of[same]
    return shifts


def _under(system: R, axial: float) -> R:
    """The system under an axial load alone, the other coordinates held."""
    return attrs.evolve(system, load=axial * _AXIAL, free=_AXIAL)


def _some(system: R, balls: np.ndarray, facing: bool = False) -> R:
    """Rows of a system by their balls (n,); ``facing``: as one bearing in its own plane, not preloaded, that faces "+"."""
    table = system.table[balls].copy()
    if facing:
        table[:, [ring.SIDE, ring.LEVER, ring.SHIFT]] = 1.0, 0.0, 0.0
    return system.of_balls(balls, table)


def _follow_spring(problem: Problem, basis: Basis, origin: float, system: Ring, guess: np.ndarray) -> np.ndarray:
    """(5,) equilibrium at which the sliding rows carry the spring's force; builds their place into the system.

    The spring's travel counts from ``origin``, the shift [m] of the first of them before mounting.  With their shift s, their force f
    on the ring and K the tangents, g = side f_x grows by dg/ds = k_xx - k_xq K^-1 k_qx: Newton's method in s within a bracket.

    ConvergenceError: no such place, or one beyond the spring's travel.
    """
    second, preload = system.sliding, problem.bearing.other_preload
    assert second is not None, "the scene's rows are on a spring"
    side, free = float(system.table[second[0], ring.SIDE]), system.free > 0.0
    low, high = -np.inf, np.inf
    step = _STEP * basis.geometry.centre_distance
    apart = system.table[second, ring.SHIFT] - system.table[second[0], ring.SHIFT]
    shift = float(system.table[second[0], ring.SHIFT])
    q = guess
    for _ in range(_LIMIT):
        system.table[second, ring.SHIFT] = shift + apart
        q, ball, _ = system.solve_equilibrium(q)
        still = system.without(ring.CAGE)
        all_rows, rows = still.evaluate(q, ball=ball), _some(still, second).evaluate(q, ball=ball[second])
        excess = side * float(rows.force[0]) - preload
        if abs(excess) <= _TOLERANCE * preload:
            slid, travel = abs(shift - origin), problem.bearing.spring_travel
            if travel is not None and slid > travel:
                raise ConvergenceError(
                    f"the rings on the spring would slide {1e6 * slid:.3g} µm from where the preload sets them before mounting, beyond "
                    f"`bearing.spring_travel` = {travel:g} m: they reach their stop, and the preload is no longer the spring's. Allow "
                    "more travel, reduce the load, or use preload_kind = 'rigid'."
                )
            return q
        low, high = (low, shift) if excess > 0.0 else (shift, high)
        tangent = system.reduced(all_rows.stiffness + system.stiffness)
        follows = np.linalg.lstsq(tangent, rows.stiffness[free, 0], rcond=None)[0]
        slope = float(rows.stiffness[0, 0] - rows.stiffness[0, free] @ follows)
        trial = shift - excess / slope if slope > 0.0 else np.nan
        if not (low < trial < high and abs(trial - shift) < 4.0 * step):
            bounded = np.isfinite(low) and np.isfinite(high)
            trial = 0.5 * (low + high) if bounded else shift - np.copysign(step, excess)
        shift = trial
    key = "preload" if problem.bearing.second_preload is None else "second_preload"
    spring = f"the spring of `bearing.{key}` = {preload:g} N under these loads"
    remedy = "raise the preload, or use preload_kind = 'rigid'."
    raise ConvergenceError(f"no position of the second row was found at which it carries {spring}: {remedy}", {"q": q})


def preload_table(model: Model, equilibrium: Equilibrium) -> Tables | None:
    """``equilibrium.preload`` of result.json; None without preload.

    Before mounting the rows of the first direction and of the other one (``second``) carry what the preload sets, under its
    difference as an axial load.  Mounted and running, both without loads, the rows of either direction carry the same.  ``rows_n``
    are the axial forces of the rows under the constant loads.  ``lift_off_axial_n`` are the loads [N] along +x and -x, of all
    coordinates but x held and the scene's loads left out, at which the first row carries nothing any more, ``lift_off_row`` its
    number, from 1; None where none ever does.
    """
    bearing, system = model.problem.bearing, model.system
    if not bearing.preloaded:
        return None
    first, second = bearing.preload, bearing.other_preload
    if bearing.preload_of == "row":
        first = second = _unloaded(model, system.standing(model.basis.growth))
    fitted = model.problem.mounting.fitted or first != second
    mounted = _unloaded(model, _mounted(model)) if fitted else first
    rows = _row_forces(model, system, equilibrium.displacement, equilibrium.ball)
    return {
        "kind": bearing.preload_kind, "of": bearing.preload_of, "before_mounting_n": first, "second_before_mounting_n": second,
        "mounted_n": mounted, "running_n": _unloaded(model, system), "rows_n": rows, **_lift_off(model),
    }  # fmt: skip


def _mounted(model: Model) -> Ring:
    """The bearing with its fits, at standstill and at the temperature of assembly."""
    running, growth = model.problem.running, model.basis.growth
    still = attrs.evolve(running.kinematics, radial_expansion=0.0, ring_growth=False, ball_growth=False)
    cold = attrs.evolve(running.mounting, inner_temperature=0.0, outer_temperature=0.0, ball_temperature=0.0)
    fits = growth_of(attrs.evolve(running, kinematics=still, mounting=cold, spin_speed=0.0), model.basis.row)
    return model.system.standing(Growth(growth.common - fits.common, growth.by_ball - fits.by_ball))


def _unloaded(model: Model, system: Ring) -> float:
    """What the rows of either direction carry against each other without any load [N]; 0 where all are loose."""
    if system.sliding is not None:
        return model.problem.bearing.other_preload
    try:
        q, ball, _ = _under(system, 0.0).solve_equilibrium(np.zeros(5))
    except ConvergenceError:
        return 0.0
    rows = model.problem.bearing.rows
    forces = _row_forces(model, system, q, ball)
    return sum(force for force, (side, _) in zip(forces, rows, strict=True) if side == rows[0][0])


def _lift_off(model: Model) -> Tables:
    """Axial loads along +x and -x at which the first row of a set lifts off, and its number.

    The inner rings move axially from where the set carries no load; forces follow from the displacement, no equilibrium is solved for.
    Rows on a spring keep its force, as their outer rings follow.
    """
    system, spring = model.system.without(ring.CAGE), 0.0
    balls = np.arange(system.ball_count)
    if system.sliding is not None:
        balls = np.setdiff1d(balls, system.sliding)
        spring = float(system.table[system.sliding[0], ring.SIDE]) * model.problem.bearing.other_preload
    rows, start = _some(system, balls), 0.0
    with suppress(ConvergenceError):  # all rows are loose
        start = float(_under(rows, -spring).solve_equilibrium(np.zeros(5))[0][0])
    loads, numbers = list[float | None](), list[int | None]()
    for sense in (1.0, -1.0):
        x, ball = _first_open(rows, start, sense * model.bearing.largest_motion)
        loads.append(None if x is None else float(rows.evaluate(x * _AXIAL).force[0]) + spring)
        numbers.append(None if ball is None else int(model.basis.row[balls[ball]]) + 1)
    return {"lift_off_axial_n": loads, "lift_off_row": numbers}


def _first_open(rows: Ring, start: float, furthest: float) -> tuple[float, int] | tuple[None, None]:
    """Axial displacement [m] at which an inner contact opens first, and its ball.

    start : displacement from which the rings move [m];  furthest : by which they move at most, signed [m]
    """
    unloaded = np.flatnonzero(rows.table[:, ring.SIDE] != np.sign(furthest))
    lifting = _some(rows, unloaded)

    def gaps(share: float) -> np.ndarray:
        return lifting.evaluate((start + share * furthest) * _AXIAL).gap[: len(unloaded)]

    low, high = 0.0, _LIFTED
    try:
        while len(unloaded) and gaps(high).max() < 0.0 and high < 1.0:
            low, high = high, min(2.0 * high, 1.0)
        if not len(unloaded) or gaps(high).max() < 0.0:
            return None, None
        share = 0.0 if gaps(low).max() >= 0.0 else regula_falsi(lambda share: float(gaps(share).max()), low, high)
    except ConvergenceError:  # balls find no place between the races on the way
        return None, None
    return start + share * furthest, int(unloaded[gaps(share).argmax()])


def lost_preload(model: Model) -> str:
    """What took all preload of a pair and the remedy; empty where some is left, or there was none.

    Centrifugal forces of balls and growth of rings raise a pair's preload: a raceway that shrinks is what takes it.
    """
    bearing, kinematics = model.problem.bearing, model.problem.kinematics
    if not bearing.preloaded or _unloaded(model, model.system) > 0.0:
        return ""
    radial = model.basis.growth.common[1]
    shrunk = f"the inner raceway has shrunk by {-1e6 * radial:.3g} µm (kinematics.radial_expansion = {kinematics.radial_expansion:g} m)"
    warm = ", ".join(
        f"mounting.{key} = {value:g} {'K' if 'temperature' in key else 'm'}"
        for key, value in model.problem.mounting.changes.items()
    )
    return (
        f"The preload of {max(bearing.preload, *(row.preload or 0.0 for row in bearing.row), 0.0):g} N is lost: both rows are loose, because {shrunk if not warm else f'the grooves have grown apart ({warm})'} "
        "since the preload was set. Raise bearing.preload, reduce the shrinkage, or use preload_kind = 'spring'."
    )


def held_table(model: Model, equilibrium: Equilibrium) -> dict[str, float] | None:
    """``equilibrium.held_axial`` of result.json: the axial force that gave the held displacement, what it takes mounted, and now."""
    problem, q = model.problem, equilibrium.displacement
    if problem.supports.axial != "displacement":
        return None
    first = mounted = problem.load.axial
    if problem.mounting.fitted:
        mounted = float(evaluate_following(problem, _mounted(model), q * _AXIAL).force[0])
    now = model.system.without(ring.CAGE).evaluate(q, ball=equilibrium.ball)
    return {"before_mounting_n": first, "mounted_n": mounted, "running_n": float(now.force[0])}


def evaluate_following(problem: Problem, system: Ring, q: np.ndarray, ball: np.ndarray | None = None) -> Evaluation:
    """Contacts at a displacement (5,) of the ring to which rows on a spring have followed, with their constant force."""
    if system.sliding is None:
        return system.evaluate(q, ball=ball)
    side, table = float(system.table[system.sliding[0], ring.SIDE]), system.table.copy()
    sprung, _, _ = _under(_some(system, system.sliding), side * problem.bearing.other_preload).solve_equilibrium(q)
    table[system.sliding, ring.SHIFT] += side * (sprung[0] - q[0])
    moved = attrs.evolve(system, table=table)
    now = moved.evaluate(q, ball=ball)
    stiffness, damping = moved.rows_following(q, now, now.stiffness, now.damping)
    return attrs.evolve(now, stiffness=stiffness, damping=damping)


def _row_forces(model: Model, system: Ring, q: np.ndarray, ball: np.ndarray) -> list[float]:
    """Axial force of each row in its seating direction [N]."""
    still, forces = system.without(ring.CAGE), []
    for k, (side, _) in enumerate(model.problem.bearing.rows):
        balls = np.flatnonzero(model.basis.row == k)
        forces.append(side * float(_some(still, balls).evaluate(q, ball=ball[balls]).force[0]))
    return forces
