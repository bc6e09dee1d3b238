"""Stated over true error of Z and K.

True values come from Fourier collocation in time, finer steps where the steady orbit is not the question, 4999 equilibria, the
periodic solver, or shooting on independent equations (``validation``).  A factor of 3 is less than the 4 by which twice as many
steps change an error of second order, so that nobody who chooses steps by what is stated is a halving off.
"""

from functools import cache

import pytest

from checks.validation.error_estimate import CASES, FACTOR, judge, right, worst
from checks.validation.identified_stiffness import CASES as STIFFNESSES
from checks.validation.identified_stiffness import LIMIT, compared
from checks.validation.series_errors import SERIES, series_errors
from checks.validation.start_errors import judged_starts

pytestmark = pytest.mark.night

STATED = {"at_least": 1.0 / FACTOR, "at_most": FACTOR, "basis": "own other method"}
#: Of a turn: even and odd, multiples of the mirror axis and of the balls, primes.
COUNTS = (8, 9, 10, 11, 12, 13, 15, 16, 20, 24, 30, 36, 45, 48, 60, 61, 72, 90, 120, 127, 180, 240, 300, 359, 360)
#: Starts that may be wrong: one in a hundred, as a run may settle on another motion than the one that is solved for.
SHARE, STARTS = 0.99, 390
FINE = (
    "newmark", "newmark, tilt free", "generalized alpha, dissipative, tilt free", "central differences",
    "central differences, tilt free", "central differences at 0.89 of their limit",
)  # fmt: skip
COARSE = (
    "8 steps a turn", "24 steps a turn", "36 steps a turn, tilt free", "61 steps a turn (odd), force of one direction",
    "3 turns of 90 steps", "2 turns of 36 steps, tilt free",
)  # fmt: skip
LIFTED = (
    "lift-off, 200 N, 13 000 r/min", "lift-off, 100 N, tilt free", "lift-off, 400 N, 15 000 r/min, 60 steps a turn",
    "lift-off, 150 N, force of one direction", "400 N, force of one direction, tilt free", "light preload of 50 N",
    "light preload of 20 N, tilt free",
)  # fmt: skip
BEGUN = (
    "ramp, tilt free", "ramp, 3 turns, tilt free: one turn is used", "sudden load", "sudden load, 60 turns of 180 steps",
    "sudden load, 4 turns, 200 N, tilt free", "sudden load, heavily damped contacts",
)  # fmt: skip
OTHERS = (
    "damped contacts", "penalty law, tilt against 20 kN m/rad", "40 000 r/min, tilt free", "orbiting balls, 24 turns",
)  # fmt: skip
FITTED = ("impedance fit over three speeds",)


@cache
def judged() -> dict[str, tuple[float, float, float]]:
    """Stated error, true error and the bound of the true value, of each case."""
    return {one.name: judge(one) for one in CASES}


@pytest.mark.parametrize(("words", "names", "misses"), [
    ("three integrators, up to the stable limit", FINE, ""), ("8 to 90 steps per turn, or few turns", COARSE, ""),
    ("lift-off and light preload", LIFTED, ""), ("sudden load and ramp", BEGUN, ""),
    ("damping, penalty law, high speed, orbiting balls", OTHERS, ""),
    (
        "impedance fit over three speeds",
        FITTED,
        "the largest misfit over all speeds is stated; at the speed of the result the fit is closer",
    ),
])  # fmt: skip
def test_of_scenes(claim, words, names, misses):
    ratio = worst([judged()[name][:2] for name in names])
    source = f"Fourier collocation or finer steps, {len(names)} scenes"
    claim(f"stated over true error of Z, furthest from 1: {words}", ratio, **STATED, source=source, misses=misses)


def test_true_values_are_better_known_than_what_they_judge(claim):
    assert {*FINE, *COARSE, *LIFTED, *BEGUN, *OTHERS, *FITTED} == set(judged())
    largest = max(bound / true for _, true, bound in judged().values())
    source = f"change from 129 to 257 times per turn, or the finer run's stated error; {len(CASES)} scenes"
    claim("uncertainty of the true value over the true error", largest, at_most=0.1, basis="own other method", source=source)


@pytest.mark.parametrize("kind", ["unidirectional", "bidirectional"])
def test_of_series_of_equilibria(claim, kind):
    places = [place for place, (_, _, its, *_) in enumerate(SERIES) if its == kind]
    ratio = worst([series_errors(place, count) for place in places for count in COUNTS])
    quantity = f"stated over true error of Z, furthest from 1: {COUNTS[0]} to {COUNTS[-1]} equilibria per turn, {kind}"
    claim(quantity, ratio, **STATED, source=f"4999 equilibria; {len(places)} scenes of {len(COUNTS)} counts")


def test_of_sudden_and_ramped_starts(claim):
    found = judged_starts(STARTS)
    good = [right(one.estimate, one.true) for one in found]
    begins = [one.start.tables["integrator"]["start"] for one in found]
    groups = {
        "sudden starts": [kind == "static" for kind in begins], "ramped starts": [kind == "ramp" for kind in begins],
        "starts within a tenth of a resonance": [abs(one.start.ratio - 1.0) <= 0.1 for one in found],
    }  # fmt: skip
    bounds = {"at_least": SHARE, "basis": "own other method"}
    for words, chosen in groups.items():
        ours = [ok for ok, in_group in zip(good, chosen, strict=True) if in_group]
        quantity = f"share of {words} whose error of Z is stated within a factor of {FACTOR:g}"
        claim(quantity, sum(ours) / len(ours), **bounds, source=f"periodic solver, {len(ours)} drawn starts")
    least = sum(one.estimate >= one.true / FACTOR or right(one.estimate, one.true) for one in found)
    quantity = "share of starts whose error of Z is not stated too small by more"
    claim(quantity, least / STARTS, **bounds, source=f"periodic solver, {STARTS} drawn starts")
    of_k = sum(one.true_of_k <= FACTOR * one.estimate_of_k for one in found)
    quantity = f"share of starts whose K is off by at most {FACTOR:g} times its stated error"
    claim(quantity, of_k / STARTS, **bounds, source=f"periodic solver, {STARTS} drawn starts")
    asked = [one.confirmed for one in found if one.confirmed is not None]
    quantity = "share of those steady motions that Fourier collocation finds to a thousandth of the error"
    source = f"neither equations nor search in common; {len(asked)} of every tenth start"
    claim(quantity, sum(asked) / len(asked), at_least=1.0, basis="own other method", source=source)


def test_of_stiffness_against_independent_code(claim):
    found = compared(STIFFNESSES)
    source = f"shooting with DOP853 on the reference's own equations; {len(STIFFNESSES)} scenes by three integrators"
    largest = max(one.error for one in found)
    claim("largest relative error of K", largest, at_most=LIMIT, basis="own other method", source=f"{source}; (w h)^2 / 6")
    ratio = worst([(one.stated_error / one.wanted, one.error) for one in found])
    claim("stated over true error of K, furthest from 1", ratio, **STATED, source=source)
