"""Bearings that are loose, lifted, unseated or overloaded, and numbers in another unit: what a run warns of, and that it warns of nothing else."""

from __future__ import annotations

import re
from math import pi

from benchmarks.checks._scenes import Tables
from benchmarks.evidence import Row, below, near
from raceway import run
from raceway.errors import SceneError
from raceway.scene.reading import scene_from_dict

_SET = {"preset": "7014C", "arrangement": "DB", "preload": 500.0}
_PAIR = {"preset": "B7206C", "arrangement": "DB", "preload": 300.0}
_FAST = {"ring_growth": True, "spin_speed_rpm": 20000.0}
_COMMAND = "python -m benchmarks.meaning limits"
#: Words that each warning of these begins with or holds, beside which no sane scene has any.
_WORDS = (
    "loose on its shaft",
    "lifts off",
    "unseats",
    "contact pressure",
    "is more than",
    "not resolved",
    "error of Z is",
    "off Hertz's",
)
#: Bearings and, over Z D^2 12 MPa (about the static rating), axial and radial loads that machines run at; of sets the preload is 2 %.
_BEARINGS = ("7001C", "7005A", "7008C", "7014A", "7020C", "7206A", "7216A", "7230C", "B7206C")
_LOADS = ((0.03, 0.0, 3e5), (0.03, 0.02, 1e5), (0.1, 0.1, 1e5), (0.02, 0.05, 0.0))


def rows() -> list[Row]:
    """The rows of report meaning."""
    return [*_loose(), *_seats(), *_loads(), *_units(), _false_alarms(), *_speeds()]


def _warned(tables: Tables, words: str) -> str:
    return next((text for text in run(tables).warnings if words in text), "")


def _number(text: str, before: str) -> float:
    """The number that stands before these words; 0 where the warning is missing."""
    match = re.search(rf"([-\d.]+) {re.escape(before)}", text)
    return float(match[1]) if match else 0.0


def _loose() -> list[Row]:
    found, kyy = [], []
    # Annuli in plane stress under their own centrifugal force (Timoshenko & Goodier, section 32): ring from bore to land, solid shaft.
    b = scene_from_dict({"bearing": _SET, "load": {"axial": 1.0}}).bearing
    inside, land, steel = 0.5 * b.bore, 0.5 * (b.pitch_diameter - b.ball_diameter) + 0.2 * b.ball_diameter, b.rings
    factor = steel.density * (20000.0 * pi / 30.0) ** 2 * inside / (4.0 * steel.young)
    ring = factor * ((1.0 - steel.poisson) * inside**2 + (3.0 + steel.poisson) * land**2)
    lost = 2e6 * (ring - factor * (1.0 - steel.poisson) * inside**2)
    for fit, before in ((0.0, "nothing said, kyy 892 N/µm"), (1e-6, "refused"), (5e-6, "refused")):
        result = run({"bearing": _SET, "kinematics": _FAST, "mounting": {"shaft_interference": fit}})
        text = next((one for one in result.warnings if "loose on its shaft" in one), "")
        kyy.append(result.stiffness[1, 1])
        what = f"7014C DB, 20 000 r/min, {1e6 * fit:g} µm of interference: loose by [µm]"
        found.append(near(what, _number(text, "µm, on the diameter"), lost - 1e6 * fit, 5e-3, _COMMAND, f"before: {before}"))
    spread = max(kyy) / min(kyy) - 1.0
    return [*found, below("the same three: spread of kyy", float(spread), 1e-12, _COMMAND, f"{1e-6 * kyy[0]:.1f} N/µm")]


def _seats() -> list[Row]:
    lifted = [
        bool(_warned({"bearing": _PAIR, "load": {"axial": force}}, f"row {row} lifts off"))
        for force, row in ((3e3, 2), (-3e3, 1))
    ]
    found = [
        near("rows of a DB of 300 N told to lift off under 3000 and -3000 N", sum(lifted), 2, 0.0, _COMMAND, "before: 0")
    ]
    for axial in (0.0, 1.0, 100.0):
        text = _warned(
            {"bearing": {"preset": "B7206C"}, "load": {"axial": axial, "radial": [2000.0, 0.0]}}, "the bearing unseats"
        )
        what = f"B7206C, 2000 N radial, {axial:g} N axial: warnings that it unseats"
        found.append(near(what, bool(text), 1, 0.0, _COMMAND, f"{text[:75]}; before: none"))
    return found


def _loads() -> list[Row]:
    found = []
    for axial, before in ((5e4, "none of it"), (1e6, "none of it")):
        result = run({"bearing": {"preset": "B7206C"}, "load": {"axial": axial}})
        text = next((one for one in result.warnings if "contact pressure" in one), "")
        # Hertz by itself: 1.5 Q / (pi a b) from the ball's load and semi-axes.
        ball = result.to_dict()["equilibrium"]["balls"][0]
        hertz = 1.5e-6 * ball["load_inner_n"] / (pi * ball["semi_major_inner_m"] * ball["semi_minor_inner_m"])
        what = f"B7206C, {axial:g} N axial: pressure that is told [MPa]"
        found.append(near(what, _number(text, "MPa on the inner race"), hertz, 1e-3, _COMMAND, f"before: {before}"))
    return found


def _units() -> list[Row]:
    cases: tuple[tuple[str, Tables, str], ...] = (
        ("friction 1.5", {"contact": {"friction": 1.5}}, "`contact.friction` = 1.5 is more than"),
        ("rotor of 1e6 kg", {"rotor": {"mass": 1e6}}, "`rotor.mass` = 1e+06 kg is more than"),
    )
    base: Tables = {"bearing": {"preset": "B7206C"}, "load": {"axial": 300.0}}
    return [
        near(f"{name}: warnings", bool(_warned(base | more, words)), 1, 0.0, _COMMAND, "before: 0")
        for name, more, words in cases
    ]


def _false_alarms() -> Row:
    """Warnings of these kinds on scenes that nothing is wrong with."""
    count, alarms = 0, list[str]()
    for name in _BEARINGS:
        own = scene_from_dict({"bearing": {"preset": name}, "load": {"axial": 1.0}}).bearing
        rating = 12e6 * own.ball_count * own.ball_diameter**2
        for arrangement in ("single", "DB", "TBT"):
            bearing: Tables = {"preset": name, "arrangement": arrangement}
            bearing |= {} if arrangement == "single" else {"preload": 0.02 * rating}
            for axial, radial, ndm in _LOADS:
                load = {"axial": axial * rating, "radial": [radial * rating, 0.0]}
                spin = {"spin_speed_rpm": ndm / (1e3 * own.pitch_diameter)}
                said = run({"bearing": bearing, "load": load, "kinematics": spin}).warnings
                count, alarms = count + 1, alarms + [text for text in said if any(word in text for word in _WORDS)]
    return below(
        f"such warnings on {count} scenes with usual loads, speeds and preloads",
        len(alarms),
        0,
        _COMMAND,
        "; ".join(alarms[:2]),
    )


def _speeds() -> list[Row]:
    """Speeds of a fit, a share apart: refused below 5 %."""
    found = []
    for apart, expected in ((1e-9, 1), (1e-3, 1), (0.049, 1), (0.051, 0), (0.5, 0)):
        speeds = [12000.0, 12000.0 * (1.0 + apart)]
        tables = {
            "bearing": {"preset": "B7206C"}, "load": {"axial": 300.0}, "identifier": {"kind": "impedance_fit", "speeds_rpm": speeds},
            "excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 1e-5},
        }  # fmt: skip
        try:
            scene_from_dict(tables)
            refused = 0
        except SceneError as error:
            refused = int("`identifier.speeds_rpm`" in str(error) and "5 % or more above" in str(error))
        found.append(
            near(f"impedance_fit of two speeds {100.0 * apart:g} % apart: refusals", refused, expected, 0.0, _COMMAND)
        )
    return found
