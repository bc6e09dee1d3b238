"""Tangent responses of damped contacts, balls condensed out at the frequency of the motion; the sentence on a dry bearing's damping."""

import numpy as np
import pytest

import raceway as rw
from raceway.answers.quantities import RULE_OF_THUMB_S, dry_damping_note
from raceway.extend import dry_damping_words, layout
from raceway.testing import settled

SPEED = 24000.0
#: Force of whole runs over the axial load: Z of an orbit is off by its square, 6e-8, and by what the run claims, 1e-8.
SMALL = 2.5e-4


def tables(identifier, contact, **changes):
    found = {
        "bearing": {"preset": "B7206C"}, "load": {"axial": 400.0}, "supports": {"tilt": "locked"},
        "contact": contact,
        "kinematics": {"spin_speed_rpm": SPEED, "gyroscopic": "none", "ring_growth": False},
        "excitation": {"kind": "bidirectional", "amplitude": "constant", "force": 400.0 * SMALL, "speed_rpm": SPEED},
        "integrator": {"kind": "periodic"}, "identifier": {"kind": identifier},
    }  # fmt: skip
    for name, table in changes.items():
        found[name] = {**found.get(name, {}), **table}
    return found


def complex_condensation(system, equilibrium, w):
    """S(j w) of rigid balls with Hertz contacts, by complex arithmetic ball by ball."""
    centre, direction = system.centre_vectors(equilibrium.displacement, ball=equilibrium.ball)
    out, count = np.zeros((5, 5), dtype=complex), system.ball_count
    for k in range(count):
        contacts = []
        reaches = (centre[k] - equilibrium.ball[k, :2], equilibrium.ball[k, :2])
        for reach, c in zip(reaches, (k, count + k), strict=True):
            force, length = equilibrium.contact_force[c], np.linalg.norm(reach)
            stiffness = 1.5 * force / -equilibrium.gap[c] if force > 0.0 else 0.0
            dashpot = stiffness * system.scalars[layout.TIME_CONSTANT] + (force > 0.0) * system.scalars[layout.DAMPING]
            along = np.outer(reach, reach) / length**2
            contacts.append((stiffness + 1j * w * dashpot) * along + force / length * (np.eye(2) - along))
        inner, outer = contacts
        (c, s), (side, lever) = direction[k], system.table[k, [layout.SIDE, layout.LEVER]]
        arm = system.scalars[layout.TILT_ARM]
        move = np.array([[side, 0.0, 0.0, side * arm * s, -side * arm * c], [0.0, c, s, -lever * s, lever * c]])
        out += move.T @ (inner - inner @ np.linalg.solve(inner + outer, inner)) @ move
    return out


@pytest.mark.parametrize(("contact", "limit"), [
    ({"time_constant": 1e-6}, 1e-12), ({"time_constant": 2e-4}, 1e-11), ({"damping": 3e3}, 1e-10),
    ({"damping": 1e5}, 1e-8),
])  # fmt: skip
@pytest.mark.parametrize("load", [{"axial": 400.0}, {"axial": 400.0, "radial": [900.0, 200.0]}])
def test_stiffness_at_a_frequency_equals_complex_arithmetic(contact, load, limit):
    """Continued from real rates, against every ball condensed at j w; rounding grows with w c / k: 3 at 1e5 N s/m."""
    model, equilibrium = settled(tables("tangent", contact, load=load))
    for w in (0.1, 300.0, 2.0 * np.pi * SPEED / 60.0):
        found = model.system.viscous_stiffness_at(equilibrium.displacement, equilibrium.ball, w)
        wanted = complex_condensation(model.system, equilibrium, w)
        size = np.sqrt(np.abs(np.diag(wanted)))
        assert np.abs((equilibrium.stiffness + found - wanted) / np.outer(size, size)).max() < limit
        assert model.system.viscous_stiffness_at(equilibrium.displacement, equilibrium.ball, -w) == pytest.approx(
            found.conj()
        )


def test_slow_motions_have_the_damping_of_the_equilibrium():
    """C of the equilibrium is the limit of slow motions: what is left falls with w^2."""
    model, equilibrium = settled(tables("tangent", {"time_constant": 1e-4}))
    off = []
    for w in (2000.0, 1000.0):
        found = model.system.viscous_stiffness_at(equilibrium.displacement, equilibrium.ball, w)
        off.append(abs(found.imag[1, 1] / w / equilibrium.damping[1, 1] - 1.0))
    assert 1e-4 < off[1] < 0.3 * off[0] < 0.01


CASES = [
    ({"time_constant": 1e-4}, {}),
    ({"time_constant": 1e-4}, {"kinematics": {"ball_inertia": False}}),
    ({"time_constant": 1e-4}, {"kinematics": {"gyroscopic": "outer_race"}}),
    ({"time_constant": 1e-4}, {"kinematics": {"gyroscopic": "traction"}}),
    ({"time_constant": 1e-4}, {"kinematics": {"orbiting": True}}),
    ({"time_constant": 1e-4}, {"supports": {"tilt": "free"}}),
    ({"time_constant": 1e-4}, {"supports": {"tilt": "free"}, "kinematics": {"gyroscopic": "traction"}}),
    pytest.param({"time_constant": 1e-4}, {"bodies": {"kind": "condensed"}}, marks=pytest.mark.slow),
    ({"damping": 3000.0}, {"load": {"radial": [300.0, 0.0]}}),
]


@pytest.mark.parametrize(("contact", "changes"), CASES)
def test_tangent_response_is_the_limit_of_whole_runs(contact, changes):
    """K and C under a small force against the periodic motion, which solves ring and balls in time."""
    run = rw.run(tables("fft_1x", contact, **changes))
    tangent = rw.run(tables("tangent", contact, **changes)).identification
    error = abs(tangent.dynamic_stiffness / run.identification.dynamic_stiffness - 1.0)
    assert error < 3.0 * SMALL**2 + 3.0 * run.error["total"]


def content(damping, error):
    found = {"equivalent_damping": damping, "equivalent_damping_error": error, "equivalent_stiffness": 235e6}
    return {"identification": found}


def test_a_dry_bearing_is_told_beside_the_rule_of_thumb():
    told = dry_damping_note(content(2.6e-3, 1e-4))
    assert "0.0026 N s/m" in told
    # 1.25e-5 s times 235 N/um
    assert pytest.approx(2937.5) == RULE_OF_THUMB_S * 235e6
    assert "2.9e+03 N s/m" in told
    assert "contact.damping" in told


def test_noise_is_no_number():
    told = dry_damping_note(content(2.6e-3, 1e-2))
    assert "not resolved" in told
    assert "0.0026" not in told


def test_a_damping_that_counts_is_not_told():
    assert dry_damping_note(content(500.0, 1.0)) is None
    assert dry_damping_words(500.0, 235e6) is None


def test_a_static_scene_has_no_damping_to_tell_of():
    assert dry_damping_note({"identification": None}) is None
