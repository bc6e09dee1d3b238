"""The force of a bearing with rigid rings and balls: numbers of the rings' kernels, for C, and the unit.

Numbers of geometry and balls are a + b W^2 in the speed W: centrifugal forces, gyroscopic moments, growth of the rings.  They are read from
models at two speeds; a third speed shows whether that holds.
"""

import math

import attrs
import numpy as np

from raceway import Scene, SceneError, build_model
from raceway.extend import (
    CAGE, DIMENSIONS, SCALARS, STIFFNESS, Model, System, compiled, entry_unit, renews, resolve, with_numbers,
)  # fmt: skip
from raceway_fmu.map import Interval, fit
from raceway_fmu.unit import Unit, Variable

#: What to do instead.
_MAP = "export the map instead (--kind map)"
Numbers = dict[str, np.ndarray | float]
SPIN, _RPM = "kinematics.spin_speed_rpm", np.pi / 30.0
#: Speed times pitch diameter [r/min mm] of the highest speed, where that is not set and the scene is slower: a usual limit.
_DN = 1.0e6
#: Relative deviation from a + b W^2, and from a power law, that is rounding.
_ROUNDING, _EXACT = 1e-11, 1e-12
#: Twice the exponents of power laws that have C code of their own.
_POWERS = (3, 4)
#: Of a law's table: least over largest approach, relative error, most terms;  largest approach over Hertz's at the static limit.
_SHALLOWEST, _TABLE_ERROR, _MOST_TERMS, _DEEPEST = 1e-4, 1e-9, 200, 1.5
#: Relative error from which on a table is refused.
_COARSEST = 1e-5
#: Of difference quotients of outputs by the inputs.
_STEPS = np.array([1e-9, 1e-9, 1e-9, 1e-7, 1e-7, 1e-2, 1e-5])


@attrs.frozen(eq=False)
class RigidForce:
    """The force of a bearing with rigid rings and balls, as ``packages/raceway-fmu/raceway_fmu/data/force.c`` computes it."""

    numbers: Numbers  # by their names in C: constants, arrays
    balls: int  # their count
    #: speed, highest : of the scene, and up to which the force is made for [rad/s]
    speed: float
    highest: float
    #: ball loads inside and outside up to which it is made for [N]: those of the static pressure of ISO 76
    limits: tuple[float, float]
    error: float  # of the law, relative


def rigid_force(scene: Scene, highest_rpm: float | None = None) -> RigidForce:
    """Numbers of a scene.

    highest_rpm : speed that it is made for [r/min]; None: a quarter above the scene's, or the usual limit of such bearings

    SceneError: A scene whose force is no function of displacement and speed, or not of rigid bodies.
    """
    now = float(resolve(scene).spin_speed)
    rpm = highest_rpm or max(1.25 * now / _RPM, _DN / (1e3 * scene.bearing.pitch_diameter))
    model, highest = _model(scene, rpm), rpm * _RPM
    races, ring = (model.bearing.basis.inner, model.bearing.basis.outer), _system(model)
    loads = [float(np.min((model.bearing.static_pressure / race.peak_pressure(1.0)) ** 3)) for race in races]
    depth = _DEEPEST * max(float(np.max(race.approach(load))) for race, load in zip(races, loads, strict=True))
    law, largest, error = _law(ring, depth)
    inner, outer = (min(load, largest) for load in loads)
    numbers: Numbers = {
        "BALLS": ring.ball_count,
        "MOMENTS": int(not ring.conservative),
        "CAGE_RATIO": float(model.bearing.basis.geometry.cage_speed(1.0)),
        "HIGHEST_SPEED": highest,
        "LIMIT_INNER": inner,
        "LIMIT_OUTER": outer,
        "steps": _STEPS,
    }
    # (Z, n) entries of ``table`` and ``scalars`` of each ball at rest, and what they grow by over the square of the speed.
    rings = [_system(_model(scene, rpm * math.sqrt(part))) for part in (0.25, 0.5, 1.0)]
    quarter, half, full = (np.hstack([r.table, np.broadcast_to(r.scalars, (r.ball_count, SCALARS))]) for r in rings)
    growth = (full - quarter) / 0.75
    if np.max(np.abs(full - 0.5 * growth - half)) > _ROUNDING * np.max(np.abs(full)):
        raise SceneError.at(SPIN, rpm, f"changes geometry or preload otherwise than by its square: {_MAP}")
    numbers |= {"at_rest": full - growth, "by_square": growth / (rpm * _RPM) ** 2} | law
    return RigidForce(numbers, ring.ball_count, now, highest, (inner, outer), error)


def _model(scene: Scene, rpm: float) -> Model:
    """At a speed; what its force also depends on is refused."""
    model = build_model(with_numbers(attrs.evolve(scene, excitation=None), {SPIN: rpm}))
    faults = {
        "bodies.kind": not model.traits.contacts_alone and "are not rigid, or roll on lines",
        "contact.kind": renews(scene.contact.law) and "follows the running loads",
        "contact.friction": scene.contact.friction > 0.0 and "has a memory of slips: set it to 0, or",
        "bearing.preload_kind": model.system.sliding is not None and "lets rows slide on a spring",
    }
    for key, why in faults.items():
        if why:
            raise SceneError.at(key, None, f"{why}: {_MAP}")
    return model


def _system(model: Model) -> System:
    system = compiled(model.system)
    assert system is not None, "rigid bodies have compiled forces"
    return system.without(CAGE)  # an input


def _law(system: System, depth: float) -> tuple[Numbers, float, float]:
    """From forces at approaches up to ``depth`` [m]: a power law or a table in C, its largest force [N], its relative error.

    SceneError: a law whose table has too many terms.
    """
    params, kinds = np.unique(system.law_params, axis=0, return_inverse=True)

    def forces(approach: np.ndarray) -> np.ndarray:
        n, memory, each = len(params), system.law_state.shape[1], list[np.ndarray]()
        for one in approach:
            state, out = np.zeros((n, memory)), np.zeros((3, n))
            system.law(np.full(n, -one), np.zeros(n), np.ascontiguousarray(params), state, state.copy(), 1.0, *out)
            each.append(out[0])
        return np.stack(each, axis=1)

    kinds, approach = kinds.ravel(), depth * np.geomspace(_SHALLOWEST, 1.0, 25)
    values, outer = forces(approach), slice(system.ball_count, None)
    for power in _POWERS:
        factors = values / approach ** (0.5 * power)
        if np.all(np.ptp(factors, axis=1) <= _EXACT * factors.max(axis=1)):
            factor = factors[:, -1][kinds]
            return {"LAW": power, "SEAT_POWER": 2.0 / power, "factors": factor, "seats": factor[outer]}, np.inf, 0.0

    def ratios(columns: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        approach = depth * np.exp(columns[0])
        ratio = forces(approach) / approach**1.5
        return ratio, np.abs(ratio)

    series = fit(ratios, [Interval(math.log(_SHALLOWEST), 0.0)], _TABLE_ERROR, _MOST_TERMS)
    error = float(2.0 * series.error.max())
    if not error < _COARSEST:
        raise SceneError.at("contact.kind", None, f"has a force that {_MOST_TERMS} terms give to {error:.1e} only: {_MAP}")
    terms, seats = series.terms, (values[:, -1] / depth**1.5)[kinds][outer]
    table = {"TABLE_LOW": _SHALLOWEST * depth, "TABLE_HIGH": depth, "TABLE_TERMS": terms.shape[1], "tables": terms}
    numbers = {"LAW": 0, "SEAT_POWER": 2.0 / 3.0, "seats": seats, **table, "kinds": kinds}
    return numbers, float(values[:, -1].min()), error


#: What users have to know beside.
NOTES = (
    "the force of the contacts alone: masses, loads, dampers and the shaft's stiffness are the simulator's; dashpots of [contact] are left out",
    "cage_angle 0: balls at their azimuths; its integral of cage_speed: ball passing",
)

#: Relative errors: a ball's last step is at most 1e-7 of its approach, of which forces keep the square, stiffness the first power.
_OF_FORCE, _OF_STIFFNESS = 1e-9, 1e-6

_INPUTS = (
    *(Variable(name, "m", "displacement of the inner ring", 0.0) for name in "xyz"),
    *(Variable(name, "rad", "tilt of the inner ring about y, z", 0.0) for name in ("tilt_y", "tilt_z")),
    Variable("speed", "rad/s", "of the shaft", 0.0),
    Variable("cage_angle", "rad", "by which the balls have travelled: 0, or the integral of cage_speed", 0.0),
)


def force_unit(scene: Scene, name: str, highest_rpm: float | None = None) -> Unit:
    """See ``raceway_fmu.rigid_force.rigid_force``."""
    force = rigid_force(scene, highest_rpm)
    (inner, outer), rpm = force.limits, force.highest * 30.0 / np.pi
    ranges = f"speed 0 to {rpm:g} r/min, ball loads to {inner:.4g} N inside and {outer:.4g} N outside"
    errors = {"force": max(force.error, _OF_FORCE), STIFFNESS.name: max(force.error, _OF_STIFFNESS)}
    forces = [Variable(f"force_{name}", "N", "of the bearing on the shaft") for name in "xyz"]
    moments = [Variable(f"moment_{name}", "N m", "of the bearing on the shaft") for name in "yz"]
    further = [
        Variable("largest_ball_load", "N", "of both races"),
        Variable("cage_speed", "rad/s", "of the balls round the axis"),
    ]
    loads = [
        Variable(f"ball_load_{race}[{k + 1}]", "N", f"of each ball on the {race} race")
        for race in ("inner", "outer")
        for k in range(force.balls)
    ]
    dof, words = DIMENSIONS["dof"], "tangent: what the force loses by a displacement"
    tangent = STIFFNESS.name
    entries = [Variable(f"{tangent}.{a}.{b}", entry_unit(STIFFNESS.unit, (a, b)), words) for a in dof for b in dof]
    return Unit(
        name,
        f"force of the bearing on its shaft, rigid rings and balls; {ranges}; relative error {errors['force']:.1e}.",
        "force.c",
        force.numbers,
        f"beyond what the model is made for ({ranges}): computed all the same",
        (*_INPUTS[:5], attrs.evolve(_INPUTS[5], start=force.speed, low=0.0, high=force.highest), _INPUTS[6]),
        (*forces, *moments, *further, *loads, *entries),
        tuple(
            Variable(f"relative_error.{kind}", "1", "of the largest, against Raceway's kernels", e)
            for kind, e in errors.items()
        ),
    )
