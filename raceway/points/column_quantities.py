"""Quantities of many operating points, from what the compiled loops leave; each for itself, so that only what is asked for costs."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from typing import TypeAlias

import attrs
import numpy as np

from raceway.answers.quantities import AMPLITUDE, KNOWN, OF_ORBITS, Z_IMAG, Z_REAL, C, K, Quantity, plugin_quantities
from raceway.bodies.columns import Builder, ColumnBearing, solved_columns
from raceway.core.periodic.floquet import NEUTRAL
from raceway.core.periodic.orbits import Orbits
from raceway.core.ring.ring import COORDINATES
from raceway.core.signals import impedance
from raceway.core.signatures import States
from raceway.framework.contracts import SolvedPoints
from raceway.framework.duties import fitting_quantities, quantities_at, turn_samples
from raceway.framework.loading.registry import Registry, default_registry
from raceway.pipeline.plausible import column_bounds
from raceway.pipeline.result import Result
from raceway.planning.columns import why_not
from raceway.planning.plan import make_plan
from raceway.planning.resolve import resolve
from raceway.scene.scene import Scene

#: Largest change of the stiffness along an orbit, over its mean, up to which the loop's answer is taken: beyond, several motions may
#: exist, which a run looks for.
_MILD = 0.5
_MULTIPLIER, _CHANGE = OF_ORBITS
#: Relative tolerance of the orbit of one scene.
_TOLERANCE = 1e-10
#: Labels of the dimensions of arrays.
DIMENSIONS = {"dof": list(COORDINATES), "dof2": list(COORDINATES), "race": ["inner", "outer"]}


@attrs.frozen(eq=False, slots=False)
class Computed:
    """Equilibria, and orbits where a motion is asked for, of n points."""

    bearing: ColumnBearing
    states: States
    orbits: Orbits | None

    @classmethod
    def of(cls, bearing: ColumnBearing, moving: bool, tolerance: float, outputs: Iterable[str]) -> "Computed":
        """Solve for what the outputs need."""
        states = bearing.equilibria("damping" in outputs)
        if not moving:
            return cls(bearing, states, None)
        example, of_plugins = bearing.plan.problem, plugin_quantities(default_registry())
        plugins = {of_plugins[name][0] for name in outputs if name in of_plugins}
        samples = [turn_samples(getattr(example.quantities, name), example) for name in plugins]
        times = math.lcm(*(count for count in samples if count)) if any(samples) else 0
        with_disturbances, asked = _MULTIPLIER in outputs, times if times or not EXTREMES.isdisjoint(outputs) else None
        motion = bearing.orbits(states, tolerance, disturbed=with_disturbances, times=asked)
        if asked is None and bearing.impossible(motion.peak).any():
            motion = bearing.orbits(states, tolerance, disturbed=with_disturbances, times=0)
        return cls(bearing, states, motion)

    @property
    def speed(self) -> np.ndarray:
        """(n,) of the excitation [rad/s]."""
        return self.bearing.force[1]

    @cached_property
    def fine(self) -> np.ndarray:
        """(n,) whether the loop's answer is that of a run."""
        fine = (self.states.status == 0) & ~self.bearing.impossible(self.states.force)
        if self.orbits is not None:
            fine &= (self.orbits.status == 0) & (self.orbits.change < _MILD) & ~self.bearing.impossible(self.orbits.peak)
        return np.asarray(fine)

    @cached_property
    def peak(self) -> np.ndarray:
        """(n, 2, Z) largest contact forces."""
        return _races(self.states.force if self.orbits is None else self.orbits.peak)

    @cached_property
    def points(self) -> SolvedPoints:
        """As plug-ins of quantities see them."""

        def turn(count: int) -> np.ndarray:
            force = self.motion.turn
            return force[:, :: force.shape[1] // count].reshape(len(force), count, 2, -1)

        return solved_columns(self.bearing, self.states, None if self.orbits is None else turn)

    @np.errstate(all="ignore")
    def of_plugin(self, plugin: str, name: str) -> np.ndarray:
        """(n, ...) numbers of a plug-in of quantities, which computes all of its own at once."""
        quantities = getattr(self.bearing.problem.quantities, plugin)
        return self.points.once(f"numbers of {plugin}", lambda: quantities_at(quantities, self.points))[name]

    @cached_property
    def pressure(self) -> np.ndarray:
        """(n, 2, Z) peak pressures under these."""
        return _races(self.bearing.pressures(self.peak.reshape(len(self.peak), -1)))

    @property
    def largest_multiplier(self) -> np.ndarray:
        """(n,) growth of the most persistent disturbance in a turn, see ``raceway.core.periodic.floquet``."""
        over, steady = np.full(len(self.speed), np.nan), self.motion.status == 0
        multipliers = np.abs(np.linalg.eigvals(self.motion.transfer[steady])).max(axis=1, initial=0.0)
        over[steady] = multipliers ** (2.0 * np.pi / self.motion.span[steady])
        return over

    @cached_property
    def line(self) -> np.ndarray:
        """(n, 5) synchronous (1x) component of the displacement."""
        return self._complex("line")

    @cached_property
    def force(self) -> np.ndarray:
        """(n, 5) synchronous (1x) component of the force."""
        return self._complex("force")

    @property
    def motion(self) -> Orbits:
        """The orbits of a motion that was asked for."""
        assert self.orbits is not None, "quantities of a motion make one be asked for"
        return self.orbits

    def _complex(self, name: str) -> np.ndarray:
        parts = getattr(self.motion, name)
        return np.asarray(parts[:, :5] + 1j * parts[:, 5:])

    @cached_property
    def impedance(self) -> np.ndarray:
        """(n,) Z = (F^H F) / (F^H x), see ``raceway.core.signals``."""
        return impedance(self.force[:, :3], self.line[:, :3])

    @cached_property
    def mass(self) -> np.ndarray:
        """(n,) of K = Re Z + m w^2."""
        return np.broadcast_to(self.bearing.problem.inertia.mass, len(self.states.status)).astype(float)

    @cached_property
    def parts(self) -> tuple[np.ndarray, np.ndarray]:
        """(n,) forward and backward amplitude of the 1x orbit [m]."""
        y, z = self.line[:, 1], self.line[:, 2]
        return 0.5 * np.abs(y + 1j * z), 0.5 * np.abs(y - 1j * z)


def lasting(multiplier: float) -> bool:
    """Whether an orbit with this largest Floquet multiplier is not unstable."""
    return multiplier <= 1.0 + NEUTRAL


def _tilts_follow(c: Computed) -> np.ndarray:
    K, shaft = c.states.stiffness, c.bearing.points.shaft
    a, b, e, d = K[:, 3, 3] + shaft, K[:, 3, 4], K[:, 4, 3], K[:, 4, 4] + shaft
    det = a * d - b * e
    with np.errstate(divide="ignore", invalid="ignore"):
        first = (d * K[:, 3, 1] - b * K[:, 4, 1]) / det
        second = (a * K[:, 4, 1] - e * K[:, 3, 1]) / det
    follows = K[:, 1, 1] - K[:, 1, 3] * first - K[:, 1, 4] * second
    return np.where(det != 0.0, follows, K[:, 1, 1])


def _races(values: np.ndarray) -> np.ndarray:
    """(n, 2, Z) of (n, 2 Z)."""
    return values.reshape(len(values), 2, -1)


_STATIC: dict[str, Callable[[Computed], np.ndarray]] = {
    "displacement": lambda c: c.states.q,
    "stiffness": lambda c: c.states.stiffness,
    "damping": lambda c: c.states.damping,
    "x": lambda c: c.states.q[:, 0],
    "kxx": lambda c: c.states.stiffness[:, 0, 0],
    "kyy": lambda c: c.states.stiffness[:, 1, 1],
    "kyy_tilts_follow": _tilts_follow,
    "largest_ball_load": lambda c: c.states.force.max(axis=1),
    "ball_load": lambda c: _races(c.states.force),
    "error_model_bound": lambda c: column_bounds(c.bearing.plan.problem, c.bearing, c.states.force),
    "contact_angle": lambda c: _races(np.degrees(np.concatenate(c.bearing.contact_angles(c.states), axis=1))),
}
#: Of the motion where there is one, else of the equilibrium.
_EXTREMES: dict[str, Callable[[Computed], np.ndarray]] = {
    "axial_displacement": lambda c: (c.states.q if c.orbits is None else c.orbits.mean)[:, 0],
    "peak_ball_load": lambda c: c.peak.max(axis=(1, 2)),
    "peak_ball_load_inner": lambda c: c.peak[:, 0].max(axis=1),
    "peak_ball_load_outer": lambda c: c.peak[:, 1].max(axis=1),
    "min_ball_load": lambda c: _races(c.states.force if c.orbits is None else c.orbits.least)[:, 0].min(axis=1),
    "p0": lambda c: c.pressure.max(axis=(1, 2)),
    "p0_inner": lambda c: c.pressure[:, 0].max(axis=1),
    "p0_outer": lambda c: c.pressure[:, 1].max(axis=1),
}
_MOVING: dict[str, Callable[[Computed], np.ndarray]] = {
    _MULTIPLIER: lambda c: c.largest_multiplier,
    K.name: lambda c: c.impedance.real + c.mass * c.speed**2,
    C.name: lambda c: c.impedance.imag / c.speed,
    Z_REAL.name: lambda c: c.impedance.real,
    Z_IMAG.name: lambda c: c.impedance.imag,
    "dynamic_stiffness": lambda c: np.abs(c.impedance),
    "phase_lag": lambda c: np.degrees(np.angle(c.impedance)),
    "force_amplitude": lambda c: np.linalg.svd(np.stack([c.force[:, :3].real, c.force[:, :3].imag], 1), compute_uv=False)[
        :, 0
    ],
    "mass": lambda c: c.mass,
    "speed_rpm": lambda c: c.speed * 30.0 / np.pi,
    "frequency": lambda c: c.speed / (2.0 * np.pi),
    "forward_amplitude": lambda c: c.parts[0],
    "backward_amplitude": lambda c: c.parts[1],
    **dict.fromkeys(("orbit_major", AMPLITUDE.name), lambda c: c.parts[0] + c.parts[1]),
    "orbit_minor": lambda c: np.abs(c.parts[0] - c.parts[1]),
    _CHANGE: lambda c: c.motion.change,
    "residual": lambda c: c.motion.residual,
    **dict.fromkeys(("error_total", "error_time_step"), lambda c: c.motion.error),
    # A turn of the steady motion, and its exact Fourier line.
    **dict.fromkeys(("error_transient", "error_identification"), lambda c: np.zeros(len(c.speed))),
}
#: Quantities of a motion; of the motion where there is one; and all that a function has beside those of plug-ins.
MOVING, EXTREMES = frozenset(_MOVING), frozenset(_EXTREMES)
QUANTITIES = _STATIC | _EXTREMES | _MOVING


def stated_columns(scene: Scene, registry: Registry) -> dict[str, Quantity]:
    """Quantities of plug-ins with one number a point which a scene has, by their names."""
    fitting = {plugin.name for plugin in fitting_quantities(resolve(scene))}
    numbers = plugin_quantities(registry)
    return {name: quantity for name, (plugin, quantity) in numbers.items() if plugin in fitting and not quantity.dims}


@attrs.frozen(eq=False)
class SteadyLines:
    """Synchronous (1x) components of the steady orbits of one bearing under one load after another."""

    _bearings: dict[float, ColumnBearing] = attrs.field(factory=dict, init=False)

    def line(self, scene: Scene, speed: float) -> np.ndarray | None:
        """(5,) complex line by the compiled loop, at the speed [rad/s] of the excitation; None where a run has to find it."""
        if scene.heat is not None or why_not(resolve(scene), True):
            return None
        if speed not in self._bearings:
            self._bearings[speed] = Builder(make_plan(scene)).at({"load.axial": np.array([scene.load.axial])})
        bearing = self._bearings[speed]
        problem = attrs.evolve(bearing.problem, excitation=scene.excitation)
        numbers = Computed.of(attrs.evolve(bearing, problem=problem), True, _TOLERANCE, ())
        return numbers.line[0] if numbers.fine[0] else None


def of_result(name: str, result: Result) -> np.ndarray | float | None:
    """One of them of a run."""
    if name == _CHANGE:
        return None
    if name == "ball_load":
        return result.equilibrium.contact_force.reshape(2, -1)
    if name == "largest_ball_load":
        return result.equilibrium.contact_force.max()
    if name == _MULTIPLIER:
        floquet = result.stability["floquet"]
        return None if floquet is None else floquet["largest"]
    if name == "contact_angle":
        return np.degrees([result.equilibrium.angle_inner, result.equilibrium.angle_outer])
    return result.quantities.get(name) if name not in KNOWN else KNOWN[name].of(result)


#: Values by the names of outputs.
Columns: TypeAlias = dict[str, np.ndarray]

#: Relative step of differences, of fourth order.
_STEP = 1e-3

#: Weights of values at shifts by so many steps: their sum over the step is the derivative.
_CENTRAL = {-2: 1.0 / 12.0, -1: -8.0 / 12.0, 1: 8.0 / 12.0, 2: -1.0 / 12.0}

_FORWARD = {0: -25.0 / 12.0, 1: 4.0, 2: -3.0, 3: 4.0 / 3.0, 4: -0.25}

_BACKWARD = {-shift: -weight for shift, weight in _FORWARD.items()}

#: What numbers that are 0 are taken for in such a step, by their units; 1 otherwise.
_LEAST = {"m": 1e-6}


def jacobian(
    columns: Callable[[Columns], Columns],
    allowed: Callable[[str, float], bool],
    inputs: Columns,
    units: Mapping[str, str],
    outputs: Sequence[str],
) -> dict[str, Columns]:
    """Derivatives (n, ...) of each output by each input that has a unit: ``jacobian(...)[output][input]``.

    columns : computes outputs from columns of all inputs;  allowed : whether a key's rule admits a number
    inputs : (n,) each, by their keys;  units : of those by which is derived
    """
    stencils, steps = {}, {}
    for key, unit in units.items():
        least, finite = _LEAST.get(unit, 1.0), np.isfinite(inputs[key])
        # What is no number has no derivative, and no say in the steps of the others.
        value = np.where(finite, inputs[key], inputs[key][finite][0] if finite.any() else least)
        size = np.abs(value)
        steps[key] = _STEP * np.where(size > 0.0, size, size.max() or least)
        low, high = (
            allowed(key, float(end)) for end in ((value - 2.0 * steps[key]).min(), (value + 2.0 * steps[key]).max())
        )
        stencils[key] = _FORWARD if not low else _CENTRAL if high else _BACKWARD
    # All inputs at all shifts of one key after another.
    moves = [(path, shift * steps[path]) for path, stencil in stencils.items() for shift in stencil]
    neighbours = {
        key: np.concatenate([value + move * (path == key) for path, move in moves]) for key, value in inputs.items()
    }
    answer, out = columns(neighbours), dict[str, Columns]()
    for name in outputs:
        parts, first = answer[name].reshape((-1, len(size), *answer[name].shape[1:])), 0
        out[name] = {}
        for key, stencil in stencils.items():
            slope = np.tensordot(list(stencil.values()), parts[first : first + len(stencil)], axes=1)
            out[name][key] = (slope.T / steps[key]).T
            first += len(stencil)
    return out
