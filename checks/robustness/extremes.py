"""Extreme scenes, of sets, rollers and heat, too: what is raised, and said of errors that are not estimated or larger than Z."""

import re
from collections.abc import Iterator
from contextlib import redirect_stdout
from io import StringIO
from itertools import islice

from rich.console import Console

from checks.robustness import Row, above, below
from checks.robustness._fuzz import refuse_nan
from checks.robustness._scenes import Chance, Tables, example
from raceway import RacewayError, Result, make_plan, scene_from_dict
from raceway.extend import run

#: Runs that finish, and the most steps and predicted processor time [s] of those that are tried.
RUNS, _STEPS, _SECONDS = 500, 3000, 3.0
_PARTS = ("total", "time_step", "transient", "identification", "mesh", "contact")
_OF_Z = ("equivalent stiffness K", "equivalent damping C", "|Z|")


def rows() -> list[Row]:
    """Rows of 500 runs."""
    silent, shown, hidden, unsaid, null, large = [], [], [], [], 0, 0
    raw: list[str] = []
    for seed, _, result in islice(finished(raw), RUNS):
        error, warnings = result.error, result.warnings
        try:
            refuse_nan(result)
        except (AssertionError, ValueError) as why:
            raw.append(f"scene {seed}: {why}")
        silent += [seed] if any(error[part] is None and not error["how"].get(part) for part in _PARTS) else []
        if error["total"] is None:
            null += 1
            # With its reason: more than that it is not known.
            said = [text for text in warnings if "error of Z is not estimated: " in text and len(text) > 60]
            silent += [] if said or any("error is not estimated, because" in text for text in warnings) else [seed]
        if any((error[part] or 0.0) >= 1.0 for part in _PARTS):
            large += 1
            numbers = _numbers(result)
            shown += [seed] if numbers else []
            unsaid += [] if any("Z is not resolved" in text for text in warnings) else [seed]
        elif large and not _numbers(result):
            hidden.append(seed)
    nulls = f"null totals without a warning and its reason, null parts without one, of {RUNS} extreme runs"
    told = f"{null} with a null total, {large} with a part of 1 or more"
    return [
        below("exceptions that are no message, and NaN in results", len(raw), 0, "; ".join(raw[:3])),
        below(nulls, len(silent), 0, f"{told} {silent[:5]}"),
        below("runs with a part of 1 or more without a warning", len(unsaid), 0, str(unsaid[:5])),
        below("runs with a part of 1 or more whose screen shows K, C or Z as a number", len(shown), 0, str(shown[:5])),
        below("runs without one whose screen shows none of them", len(hidden), 0, str(hidden[:5])),
        above("of the rarer of both kinds among them", min(null, large), 10, told),
    ]


def _numbers(result: Result) -> list[str]:
    """Names of the rows of the screen that show a part of Z as a number."""
    with redirect_stdout(StringIO()) as text:
        Console(width=200).print(result.screen())
    lines = [line for line in text.getvalue().splitlines() if line.strip().startswith(_OF_Z)]
    return [line for line in lines if re.search(r"  -?\d", line) and "not resolved" not in line]


def extreme(chance: Chance) -> Tables:
    """A scene at the edges of what rigid bearings are asked for: loads, speeds, clearances, balls, tilt, damping, laws, integrators."""
    axial = chance.decades(1.0, 1e5)
    bearing: Tables = {
        "ball_diameter": 9.525e-3, "pitch_diameter": 46e-3, "ball_count": chance.one(3, 5, 12, 14),
        "conformity_inner": chance.one(0.501, 0.522, 0.6), "conformity_outer": chance.one(0.501, 0.522, 0.6),
    }  # fmt: skip
    bearing |= (
        {"contact_angle_deg": chance.one(5.0, 15.0, 40.0)}
        if chance.happens(0.7)
        else {"radial_clearance": chance.decades(1e-6, 1e-4)}
    )
    law: Tables = {"kind": chance.one("hertz", "hertz", "penalty"), "friction": chance.one(0.0, 0.0, 0.0, 0.3, 1.0)}
    if law["kind"] == "penalty" and chance.happens(0.5):
        law["stiffness"] = chance.decades(1e12, 1e17)
    force = {
        "kind": chance.one("bidirectional", "unidirectional"),
        "speed_rpm": chance.decades(1.0, 2e5),
        "amplitude": "constant",
    }
    tables: Tables = {
        "bearing": bearing,
        "load": {"axial": axial, "radial": [axial * chance.one(0.0, 0.0, 1.0, 5.0, 50.0), 0.0]},
        "supports": {"tilt": chance.one("locked", "locked", "free", 1e4)},
        "rotor": {"mass": chance.decades(1e-2, 1e4), "transverse_inertia": chance.decades(1e-5, 1.0)},
        "contact": law | {"damping": chance.one(0.0, 1e-3, 300.0, 1e4)},
        "kinematics": {"ball_inertia": chance.happens(0.5), "orbiting": chance.happens(0.1)},
        "excitation": force | {"force": axial * chance.decades(1e-4, 3.0)},
        "integrator": {
            "kind": chance.one("newmark", "generalized_alpha", "central_difference", "quasi_static", "periodic"),
            "turns": chance.whole(1, 6), "steps_per_turn": chance.one(8, 24, 48, 96, "auto"),
            "start": chance.one("orbit", "ramp", "static"),
        },
        "identifier": {"kind": chance.one("fft_1x", "fft_1x", "sine_fit", "tangent")},
    }  # fmt: skip
    if chance.happens(0.1):
        first = force["speed_rpm"]
        speeds = [first, first * chance.one(1.001, 1.03, 1.2, 3.0)]
        tables["identifier"] = {"kind": "impedance_fit", "speeds_rpm": speeds}
    if chance.happens(0.3):
        tables["bearing"] = {
            "preset": chance.one("B7206C", "7008A5"), "arrangement": chance.one("DB", "DF", "TBT", "QBC"), "bore": 0.03, "width": 0.016,
            "preload": chance.decades(1.0, 1e5), "preload_kind": chance.one("rigid", "spring"),
        }  # fmt: skip
    elif chance.happens(0.4):
        rollers = example("cylindrical_rollers")
        tables |= {name: rollers[name] for name in ("bearing", "bodies", "supports")}
        tables["bearing"] |= {"radial_clearance": chance.decades(1e-7, 1e-3), "ball_count": chance.one(3, 13)}
        tables |= {
            "load": {"radial": [axial, chance.one(0.0, axial)]},
            "contact": {"kind": "line", "damping": chance.one(0.0, 300.0)},
        }
    if chance.happens(0.4):
        tables["bearing"] |= {"bore": 0.03, "outer_diameter": 0.062, "width": 0.016}
        tables["lubricant"] = {"oil": chance.one("VG 10", "VG 46", "VG 220")}
        tables["heat"] = {
            "oil_inlet_c": chance.between(0.0, 130.0), "oil_flow": chance.one("infinite", chance.decades(1e-9, 1e-2)),
            "ambient_c": chance.between(-50.0, 500.0), chance.one("inner_balls", "outer_oil"): chance.one("auto", "infinite", 1e-9, 1e9, 1e300),
        }  # fmt: skip
    return tables


def finished(raw: list[str], first: int = 0) -> Iterator[tuple[int, Tables, Result]]:
    """Seed, tables and result of every scene that is cheap enough and has an answer; what is raised and no message goes to ``raw``."""
    seed = first
    while True:
        tables = extreme(Chance(seed))
        seed += 1
        try:
            scene = scene_from_dict(tables)
            plan = make_plan(scene)
            if plan.predicted_steps > _STEPS or plan.predicted_work_s > _SECONDS:
                continue
            yield seed - 1, tables, run(scene)
        except RacewayError as error:
            raw += [f"scene {seed - 1}: {error}"] if {"nan", "nan,"} & set(str(error).split()) else []
        except Exception as error:
            raw.append(f"scene {seed - 1}: {error!r}")
