"""The catalogue: balls and grooves inferred from printed numbers, presets made of them, ball-pass frequencies."""

from __future__ import annotations

import json
import time
from functools import cache

import numpy as np

import raceway as rw
from raceway.studies.infer.infer import STIFFNESS_90
from raceway.studies.infer.printed import printed_by
from validation.command_line import invoke

NSK = "NSK, super-precision bearings, series 70, 72, 79"
GMN = "GMN's printed balls: 103 bearings, each inferred from what is printed of it and from the balls of the 102 others"


@cache
def inferred(*words):
    begun = time.process_time()
    content = json.loads(invoke("infer", *words, "--json").stdout)["summary"]
    return content, time.process_time() - begun


@cache
def of_scenes():
    """Relative errors of all printed axial stiffnesses of pairs, each by the equilibrium of a scene as a user writes it."""
    begun, errors = time.process_time(), []
    for one in printed_by("nsk"):
        for pair in one.pairs:
            bearing = {"preset": one.names[0], "arrangement": "DB", "preload": pair.preload}
            errors.append(abs(rw.run({"bearing": bearing}).stiffness[0, 0] / pair.stiffness - 1.0))
    return np.array(errors), time.process_time() - begun


def test_inferred_from_ratings(claim):
    found, _ = inferred("nsk", "--conformity", "0.522")
    assert found["designations"] == 249
    largest = found["dynamic_rating_error_max"]
    why = "7208A5 is printed in steps of 500 N, 1.4 % of its 34 500 N"
    quantity, source = "printed ratings of 249 designations: dynamic, largest relative error", f"ISO 281; {NSK}"
    claim(quantity, largest, at_most=0.006, basis="published", source=source, misses=why)
    quantity, source = "printed ratings of 249 designations: static, largest relative error", f"ISO 76; {NSK}"
    claim(quantity, found["static_rating_error_max"], at_most=0.008, basis="published", source=source)
    names = {one["name"] for one in json.loads(invoke("catalogue", "--json").stdout)["bearings"]}
    assert all(one.names[0] in names for one in printed_by("nsk"))


def test_stiffness_of_pairs(claim):
    """By the inference's own formulas and by equilibria of scenes."""
    found, _ = inferred("nsk", "--conformity", "0.522")
    errors, _ = of_scenes()
    assert len(errors) == found["pair_stiffnesses"]
    where, source = (
        f"{len(errors)} printed axial stiffnesses of pairs, series 70, one conformity",
        f"{NSK}: two or three digits",
    )
    for word, own, scenes, limit in (
        ("median", found["pair_stiffness_error_median"], np.median(errors), 0.01),
        ("90 % within", found["pair_stiffness_error_90"], np.quantile(errors, 0.9), 0.04),
    ):
        claim(f"{where}: relative error, {word}", max(own, scenes), at_most=limit, basis="published", source=source)
    said = rw.run({"bearing": {"preset": "7014C"}, "load": {"axial": 1000.0}}).to_dict()["geometry"]["words"]
    assert "known to about" in said


def test_inferred_of_bearings_whose_balls_are_printed(claim):
    found, _ = inferred("gmn")
    share = min(
        found[key] for key in ("ball_count_right", "ball_diameter_within_1_percent", "pitch_diameter_within_1_percent")
    )
    quantity = "bearings with printed balls: number right, diameter and pitch within 1 %: least share"
    claim(quantity, share, at_least=0.95, basis="published", source=GMN)
    quantity = "bearings with printed balls: relative error of their axial stiffness, 90 % within"
    stated = STIFFNESS_90["grooves"]
    claim(
        quantity, found["pair_stiffness_error_90"], at_most=stated, basis="published", source=f"{GMN}; what an answer states"
    )


def test_time(claim):
    spent = sum(one[1] for one in (inferred("nsk", "--conformity", "0.522"), inferred("gmn"), of_scenes()))
    quantity = "processor time of both inferences and 384 scenes"
    claim(quantity, spent, at_most=10.0, unit="s", basis="regression", source="a catalogue is made while one waits")


def test_ball_pass_frequencies(claim):
    bearing = {
        "ball_count": 9, "ball_diameter": "7.9375 mm", "pitch_diameter": "38.5 mm", "conformity_inner": 0.52,
        "conformity_outer": 0.53, "contact_angle_deg": 0.0,
    }  # fmt: skip
    (found,) = rw.run({"bearing": bearing, "load": {"radial": [1.0, 0.0]}}).to_dict()["ball_pass"]["rows"]
    printed = {"ftf": (0.3969, 5e-5), "bpfo": (3.572, 5e-4), "bpfi": (5.428, 5e-4), "bsf": (2.32, 5e-3)}
    off = max(abs(found[name] - value) / digit for name, (value, digit) in printed.items())
    quantity = (
        "FTF, BPFO, BPFI, BSF over the shaft's speed, 9 balls of 7.9375 mm on 38.50 mm: error over half a printed digit"
    )
    claim(quantity, off, at_most=1.0, basis="published", source="printed with a public data set: 0.3969, 3.572, 5.428, 2.32")
