"""What a number of a result does not say itself: motions that cannot be, and K under other hypotheses.

The spread is that of K, static stiffness, ball load and pressure over the hypotheses of ``[kinematics]`` that a scene leaves at
"auto".  No numerical error knows of it: two programs with other hypotheses solve other equations.  Each hypothesis, and together
those that change a quantity most to either side, are put into the ring that was run; its equilibrium gives kyy, its steady orbit
near the recorded one K.  Both are compared with the same solver's values under the scene's own hypotheses, so that errors of the
orbits cancel.

Nothing is solved where a bound says that it would change nothing: gyroscopic moments change kyy by less than 3 F_c / Q and the
growth u of the inner raceway by less than u / d (F_c centrifugal force, Q inner load, d inner approach of a loaded ball).  The
moment over the ball's diameter is some 0.4 F_c sin(beta); the factors are the largest that 400 bearings of the catalogue at random
loads and speeds (n d_m 3e3 to 2e6 mm r/min) gave, rounded up.  They bound kyy, and K away from resonances.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from itertools import product
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from raceway.answers.quantities import KXX, KYY, KYY_TILTS_FOLLOW, P0, PEAK_BALL_LOAD, K
from raceway.bodies.basis import Basis, growth_of
from raceway.bodies.model import Equilibrium, Model, tilts_follow
from raceway.bodies.mounting import place_ring
from raceway.bodies.rigid_bearing import add_moments
from raceway.core.columns import some, with_values
from raceway.core.contact.hertz import Ellipse
from raceway.core.record import Record
from raceway.core.ring.kernels.layout import CENTRIFUGAL, GYROSCOPIC, OWN_REST_AXIAL, OWN_TILT_ARM, REST_AXIAL, TILT_ARM
from raceway.core.ring.orbit import Orbit, orbit_near
from raceway.core.ring.system import compiled, surrogate
from raceway.core.signals import Identification, stiffness
from raceway.errors import ConvergenceError, RacewayError, SceneError
from raceway.framework.duties import renews
from raceway.framework.estimate import Estimate, Note
from raceway.pipeline.equilibrium import pressures, solve_equilibrium
from raceway.pipeline.simulate import Simulation, last_turn
from raceway.planning.resolve import Problem
from raceway.planning.rules import refuse_what_cannot_run
from raceway.storage.tables import ReadTables, Tables

if TYPE_CHECKING:
    from raceway.bodies.columns import ColumnBearing

#: Samples of the last turn that are looked at.
_SAMPLES = 60
#: Part of what a body gives way, by which it lags behind, that is worth a sentence.
_LAG = 0.01
#: Keys of ``[kinematics]`` that are hypotheses, with what stands beside "auto".
_HYPOTHESES: dict[str, tuple[Any, ...]] = {"gyroscopic": ("none", "outer_race", "shared"), "ring_growth": (False, True)}
_QUANTITIES = (K.name, KXX.name, KYY.name, KYY_TILTS_FOLLOW.name, PEAK_BALL_LOAD.name, P0.name)
#: Relative change of a stiffness that is not worth a solution or a sentence.
NEGLIGIBLE = 1e-3
#: Times of a turn, an odd number, and residual of orbits that are compared: both cancel in their ratio.
_ORBIT_TIMES, _TOLERANCE, _ROUGH = 17, 1e-7, 1e-4
#: Iterations from the motion under the scene's own hypotheses, after which one from the linear response is tried.
_LIMIT = 12
#: Distance of the steady orbit's Z from the identified one, over its size, up to which that orbit is the motion.
_SAME = 0.05
_MOMENTS, _GROWTH = 3.0, 1.0

Secant = Callable[[Model, Equilibrium], float]
#: Values of keys of ``[kinematics]``; relative changes of quantities by their names, None of what is not known.
Values = dict[str, Any]
Changes = dict[str, float | None]


@attrs.frozen
class Spread:
    """``rows`` : what hypotheses change, alone and together; ``bound`` : upper estimate of the relative change of kyy."""

    rows: list[tuple[Values, Changes]]
    bound: float

    @property
    def ranges(self) -> dict[str, list[float] | None]:
        """Of each quantity the least and largest change, 0 between them; None where a row lacks the number."""
        ranges: dict[str, list[float] | None] = {}
        for name in _QUANTITIES:
            numbers = [number for _, change in self.rows if (number := change[name]) is not None]
            complete = numbers and len(numbers) == len(self.rows)
            ranges[name] = [min(0.0, *numbers), max(0.0, *numbers)] if complete else None
        return ranges

    @property
    def table(self) -> Tables:
        """``error.model`` of result.json, with each hypothesis by itself."""
        alone = [(key, value, change) for one, change in self.rows for key, value in one.items() if len(one) == 1]
        hypotheses = [{"key": f"kinematics.{key}", "value": value, **change} for key, value, change in alone]
        return {**self.ranges, "hypotheses": hypotheses, "bound": self.bound}


def refuse_impossible(model: Model, equilibrium: Equilibrium, record: Record) -> None:
    """Refuse a motion that leaves the grooves.

    ConvergenceError: The ring moves further than the groove centres are apart: the ball would climb out of its groove.
    """
    distance = float(np.abs(record.displacement[:, :3] - equilibrium.displacement[:3]).max())
    limit = model.bearing.largest_motion
    if distance > limit:
        raise ConvergenceError(
            f"the ring moves by {1e3 * distance:.3g} mm, more than the groove centres are apart ({1e3 * limit:.3g} mm): balls "
            f"would leave their grooves. The excitation's force is {model.excitation.amplitude_n:.4g} N: check its unit (unbalance in kg m), or load the bearing more.",
            {"q": record.final.q, "v": record.final.v, "ball": record.final.ball},
        )


def pressure_warnings(model: Model, force: np.ndarray) -> list[str]:
    """Where the largest contact pressure exceeds that of static load ratings; forces (2 Z,) [N]."""
    limit, rows = model.bearing.static_pressure, model.basis.row
    peaks = pressures(model, force).reshape(2, -1)
    # The first of those that are alike.
    race, ball = np.unravel_index(np.argmax(peaks >= (1.0 - 1e-9) * peaks.max()), (2, len(rows)))
    if not peaks[race][ball] > limit:
        return []
    name = (f"row {rows[ball] + 1}, " if rows[-1] else "") + f"ball {ball - np.argmax(rows == rows[ball])}"
    return [
        f"the contact pressure reaches {1e-6 * peaks[race][ball]:.0f} MPa on the {('inner', 'outer')[race]} race, {name}: above "
        f"{1e-6 * limit:.0f} MPa (static load ratings, ISO 76) permanent indentation of ball and race is not modelled"
    ]


def motion_warnings(model: Model, record: Record) -> tuple[str, ...]:
    """Sentences about the last turn of a record, each said once."""
    z, bearing, end = model.system.ball_count, model.bearing, len(record.time)
    per_turn = max(record.schedule.steps_per_turn // record.schedule.stride, 1)
    samples = np.unique(np.linspace(max(end - per_turn, 0), end - 1, _SAMPLES).astype(int))
    warnings, force = [], record.contact_force[samples]
    open_balls = int((force[:, :z] == 0.0).any(axis=0).sum())
    if open_balls:
        warnings.append(f"{open_balls} of {z} balls lose contact with the inner race during a turn")
    inner, outer = _angles(model, record, samples)
    beyond: dict[str, str] = {text: text for text in pressure_warnings(model, force.max(axis=0))}
    for k in np.flatnonzero(bearing.over_edges(model, inner, outer, force)):
        bearing.refuse_impossible(model, force[k])
        for text in bearing.edge_warnings(model, inner[k], outer[k], force[k]):
            beyond.setdefault(text.split(" reaches ")[0], text)
    b = model.problem.bearing
    if b.radial_clearance is None and b.contact_angle > 0.0 and np.nanmin(inner, initial=np.inf) <= 0.0:
        words = "the bearing loses axial contact during a turn: the contact angle of a loaded ball is zero or negative"
        warnings.append(words)
    return (*warnings, *(f"during a turn {text}" for text in beyond.values()))


def _angles(model: Model, record: Record, samples: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Inner and outer contact angles (n, Z) [rad] of some samples."""
    columns = record.displacement, record.ball, record.contact_force, record.time
    if model.system.spin is None:
        return model.bearing.contact_angles(model, *(column[samples] for column in columns))
    angles = []
    for k in samples:
        at_time = attrs.evolve(model, system=model.system.at_speed(record.time[k]))
        angles.append(model.bearing.contact_angles(at_time, *(column[k] for column in columns)))
    inner, outer = zip(*angles, strict=True)
    return np.array(inner), np.array(outer)


def inertia_warnings(table: ReadTables | None, total: float | None) -> list[str]:
    """Where motions that follow at once are off by more than a result's stated error says, and by more than 1 %."""
    inertia = {} if table is None else table.get("inertia") or {}
    parts = {
        "the inner ring": inertia.get("inner_supported_error"),
        "the outer ring": inertia.get("outer_supported_error"),
        "a ball along its grooves": inertia.get("ball_along_grooves_error"),
    }
    limit = max(_LAG, total or 0.0)
    beyond = {name: share for name, share in parts.items() if share is not None and share > limit}
    if not beyond:
        return []
    worst = max(beyond, key=lambda name: beyond[name])
    return [
        f"{worst} is quasi-static, an error of (w / w1)^2 = {beyond[worst]:.2g} of its deflection, which the stated error does not include. Elastic bodies (bodies.kind "
        "= 'elastic') include its inertia"
    ]


def model_spread(
    model: Model, equilibrium: Equilibrium, identification: Identification | None, simulation: Simulation | None
) -> tuple[Spread | None, Note]:
    """How far other hypotheses move the numbers, and how that was found or why not."""
    values, why = _alternatives(model.problem, compiled(model.system) is not None)
    if isinstance(why, Note):
        return None, why
    bound = _bound_of(model, equilibrium, values)
    if bound < NEGLIGIBLE:
        return Spread([], bound), Estimate.BOUND(bound=bound, why=why)
    secant, how = _secant(model, equilibrium, identification, simulation)
    kinematics, own = model.problem.kinematics, _state_numbers(model, equilibrium)
    rows: list[tuple[Values, Changes]] = []

    def solve(combination: Values) -> None:
        nonlocal how
        change: Changes = dict.fromkeys(_QUANTITIES)
        try:
            problem = attrs.evolve(model.problem, kinematics=attrs.evolve(kinematics, **combination))
            variant, state = _under(model, problem, equilibrium)
            for name, number in _state_numbers(variant, state).items():
                before = own[name]
                change[name] = None if before is None or number is None else (number - before) / abs(before)
            of_secant = np.nan if secant is None else secant(variant, state)
            change[K.name] = of_secant if np.isfinite(of_secant) else None
        except (RacewayError, ArithmeticError, np.linalg.LinAlgError) as error:
            how += f"; not under {combination}: {str(error).splitlines()[0]}"
        rows.append((combination, change))

    for key, others in values.items():
        for value in others:
            solve({key: value})
    # Those of several keys that change a quantity most to either side, by what each changes alone.
    combinations: list[Values] = []
    for name, sign in product(_QUANTITIES, (-1.0, 1.0)):
        together: Values = {}
        for key in values:
            alone = [(sign * by, one[key]) for one, change in rows if key in one and (by := change[name]) is not None]
            most, value = max(alone, key=lambda pair: pair[0], default=(0.0, None))
            if most > 0.0:
                together[key] = value
        if len(together) > 1 and together not in combinations:
            combinations.append(together)
    for combination in combinations:
        solve(combination)
    return Spread(rows, bound), Estimate.EACH_HYPOTHESIS(how=how, why=why)


def _state_numbers(model: Model, equilibrium: Equilibrium) -> dict[str, float | None]:
    k, forces = equilibrium.stiffness, equilibrium.contact_force
    return {
        KXX.name: float(k[0, 0]), KYY.name: float(k[1, 1]),
        KYY_TILTS_FOLLOW.name: tilts_follow(k, model.problem.supports.tilt),
        PEAK_BALL_LOAD.name: float(np.max(forces)), P0.name: float(pressures(model, forces).max()),
    }  # fmt: skip


def closed_bound(model: Model, equilibrium: Equilibrium) -> float | None:
    """Upper estimate of the relative change of kyy by the hypotheses left open; None where there are none."""
    values, _ = _alternatives(model.problem, compiled(model.system) is not None)
    return _bound_of(model, equilibrium, values) if values else None


def _bound_of(model: Model, equilibrium: Equilibrium, keys: Collection[str]) -> float:
    z = model.system.ball_count
    return float(_bound(model.problem, model.basis, model.inner, model.system.table, equilibrium.contact_force[:z], keys))


def column_bounds(example: Problem, bearing: ColumnBearing, force: np.ndarray) -> np.ndarray:
    """The same (n,) of the rigid bearing at n points, one ``example``, under contact forces (n, 2 Z); nan: none."""
    values, _ = _alternatives(example, True)
    if not values:
        return np.full(len(force), np.nan)
    inner, table = force[:, : force.shape[1] // 2], bearing.points.table
    return _bound(bearing.problem, bearing.basis, bearing.ellipses[0], table, inner, values)


def _alternatives(problem: Problem, compiled_ring: bool) -> tuple[dict[str, list[Any]], str]:
    """Values of the keys left open that the scene can run with, and what it cannot; a note where there are none."""
    if problem.spin_speed == 0.0:
        return {}, Estimate.NOTHING_TURNS()
    automatic = [key for key in _HYPOTHESES if getattr(problem.scene.kinematics, key) == "auto"]
    if not automatic:
        return {}, Estimate.HYPOTHESES_STATED()
    if not compiled_ring:
        return {}, Estimate.POINTS_TOO_SLOW(kind=problem.bodies.name)
    if problem.contact.law.state_size > 0 or problem.spin_changes:
        return {}, Estimate.NO_STEADY_MOTION()
    values: dict[str, list[Any]] = {}
    why = ""
    for key in automatic:
        for value in _HYPOTHESES[key]:
            if value == getattr(problem.kinematics, key) or (value is True and some(problem.mounting.shaft_interference)):
                continue  # a fit that is given is not left out
            try:
                refuse_what_cannot_run(attrs.evolve(problem, kinematics=attrs.evolve(problem.kinematics, **{key: value})))
            except SceneError as error:
                why = f"{why}; without kinematics.{key}: {error.mistakes[0].message}"
                break
            values.setdefault(key, []).append(value)
    return values, why if values else Estimate.NO_OTHER_HYPOTHESIS(why=why)


def _bound(
    problem: Problem, basis: Basis, ellipse: Ellipse, table: np.ndarray, inner: np.ndarray, keys: Collection[str]
) -> np.ndarray:
    """Of inner loads (..., Z) with their ellipse and balls' numbers (..., Z, k), at one point or many."""
    carrying = inner > 0.0
    least = np.where(carrying, inner, np.inf).min(axis=-1)
    bound = np.where(np.isfinite(least), 0.0, np.inf)
    if "gyroscopic" in keys:
        bound += _MOMENTS * np.divide(table[..., CENTRIFUGAL], inner, out=np.zeros_like(inner), where=carrying).max(axis=-1)
    if "ring_growth" in keys:
        running = problem.running
        either = (with_values(running.kinematics, ring_growth=grows) for grows in (True, False))
        more, now = (growth_of(attrs.evolve(running, kinematics=one), basis.row) for one in either)
        radial = np.abs(more.common[..., None, 1] + more.by_ball[..., 1] - now.common[..., None, 1] - now.by_ball[..., 1])
        with np.errstate(invalid="ignore"):  # of points without a load
            approach = ellipse.approach(np.where(carrying, inner, least[..., None])).max(axis=-1)
        bound += _GROWTH * radial.max(axis=-1) / approach
    return bound


def _under(model: Model, problem: Problem, near: Equilibrium) -> tuple[Model, Equilibrium]:
    """The model and its equilibrium under other ``[kinematics]``, without building its bodies again."""
    ring = compiled(model.system)
    assert ring is not None, "refused above"
    growth, kernel = growth_of(problem.running, model.basis.row), ring.kernel
    scalars, table = ring.scalars.copy(), ring.table.copy()
    scalars[REST_AXIAL : TILT_ARM + 1] += growth.common - model.basis.growth.common
    table[:, OWN_REST_AXIAL : OWN_TILT_ARM + 1] += growth.by_ball - model.basis.growth.by_ball
    if problem.kinematics.gyroscopic == "none":
        scalars[GYROSCOPIC] = 0.0
    else:
        from raceway.core.ring.kernels.rigid_inertial import rigid_tangential as kernel

        add_moments(scalars, problem, model.geometry)
        if ring.condensed:
            from raceway.core.ring.kernels.structural import condensed

            kernel = condensed(kernel)
    system = attrs.evolve(ring, scalars=scalars, table=table, kernel=kernel)
    if system.mounted_params is not None and system.reach is not None:  # a law is renewed from standstill, as in a run
        system = system.running(system.mounted_params, np.zeros_like(system.reach))
    basis, q = attrs.evolve(model.basis, growth=growth), near.displacement
    if renews(problem.contact.law) or (problem.bearing.preloaded and problem.bearing.preload_kind == "spring"):
        q = place_ring(problem, basis, system)
    bearing = attrs.evolve(model.bearing, basis=basis, system=system, guess=q)
    variant = attrs.evolve(model, problem=problem, system=system, bearing=bearing)
    return variant, solve_equilibrium(variant)


def _secant(
    model: Model, equilibrium: Equilibrium, identification: Identification | None, simulation: Simulation | None
) -> tuple[Secant | None, str]:
    """Relative change of K by another model with its equilibrium, or None; and how, or why not."""
    if identification is None:
        return None, "the scene is static"
    method, identifier, period = model.problem.integrator.method, model.problem.identifier.method, model.excitation.period_s
    if "speeds" in identifier.needs:
        return None, "not estimated: it is fitted over several speeds"
    if "record" not in identifier.needs:
        k, how = K.of(identification), f"identifier '{model.problem.identifier.kind}' at each equilibrium"
        return lambda variant, state: float((K.of(identifier.identify([], state, variant)) - k) / abs(k)), how
    turn = None if simulation is None or period is None else last_turn(simulation.whole, period)
    if model.problem.contact.friction > 0.0 or turn is None:
        return None, "not estimated: with friction, or without whole turns, there is no steady orbit to compare with"
    half = np.fft.rfft(turn.displacement, axis=0)[: _ORBIT_TIMES // 2 + 1] / len(turn.displacement)
    first = _ORBIT_TIMES * np.fft.irfft(half, _ORBIT_TIMES, axis=0)

    def orbit(variant: Model, displacement: np.ndarray, limit: int) -> Orbit:
        ring = variant.bearing.periodic_system(variant.system)
        return orbit_near(ring, period, displacement, _ORBIT_TIMES, method.inertial, _TOLERANCE, limit)

    def value(orbit: Orbit) -> complex:
        waves = 2.0 / _ORBIT_TIMES * np.exp(-2j * np.pi * np.arange(_ORBIT_TIMES) / _ORBIT_TIMES)
        return stiffness(waves @ orbit.force, waves @ orbit.displacement)

    try:
        samples = orbit(model, first, 5 * _LIMIT)
    except RacewayError as error:
        return None, f"not estimated: {str(error).splitlines()[0]}"
    base = value(samples)
    if not abs(base - identification.dynamic_stiffness) <= _SAME * abs(base):
        return None, "not estimated: the motion that was identified is no steady orbit"
    speed = identification.speed

    def of_orbit(variant: Model, state: Equilibrium) -> float:
        apart = state.displacement - equilibrium.displacement
        try:
            z = value(orbit(variant, samples.displacement + apart, _LIMIT))
        except RacewayError:  # balls lift off: from the linear response, on a mesh that follows the motion
            if not method.inertial:
                raise
            from raceway.core.periodic.search import directly, problem_of
            from raceway.core.periodic.steady import synchronous_response

            q, system = state.displacement, surrogate(variant.bearing.periodic_system(variant.system))
            problem = problem_of(system, speed, q)
            z = synchronous_response(directly(problem, q, state.stiffness, _ROUGH).solved)[0]
        return float((z.real - base.real) / abs(base.real + model.mass_used * speed**2))

    return of_orbit, "of the steady orbit near the recorded one"
