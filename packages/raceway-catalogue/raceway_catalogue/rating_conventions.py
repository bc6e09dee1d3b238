"""How makers rate their bearings, and which ball counts and ball diameters explain what they print.

Two practices are known.  By the *tables* of ISO 281 and ISO 76: ratings as if all grooves were 0.52 D wide, so that C and C0 at any
contact angle give Z and D by themselves.  By their own *grooves*: the closed forms behind the tables at the conformity that the
bearing has, which makes C and C0 nearly the same equation in Z and conformity; only grooves and fillings of other bearings of that
maker, which prints their Z, D and d_m, tell the candidates apart.

Both give each candidate a log-density of what is printed, so that they can be compared where the maker is not known.
"""

from collections.abc import Iterator
from functools import cache

import attrs
import numpy as np
from numpy.typing import ArrayLike

from raceway.extend import BallRow
from raceway_catalogue.printed import Printed, printed_by

#: Steps of Newton's method, of which four reach rounding at preloads that bearings have.
_NEWTON = 8


def pair_stiffness(row: BallRow, preload: ArrayLike, young: float, poisson: float) -> np.ndarray:
    """Axial and radial stiffness (2, ...) [N/m], tilt locked, of two such rows back to back or face to face under a rigid preload.

    preload : [N];  young, poisson : of balls and rings, [Pa] and 1
    """
    factor = row.load_factor(0.5 * young / (1.0 - poisson**2))
    distance = (row.inner + row.outer - 1.0) * row.diameter
    load, free = np.asarray(preload) / (row.count * factor * distance**1.5), np.cos(row.angle)
    # t = cos(a) / cos(b) - 1 of sin(b) t^1.5 = load, by Newton's method from above: sin(b) is at least sin(a).
    stretch = (load / np.sqrt(1.0 - free**2)) ** (2.0 / 3.0)
    for _ in range(_NEWTON):
        sine = np.sqrt(1.0 - (free / (1.0 + stretch)) ** 2)
        slope = 1.5 * np.sqrt(stretch) * sine + stretch**1.5 * free**2 / ((1.0 + stretch) ** 3 * sine)
        stretch = stretch - (sine * stretch**1.5 - load) / slope
    cosine = free / (1.0 + stretch)
    approach, length = stretch * distance, (1.0 + stretch) * distance
    normal, across = 1.5 * factor * np.sqrt(approach), factor * approach**1.5 / length
    axial, radial = normal + (across - normal) * cosine**2, 0.5 * (across + (normal - across) * cosine**2)
    return np.asarray(2.0 * row.count * np.stack([axial, radial]))


_INCH = 25.4e-3
#: First and last size, and the step: in inches, and in m.
_BY_INCH = ((1 / 32, 31 / 64, 1 / 64), (1 / 2, 47 / 32, 1 / 32), (3 / 2, 4.0, 1 / 16))
_BY_MILLIMETRE = ((1e-3, 12.5e-3, 0.5e-3), (13e-3, 100e-3, 1e-3))
#: Relative distance up to which two sizes are one.
_SAME = 1e-6


def ball_sizes(smallest: float, largest: float, metric: bool = False) -> np.ndarray:
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
    bearings of the maker that resemble it, None by the tables; ``pitch_factor``: pitch diameter over the mean of bore and outer
    diameter.
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
    pitch_factor: float = 1.0

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
    row = BallRow(count, diameter, size.mean_diameter, angle, inner, outer)
    return np.asarray(pair_stiffness(row, [pair.preload for pair in size.pairs], YOUNG, POISSON)[0])


def both_stiffnesses(
    size: Printed, balls: Candidate, preload: float, angle_deg: ArrayLike, inner: ArrayLike, outer: ArrayLike
) -> np.ndarray:
    """Axial and radial stiffness (2, ...) [N/m] of a pair under a preload [N], of contact angles [deg] and conformities (...)."""
    row = BallRow(balls.ball_count, balls.ball_diameter, size.mean_diameter, np.radians(angle_deg), inner, outer)
    return pair_stiffness(row, preload, YOUNG, POISSON)


def _misfits(size: Printed, count: ArrayLike, diameter: float, inner: ArrayLike, outer: ArrayLike) -> np.ndarray:
    return stiffnesses(size, count, diameter, inner, outer) / [pair.stiffness for pair in size.pairs] - 1.0


def _trials(size: Printed, metric: bool = False) -> Iterator[tuple[float, np.ndarray]]:
    """Ball diameters [m] with the counts that fill the pitch circle as bearings do."""
    for d in ball_sizes(_BALL[0] * size.section, _BALL[1] * size.section, metric):
        most = np.pi / np.arcsin(d / size.mean_diameter)
        counts = np.arange(max(int(_FILL[0] * most), 4), int(_FILL[1] * most) + 2)
        yield float(d), counts[counts <= most]


def by_tables(size: Printed, metric: bool = False) -> list[Candidate]:
    """Candidates by the tables of ISO 281 and ISO 76; balls of inch sizes, or of whole and half mm."""
    candidates = []
    for d, counts in _trials(size, metric):
        row = BallRow(counts[:, None], d, size.mean_diameter, size.angles)
        dynamic, static = row.dynamic_rating() / size.dynamic - 1.0, row.static_rating() / size.static - 1.0
        agreement = np.maximum(np.abs(dynamic), np.abs(static)).max(axis=1) <= _NONE
        stiffness = _misfits(size, counts[agreement], d, CONFORMITY, CONFORMITY)
        for z, c, c0, stiff in zip(counts[agreement], dynamic[agreement], static[agreement], stiffness, strict=True):
            off = np.array([*(np.abs(x).max() for x in (c, c0)), stiff.mean() if stiff.size else 0.0]) / _BY_TABLES
            shape = (np.array(_shape(size, int(z), d)[:2]) - _TABLES_SHAPE) / _TABLES_SCATTER
            weight = -0.5 * (off @ off + shape @ shape) - np.log([*_BY_TABLES, *_TABLES_SCATTER]).sum()
            candidates.append(Candidate("tables", int(z), d, CONFORMITY, CONFORMITY, tuple(c), tuple(c0), float(weight)))
    return candidates


def _grooves(size: Printed, d: float, counts: np.ndarray, wide: bool) -> tuple[np.ndarray, np.ndarray]:
    """Inner conformity (n,) by C0 of the first angle, NaN where no groove gives it, and log-error of C with it, of counts (n,)."""
    angle, pitch, f = size.angles[0], size.mean_diameter, _CONFORMITIES
    rating = BallRow(1.0, d, pitch, angle, f, np.full_like(f, _USUAL_OUTER) if wide else f).static_rating_of_grooves()
    order = np.argsort(rating)
    inner = np.interp(size.static[0] / counts, rating[order], f[order], left=np.nan, right=np.nan)
    if wide:
        inner = np.where(inner < _WIDE_INNER, np.nan, inner)
    row = BallRow(counts, d, pitch, angle, inner, np.full_like(inner, _USUAL_OUTER) if wide else inner)
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
        (narrow, narrow_error), (inner, wide_error) = (_grooves(size, d, np.array([z]), each) for each in (False, True))
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
    """Candidates by the maker's own grooves, a printed bearing (its designation) left out to test the method on it."""
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
            inner, dynamic = _grooves(size, d, counts, wide)
            agreement = np.isfinite(inner) & (np.abs(dynamic) <= _NONE)
            stiffness = _misfits(size, counts[agreement], d, inner[agreement], _USUAL_OUTER if wide else inner[agreement])
            for z, f, c, stiff in zip(counts[agreement], inner[agreement], dynamic[agreement], stiffness, strict=True):
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
