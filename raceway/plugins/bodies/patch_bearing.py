"""Condensed rings and balls whose contacts are pressures at surface points.

The answer of rigid rings on Hertz's contacts says how far the contacts reach and which load the points are laid out for;
where contacts go further than that, the patches are made wider.
"""

from collections.abc import Callable

import attrs
import numpy as np

from raceway.bodies.basis import Basis, at_points, contact_pairs, make_basis
from raceway.bodies.contacts import elasticity, rigid_rings
from raceway.bodies.model import BuiltBearing, Equilibrium, Model, Told, overlap
from raceway.bodies.mounting import place_ring
from raceway.bodies.rigid_bearing import probe, rigid_system, with_hertz
from raceway.core.fem.mesh.part_meshes import ring_shape
from raceway.core.fem.patches.patch import Patch, RingBody, Solid, Spacing, make_ball, make_patch
from raceway.core.fem.patches.pressure import BeyondPatch, ContactState, PointLaw, Reach, reach_of
from raceway.core.fem.patches.system import PatchSystem, Pool
from raceway.core.record import Record
from raceway.core.ring.kernels.layout import CAGE
from raceway.core.ring.orbit import steady_orbit
from raceway.core.ring.ring import Evaluation, Ring
from raceway.core.ring.system import System, surrogate
from raceway.core.signatures import LAW
from raceway.errors import ConvergenceError, RacewayError
from raceway.framework.duties import is_constraint, law_params
from raceway.framework.estimate import Estimate
from raceway.framework.loading.probe import plugin_kernel
from raceway.planning.plan import ScenePlan
from raceway.planning.resolve import Problem
from raceway.plugins.bodies.condensed_bearing import inertia_table
from raceway.plugins.bodies.mesh import locking
from raceway.scene.growth import load_at_edge
from raceway.storage.tables import Tables

#: Entries of the stiffness below this part of sqrt(K_ii K_jj) are ripple or cancel out: no relative difference.
_NOTHING = 0.02
#: Points along a semi-axis below which the largest pressure is off by more than 1 %.
_ENOUGH = 3.0


@attrs.frozen(eq=False)
class PressureField:
    """Pressures on a ball's surface."""

    along: np.ndarray  # (m,) place along the groove, from the contact angle of zero [m]
    across: np.ndarray  # (n,) along the rolling direction [m]
    angle: np.ndarray  # (m,) of the rows on the ball, as contact angles [rad]
    pressure: np.ndarray  # (m, n) [Pa], zero where nothing carries


def pressure_field(patch: Patch, state: ContactState) -> PressureField:
    """Pressures of a contact at all points of its patch."""
    pressure = np.zeros(patch.rows * patch.columns)
    pressure[state.nodes] = state.load / patch.area
    radius = patch.ball.radius
    return PressureField(
        radius * patch.phi, radius * patch.ball.latitude, patch.phi, pressure.reshape(patch.rows, patch.columns)
    )


@attrs.frozen(eq=False)
class _NodalBearing(BuiltBearing):
    """Condensed rings and balls with pressures at surface points."""

    nodes: float  # points along each semi-axis of the inner contact at ``load`` [N]
    load: float
    spacing: Spacing
    pool: Pool  # patches as they are now
    rigid: System  # the same scene with rigid bodies
    beside: np.ndarray  # (5,) where its equilibrium is looked for
    coarser: Callable[[], Ring] | None  # builds the same system with half as many points; None where there are no fewer
    _errors: dict[bytes, tuple[float | None, str]] = attrs.field(init=False, factory=dict)

    def friction_lost(self, system: Ring, record: Record) -> float:
        """By the points' memory."""
        assert isinstance(system, PatchSystem)
        return system.friction_lost(record)

    def solve_equilibrium(
        self, near: np.ndarray | None = None, on_progress: Callable[[str, int, int], None] | None = None
    ) -> tuple[np.ndarray, np.ndarray, int]:
        """From a near equilibrium, what is held staying where it is; from the own guess where that fails."""
        if near is not None:
            try:
                return self.system.solve_equilibrium(np.where(self.system.free > 0.0, near, self.guess))
            except ConvergenceError:
                pass  # the own guess decides whether there is an equilibrium
        return super().solve_equilibrium()

    def contact_error(self, model: Model, equilibrium: Equilibrium) -> Told:
        """The overlap that a law leaves."""
        return overlap(self.ball_columns(model, equilibrium), equilibrium)

    def pressed(self, model: Model, equilibrium: Equilibrium) -> tuple[Evaluation, list[ContactState]]:
        """The state and the contacts' answers at the equilibrium, inner races first."""
        system = model.system.without(CAGE)
        assert isinstance(system, PatchSystem)
        return system.evaluate(equilibrium.displacement, ball=equilibrium.ball), system.pressures()

    def pressure_field(self, model: Model, equilibrium: Equilibrium, ball: int, inner: bool = True) -> PressureField:
        """Pressures of one contact at the equilibrium."""
        contacts = self.pressed(model, equilibrium)[1]
        contact = ball if inner else ball + model.system.ball_count
        return pressure_field(self.pool.patches[0 if inner else 1], contacts[contact])

    def ball_columns(self, model: Model, equilibrium: Equilibrium) -> dict[str, np.ndarray]:
        """Keys of ``equilibrium.balls[]`` in result.json beyond those of all bodies, each (Z,).

        The approach of a contact is Hertz's at its load, what a law's penetration adds, and the rest, which finite rings
        and balls give less or more than half-spaces.
        """
        now, contacts = self.pressed(model, equilibrium)
        z, out = model.system.ball_count, {}
        for race, (word, ellipse) in enumerate((("inner", model.inner), ("outer", model.outer))):
            states = contacts[race * z : (race + 1) * z]
            load = now.contact_force[race * z : (race + 1) * z]
            approach = np.where(load > 0.0, -now.gap[race * z : (race + 1) * z], 0.0)
            penetration = np.array([state.penetration for state in states])
            area = self.pool.patches[race].area
            out[f"peak_pressure_nodal_{word}_pa"] = np.array([state.load.max(initial=0.0) / area for state in states])
            out[f"points_{word}"] = np.array([float(len(state.nodes)) for state in states])
            across = np.array([float(ellipse.semi_axes(f)[1]) for f in load]) / self.spacing.across
            along = np.array([float(ellipse.semi_axes(f)[0]) for f in load]) / self.spacing.along
            out[f"points_per_semi_axis_{word}"] = np.minimum(across, along)
            out[f"approach_{word}_m"] = approach
            out[f"approach_hertz_{word}_m"] = np.asarray(ellipse.approach(load))
            out[f"approach_penetration_{word}_m"] = penetration
            out[f"approach_structural_{word}_m"] = approach - np.asarray(ellipse.approach(load)) - penetration
        return out

    def report(self, model: Model, equilibrium: Equilibrium) -> Tables:
        """The table ``model`` of result.json."""
        rigid_table, stiffness = rigid_rings(self.rigid, self.beside)
        columns = self.ball_columns(model, equilibrium)
        error, how = self._change_from_coarser(model, equilibrium)
        counts = [columns[f"points_per_semi_axis_{word}"] for word in ("inner", "outer")]
        loaded = equilibrium.contact_force[: model.system.ball_count] > 0.0
        approach = columns["approach_inner_m"][loaded]
        share = columns["approach_penetration_inner_m"][loaded] / approach if loaded.any() else np.zeros(1)
        return {
            "bodies": "condensed: finite elements of rings and balls, pressures at surface points",
            "rigid_rings": rigid_table,
            "elasticity": elasticity(equilibrium.stiffness, stiffness, _NOTHING),
            "mesh": {
                "nodes_per_semi_axis": self.nodes,
                "at_ball_load_n": self.load,
                "least_nodes_per_semi_axis": float(min(np.min(c[loaded], initial=np.inf) for c in counts)),
                "spacing_along_m": self.spacing.along,
                "spacing_across_m": self.spacing.across,
                "change_from_coarser": error,
                "how": how,
            },
            "inertia": inertia_table(model, equilibrium),
            "penetration_share": float(share.max(initial=0.0)),
            "tangent": "mean over all positions of the points under the ellipses, which removes the ripple",
        }

    def mesh_error(self, model: Model, equilibrium: Equilibrium) -> tuple[float | None, str]:
        """Relative error by too few points: of the displacement or, where a motion is identified, by the ripple if larger.

        The displacement's is of order 2: a third of what half as many points change.  The ripple is measured at one place
        of the points, against the mean over all places; a motion of some micrometres meets a few places and averages some of it.
        """
        error, how = self._change_from_coarser(model, equilibrium)
        if model.problem.excitation is None or not {"record", "speeds"} & set(model.problem.identifier.method.needs):
            return error, how
        radial = np.diag(self.pressed(model, equilibrium)[0].stiffness)[1:3]
        ripple = float(np.abs(radial / np.diag(equilibrium.stiffness_rows_held)[1:3] - 1.0).max())
        if error is not None and error >= ripple:
            return error, Estimate.FEWER_POINTS_NOT_RIPPLE(ripple=ripple)
        return ripple, Estimate.RIPPLE(change="" if error is None else f"; {how} is {error:.2g}")

    def _change_from_coarser(self, model: Model, equilibrium: Equilibrium) -> tuple[float | None, str]:
        if self.coarser is None:
            return None, Estimate.FEWEST_POINTS()
        state = model.system.load.tobytes() + equilibrium.displacement.tobytes()
        if state not in self._errors:
            self._errors[state] = self._compared(self.coarser, model, equilibrium)
        return self._errors[state]

    @staticmethod
    def _compared(coarser: Callable[[], Ring], model: Model, equilibrium: Equilibrium) -> tuple[float | None, str]:
        try:
            q, _, _ = attrs.evolve(coarser(), load=model.system.load).solve_equilibrium(equilibrium.displacement)
        except RacewayError as why:
            return None, Estimate.FEWER_POINTS_FAILED(why=why)
        weight = np.array([1.0, 1.0, 1.0, model.system.arm, model.system.arm])
        change = np.abs((q - equilibrium.displacement) * weight).max() / np.abs(equilibrium.displacement * weight).max()
        return float(change) / 3.0, Estimate.FEWER_POINTS()

    def warnings(self, model: Model, equilibrium: Equilibrium) -> list[str]:
        """Contacts that the groove's edge cuts off, with the load at which that begins; points that are too few; elements that lock."""
        _, contacts = self.pressed(model, equilibrium)
        z, radius, sentences = model.system.ball_count, 0.5 * model.geometry.ball_diameter, locking(model.problem)
        for race, (word, ellipse) in enumerate((("inner", model.inner), ("outer", model.outer))):
            truncated = [state for state in contacts[race * z : (race + 1) * z] if state.truncated]
            if not truncated:
                continue
            sense = self.pool.patches[race].race.sense
            worst = max(truncated, key=lambda state: float(np.hypot(*state.force)))
            angle = float(np.arctan2(-sense * worst.force[0], -sense * worst.force[1]))
            low, high = self.pool.patches[race].race.edges
            edge, angle = (high, angle) if high - angle < angle - low else (-low, -angle)
            begins = load_at_edge(ellipse, radius, edge - angle)
            sentences.append(
                f"{len(truncated)} contact(s) on the {word} race are truncated by the groove's edge at {np.degrees(edge):.1f} deg: at "
                f"{np.degrees(angle):.1f} deg that begins at {begins:.3g} N per ball; the pressure at the edge depends on the mesh"
            )
        columns = self.ball_columns(model, equilibrium)
        loaded = equilibrium.contact_force[:z] > 0.05 * equilibrium.contact_force[:z].max(initial=1e-300)
        least = float(columns["points_per_semi_axis_inner"][loaded].min(initial=np.inf))
        if least < _ENOUGH:
            remedy = "use more mesh.nodes_per_semi_axis for its pressure, which is off by percents below 3"
            sentences.insert(0, f"only {least:.1f} points lie along a semi-axis of a loaded contact: {remedy}")
        return sentences


#: Size of elements far from the contacts [m] where the scene says nothing.
BULK = 0.8e-3
#: Contacts that are laid out may carry this much more than rigid bodies say before patches are made anew.
_ROOM = 1.2


def build(problem: Problem, plan: ScenePlan, per_semi_axis: int) -> _NodalBearing:
    """The bearing of a scene with condensed bodies and pressures at so many surface points along each semi-axis.

    MeshError: Rings without dimensions, sections that cannot be meshed.
    """
    basis = make_basis(problem)
    as_rigid = with_hertz(problem)
    rigid = rigid_system(as_rigid, plan, basis)
    probe(as_rigid, basis, rigid)
    guess = place_ring(as_rigid, basis, rigid)
    reach = _first_reach(problem, basis, rigid, guess)
    nodes, load = float(per_semi_axis), getattr(problem.mesh, "ball_load", None)
    # Of two digits: states near each other then share their compliances.
    load = float(f"{reach.mean_load:.1e}" if load is None else load)
    system, spacing = _system(problem, basis, rigid, reach, nodes, load)
    beside = guess
    if problem.bearing.preloaded or problem.supports.axial == "displacement":
        rigid = attrs.evolve(rigid, table=rigid.table.copy())
        guess = place_ring(as_rigid, basis, system)

    def coarser() -> Ring:
        coarse, _ = _system(problem, basis, system, reach, 0.5 * nodes, load)
        return coarse

    fewer = coarser if nodes >= 2.0 else None
    return _NodalBearing(basis, system, guess, nodes, load, spacing, system.pool, rigid, beside, fewer)


def _system(
    problem: Problem, basis: Basis, ring: Ring, reach: Reach, nodes: float, load: float
) -> tuple[PatchSystem, Spacing]:
    """A ring like another one, on patches with so many points along the semi-axes at a load [N]."""
    a, b = basis.inner.semi_axes(load)
    spacing = Spacing.of((float(a), float(b)), nodes, 0.5 * basis.geometry.ball_diameter, reach.widest)
    make = _maker(problem, spacing)
    law, laws = problem.contact.law, list[PointLaw | None]([None, None])
    if not is_constraint(law):  # the plan has refused those that remember
        pairs = at_points(contact_pairs(problem, basis), np.array([0, len(basis.azimuth)]), np.full(2, spacing.area))
        kernel = plugin_kernel(law, "contact law", LAW, "LAW")
        laws = [PointLaw(kernel, row, spacing.area) for row in law_params(law, pairs, "race")]

    def wider(beyond: BeyondPatch) -> tuple[Patch, Patch]:
        nonlocal reach
        ellipse = basis.inner if beyond.sense < 0.0 else basis.outer
        reach = reach.grown(beyond, ellipse, 0.5 * basis.geometry.ball_diameter, _ROOM)
        return make(reach)

    pool = Pool(make(reach), (laws[0], laws[1]), wider, problem.contact.friction)
    mass = basis.geometry.ball_mass(problem.bearing.balls.density) if problem.kinematics.ball_inertia else 0.0
    fields = {f.name: getattr(ring, f.name) for f in attrs.fields(Ring)}
    return PatchSystem(**{**fields, "table": ring.table.copy()}, rigid=surrogate(ring), pool=pool, ball_mass=mass), spacing


def _first_reach(problem: Problem, basis: Basis, rigid: System, guess: np.ndarray) -> Reach:
    """Loads and contact angles of rigid bodies at rest and, where the excitation repeats, on its orbit."""
    q, ball, _ = rigid.solve_equilibrium(guess)
    states = [(q, ball, 0.0)]
    excitation = problem.excitation
    if excitation is not None and excitation.period_s is not None:
        try:
            orbit = steady_orbit(rigid.at_standstill(), excitation.period_s, q, samples=33)
            times = np.arange(33) * orbit.period / 33
            states += [(q, ball, t) for q, ball, t in zip(orbit.displacement, orbit.ball, times, strict=True)]
        except ConvergenceError:
            pass  # patches grow on the way
    angles: tuple[list[np.ndarray], list[np.ndarray]] = ([], [])
    loads: tuple[list[np.ndarray], list[np.ndarray]] = ([], [])
    still = rigid.at_standstill()
    for q, ball, t in states:
        now = still.evaluate(q, ball=ball[:, : still.ball_columns], t=t)
        centre = still.centre_vectors(q, t)[0]
        z = still.ball_count
        for race, vector in enumerate((centre - now.ball[:, :2], now.ball[:, :2])):
            angles[race].append(np.arctan2(vector[:, 0], vector[:, 1]))
            loads[race].append(now.contact_force[race * z : (race + 1) * z])
    free = basis.geometry.contact_angle
    inner, outer = ((np.concatenate(a), np.concatenate(f)) for a, f in zip(angles, loads, strict=True))
    return reach_of(inner, outer, (basis.inner, basis.outer), 0.5 * basis.geometry.ball_diameter, free, _ROOM)


def _maker(problem: Problem, spacing: Spacing) -> Callable[[Reach], tuple[Patch, Patch]]:
    """Patches for a reach; the ball's grid follows the larger one of the two."""
    b = problem.bearing
    bulk = float(getattr(problem.mesh, "element_size", BULK))
    rings = Solid(b.rings.young, b.rings.poisson, bulk=bulk)
    steel = Solid(b.balls.young, b.balls.poisson, bulk=bulk)
    seats = [k if isinstance(k, float) else "clamped" for k in (problem.supports.inner_seat, problem.supports.outer_seat)]

    def make(reach: Reach) -> tuple[Patch, Patch]:
        grid = spacing.holding(reach.widest)
        # Half a row for mean stiffnesses, which slide so far, and half a row since the last one must carry nothing.
        slide = grid.along / min(ring_shape(b, inner).groove for inner in (True, False))
        bodies = [
            RingBody(ring_shape(b, inner), rings, seat, (window[0] - slide, window[1] + slide))
            for inner, seat, window in zip((True, False), seats, (reach.inner, reach.outer), strict=True)
        ]
        rows = max(int((body.window[1] - body.window[0]) * body.shape.groove / grid.along) + 2 for body in bodies)
        ball = make_ball(0.5 * b.ball_diameter, steel, grid, rows, shear=problem.contact.friction > 0.0)
        first, second = (make_patch(body, ball, grid, b.ball_count) for body in bodies)
        return first, second

    return make
