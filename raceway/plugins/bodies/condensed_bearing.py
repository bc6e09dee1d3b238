"""Elastic rings and balls, reduced to the compliances that the contacts feel; one force for each contact."""

from collections.abc import Hashable
from math import nan
from threading import Lock

import attrs
import numpy as np

from raceway.bodies import rigid_bearing as rigid
from raceway.bodies.basis import Basis, seat_of
from raceway.bodies.contacts import elasticity, rigid_rings
from raceway.bodies.model import BuiltBearing, Equilibrium, Model, Told, calibration_error, untold
from raceway.bodies.mounting import place_ring
from raceway.bodies.rigid_bearing import RigidBearing
from raceway.core.contact.hertz import ball_compliance
from raceway.core.fem.calibration import calibrated
from raceway.core.fem.mesh.part_meshes import RingShape, ring_shape
from raceway.core.fem.patches.patch import RingBody, Solid
from raceway.core.fem.revolution.sections import Profile
from raceway.core.fem.structural import (
    SURFACE,
    ElasticBodies,
    elastic_scalars,
    elastic_system,
    first_frequency,
    reach,
    ring_compliance,
    ring_section,
)
from raceway.core.jit import Kernel
from raceway.core.ring.kernels import layout as ring
from raceway.core.ring.kernels.structural import condensed
from raceway.core.ring.system import System, surrogate
from raceway.errors import ConvergenceError, SceneError
from raceway.framework.duties import is_hertzian
from raceway.framework.estimate import Estimate
from raceway.planning.parts import BETWEEN_BALLS
from raceway.planning.plan import ScenePlan
from raceway.planning.resolve import Problem
from raceway.storage.tables import Tables


def inertia_table(model: Model, equilibrium: Equilibrium) -> Tables:
    """First elastic frequencies of both rings as supported and free, and of a ball along its grooves [Hz].

    Each with the error (w / w_1)^2 that leaving out its inertia makes in what it contributes; None in a static scene, and for
    a ball whose inertia the motion has.

    A ball pressed by Q between two grooves is held along them by k = Q_i / L_i + Q_o / L_o, where L is the distance from the
    ball's centre to the groove's.
    """
    problem = model.problem
    b = problem.bearing
    excitation = problem.excitation
    frequency = None if excitation is None else float(excitation.frequency_hz)
    out: Tables = {}

    def tell(name: str, first: float | None) -> None:
        out[f"{name}_hz"] = first
        out[f"{name}_error"] = None if frequency is None or first is None else (frequency / first) ** 2

    for inner, word in ((True, "inner"), (False, "outer")):
        shape = ring_shape(b, inner)
        for name, seat in (("supported", seat_of(problem, inner)), ("free", "free")):
            steel = (b.rings.young, b.rings.poisson, b.rings.density)
            tell(f"{word}_{name}", first_frequency(shape, b.ball_diameter, *steel, seat))
    z, geometry = model.system.ball_count, model.geometry
    force = equilibrium.contact_force
    held = force[:z] / geometry.offset_inner + force[z:] / geometry.offset_outer
    loaded = held[(force[:z] > 0.0) & (force[z:] > 0.0)]
    mass = geometry.ball_mass(b.balls.density)
    slowest = float(np.sqrt(loaded.min() / mass) / (2.0 * np.pi)) if len(loaded) else None
    tell("ball_along_grooves", slowest)
    recorded = problem.recorded
    moves = recorded and problem.integrator.method.inertial and getattr(model.system, "ball_mass", 0.0) > 0.0
    out["ball_along_grooves_in_motion"] = moves
    if moves:
        out["ball_along_grooves_error"] = None
    return out


#: Peak pressure [Pa] of the contact whose length the line loads on the rings have: independent of the scene's load, so that
#: one table serves all of them; the compliance changes by less than 0.01 nm/N with it.
_PRESSURE = 1.5e9
#: Size of elements far from a contact that is calibrated at its surface points, over ``reach``.
_CALIBRATED_BULK = 0.4
#: Compliances of the last scenes: a run asks for them up to four times, a study for the same bodies again and again.
_KEPT = 8
BODIES_BY_SECTION: dict[Hashable, ElasticBodies] = {}
_LOCK = Lock()


def sections(problem: Problem, basis: Basis) -> Hashable:
    """All that the compliances of the rings and their calibrations are computed from: loads and masses are not."""
    b = problem.bearing
    shape = b.ball_diameter, b.pitch_diameter, b.ball_count, b.conformity_inner, b.conformity_outer, b.contact_angle
    sizes = b.bore, b.outer_diameter, b.width, b.shoulder_height, b.inner_profile, b.outer_profile
    elastic = b.rings.young, b.rings.poisson, b.balls.young, b.balls.poisson
    pairs = tuple(
        (float(ellipse.factor), *(float(axis) for axis in ellipse.semi_axes(1.0))) for ellipse in (basis.inner, basis.outer)
    )
    return shape, sizes, elastic, pairs, problem.supports.inner_seat, problem.supports.outer_seat, problem.mesh


def elastic_bodies(problem: Problem, basis: Basis, coarser: float = 1.0) -> ElasticBodies:
    """Structural compliances of a scene's rings and balls; those of the last few scenes are cached.

    coarser : factor on all sizes of elements

    SceneError: Bodies so soft that their contacts are as large as a ball.
    """
    key = (sections(problem, basis), coarser)
    with _LOCK:
        bodies = BODIES_BY_SECTION.pop(key, None) or _elastic_bodies(problem, basis, coarser)
        BODIES_BY_SECTION[key] = bodies  # the last in, and the last to go
        if len(BODIES_BY_SECTION) > _KEPT:
            del BODIES_BY_SECTION[next(iter(BODIES_BY_SECTION))]
    b, (a, across) = problem.bearing, (float(x) for x in basis.inner.semi_axes(basis.ball_load))
    direct, opposite = ball_compliance(0.5 * b.ball_diameter, b.balls.young, b.balls.poisson, a, across)
    if not abs(direct) * basis.ball_load < b.ball_diameter:
        soft, steel = min(("balls", b.balls), ("rings", b.rings), key=lambda part: part[1].young)
        why = f"is too soft for {basis.ball_load:.3g} N per ball: its contacts would be as large as the ball. Steel has 2.1e11 Pa"
        raise SceneError.at(f"bearing.{soft}.young", steel.young, why)
    return attrs.evolve(bodies, ball_direct=direct, ball_opposite=opposite)


def _elastic_bodies(problem: Problem, basis: Basis, coarser: float) -> ElasticBodies:
    """Rings and calibrations; the ball's own compliance, which follows the load, is filled in each time."""
    b = problem.bearing
    typical = _typical_load(basis)
    rings, calibrations = [], []
    for inner in (True, False):
        shape = ring_shape(b, inner)
        half = float((basis.inner if inner else basis.outer).semi_axes(typical)[0])
        bulk, fine = _element_sizes(problem, shape, half)
        contacts, elastic = (b.ball_diameter, b.ball_count, half), (b.rings.young, b.rings.poisson, seat_of(problem, inner))
        sizes = (coarser * bulk, coarser * min(fine, bulk), coarser * min(2.0 * fine, bulk))
        rings.append(ring_compliance(shape, *contacts, *elastic, *sizes))
        size = _CALIBRATED_BULK * reach(shape, b.ball_diameter)
        steel, balls = (Solid(material.young, material.poisson, bulk=size) for material in (b.rings, b.balls))
        body = RingBody(shape, steel, seat_of(problem, inner), (0.0, 0.0))
        both = basis.inner, basis.outer
        calibrations.append(
            calibrated(body, balls, both, typical, 0.5 * b.ball_diameter, b.ball_count, abs(b.contact_angle))
        )
    return ElasticBodies(rings[0], rings[1], nan, nan, (calibrations[0], calibrations[1]))


def _typical_load(basis: Basis) -> float:
    """The load of ``_PRESSURE`` on the inner race [N]: p0 grows with the cube root of the load."""
    return float((_PRESSURE / basis.inner.peak_pressure(1.0)) ** 3)


def _element_sizes(problem: Problem, shape: RingShape, half: float) -> tuple[float, float]:
    """Sizes of a ring's elements far from the groove and on it [m]; ``half``: semi-major axis of a typical contact."""
    length = reach(shape, problem.bearing.ball_diameter)
    if problem.mesh is None:
        return 0.62 * length, SURFACE * length
    return min(problem.mesh.element_size, 0.62 * length), half / problem.mesh.nodes_per_semi_axis


#: How much coarser the mesh is that error.mesh is estimated with.
_COARSER = 2.0
#: Entries of the stiffness below this part of sqrt(K_ii K_jj) are coupling that cancels out: no relative difference.
_NOTHING = 1e-6


def build(problem: Problem, plan: ScenePlan) -> "_CondensedBearing":
    """The bearing of a scene with condensed bodies and contact resultants."""
    stiff = rigid.build(problem, plan)
    bodies = elastic_bodies(problem, stiff.basis)
    _refuse_stiff_law(problem, stiff, bodies)
    _refuse_dashpots(problem, plan, stiff, bodies)
    angles = _contact_angles(problem, stiff) if plan.keeps(BETWEEN_BALLS) else None
    system = elastic_system(surrogate(stiff.system), bodies, angles)
    return _CondensedBearing(stiff.basis, system, place_ring(problem, stiff.basis, system), stiff, bodies, angles)


@attrs.frozen(eq=False)
class _CondensedBearing(BuiltBearing):
    """Condensed rings and balls with contact resultants."""

    rigid: RigidBearing  # the same bearing with rigid rings and balls
    compliances: ElasticBodies  # of rings and balls
    angles: np.ndarray | None  # (Z,) at which the compliances between balls were taken [rad]; None where they are left out

    def report(self, model: Model, equilibrium: Equilibrium) -> Tables:
        """The table ``model`` of result.json: what the elasticity of the bodies changes, and how good their mesh is."""
        rigid_table, stiffness = rigid_rings(surrogate(self.rigid.system), self.rigid.guess)
        angle = float(np.nanmean(equilibrium.angle_inner))
        inner, outer = self.compliances.at(angle)
        mesh_error, how = self.mesh_error(model, equilibrium)
        half = float(model.inner.semi_axes(np.max(equilibrium.contact_force[: model.system.ball_count]))[0])
        return {
            "bodies": "condensed: elastic rings and balls, contacts as resultants calibrated to Hertz",
            "rigid_rings": rigid_table,
            "elasticity": elasticity(equilibrium.stiffness, stiffness, _NOTHING),
            "compliance": {
                "contact_angle_deg": float(np.degrees(angle)),
                "inner_m_per_n": inner,
                "outer_m_per_n": outer,
                "ball_own_m_per_n": self.compliances.ball_direct,
                "ball_opposite_m_per_n": self.compliances.ball_opposite,
                "largest_between_balls_m_per_n": self.compliances.largest_across,
                "between_balls": self.angles is not None,
            },
            "mesh": {
                "elements_inner": self.compliances.inner.elements,
                "elements_outer": self.compliances.outer.elements,
                "nodes_per_semi_axis": half / self.compliances.inner.surface,
                "change_from_coarser": mesh_error,
                "how": how,
            },
            "inertia": inertia_table(model, equilibrium),
        }

    def mesh_error(self, model: Model, equilibrium: Equilibrium) -> Told:
        """Relative change of the diagonal stiffness when rings are meshed twice as coarse: an upper bound of the error."""
        coarse = elastic_bodies(model.problem, self.rigid.basis, _COARSER)
        system = elastic_system(surrogate(self.rigid.system), coarse, self.angles)
        system.table[:, ring.SHIFT] = model.system.table[:, ring.SHIFT]
        try:
            q, ball, _ = attrs.evolve(system, load=model.system.load).solve_equilibrium(equilibrium.displacement)
        except ConvergenceError as why:
            return None, Estimate.COARSER_MESH_FAILED(why=why)
        free = np.flatnonzero(model.system.free > 0.0)
        fine = np.diag(equilibrium.stiffness_rows_held)[free]
        diagonal = np.diag(system.evaluate(q, ball=ball).stiffness)[free]
        return float(np.abs(diagonal / fine - 1.0).max()), Estimate.COARSER_MESH()

    def contact_error(self, model: Model, equilibrium: Equilibrium) -> Told:
        """Of a ball's stiffness by what its contacts' calibration leaves; the largest of all loaded balls."""
        return calibration_error(self.compliances, model, equilibrium) if model.traits.calibrated else untold(model)

    def ring_section(self, model: Model, inner: bool) -> Profile:
        """The mesh of a ring's section that its compliance was computed on, for pictures."""
        basis, shape = self.rigid.basis, ring_shape(model.problem.bearing, inner)
        half = float((basis.inner if inner else basis.outer).semi_axes(_typical_load(basis))[0])
        bulk, fine = _element_sizes(model.problem, shape, half)
        return ring_section(shape, model.problem.bearing.ball_diameter, bulk, min(fine, bulk))


def _contact_angles(problem: Problem, stiff: RigidBearing) -> np.ndarray:
    """(Z,) contact angles with rigid rings: the free one where a ball carries nothing; their mean for balls that orbit."""
    system: System = surrogate(stiff.system)
    angles = np.full(system.ball_count, problem.bearing.contact_angle)
    try:
        q, ball, _ = system.solve_equilibrium(stiff.guess)
    except ConvergenceError:
        return angles
    centre, _ = system.centre_vectors(q)
    loaded = system.evaluate(q, ball=ball).contact_force[: system.ball_count] > 0.0
    directions = np.arctan2(centre[:, 0], centre[:, 1])
    if problem.kinematics.orbiting and loaded.any():
        return np.full(system.ball_count, directions[loaded].mean())
    return np.where(loaded, directions, angles)


def _refuse_stiff_law(problem: Problem, stiff: RigidBearing, bodies: ElasticBodies) -> None:
    """A law so stiff that the bodies take off more compliance than its contact has."""
    compliance = min(bodies.at(problem.bearing.contact_angle))
    if compliance >= 0.0:
        return
    system = surrogate(stiff.system)
    stiffness = float(_law_stiffness(problem, stiff.basis, system.law, system.law_params))
    if stiffness * -compliance >= 1.0:
        thin = "The walls below the grooves are too thin: check bore, outer_diameter and profiles"
        remedy = thin if is_hertzian(problem.contact.law) else "Use 'hertz', or a softer law"
        taken = f"they take {-1e9 * compliance:.3g} nm/N off it, since they are stiffer than half-spaces"
        why = f"its contact of {1e-6 * stiffness:.3g} N/µm is stiffer than elastic bodies allow: {taken}. {remedy}"
        raise SceneError.at("contact.kind", problem.contact.kind, why)


def _law_stiffness(problem: Problem, basis: Basis, law: Kernel, params: np.ndarray) -> np.ndarray:
    """(...) largest stiffness [N/m] of a law with params (..., 2 Z, k), at one and five times a ball's rough load."""
    largest, contacts = np.zeros(params.shape[:-2]), params.shape[:-1]
    memory = np.zeros((np.prod(contacts), problem.contact.law.state_size))
    for load in (1.0, 5.0):
        approach = np.asarray(basis.inner.approach(load * basis.ball_load))[..., None]
        gap = -np.broadcast_to(approach, contacts).ravel()
        force, d_gap, d_rate = np.empty_like(gap), np.empty_like(gap), np.empty_like(gap)
        law(gap, np.zeros_like(gap), params.reshape(len(gap), -1), memory, memory.copy(), 0.0, force, d_gap, d_rate)
        largest = np.maximum(largest, -d_gap.reshape(contacts).min(axis=-1))
    return largest


def elastic_parts(problem: Problem, basis: Basis, parts: Tables) -> tuple[Tables, np.ndarray]:
    """The ``contact_parts`` of n points that share condensed bodies, from those of rigid ones; (n,) whether the law is too stiff."""
    bodies = elastic_bodies(problem, attrs.evolve(basis, ball_load=float(np.min(basis.ball_load))))
    scalars = elastic_scalars(parts["scalars"], bodies)
    # Loads make themselves felt in a ball's own compliance only, which contacts calibrated at surface points have in them.
    own, knots = np.zeros((2, *problem.points)), int(scalars[0, ring.KNOTS])
    for race in (k for k, calibration in enumerate(bodies.calibrations) if calibration is None):
        loads, place = np.unique(np.broadcast_to(basis.ball_load, problem.points), return_inverse=True)
        ball = 0.5 * problem.bearing.ball_diameter, problem.bearing.balls.young, problem.bearing.balls.poisson
        each = [ball_compliance(*ball, *map(float, basis.inner.semi_axes(load)))[0] for load in loads]
        own[race] = np.array(each)[place] - bodies.ball_direct
        scalars[:, ring.VALUES + 2 * race * knots :][:, :knots] += own[race][:, None]
    compliance = (np.array(bodies.at(problem.bearing.contact_angle))[:, None] + own).min(axis=0)
    too_stiff = _law_stiffness(problem, basis, parts["law"], parts["law_params"]) * -compliance >= 1.0
    kernels = {name: condensed(parts[name]) for name in ("kernel", "base_kernel")}
    return {**parts, **kernels, "scalars": scalars}, too_stiff


def _refuse_dashpots(problem: Problem, plan: ScenePlan, stiff: RigidBearing, bodies: ElasticBodies) -> None:
    """Dashpots that a time step makes stiffer than what the bodies take off leaves."""
    compliance = -min(bodies.at(problem.bearing.contact_angle))
    if plan.time_step_s is None or problem.integrator.method.steady or compliance <= 0.0:
        return
    # A rate is 1.5 / dt of a displacement; the contact's own stiffness needs the other half.
    bound = 0.5 * plan.time_step_s / (1.5 * compliance)
    words = f"makes contacts stiffer within a step of {plan.time_step_s:.3g} s than elastic bodies allow: they take {1e9 * compliance:.3g} nm/N off them"
    if problem.contact.dashpot > bound:
        why = f"{words}. Use at most {bound:.3g} N s/m, or fewer steps per turn"
        raise SceneError.at("contact.damping", problem.contact.damping, why)
    load = float(_typical_load(stiff.basis))
    stiffness = max(1.5 * load / float(ellipse.approach(load)) for ellipse in (stiff.basis.inner, stiff.basis.outer))
    if problem.time_constant * stiffness > bound:
        why = f"{words}. Use at most {bound / stiffness:.3g} s, or fewer steps per turn"
        raise SceneError.at("contact.time_constant", problem.time_constant, why)
