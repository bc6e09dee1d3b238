"""What is known of the stiffness of inferred bearings: each series from the grooves of the others, radially by printed factors."""

from __future__ import annotations

import re
from collections import defaultdict

import numpy as np

import raceway as rw
from benchmarks.evidence import Row, below
from raceway.studies.infer.practices import stiffnesses
from raceway.studies.infer.printed import Printed, printed_by

COMMAND = "python -m benchmarks.meaning catalogue"
#: Conformities that are tried, of both grooves.
_TRIED = np.linspace(0.505, 0.57, 131)
#: Radial over axial stiffness of pairs by preload class, NSK, Super precision bearings, the factors of 15 and 30 deg (as in case nsk-7206C-stiffness).
_FACTORS = {15.0: (6.5, 6.0, 5.0, 4.5), 30.0: (1.4, 1.4, 1.4, 1.4)}
_SUFFIX = {15.0: "C", 30.0: "A"}


def rows() -> list[Row]:
    return [*_axial(), _radial(), *_other_maker()]


def _misfits(one: Printed, count: int, diameter: float) -> np.ndarray:
    """(n, f) computed over printed stiffness, less 1, of each printed pair at each conformity."""
    printed = np.array([pair.stiffness for pair in one.pairs])
    return (stiffnesses(one, count, diameter, _TRIED, _TRIED) / printed - 1.0).T


def _best(misfits: np.ndarray) -> int:
    return int(np.median(np.abs(misfits), axis=0).argmin())


def _axial() -> list[Row]:
    """Series 70 from the grooves of 7206, and the reverse."""
    series = np.concatenate([_misfits(one, *_balls(one)) for one in printed_by("nsk") if one.pairs])
    case = {15: ((60, 32e6), (120, 43e6), (290, 66e6), (590, 94e6)), 30: ((50, 85e6), (380, 175e6), (630, 210e6))}
    size = {"arrangement": "DB", "preset": "7206C", "conformity_inner": 0.0, "conformity_outer": 0.0}
    other = []
    for angle, pairs in case.items():
        for preload, printed in pairs:
            curve = [
                rw.run({"bearing": {**size, "conformity_inner": f, "conformity_outer": f, "contact_angle_deg": angle, "preload": preload}})
                .stiffness[0, 0] / printed - 1.0
                for f in (0.518, 0.522, 0.526)
            ]  # fmt: skip
            other.append(np.interp(_TRIED, (0.518, 0.522, 0.526), curve, left=1.0, right=1.0))
    sizes = np.array(other)
    stated = rw.catalogue("7014C")[0].stiffness_error
    held_out = np.quantile(np.abs(series[:, _best(sizes)]), 0.9), np.abs(sizes[:, _best(series)]).max()
    return [
        below("384 axial stiffnesses of series 70 in the grooves of 7206: 90 % within", float(held_out[0]), stated, COMMAND,
              f"r/D {_TRIED[_best(sizes)]:.4f}; series 70 alone gives {_TRIED[_best(series)]:.4f}"),
        below("7 axial stiffnesses of 7206C, 7206A in the grooves of series 70: largest", float(held_out[1]), 0.04, COMMAND, "the tolerance of case nsk-7206C-stiffness"),
    ]  # fmt: skip


def _balls(one: Printed) -> tuple[int, float]:
    table = rw.catalogue(one.names[0])[0].table
    return int(table["ball_count"]), float(table["ball_diameter"])


def _radial() -> Row:
    off = []
    for one in printed_by("nsk"):
        for angle, factors in _FACTORS.items():
            pairs = [pair for pair in one.pairs if pair.contact_angle_deg == angle]
            name = next((name for name in one.names if name.endswith(_SUFFIX[angle])), None)
            for pair, factor in zip(pairs, factors, strict=False):
                k = rw.run({"bearing": {"preset": name, "arrangement": "DB", "preload": pair.preload}}).stiffness[1, 1]
                off.append(abs(k / (factor * pair.stiffness) - 1.0))
    stated = rw.catalogue("7014C")[0].radial_stiffness_error
    note = f"{len(off)} pairs of 15 and 30 deg, tilt locked; the factors are rounded by up to 4 %"
    return below(
        "radial stiffness of series 70 against the maker's factors: 90 % within",
        float(np.quantile(off, 0.9)),
        stated,
        COMMAND,
        note,
    )


def _other_maker() -> list[Row]:
    """Each series of the maker that prints its balls, from one groove of his other series: what a series without printed stiffness may be off."""
    series: dict[str, list[np.ndarray]] = defaultdict(list)
    for one in printed_by("gmn"):
        word = re.match(r"[A-Z]+ (618|619|60|62)", one.names[0])
        if word and one.internals is not None and one.pairs:
            series[word[1]].append(_misfits(one, one.internals.ball_count, one.internals.ball_diameter))
    off = []
    for name, own in series.items():
        others = np.concatenate([part for other, parts in series.items() if other != name for part in parts])
        off.append(np.abs(np.concatenate(own)[:, _best(others)]))
    stated = rw.catalogue("7914C")[0].stiffness_error
    note = ", ".join(f"{name} {100.0 * np.quantile(part, 0.9):.0f} %" for name, part in zip(series, off, strict=True))
    value = float(np.quantile(np.concatenate(off), 0.9))
    return [
        below(
            "a series left out, of another maker's four: 90 % of its axial stiffnesses within", value, stated, COMMAND, note
        )
    ]
