"""Against the load zone of Sjovall and Harris, evaluated here without the program.

Each contact follows Palmgren, delta = 3.84e-5 Q^0.9 / L^0.8 in mm and N; both contacts of a roller make 2 delta.  With the
ring's displacement d_r and the clearance P_d, eps = (1 - P_d / (2 d_r)) / 2 and Q(psi) = Q_max [1 - (1 - cos psi) / (2 eps)]^(10/9)
(Harris, Rolling Bearing Analysis, 4th ed., 2001, chapter 7; Sjovall, The load distribution within ball and roller bearings
under given external radial and axial load, 1933).
"""

import numpy as np
import pytest
import raceway_cylindrical_rollers
from scipy.integrate import quad
from scipy.optimize import brentq

from raceway import SceneError, scene_from_dict
from raceway.bodies.model import build_model
from raceway.framework.registry import Registry
from raceway.pipeline.equilibrium import solve_equilibrium
from raceway.pipeline.run import run
from raceway.planning.plan import make_plan

N = 10.0 / 9.0
LENGTH, FORCE = 9e-3, 4000.0
REGISTRY = Registry(third_party=False)
REGISTRY.add(raceway_cylindrical_rollers)
TABLES = {
    name: table
    for name, table in raceway_cylindrical_rollers.CylindricalRollers.example_scene().items()
    if name not in ("excitation", "integrator")
} | {"bodies": {"kind": "cylindrical_rollers", "roller_length": LENGTH}, "load": {"radial": [FORCE, 0.0]}}
#: Many thin rollers, whose sum is near the integral.
MANY = {"ball_count": 100, "ball_diameter": 4e-3, "pitch_diameter": 0.2, "bore": 0.15}


def found(clearance=0.0, growth=0.0, force=FORCE, bearing=None, **tables):
    """Model and equilibrium; ``growth`` [m] of the inner raceway makes a clearance of ``clearance - 2 growth``."""
    changed = {**TABLES, "bearing": {**TABLES["bearing"], "radial_clearance": clearance, **(bearing or {})}, **tables}
    changed["kinematics"] = {"ball_inertia": False, "radial_expansion": growth, **tables.get("kinematics", {})}
    scene = scene_from_dict({**changed, "load": {"radial": [force, 0.0]}}, REGISTRY)
    model = build_model(scene)
    return model, solve_equilibrium(model)


def series(length=LENGTH):
    """K of Q = K delta^(10/9) [N/m^(10/9)] of both contacts of a roller."""
    per_load = 2.0 * 3.84e-5 / (1e3 * length) ** 0.8  # mm / N^0.9
    return (1e3 / per_load) ** N


def loads(shift, clearance, azimuth, length=LENGTH):
    return series(length) * np.maximum(shift * np.cos(azimuth) - 0.5 * clearance, 0.0) ** N


def load_integral(eps, n=N):
    """J_r(eps): integral of [1 - (1 - cos psi) / (2 eps)]^n cos psi over the load zone, over 2 pi."""
    edge = np.pi if eps >= 1.0 else np.arccos(1.0 - 2.0 * eps)
    return quad(lambda psi: max(1.0 - (1.0 - np.cos(psi)) / (2.0 * eps), 0.0) ** n * np.cos(psi), 0.0, edge)[0] / np.pi


def test_the_constant_is_harris_own():
    # Q = 8.06e4 L^(8/9) delta^(10/9) in mm and N, to its three digits.
    assert pytest.approx(8.06e4, rel=1e-3) == (1.0 / 3.84e-5) ** N


def test_the_load_integral_is_the_tabulated_one():
    # Harris' table for line contact at eps = 0.5 has four digits, and is that of n = 1.1.
    assert load_integral(0.5, 1.1) == pytest.approx(0.2453, abs=5e-5)
    assert load_integral(0.5) == pytest.approx(0.2453, rel=2.5e-3)


@pytest.mark.parametrize(("clearance", "growth"), [(0.0, 0.0), (20e-6, 0.0), (60e-6, 0.0), (0.0, 5e-6), (0.0, 15e-6)])
def test_loads_of_the_rollers_are_the_discrete_sum(clearance, growth):
    model, equilibrium = found(clearance, growth)
    gap, azimuth = clearance - 2.0 * growth, model.azimuth
    shift = brentq(lambda d: loads(d, gap, azimuth) @ np.cos(azimuth) - FORCE, 0.0, 1e-3, xtol=1e-18, rtol=1e-15)
    expected = loads(shift, gap, azimuth)
    # Both are solved to rounding: 1e-11 of the forces here.
    assert equilibrium.displacement[1] == pytest.approx(shift, rel=1e-9)
    for race in np.split(equilibrium.contact_force, 2):
        assert np.abs(race - expected).max() < 1e-9 * FORCE
    assert (equilibrium.contact_force[:13] > 0.0).sum() == (expected > 0.0).sum()


@pytest.mark.parametrize(("clearance", "growth"), [(0.0, 0.0), (10e-6, 0.0), (0.0, 2e-6), (0.0, 10e-6)])
def test_the_load_zone_is_sjovalls(clearance, growth):
    model, equilibrium = found(clearance, growth, bearing=MANY)
    gap, shift = clearance - 2.0 * growth, equilibrium.displacement[1]
    eps = 0.5 * (1.0 - gap / (2.0 * shift))
    inner = equilibrium.contact_force[:100]
    zone = np.maximum(1.0 - (1.0 - np.cos(model.azimuth)) / (2.0 * eps), 0.0) ** N
    assert np.abs(inner / inner.max() - zone).max() < 1e-9
    # A sum over a period with a kink of power n at the zone's edge: (2 pi / Z)^(n + 1) = 3e-3.
    assert 100 * inner.max() * load_integral(eps) == pytest.approx(FORCE, rel=3e-3)


def test_with_zero_clearance_the_most_loaded_roller_carries_four_times_the_mean():
    # Harris: Q_max = 4.08 F_r / Z at eps = 0.5.
    _, equilibrium = found(bearing=MANY)
    assert 100 * equilibrium.contact_force.max() / FORCE == pytest.approx(4.08, rel=5e-3)


@pytest.mark.parametrize("clearance", [0.0, 20e-6])
def test_the_stiffness_is_the_slope_of_the_force(clearance):
    _, middle = found(clearance)
    step = 1e-3 * FORCE
    low, high = (found(clearance, force=FORCE + sign * step)[1].displacement[1] for sign in (-1.0, 1.0))
    # The curvature of the force leaves 1e-6 of a difference over 1e-3.
    assert middle.stiffness[1, 1] == pytest.approx(2.0 * step / (high - low), rel=1e-5)
    assert np.abs(middle.stiffness[[0, 3, 4]]).max() == 0.0


def test_centrifugal_forces_load_the_outer_races_alone():
    speed = 15000.0
    model, equilibrium = found(20e-6, kinematics={"ball_inertia": True, "spin_speed_rpm": speed})
    mass = 7810.0 * 0.25 * np.pi * 9e-3**2 * LENGTH
    cage = 0.5 * speed * np.pi / 30.0 * (1.0 - 9.0 / 46.5)
    inner, outer = np.split(equilibrium.contact_force, 2)
    assert outer - inner == pytest.approx(np.full(13, mass * 0.5 * 46.5e-3 * cage**2), rel=1e-9)
    assert inner @ np.cos(model.azimuth) == pytest.approx(FORCE, rel=1e-9)


def test_pressures_are_hertz_line_contacts():
    model, _ = found()
    (pressure,), (along,), (across,) = model.bearing.contact_ellipse(model, 0, np.array([1000.0]))
    radius, modulus = 1.0 / (2.0 / 9e-3 + 2.0 / 37.5e-3), 212e9 / (2.0 * (1.0 - 0.29**2))
    assert pressure == pytest.approx(np.sqrt(1000.0 * modulus / (np.pi * radius * LENGTH)), rel=1e-12)
    assert pressure * np.pi * across * along == pytest.approx(1000.0, rel=1e-12)


@pytest.mark.parametrize(
    ("table", "keys", "path"),
    [
        ("supports", {"axial": "force"}, "supports.axial"),
        ("supports", {"axial": "displacement", "tilt": "free"}, "supports.tilt"),
        ("contact", {"kind": "hertz"}, "contact.kind"),
        ("contact", {"kind": "palmgren", "friction": 0.1}, "contact.friction"),
        ("kinematics", {"gyroscopic": "shared"}, "kinematics.gyroscopic"),
        ("load", {"axial": 100.0, "radial": [FORCE, 0.0]}, "load.axial"),
    ],
)
def test_what_rollers_cannot_do_is_refused_by_its_key(table, keys, path):
    with pytest.raises(SceneError, match=f"`{path}`"):
        make_plan(scene_from_dict({**TABLES, table: keys}, REGISTRY))


def test_a_run_says_whose_bodies_it_used():
    tables = {**raceway_cylindrical_rollers.CylindricalRollers.example_scene(), "bodies": TABLES["bodies"]}
    told = run(scene_from_dict(tables, REGISTRY), REGISTRY).to_dict()
    assert {p["name"]: p["distribution"] for p in told["environment"]["plugins"]}["cylindrical_rollers"].startswith(
        "raceway_cyl"
    )
    assert not [warning for warning in told["warnings"] if "loses axial contact" in warning or "groove" in warning]
