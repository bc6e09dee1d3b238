"""How makers rate their bearings, and which ball counts and ball diameters explain what they print.

Two practices are known.  By the *tables* of ISO 281 and ISO 76: ratings as if all grooves were 0.52 D wide, so that C and C0 at any
contact angle give Z and D by themselves.  By their own *grooves*: the closed forms behind the tables at the conformity that the
bearing has, which makes C and C0 nearly the same equation in Z and conformity; only grooves and fillings of other bearings of that
maker, which prints their Z, D and d_m, tell the candidates apart.

Both give each candidate a log-density of what is printed, so that they can be compared where the maker is not known.

Notes
-----
C = b_m f_c cos(a)^0.7 Z^(2/3) D^1.8 with D in mm (3.647 D^1.4 above 25.4 mm) and C0 = f_0 Z D^2 cos(a), f_c and f_0 being
tabulated over g = D cos(a) / d_m for grooves of 0.52 D; one row of balls, lengths in metres.

Below g = 0.1 the table of f_0 bends down, because it allows an outer groove of 0.53 D, which then carries less than the inner one.
Makers whose outer groove is as narrow as the inner one go on with the inner race (one prints f_0 up to 16.8 for bearings of
g = 0.08): ``_static_factor`` is the table from 0.1 on and the inner race's Hertz load at 4200 MPa below.

References
----------
ISO 281:2007, table 2, and ISO/TR 1281-1:2021 (closed form of f_c); ISO 76:2006, table 1, and ISO/TR 10657:2021 (4200 MPa).
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import attrs
import numpy as np
from numpy.typing import ArrayLike

from raceway.studies.catalogue.printed import Printed, printed_by

#: Steps of Newton's method, of which four reach rounding at preloads that bearings have.
_NEWTON = 8
#: Points of the table, and the smallest (b/a)^2 in it.
_POINTS, _FLATTEST = 4000, 1e-6

#: b_m of single-row radial and angular-contact ball bearings of contemporary steel.
_MATERIAL_FACTOR = 1.3
#: Ball diameter [m] above which the exponent of D changes, and the pressure of the static rating [Pa].
_LARGE, _PERMITTED = 25.4e-3, 4200e6
#: Conformity of the standards' tables; modulus and Poisson's ratio of ISO/TR 10657.
_STANDARD, _YOUNG, _POISSON = 0.52, 207e9, 0.3
_MODULUS = 0.5 * _YOUNG / (1.0 - _POISSON**2)
#: f_c and f_0 over g = 0, 0.01 ... 0.40.
_F_C = np.array([
    0.0, 29.1, 35.8, 40.3, 43.8, 46.7, 49.1, 51.1, 52.8, 54.3, 55.5, 56.6, 57.5, 58.2,
    58.8, 59.3, 59.6, 59.8, 59.9, 60.0, 59.9, 59.8, 59.6, 59.3, 59.0, 58.6, 58.2, 57.7,
    57.1, 56.6, 56.0, 55.3, 54.6, 53.9, 53.2, 52.4, 51.7, 50.9, 50.0, 49.2, 48.4,
])  # fmt: skip
_F_0 = np.array([
    14.7, 14.9, 15.1, 15.3, 15.5, 15.7, 15.9, 16.1, 16.3, 16.5, 16.4, 16.1, 15.9, 15.6,
    15.4, 15.2, 14.9, 14.7, 14.4, 14.2, 14.0, 13.7, 13.5, 13.2, 13.0, 12.8, 12.5, 12.3,
    12.1, 11.8, 11.6, 11.4, 11.2, 10.9, 10.7, 10.5, 10.3, 10.0, 9.8, 9.6, 9.4,
])  # fmt: skip
_G = np.arange(_F_C.size) / 100.0
#: From here on the inner race limits the static rating.
_INNER_LIMITS = 10


@cache
def _table() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Curvature difference, (b/a)-scaled product a* b*, and delta* of growing ellipticity."""
    from scipy.special import ellipe, ellipkm1

    m1 = np.logspace(-1e-6, np.log10(_FLATTEST), _POINTS)
    first, second, chi2 = ellipkm1(m1), ellipe(1.0 - m1), 1.0 / m1
    difference = ((chi2 + 1.0) * second - 2.0 * first) / ((chi2 - 1.0) * second)
    area = (2.0 * chi2 * second / np.pi) ** (2.0 / 3.0) / np.sqrt(chi2)
    return difference, area, 2.0 * first / np.pi * (np.pi / (2.0 * chi2 * second)) ** (1.0 / 3.0)


def _groove(diameter: ArrayLike, g: ArrayLike, conformity: ArrayLike, inner: bool) -> tuple[np.ndarray, np.ndarray]:
    """Curvature sum [1/m] and difference of a ball in a groove, at g = D cos(a) / d_m; arrays that broadcast."""
    d, g, f = np.asarray(diameter), np.asarray(g), np.asarray(conformity)
    rolling = 2.0 * g / (1.0 - g) if inner else -2.0 * g / (1.0 + g)
    total = 4.0 - 1.0 / f + rolling
    return total / d, (1.0 / f + rolling) / total


def _load_at_pressure(curvature: np.ndarray, difference: np.ndarray, modulus: float, pressure: float) -> np.ndarray:
    """Load [N] at a peak pressure [Pa]: p = 1.5 Q / (pi a b), a b = a* b* (3 Q / (2 S E*))^(2/3)."""
    area = np.interp(difference, *_table()[:2])
    return (2.0 * np.pi * area * pressure / 3.0) ** 3 * (1.5 / (curvature * modulus)) ** 2


def _load_factor(curvature: np.ndarray, difference: np.ndarray, modulus: float) -> np.ndarray:
    """K [N/m^1.5] of Q = K delta^1.5."""
    differences, _, delta = _table()
    unit = 2.0 / (curvature * np.interp(difference, differences, delta))
    return 2.0 / 3.0 * curvature * modulus * unit**1.5


@attrs.frozen(eq=False)
class _BallRow:
    """One row of balls between its grooves; arrays that broadcast.

    count : Z;  diameter, pitch : D, d_m [m];  angle : free contact angle [rad]
    inner, outer : conformity r / D of the grooves, by default that of the standards' tables
    """

    count: np.ndarray = attrs.field(converter=np.asarray)
    diameter: np.ndarray = attrs.field(converter=np.asarray)
    pitch: np.ndarray = attrs.field(converter=np.asarray)
    angle: np.ndarray = attrs.field(converter=np.asarray)
    inner: np.ndarray = attrs.field(converter=np.asarray, default=_STANDARD)
    outer: np.ndarray = attrs.field(converter=np.asarray, default=_STANDARD)

    @property
    def gamma(self) -> np.ndarray:
        """g = D cos(a) / d_m."""
        return np.asarray(self.diameter * np.cos(self.angle) / self.pitch)

    @property
    def _grooves(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Curvature sum and difference at the inner and at the outer race."""
        races = ((self.inner, True), (self.outer, False))
        return [_groove(self.diameter, self.gamma, conformity, inner) for conformity, inner in races]

    def dynamic_rating(self) -> np.ndarray:
        """C of ISO 281 [N]; conformities other than the tables' change f_c as the closed form of ISO/TR 1281-1 does."""
        d, g = self.diameter, self.gamma
        size = np.where(d <= _LARGE, (1e3 * d) ** 1.8, 3.647 * (1e3 * d) ** 1.4)
        standard = np.asarray(_STANDARD)
        factor = np.interp(g, _G, _F_C) * _closed(g, self.inner, self.outer) / _closed(g, standard, standard)
        return np.asarray(_MATERIAL_FACTOR * factor * np.cos(self.angle) ** 0.7 * self.count ** (2.0 / 3.0) * size)

    def static_rating(self) -> np.ndarray:
        """C0 of ISO 76 [N], by its table, whatever the conformities."""
        return np.asarray(_static_factor(self.gamma) * self.count * (1e3 * self.diameter) ** 2 * np.cos(self.angle))

    def static_rating_of_grooves(self) -> np.ndarray:
        """C0 [N] of the grooves: Z Q cos(a) / 5 with Q the ball load at 4200 MPa on the race that reaches it first."""
        loads = [_load_at_pressure(*shape, _MODULUS, _PERMITTED) for shape in self._grooves]
        return np.asarray(self.count * np.minimum(*loads) * np.cos(self.angle) / 5.0)

    def pair_stiffness(self, preload: ArrayLike, young: float, poisson: float) -> np.ndarray:
        """Axial stiffness [N/m] of two such rows back to back or face to face under a rigid preload.

        preload : [N];  young, poisson : of balls and rings, [Pa] and 1
        """
        modulus = 0.5 * young / (1.0 - poisson**2)
        compliance = sum(_load_factor(*shape, modulus) ** (-2.0 / 3.0) for shape in self._grooves)
        factor = np.asarray(compliance) ** -1.5
        distance = (self.inner + self.outer - 1.0) * self.diameter
        stretch = _stretch(np.asarray(preload) / (self.count * factor * distance**1.5), np.cos(self.angle))
        cosine = np.cos(self.angle) / (1.0 + stretch)
        approach, length = stretch * distance, (1.0 + stretch) * distance
        along = 1.5 * factor * np.sqrt(approach) * (1.0 - cosine**2) + factor * approach**1.5 / length * cosine**2
        return np.asarray(2.0 * self.count * along)


def _stretch(load: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    """t = cos(a) / cos(b) - 1 of sin(b) t^1.5 = ``load``, by Newton's method from above: sin(b) is at least sin(a)."""
    t = (load / np.sqrt(1.0 - cosine**2)) ** (2.0 / 3.0)
    for _ in range(_NEWTON):
        sine = np.sqrt(1.0 - (cosine / (1.0 + t)) ** 2)
        slope = 1.5 * np.sqrt(t) * sine + t**1.5 * cosine**2 / ((1.0 + t) ** 3 * sine)
        t = t - (sine * t**1.5 - load) / slope
    return np.asarray(t)


def _closed(g: np.ndarray, fi: np.ndarray, fo: np.ndarray) -> np.ndarray:
    """The part of f_c that depends on g and on the conformities."""
    wide = (2.0 * fi / (2.0 * fi - 1.0)) ** 0.41
    both = 1.04 * ((1.0 - g) / (1.0 + g)) ** 1.72 * (fi / fo * (2.0 * fo - 1.0) / (2.0 * fi - 1.0)) ** 0.41
    return (1.0 + both ** (10.0 / 3.0)) ** -0.3 * wide


def _static_factor(g: ArrayLike) -> np.ndarray:
    """f_0 [N/mm2] of ISO 76, below g = 0.1 that of the inner race."""
    g = np.asarray(g, dtype=float)
    low = np.clip(g, 1e-3, 0.1)
    inner = _load_at_pressure(*_groove(1.0, low, _STANDARD, True), _MODULUS, _PERMITTED)
    edge = _load_at_pressure(*_groove(1.0, np.array(0.1), _STANDARD, True), _MODULUS, _PERMITTED)
    return np.where(g < 0.1, _F_0[_INNER_LIMITS] * inner / edge, np.interp(g, _G, _F_0))


_INCH = 25.4e-3
#: First and last size, and the step: in inches, and in m.
_BY_INCH = ((1 / 16, 31 / 64, 1 / 64), (1 / 2, 47 / 32, 1 / 32), (3 / 2, 4.0, 1 / 16))
_BY_MILLIMETRE = ((1e-3, 12.5e-3, 0.5e-3), (13e-3, 100e-3, 1e-3))
#: Relative distance up to which two sizes are one.
_SAME = 1e-6


def _ball_sizes(smallest: float, largest: float, metric: bool = False) -> np.ndarray:
    """Sizes (n,) [m] from ``smallest`` to ``largest`` [m], by inches or by mm."""
    unit, steps = (1.0, _BY_MILLIMETRE) if metric else (_INCH, _BY_INCH)
    sizes = np.concatenate([np.arange(first, last + 0.5 * step, step) for first, last, step in steps]) * unit
    return sizes[(sizes >= smallest) & (sizes <= largest)]


def size_words(diameter: float) -> str:
    """A size as people write it: 15/32 in, 6.5 mm."""
    parts = diameter / _INCH * 64.0
    if abs(parts - round(parts)) < _SAME * parts:
        top, bottom = round(parts), 64
        while top % 2 == 0 and bottom > 1:
            top, bottom = top // 2, bottom // 2
        return f"{top}/{bottom} in" if bottom > 1 else f"{top} in"
    return f"{1e3 * diameter:g} mm"


#: Limits within which the tables meet printed ratings, C and C0.
LIMITS = 0.006, 0.008
#: Times these limits beyond which a candidate explains nothing, and the least share of known bearings that resemble one.
_BEYOND, _LIKE = 1.6, 1e-6
#: Conformity that meets the printed stiffnesses of makers that rate by the tables, and the steel that it was fitted with [Pa].
CONFORMITY, YOUNG, POISSON = 0.522, 208e9, 0.3
#: Ball diameter over the section (outer diameter less bore), and the share of the pitch circle that balls fill, both generously.
_BALL, _FILL = (0.16, 0.45), (0.45, 0.97)
#: Grooves that the second practice is searched over: equal ones, and a wide inner one with the usual outer one.
_CONFORMITIES = np.linspace(0.506, 0.59, 337)
_WIDE_INNER, _USUAL_OUTER = 0.535, 0.522
#: Scatter (relative) of C, C0 and the mean stiffness by the tables; of C, stiffness by grooves, and of conformity.
_BY_TABLES = np.array([0.003, 0.003, 0.02])
_BY_GROOVES = np.array([0.006, 0.05])
_GROOVE = 0.0005
#: Scatter of filling and of D over the section within a family of sizes; of a family in (bore / outer diameter), log size and log D.
_SHAPE, _FAMILY, _SAME_BALL = np.array([0.02, 0.02]), np.array([0.03, 0.3]), 0.02
#: The same of all bearings of makers that rate by the tables: mean and scatter.
_TABLES_SHAPE, _TABLES_SCATTER = np.array([0.785, 0.29]), np.array([0.05, 0.02])
#: Misfit of the dynamic rating beyond which a candidate is none.
_NONE = 0.045


@attrs.frozen
class Candidate:
    """A ball count and diameter [m] with the conformities and misfits (relative, signed, computed less printed) that belong to it.

    ``weight``: log-density of what is printed; ``practice``: "tables" or "grooves"; ``alike``: share, from 0 to 1, of known
    bearings of the maker that resemble it, None by the tables.
    """

    practice: str
    ball_count: int
    ball_diameter: float
    conformity_inner: float
    conformity_outer: float
    dynamic_errors: tuple[float, ...]
    static_errors: tuple[float, ...]
    weight: float
    alike: float | None = None

    @property
    def explains(self) -> bool:
        """Whether it is an answer at all: ratings met, or such a bearing known."""
        return self.misfit <= _BEYOND if self.alike is None else self.alike >= _LIKE

    @property
    def misfit(self) -> float:
        """Largest error of a rating over its limit."""
        worst = [max(map(abs, errors)) for errors in (self.dynamic_errors, self.static_errors)]
        return max(error / limit for error, limit in zip(worst, LIMITS, strict=True))


def stiffnesses(size: Printed, count: ArrayLike, diameter: float, inner: ArrayLike, outer: ArrayLike) -> np.ndarray:
    """Axial stiffness [N/m] of each printed pair, (..., n), of counts and conformities (...)."""
    angle = np.radians([pair.contact_angle_deg for pair in size.pairs])
    count, inner, outer = (np.asarray(x)[..., None] for x in (count, inner, outer))
    row = _BallRow(count, diameter, size.mean_diameter, angle, inner, outer)
    return row.pair_stiffness([pair.preload for pair in size.pairs], YOUNG, POISSON)


def _misfits(size: Printed, count: ArrayLike, diameter: float, inner: ArrayLike, outer: ArrayLike) -> np.ndarray:
    return stiffnesses(size, count, diameter, inner, outer) / [pair.stiffness for pair in size.pairs] - 1.0


def _trials(size: Printed, metric: bool = False) -> Iterator[tuple[float, np.ndarray]]:
    """Ball diameters [m] with the counts that fill the pitch circle as bearings do."""
    for d in _ball_sizes(_BALL[0] * size.section, _BALL[1] * size.section, metric):
        most = np.pi / np.arcsin(d / size.mean_diameter)
        counts = np.arange(max(int(_FILL[0] * most), 4), int(_FILL[1] * most) + 2)
        yield float(d), counts[counts <= most]


def by_tables(size: Printed, metric: bool = False) -> list[Candidate]:
    """Candidates by the tables of ISO 281 and ISO 76; balls of inch sizes, or of whole and half mm."""
    candidates = []
    for d, counts in _trials(size, metric):
        row = _BallRow(counts[:, None], d, size.mean_diameter, size.angles)
        dynamic, static = row.dynamic_rating() / size.dynamic - 1.0, row.static_rating() / size.static - 1.0
        met = np.maximum(np.abs(dynamic), np.abs(static)).max(axis=1) <= _NONE
        stiffness = _misfits(size, counts[met], d, CONFORMITY, CONFORMITY)
        for z, c, c0, stiff in zip(counts[met], dynamic[met], static[met], stiffness, strict=True):
            off = np.array([*(np.abs(x).max() for x in (c, c0)), stiff.mean() if stiff.size else 0.0]) / _BY_TABLES
            shape = (np.array(_shape(size, int(z), d)[:2]) - _TABLES_SHAPE) / _TABLES_SCATTER
            weight = -0.5 * (off @ off + shape @ shape) - np.log([*_BY_TABLES, *_TABLES_SCATTER]).sum()
            candidates.append(Candidate("tables", int(z), d, CONFORMITY, CONFORMITY, tuple(c), tuple(c0), float(weight)))
    return candidates


def _fitted(size: Printed, d: float, counts: np.ndarray, wide: bool) -> tuple[np.ndarray, np.ndarray]:
    """Inner conformity (n,) by C0 of the first angle, NaN where no groove gives it, and log-error of C with it, of counts (n,)."""
    angle, pitch, f = size.angles[0], size.mean_diameter, _CONFORMITIES
    rating = _BallRow(1.0, d, pitch, angle, f, np.full_like(f, _USUAL_OUTER) if wide else f).static_rating_of_grooves()
    order = np.argsort(rating)
    inner = np.interp(size.static[0] / counts, rating[order], f[order], left=np.nan, right=np.nan)
    if wide:
        inner = np.where(inner < _WIDE_INNER, np.nan, inner)
    row = _BallRow(counts, d, pitch, angle, inner, np.full_like(inner, _USUAL_OUTER) if wide else inner)
    return inner, np.log(row.dynamic_rating() / size.dynamic[0])


@cache
def _printed_bearings() -> np.ndarray:
    """Records (n,) of the bearings whose maker prints balls and pitch diameter."""
    records = []
    for size in printed_by("gmn"):
        if size.internals is None:
            continue
        z, d = size.internals.ball_count, size.internals.ball_diameter
        # Narrow grooves give C and C0 by one conformity; a wide inner groove is seen by C0, which it alone limits.
        (narrow, narrow_error), (inner, wide_error) = (_fitted(size, d, np.array([z]), each) for each in (False, True))
        wide = bool(np.isfinite(inner[0])) and abs(wide_error[0]) < abs(narrow_error[0])
        f, dynamic = (float(inner[0]), wide_error[0]) if wide else (float(narrow[0]), narrow_error[0])
        stiff = np.log1p(_misfits(size, z, d, f, _USUAL_OUTER if wide else f)).mean()
        angle = size.ratings[0].contact_angle_deg
        records.append((size.names[0], wide, d, angle, f, dynamic, stiff, *_shape(size, z, d)))
    numbers = "diameter", "angle", "conformity", "dynamic", "stiffness", "fill", "ball", "bore", "size"
    return np.array(records, dtype=[("name", object), ("wide", bool), *((name, float) for name in numbers)])


def _shape(size: Printed, z: int, d: float) -> tuple[float, float, float, float]:
    """Filling of the pitch circle, D over the section, bore over outer diameter, log of the outer diameter."""
    ratio, log_size = size.bore / size.outer_diameter, float(np.log(size.outer_diameter))
    return z * d / (np.pi * size.mean_diameter), d / size.section, ratio, log_size


def _bell(*offs: np.ndarray) -> np.ndarray:
    return np.exp(-0.5 * sum(off**2 for off in offs))


def by_grooves(size: Printed, without: str = "") -> list[Candidate]:
    """Candidates by the maker's own grooves.

    Parameters
    ----------
    without : designation of a printed bearing that is left out, to test the method on it
    """
    bearings, candidates = _printed_bearings(), []
    references = bearings["name"] != without
    same = zip((bearings["bore"], bearings["size"]), _shape(size, 1, 1.0)[2:], _FAMILY, strict=True)
    family = references * _bell(*((x - y) / s for x, y, s in same))
    for d, counts in _trials(size):
        near = np.log(bearings["diameter"] / d)
        ball = references * (_bell(near / _SAME_BALL) + 0.02 * _bell(near / 0.3))
        for wide in (False, True):
            alike = bearings["wide"] == wide
            angles = _bell((bearings["angle"] - size.ratings[0].contact_angle_deg) / 6.0) if wide else 1.0
            width = _GROOVE * (4.0 if wide else 1.0)
            inner, dynamic = _fitted(size, d, counts, wide)
            met = np.isfinite(inner) & (np.abs(dynamic) <= _NONE)
            stiffness = _misfits(size, counts[met], d, inner[met], _USUAL_OUTER if wide else inner[met])
            for z, f, c, stiff in zip(counts[met], inner[met], dynamic[met], stiffness, strict=True):
                outer = _USUAL_OUTER if wide else float(f)
                offs = [(f - bearings["conformity"]) / width, (c - bearings["dynamic"]) / _BY_GROOVES[0]]
                offs += [(np.log1p(stiff).mean() - bearings["stiffness"]) / _BY_GROOVES[1]] if size.pairs else []
                grooves = (ball * alike * angles * _bell(*offs)).sum() / ((ball * alike * angles).sum() + 1e-9)
                fill, share, *_ = _shape(size, int(z), d)
                shape = _bell((fill - bearings["fill"]) / _SHAPE[0], (share - bearings["ball"]) / _SHAPE[1])
                likely = (family * alike * shape).sum() / (family.sum() + 1e-9)
                # A width of the conformity is one of C0: C0 falls with (2 f - 1)^0.64.
                spread = 0.64 * 2.0 * width / (2.0 * f - 1.0)
                weight = np.log(grooves + 1e-7) + np.log(likely + 1e-5) - np.log([spread, *_BY_GROOVES, *_SHAPE]).sum()
                errors = (float(np.expm1(c)),), (0.0,)
                alike_share = float(grooves * likely)
                candidates.append(Candidate("grooves", int(z), d, float(f), outer, *errors, float(weight), alike_share))
    return candidates
