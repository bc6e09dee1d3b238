"""Oil films and damping: against formulas and numbers by hand, their effect on a bearing, and what they cost."""

from __future__ import annotations

import json
import os
import subprocess
import time
from typing import Any

import numpy as np

import raceway as rw
from benchmarks.evidence import Row, below
from benchmarks.evidence.ross import ROOT, interpreters
from raceway.core.contact.film import REGIMES, film, thermal_reduction
from raceway.pipeline.run import run
from raceway.pipeline.settle import settle
from raceway.pipeline.simulate import simulate
from raceway.planning.plan import make_plan
from raceway.scene.tables import TIME_CONSTANTS
from validation.film import (
    OIL,
    ROLLED,
    inlet_film,
    motion,
    pair,
    preload_by_hand,
    regimes,
    rolled,
    rolled_by_regime,
    scene,
    springs,
)

TITLE = "Oil films and damping"
COMMAND = "python -m benchmarks.evidence film"
_SPEEDS = (1000.0, 5000.0, 10000.0, 15000.0)
_ORDERS = ("newmark", "generalized_alpha", "central_difference")
#: Logarithmic decrement of the rotor of the documents between the ends of the rule c = tau k of rolling bearings.
_DECREMENT = (8e-4, 1.3e-2)


def rows() -> list[Row]:
    return [*_formulas(), *_limits(), *_effect(), *_damping(), *_decrement(), *_energy(), *_order(), *_cost()]


def _formulas() -> list[Row]:
    rng = np.random.default_rng(22)
    n = 1000
    along, across = 10.0 ** rng.uniform(-3.0, -1.0, n), 10.0 ** rng.uniform(-2.0, 0.0, n)
    modulus, load, k = 10.0 ** rng.uniform(7.0, 11.5, n), 10.0 ** rng.uniform(-1.0, 4.0, n), rng.uniform(1.0, 10.0, n)
    viscous, alpha = 10.0 ** rng.uniform(-4.0, 1.0, n), 2e-8
    found = film(viscous, alpha, modulus, along, across, load, k)
    off, met = [0.0, 0.0], set()
    for i in range(n):
        each = regimes(viscous[i] / (modulus[i] * along[i]), alpha * modulus[i], load[i] / (modulus[i] * along[i] ** 2), k[i], across[i] / along[i])  # fmt: skip
        best = max(range(4), key=lambda one: each[one][1])
        met.add(REGIMES[best])
        for place, value in enumerate((found.central[i], found.minimum[i])):
            off[place] = max(off[place], abs(value / (each[best][place] * along[i]) - 1.0))
    note = f"regimes met: {', '.join(sorted(met))}"
    result = [
        below(f"{name} of {n} random contacts against the formulas written out, relative", value, 1e-12, COMMAND, note)
        for name, value in zip(("h_c", "h_min"), off, strict=True)
    ]
    return [*result, *_published()]


def _published() -> list[Row]:
    """A steel ball that rolls down a plate: the law against printed answers; and the heat of the inlet against its equations."""
    result = []
    for path, answer in ROLLED:
        found = film(**rolled(path))
        value, name = 1e6 * float(found.minimum[0]), f"h_min of the law, a ball rolling down a plate, after {path:g} m [µm]"
        note = (
            f"the law's regime is {REGIMES[found.regime[0]]}; the exercise, of a tribology course in the notation of Stachowiak and "
            f"Batchelor, takes piezoviscous-elastic without asking, of which the formula gives {rolled_by_regime(path)[0]:.3f}"
        )
        result.append(Row(name, value, f"{answer}, as printed", f"{value:.3f}" == answer, COMMAND, note))
    note = "both of Wilson and Sheu's print: Murch and Wilson's fit; Grubin's inlet with the heat of shear, integrated here"
    for loading in (0.1, 1.0, 10.0, 100.0):
        off = abs(float(thermal_reduction(np.array(loading))) / inlet_film(loading) - 1.0)
        result.append(
            below(f"thermal reduction at L = {loading:g} against the integrated inlet, relative", off, 0.15, COMMAND, note)
        )
    return result


def _limits() -> list[Row]:
    """Without viscosity or speed a film is the dry law."""
    result = []
    for name, contact, spin in (
        ("viscosity 1e-30 Pa s", {"kind": "film", "viscosity": 1e-30}, 12000.0),
        ("speed 1e-15 r/min", {"kind": "film", "viscosity": 0.03}, 1e-15),
    ):
        tables = {"kinematics": {"spin_speed_rpm": spin}, "load": {"radial": [200.0, 0.0]}}
        wet, dry = (run(scene(law, **tables)) for law in (contact, {"kind": "hertz"}))
        moved = float(np.abs(wet.displacement - dry.displacement).max() / np.abs(dry.displacement).max())
        stiff = abs(_k(wet) / _k(dry) - 1.0)
        result.append(below(f"{name}: displacement against law hertz, relative", moved, 1e-12, COMMAND))
        result.append(below(f"{name}: K against law hertz, relative", stiff, 1e-9, COMMAND))
    return result


def _k(result: rw.Result) -> float:
    assert result.equivalent_stiffness is not None, "no static scene here"
    return result.equivalent_stiffness


def _effect() -> list[Row]:
    """B7206C in a DB pair with 1 kN of preload, VG 32 at 40 C, composite roughness 0.1 µm."""
    result = []
    for kind in ("rigid", "spring"):
        for speed in _SPEEDS:
            wet, dry = (run(pair(law, kind, speed)) for law in (OIL, {"kind": "hertz"}))
            found = wet.to_dict()["equilibrium"]
            ball, running = found["balls"][0], found["preload"]["running_n"]
            films = tuple(ball[f"{race}_film_central_m"] for race in ("inner", "outer"))
            told = (
                f"preload {running:.0f} N (dry {dry.to_dict()['equilibrium']['preload']['running_n']:.0f}), "
                f"K {1e-6 * _k(wet):.1f} N/µm (dry {1e-6 * _k(dry):.1f}), h_c {1e6 * films[0]:.3f} and {1e6 * films[1]:.3f} µm, "
                f"Lambda {ball['inner_film_parameter']:.2g}"
            )
            name = f"DB pair of B7206C, {kind} preload of 1 kN, VG 32 at 40 C, {speed:g} r/min"
            result.append(Row(name, told, "reported", True, COMMAND, "inner and outer race; roughness 0.1 µm"))
            if kind == "rigid":
                basis = wet.model.basis
                hand = preload_by_hand(1000.0, (basis.inner.factor, basis.outer.factor), films)
                off = abs((running - 1000.0) / (hand - 1000.0) - 1.0)
                note = f"by hand {hand:.1f} N: films in series with Hertz, balls without mass"
                result.append(below(f"{name}: gain of preload against the hand's, relative", off, 0.02, COMMAND, note))
    return result


def _damping() -> list[Row]:
    """C of a small force that turns, tilt locked, against tau times the springs' stiffness."""
    result = []
    for law in ({"kind": "hertz"}, OIL):
        for tau in TIME_CONSTANTS:
            found = run(scene({**law, "time_constant": tau}, kinematics={"ball_inertia": False}))
            wanted = tau * springs(found.model, found.equilibrium)
            name = f"C against tau k in closed form, law {law['kind']}, tau {tau:g} s, relative"
            result.append(below(name, abs(float(found.equivalent_damping or 0.0) / wanted - 1.0), 0.01, COMMAND))
    factor = run(scene({"kind": "hertz", "loss_factor": 0.01}, kinematics={"ball_inertia": False}))
    assert factor.dynamic_stiffness is not None, "no static scene here"
    value = factor.dynamic_stiffness.imag / springs(factor.model, factor.equilibrium)
    result.append(below("loss factor 0.01: w C / k of the springs, relative", abs(value / 0.01 - 1.0), 0.01, COMMAND))
    return result


_ROTOR = """
import json, sys
from benchmarks.evidence._ross_rotor import rig_rotor
from raceway.studies.ross.installed import ross as installed
ross = installed("this report")
told = []
for k, c in json.loads(sys.argv[1]):
    rotor = rig_rotor(ross, lambda node: ross.BearingElement(n=node, kxx=k, cxx=c, kzz=1e8))
    modal = rotor.run_modal(12000.0 * 3.141592653589793 / 30.0)
    told.append([float(one) for one in modal.log_dec[:2]])
print(json.dumps(told))
"""


def _decrement() -> list[Row]:
    """Of the rig's rotor in ROSS on our bearings, at both ends of the band."""
    name, found = "logarithmic decrement of the rig's rotor in ROSS, ends of damping = 'band'", interpreters()
    if not found:
        note = "extra ross absent: name an interpreter that has it in RACEWAY_ROSS_PYTHON"
        return [Row(name, "not run", f"within {_DECREMENT[0]:g} to {_DECREMENT[1]:g}", False, COMMAND, note)]
    band = run(scene({"kind": "hertz", "damping": "band"})).band
    assert band is not None, "asked for"
    ends = json.dumps(list(zip(band["equivalent_stiffness"], band["equivalent_damping"], strict=True)))
    done = subprocess.run(
        [found[0], "-c", _ROTOR, ends],
        env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, text=True, check=True, timeout=600,
    )  # fmt: skip
    told: Any = json.loads(done.stdout.strip().splitlines()[-1])
    values = [value for end in told for value in end]
    ok = min(values) >= _DECREMENT[0] and max(values) <= _DECREMENT[1]
    note = (
        f"K {1e-6 * band['equivalent_stiffness'][0]:.0f} N/µm, tilt locked, is stiffer than the 87 and 136 N/µm of ROSS's closed formula, on "
        "which the band of decrements rests: a stiffer bearing takes a smaller part of the motion, and damps less at the same tau; "
    )
    note += f"C {band['equivalent_damping'][0]:.0f} and {band['equivalent_damping'][1]:.0f} N s/m at both bearings; backward and forward whirl"
    words = "; ".join(", ".join(f"{value:.2e}" for value in end) for end in told)
    return [Row(name, words, f"within {_DECREMENT[0]:g} to {_DECREMENT[1]:g}", ok, COMMAND, note)]


def _energy() -> list[Row]:
    """Drift of the energy balance, with the losses in the contacts."""
    result = []
    for kind in _ORDERS:
        drifts = []
        for contact in ({}, {"time_constant": TIME_CONSTANTS[0]}, {"time_constant": TIME_CONSTANTS[1]}):
            turning = {"excitation": {"force": 200.0}, "kinematics": {"ball_inertia": False}}
            method = {"kind": kind, "steps_per_turn": 2000, "turns": 6}
            found = run(scene({"kind": "hertz", **contact}, integrator=method, rotor={"mass": 2.0}, **turning))
            drifts.append(float(found.stability["energy_drift"]))
        worst = max(drifts[1:])
        name = f"{kind}: drift of the energy balance with c = tau k"
        note = f"without damping {drifts[0]:.1e}; what is left is quadrature: the losses are integrated from recorded samples of the gap"
        result.append(below(name, worst, max(2.0 * drifts[0], 1e-4), COMMAND, note))
    return result


def _order() -> list[Row]:
    """Slope of the error over four halvings of the step, against sixteen times finer steps of the same method."""
    result, counts = [], [360, 720, 1440, 2880]
    for law in ({"kind": "hertz"}, OIL):
        for kind in _ORDERS:
            contact = {**law, "time_constant": TIME_CONSTANTS[0]}
            finest = motion(kind, contact, 16 * counts[-1], 90)
            errors = [np.abs(motion(kind, contact, count, 90) - finest).max() for count in counts]
            slope = -float(np.polyfit(np.log(counts), np.log(errors), 1)[0])
            name = f"order of {kind} with law {law['kind']}, tau {TIME_CONSTANTS[0]:g} s"
            result.append(Row(name, slope, "2 within 0.1", abs(slope - 2.0) <= 0.1, COMMAND))
    return result


def _cost() -> list[Row]:
    """Processor time of a step over that with law hertz, by turns in one run, the least of each."""
    laws = {"film": OIL, "film with c = tau k": {**OIL, "time_constant": 1.25e-5}, "hertz": {"kind": "hertz"}}
    result = []
    for inertia in (False, True):
        least = dict.fromkeys(laws, np.inf)
        ready = {}
        for name, law in laws.items():
            one = scene(law, integrator={"turns": 40, "steps_per_turn": 360}, kinematics={"ball_inertia": inertia})
            model = rw.build_model(one, make_plan(one))
            ready[name] = model, settle(model)
        for _ in range(9):
            for name, (model, still) in ready.items():
                begun = time.process_time()
                simulate(model, still)
                least[name] = min(least[name], time.process_time() - begun)
        balls = "with centrifugal force" if inertia else "weightless"
        for name in list(laws)[:2]:
            told = f"time of 14400 steps, {name} over hertz, balls {balls}"
            result.append(below(told, least[name] / least["hertz"], 1.5, COMMAND))
    return result
