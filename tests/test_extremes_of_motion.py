"""What a transient reports of its extremes: penetration, the stable limit of explicit steps, the turns that are used."""

import numpy as np
import pytest

from raceway import StabilityError, scene_from_dict
from raceway.testing import b7206c, run, simulate, solve_equilibrium

#: A force that lifts balls off and presses others with many times the preload.
HEAVY = {"kind": "bidirectional", "speed_rpm": 12000.0, "amplitude": "constant", "force": 1500.0}


def heavy(**tables):
    return b7206c(load={"axial": 100.0}, rotor={"mass": 2.0}, excitation=HEAVY, **tables)


def test_the_largest_penetration_is_hertz_s_approach_at_the_largest_load():
    result = run(scene_from_dict(heavy(integrator={"kind": "newmark", "turns": 2, "steps_per_turn": 180})))
    counts = result.simulation.whole.counts
    # The largest force and the largest approach belong to one contact: forces of both races of a weightless ball are equal,
    # and the softer race approaches more.
    softer = max(float(e.approach(counts["peak_contact_force_n"])) for e in (result.model.inner, result.model.outer))
    # Dashpots and centrifugal force set the forces of the two races apart by some newtons of 800.
    assert result.to_dict()["stability"]["max_penetration_m"] == pytest.approx(softer, rel=0.03)


def test_the_stable_limit_is_that_of_the_orbit_where_it_is_stiffer_than_the_equilibrium(built):
    model = built(**{k: v for k, v in heavy(integrator={"kind": "central_difference", "turns": 2}).items() if k != "title"})
    equilibrium = solve_equilibrium(model)
    at_rest = model.system.critical_time_step(equilibrium.stiffness)
    found = simulate(model, equilibrium)
    assert found.start.orbit is not None
    on_orbit = min(model.system.critical_time_step(tangent) for tangent in found.start.orbit.stiffness)
    # The loaded side has several times the stiffness of the equilibrium: Hertz's grows with the cube root of the load.
    assert on_orbit < 0.8 * at_rest
    assert found.critical_time_step == pytest.approx(on_orbit, rel=1e-12)
    between = int(np.ceil(model.excitation.period_s / np.sqrt(on_orbit * at_rest)))
    with pytest.raises(StabilityError, match="above the stable limit"):
        simulate(model, equilibrium, steps_per_turn=between, start=found.start)
    # "auto" stays below 0.8 of the limit and is silent; what stands above it is told.
    assert not any("of the stable limit" in text for text in found.warnings)
    just_below = int(np.ceil(model.excitation.period_s / (0.95 * on_orbit)))
    told = simulate(model, equilibrium, steps_per_turn=just_below, start=found.start).warnings
    assert any("0.9" in text and "of the stable limit" in text for text in told)


def test_a_sudden_start_uses_its_last_third(built):
    model = built(
        rotor={"mass": 2.0},
        excitation={**HEAVY, "force": 100.0},
        integrator={"kind": "newmark", "turns": 9, "start": "static"},
    )
    found = simulate(model, solve_equilibrium(model))
    period = model.excitation.period_s
    assert found.whole.time[-1] - found.record.time[0] <= (3.0 + 1e-6) * period
    assert found.record.time[-1] == pytest.approx(9.0 * period, rel=1e-9)
