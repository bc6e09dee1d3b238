"""Elastic bodies in motion."""

import json
import subprocess
import sys
import time

import numpy as np
import pytest

from checks.validation.command_line import EXAMPLES
from checks.validation.scenes import built_in
from raceway import build_model, make_plan, scene_from_dict
from raceway.core.fem.elastic.bearing import ElasticSystem
from raceway.core.fem.elastic.friction import CoulombFriction
from raceway.core.fem.elastic.iterative_solver import sticking_stiffness
from raceway.core.fem.elastic.ring import from_orbit
from raceway.extend import Schedule, drift, integrate, steady_orbit
from raceway.testing import run, solve_equilibrium
from tests.core.validation.impact import MODULUS, expected, model, moving, structural_compliances

CentralDifference = built_in("integrator", "central_difference")
Newmark = built_in("integrator", "newmark")

pytestmark = pytest.mark.night

#: The impact: elements at the contact [m], their zone [m], hourglass coefficient, steps of the implicit run.
FINE, ZONE, HOURGLASS, IMPLICIT_STEPS = 0.14e-3, 0.34e-3, 0.005, 240
#: A whole bearing, coarse: it is for comparing methods, not for accuracy.
BEARING = {
    "title": "coarse whole bearing", "bearing": {"preset": "B7206C"}, "bodies": {"kind": "elastic", "formulation": "one_point"},
    "mesh": {
        "kind": "structured", "element_size": 3.2e-3, "nodes_per_semi_axis": 1, "azimuth_cells": 36, "growth": 3.0, "patch": 0.5,
        "ball_load": 2000.0,
    },
    "load": {"axial": 1000.0}, "rotor": {"mass": 0.5},
    "contact": {"kind": "penalty", "discretisation": "nodal", "stiffness": 1e15},
    "excitation": {"kind": "bidirectional", "speed_rpm": 15000.0, "amplitude": "constant", "force": 200.0},
}  # fmt: skip
CLOSED, OWN = {"basis": "closed form"}, {"basis": "own other method"}
CONSERVED = {"at_most": 0.005, **CLOSED, "source": "conservation; 0.5 % of what a contact stores"}


class Heard(ElasticSystem):
    """Keeps the contact force [N] of every step."""

    def __init__(self, system):
        super().__init__(system.assembly, system.contact, MODULUS, system.load)
        self.force = []

    def commit(self):
        self.force.append(self.contacts()[2])
        super().commit()


def fallen(quarter, method, duration):
    """Record, and contact force of the whole ball at every step (steps,) [N]."""
    start = moving(quarter.system, quarter.velocity)
    state = quarter.system.begin(start)
    quarter.system.internal(0.0, 1e-9, state.u, state.v)
    steps = IMPLICIT_STEPS if method.implicit else int(duration / (0.8 * quarter.system.stable_step()))
    heard = Heard(quarter.system)
    record = integrate(method, heard, start, Schedule(duration / steps, steps, 1, stride=max(1, steps // 600)))
    return record, 4.0 * np.array(heard.force)


def test_impact(claim):
    """A ball of 9.525 mm, 1 m/s, on a clamped block of 16 x 16 x 8 mm; a quarter of both."""
    compliance = sum(structural_compliances())
    errors, impulses, energies, hourglass, peaks, lasting = [], [], [], [], [], []
    for method in (CentralDifference(), Newmark(tolerance=1e-6)):
        quarter = model(FINE, ZONE, hourglass=HOURGLASS)
        wanted = expected(quarter.mass, 1.0, compliance)
        record, heard = fallen(quarter, method, 1.15 * wanted.time)
        force, times = 4.0 * record.contact_force[:, 0], record.time
        lasting.append(float(times[np.flatnonzero(force > 0.0)[-1]]))
        peaks.append(heard.max())
        away = quarter.speed(record.final.full_state["v"])
        impulses.append(abs(float(np.sum(force) * (times[1] - times[0])) / (quarter.mass * (1.0 + away)) - 1.0))
        errors += [abs(force.max() / wanted.force - 1.0), abs(lasting[-1] / wanted.time - 1.0)]
        energies.append(drift(record.energies) or 0.0)
        hourglass.append(record.energies["hourglass"].max() / record.energies["elastic"].max())
    where = "impact of a ball, explicit and implicit"
    source = "Hertz's law and the structural compliance in series, without waves in the bodies"
    claim(
        f"{where}: peak force and contact time: largest relative error", max(errors), at_most=0.03, **CLOSED, source=source
    )
    claim(f"{where}: impulse over the change of momentum: largest error", max(impulses), **CONSERVED)
    claim(f"{where}: change of the energy: largest", max(energies), **CONSERVED)
    source = "a mode that real bodies do not have; coefficient 0.005"
    claim(f"{where}: hourglass energy over elastic energy: largest", max(hourglass), at_most=0.02, **CLOSED, source=source)
    why = "at the explicit step points that open and close ring; means over an implicit step are 0.2 % apart"
    bounds = {"at_most": 0.01, **OWN, "source": "explicit and implicit integrator, 6400 and 240 steps"}
    claim("impact of a ball: peak force of single steps: difference", abs(peaks[1] / peaks[0] - 1.0), **bounds, misses=why)
    claim("impact of a ball: contact time: difference", abs(lasting[1] / lasting[0] - 1.0), **bounds)


@pytest.fixture(scope="module")
def bearing():
    """Model and the start on its orbit."""
    built = build_model(scene_from_dict(BEARING))
    found = solve_equilibrium(built)
    orbit = steady_orbit(built.bearing.periodic_system(built.system), built.excitation.period_s, found.displacement)
    return built, found, from_orbit(built.system, orbit)


def test_bearing_by_two_integrators(claim, bearing):
    """A twentieth of a turn from the same start."""
    built, found, start = bearing
    part = 0.05 * built.excitation.period_s
    steps = 40 * (int(part / (0.7 * built.system.critical_time_step(found.stiffness))) // 40 + 1)
    explicit = integrate(CentralDifference(), built.system, start, Schedule(part / steps, steps, 1, stride=steps // 40))
    implicit = integrate(Newmark(tolerance=1e-6), built.system, start, Schedule(part / 40, 40, 1))
    moved = np.abs(explicit.displacement[:, 1:3] - found.displacement[1:3]).max()
    apart = np.abs(explicit.displacement[:, :3] - implicit.displacement[:, :3]).max() / moved
    loads = np.abs(explicit.contact_force - implicit.contact_force).max() / explicit.contact_force.max()
    where, bounds = "a twentieth of a turn at 15 000 r/min, central_difference and newmark", {"at_most": 0.02, **OWN}
    source = "34 480 and 40 steps"
    claim(f"{where}: displacements: largest difference", apart, **bounds, source=source)
    claim(f"{where}: contact forces: largest difference", loads, **bounds, source=source)
    quantity = f"{where}: change of the energy: largest"
    claim(quantity, max(drift(one.energies) or 0.0 for one in (explicit, implicit)), **CONSERVED)
    share = float(explicit.energies["hourglass"].max() / explicit.energies["elastic"].max())
    why = "one element to the semi-axis: its bending and contact are hourglass modes"
    source = "a mode that real bodies do not have; coefficient 0.05"
    claim(f"{where}: hourglass energy over elastic energy", share, at_most=0.02, **CLOSED, source=source, misses=why)


def test_iterations_with_friction(claim, bearing):
    """To the static state with mu = 0.03 from the place of rigid bodies."""
    ring = bearing[0].system
    system = ring.bodies.system
    place, places, _ = ring.surrogate.solve_equilibrium(ring.equilibrium[:5])
    guess = ring.bodies.guess(place, places if places[:, 1].any() else ring._on_the_line(place, places))
    _, without = ring.equilibrium_under(guess, ring.load)
    contact = system.contact
    contact.friction = CoulombFriction(0.03, sticking_stiffness(ring.bodies.setup, contact.area))
    system.locate(guess)
    contact.friction.begin((contact.move @ system.assembly.nodal(guess)).reshape(-1, 3))
    found = system.solve_equilibrium(guess, 1e-7)
    contact.friction = None
    quantity, source = "bearing with mu = 0.03: iterations over those without friction", "Newton's method, exact tangents"
    claim(quantity, found.iterations / without, at_most=3.0, basis="regression", source=source)


def test_predicted_work(claim):
    """Of an equilibrium, and of one turn of 8 implicit steps."""
    still = {key: value for key, value in BEARING.items() if key != "excitation"}
    ratios = []
    for tables in (still, {**BEARING, "integrator": {"kind": "newmark", "turns": 1, "steps_per_turn": 8}}):
        scene = scene_from_dict(tables)
        predicted, begun = make_plan(scene).predicted_work_s, time.process_time()
        run(scene)
        ratio = (time.process_time() - begun) / predicted
        ratios.append(max(ratio, 1.0 / ratio))
    quantity = "equilibrium and newmark of a coarse bearing: measured over predicted CPU time, or its inverse: largest"
    why = "0.6 CPU-s of 4.0 predicted for the equilibrium, 2.1 to 3.2 of 5.0 for a turn of 8 steps"
    source = "a plan is for choosing: a factor of 2"
    claim(quantity, max(ratios), at_most=2.0, basis="regression", source=source, misses=why, machine=True)


def test_explicit_step_of_the_article_s_mesh(claim):
    words = [sys.executable, "-m", "checks.explicit_step"]
    found = json.loads(subprocess.run(words, cwd=EXAMPLES.parent, stdout=subprocess.PIPE, check=True).stdout)
    assert found["same_digits"]
    name, once = "explicit step, a million elements, friction", {"basis": "regression", "source": "ratios of one run"}
    claim(f"{name}: CPU time over the forces alone, one thread", found["step_over_forces"], at_most=2.5, **once)
    claim(f"{name}: CPU time of all threads over one", found["cpu_ratio"], at_most=1.25, **once)
