"""Whole runs under forces far below the preload: linear problems, whose Z is the tangent's."""

import pytest

import raceway as rw
from raceway import scene_from_dict

SPEED = 12000.0


def response(integrator, share, identifier="fft_1x", **changes):
    """A run under a force of ``share`` of the axial load."""
    tables = {
        "bearing": {"preset": "B7206C"},
        "load": {"axial": 400.0},
        "supports": {"tilt": "locked"},
        "kinematics": {"spin_speed_rpm": SPEED},
        "excitation": {"kind": "unidirectional", "amplitude": "constant", "force": 400.0 * share, "speed_rpm": SPEED},
        "integrator": {"kind": integrator},
        "identifier": {"kind": identifier},
    }
    for name, table in changes.items():
        tables[name] = {**tables.get(name, {}), **table}
    return rw.run(scene_from_dict(tables))


KINDS = [
    {},
    {"kinematics": {"ball_inertia": False}},
    {"kinematics": {"gyroscopic": "outer_race"}},
    {"load": {"radial": [300.0, 0.0]}},
]


@pytest.mark.parametrize("changes", KINDS)
@pytest.mark.parametrize("share", [1e-8, 1e-6, 1e-4])
def test_a_periodic_motion_under_a_small_force_has_the_tangents_answer(changes, share):
    """A motion of 2e-14 m on 2e-5 m is resolved to 1e-4 by rounding; its own estimate covers what it is off by."""
    run = response("periodic", share, **changes)
    tangent = response("periodic", share, "tangent", **changes)
    off = abs(run.identification.dynamic_stiffness / tangent.identification.dynamic_stiffness - 1.0)
    assert off < run.error["total"] + 5.0 * share**2
    assert run.error["total"] < max(1e-11 / share, 1e-7)


@pytest.mark.parametrize("integrator", ["newmark", "generalized_alpha"])
def test_steps_are_balanced_against_the_excitation(integrator):
    """The iteration of a step leaves a part of the force that drives it: a force of 1e-6 of the preload is no worse than one of 1e-3."""
    z = {share: response(integrator, share) for share in (1e-6, 1e-3)}
    small, large = (z[share].identification.dynamic_stiffness for share in z)
    assert abs(small / large - 1.0) < 1e-7
    tangent = response(integrator, 1e-6, "tangent").identification.dynamic_stiffness
    assert abs(small / tangent - 1.0) < 3.0 * z[1e-6].error["total"]
