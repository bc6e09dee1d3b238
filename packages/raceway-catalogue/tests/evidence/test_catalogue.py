"""Inferred geometry, presets and ball-pass frequencies."""

import json
import re
from collections import defaultdict
from functools import cache

import numpy as np
import pytest
from raceway_catalogue.inferred import STIFFNESS_95
from raceway_catalogue.printed import printed_by
from raceway_catalogue.rating_conventions import stiffnesses

import raceway as rw
from checks.validation.command_line import invoke
from raceway.core.jit import working_process_time

pytestmark = pytest.mark.night

NSK = "NSK, super-precision bearings, series 70, 72, 79"
GMN = "GMN's printed balls: 103 bearings, each inferred from what is printed of it and from the balls of the 102 others"


@cache
def inferred(*words):
    begun = working_process_time()
    content = json.loads(invoke("catalogue", "--infer", *words, "--json").stdout)["summary"]
    return content, working_process_time() - begun


#: Radial over axial stiffness by preload class, as NSK prints them for 15 and 30 deg, rounded by up to 4 %.
FACTORS = {15: (6.5, 6.0, 5.0, 4.5), 30: (1.4, 1.4, 1.4, 1.4)}


@cache
def of_scenes(maker, own=True):
    """(n, 2, 3): printed over computed, less 1, axial and radial (nan: not printed), and the interval of ``geometry.data``.

    Each by the equilibrium of a scene as a user writes it; own: by the maker's designation, not by one that says no maker.
    """
    begun, rows = working_process_time(), []
    for one in printed_by(maker):
        name = one.names[0] if own or maker == "nsk" else one.names[0][:4] + one.names[0][5:].replace("AD", "A5")
        for k, pair in enumerate(one.pairs):
            bearing = {"preset": name, "arrangement": "DB", "preload": pair.preload}
            result = rw.run({"bearing": bearing | ({"maker": maker.upper()} if own else {})})
            factor = (
                FACTORS.get(pair.contact_angle_deg, (np.nan,) * 4)[k]
                if pair.radial is None
                else pair.radial / pair.stiffness
            )
            off = pair.stiffness * np.array([1.0, factor]) / np.diag(result.stiffness)[:2] - 1.0
            parts = np.array([[part["axial"], part["radial"]] for part in result.geometry["data"]])
            # Parts of either sign combine by the root of the sum of squares on each side.
            sides = np.sqrt((parts**2).sum(axis=0)) * (-1.0, 1.0)
            rows.append(np.column_stack([off, sides]))
    return np.array(rows), working_process_time() - begun


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
    errors = np.abs(of_scenes("nsk")[0][:, 0, 0])
    assert len(errors) == found["pair_stiffnesses"]
    where, source = (
        f"{len(errors)} printed axial stiffnesses of pairs, series 70, one conformity", f"{NSK}: two or three digits",
    )  # fmt: skip
    for word, own, scenes, limit in (
        ("median", found["pair_stiffness_error_median"], np.median(errors), 0.01),
        ("90 % within", found["pair_stiffness_error_90"], np.quantile(errors, 0.9), 0.04),
    ):
        claim(f"{where}: relative error, {word}", max(own, scenes), at_most=limit, basis="published", source=source)


#: Grease limit of 7014C, 13 000 r/min as NSK prints it, over its mean diameter [mm r/min], here of all sizes and angles.
GREASE = 1.17e6


def test_spindle_pairs_at_light_preload_and_grease_limit_do_not_slide(claim):
    """The preload is the printed light one, of NSK's series 72 and 79 series 70's share of the static rating (median of an angle)."""
    shares, needed, told = defaultdict(list), [], 0
    sizes = [(maker, one) for maker in ("nsk", "ntn") for one in printed_by(maker)]
    light = {one.names[0]: one.pairs[min(1, len(one.pairs) - 1)] for _, one in sizes if one.pairs}
    for maker, one in sizes:
        if maker == "nsk" and one.pairs:
            shares[one.pairs[0].contact_angle_deg].append(light[one.names[0]].preload / one.ratings[0].static)
    for maker, one in sizes:
        name, turns = one.names[0], GREASE / (500.0 * (one.bore + one.outer_diameter))
        rating = one.ratings[0] if one.ratings else None
        preload = light[name].preload if name in light else np.median(shares[rating.contact_angle_deg]) * rating.static
        bearing = {"preset": name, "maker": maker.upper(), "arrangement": "DB", "preload": preload}
        result = rw.run({"bearing": bearing, "kinematics": {"spin_speed_rpm": turns}})
        needed.append(result.to_dict()["sliding"]["traction_needed"])
        told += any("balls slide" in text for text in result.warnings)
    what = f"of {len(sizes)} pairs DB of NSK and NTN, light preload, n d_m = 1.17e6 mm r/min (grease)"
    source = f"bound: traction coefficient 0.06, below the 0.08 of conventional lubricants (ASLE 1959); {NSK}; NTN-SNR, ULTAGE, 2015"
    claim(f"{what}: share with a warning of sliding", told / len(sizes), at_most=0.05, basis="published", source=source)
    claim(f"{what}: largest traction coefficient needed", max(needed), at_most=0.06, basis="published", source=source)


def test_inferred_of_bearings_whose_balls_are_printed(claim):
    found, _ = inferred("gmn")
    share = min(
        found[key] for key in ("ball_count_right", "ball_diameter_within_1_percent", "pitch_diameter_within_1_percent")
    )
    quantity = "bearings with printed balls: number right, diameter and pitch within 1 %: least share"
    claim(quantity, share, at_least=0.95, basis="published", source=GMN)
    quantity = "bearings with printed balls: relative error of their axial stiffness, 90 % within"
    stated = STIFFNESS_95["grooves"]
    claim(
        quantity, found["pair_stiffness_error_90"], at_most=stated, basis="published", source=f"{GMN}; what an answer states"
    )


def test_deep_groove_bearings_and_rollers_by_number(claim):
    """Printed ratings of the catalogue's designations, and balls beside those that two makers print; what is refused counts as wrong."""
    deep = [one for one in rw.catalogue("*") if "deep-groove ball bearing of series" in one.title]
    assert len(deep) == 254
    errors = [abs(error) for one in deep for error in one.printed.values()]
    quantity = "printed ratings of 254 deep-groove designations: dynamic and static, largest relative error"
    source = "ISO 281, ISO 76; NSK, Rolling bearings, CAT. No. E1102e"
    claim(quantity, max(errors), at_most=0.01, basis="published", source=source)
    nmb, _ = inferred("nmb_deep_groove")
    right = [nmb["ball_count_right"] * nmb["internals_printed"]]
    named = {one.name: one.table for one in deep}
    for one in printed_by("gmn_deep_groove"):
        if one.bore >= 10e-3:  # below, both makers fill the same number with other balls
            table, balls = named[one.names[0]], one.internals
            right.append(
                table["ball_count"] == balls.ball_count and abs(table["ball_diameter"] / balls.ball_diameter - 1.0) < 0.01
            )
    share, among = sum(right) / (nmb["internals_printed"] + len(right) - 1), nmb["internals_printed"] + len(right) - 1
    quantity = f"{among} deep-groove bearings with printed balls: share with the right number and diameter"
    source = "NMB, from its ratings; GMN from 10 mm bore, from NSK's ratings"
    claim(quantity, share, at_least=0.9, basis="published", source=source)
    rollers = [abs(one.printed["dynamic_rating_error"]) for one in rw.catalogue("NU*")]
    quantity = f"printed dynamic ratings of {len(rollers)} cylindrical roller designations: largest relative error"
    claim(quantity, max(rollers), at_most=0.01, basis="published", source="ISO 281, with the length from C0 by ISO 76; NSK")


#: Conformities that are tried, of both grooves.
TRIED = np.linspace(0.505, 0.57, 131)


def misfits(one, count, diameter):
    """(n, f) computed over printed stiffness, less 1, of each printed pair at each conformity."""
    return (stiffnesses(one, count, diameter, TRIED, TRIED) / np.array([pair.stiffness for pair in one.pairs]) - 1.0).T


def best(off) -> int:
    return int(np.median(np.abs(off), axis=0).argmin())


def test_stiffness_of_a_series_left_out(claim):
    """Series 70 in the grooves of 7206, and the reverse; each series of a maker who prints his balls in those of his other ones."""
    own = ((one, rw.catalogue(one.names[0])[0].table) for one in printed_by("nsk") if one.pairs)
    series = np.concatenate([misfits(one, int(table["ball_count"]), float(table["ball_diameter"])) for one, table in own])
    near, curves = (0.518, 0.522, 0.526), []
    for angle, pairs in (
        (15, ((60, 32e6), (120, 43e6), (290, 66e6), (590, 94e6))), (30, ((50, 85e6), (380, 175e6), (630, 210e6)))
    ):  # fmt: skip
        for preload, printed in pairs:
            bearings = (
                {"preset": "7206C", "arrangement": "DB", "contact_angle_deg": angle, "preload": preload, "conformity_inner": f, "conformity_outer": f}
                for f in near
            )  # fmt: skip
            curve = [rw.run({"bearing": bearing}).stiffness[0, 0] / printed - 1.0 for bearing in bearings]
            curves.append(np.interp(TRIED, near, curve, left=1.0, right=1.0))
    sizes = np.array(curves)
    stated = rw.catalogue("7014C")[0].stiffness_error
    quantity, source = "axial stiffnesses of series 70 in the grooves of 7206: 90 % within", f"{NSK}; what an answer states"
    claim(quantity, np.quantile(np.abs(series[:, best(sizes)]), 0.9), at_most=stated, basis="published", source=source)
    quantity, source = (
        "axial stiffnesses of 7206C and 7206A in the grooves of series 70: largest error", "NSK; as in report published",
    )  # fmt: skip
    claim(quantity, np.abs(sizes[:, best(series)]).max(), at_most=0.04, basis="published", source=source)
    parts = defaultdict(list)
    for one in printed_by("gmn"):
        word = re.match(r"[A-Z]+ (618|619|60|62)", one.names[0])
        if word and one.internals is not None and one.pairs:
            parts[word[1]].append(misfits(one, one.internals.ball_count, one.internals.ball_diameter))
    off = []
    for name, found in parts.items():
        others = np.concatenate([part for other, its in parts.items() if other != name for part in its])
        off.append(np.abs(np.concatenate(found)[:, best(others)]))
    stated = rw.catalogue("7914C")[0].stiffness_error
    quantity, source = (
        "axial stiffnesses of a series in the grooves of the maker's other three: 90 % within",
        "GMN; what an answer states",
    )
    claim(quantity, np.quantile(np.concatenate(off), 0.9), at_most=stated, basis="published", source=source)


def test_radial_stiffness(claim):
    """By the maker's factors of radial over axial stiffness by preload class, of 15 and 30 deg."""
    off = of_scenes("nsk")[0][:, 1, 0]
    off = np.abs(off[np.isfinite(off)])
    quantity = f"radial stiffnesses of {len(off)} pairs of series 70, tilt locked: 95 % within"
    stated, source = rw.catalogue("7014C")[0].radial_stiffness_error, f"{NSK}: factors rounded by 4 %"
    claim(quantity, np.quantile(off, 0.95), at_most=stated, basis="published", source=source)


def test_printed_stiffness_lies_within_what_a_result_says(claim):
    """Designations that say no maker, against what NTN and NSK print; NTN's own designations against their printed pairs."""
    for maker, words in (("ntn", "50 pairs of NTN"), ("nsk", "NSK's series 70")):
        off, low, high = np.moveaxis(of_scenes(maker, own=False)[0], -1, 0).reshape(3, -1)
        known = np.isfinite(off)
        inside, width = ((low <= off) & (off <= high))[known], np.median(high - low)
        quantity = f"printed stiffnesses of {words} by designations without a maker: share of {known.sum()} inside, {100.0 * width:.0f} % wide"
        claim(
            quantity, inside.mean(), at_least=0.95, basis="published", source="what a result says of geometry; NSK, NTN-SNR"
        )
    own = np.median(np.abs(of_scenes("ntn")[0][:, :, 0]), axis=0)
    for word, error, limit in zip(("axial", "radial"), own, (0.01, 0.03), strict=True):
        quantity = f"{word} stiffnesses of 50 pairs of NTN's series 70 by their own designations: relative error, median"
        source = "NTN-SNR, ULTAGE, 2015; groove and angle are fitted to it"
        claim(quantity, error, at_most=limit, basis="published", source=source)


def test_spread_between_makers(claim):
    """Printed stiffnesses of NTN's pairs and of GMN's standard design over those of the presets of the size."""
    presets = [one for one in rw.catalogue("7*") if one.maker == "NSK"]
    own = {tuple(np.round(one.size, 6)): one for one in presets}
    changes = {"70": [], "72": [], "79": []}
    for one in (*printed_by("ntn"), *(one for one in printed_by("gmn") if one.names[0].startswith("S ") and one.pairs)):
        size = one.bore, one.outer_diameter, one.width, one.pairs[0].contact_angle_deg
        if preset := own.get(tuple(np.round(size, 6))):
            computed = stiffnesses(one, preset.table["ball_count"], preset.table["ball_diameter"], 0.522, 0.522)
            changes[preset.name[:2]] += list(np.array([pair.stiffness for pair in one.pairs]) / computed - 1.0)
    for series, found in changes.items():
        low, high = rw.catalogue(f"{series}14C")[0].data[1]["axial"]
        share = np.mean([low <= change <= high for change in found])
        quantity = f"{len(found)} axial stiffnesses of other makers beside series {series}: share within {100 * low:+.0f} to {100 * high:+.1f} %"
        claim(quantity, share, at_least=0.95, basis="published", source="GMN, NTN-SNR; what a result says of other makers")
