"""Oil films and damping."""

import time

import numpy as np
import pytest

from checks.validation.film import OIL, ROLLED, SPINDLE, rolled, scene, skf_reduction  # fmt: skip
from checks.validation.ross_rotor import in_ross
from checks.validation.scenes import built_in
from raceway import build_model, scene_from_dict
from raceway.core.contact.film import film, thermal_reduction
from raceway.extend import run, simulate, solve_equilibrium
from raceway.scene.lubricant import GRADES, Walther

Film = built_in("contact_law", "film")

pytestmark = pytest.mark.night

HERTZ = {"kind": "hertz"}


@pytest.mark.parametrize(("path", "printed", "misses"), [
    (*ROLLED[0], ""),
    (*ROLLED[1], "the exercise takes every contact for piezoviscous-elastic; this one is light and fast, isoviscous-rigid"),
])  # fmt: skip
def test_ball_on_a_plate(claim, path, printed, misses):
    value = 1e6 * float(film(**rolled(path)).minimum[0])
    quantity = f"h_min of a ball rolling down a plate, after {path:g} m"
    source = "printed exercise in the notation of Stachowiak and Batchelor; three decimals"
    within = 5e-4 / float(printed)
    claim(quantity, value, near=float(printed), within=within, unit="um", basis="published", source=source, misses=misses)


def test_heat_of_the_inlet_of_oils(claim):
    known = Film(viscosity=0.02784, temperature_viscosity=0.035, conductivity=0.14)
    factor = thermal_reduction(np.array(known.dynamic_viscosity * known.beta * 42.0**2 / known.conductivity))
    source = "worked example of the requirement"
    quantity = "thermal reduction at 42 m/s, beta 0.035 1/K, 0.14 W/m/K"
    claim(quantity, float(factor), near=0.45, within=0.02, basis="regression", source=source)
    away = 0.0
    for line in (Walther(*GRADES[oil]) for oil in ("VG 10", "VG 32", "VG 68", "VG 100")):
        for celsius in (40.0, 60.0, 80.0):
            for diameter in (5e-3, 15e-3, 50e-3, 100e-3):  # n d_m to 2e6 at 20 000 r/min
                speed = np.pi * diameter * 2e4 / 120.0  # of rolling at a small g
                loading = 870e-6 * line.viscosity(celsius) * line.thinning(celsius) * speed**2 / 0.14
                skf = skf_reduction(2e4, diameter, 1e-6 * line.viscosity(celsius))
                away = max(away, abs(float(thermal_reduction(np.array(loading))) - skf))
    quantity = "thermal reduction less SKF's, VG 10 to 100, 40 to 80 C, n d_m to 2e6: largest distance"
    source = "SKF's inlet factor of the friction moment, a fit for all bearings"
    claim(quantity, away, at_most=0.12, basis="published", source=source)
    pairs = []
    for law in (HERTZ, {**OIL, "inlet_heating": "none"}, OIL):
        one = run(scene_from_dict({"bearing": SPINDLE, "contact": law, "kinematics": {"spin_speed_rpm": 18000.0}}))
        pairs.append(one.to_dict()["equilibrium"]["preload"]["running_n"])
    dry, cold, hot = pairs
    claim(
        "DB of 7014C, 300 N, 18 000 r/min, VG 32: part of an isothermal film's gain of preload that the inlet's heat takes",
        (cold - hot) / (cold - dry),
        near=0.5,
        within=0.2,
        basis="regression",
        source="the requirement's estimate, 'about half', at beta = 0.035 1/K, where it is 0.61",
        misses="beta is the slope of the oil's own line, 0.043 1/K",
    )


def test_decrement_of_a_rotor(claim):
    band = run(scene({**HERTZ, "damping": "band"})).band
    ends = list(zip(band["equivalent_stiffness"], band["equivalent_damping"], strict=True))
    values = [value for one in in_ross("decrements", ends) for value in one]
    quantity = "logarithmic decrement of the rig's rotor in ROSS, damping = 'band'"
    source = "c = tau k of rolling bearings on ROSS's closed formula, 87 and 136 N/um: 8e-4 to 1.3e-2"
    misses = "K of 235 N/um, tilt locked, is stiffer: it takes a smaller part of the motion, and damps less at the same tau"
    claim(f"{quantity}: least", min(values), at_least=8e-4, basis="other program", source=source, misses=misses)
    claim(f"{quantity}: largest", max(values), at_most=1.3e-2, basis="other program", source=source)


def test_cost(claim):
    """By turns in one run, the least of each."""
    ratios, laws = [], (HERTZ, OIL, {**OIL, "time_constant": 1.25e-5})
    for inertia in (False, True):
        ready, spent = [], [[], [], []]
        for law in laws:
            one = scene(law, integrator={"turns": 40, "steps_per_turn": 360}, kinematics={"ball_inertia": inertia})
            model = build_model(one)
            ready.append((model, solve_equilibrium(model)))
        for _ in range(9):
            for (model, still), times in zip(ready, spent, strict=True):
                begun = time.process_time()
                simulate(model, still)
                times.append(time.process_time() - begun)
        dry, *wet = map(min, spent)
        ratios += [one / dry for one in wet]
    quantity = "processor time of steps with a film, with and without c = tau k, over that of law hertz: largest"
    claim(quantity, max(ratios), at_most=1.5, basis="regression", source="a film is a power of the load, taken once a step")
