"""Steps in time by superelements against the unreduced system: mass, dashpots, and friction that sticks and slips."""

from functools import cache

import numpy as np
import pytest

from checks.validation.scenes import built_in
from raceway.core.fem.elastic.iterative_solver import LinearSolver
from raceway.core.fem.elastic.superelement import Closed
from raceway.extend import Schedule, integrate, standstill
from raceway.testing import solve_equilibrium
from tests.core.superelements.bearings import built

GeneralizedAlpha = built_in("integrator", "generalized_alpha")

#: 15 000 r/min: a turn of 4 ms.  A force of a tenth of the load that acts at once.
TURNING = {
    "excitation": {"kind": "bidirectional", "speed_rpm": 15000.0, "amplitude": "constant", "force": 300.0},
    "contact": {"friction": 0.03, "damping": 200.0},
    "rotor": {"mass": 0.5, "damping": 300.0, "transverse_inertia": 1e-4}, "supports": {"tilt": "free"},
}  # fmt: skip
HELD = {"fastened": {}, "on beds": {"supports": {"tilt": "free", "inner_seat": 1e12, "outer_seat": 2e12}}}
STEP = 1e-5


@cache
def at_rest(held):
    """A model in equilibrium, by superelements; the equilibrium itself is the same to 1e-11 without, see test_statics."""
    model = built(**TURNING | HELD[held])
    solve_equilibrium(model)
    return model, model.bearing.bearing.system


def coefficients(dt):
    """c_k, c_c, c_m of a scheme that weighs the forces at a step's ends, as generalised-alpha does."""
    return 0.6, 1.2 / dt, 2.7 / dt**2


def on_the_way(held):
    """A system whose contacts were evaluated one step from its equilibrium: points slip there."""
    model, system = at_rest(held)
    ring, rng = model.system, np.random.default_rng(4)
    y = ring.equilibrium
    ring.stepped().begin(standstill(ring, ramped=False))
    v = 1e-3 * rng.standard_normal(system.size) * system.assembly.unknown
    v[3:5] *= 100.0
    system.internal(0.0, STEP, y + STEP * v, v)
    return system, rng


def image_of(system, dt):
    """The matrix' product with unknowns; conjugate gradients leave out the ring's gyroscopic moments, which are skew."""
    a, (c_k, c_c, c_m) = system.assembly, coefficients(dt)
    symmetric = LinearSolver(a, system.contact, 2e11).image(c_k, c_c, c_m)
    skew = 0.5 * c_c * (a.frame_damping - a.frame_damping.T)
    assert skew.any()

    def image(y):
        out = symmetric(y)
        out[: a.frame_size] += np.where(a.frame_free, skew @ y[: a.frame_size], 0.0)
        return out

    return image


@pytest.mark.parametrize(("held", "steps"), [
    ("fastened", (1e-6,)), ("on beds", (1e-2,)), pytest.param("fastened", (1e-2, 1e-6), marks=pytest.mark.slow),
])  # fmt: skip
def test_a_solution_is_that_of_the_matrix_of_a_step(held, steps):
    """Stiffness, friction, dashpots, mass: the image of the solution is the right side, whether mass holds the balls or hardly."""
    system, rng = on_the_way(held)
    contact, solver = system.contact, system.condensed
    assert contact.friction.slipping.any()
    assert contact.rate_stiffness.any()
    for dt in steps:
        before = solver.setups
        assert_solved(system, rng, dt)
        # Superelements of a step are kept and know its mass.
        c_k, _, c_m = coefficients(dt)
        assert all(isinstance(ring.element, Closed) for ring in solver.interface(c_m / c_k).rings)
        assert solver.setups == before + 1
    # Those of another mass have gone: memory is that of one.
    solver.interface(0.0)
    assert solver.setups == before + 2


def test_balls_that_touch_nothing_are_held_by_their_mass_and_cage_alone():
    """The ring moved back by 50 um, no contact closed: springs that superelements were given to be held are taken off."""
    model, system = at_rest("fastened")
    y = model.system.equilibrium.copy()
    y[0] -= 5e-5
    u, starts = np.zeros((system.assembly.nodes, 3)), system.assembly.starts
    u[: starts[1], 0], u[starts[2] :, 0] = -5e-5, -2.5e-5  # the inner ring, and balls by half of it
    system.internal(0.0, STEP, y + np.concatenate([np.zeros(5), u.ravel()[system.assembly.free]]), np.zeros_like(y))
    assert not system.contact.force.any()
    assert_solved(system, np.random.default_rng(5), 1e-4, first=1e-2)


def assert_solved(system, rng, dt, first=1e-3):
    """To single precision times a condition of a hundred, and with two refinements, five digits each, to rounding."""
    right = rng.standard_normal(system.size) * system.assembly.unknown
    found = system.solver.solve(*coefficients(dt), right)
    image = image_of(system, dt)
    for wanted in (first, 1e-9, 1e-11):
        rest = right - image(found)
        assert system.measure(rest) < wanted * system.measure(right)
        found = found + system.solver.solve(*coefficients(dt), rest)


@pytest.mark.parametrize("method", [
    pytest.param(built_in("integrator", "newmark")(tolerance=1e-10), id="newmark"),
    pytest.param(GeneralizedAlpha(tolerance=1e-10), id="generalized_alpha", marks=pytest.mark.slow),
])  # fmt: skip
@pytest.mark.parametrize("held", ["fastened", pytest.param("on beds", marks=pytest.mark.slow)])
def test_steps_with_friction_are_those_of_the_unreduced_system(method, held, monkeypatch):
    """Two steps after a force that acts at once; 1e-10 of the forces, times a softness of some hundred."""
    model, system = at_rest(held)
    ring, schedule = model.system, Schedule(STEP, 2, 1)
    start = standstill(ring, ramped=False)
    new = integrate(method, ring.stepped(), start, schedule)
    assert 0.0 < system.contact.friction.slipping.mean() < 1.0
    unreduced = LinearSolver(system.assembly, system.contact, model.bearing.bearing.setup.modulus)
    monkeypatch.setattr(system, "solver", unreduced)
    monkeypatch.setattr(system, "condensed", None)
    old = integrate(method, ring.stepped(), start, schedule)
    # Contacts balance at every evaluation: the first solution, and refinements by five digits.
    assert new.counts["evaluations"] <= 2 * 4
    moved = {name: np.abs(old.final.full_state[name] - start.full_state[name]).max() for name in ("u", "v", "a")}
    for name, size in moved.items():
        assert np.abs(new.final.full_state[name] - old.final.full_state[name]).max() < 1e-5 * size, name
    assert (
        np.abs(new.final.full_state["u"] - old.final.full_state["u"]).max() < 1e-7 * np.abs(old.final.full_state["u"]).max()
    )
    change = np.abs(old.contact_force - old.contact_force[0]).max()
    assert np.abs(new.contact_force - old.contact_force).max() < 1e-5 * change
    assert np.abs(new.contact_force - old.contact_force).max() < 1e-7 * old.contact_force.max()
