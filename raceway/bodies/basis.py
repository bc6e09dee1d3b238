"""What every kind of bodies starts from: geometry, contacts, loads and the linear parts of the ring."""

from math import pi

import attrs
import numpy as np

from raceway.core.columns import Number, largest, per_ball, radians, where
from raceway.core.contact.geometry import BallBearing, Growth
from raceway.core.contact.hertz import Ellipse, contact_modulus, every
from raceway.core.ring.ring import ChangingSpeed
from raceway.core.signatures import FORCE
from raceway.framework.contracts import ContactPairs
from raceway.framework.duties import force_params
from raceway.framework.loading.probe import plugin_kernel
from raceway.planning.plan import ScenePlan
from raceway.planning.resolve import Problem
from raceway.scene.growth import RunningBearing
from raceway.storage.tables import Tables


@attrs.frozen(eq=False)
class Basis:
    """Geometry and load-independent contacts of a scene.

    Of n operating points all numbers may be columns (n,).
    """

    geometry: BallBearing  # lengths of the first row
    geometries: tuple[BallBearing, ...]  # of each row
    modulus: float  # E* [Pa]
    #: inner, outer : Hertz contacts; of rows that differ those of all balls, with numbers (Z,)
    inner: Ellipse
    outer: Ellipse
    azimuth: np.ndarray  # (Z,) at time zero, rows one after the other [rad]
    row: np.ndarray  # (Z,) to which row of the set each ball belongs
    #: axial, ball_load : rough axial approach [m] and load of a ball [N] under the axial load alone
    axial: float
    ball_load: float
    growth: Growth  # of the grooves of the running, warm rows beyond those before mounting

    @property
    def ball_radius(self) -> np.ndarray | float:
        """D/2 [m]: one number, or (Z,) of rows that differ."""
        radii = [0.5 * geometry.ball_diameter for geometry in self.geometries]
        return radii[0] if len(set(radii)) == 1 else np.array(radii)[self.row]

    def of_ball(self, ball: int) -> tuple[Ellipse, Ellipse]:
        """Inner and outer Hertz contact of one ball."""
        return self.geometries[self.row[ball]].ellipses(self.modulus)


def make_basis(problem: Problem, meshed: bool = False) -> Basis:
    """Geometry and contacts of a scene; bodies that are ``meshed`` where they touch count axial displacements from there."""
    b = problem.bearing
    geometries = tuple(BallBearing.of(bearing, b.centred and not meshed) for bearing in b.of_rows)
    modulus = contact_modulus(b.rings.young, b.rings.poisson, b.balls.young, b.balls.poisson)
    azimuth = [
        per_ball(radians(bearing.first_ball_azimuth_deg)) + 2.0 * pi * np.arange(bearing.ball_count) / bearing.ball_count
        for bearing in b.of_rows
    ]
    row = np.repeat(np.arange(len(b.rows)), [bearing.ball_count for bearing in b.of_rows])
    inner, outer = geometries[0].ellipses(modulus)
    if not b.equal_rows:
        pairs = [geometry.ellipses(modulus) for geometry in geometries]
        inner, outer = (every([pair[race] for pair in pairs], row) for race in (0, 1))
    axial, ball_load = problem.axial_approach
    balls = np.concatenate(azimuth, axis=-1), row
    load, growth = largest(ball_load, 1.0), growth_of(problem.running, row)
    return Basis(geometries[0], geometries, modulus, inner, outer, *balls, axial, load, growth)


def growth_of(running: RunningBearing, row: np.ndarray) -> Growth:
    """Of the grooves; ``row`` (Z,) is each ball's."""
    numbers = [[grown.axial, grown.radial, grown.inner, grown.outer, 0.0] for grown in running.grooves]
    rows = np.empty((*np.broadcast_shapes(*(np.shape(number) for grown in numbers for number in grown)), len(numbers), 5))
    for place in np.ndindex(rows.shape[-2:]):
        rows[(..., *place)] = numbers[place[0]][place[1]]
    # What places make of temperatures is each row's own, and so is all that rows of other bearings have beyond the first.
    common = rows[..., 0, :].copy()
    if running.bearing.equal_rows:
        common[..., 0] = rows[..., 0].mean(axis=-1)
    own = rows - common[..., None, :]
    return Growth(common, own[..., row, :] if own.any() else np.zeros((len(row), own.shape[-1])))


def contact_pairs(problem: Problem, basis: Basis) -> ContactPairs:
    """The contacts as a law sees them, mounted and at standstill; those of n points (n 2 Z,) one after the other."""
    inner, outer = basis.inner, basis.outer
    rings, balls, shape = problem.bearing.rings, problem.bearing.balls, (*problem.points, len(basis.row))

    def both(a: Number, b: Number) -> np.ndarray:
        halves = np.empty((*shape[:-1], 2, shape[-1]))
        for race, value in enumerate((a, b)):
            halves[..., race, :] = per_ball(value) if problem.points else value
        return halves.ravel()

    def every(value: Number) -> np.ndarray:
        return both(value, value)

    return ContactPairs(
        curvature_a=both(inner.curvatures[0], outer.curvatures[0]),
        curvature_b=both(inner.curvatures[1], outer.curvatures[1]),
        contact_modulus=every(basis.modulus),
        hertz_factor=both(inner.factor, outer.factor),
        reference_load=every(basis.ball_load),
        ring_young=every(rings.young),
        ring_poisson=every(rings.poisson),
        ball_young=every(balls.young),
        ball_poisson=every(balls.poisson),
        running_angle=every(0.0),
    )


def at_points(pairs: ContactPairs, pair: np.ndarray, area: np.ndarray) -> ContactPairs:
    """Surface points of contacts (n,) as a law sees them, with their areas (n,) [m2]."""
    return attrs.evolve(pairs.at(pair), area=area)


def linear_parts(problem: Problem, plan: ScenePlan) -> Tables:
    """Mass, damping and stiffness (5, 5) of ring, rotor and shaft, the unknowns (5,) and the constant load (5,)."""
    inertia = problem.inertia
    damping = np.diag([problem.rotor.damping] * 3 + [0.0, 0.0]) + gyroscopic(problem)
    shaft = problem.supports.tilt if isinstance(problem.supports.tilt, float) else 0.0
    return {
        "mass": np.diag([inertia.mass] * 3 + [inertia.transverse] * 2),
        "damping": damping,
        "stiffness": np.diag([0.0, 0.0, 0.0, shaft, shaft]),
        "free": np.array(plan.free, dtype=float),
        "load": np.array([problem.load.axial, *problem.load.radial, *problem.load.moment]),
    }


def excitation(problem: Problem) -> Tables:
    """The excitation's kernel and parameters."""
    if problem.excitation is None:
        from raceway.core.ring.system import no_force

        return {"force": no_force, "force_params": np.zeros(1)}
    kernel = plugin_kernel(problem.excitation, "excitation", FORCE, "FORCE")
    return {"force": kernel, "force_params": force_params(problem.excitation)}


def changing_speed(problem: Problem) -> ChangingSpeed | None:
    """What follows the speed of an excitation that changes it; None where the spin speed is steady."""
    if not problem.spin_changes:
        return None
    return ChangingSpeed(problem.excitation.phase, problem.spin_speed, problem.running.speed_growth(), gyroscopic(problem))


def gyroscopic(problem: Problem) -> np.ndarray:
    """(..., 5, 5) part of the damping that the spinning ring and rotor make [N m s/rad].

    dH/dt: +I_p W tilt_z' about y, -I_p W tilt_y' about z.
    """
    moments = np.zeros((*problem.points, 5, 5))
    moments[..., 3, 4] = problem.inertia.polar * problem.spin_speed
    moments[..., 4, 3] = -moments[..., 3, 4]
    return moments


def seat_of(problem: Problem, inner: bool) -> str | float:
    """What a ring sits on, as ``raceway.core.fem.revolution.body.Revolution`` takes it: "clamped", or a bed [N/m3]."""
    seat = problem.supports.inner_seat if inner else problem.supports.outer_seat
    return "clamped" if isinstance(seat, str) else float(seat)


def first_guess(problem: Problem, basis: Basis, shift: Number = 0.0) -> np.ndarray:
    """(..., 5) displacement to look for the equilibrium from [m, rad].

    shift : largest axial approach that the preload of a set builds in [m].  Its loaded rows approach beyond it; until the others have let
        go, at twice that approach, these help with as much stiffness.
    """
    geometry, x, axial, radial = basis.geometry, basis.axial, problem.load.axial, problem.load.radial
    rest_axial, rest_radial = geometry.rest
    touch, opposite = geometry.seat - rest_axial, -geometry.seat - rest_axial  # first touch either way
    size, guess = np.hypot(*radial), np.zeros((*problem.points, 5))
    if np.any(shift):
        guess[..., 0] = np.sign(axial) * np.where(
            x > 2.0 * shift, x - shift, x * np.sqrt(x / np.maximum(shift, 1e-30)) / 3.0
        )
        return guess
    across = (axial == 0.0) & (size > 0.0)
    guess[..., 0] = where(axial > 0.0, touch + x, where(axial < 0.0, opposite - x, where(across, -rest_axial, touch)))
    reach = geometry.centre_distance - rest_radial + 1e-3 * geometry.centre_distance
    for i, force in enumerate(radial):
        guess[..., 1 + i] = where(across, force / where(across, size, 1.0) * reach, 0.0)
    return guess
