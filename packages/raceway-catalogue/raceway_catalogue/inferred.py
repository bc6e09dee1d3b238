"""Inferred bearings, each number with its scatter and its reason; tables of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

import attrs
import numpy as np

from raceway import Answer, SceneError, door
from raceway.extend import Fact, Part, Tables, Words, clearance_range, number, sections
from raceway_catalogue.deep_groove import GROOVES, STIFFNESS_ERROR, deep_groove_candidates
from raceway_catalogue.printed import Printed
from raceway_catalogue.rating_conventions import (
    CONFORMITY, LIMITS, POISSON, YOUNG, Candidate, both_stiffnesses, by_grooves, by_tables, size_words, stiffnesses,
)  # fmt: skip

#: What is printed and checked.
QUANTITIES = ("dynamic rating", "static rating", "pair stiffness", "radial stiffness")


@attrs.frozen
class _Number:
    """A number, its relative scatter, and why it is this one."""

    value: float
    scatter: float
    reason: str


@attrs.frozen
class _Check:
    """A printed number met: contact angle [deg], what, printed and computed, relative error."""

    contact_angle_deg: float
    quantity: str
    printed: float
    computed: float

    @property
    def error(self) -> float:
        return self.computed / self.printed - 1.0


@attrs.frozen(repr=False)
class Inferred(Answer):
    """Balls and grooves of a bearing, inferred from what its maker prints.

    Attributes
    ----------
    printed : what it was inferred from
    practice : "tables" of ISO 281 and ISO 76, or the maker's own "grooves"
    ball_count, ball_diameter [m], pitch_diameter [m], conformity_inner, conformity_outer : Number
    share : of the probability that this ball count has among all that explain the ratings
    other : the next likely ball count and diameter [m] with its share, or None
    checks : printed ratings [N] and stiffnesses of pairs [N/m] against those of these numbers
    stiffness_error : relative uncertainty of the axial stiffness, 95 %
    contact_angles : by the nominal one [deg], where radial stiffnesses fix it [deg]

    Examples
    --------
    >>> import raceway as rw
    >>> found = rw.infer("70 mm", "110 mm", {15: ("47 kN", "43 kN"), 25: ("44.5 kN", "41 kN")})
    >>> found.ball_count.value, round(found.ball_diameter.value * 1e3, 3)
    (20, 11.906)
    """

    stem: ClassVar[str] = "inferred"
    printed: Printed
    practice: str
    ball_count: _Number
    ball_diameter: _Number
    pitch_diameter: _Number
    conformity_inner: _Number
    conformity_outer: _Number
    share: float
    other: Tables | None
    checks: tuple[_Check, ...]
    stiffness_error: float
    contact_angles: dict[float, _Number]

    @property
    def numbers(self) -> dict[str, _Number]:
        """By the keys of [bearing]."""
        keys = "ball_count", "ball_diameter", "pitch_diameter", "conformity_inner", "conformity_outer"
        return {key: getattr(self, key) for key in keys}

    @door
    def worst(self, quantity: str) -> float | None:
        """Largest relative error of "dynamic rating", "static rating" or "pair stiffness"; None where none is printed."""
        return max((abs(check.error) for check in self.checks if check.quantity == quantity), default=None)

    @door
    def bearing(self, contact_angle_deg: float | None = None) -> Tables:
        """The table [bearing] of a scene; a deep-groove bearing with the middle of clearance class CN.

        Parameters
        ----------
        contact_angle_deg : None: that of the first rating
        """
        size, steel = self.printed, {"young": YOUNG, "poisson": POISSON}
        table: Tables = {"bore": size.bore, "outer_diameter": size.outer_diameter}
        table |= {} if size.width is None else {"width": size.width}
        table |= {key: number.value for key, number in self.numbers.items()}
        nominal = contact_angle_deg or size.ratings[0].contact_angle_deg
        table["contact_angle_deg"] = self.contact_angles[nominal].value if nominal in self.contact_angles else nominal
        if size.deep_groove and (limits := clearance_range("ball", size.bore)):
            table["radial_clearance"] = 0.5 * sum(limits)
        return {**table, "rings": dict(steel), "balls": dict(steel)}

    def to_dict(self) -> Tables:
        """Plain tables: numbers with uncertainty and reason, checks, the table [bearing]."""
        return {
            "names": list(self.printed.names),
            **{name: getattr(self, name) for name in ("practice", "share", "other")},
            "numbers": {key: attrs.asdict(number) for key, number in self.numbers.items()},
            "checks": [{**attrs.asdict(check), "error": check.error} for check in self.checks],
            "stiffness_error": self.stiffness_error,
            "contact_angles": {f"{angle:g}": attrs.asdict(number) for angle, number in self.contact_angles.items()},
            "bearing": self.bearing(),
        }

    def _number_facts(self) -> list[Fact]:
        facts: list[Fact] = []
        for key, inferred in self.numbers.items():
            value = number(1e3 * inferred.value, "mm") if key.endswith("diameter") else f"{inferred.value:.5g}"
            scatter = "" if key == "ball_count" else f"+- {100.0 * inferred.scatter:.2g} %; "
            facts.append((key.replace("_", " "), value, scatter + inferred.reason))
        for angle, angle_number in self.contact_angles.items():
            why = f"+- {100.0 * angle_number.scatter:.2g} %; {angle_number.reason}"
            facts.append((f"contact angle {angle:g} deg", f"{angle_number.value:.4g} deg", why))
        return facts

    def _facts(self) -> tuple[str, list[Fact]]:
        facts = self._number_facts()
        for quantity in QUANTITIES:
            if (error := self.worst(quantity)) is not None:
                facts.append((quantity, f"{100.0 * error:.2g} %", "largest error of what is printed"))
        facts.append(("axial stiffness", f"{100.0 * self.stiffness_error:.2g} %", "known to about this, 95 %"))
        return self.printed.title, facts

    def report(self) -> Sequence[Part]:
        practice = "the maker's grooves" if self.practice == "grooves" else "the tables of ISO 281 and ISO 76"
        rows = [(f"Inferred by {practice}", "", ""), *self._number_facts()]
        if self.other is not None and self.other["share"] > 1e-3:
            balls = f"{self.other['ball_count']} of {1e3 * self.other['ball_diameter']:.4g} mm"
            rows.append(("next likely", balls, f"{100.0 * self.other['share']:.2g} %"))
        rows.append(("What is printed", "", ""))
        for check in self.checks:
            stiff = check.quantity.endswith("stiffness")
            value = number(1e-6 * check.printed, "N/µm") if stiff else number(1e-3 * check.printed, "kN")
            rows += [(f"{check.quantity}, {check.contact_angle_deg:g} deg", value, f"met with {100.0 * check.error:+.2f} %")]
        error = f"geometry inferred: axial stiffness uncertain by about {100.0 * self.stiffness_error:.0f} %"
        return [Words(self.printed.title, "bold"), sections(rows), error]


#: Practices of rating by maker, in small letters.
_PRACTICES = {"nsk": "tables", "nmb": "tables", "gmn": "grooves"}
#: 95 % of the printed axial stiffnesses of pairs lie within this of those of the inferred bearings, by practice (report catalogue).
STIFFNESS_95 = {"tables": 0.045, "grooves": 0.08}
#: Scatter of the pitch diameter: of 103 bearings whose maker prints it, 101 have the mean of bore and outer diameter.
_PITCH = 0.01
#: Scatter of the conformity where no stiffness is printed: of the series 70, fitted one by one, (f - 0.5) scatters by 5 %.
_CONFORMITY = 0.002
#: The same of deep grooves, of which none is printed: 0.515 to 0.525.
_DEEP_CONFORMITY = 0.01
#: Error of one printed stiffness: the median over 384 pairs of the series 70 in grooves of one conformity (report catalogue).
_STIFFNESS = 0.008
#: Share of known bearings like it below which an answer by grooves is called doubtful.
_ALIKE = 1e-3
#: Conformities over which printed stiffnesses are matched, and turns [deg] of the contact angle, within which it is manufactured.
_TRIED, _TURNS = np.linspace(0.505, 0.56, 56), np.linspace(-4.0, 4.0, 33)


def infer_printed(size: Printed, maker: str | None = None, conformity: float | None = None) -> Inferred:
    """Balls and grooves of one size.

    maker : "NSK" or "GMN", whose practice of rating is known; None: the practice that explains the numbers better
    conformity : of both grooves; None: from printed stiffnesses, else 0.522

    SceneError: Ratings that contradict each other, or that no whole number of usual balls explains; an unknown maker; stiffnesses that
    no groove gives.
    """
    if not size.ratings:
        raise SceneError.at(size.title, None, "needs the load ratings at one contact angle or more")
    _refuse_contradiction(size)
    candidates = _candidates(size, maker)
    if not candidates or not candidates[0].explains:
        raise SceneError.at(size.title, None, _mismatch(candidates))
    best = candidates[0]
    odds = np.exp([min(x.weight - best.weight, 0.0) for x in candidates])
    odds /= odds.sum()
    shares = list(zip(candidates, map(float, odds), strict=True))
    share = float(sum(p for x, p in shares if x.ball_count == best.ball_count))
    next_likely = (
        {"ball_count": x.ball_count, "ball_diameter": x.ball_diameter, "share": p}
        for x, p in shares
        if x.ball_count != best.ball_count
    )
    angles = {} if conformity is not None else _contact_angles(size, best)
    angles_deg = {angle: number.value for angle, number in angles.items()}
    pairs = [attrs.evolve(x, contact_angle_deg=angles_deg.get(x.contact_angle_deg, x.contact_angle_deg)) for x in size.pairs]
    inner, outer = _grooves(attrs.evolve(size, pairs=tuple(pairs)), best, conformity)
    how = {
        "tables": "meets C and C0 by the tables of ISO 281 and ISO 76",
        "grooves": "meets C and C0 with a groove and a filling as other bearings of the maker have",
    }
    doubt = "" if best.alike is None or best.alike >= _ALIKE else "; hardly any is like this one, so it is doubtful"
    checks = []
    for rating, c, c0 in zip(size.ratings, best.dynamic_errors, best.static_errors, strict=True):
        for word, force, off in (("dynamic", rating.dynamic, c), ("static", rating.static, c0)):
            checks.append(_Check(rating.contact_angle_deg, f"{word} rating", force, force * (1.0 + off)))
    for entry, pair in zip(size.pairs, pairs, strict=True):
        angle = entry.contact_angle_deg
        axial, radial = both_stiffnesses(size, best, pair.preload, pair.contact_angle_deg, inner.value, outer.value)
        checks.append(_Check(angle, "pair stiffness", pair.stiffness, float(axial)))
        checks += [] if pair.radial is None else [_Check(angle, "radial stiffness", pair.radial, float(radial))]
    of_count = f"{how[best.practice]}; {100.0 * share:.3g} % of all counts that do{doubt}"
    of_ball = f"usual size, {size_words(best.ball_diameter)}; C alone leaves the uncertainty"
    asked = "" if abs(best.pitch_factor - 1.0) < 1e-9 else f"as C and C0 ask for, {best.pitch_factor:.3g} of "
    of_pitch = f"{asked}the mean of bore and outer diameter"
    return Inferred(
        printed=size,
        practice=best.practice,
        ball_count=_Number(best.ball_count, 1.0 - share, of_count),
        ball_diameter=_Number(best.ball_diameter, max(map(abs, best.dynamic_errors)) / 1.8, of_ball),
        pitch_diameter=_Number(best.pitch_factor * size.mean_diameter, _PITCH, of_pitch),
        conformity_inner=inner,
        conformity_outer=outer,
        share=share,
        other=next(next_likely, None),
        checks=tuple(checks),
        stiffness_error=STIFFNESS_ERROR if size.deep_groove else STIFFNESS_95[best.practice],
        contact_angles=angles,
    )


def _candidates(size: Printed, maker: str | None) -> list[Candidate]:
    """Those that explain the ratings, then the likeliest first."""
    if maker is not None and maker.lower() not in _PRACTICES:
        makers = ", ".join(name.upper() for name in _PRACTICES)
        raise SceneError.at("maker", maker, f"must be one of {makers}, whose practice of rating is known, or left out")
    practice = None if maker is None else _PRACTICES[maker.lower()]
    if size.deep_groove:
        if practice == "grooves":
            rule = "rates deep-groove bearings by its own grooves, which leave the count open: give conformity and balls"
            raise SceneError.at("maker", maker, rule)
        return sorted(deep_groove_candidates(size), key=lambda x: (not x.explains, -x.weight))
    candidates = [] if practice == "grooves" else by_tables(size)
    # A known bearing is inferred from the others.  Ratings at several angles are one bearing by the tables, or none of both practices.
    if practice == "grooves" or (practice is None and len(size.ratings) == 1):
        candidates += by_grooves(size, without=size.names[0] if size.names else "")
    if practice != "grooves" and not any(x.explains for x in candidates):
        candidates += by_tables(size, metric=True)
    return sorted(candidates, key=lambda x: (not x.explains, -x.weight))


def _refuse_contradiction(size: Printed) -> None:
    """Ratings fall as the contact angle grows: C with cos(a)^0.7, C0 with cos(a), but for a few percent."""
    angles = [rating.contact_angle_deg for rating in size.ratings]
    if len(set(angles)) < len(angles):
        raise SceneError.at(size.title, angles, "an angle has one pair of ratings: these dimensions are listed twice")
    first = min(size.ratings, key=lambda x: x.contact_angle_deg)
    for rating in size.ratings:
        lean = math.cos(math.radians(rating.contact_angle_deg)) / math.cos(math.radians(first.contact_angle_deg))
        for word, power in (("dynamic", 0.7), ("static", 1.0)):
            value, base = getattr(rating, word), getattr(first, word)
            if abs(value / base / lean**power - 1.0) > 0.06:
                rule = (
                    f"contradicts {base:g} N at {first.contact_angle_deg:g} deg: the same balls have {base * lean**power:.4g} N, "
                    "but for some percent. Are both of one size and one maker?"
                )
                raise SceneError.at(f"{size.title}: {word} rating at {rating.contact_angle_deg:g} deg", value, rule)


def _mismatch(candidates: list[Candidate]) -> str:
    say = "no whole number of balls of a usual size explains these ratings"
    tables = [x for x in candidates if x.practice == "tables"]
    if not tables:
        return f"{say}: are dimensions and ratings of one bearing, in mm and N?"
    near = max(tables, key=lambda x: x.weight)
    c, c0 = (max(errors, key=abs) for errors in (near.dynamic_errors, near.static_errors))
    return (
        f"{say}: the nearest, {near.ball_count} balls of {1e3 * near.ball_diameter:.4g} mm, has C {100.0 * c:+.1f} % and C0 "
        f"{100.0 * c0:+.1f} % off by ISO 281 and ISO 76, which their makers meet within {100.0 * LIMITS[0]:g} and {100.0 * LIMITS[1]:g} %"
    )


def _grooves(size: Printed, best: Candidate, conformity: float | None) -> tuple[_Number, _Number]:
    if conformity is not None:
        both = _Number(conformity, _CONFORMITY, "given")
        return both, both
    if size.deep_groove:
        why = "a default, the largest that ISO 76 rates deep grooves with: makers print none"
        return _Number(GROOVES[0], _DEEP_CONFORMITY, why), _Number(GROOVES[1], _DEEP_CONFORMITY, why)
    if best.practice == "grooves" and all(pair.radial is None for pair in size.pairs):
        why = "gives C0 as Hertz contact at 4200 MPa"
        outer = why if best.conformity_outer == best.conformity_inner else "usual beside a wide inner groove"
        return _Number(best.conformity_inner, _CONFORMITY, why), _Number(best.conformity_outer, _CONFORMITY, outer)
    # Median of the conformities that give each printed stiffness, and its relative scatter
    if not size.pairs:
        both = _Number(CONFORMITY, _CONFORMITY, "meets printed stiffnesses of the series 70, and is taken for all")
        return both, both
    curves, n = stiffnesses(size, best.ball_count, best.ball_diameter, _TRIED, _TRIED), len(size.pairs)
    stiffnesses_printed = np.array([pair.stiffness for pair in size.pairs])
    # Stiffness falls as grooves widen.
    each = [float(np.interp(k, row[::-1], _TRIED[::-1])) for k, row in zip(stiffnesses_printed, curves.T, strict=True)]
    middle = float(np.median(each))
    if not _TRIED[0] < middle < _TRIED[-1]:
        usual = stiffnesses(size, best.ball_count, best.ball_diameter, CONFORMITY, CONFORMITY)
        rule = (
            f"contradicts the ratings: these balls have {1e-6 * usual[0]:.3g} N/µm under {size.pairs[0].preload:g} N in grooves of "
            f"{CONFORMITY:g} D, and no groove that is ground gives this. Is it the axial stiffness of a pair?"
        )
        raise SceneError.at(f"{size.title}: stiffness of a pair", f"{1e-6 * stiffnesses_printed[0]:.3g} N/µm", rule)
    falls = np.abs(np.gradient(np.log(curves), np.log(_TRIED), axis=0))
    by_one = _STIFFNESS / float(np.median([np.interp(middle, _TRIED, slope) for slope in falls.T]))
    scatter = max(float(np.median(np.abs(np.array(each) - middle))) / middle, by_one)
    several = f"{n} printed stiffnesses of pairs" if n > 1 else "the printed stiffness of a pair"
    both = _Number(round(middle, 4), scatter, f"meets {several}")
    return both, both


def _contact_angles(size: Printed, best: Candidate) -> dict[float, _Number]:
    """The angles [deg] at which one groove gives both stiffnesses of a pair, by the nominal ones; mean of the pairs of an angle.

    SceneError: stiffnesses that no angle gives together.
    """
    by_nominal: dict[float, list[tuple[float, float]]] = {}
    for pair in size.pairs:
        trial_angles = pair.contact_angle_deg + _TURNS
        axial, radial = both_stiffnesses(size, best, pair.preload, trial_angles[:, None], _TRIED, _TRIED)
        grooves = [np.interp(pair.stiffness, k[::-1], _TRIED[::-1], left=np.nan, right=np.nan) for k in axial]
        beside = np.array([np.interp(f, _TRIED, k) for f, k in zip(grooves, radial, strict=True)])
        trial_angles, beside = trial_angles[np.isfinite(beside)], beside[np.isfinite(beside)]
        if pair.radial is None or len(beside) < 2:
            continue  # no groove gives the axial one, which is refused with the conformity
        if not beside[-1] <= pair.radial <= beside[0]:
            rule = (
                f"contradicts the axial one, {1e-6 * pair.stiffness:.3g} N/µm under {pair.preload:g} N: grooves that give this at "
                f"{trial_angles[0]:.3g} to {trial_angles[-1]:.3g} deg have {1e-6 * beside[-1]:.3g} to {1e-6 * beside[0]:.3g} N/µm. Is it the radial "
                "stiffness of the pair, tilt locked?"
            )
            raise SceneError.at(f"{size.title}: radial stiffness of a pair", f"{1e-6 * pair.radial:.3g} N/µm", rule)
        angle = np.interp(pair.radial, beside[::-1], trial_angles[::-1])
        slope = np.interp(angle, trial_angles, np.abs(np.gradient(np.log(beside), np.log(trial_angles))))
        by_nominal.setdefault(pair.contact_angle_deg, []).append((angle, _STIFFNESS / slope))
    means = {nominal: np.mean(each, axis=0) for nominal, each in by_nominal.items()}
    why = "gives axial and radial stiffness of a pair"
    return {nominal: _Number(round(float(mean), 3), float(scatter), why) for nominal, (mean, scatter) in means.items()}
