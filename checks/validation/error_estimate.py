"""The error that a result states against its true error, over 30 varied scenes, hard ones among them.

The true value is Z of the steady orbit by Fourier collocation with 257 times a turn (its change from 129 is stated where it
matters): no time integration, no transient.  Scenes whose question is not the steady orbit (orbiting balls, friction, fits
over several speeds), or where collocation finds none, are held against the same run with finer steps.
"""

from typing import Any

import attrs
import numpy as np

from checks.validation.scenes import rotating
from raceway import scene_from_dict
from raceway.extend import steady_orbit, stiffness
from raceway.testing import model_of, run, solve_equilibrium

#: An estimate is right within this factor, or when it and the error are below this size.  The factor is less than the 4 by which
#: twice as many steps change an error of second order: nobody who chooses steps by the estimate is a halving off.
FACTOR, SMALL = 3.0, 1e-6
_FINE_STEPS = 2880


@attrs.frozen
class Case:
    """A scene; ``finer`` names what the reference run changes, where the steady orbit is not the question."""

    name: str
    tables: dict[str, Any]
    finer: dict[str, Any] | None = None


def case(
    name: str, axial: float = 1000.0, tilt: Any = "locked", rpm: float = 12000.0, kind: str = "bidirectional",
    finer: dict[str, Any] | None = None, integrator: dict[str, Any] | None = None, **tables: Any,
) -> Case:  # fmt: skip
    """The article's bearing with its rotating force, changed."""
    found = rotating(axial, tilt, rpm, True, "newmark")
    found["excitation"]["kind"] = kind
    found["integrator"] = {**found["integrator"], **(integrator or {})}
    for table, values in tables.items():
        found[table] = {**found.get(table, {}), **values}
    return Case(name, found, finer)


def steps(count: int, **more: Any) -> dict[str, Any]:
    return {"steps_per_turn": count, **more}


_ALPHA = {"kind": "generalized_alpha", "rho_infinity": 0.5}
_EXPLICIT = {"kind": "central_difference"}
_FINE = {"steps_per_turn": _FINE_STEPS}

CASES = (
    case("newmark"),
    case("newmark, tilt free", tilt="free"),
    case("generalized alpha, dissipative, tilt free", tilt="free", integrator=_ALPHA),
    case("central differences", integrator=_EXPLICIT),
    case("central differences, tilt free", tilt="free", integrator=_EXPLICIT),
    case("central differences at 0.89 of their limit", integrator=_EXPLICIT | steps(30)),
    case("8 steps a turn", integrator=steps(8)),
    case("24 steps a turn", integrator=steps(24)),
    case("36 steps a turn, tilt free", tilt="free", integrator=steps(36)),
    case("61 steps a turn (odd), force of one direction", kind="unidirectional", integrator=steps(61)),
    case("3 turns of 90 steps", integrator=steps(90, turns=3)),
    case("2 turns of 36 steps, tilt free", tilt="free", integrator=steps(36, turns=2)),
    case("lift-off, 200 N, 13 000 r/min", axial=200.0, rpm=13000.0),
    case("lift-off, 100 N, tilt free", axial=100.0, tilt="free"),
    case("lift-off, 400 N, 15 000 r/min, 60 steps a turn", axial=400.0, rpm=15000.0, integrator=steps(60),
         kinematics={"ball_inertia": False}),
    case("lift-off, 150 N, force of one direction", axial=150.0, kind="unidirectional", rpm=9000.0),
    case("400 N, force of one direction, tilt free", axial=400.0, tilt="free", kind="unidirectional"),
    case("light preload of 50 N", axial=50.0, rpm=6000.0, excitation={"unbalance": 6e-5}),
    case("light preload of 20 N, tilt free", axial=20.0, tilt="free", rpm=9000.0, excitation={"unbalance": 1e-5}, finer=_FINE),
    case("ramp, tilt free", tilt="free", integrator={"start": "ramp"}),
    case("ramp, 3 turns, tilt free: one turn is used", tilt="free", integrator={"start": "ramp", "turns": 3}),
    case("sudden load", integrator={"start": "static"}),
    case("sudden load, 60 turns of 180 steps", integrator=steps(180, start="static", turns=60)),
    case("sudden load, 4 turns, 200 N, tilt free", axial=200.0, tilt="free", integrator={"start": "static", "turns": 4}),
    case("damped contacts", contact={"damping": 500.0}),
    case("penalty law, tilt against 20 kN m/rad", tilt=2e4, contact={"kind": "penalty"}, integrator=steps(120)),
    case("40 000 r/min, tilt free", axial=2000.0, tilt="free", rpm=40000.0, excitation={"unbalance": 3e-5}),
    case("orbiting balls, 24 turns", axial=400.0, integrator=steps(90, turns=24), kinematics={"orbiting": True}, finer=_FINE),
    case("impedance fit over three speeds", integrator=steps(60),
         identifier={"kind": "impedance_fit", "speeds_rpm": [9000.0, 12000.0, 15000.0]}),
    case("sudden load, heavily damped contacts", integrator=steps(120, start="static", turns=24), contact={"damping": 2000.0},
         finer={"steps_per_turn": _FINE_STEPS, "start": "ramp", "turns": 60}),
)  # fmt: skip


def orbit_value(tables: dict[str, Any]) -> tuple[complex, float]:
    """Z of the steady orbit and its relative change from half as many times.  ConvergenceError: no orbit found."""
    model = model_of(tables)
    start = solve_equilibrium(model).displacement
    found = []
    for samples in (129, 257):
        orbit = steady_orbit(model.system, model.excitation.period_s, start, samples, tolerance=1e-11)
        force, line = (np.fft.fft(part, axis=0)[1] for part in (orbit.force, orbit.displacement))
        found.append(stiffness(force, line))
    return found[-1], abs(found[-1] - found[-2]) / abs(found[-1])


def judge(one: Case) -> tuple[float, float, float]:
    """Estimated and true relative error of Z, and the bound of the true value."""
    result = run(scene_from_dict(one.tables))
    if one.finer is None:
        wanted, bound = orbit_value(one.tables)
    else:
        finer = run(scene_from_dict({**one.tables, "integrator": {**one.tables["integrator"], **one.finer}}))
        wanted, bound = finer.identification.dynamic_stiffness, finer.error["total"]
    estimate = result.error["total"]
    true = abs(result.identification.dynamic_stiffness - wanted) / abs(wanted)
    return float("nan") if estimate is None else estimate, true, bound


def right(estimate: float, true: float) -> bool:
    return (estimate < SMALL and true < SMALL) or true / FACTOR <= estimate <= FACTOR * true


def worst(pairs: list[tuple[float, float]]) -> float:
    """Estimated over true error that is furthest from 1, of those that are not both below ``SMALL``; NaN where one is not known."""
    estimate, true = np.array([pair for pair in pairs if not max(pair) < SMALL]).T
    return float((estimate / true)[np.argmax(np.abs(np.log(estimate / true)))])


def named(name: str) -> Case:
    """A case by its name."""
    return next(one for one in CASES if one.name == name)
