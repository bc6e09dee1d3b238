"""The steady orbit solved for directly: against long transients, its cost, its symmetry, its multipliers, its hard cases."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.linalg import expm

from benchmarks.evidence import Row, below
from benchmarks.evidence._orbits import ONE_WAY, Tables, apart, by_turns, methods, resonance, scene, solve_ms, solved
from raceway.core.schemes.drivers import integrate
from raceway.core.stepping.record import Schedule
from raceway.integrators.periodic import Periodic
from raceway.pipeline.settle import settle
from raceway.scene.inner_ring import ring_inertia
from raceway.testing.systems import SPEED, linear_system, motion
from validation.reference.ring import Ring
from validation.reference.shooting import periodic as shooting
from validation.reference.shooting import rotating as turning
from validation.reference.shooting import swinging
from validation.scenes import model_of, rig_force

TITLE = "The steady orbit solved for directly"
COMMAND = "python -m benchmarks.evidence periodic"
TURNS, STEPS = 400, 1440
_SCENE = "raceway run examples/b7206.toml --set integrator.kind=periodic"

#: Scenes that a transient settles on.
SETTLING: dict[str, Tables] = {
    "tilt locked": scene(),
    "tilt free, ball inertia": scene(tilt="free", inertia=True),
    "tilt locked, force of one direction": scene(excitation=ONE_WAY),
    "every ball lifts off, 200 N": scene(axial=200.0),
    "condensed bodies": scene(bodies={"kind": "condensed"}),
}
SYMMETRIC = {
    **{name: SETTLING[name] for name in ("tilt locked", "tilt free, ball inertia", "every ball lifts off, 200 N")},
    "two rows, gyroscopic moments": scene(
        inertia=True, kinematics={"gyroscopic": "shared"}, bearing={"arrangement": "DB", "row_distance": 0.016}
    ),
    "contacts with 500 N s/m": scene(contact={"damping": 500.0}),
    "condensed bodies": SETTLING["condensed bodies"],
}
COST = {
    "tilt locked, weightless balls": scene(),
    "tilt free, weightless balls": scene(tilt="free"),
    "tilt locked, ball inertia": scene(inertia=True),
    "tilt free, ball inertia": scene(tilt="free", inertia=True),
}
#: No motion grows out of rest to the whole force.
RESONANT = {
    "600 N, tilt free, 13 500 r/min, force of one direction": scene(
        axial=600.0, rpm=13500.0, tilt="free", inertia=True, excitation=ONE_WAY
    ),
    "400 N, tilt locked, 15 000 r/min, ball inertia, force of one direction": scene(
        axial=400.0, rpm=15000.0, inertia=True, excitation=ONE_WAY
    ),
}


def rows() -> list[Row]:
    # First, as a user's process is: two milliseconds of Python feel the garbage of a hundred other runs, Newmark does not.
    cost = _cost()
    return [*_transients(), *cost, *_symmetry(), *_multipliers(), *_resonances(), *_methods()]


def _transients() -> list[Row]:
    out = []
    for name, tables in SETTLING.items():
        direct, by_time = solved(tables), by_turns(tables, TURNS, STEPS)
        z = direct.identification.dynamic_stiffness
        note = f"|Z| = {abs(z):.10g} N/m; {direct.cost['solve_s']:.2g} s against {by_time.cost['solve_s']:.2g} s"
        words = f"{name}: Z against {TURNS} turns of {STEPS} steps with a C2 ramp, relative"
        out.append(below(words, apart(direct, by_time), 1e-6, COMMAND, note))
    return out


def _cost() -> list[Row]:
    out = []
    for name, tables in COST.items():
        # In turns, because what else the machine does slows down short work more than long.
        newmark: Tables = {**tables, "integrator": {"kind": "newmark", "turns": 12}}
        both = [(solve_ms(tables, 60), solve_ms(newmark, 10)) for _ in range(5)]
        direct, by_time = (min(times) for times in zip(*both, strict=True))
        note = f"{direct:.2f} ms against {by_time:.1f} ms, from the equilibrium to the record, starting orbit included"
        words = f"{name}, rotating force: processor time over that of 12 turns of 360 Newmark steps"
        out.append(below(words, direct / by_time, 0.1, COMMAND, note))
    return out


def _symmetry() -> list[Row]:
    out = []
    for name, tables in SYMMETRIC.items():
        one, whole = (solved({**tables, "integrator": {"kind": "periodic", "tolerance": 1e-9, "symmetry": kind}})
                      for kind in ("auto", "none"))  # fmt: skip
        span = one.stability["floquet"]["span_deg"]
        pair = [found.simulation.record.displacement for found in (one, whole)]
        off = np.abs(pair[0] - pair[1])[:, :3].max() / (0.5 * np.ptp(pair[1][:, 1]))
        found = [np.sort([m["abs"] for m in result.stability["floquet"]["multipliers"]]) for result in (one, whole)]
        note = f"{span:.4g} deg; {one.cost['steps']} against {whole.cost['steps']} intervals; multipliers differ in size by "
        note += f"{np.abs(found[0] - found[1]).max():.1g}"
        words = f"{name}: motion of one ball pitch against that of one turn, over its amplitude"
        out.append(below(words, off, 1e-8, COMMAND, note))
    return out


def _apart(found: Any, wanted: np.ndarray) -> float:
    """Largest distance of a multiplier from the nearest one that is wanted."""
    own = np.array([complex(m["real"], m["imag"]) for m in found["multipliers"]])
    off = np.abs(own[:, None] - wanted[None, :])
    return float(max(off.min(axis=0).max(), off.min(axis=1).max()))


def _multipliers() -> list[Row]:
    system = linear_system()
    chosen = np.ix_(system.free > 0.0, system.free > 0.0)
    still = motion(system, np.zeros(5), np.zeros(5))
    turn = 2.0 * np.pi / SPEED
    record = integrate(Periodic(tolerance=1e-9), system, still, Schedule(turn / 36, 36, 1))
    inverse = np.linalg.inv(system.mass[chosen])
    n = len(inverse)
    flow = np.block(
        [[np.zeros((n, n)), np.eye(n)], [-inverse @ system.stiffness[chosen], -inverse @ system.damping[chosen]]]
    )
    wanted = np.linalg.eigvals(expm(flow * turn))
    words = "Floquet multipliers of springs, dashpots and a gyroscopic term against the matrix exponential, largest distance"
    out = [below(words, _apart(record.counts["floquet"], wanted), 1e-8, COMMAND)]
    free_of_damping = {"damping": 0.0}
    cases = {
        "400 N, rotating force": scene(axial=400.0, contact=free_of_damping),
        "400 N, force of one direction": scene(axial=400.0, excitation=ONE_WAY, contact=free_of_damping),
        "1000 N, tilt free": scene(tilt="free", contact=free_of_damping),
    }
    for name, tables in cases.items():
        note = "DOP853 with its variational equations; no kernel of the program"
        words = f"Floquet multipliers, {name}, against the monodromy matrix of an independent program, largest distance"
        out.append(below(words, _apart(_tight(tables).stability["floquet"], _monodromy(tables)), 1e-6, COMMAND, note))
    damped = scene(contact={"damping": 20.0})
    found = [m["abs"] for m in _tight(damped).stability["floquet"]["multipliers"]]
    rate = np.log(np.sort(found)) / np.log(np.sort(np.abs(_monodromy(damped))))
    note = "rates of the balls are not varied: off by the difference of the races' compliances over their sum"
    words = "decay of disturbances, contacts with 20 N s/m, against the same, largest relative difference"
    out.append(below(words, float(np.abs(rate - 1.0).max()), 0.05, COMMAND, note))
    return out


def _tight(tables: Tables) -> Any:
    return solved({**tables, "integrator": {"kind": "periodic", "tolerance": 1e-9}})


def _monodromy(tables: Tables) -> np.ndarray:
    model = model_of(tables)
    system, w = model.system, 12000.0 * np.pi / 30.0
    damping = tables["contact"]["damping"]
    _, _, polar = ring_inertia(model.scene)
    ring = Ring(9.525e-3, 46e-3, 12, np.radians(15.0), 0.522, 0.522, damping=damping, spin=polar * w)
    one_way = tables["excitation"]["kind"] == "unidirectional"
    force = (swinging if one_way else turning)(rig_force(12000.0), w)
    record = _tight(tables).simulation.record
    q, v = record.displacement[-1].copy(), record.velocity[-1].copy()
    q[system.free == 0.0] = settle(model).displacement[system.free == 0.0]
    return shooting(ring, system.mass, system.load, force, system.free, 2.0 * np.pi / w, q, v)[2]


def _resonances() -> list[Row]:
    out = []
    for name, tables in RESONANT.items():
        end, result = resonance(tables), solved(tables)
        fate = result.stability["floquet"]
        orders = ", ".join(f"{order:.2f}" for order in end.orders)
        note = f"natural frequencies at {orders} times the force's; the branch turns back there and at no force has become "
        note += f"the free vibration of order {end.order}, {1e6 * end.amplitude:.2f} um (share {end.ends_at:.2g})"
        out.append(Row(f"{name}: share of the force where the motion that grows out of rest ends", end.fold, "below 1",
                       end.fold < 1.0 and abs(end.ends_at) < 0.02, COMMAND, note))  # fmt: skip
        ways = {"+1": "through +1", "-1": "through -1", "pair": "as a pair, a second frequency"}
        by_time = by_turns(tables, 60, 720)
        spread = by_time.identification.spread
        note = (
            f"found {fate['found']}, leaves {ways.get(fate['leaves_by'] or '', 'nothing')}; a ramped transient of 60 turns "
        )
        note += "has no steady line: single turns differ from the mean by " + ("?" if spread is None else f"{spread:.2g}")
        out.append(Row(f"{name}: growth of disturbances a turn on the motion at the whole force", fate["largest"],
                       "above 1: unstable", fate["verdict"] == "unstable", COMMAND, note))  # fmt: skip
    return out


def _methods() -> list[Row]:
    cases = {
        "rotating force": scene(),
        "force of one direction": scene(excitation=ONE_WAY),
        "every ball lifts off, 200 N": SETTLING["every ball lifts off, 200 N"],
    }
    return [
        Row(f"{name}: {words}", f"error {error:.1e}, {spent:.2f} ms", "reported", True, COMMAND)
        for name, tables in cases.items()
        for words, error, spent in methods(tables)
    ]
