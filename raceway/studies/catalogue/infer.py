"""Balls and grooves of a bearing from what its maker prints, for Python: ``raceway.infer``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np

from raceway.errors import SceneError
from raceway.framework.doors import door
from raceway.scene.units import number_in
from raceway.storage.tables import Tables
from raceway.studies.catalogue.inferred import Inferred, infer_printed
from raceway.studies.catalogue.printed import PairStiffness, Printed, Rating, Table, printed_by, read_table, sizes_of

#: A number in SI units, or text with a unit.
Quantity = float | str


@door
def infer(
    bore: Quantity,
    outer_diameter: Quantity,
    ratings: Mapping[float, tuple[Quantity, Quantity]],
    *,
    width: Quantity | None = None,
    pairs: Iterable[tuple[float, Quantity, Quantity]] = (),
    name: str = "",
    maker: str | None = None,
    conformity: float | None = None,
) -> Inferred:
    """Ball count, ball diameter, pitch diameter and conformity of an angular-contact ball bearing from what its maker prints.

    Parameters
    ----------
    bore, outer_diameter, width : [m], or text such as "70 mm"
    ratings : by contact angle [deg], basic load ratings (dynamic C, static C0) [N]; all angles of a size that are printed
    pairs : (contact angle [deg], preload [N], axial stiffness [N/m]) of pairs back to back or face to face
    name : designation
    maker : "NSK" rates by the tables of ISO 281 and ISO 76, "GMN" by its own grooves; None: what explains the ratings better
    conformity : of both grooves, where it is known; None: from ``pairs``, else 0.522

    Returns
    -------
    Inferred
        Each number with its scatter and reason; ``bearing()`` is the [bearing] table of a scene

    Raises
    ------
    SceneError
        Ratings that contradict each other, that no whole number of balls explains, or that are no numbers of their unit.

    Examples
    --------
    >>> import raceway as rw
    >>> found = rw.infer("70 mm", "110 mm", {15: ("47 kN", "43 kN"), 25: ("44.5 kN", "41 kN")}, width="20 mm")
    >>> found.ball_count.value, found.conformity_inner.value
    (20, 0.522)
    >>> result = rw.run({"bearing": found.bearing(25), "load": {"axial": 1000.0}})
    >>> round(float(result.stiffness[0, 0]) * 1e-6, 1)  # axial [N/um]
    142.8
    """
    one = Printed(
        bore=quantity("bore", "m", bore),
        outer_diameter=quantity("outer diameter", "m", outer_diameter),
        width=None if width is None else quantity("width", "m", width),
        ratings=tuple(
            Rating(angle, quantity("dynamic rating", "N", c), quantity("static rating", "N", c0))
            for angle, (c, c0) in ratings.items()
        ),
        pairs=tuple(
            PairStiffness(angle, quantity("preload", "N", load), quantity("stiffness", "N/m", stiffness))
            for angle, load, stiffness in pairs
        ),
        names=(name,) if name else (),
    )
    return infer_printed(one, maker, conformity)


def quantity(what: str, unit: str, given: Quantity) -> float:
    """A number in the unit, from text with any of its dimension.

    Raises
    ------
    SceneError
        No number, or another dimension.
    """
    if isinstance(given, bool) or not isinstance(given, int | float | str):
        raise SceneError.at(what, None, f"must be a number [{unit}] or text with a unit, not {type(given).__name__}")
    try:
        return float(given)  # text without a unit is in the SI unit
    except ValueError:
        pass
    try:
        return float(number_in(unit, str(given)))
    except ValueError as why:
        raise SceneError.at(what, given, str(why)) from None


#: Tables that come with the package, and whose they are.
TABLES = {"nsk": "NSK", "gmn": "GMN"}
_QUANTITIES = ("dynamic rating", "static rating", "pair stiffness")


def infer_table(table: str, maker: str | None = None, conformity: float | None = None) -> Tables:
    """Rows, one a size, and a summary.

    Parameters
    ----------
    table : a CSV file, or "nsk" or "gmn" for those of the package
    maker, conformity : as in ``infer_printed``; a table of the package names its maker

    Raises
    ------
    SceneError
        A table that cannot be read, or of which no size can be inferred.
    """
    own = table.lower() in TABLES and not Path(table).exists()
    read = Table(printed_by(table.lower()), ()) if own else read_table(Path(table))
    sizes = sizes_of(read.lines)
    maker = maker or (TABLES[table.lower()] if own else None)
    rows: list[Tables] = [{"name": fault.path, "refused": str(fault)} for fault in read.faults]
    answers: list[tuple[Printed, Inferred]] = []
    faults: list[SceneError] = []
    for one in sizes:
        try:
            found = infer_printed(one, maker, conformity)
        except SceneError as error:
            faults.append(error)
            rows.append({"name": one.title, "refused": str(error)})
        else:
            answers.append((one, found))
            rows.append(_row(one, found))
    if not answers:
        raise SceneError([mistake for error in faults for mistake in error.mistakes][:5])
    return {"table": table, "maker": maker, "rows": rows, "summary": _summary(answers, sizes)}


def _row(one: Printed, found: Inferred) -> Tables:
    worst = {word.replace(" ", "_") + "_error": found.worst(word) for word in _QUANTITIES}
    numbers = {key: number.value for key, number in found.numbers.items()}
    scatter = {f"{key}_scatter": number.scatter for key, number in found.numbers.items()}
    inside = one.internals
    told = (
        {}
        if inside is None
        else {"printed_" + key: getattr(inside, key) for key in ("ball_count", "ball_diameter", "pitch_diameter")}
    )
    return {"name": one.title, "practice": found.practice, **numbers, **worst, **scatter, **told}


def _summary(answers: list[tuple[Printed, Inferred]], sizes: list[Printed]) -> Tables:
    """Largest errors of ratings, median and 90 % of stiffnesses, and how many printed internals are met; what is refused is not."""
    errors = {
        word: [abs(c.error) for _, found in answers for c in found.checks if c.quantity == word] for word in _QUANTITIES
    }
    stiff = errors["pair stiffness"]
    told = [(one.internals, found) for one, found in answers if one.internals is not None]

    every = sum(one.internals is not None for one in sizes)

    def share(met: list[bool]) -> float | None:
        return sum(met) / every if every else None

    return {
        "sizes": len(sizes),
        "inferred": len(answers),
        "designations": sum(len(one.ratings) for one, _ in answers),
        "dynamic_rating_error_max": max(errors["dynamic rating"]),
        "static_rating_error_max": max(errors["static rating"]),
        "pair_stiffnesses": len(stiff),
        "pair_stiffness_error_median": float(np.median(stiff)) if stiff else None,
        "pair_stiffness_error_90": float(np.quantile(stiff, 0.9)) if stiff else None,
        "internals_printed": every,
        "ball_count_right": share([inside.ball_count == found.ball_count.value for inside, found in told]),
        "ball_diameter_within_1_percent": share(
            [abs(found.ball_diameter.value / inside.ball_diameter - 1.0) <= 0.01 for inside, found in told]
        ),
        "pitch_diameter_within_1_percent": share(
            [abs(found.pitch_diameter.value / inside.pitch_diameter - 1.0) <= 0.01 for inside, found in told]
        ),
    }
