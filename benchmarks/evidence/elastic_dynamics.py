"""Elastic bodies in motion: a ball that falls on a block, a block that slides, a whole bearing by two integrators."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from benchmarks.evidence import Row, below
from benchmarks.evidence._impact import Impact, expected, model, structural_compliances
from benchmarks.evidence._kept import kept
from benchmarks.explicit_step import measure
from raceway import build_model, make_plan, scene_from_dict
from raceway.bodies.model import Model
from raceway.core.elastic.contacts.friction import CoulombFriction
from raceway.core.elastic.start import from_orbit
from raceway.core.elastic.stepped import SteppedElastic
from raceway.core.elastic.touching import sticking
from raceway.core.ring.orbit import steady_orbit
from raceway.core.schemes.drivers import integrate
from raceway.core.stepping.energy import drift, largest_share
from raceway.core.stepping.record import Record, Schedule
from raceway.integrators.central_difference import CentralDifference
from raceway.integrators.newmark import Newmark
from raceway.pipeline.run import run
from raceway.pipeline.settle import settle
from validation.block import Block

TITLE = "Elastic bodies in motion"
COMMAND = "python -m benchmarks.evidence elastic_dynamics"
#: The impact: elements at the contact [m], their zone [m], hourglass coefficient, steps of the implicit run.
FINE, ZONE, HOURGLASS, IMPLICIT_STEPS = 0.14e-3, 0.34e-3, 0.005, 240
#: A whole bearing, coarse: it is for comparing programs' ways, not for accuracy.
BEARING: dict[str, Any] = {
    "title": "coarse whole bearing",
    "bearing": {"preset": "B7206C"},
    "bodies": {"kind": "elastic", "formulation": "one_point"},
    "mesh": {
        "kind": "structured",
        "element_size": 3.2e-3,
        "nodes_per_semi_axis": 1,
        "azimuth_cells": 36,
        "growth": 3.0,
        "patch": 0.5,
        "ball_load": 2000.0,
    },
    "load": {"axial": 1000.0},
    "rotor": {"mass": 0.5},
    "contact": {"kind": "penalty", "discretisation": "nodal", "stiffness": 1e15},
    "excitation": {"kind": "bidirectional", "speed_rpm": 15000.0, "amplitude": "constant", "force": 200.0},
}


def rows() -> list[Row]:
    return kept("elastic_dynamics", PARTS)


class _Heard(SteppedElastic):
    """Keeps the contact force [N] of every step."""

    def __init__(self, stepped: SteppedElastic) -> None:
        super().__init__(stepped.system)
        self.force: list[float] = []

    def commit(self) -> None:
        self.force.append(self.contacts()[2])
        super().commit()


def _impact() -> list[Row]:
    """A ball of 9.525 mm, 1 m/s, on a clamped block of 16 x 16 x 8 mm; a quarter of both."""
    down, up = structural_compliances()
    out, peaks = [], []
    for method in (CentralDifference(), Newmark(tolerance=1e-6)):
        quarter = model(FINE, ZONE, hourglass=HOURGLASS)
        wanted = expected(quarter.mass, 1.0, down + up)
        record, heard, cpu = _fallen(quarter, method, 1.15 * wanted.time)
        force, times = 4.0 * record.contact_force[:, 0], record.time
        # For the note: means over an implicit step, over which points that open and close ring.
        window = max(1, len(heard) // IMPLICIT_STEPS)
        mean = np.convolve(heard, np.full(window, 1.0 / window), "valid")
        touching = np.flatnonzero(force > 0.0)
        lasted = float(times[touching[-1]])
        away = quarter.speed(record.final.whole["v"])  # type: ignore[index]
        momentum = float(np.sum(force) * (times[1] - times[0])) / (quarter.mass * (1.0 + away))
        peaks.append((float(max(heard)), lasted, float(mean.max())))
        name, note = f"impact, {method.name}: ", f"{record.counts['steps']} steps, {cpu:.0f} CPU-s, {len(force)} samples"
        out += [
            below(name + "peak force against Hertz with structural compliance", abs(force.max() / wanted.force - 1.0), 0.03, COMMAND,
                  f"{force.max():.2f} N against {wanted.force:.2f} N; {note}"),
            below(name + "contact time against the same", abs(lasted / wanted.time - 1.0), 0.03, COMMAND,
                  f"{1e6 * lasted:.3f} us against {1e6 * wanted.time:.3f} us"),
            below(name + "impulse against the change of momentum", abs(momentum - 1.0), 0.005, COMMAND,
                  f"ball of {1e3 * quarter.mass:.4g} g (the reduced mass: the block is clamped) leaves with {away:.4f} m/s"),
            below(name + "energy balance", drift(record.energies) or 0.0, 0.005, COMMAND),
            below(name + f"hourglass energy over elastic energy, coefficient {HOURGLASS}",
                  largest_share(record.energies, "hourglass", "elastic"), 0.02, COMMAND),
        ]  # fmt: skip
    (explicit, first, top), (implicit, second, other) = peaks
    note = (
        f"{explicit:.2f} N against {implicit:.2f} N, single steps: at the explicit step points that open and close ring; means over "
        f"an implicit step of {1e9 * 1.15 * wanted.time / IMPLICIT_STEPS:.0f} ns are {100.0 * abs(other / top - 1.0):.2f} % apart"
    )
    out.append(below("impact, peak force: explicit against implicit", abs(implicit / explicit - 1.0), 0.01, COMMAND, note))
    out.append(below("impact, contact time: explicit against implicit", abs(second / first - 1.0), 0.01, COMMAND))
    return out


def _fallen(quarter: Impact, method: Any, duration: float) -> tuple[Record, np.ndarray, float]:
    """Record, contact force of the whole ball at every step (steps,) [N], CPU seconds."""
    start = quarter.system.moving(quarter.velocity)
    state = quarter.system.begin(start)
    quarter.system.internal(0.0, 1e-9, state.u, state.v)
    steps = IMPLICIT_STEPS if method.implicit else int(duration / (0.8 * quarter.system.stable_step()))
    begun = time.process_time()
    schedule = Schedule(duration / steps, steps, 1, stride=max(1, steps // 600))
    heard = _Heard(quarter.system)
    record = integrate(method, heard, start, schedule)
    return record, 4.0 * np.array(heard.force), time.process_time() - begun


def _block() -> list[Row]:
    """A block pressed on a plane with mu = 0.3 that slides at 1 m/s and stops; one that is pulled below the limit."""
    out, weight, mu, speed = [], 2.0, 0.3, 1.0
    for method in (Newmark(), CentralDifference()):
        block = Block(weight, mu)
        slowing = mu * weight / block.mass
        lasts, way = speed / slowing, 0.5 * speed**2 / slowing
        steps = 200 if method.implicit else int(1.4 * lasts / (0.8 * block.stable_step()))
        record = integrate(method, block, block.at_rest(speed), Schedule(1.4 * lasts / steps, steps, 1))  # type: ignore[arg-type]
        x, v, t = record.displacement[:, 0], record.velocity[:, 0], record.time
        sliding = t < 0.9 * lasts
        name = f"block on a plane, {method.name}: "
        wrong = float(np.abs(v[sliding] - (speed - slowing * t[sliding])).max() / speed)
        out.append(below(name + "velocity while it slides, over the first", wrong, 0.01, COMMAND))
        wrong = float(np.abs(x[t > 1.1 * lasts] - way).max() / way)
        out.append(below(name + "where it stops and stays", wrong, 0.01, COMMAND, f"{1e3 * way:.4g} mm"))
        lost = float(record.energies["friction"][-1] / (0.5 * block.mass * speed**2))
        out.append(below(name + "energy that friction took, over the kinetic one", abs(lost - 1.0), 0.01, COMMAND))
    block = Block(weight, mu, lambda t: 0.3 * mu * weight * np.sin(np.pi * min(t / 4e-3, 1.0)) ** 2, stick=1e11)
    record = integrate(Newmark(), block, block.at_rest(), Schedule(4e-5, 125, 1))  # type: ignore[arg-type]
    lost = float(record.energies["friction"][-1])
    out.append(below("block on a plane, pulled with 0.3 of the limit: energy lost, J", lost, 0.0, COMMAND, "it sticks"))
    return out


def _built(**changes: Any) -> tuple[Model, Any]:
    scene = scene_from_dict({**BEARING, **changes})
    built = build_model(scene, make_plan(scene))
    return built, settle(built)


def _bearing() -> list[Row]:
    """A twentieth of a turn by both integrators from the same start, and on from the disk; friction at rest."""
    built, found = _built()
    ring: Any = built.system
    period = built.excitation.period_s
    orbit = steady_orbit(built.bearing.orbiting(ring), period, found.displacement)
    start = from_orbit(ring, orbit, 0.0)
    limit = ring.critical_time_step(found.stiffness)
    steps = 40 * (int(0.05 * period / (0.7 * limit)) // 40 + 1)
    part = 0.05 * period
    begun = time.process_time()
    explicit = integrate(CentralDifference(), ring, start, Schedule(part / steps, steps, 1, stride=steps // 40))
    middle = time.process_time()
    implicit = integrate(Newmark(tolerance=1e-6), ring, start, Schedule(part / 40, 40, 1))
    ended = time.process_time()
    moved = np.abs(explicit.displacement[:, 1:3] - found.displacement[1:3]).max()
    apart = float(np.abs(explicit.displacement[:, :3] - implicit.displacement[:, :3]).max() / moved)
    loads = float(np.abs(explicit.contact_force - implicit.contact_force).max() / explicit.contact_force.max())
    cells = ring.bodies.cells
    note = f"{cells} elements; {steps} steps, {middle - begun:.0f} CPU-s against 40 steps, {ended - middle:.0f} CPU-s"
    name = "a twentieth of a turn at 15 000 r/min, central_difference against newmark: "
    out = [
        below(name + "displacement over its amplitude", apart, 0.02, COMMAND, note),
        below(name + "contact forces over the largest", loads, 0.02, COMMAND),
        below(name + "energy balance, central_difference", drift(explicit.energies) or 0.0, 0.005, COMMAND),
        below(name + "energy balance, newmark", drift(implicit.energies) or 0.0, 0.005, COMMAND),
        below(name + "hourglass energy over elastic energy, coefficient 0.05",
              largest_share(explicit.energies, "hourglass", "elastic"), 0.02, COMMAND,
              "one element to the semi-axis: bend and contact of such cells are hourglass modes; both integrators step the same mesh"),
    ]  # fmt: skip
    return [*out, *_restart(ring, start, part / steps), *_rubbing(ring)]


def _restart(ring: Any, start: Any, dt: float) -> list[Row]:
    out = []
    for method, step in ((CentralDifference(), dt), (Newmark(tolerance=1e-9), 100.0 * dt)):
        count = 20 if not method.implicit else 4
        whole = integrate(method, ring, start, Schedule(step, count, 1))
        first = integrate(method, ring, start, Schedule(step, count // 2, 1))
        second = integrate(method, ring, first.final, Schedule(step, count // 2, 1, first=count // 2))
        apart = np.abs(second.final.whole["u"] - whole.final.whole["u"]).max() / np.abs(whole.final.whole["u"]).max()
        bound = 0.0 if not method.implicit else 1e-8
        note = "to the last bit" if bound == 0.0 else "to Newton's tolerance: linear solves remember their factors"
        out.append(
            below(
                f"two halves, {method.name}: largest relative difference of all unknowns",
                float(apart),
                bound,
                COMMAND,
                note,
            )
        )
    return out


def _rubbing(ring: Any) -> list[Row]:
    """Iterations to the static state with mu = 0.03 from the place of rigid bodies, against those without."""
    system = ring.bodies.system
    place, places, _ = ring.surrogate.settle(ring.equilibrium[:5])
    guess = ring.bodies.guess(place, places if places[:, 1].any() else ring._on_the_line(place, places))
    _, without = ring.settled(guess, ring.load)
    contact = system.contact
    contact.friction = CoulombFriction(0.03, sticking(ring.bodies.setup, contact.area))
    system.locate(guess)
    contact.friction.begin((contact.move @ system.assembly.nodal(guess)).reshape(-1, 3))
    found = system.settle(guess, 1e-7)
    contact.friction = None
    note = f"{found.iterations} against {without} iterations"
    return [
        below(
            "bearing with mu = 0.03: iterations over those without friction", found.iterations / without, 3.0, COMMAND, note
        )
    ]


def _cost() -> list[Row]:
    """CPU seconds of whole runs against the plan's prediction."""
    out = []
    still = {key: value for key, value in BEARING.items() if key != "excitation"}
    moving = {**BEARING, "integrator": {"kind": "newmark", "turns": 1, "steps_per_turn": 8}}
    for name, tables in (("equilibrium", still), ("newmark, one turn of 8 steps", moving)):
        scene = scene_from_dict(tables)
        predicted = make_plan(scene).predicted_work_s
        begun = time.process_time()
        run(scene)
        ratio = (time.process_time() - begun) / predicted
        out.append(below(f"cost, {name}: the larger of measured over predicted and its inverse", max(ratio, 1.0 / ratio), 2.0, COMMAND,
                         f"{ratio * predicted:.1f} CPU-s measured, {predicted:.1f} s predicted"))  # fmt: skip
    return out


def _step() -> list[Row]:
    """An explicit step on the article's mesh, with friction: one thread against all cores."""
    found = measure()
    command = "python -m benchmarks.explicit_step"
    name, threads = f"explicit step, article mesh of {found['elements']} elements, friction: ", found["threads"]
    note = f"{found['step_us_per_element']:.3f} us an element and step; the forces alone {found['forces_us_per_element']:.3f} us"
    out = [
        below(name + "CPU over the forces of the elements alone, one thread", found["step_over_forces"], 2.5, command, note),
        below(name + f"CPU with {threads} threads over one", found["cpu_ratio"], 1.25, command,
              f"{found['all_threads_cpu_us_per_element']:.3f} us an element and step"),
        Row(name + f"digits with {threads} threads", "the same" if found["same_digits"] else "others", "the same as with one",
            found["same_digits"], command),
    ]  # fmt: skip
    quantity = name + f"wall time of one thread over that of {threads}"
    wall = (
        f"{found['step_wall_us_per_element']:.3f} and {found['all_threads_wall_us_per_element']:.3f} us an element and step"
    )
    if threads == 1 or not found["quiet"]:
        why = "not measured: one core" if threads == 1 else "not measured: machine busy"
        return [*out, Row(quantity, why, "for information", True, command, wall)]
    least = 0.75 * threads if threads <= 4 else 3.0  # memory bandwidth bounds more of them
    return [*out, Row(quantity, found["wall_ratio"], f"at least {least:g}", found["wall_ratio"] >= least, command, wall)]


#: Each of them minutes of CPU time, but for the step.
PARTS = (_impact, _block, _bearing, _cost, _step)
