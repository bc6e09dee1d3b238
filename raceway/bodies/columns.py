"""A bearing with rigid or condensed bodies at n operating points at once: its numbers as columns, for the compiled loops over points.

The builders are those of one point (``raceway.bodies.basis``, ``raceway.bodies.rigid_bearing``): arrays have a first axis more.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any, TypeVar

import attrs
import numpy as np

from raceway.bodies.basis import Basis, contact_pairs, first_guess, gyroscopic, make_basis
from raceway.bodies.contacts import contact_angles
from raceway.bodies.rigid_bearing import contact_parts, law_of_contacts
from raceway.bodies.running import ITERATIONS, LOAD_TOLERANCE, running_pairs
from raceway.core.columns import at_rows, distinct, has_columns, largest, per_ball, some
from raceway.core.contact.hertz import Ellipse
from raceway.core.periodic.fourier import Turning
from raceway.core.periodic.orbits import Orbits, orbits
from raceway.core.periodic.turn import one_pitch
from raceway.core.ring.equilibria import equilibria, groove_centres
from raceway.core.ring.equilibrium import NOT_CONVERGED
from raceway.core.ring.kernels import layout as ring
from raceway.core.ring.kernels.layout import OWN_OFFSET_INNER, OWN_OFFSET_OUTER, elastic_columns
from raceway.core.ring.kernels.rigid_inertial import rigid_inertial, rigid_tangential
from raceway.core.ring.kernels.structural import condensed
from raceway.core.ring.system import System, no_force
from raceway.core.signatures import FORCE, LOOSE, Kernels, Linear, Points, States
from raceway.framework.contracts import SolvedPoints
from raceway.framework.duties import force_params, is_elementwise_force, law_params, reach_of, renews
from raceway.framework.loading.probe import plugin_kernel
from raceway.planning.columns import column_problem
from raceway.planning.plan import ScenePlan
from raceway.planning.resolve import Problem
from raceway.scene.bearing import DIMENSIONS
from raceway.scene.growth import groove_edge
from raceway.storage.tables import Tables

C = TypeVar("C", bound="ColumnBearing")
R = TypeVar("R", Points, States, Turning, Orbits)
#: Samples of a span at most.
_MOST_SAMPLES = 128
_AXIAL = np.array([1.0, 0.0, 0.0, 0.0, 0.0])


@attrs.frozen(eq=False)
class ColumnBearing:
    """The bearing at n points."""

    problem: Problem
    plan: ScenePlan
    basis: Basis
    linear: Linear  # what all points share
    points: Points  # numbers of each
    kernels: Kernels  # of balls and law
    faults: np.ndarray  # (n,) status of the preload's own equilibria, 0 where it is built in
    unloaded: ColumnBearing | None = None  # the same at one point, where nothing but loads differs from it

    @cached_property
    def force(self) -> tuple[np.ndarray, np.ndarray]:
        """Parameters (n, k) of the excitation at each point, and its speed (n,) [rad/s]."""
        excitation, n = self.problem.excitation, self.problem.points
        if not has_columns(excitation) or is_elementwise_force(excitation):
            params, period = force_params(excitation), excitation.period_s
            numbers = np.broadcast_to(params, (*n, params.shape[-1])), np.broadcast_to(np.array(period), n)
        else:
            several, which = distinct(excitation)
            numbers = np.array([force_params(each) for each in several]), np.array([each.period_s for each in several])
            numbers = numbers[0][which], numbers[1][which]
        return np.ascontiguousarray(numbers[0]), 2.0 * np.pi / numbers[1].astype(float)

    def under(self, problem: Problem) -> ColumnBearing | None:
        """Of the bearing at one point that at n points of a problem in which loads alone differ; None where its preload depends on them."""
        n, (axial, ball_load) = problem.points[0], problem.axial_approach
        basis = attrs.evolve(self.basis, axial=axial, ball_load=largest(ball_load, 1.0))
        params = law_of_contacts(problem, basis)
        if some(problem.bearing.preload) and not np.all(params == self.points.params):
            return None
        scalars, table = (np.repeat(part, n, axis=0) for part in (self.points.scalars, self.points.table))
        guess = first_guess(problem, basis, table[..., ring.SHIFT].max(axis=-1))
        points, faults = Points(scalars, table, params, *_loads(problem), guess), np.repeat(self.faults, n)
        return attrs.evolve(self, problem=problem, basis=basis, points=points, faults=faults, unloaded=self)

    @property
    def conspicuous(self) -> np.ndarray:
        """(n,) whether numbers contradict each other, or leave no bearing: the rules of a scene then say what is wrong."""
        loaded = np.abs(self.points.load).sum(axis=1) + self.problem.bearing.preload
        return (self.unloaded or self)._no_bearing | ~(loaded > 0.0)

    @cached_property
    def _no_bearing(self) -> np.ndarray:
        p, b = self.problem, self.problem.bearing
        wrong = np.zeros(p.points, dtype=bool)
        for rule in DIMENSIONS:
            wrong |= rule.when(b)
        edge = groove_edge(b)
        for row in range(len(b.rows)):
            room, radial = p.running.centre_distance(row)
            wrong |= (room <= 0.0) | (radial >= room) & (b.contact_angle > 0.0) | (radial <= np.cos(edge) * room)
        return wrong | (len({side for side, _ in b.rows}) < 2) & (np.asarray(b.preload) > 0.0)

    def equilibria(self, damped: bool = False) -> States:
        """The static state of each point; ``damped`` : with the damping of its contacts."""
        columns = self.kernels.columns + (2 if self.plan.balls == "tangential" else 0)
        states = _empty_states(len(self.faults), self.points.table.shape[1], columns, damped)
        equilibria(self.kernels, self.linear, self.points, states)
        states.status[self.faults != 0] = self.faults[self.faults != 0]
        return states

    def orbits(
        self, states: States, tolerance: float, near: bool = False, disturbed: bool = False, times: int | None = None
    ) -> Orbits:
        """The steady orbit of each point about its equilibrium under a periodic force.

        tolerance : of the 1x component, relative;  near : whether all points are neighbours of the first one
        disturbed : whether ``transfer`` is computed, too;  times : of a turn at which contact forces are, beside
        their extremes between samples; None: neither, and ``peak`` is an upper bound
        """
        z, n, inertia = self.points.table.shape[1], len(states.status), self.problem.inertia
        params, speed = self.force
        disturbances = 2 * int(self.linear.free.sum()) * disturbed
        least, turn = (0 if times is None else 2 * z,), (times or 0, 2 * z)
        shapes = [(10,), (10,), (5,), *[()] * 3, (2 * z,), least, turn, *[()] * 3, 2 * (disturbances,)]
        out = Orbits(*(np.zeros((n, *shape)) for shape in shapes))
        out = out._replace(error=np.full(n, np.nan), samples=np.zeros(n, np.int64), status=np.full(n, -1, np.int64))
        rows, moments = (inertia.mass,) * 3 + (inertia.transverse,) * 2, gyroscopic(self.problem)
        mass = np.ascontiguousarray(np.stack([np.broadcast_to(value, n) for value in rows], axis=1), dtype=float)
        moments[:, range(3), range(3)] += np.broadcast_to(self.problem.rotor.damping, n)[:, None]
        force = plugin_kernel(self.problem.excitation, "excitation", FORCE, "FORCE")
        turning = Turning(force, params, speed, moments, mass, 0.0, 2.0 * np.pi, np.arange(z), 8, _MOST_SAMPLES, tolerance)
        across = np.any(self.points.load[:, 1:] * self.linear.free[1:] != 0.0, axis=1)
        for these in (np.flatnonzero(across), np.flatnonzero(~across & (states.status == 0))):
            if not len(these):
                continue
            chosen = np.unique(np.append(these, 0)) if near else these if len(these) < n else slice(None)
            first = these[-1]
            parts = {"mass": np.diag(mass[first]), "damping": moments[first], "force": force, "force_params": params[first]}
            system = attrs.evolve(self._system(first), **parts)
            symmetry = None if across[first] else one_pitch(system, speed[first], states.q[first])
            if symmetry is not None:
                sense = float(np.sign(symmetry.angle))
                turning = turning._replace(sense=sense, span=symmetry.span, order=symmetry.order.astype(np.int64), least=4)
            here = _rows(out, chosen)
            mine = _rows(self.points, chosen), _rows(states, chosen), _rows(turning, chosen)
            orbits(self.kernels, self.linear, *mine, near, here)
            for column, part in zip(out, here, strict=True):
                column[chosen] = part
        return out

    def at(self, points: np.ndarray) -> ColumnBearing:
        """Its numbers at some of the points, by their indices; problem and basis are those of all."""
        return attrs.evolve(self, points=_rows(self.points, points), faults=self.faults[points])

    @np.errstate(all="ignore")
    def warmed(self, points: np.ndarray, problem: Problem) -> ColumnBearing:
        """Of a mounted bearing some points, by their indices, at other temperatures of rings, balls and oil: those of ``problem``."""
        part, basis, before = self.at(points), make_basis(problem), self.basis.growth
        scalars, table = part.points.scalars, part.points.table
        scalars[:, ring.REST_AXIAL : ring.TILT_ARM + 1] += basis.growth.common - before.common[points]
        by_ball = before.by_ball[points] if before.by_ball.ndim > 2 else before.by_ball
        table[..., ring.OWN_REST_AXIAL : ring.OWN_TILT_ARM + 1] += basis.growth.by_ball - by_ball
        return running_columns(attrs.evolve(part, problem=problem, basis=basis))

    def _system(self, row: int) -> System:
        """The bearing at one point, at rest."""
        scalars, table, params, load, shaft, _ = (column[row] for column in self.points)
        kernel, base, _, law, _ = self.kernels
        none = np.zeros((5, 5))
        base = base if self.plan.balls == "tangential" else kernel
        return System(
            kernel=kernel, base_kernel=base, law=law, law_params=params, law_state=np.zeros((len(params), 0)), scalars=scalars,
            table=table, load=load, stiffness=np.diag([0.0, 0.0, 0.0, shaft, shaft]), mass=none, damping=none,
            free=self.linear.free, force=no_force, force_params=np.zeros(1),
        )  # fmt: skip

    def _preloaded(self) -> ColumnBearing:
        """With the preload of a set built in: the axial approach of the rows of either direction under it, at standstill."""
        bearing, points, basis = self.problem.bearing, self.points, self.basis
        parts = (getattr(self.problem, name) for name in OF_PRELOAD)
        # Loads and speeds are none of a preload's: where nothing else differs, one point stands for all.
        alike = self.problem.traits.contacts_alone and not any(map(has_columns, parts))
        alike = alike and bool(np.all(points.params == points.params[:1]))
        some_points = np.arange(1 if alike else len(self.faults))
        mounted, sides = _rows(points, some_points), np.array(bearing.rows)[basis.row, 0]
        scalars, table = mounted.scalars, mounted.table
        scalars[:, ring.GYROSCOPIC] = 0.0
        for numbers, first, growth in (
            (scalars, ring.REST_AXIAL, basis.growth.common), (table, ring.OWN_REST_AXIAL, basis.growth.by_ball)
        ):  # fmt: skip
            grown = numbers[..., first : first + 5]
            grown -= np.broadcast_to(growth, (len(self.faults), *grown.shape[1:]))[some_points]
        table[..., ring.CENTRIFUGAL], table[..., [ring.SIDE, ring.LEVER]] = 0.0, (1.0, 0.0)
        n, faults = len(scalars), self.faults.copy()
        none = np.zeros((n, 5))
        for side, force in ((sides[0], bearing.preload), (-sides[0], bearing.other_preload)):
            balls, pressed = np.flatnonzero(sides == side), np.broadcast_to(force, n) > 0.0
            if not len(balls):
                continue
            guess, load = none.copy(), none.copy()
            guess[:, 0], load[:, 0] = 0.05 * basis.geometry.centre_distance, force
            contacts = np.concatenate([balls, balls + len(sides)])
            rows = Points(scalars, table[:, balls].copy(), mounted.params[:, contacts].copy(), load, np.zeros(n), guess)
            states = _empty_states(n, len(balls), self.kernels.columns)
            equilibria(self.kernels, self.linear._replace(free=_AXIAL), rows, states)
            points.table[:, balls, ring.SHIFT] = np.where(pressed[:, None], states.q[:, :1], 0.0)
            faults = np.where(pressed & (states.status != 0), states.status, faults)
        points.guess[:] = first_guess(self.problem, basis, points.table[..., ring.SHIFT].max(axis=-1))
        return attrs.evolve(self, faults=faults)

    def contact_angles(self, states: States) -> tuple[np.ndarray, np.ndarray]:
        """Inner and outer (n, Z) [rad]; nan where a contact is open."""
        centre = np.empty((len(states.q), 2, self.points.table.shape[1]))
        groove_centres(self.points.scalars, self.points.table, states.q, centre)
        return contact_angles(np.moveaxis(centre, 1, 2), True, states.ball, states.force)

    def pressures(self, force: np.ndarray) -> np.ndarray:
        """(n, 2 Z) peak pressures [Pa] under contact forces (n, 2 Z) [N]."""
        z = force.shape[1] // 2
        halves = force[:, :z], force[:, z:]
        return np.concatenate([e.peak_pressure(half) for e, half in zip(self.ellipses, halves, strict=True)], axis=1)

    def impossible(self, force: np.ndarray) -> np.ndarray:
        """(n,) whether any contact would be longer than half the ball's circumference."""
        b, z = self.basis, force.shape[1] // 2
        halves = force[:, :z], force[:, z:]
        if self.problem.bearing.equal_rows:
            largest_of_race = (e.semi_axes(half.max(axis=1))[0] for e, half in zip((b.inner, b.outer), halves, strict=True))
            return np.asarray(np.maximum(*largest_of_race) >= 0.25 * np.pi * b.geometry.ball_diameter)
        pairs = zip(self.ellipses, halves, strict=True)
        return np.any([(e.semi_axes(half)[0] / b.ball_radius).max(axis=1) >= 0.5 * np.pi for e, half in pairs], axis=0)

    def contact_ellipse(self, load: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Peak pressure [Pa] and semi-axes [m] of contacts under loads (n, 2, Z) [N]."""
        halves = [(e.peak_pressure(load[:, k]), *e.semi_axes(load[:, k])) for k, e in enumerate(self.ellipses)]
        pressure, major, minor = (np.stack(np.broadcast_arrays(*pair), axis=1) for pair in zip(*halves, strict=True))
        return pressure, major, minor

    @property
    def ellipses(self) -> tuple[Ellipse, Ellipse]:
        """Of the inner and outer contacts, with numbers that spread over points and balls."""
        pair = self.basis.inner, self.basis.outer
        if not self.problem.bearing.equal_rows:
            return pair
        inner, outer = (Ellipse(*map(per_ball, attrs.astuple(ellipse))) for ellipse in pair)
        return inner, outer


#: Tables of a scene that a preload depends on.
OF_PRELOAD = ("bearing", "bodies", "contact", "mounting")


def running_columns(bearing: ColumnBearing) -> ColumnBearing:
    """A bearing at n points with its law's parameters at their running speeds: ``renew`` of columns, of which those that fit rest."""
    if not renews(bearing.problem.contact.law):
        return bearing
    problem, basis, points, faults = bearing.problem, bearing.basis, bearing.points, bearing.faults.copy()
    n, z = points.table.shape[:2]
    fields = (points.table, points.params, points.guess)
    table, params, guess = (np.array(field) for field in fields)
    bearing = attrs.evolve(bearing, points=points._replace(table=table, params=params, guess=guess), faults=faults)
    mounted, law = contact_pairs(problem, basis), problem.contact.law
    force, reach, angle = np.zeros((n, 2 * z)), np.zeros((n, 2 * z)), np.full((2, n, z), np.nan)
    rows = np.flatnonzero((faults == 0) & ~bearing.conspicuous)
    for _ in range(ITERATIONS):
        part = bearing.at(rows)
        states = part.equilibria()
        faults[rows], guess[rows] = states.status, states.q
        largest = np.maximum(states.force.max(axis=1, initial=0.0), 1e-300)
        fit = np.abs(states.force - force[rows]).max(axis=1, initial=0.0) <= LOAD_TOLERANCE * largest
        force[rows], angle[:, rows] = states.force, part.contact_angles(states)
        rows = rows[~fit & (states.status == 0)]
        if not len(rows):
            return bearing
        contacts = (2 * z * rows[:, None] + np.arange(2 * z)).ravel()
        pairs = running_pairs(problem, basis, force, (angle[0], angle[1]), mounted=mounted).at(contacts)
        law_there, before = at_rows(law, rows), reach[rows]
        params[rows] = law_params(law_there, pairs).reshape(len(rows), 2 * z, -1)
        reach[rows] = reach_of(law_there, pairs).reshape(len(rows), 2 * z)
        ahead = (reach[rows] - before).reshape(-1, 2, z).swapaxes(1, 2)
        table[rows, :, OWN_OFFSET_INNER : OWN_OFFSET_OUTER + 1] -= ahead
    faults[rows] = NOT_CONVERGED
    return bearing


def ball_columns(
    problem: Problem, plan: ScenePlan, deformed: Callable[[Problem, Basis, Tables], tuple[Tables, np.ndarray]] | None = None
) -> ColumnBearing:
    """Balls in grooves, for ``Builder``.

    deformed : kernels and numbers of bodies that deform, from those of rigid ones; (n,) whether the law is too stiff for them
    """
    basis = make_basis(problem)
    parts, too_stiff = contact_parts(problem, plan, basis), np.zeros(problem.points, dtype=bool)
    if deformed is not None:
        parts, too_stiff = deformed(problem, basis, parts)
    bearing = assembled_columns(ColumnBearing, problem, plan, basis, parts)
    bearing.faults[too_stiff] = LOOSE
    if some(problem.bearing.preload):
        return bearing._preloaded()
    bearing.points.guess[:] = first_guess(problem, basis)
    return bearing


def assembled_columns(cls: type[C], problem: Problem, plan: ScenePlan, basis: Basis, parts: Tables) -> C:
    """A bearing at n points of its kernels and their numbers, at standstill and without a guess."""
    n = problem.points[0]
    parts["scalars"][:, ring.CAGE] = 0.0  # at rest; balls of periodic motions stand
    columns = 2 + elastic_columns(parts["scalars"][0])
    own, tangential = (condensed(each) if columns > 2 else each for each in (rigid_inertial, rigid_tangential))
    lanes = parts["base_kernel"] is own and parts["kernel"] in (own, tangential) and columns < 6
    lanes &= not np.any(parts["scalars"][:, ring.FRICTION])
    kernels = Kernels(parts["kernel"], parts["base_kernel"], columns, parts["law"], lanes)
    none = np.zeros((5, 5))
    linear = Linear(none, none, none, np.array(plan.free, dtype=float), np.zeros(5))
    points = Points(parts["scalars"], parts["table"], parts["law_params"], *_loads(problem), np.zeros((n, 5)))
    return cls(problem, plan, basis, linear, points, kernels, np.zeros(n, dtype=np.int64))


def _loads(problem: Problem) -> tuple[np.ndarray, np.ndarray]:
    """(n, 5) loads [N, N m] and (n,) stiffness of the shaft against tilts [N m/rad]."""
    load, shaft, tilt = np.empty((*problem.points, 5)), np.zeros(problem.points), problem.supports.tilt
    for k, number in enumerate((problem.load.axial, *problem.load.radial, *problem.load.moment)):
        load[:, k] = number
    shaft += 0.0 if isinstance(tilt, str) else tilt
    return load, shaft


def solved_columns(bearing: ColumnBearing, states: States, turn: Callable[[int], np.ndarray] | None = None) -> SolvedPoints:
    """n points of a compiled loop as quantities see them; ``turn`` : of ``SolvedPoints``."""
    problem, n, z = bearing.problem, len(states.status), states.force.shape[1] // 2

    return SolvedPoints(
        problem=problem,
        row=bearing.basis.row,
        side=np.array([side for side, _ in problem.bearing.rows])[bearing.basis.row],
        speed=np.broadcast_to(problem.spin_speed, n),
        load=states.force.reshape(n, 2, z),
        contact_angles=lambda: np.stack(bearing.contact_angles(states), axis=1),
        displacement=states.q,
        stiffness=states.stiffness,
        running_contacts=lambda: running_pairs(problem, bearing.basis, states.force, bearing.contact_angles(states)),
        ellipse=bearing.contact_ellipse,
        turn=turn,
    )


def _rows(record: R, chosen: np.ndarray | slice) -> R:
    """Rows of the columns (n, ...) of a record; what all points share stays."""
    arrays = {name: value for name, value in record._asdict().items() if isinstance(value, np.ndarray) and len(value)}
    columns: dict[str, Any] = {name: np.ascontiguousarray(x[chosen]) for name, x in arrays.items() if name != "order"}
    return record._replace(**columns)


def _empty_states(n: int, z: int, columns: int, damped: bool = False) -> States:
    stiffness, damping = np.empty((n, 5, 5)), np.empty((n * damped, 5, 5))
    force, status = np.zeros((n, 2 * z)), np.empty(n, dtype=np.int64)
    return States(np.empty((n, 5)), np.empty((n, z, columns)), stiffness, damping, force, status)


#: Tables of a scene that a bearing is built from, beside its speed and loads.
_BUILT = (*OF_PRELOAD, "kinematics")


@attrs.frozen(eq=False, slots=False)
class Builder:
    """Bearings at columns of a scene's keys, ``plan`` of one point; what loads leave as it is, is built once."""

    plan: ScenePlan

    @np.errstate(all="ignore")  # of points that contradict themselves
    def at(self, columns: Mapping[str, np.ndarray]) -> ColumnBearing:
        """The bearing at the points of columns (n,)."""
        return running_columns(self.mounted(columns))

    @np.errstate(all="ignore")
    def mounted(self, columns: Mapping[str, np.ndarray]) -> ColumnBearing:
        """The same with the contact law as at standstill."""
        own, problem = self.plan.problem, column_problem(self.plan.problem, columns)
        bearing = None
        if own.traits.contacts_alone and all(getattr(problem, name) is getattr(own, name) for name in _BUILT):
            speeds = ((p.spin_speed, p.time_constant) for p in (own, problem))
            if problem.excitation is own.excitation or all(np.all(a == b) for a, b in zip(*speeds, strict=True)):
                bearing = self._unloaded and self._unloaded.under(problem)
        return problem.body_kind.columns(self.plan) if bearing is None else bearing

    @cached_property
    def _unloaded(self) -> ColumnBearing | None:
        """At one point; None where a plug-in has changed what the law makes of its contacts."""
        one = attrs.evolve(self.plan.problem, points=(1,))
        bearing: ColumnBearing = one.body_kind.columns(self.plan)
        params = law_params(one.contact.law, contact_pairs(one, bearing.basis))
        return bearing if np.array_equal(params.ravel(), bearing.points.params.ravel()) else None
