"""Balls and grooves inferred from printed numbers, the catalogue made from them, and ball-pass frequencies."""

from __future__ import annotations

import json
import resource
import subprocess
import sys

import numpy as np

import raceway as rw
from benchmarks.evidence import Row, below
from raceway.storage.tables import Tables
from raceway.studies.infer.infer import STIFFNESS_90
from raceway.studies.infer.printed import printed_by

TITLE = "The catalogue: inference from printed numbers, and ball-pass frequencies"
_NSK, _GMN = "raceway infer nsk --conformity 0.522", "raceway infer gmn"
#: Printed with a public data set: 9 balls of 7.9375 mm on 38.50 mm, 0 deg.
_PRINTED = {"ftf": (0.3969, 5e-5), "bpfo": (3.572, 5e-4), "bpfi": (5.428, 5e-4), "bsf": (2.32, 5e-3)}
_BEARING = {
    "ball_count": 9,
    "ball_diameter": "7.9375 mm",
    "pitch_diameter": "38.5 mm",
    "conformity_inner": 0.52,
    "conformity_outer": 0.53,
    "contact_angle_deg": 0.0,
}


def rows() -> list[Row]:
    rw.run({"bearing": {"preset": "7014C", "arrangement": "DB", "preload": 100.0}})  # compiles kernels, once for a machine
    before = _children()
    nsk, gmn = _answer(_NSK), _answer(_GMN)
    found = [*_inferred(nsk["summary"]), *_known(gmn["summary"])]
    pairs = _answer_of("benchmarks.evidence.catalogue")
    found += [
        below("the same by equilibria of scenes (preset, arrangement, preload): median error", pairs["median"], 0.01, _PAIRS),
        below("the same: 90 % within", pairs["most"], 0.04, _PAIRS),
        below(
            "processor time: both inferences and 384 scenes [s]", _children() - before, 10.0, f"{_NSK}; {_GMN}; {_PAIRS}",
            "three processes, kernels in the cache",
        ),
    ]  # fmt: skip
    return [*found, *_catalogue(), *_ball_pass(), *_refusals()]


def _inferred(found: Tables) -> list[Row]:
    step = "the largest is 7208A5, printed in steps of 500 N, which is 1.4 % of its 34 500 N"
    return [
        Row("designations inferred, series 70, 72, 79", found["designations"], "249", found["designations"] == 249, _NSK),
        below("printed dynamic ratings met within", found["dynamic_rating_error_max"], 0.006, _NSK, step),
        below("printed static ratings met within", found["static_rating_error_max"], 0.008, _NSK),
        below(
            f"{found['pair_stiffnesses']} printed axial stiffnesses of pairs, series 70, one conformity: median error",
            found["pair_stiffness_error_median"], 0.01, _NSK,
        ),
        below("the same: 90 % within", found["pair_stiffness_error_90"], 0.04, _NSK),
    ]  # fmt: skip


def _known(found: Tables) -> list[Row]:
    count = found["internals_printed"]
    note = (
        f"{count} bearings of one maker, each inferred from what is printed of it and from the balls of the {count - 1} others, by its "
        "own grooves; the tables, by which the 249 designations were made, are another practice: raceway infer gmn --maker NSK"
    )
    rows = []
    for word, key in (
        ("Z right", "ball_count_right"),
        ("D within 1 %", "ball_diameter_within_1_percent"),
        ("d_m within 1 %", "pitch_diameter_within_1_percent"),
    ):
        value = found[key]
        rows.append(Row(f"bearings with printed balls: {word}", value, "at least 0.95", value >= 0.95, _GMN, note))
        note = ""
    stated, value = STIFFNESS_90["grooves"], found["pair_stiffness_error_90"]
    rows.append(below("the same: 90 % of their printed axial stiffnesses within what an answer states", value, stated, _GMN))
    return rows


def _catalogue() -> list[Row]:
    command = "raceway catalogue --json"
    names = {one["name"] for one in _answer(command)["bearings"]}
    there = sum(one.names[0] in names for one in printed_by("nsk"))
    hybrid = [
        rw.run({"bearing": {"preset": "7014C", "balls": {"material": name}}, "load": {"axial": 1000.0}}).stiffness[0, 0]
        for name in ("100Cr6", "Si3N4")
    ]
    said = rw.run({"bearing": {"preset": "7014C"}, "load": {"axial": 1000.0}}).to_dict()["geometry"]["words"]
    return [
        Row("angular-contact designations as presets", there, "at least 249", there >= 249, command),
        Row("what a result says of a preset", said, "said", "known to about" in said, "raceway run"),
        Row(
            'axial stiffness of a 7014C at 1 kN, balls.material = "Si3N4" over "100Cr6"', float(hybrid[1] / hybrid[0]), "reported", True,
            "raceway run --set bearing.balls.material=Si3N4",
        ),
    ]  # fmt: skip


def _ball_pass() -> list[Row]:
    scene = {"bearing": _BEARING, "load": {"radial": [1.0, 0.0]}}
    (found,) = rw.run(scene).to_dict()["ball_pass"]["rows"]
    return [
        Row(
            f"{name.upper()} over the shaft's speed, 9 balls of 7.9375 mm on 38.50 mm, 0 deg", found[name], f"{wanted:g} as printed",
            abs(found[name] - wanted) <= digit, "raceway run",
        )
        for name, (wanted, digit) in _PRINTED.items()
    ]  # fmt: skip


def _refusals() -> list[Row]:
    rows = []
    contradiction = [*_NSK.split()[1:2], "--bore", "70 mm", "--outer-diameter", "110 mm", "--maker", "NSK"]
    for quantity, words, wanted in (
        ("an unknown designation", ["catalogue", "7014B"], "the nearest: 7014C, 7014A, 7014A5, 7914C, 7904C"),
        ("ratings of no whole number of balls", [*contradiction, "--rating", "15:47 kN:30 kN"], "no whole number of balls"),
        (
            "ratings that contradict each other",
            [*contradiction, "--rating", "15:47 kN:43 kN", "--rating", "25:55 kN:41 kN"],
            "contradicts 47000 N",
        ),
    ):
        done = subprocess.run([sys.executable, "-m", "raceway", *words], capture_output=True, text=True, check=False)
        ok = done.returncode == 2 and wanted in done.stderr and "Traceback" not in done.stderr
        rows.append(Row(f"refused, exit code 2: {quantity}", done.stderr.strip(), wanted, ok, "raceway " + " ".join(words)))
    return rows


#: What the module does as a program.
_PAIRS = "python -m benchmarks.evidence.catalogue"


def _answer(command: str) -> Tables:
    return _run([*command.split()[1:], "--json"], "raceway")


def _answer_of(module: str) -> Tables:
    return _run([], module)


def _run(words: list[str], module: str) -> Tables:
    done = subprocess.run([sys.executable, "-m", module, *words], capture_output=True, text=True, check=True)
    found: Tables = json.loads(done.stdout)
    return found


def _children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def pairs() -> Tables:
    """Errors of all printed axial stiffnesses of the series 70, each by the equilibrium of a scene as a user would write it."""
    errors = []
    for one in printed_by("nsk"):
        for pair in one.pairs:
            bearing = {"preset": one.names[0], "arrangement": "DB", "preload": pair.preload}
            errors.append(rw.run({"bearing": bearing}).stiffness[0, 0] / pair.stiffness - 1.0)
    off = np.abs(errors)
    return {"count": len(errors), "median": float(np.median(off)), "most": float(np.quantile(off, 0.9))}


if __name__ == "__main__":
    print(json.dumps(pairs()))
