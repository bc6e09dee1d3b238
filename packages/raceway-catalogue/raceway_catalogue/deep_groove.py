"""Balls of deep-groove bearings from printed ratings, by the tables of ISO 281 and ISO 76 at a contact angle of zero.

A rating at one angle leaves more freedom than ratings at several, and pitch diameters are up to 4 % off the mean of bore and outer
diameter.  So the candidates are weighed by what is printed: C, C0, where the maker prints it f_0, whose ratio C0 / f_0 = Z D^2 holds at any
pitch diameter; and by how deep-groove bearings are filled, which were measured over 256 sizes whose f_0 is printed.
"""

import numpy as np

from raceway.extend import BallRow
from raceway_catalogue.printed import Printed
from raceway_catalogue.rating_conventions import CONFORMITY, Candidate, ball_sizes

#: Conformities of both grooves: the largest that ISO 76 and ISO/TS 16281 rate deep-groove bearings with; makers print none.
GROOVES = 0.52, 0.53
#: 90 % of axial stiffnesses lie within this: of 6002, 6206 and 6316 with grooves of 0.515 to 0.525 inner and 0.52 to 0.535 outer and
#: clearances of class CN, under 2 to 10 % of C0.
STIFFNESS_ERROR = 0.35
#: Ball diameter over the section, and the share of the pitch circle that balls fill: limits, and mean with standard deviation.
_BALL, _FILL = (0.2, 0.42), (0.4, 0.8)
_USUAL, _SPREAD = np.array([0.57, 0.305]), np.array([0.045, 0.02])
#: Standard deviations of C, C0 and C0 / (f_0 Z D^2), relative: rounding of printed numbers, f_0 to 0.1.
_ROUNDING = np.array([0.003, 0.003, 0.004])
#: Pitch diameters over the mean of bore and outer diameter, and their standard deviation.
_PITCHES, _PITCH = np.linspace(0.95, 1.08, 27), 0.012
#: Log-odds of balls of whole and half mm, 4 of 256 sizes, and of the mean of bore and outer diameter itself.
_METRIC, _MEAN = -4.0, 2.0
#: Ratings that are further off are no candidates.
_FARTHEST = 0.045


def deep_groove_candidates(size: Printed) -> list[Candidate]:
    """Candidates of one size, balls of inch and of metric sizes, pitch diameters about the mean of bore and outer diameter."""
    rating, candidates = size.ratings[0], list[Candidate]()
    for factor in _PITCHES:
        pitch = factor * size.mean_diameter
        for metric in (False, True):
            for d in ball_sizes(_BALL[0] * size.section, _BALL[1] * size.section, metric):
                most = np.pi / np.arcsin(d / pitch)
                counts = np.arange(max(int(_FILL[0] * most), 4), int(_FILL[1] * most) + 1)
                row = BallRow(counts, d, pitch, 0.0)
                c, c0 = row.dynamic_rating() / rating.dynamic - 1.0, row.static_rating() / rating.static - 1.0
                by_factor = counts * (1e3 * d) ** 2 * (rating.static_factor or np.nan) / rating.static - 1.0
                off = np.nan_to_num(np.stack([c, c0, by_factor])) / _ROUNDING[:, None]
                shape = np.stack([counts * d / (np.pi * pitch), np.full(len(counts), d / size.section)])
                prior = (shape - _USUAL[:, None]) / _SPREAD[:, None]
                weight = -0.5 * ((off**2).sum(axis=0) + (prior**2).sum(axis=0) + (np.log(factor) / _PITCH) ** 2)
                weight += (_METRIC if metric else 0.0) + (_MEAN if abs(factor - 1.0) < 1e-9 else 0.0)
                for k in np.flatnonzero(np.maximum(abs(c), abs(c0)) <= _FARTHEST):
                    errors = (float(c[k]),), (float(c0[k]),)
                    balls, grooves = (int(counts[k]), float(d)), (CONFORMITY, CONFORMITY)
                    candidates.append(Candidate("tables", *balls, *grooves, *errors, float(weight[k]), None, float(factor)))
    return candidates
