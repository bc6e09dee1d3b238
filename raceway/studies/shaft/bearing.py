"""Response of the scene's bearing to a turning force and moment, by ``raceway.pipeline.run``, and the motion of shaft and bearing.

The bearing is stiffer or softer with its force: ``balance`` finds the fixed point at which both agree.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from math import pi
from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.errors import ConvergenceError, SceneError
from raceway.framework.registry import Registry
from raceway.pipeline.result import Result
from raceway.pipeline.run import run
from raceway.plugins.excitations import Bidirectional
from raceway.scene import tables
from raceway.scene.scene import Scene
from raceway.scene.tables import Identifying
from raceway.studies.shaft.rotor import Rotor

if TYPE_CHECKING:
    from raceway.core.jit import Kernel


@attrs.frozen(kw_only=True)
class HarmonicLoad(Bidirectional):
    """Complex amplitudes (5,) of F_x, F_y, F_z [N], M_y, M_z [N m]; the load is their real part times e^{jwt}."""

    amplitudes: tuple[complex, ...] = (0.0,) * 5

    def parameters(self) -> np.ndarray:
        return np.concatenate([[self.whirl_speed], np.array(self.amplitudes, dtype=complex).view(float)])

    def kernel(self) -> Kernel:
        from raceway.core.excitations.harmonic import harmonic_load

        return harmonic_load


def harmonic_load(speed: float, load: np.ndarray) -> HarmonicLoad:
    """The excitation of a load (5,) [N, N m] at a speed [rad/s]."""
    largest = float(np.abs(load[:3]).max())
    return HarmonicLoad(
        speed_rpm=speed * 30.0 / pi, amplitude="constant", force=largest, amplitudes=tuple(map(complex, load))
    )


def whirling_load(speed: float, force: complex, moment: complex) -> HarmonicLoad:
    """The excitation of a force F_y + j F_z [N] and a moment M_z - j M_y [N m] that turn forward, both at time zero."""
    return harmonic_load(speed, np.array([0.0, force, -1j * force, 1j * moment, moment]))


@attrs.frozen(eq=False)
class Bearing:
    """One bearing of the rig.

    Attributes
    ----------
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

    def anew(self, replayed: Iterable[list[float]] = ()) -> Bearing:
        """The same bearing without a motion to continue: its answers depend on none before.

        Parameters
        ----------
        replayed : ``answers`` of an earlier course, which the same loads get again without a run
        """
        return attrs.evolve(self, last=[], answers=[], replayed=list(replayed))

    @property
    def coupling(self) -> float:
        """Force by tilt at rest [N/rad]."""
        return float(np.linalg.inv(self.compliance)[0, 1])

    def answer(self, speed: float, force: complex, moment: complex) -> np.ndarray:
        """Deflection [m] and slope [rad] (2,) of the inner ring in forward whirl, with its inertia.

        Parameters
        ----------
        speed : [rad/s];  force, moment : of the shaft on the inner ring [N, N m]

        Raises
        ------
        ConvergenceError
            No steady motion.
        """
        if len(self.answers) < len(self.replayed):
            self.answers.append(self.replayed[len(self.answers)])
            return np.array(self.answers[-1]).view(complex)
        scene = attrs.evolve(self.scene, excitation=whirling_load(speed, force, moment))
        # Loads that are tried one after another belong to one motion of the rig.
        result = run(scene, self.registry, near=self.last[0] if self.last else None, stay=True)
        self.last[:] = [result]
        assert result.simulation is not None  # a scene with an excitation and an identifier that needs a record
        record = result.simulation.record
        q = record.displacement
        turning = np.exp(-1j * speed * record.time) / len(record.time)
        answer = np.array([turning @ (q[:, 1] + 1j * q[:, 2]), turning @ (q[:, 4] - 1j * q[:, 3])])
        self.answers.append(answer.view(float).tolist())
        return answer


def bearing(scene: Scene, axial: float, registry: Registry) -> Bearing:
    """The scene's bearing as it sits in the rig under an axial load [N].

    Raises
    ------
    SceneError
        A scene whose bearing is not the same all around.
    """
    if any(scene.load.radial) or any(scene.load.moment):
        raise SceneError.at(
            "load", None, "the rig is taken to whirl in circles: leave `load.radial` and `load.moment` at zero"
        )
    if scene.bearing.arrangement != "single":
        raise SceneError.at("bearing.arrangement", scene.bearing.arrangement, "the rig has single bearings: 'single'")
    free = attrs.evolve(
        scene,
        load=attrs.evolve(scene.load, axial=axial),
        supports=attrs.evolve(scene.supports, tilt="free"),
        rotor=tables.Rotor(damping=scene.rotor.damping),
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

    Attributes
    ----------
    speed : [rad/s];  force, moment : of the shaft on the inner ring [N, N m]
    deflection, slope : of the inner ring [m, rad];  sensor : deflection there [m]
    mass : of the inner ring [kg];  coupling : force by tilt at rest, of the bearing [N/rad]
    runs : of the bearing, that it took

    Notes
    -----
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


def balance(line: Rotor, tested: Bearing) -> State:
    """Force and moment at which the ring and the shaft in it move alike.

    Raises
    ------
    ConvergenceError
        No such force and moment found.
    """
    speed = line.speed
    gain = tested.compliance - line.ring[:, 1:]
    start = np.linalg.solve(gain, line.ring[:, 0] * line.unbalance_force)

    def apart(load: np.ndarray) -> np.ndarray:
        return tested.answer(speed, load[0], load[1]) - line.at_ring(load[0], load[1])

    size = np.abs(tested.compliance @ start)
    load, runs = find_root(apart, start.astype(complex), gain, size)
    deflection, slope = line.at_ring(*load)
    return State(speed, load[0], load[1], deflection, slope, line.at_sensor(*load), tested.mass, tested.coupling, runs)


def find_root(
    apart: Callable[[np.ndarray], np.ndarray], start: np.ndarray, slope: np.ndarray, size: np.ndarray
) -> tuple[np.ndarray, int]:
    """A complex root (n,) of a function by Broyden's method, and the number of evaluations.

    Parameters
    ----------
    slope : (n, n) first guess of the derivative;  size : (n,) of the function's values, for the tolerance

    Notes
    -----
    Real and imaginary parts are unknowns of their own: a stiffness that depends on the amplitude is not analytic.

    References
    ----------
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
                tried = value(u + step)
            except ConvergenceError:  # a load that the bearing cannot carry: nearer ones are tried
                if half == _HALVINGS:
                    raise
            else:
                if half == _HALVINGS or np.abs(tried).max() <= 2.0 * worst:
                    break
            step = 0.5 * step
        jacobian += np.outer(tried - f - jacobian @ step, step) / (step @ step)
        u, f = u + step, tried
    raise ConvergenceError(
        f"shaft and bearing find no common motion after {_MOST} tries: they differ by {np.abs(f).max():.1e}"
    )
