"""How makers rate their bearings, and which ball counts and ball diameters explain what they print.

Two practices are known.  By the *tables* of ISO 281 and ISO 76: ratings as if all grooves were 0.52 D wide, so that C and C0 at any
contact angle give Z and D by themselves.  By their own *grooves*: the closed forms behind the tables at the conformity that the
bearing has, which makes C and C0 nearly the same equation in Z and conformity; only grooves and fillings of other bearings of that
maker, which prints their Z, D and d_m, tell the candidates apart.

Both give each candidate a log-density of what is printed, so that they can be compared where the maker is not known.
"""

from __future__ import annotations

from functools import cache

import attrs
import numpy as np
from numpy.typing import ArrayLike

from raceway.studies.catalogue.printed import Printed, printed_by
from raceway.studies.catalogue.ratings import dynamic_rating, pair_stiffness, static_rating, static_rating_of_grooves

_INCH = 25.4e-3
#: First and last size, and the step: in inches, and in m.
_BY_INCH = ((1 / 16, 31 / 64, 1 / 64), (1 / 2, 47 / 32, 1 / 32), (3 / 2, 4.0, 1 / 16))
_BY_MILLIMETRE = ((1e-3, 12.5e-3, 0.5e-3), (13e-3, 100e-3, 1e-3))
#: Relative distance up to which two sizes are one.
_SAME = 1e-6


def ball_sizes(smallest: float, largest: float, metric: bool = False) -> np.ndarray:
    """Sizes (n,) [m] from ``smallest`` to ``largest`` [m], by inches or by mm."""
    unit, steps = (1.0, _BY_MILLIMETRE) if metric else (_INCH, _BY_INCH)
    every = np.concatenate([np.arange(first, last + 0.5 * step, step) for first, last, step in steps]) * unit
    return every[(every >= smallest) & (every <= largest)]


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
BEYOND, LIKE = 1.6, 1e-6
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
    stiffness_errors: tuple[float, ...]
    weight: float
    alike: float | None = None

    @property
    def explains(self) -> bool:
        """Whether it is an answer at all: ratings met, or such a bearing known."""
        return self.misfit <= BEYOND if self.alike is None else self.alike >= LIKE

    @property
    def misfit(self) -> float:
        """Largest error of a rating over its limit."""
        worst = [max(map(abs, errors)) for errors in (self.dynamic_errors, self.static_errors)]
        return max(error / limit for error, limit in zip(worst, LIMITS, strict=True))


def stiffnesses(one: Printed, count: ArrayLike, diameter: float, inner: ArrayLike, outer: ArrayLike) -> np.ndarray:
    """Axial stiffness [N/m] of each printed pair, (..., n), of counts and conformities (...)."""
    angle = np.radians([pair.contact_angle_deg for pair in one.pairs])
    preload = np.array([pair.preload for pair in one.pairs])
    count, inner, outer = (np.asarray(x)[..., None] for x in (count, inner, outer))
    return pair_stiffness(count, diameter, one.mean_diameter, angle, inner, outer, preload, YOUNG, POISSON)


def _misfits(one: Printed, count: ArrayLike, diameter: float, inner: ArrayLike, outer: ArrayLike) -> np.ndarray:
    return stiffnesses(one, count, diameter, inner, outer) / [pair.stiffness for pair in one.pairs] - 1.0


def _trials(one: Printed, metric: bool = False) -> list[tuple[float, np.ndarray]]:
    """Ball diameters [m] with the counts that fill the pitch circle as bearings do."""
    found = []
    for d in ball_sizes(_BALL[0] * one.section, _BALL[1] * one.section, metric):
        most = np.pi / np.arcsin(d / one.mean_diameter)
        counts = np.arange(max(int(_FILL[0] * most), 4), int(_FILL[1] * most) + 2)
        found.append((float(d), counts[counts <= most]))
    return found


def by_tables(one: Printed, metric: bool = False) -> list[Candidate]:
    """Candidates by the tables of ISO 281 and ISO 76, the likeliest first; balls of inch sizes, or of whole and half mm."""
    angle, pitch, found = one.column("angle"), one.mean_diameter, []
    for d, counts in _trials(one, metric):
        dynamic = dynamic_rating(counts[:, None], d, pitch, angle) / one.column("dynamic") - 1.0
        static = static_rating(counts[:, None], d, pitch, angle) / one.column("static") - 1.0
        there = np.maximum(np.abs(dynamic), np.abs(static)).max(axis=1) <= _NONE
        stiffness = _misfits(one, counts[there], d, CONFORMITY, CONFORMITY)
        for z, c, c0, stiff in zip(counts[there], dynamic[there], static[there], stiffness, strict=True):
            off = np.array([*(np.abs(x).max() for x in (c, c0)), stiff.mean() if stiff.size else 0.0]) / _BY_TABLES
            shape = (np.array(_shape(one, int(z), d)[:2]) - _TABLES_SHAPE) / _TABLES_SCATTER
            weight = -0.5 * (off @ off + shape @ shape) - np.log([*_BY_TABLES, *_TABLES_SCATTER]).sum()
            found.append(
                Candidate("tables", int(z), d, CONFORMITY, CONFORMITY, tuple(c), tuple(c0), tuple(stiff), float(weight))
            )
    return sorted(found, key=lambda x: -x.weight)


@attrs.frozen
class _Fitted:
    """Grooves that explain a static rating, for one ball diameter and all counts (n,)."""

    wide: bool
    conformity: np.ndarray
    dynamic: np.ndarray


def _fitted(one: Printed, d: float, counts: np.ndarray, wide: bool) -> _Fitted:
    """Inner conformity from C0 (of the first angle), error of C with it; NaN where no groove gives C0."""
    angle, pitch, f = one.column("angle")[0], one.mean_diameter, _CONFORMITIES
    outer = np.full_like(f, _USUAL_OUTER) if wide else f
    rating = static_rating_of_grooves(1.0, d, pitch, angle, f, outer)
    wanted = one.column("static")[0] / counts
    order = np.argsort(rating)
    inner = np.interp(wanted, rating[order], f[order], left=np.nan, right=np.nan)
    if wide:
        inner = np.where(inner < _WIDE_INNER, np.nan, inner)
    own = np.full_like(inner, _USUAL_OUTER) if wide else inner
    return _Fitted(wide, inner, np.log(dynamic_rating(counts, d, pitch, angle, inner, own) / one.column("dynamic")[0]))


@attrs.frozen(eq=False)
class _Known:
    """Columns (n,) of the bearings whose maker prints balls and pitch diameter."""

    name: np.ndarray
    wide: np.ndarray
    diameter: np.ndarray
    angle: np.ndarray
    conformity: np.ndarray
    dynamic: np.ndarray
    stiffness: np.ndarray
    fill: np.ndarray
    ball: np.ndarray
    bore: np.ndarray
    size: np.ndarray


@cache
def _known() -> _Known:
    rows = []
    for one in printed_by("gmn"):
        inside = one.internals
        if inside is None:
            continue
        z, d = inside.ball_count, inside.ball_diameter
        # Narrow grooves give C and C0 by one conformity; a wide inner groove is seen by C0, which it alone limits.
        narrow, wide = (_fitted(one, d, np.array([z]), each) for each in (False, True))
        is_wide = bool(np.isfinite(wide.conformity[0])) and abs(wide.dynamic[0]) < abs(narrow.dynamic[0])
        kind = wide if is_wide else narrow
        f = float(kind.conformity[0])
        stiff = np.log1p(_misfits(one, z, d, f, _USUAL_OUTER if is_wide else f)).mean()
        rows.append(
            (one.names[0], is_wide, d, one.ratings[0].contact_angle_deg, f, kind.dynamic[0], stiff, *_shape(one, z, d))
        )
    return _Known(*(np.array(column) for column in zip(*rows, strict=True)))


def _shape(one: Printed, z: int, d: float) -> tuple[float, float, float, float]:
    """Filling of the pitch circle, D over the section, bore over outer diameter, log of the outer diameter."""
    return (
        z * d / (np.pi * one.mean_diameter),
        d / one.section,
        one.bore / one.outer_diameter,
        float(np.log(one.outer_diameter)),
    )


def _bell(*offs: np.ndarray) -> np.ndarray:
    return np.exp(-0.5 * sum(off**2 for off in offs))


def by_grooves(one: Printed, without: str = "") -> list[Candidate]:
    """Candidates by the maker's own grooves, the likeliest first.

    Parameters
    ----------
    without : designation of a known bearing that is left out, to test the method on it
    """
    known, found = _known(), []
    here = known.name != without
    family = here * _bell(
        *((x - y) / s for x, y, s in zip((known.bore, known.size), _shape(one, 1, 1.0)[2:], _FAMILY, strict=True))
    )
    for d, counts in _trials(one):
        near = np.log(known.diameter / d)
        ball = here * (_bell(near / _SAME_BALL) + 0.02 * _bell(near / 0.3))
        for fit in (_fitted(one, d, counts, wide) for wide in (False, True)):
            alike = known.wide == fit.wide
            angles = _bell((known.angle - one.ratings[0].contact_angle_deg) / 6.0) if fit.wide else 1.0
            width = _GROOVE * (4.0 if fit.wide else 1.0)
            there = np.isfinite(fit.conformity) & (np.abs(fit.dynamic) <= _NONE)
            inner, dynamic = fit.conformity[there], fit.dynamic[there]
            stiffness = _misfits(one, counts[there], d, inner, _USUAL_OUTER if fit.wide else inner)
            for z, f, c, stiff in zip(counts[there], inner, dynamic, stiffness, strict=True):
                outer = _USUAL_OUTER if fit.wide else float(f)
                offs = [(f - known.conformity) / width, (c - known.dynamic) / _BY_GROOVES[0]]
                offs += [(np.log1p(stiff).mean() - known.stiffness) / _BY_GROOVES[1]] if one.pairs else []
                grooves = (ball * alike * angles * _bell(*offs)).sum() / ((ball * alike * angles).sum() + 1e-9)
                fill, share, *_ = _shape(one, int(z), d)
                shape = _bell((fill - known.fill) / _SHAPE[0], (share - known.ball) / _SHAPE[1])
                likely = (family * alike * shape).sum() / (family.sum() + 1e-9)
                # A width of the conformity is one of C0: C0 falls with (2 f - 1)^0.64.
                spread = 0.64 * 2.0 * width / (2.0 * f - 1.0)
                weight = np.log(grooves + 1e-7) + np.log(likely + 1e-5) - np.log([spread, *_BY_GROOVES, *_SHAPE]).sum()
                errors = (float(np.expm1(c)),), (0.0,), tuple(stiff)
                alike_share = float(grooves * likely)
                found.append(Candidate("grooves", int(z), d, float(f), outer, *errors, float(weight), alike_share))
    return sorted(found, key=lambda x: -x.weight)
