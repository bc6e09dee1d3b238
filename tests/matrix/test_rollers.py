"""Cylindrical rollers with every integrator and excitation.

Tolerances on Z against Newmark under the same force: 0.5 % for methods with inertia, as in ``test_matrix``.  A series of
equilibria has K of the load F0, not of F0 + m w^2 r: 3 %.
"""

import json
from functools import cache

import pytest

from checks.validation.scenes import built_in
from raceway import SceneError, scene_from_dict
from raceway.testing import default_registry, run
from tests.matrix.combinations import crossed, options

CylindricalRollers = built_in("bodies", "cylindrical_rollers")


@cache
def outcome(excitation, integrator):
    """The run's result, or its refusal."""
    registry = default_registry()
    identifier = "order_tracking" if excitation == "run_up" else "fft_1x"
    method = registry.find("integrator", integrator).plugin
    tables = CylindricalRollers.example_scene() | {
        # A small negative clearance: all rollers stay loaded, as K of small motions is compared.
        "kinematics": {"ball_inertia": True, "radial_expansion": 12e-6},
        "bodies": {"kind": "cylindrical_rollers", "roller_length": 9e-3},
        "rotor": {"mass": 2.0},
        "excitation": {"kind": excitation, **options("excitation", excitation)},
        "integrator": {"kind": integrator, "turns": 6, "steps_per_turn": 120 if method.implicit else "auto"},
        "identifier": {"kind": identifier, **options("identifier", identifier)},
    }
    try:
        return run(scene_from_dict(tables, registry), registry)
    except SceneError as refused:
        return refused


@pytest.mark.parametrize(("excitation", "integrator"), crossed())
def test_rollers_run_with_every_integrator_and_excitation(excitation, integrator):
    found = outcome(excitation, integrator)
    if isinstance(found, SceneError):
        # What no bodies run: a steady motion of a force that does not repeat.
        assert default_registry().find("integrator", integrator).plugin.steady and excitation == "run_up", str(found)
        return
    assert "NaN" not in json.dumps(found.to_dict(), allow_nan=False)
    inertial = default_registry().find("integrator", integrator).plugin.inertial
    now, usual = found.identification, outcome(excitation, "newmark").identification
    assert now.equivalent_stiffness > 0.0
    assert now.equivalent_stiffness == pytest.approx(usual.equivalent_stiffness, rel=0.005 if inertial else 0.03)
