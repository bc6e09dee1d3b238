"""Energy of recorded motions: what is put in is kept or lost in dampers."""

import attrs
import numpy as np
import pytest

from checks.validation.scenes import rotating
from raceway.core.ring.energy import cumulative_integral
from raceway.extend import energy_balance, stored_energy
from raceway.testing import model_of, simulate, solve_equilibrium


def drift(integrator: str, steps: int, damping: float = 0.0, inertia: bool = False, law: str = "hertz") -> float:
    tables = rotating(1000.0, "locked", 12000.0, inertia, integrator)
    tables["contact"] = {"kind": law, "damping": damping}
    tables["rotor"]["damping"] = 100.0 * damping
    tables["integrator"] = {"kind": integrator, "turns": 2, "steps_per_turn": steps, "start": "static"}
    model = model_of(tables)
    return energy_balance(model.system, simulate(model, solve_equilibrium(model)).whole).drift


@pytest.mark.parametrize("inertia", [False, True])
@pytest.mark.parametrize("integrator", ["newmark", "central_difference"])
def test_drift_falls_with_the_square_of_the_step(integrator, inertia):
    coarse, fine = (drift(integrator, steps, inertia=inertia) for steps in (720, 1440))
    assert fine < 5e-3
    assert coarse / fine == pytest.approx(4.0, rel=0.25)  # not yet asymptotic at 720 steps


def test_penalty_law_keeps_energy_too():
    assert drift("newmark", 1440, law="penalty") < 5e-3


def test_losses_in_dampers_balance():
    """With damped contacts and a damped rotor the balance closes to the step's error."""
    coarse, fine = (drift("newmark", steps, damping=100.0) for steps in (720, 1440))
    assert fine < 5e-3 and coarse > 2.0 * fine


def test_losses_in_contacts_do_not_depend_on_how_the_record_lies_in_memory():
    """c = tau k, of a record whose columns lie apart, as those of a long run do."""
    tables = rotating(1000.0, "locked", 12000.0, False, "newmark")
    tables["contact"] = {"kind": "hertz", "time_constant": 1e-5}
    tables["integrator"] = {"kind": "newmark", "turns": 2, "steps_per_turn": 360, "start": "static"}
    model = model_of(tables)
    record = simulate(model, solve_equilibrium(model)).whole
    apart = attrs.evolve(record, gap=np.asfortranarray(record.gap), contact_force=np.asfortranarray(record.contact_force))
    one, other = (energy_balance(model.system, each) for each in (record, apart))
    assert np.array_equal(one.losses, other.losses) and one.losses[-1] > 0.0


def test_the_shaft_s_springs_store_half_k_theta_squared():
    """Tilts against a shaft of 20 kN m/rad: the balance closes as with locked tilts."""
    tables = rotating(1000.0, 2e4, 12000.0, False, "newmark")
    tables["integrator"] = {"kind": "newmark", "turns": 2, "steps_per_turn": 1440, "start": "static"}
    model = model_of(tables)
    balance = energy_balance(model.system, simulate(model, solve_equilibrium(model)).whole)
    assert balance.drift < 5e-3


def test_stored_energy_is_the_integral_of_the_law(built):
    """Hertz: 2/5 K delta^2.5; penalty: 1/3 c delta^3."""
    for kind, exponent in (("hertz", 1.5), ("penalty", 2.0)):
        system = built(contact={"kind": kind}).system
        gap = -np.linspace(-1e-6, 2e-5, 24)
        energy = np.empty(24)
        stored_energy(
            system.law, system.law_params, system.law_state, system.law_state.copy(), gap, np.empty((6, 24)), energy
        )
        wanted = system.law_params[:, 0] * np.maximum(-gap, 0.0) ** (exponent + 1.0) / (exponent + 1.0)
        assert energy == pytest.approx(wanted, rel=1e-12, abs=0.0)


def test_cumulative_integral_is_of_fourth_order():
    errors = []
    for n in (41, 81):
        t = np.linspace(0.0, 2.0, n)
        errors.append(np.abs(cumulative_integral(np.cos(3.0 * t), t[1]) - np.sin(3.0 * t) / 3.0).max())
    assert errors[0] / errors[1] > 12.0  # 16 inside, the ends are of third order locally
