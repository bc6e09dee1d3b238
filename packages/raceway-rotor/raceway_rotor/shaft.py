"""A shaft with a disc on two bearings, whirling with its unbalance: Timoshenko elements, the response of the scene's bearing by a run
of its own, and the motion that both have in common.

The bearing is stiffer or softer with its force: ``balance`` finds the fixed point at which shaft and bearing agree.

Deflection w = y + j z and slope s = y' + j z' of a shaft that whirls with e^{j lambda t} while it spins with Omega:

    (K - lambda^2 (M_t + M_r) + lambda Omega G) q = f,    q = (w_0, s_0, w_1, s_1, ...)

G = 2 M_r for a round section (I_p = 2 I_t).  Force and moment are conjugate to w and s; a moment is M_z - j M_y, the slope
theta_z - j theta_y.  The shape functions are those of the exact static solution, so that a beam loaded at its nodes is exact.

Przemieniecki, Theory of Matrix Structural Analysis (1968), sections 5.6 and 11.3; Friswell, Penny, Garvey, Lees, Dynamics of
Rotating Machines (2010), sections 5.4.3 to 5.4.6.
"""

from collections.abc import Callable, Iterable
from functools import lru_cache
from math import ceil, pi

import attrs
import numpy as np

from raceway import ConvergenceError, Result, Scene, SceneError
from raceway.extend import HarmonicLoad, Identifying, Registry, SteadyLines, harmonic_load, run
from raceway.extend import Rotor as RotorTable
from raceway_rotor.rig_table import Rig

#: Two points a node less would still integrate the stiffness exactly; mass needs degree 6.
_POINTS, _WEIGHTS = (
    0.5 * (values + shift) for values, shift in zip(np.polynomial.legendre.leggauss(4), (1.0, 0.0), strict=True)
)


@attrs.frozen(eq=False)
class Beam:
    """Nodes (n,) [m] of a round shaft and its matrices (2 n, 2 n)."""

    nodes: np.ndarray
    #: stiffness, mass, rotary : K, M_t, M_r; a disc's are added to the last two
    stiffness: np.ndarray
    mass: np.ndarray
    rotary: np.ndarray
    polar: np.ndarray  # G / 1, the gyroscopic matrix over lambda Omega

    def node(self, position: float) -> int:
        """The node at a position [m]."""
        return int(np.argmin(np.abs(self.nodes - position)))

    def dynamic(self, whirl: float, spin: float) -> np.ndarray:
        """K - lambda^2 (M_t + M_r) + lambda Omega G for speeds [rad/s]."""
        return self.stiffness - whirl**2 * (self.mass + self.rotary) + whirl * spin * self.polar

    def with_disc(self, position: float, mass: float, transverse: float, polar: float) -> "Beam":
        """A copy with a rigid disc at a node: mass [kg], inertias [kg m2]."""
        k = 2 * self.node(position)
        m, r, p = self.mass.copy(), self.rotary.copy(), self.polar.copy()
        m[k, k] += mass
        r[k + 1, k + 1] += transverse
        p[k + 1, k + 1] += polar
        return attrs.evolve(self, mass=m, rotary=r, polar=p)

    def with_spring(self, position: float, stiffness: float, tilt: float = 0.0) -> "Beam":
        """A copy with a spring against the ground at a node [N/m, N m/rad]."""
        k = 2 * self.node(position)
        s = self.stiffness.copy()
        s[k, k] += stiffness
        s[k + 1, k + 1] += tilt
        return attrs.evolve(self, stiffness=s)

    def critical_speeds(self) -> np.ndarray:
        """Speeds [rad/s], ascending, at which forward whirl with the spin is a free motion."""
        inertia = self.mass + self.rotary - self.polar  # indefinite: a disc's polar inertia exceeds its transverse one
        values = np.linalg.eigvals(np.linalg.solve(self.stiffness, inertia))
        real = values.real[(np.abs(values.imag) < 1e-9 * np.abs(values).max()) & (values.real > 0.0)]
        return np.sort(1.0 / np.sqrt(real))


def make_beam(
    nodes: np.ndarray, diameter: float, young: float, poisson: float, density: float, shear: bool = True,
    stiff: np.ndarray | None = None,
) -> Beam:  # fmt: skip
    """A round shaft of one diameter.

    nodes : (n,) ascending [m];  shear : False gives an Euler-Bernoulli beam
    stiff : (n - 1,) diameters that bend, where something stiffens the shaft [m]; its mass is not added

    Shear coefficient of a solid round section: 6 (1 + nu) / (7 + 6 nu) (Cowper 1966).
    """
    area, inertia = pi / 4.0 * diameter**2, pi / 64.0 * diameter**4
    bending = np.full(len(nodes) - 1, diameter) if stiff is None else stiff
    modulus = 6.0 * (1.0 + poisson) / (7.0 + 6.0 * poisson) * young / (2.0 * (1.0 + poisson))
    size = 2 * len(nodes)
    k, m, r = (np.zeros((size, size)) for _ in range(3))
    for i, length in enumerate(np.diff(nodes)):
        part = slice(2 * i, 2 * i + 4)
        bend_stiffness, shear_stiffness = young * pi / 64.0 * bending[i] ** 4, modulus * pi / 4.0 * bending[i] ** 2
        phi = 12.0 * bend_stiffness / (shear_stiffness * length**2) if shear else 0.0
        for x, weight in zip(_POINTS, _WEIGHTS * length, strict=True):
            w, slope, turn, bend = _shapes(x, length, phi)
            k[part, part] += weight * bend_stiffness * np.outer(bend, bend)
            if shear:
                k[part, part] += weight * shear_stiffness * np.outer(slope - turn, slope - turn)
            m[part, part] += weight * density * area * np.outer(w, w)
            r[part, part] += weight * density * inertia * np.outer(turn, turn)
    return Beam(np.asarray(nodes), k, m, r, 2.0 * r)


def _shapes(x: float, length: float, phi: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Deflection, its derivative, section's rotation and its derivative (4,) at x in 0..1 for w_0, s_0, w_1, s_1."""
    share = 1.0 / (1.0 + phi)
    half = 0.5 * phi * length
    w = [
        1.0 - 3.0 * x**2 + 2.0 * x**3 + phi * (1.0 - x),
        length * (x - 2.0 * x**2 + x**3) + half * (x - x**2),
        3.0 * x**2 - 2.0 * x**3 + phi * x,
        length * (x**3 - x**2) - half * (x - x**2),
    ]
    slope = [
        -6.0 * x + 6.0 * x**2 - phi,
        length * (1.0 - 4.0 * x + 3.0 * x**2) + half * (1.0 - 2.0 * x),
        6.0 * x - 6.0 * x**2 + phi,
        length * (3.0 * x**2 - 2.0 * x) - half * (1.0 - 2.0 * x),
    ]
    turn = [
        6.0 * (x**2 - x) / length,
        1.0 - 4.0 * x + 3.0 * x**2 + phi * (1.0 - x),
        6.0 * (x - x**2) / length,
        3.0 * x**2 - 2.0 * x + phi * x,
    ]
    bend = [6.0 * (2.0 * x - 1.0) / length, 6.0 * x - 4.0 - phi, 6.0 * (1.0 - 2.0 * x) / length, 6.0 * x - 2.0 + phi]
    return share * np.array(w), share * np.array(slope) / length, share * np.array(turn), share * np.array(bend) / length


#: Longest element over the shaft's diameter: halving it moves no answer of the rig by 1e-6.
_ELEMENT = 0.25


@attrs.frozen(eq=False)
class Rotor:
    """Answers of the free shaft at one speed, linear in unbalance force, bearing force and bearing moment.

    speed : W [rad/s]
    ring, sensor : answers (w, s) of the shaft in the bearing and (w) at the sensor: rows of (.., 3) for
        a unit of unbalance force [N] at the disc, force [N] and moment [N m] of the shaft on each bearing

    Both bearings carry the same, as mirror images.  Slope and moment are those of the bearing's own frame, whose axis points
    to where its load seats it.
    """

    speed: float
    ring: np.ndarray
    sensor: np.ndarray
    unbalance_force: float

    def at_ring(self, force: complex, moment: complex) -> np.ndarray:
        """Deflection [m] and slope [rad] of the shaft in the bearing (2,)."""
        return self.ring @ np.array([self.unbalance_force, force, moment])

    def at_sensor(self, force: complex, moment: complex) -> complex:
        """Deflection at the sensor [m]."""
        return complex(self.sensor @ np.array([self.unbalance_force, force, moment]))


@lru_cache(maxsize=32)  # one rig is asked for at many speeds, changed rigs again for each record
def shaft(rig: Rig, shear: bool = True, finer: int = 1) -> Beam:
    """The rig's shaft with its disc.

    shear : False leaves shear and rotary inertia out of the shaft;  finer : divides the length of the elements
    """
    middle, half = 0.5 * rig.shaft_length, 0.5 * rig.disc_thickness
    places = sorted({0.0, *rig.bearings, rig.sensor, middle - half, middle, middle + half, rig.shaft_length})
    nodes = [places[0]]
    for before, after in zip(places, places[1:], strict=False):
        if after - before > 1e-6:  # nearer ones share a node
            parts = finer * ceil((after - before) / (_ELEMENT * rig.shaft_diameter))
            nodes += np.linspace(before, after, parts + 1)[1:].tolist()
    centres = 0.5 * (np.array(nodes[1:]) + np.array(nodes[:-1]))
    stiff = np.where(np.abs(centres - middle) < half, rig.hub_diameter or rig.shaft_diameter, rig.shaft_diameter)
    bare = make_beam(np.array(nodes), rig.shaft_diameter, rig.young, rig.poisson, rig.density, shear, stiff)
    if not shear:
        bare = attrs.evolve(bare, rotary=0.0 * bare.rotary, polar=0.0 * bare.polar)
    inner, outer, width = 0.5 * rig.shaft_diameter, rig.disc_radius, rig.disc_thickness
    mass = rig.density * pi * (outer**2 - inner**2) * width
    polar = 0.5 * mass * (outer**2 + inner**2)
    return bare.with_disc(middle, mass, 0.5 * polar + mass * width**2 / 12.0, polar)


@lru_cache(maxsize=32)  # a fit asks for one at all its numbers
def rotor(rig: Rig, speed: float, model: Beam | None = None) -> Rotor:
    """The rotor at a speed [rad/s], or another model of its shaft."""
    model = model or shaft(rig)
    near, far = (2 * model.node(position) for position in rig.bearings)
    disc, sensor = 2 * model.node(0.5 * rig.shaft_length), 2 * model.node(rig.sensor)
    sign = 1.0 if rig.arrangement == "DB" else -1.0
    loads = np.zeros((len(model.stiffness), 3))
    loads[disc, 0] = 1.0
    loads[[near, far], 1] = -1.0
    loads[near + 1, 2], loads[far + 1, 2] = -sign, sign
    answer = np.linalg.solve(model.dynamic(speed, speed), loads)
    ring = np.array([answer[near], sign * answer[near + 1]])
    return Rotor(speed, ring, answer[sensor], unbalance_force=rig.unbalance * speed**2)


def whirling_load(speed: float, force: complex, moment: complex) -> HarmonicLoad:
    """The excitation of a force F_y + j F_z [N] and a moment M_z - j M_y [N m] that turn forward, both at time zero."""
    return harmonic_load(speed, np.array([0.0, force, -1j * force, 1j * moment, moment]))


@attrs.frozen(eq=False)
class Bearing:
    """One bearing of the rig.

    scene : with the axial load; free to tilt and without a rotor's mass, which are the shaft's
    compliance : (2, 2) of deflection and slope by force and moment, tangent at rest [m/N, 1/N; 1/N, rad/(N m)]
    mass : of the inner ring [kg]; 0 with an integrator that knows no inertia
    last : the last result, if there is one, whose motion the next one continues; see ``anew``
    answers : since ``anew``, four numbers each;  replayed : answers that the same loads in the same order gave before
    """

    scene: Scene
    registry: Registry
    compliance: np.ndarray
    mass: float
    last: list[Result] = attrs.field(factory=list, repr=False)
    answers: list[list[float]] = attrs.field(factory=list, repr=False)
    replayed: list[list[float]] = attrs.field(factory=list, repr=False)
    _lines: SteadyLines = attrs.field(factory=SteadyLines, init=False, repr=False)

    def anew(self, replayed: Iterable[list[float]] = ()) -> "Bearing":
        """The same bearing without a motion to continue: its answers depend on none before.

        replayed : ``answers`` of an earlier course, which the same loads get again without a run
        """
        return attrs.evolve(self, last=[], answers=[], replayed=list(replayed))

    @property
    def coupling(self) -> float:
        """Force by tilt at rest [N/rad]."""
        return float(np.linalg.inv(self.compliance)[0, 1])

    def answer(self, speed: float, force: complex, moment: complex) -> np.ndarray:
        """Deflection [m] and slope [rad] (2,) of the inner ring in forward whirl, with its inertia.

        speed : [rad/s];  force, moment : of the shaft on the inner ring [N, N m]

        ConvergenceError: No steady motion.
        """
        if len(self.answers) < len(self.replayed):
            self.answers.append(self.replayed[len(self.answers)])
            return np.array(self.answers[-1]).view(complex)
        scene = attrs.evolve(self.scene, excitation=whirling_load(speed, force, moment))
        line = self._lines.line(scene, speed)
        if line is None:
            # Loads that are tried one after another belong to one motion of the rig.
            result = run(scene, self.registry, near=self.last[0] if self.last else None, stay=True)
            self.last[:] = [result]
            assert result.simulation is not None  # a scene with an excitation and an identifier that needs a record
            record = result.simulation.record
            line = 2.0 * np.exp(-1j * speed * record.time) @ record.displacement / len(record.time)
        answer = 0.5 * np.array([line[1] + 1j * line[2], line[4] - 1j * line[3]])
        self.answers.append(answer.view(float).tolist())
        return answer


def bearing(scene: Scene, axial: float, registry: Registry) -> Bearing:
    """The scene's bearing in the rig under an axial load [N]; SceneError where it is not the same all around."""
    if any(scene.load.radial) or any(scene.load.moment):
        raise SceneError.at("load", None, "the rig whirls in circles: leave `load.radial` and `load.moment` at zero")
    if scene.bearing.arrangement != "single":
        raise SceneError.at("bearing.arrangement", scene.bearing.arrangement, "the rig has single bearings: 'single'")
    free = attrs.evolve(
        scene,
        load=attrs.evolve(scene.load, axial=axial),
        supports=attrs.evolve(scene.supports, tilt="free"),
        rotor=RotorTable(damping=scene.rotor.damping),
        excitation=None,
        identifier=Identifying(method=registry.find("identifier", "fft_1x").plugin()),  # the motion is read here, not there
    )
    static = run(free, registry)
    plane = np.ix_([1, 4], [1, 4])  # y and theta_z; by symmetry the same for z and -theta_y
    return Bearing(free, registry, np.linalg.inv(static.equilibrium.stiffness[plane]), static.model.mass_used)


#: Agreement of shaft and bearing, over the bearing's motion: a hundredth of what is asked of the identification, squared.
TOLERANCE = 1e-7
_MOST, _HALVINGS = 40, 4


@attrs.frozen
class State:
    """State of the tested bearing in the rig.

    speed : [rad/s];  force, moment : of the shaft on the inner ring [N, N m]
    deflection, slope : of the inner ring [m, rad];  sensor : deflection there [m]
    mass : of the inner ring [kg];  coupling : force by tilt at rest, of the bearing [N/rad]
    runs : of the bearing, that it took

    Complex amplitudes in forward whirl; the unbalance force is real.  The shaft bends the bearing, too: what it carries for
    its tilt, ``coupling`` times the slope, taken off the force leaves the stiffness against deflection alone.
    """

    speed: float
    force: complex
    moment: complex
    deflection: complex
    slope: complex
    sensor: complex
    mass: float
    coupling: float
    runs: int

    @property
    def dynamic_stiffness(self) -> complex:
        """Z = F / x [N/m]: the shaft's force on the inner ring over its deflection."""
        return self.force / self.deflection

    @property
    def stiffness(self) -> float:
        """K = Re Z + m w^2 [N/m]."""
        return self.dynamic_stiffness.real + self.mass * self.speed**2

    @property
    def damping(self) -> float:
        """C = Im Z / w [N s/m]."""
        return self.dynamic_stiffness.imag / self.speed

    @property
    def locked(self) -> tuple[float, float]:
        """K [N/m] and C [N s/m] without the part that the slope brings: as with the tilt locked."""
        z = (self.force - self.coupling * self.slope) / self.deflection
        return z.real + self.mass * self.speed**2, z.imag / self.speed


def balance(free: Rotor, bearing: Bearing) -> State:
    """Force and moment at which the ring and the shaft in it move alike; ConvergenceError where none are found."""
    speed = free.speed
    gain = bearing.compliance - free.ring[:, 1:]
    start = np.linalg.solve(gain, free.ring[:, 0] * free.unbalance_force)

    def apart(load: np.ndarray) -> np.ndarray:
        return bearing.answer(speed, load[0], load[1]) - free.at_ring(load[0], load[1])

    load, runs = find_root(apart, start.astype(complex), gain, np.abs(bearing.compliance @ start))
    deflection, slope = free.at_ring(*load)
    return State(speed, load[0], load[1], deflection, slope, free.at_sensor(*load), bearing.mass, bearing.coupling, runs)


def find_root(
    apart: Callable[[np.ndarray], np.ndarray], start: np.ndarray, slope: np.ndarray, size: np.ndarray
) -> tuple[np.ndarray, int]:
    """A complex root (n,) of a function by Broyden's method, and the number of evaluations.

    slope : (n, n) first guess of the derivative;  size : (n,) of the function's values, for the tolerance

    Real and imaginary parts are unknowns of their own: a stiffness that depends on the amplitude is not analytic.

    Broyden, Math. Comp. 19 (1965) 577.
    """
    n = len(start)
    jacobian = np.block([[slope.real, -slope.imag], [slope.imag, slope.real]])
    scale = np.concatenate([size, size])

    def value(u: np.ndarray) -> np.ndarray:
        apart_by = apart(u[:n] + 1j * u[n:])
        return np.concatenate([apart_by.real, apart_by.imag]) / scale

    jacobian = jacobian / scale[:, None]
    u = np.concatenate([start.real, start.imag])
    f = value(u)
    for count in range(1, _MOST):
        worst = float(np.abs(f).max())
        if worst < TOLERANCE:
            return u[:n] + 1j * u[n:], count
        try:
            step = -np.linalg.solve(jacobian, f)
        except np.linalg.LinAlgError:
            raise ConvergenceError(f"shaft and bearing find no common motion: they differ by {worst:.1e}") from None
        for half in range(_HALVINGS + 1):
            try:
                trial = value(u + step)
            except ConvergenceError:  # a load that the bearing cannot carry: nearer ones are tried
                if half == _HALVINGS:
                    raise
            else:
                if half == _HALVINGS or np.abs(trial).max() <= 2.0 * worst:
                    break
            step = 0.5 * step
        jacobian += np.outer(trial - f - jacobian @ step, step) / (step @ step)
        u, f = u + step, trial
    raise ConvergenceError(f"shaft and bearing find no common motion in {_MOST} tries: they differ by {np.abs(f).max():.1e}")
