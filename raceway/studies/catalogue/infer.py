"""Balls and grooves of a bearing from what its maker prints, for Python: ``raceway.infer``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

import attrs
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
    size = Printed(
        bore=_number("bore", "m", bore),
        outer_diameter=_number("outer diameter", "m", outer_diameter),
        width=None if width is None else _number("width", "m", width),
        ratings=tuple(
            Rating(angle, _number("dynamic rating", "N", c), _number("static rating", "N", c0))
            for angle, (c, c0) in ratings.items()
        ),
        pairs=tuple(
            PairStiffness(angle, _number("preload", "N", load), _number("stiffness", "N/m", stiffness))
            for angle, load, stiffness in pairs
        ),
        names=(name,) if name else (),
    )
    return infer_printed(size, maker, conformity)


def _number(name: str, unit: str, value: Quantity) -> float:
    """A number in the unit, from text with any of its dimension.

    Raises
    ------
    SceneError
        No number, or another dimension.
    """
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise SceneError.at(name, None, f"must be a number [{unit}] or text with a unit, not {type(value).__name__}")
    try:
        return float(value)  # text without a unit is in the SI unit
    except ValueError:
        pass
    try:
        return float(number_in(unit, str(value)))
    except ValueError as why:
        raise SceneError.at(name, value, str(why)) from None


#: Tables that come with the package, and whose they are.
_TABLES = {"nsk": "NSK", "gmn": "GMN"}
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
    packaged = table.lower() in _TABLES and not Path(table).exists()
    read = Table(printed_by(table.lower()), ()) if packaged else read_table(Path(table))
    sizes = sizes_of(read.lines)
    maker = maker or (_TABLES[table.lower()] if packaged else None)
    rows: list[Tables] = [{"name": fault.path, "refused": str(fault)} for fault in read.faults]
    answers: list[Inferred] = []
    faults: list[SceneError] = []
    for size in sizes:
        try:
            answers.append(infer_printed(size, maker, conformity))
            rows.append(_row(answers[-1]))
        except SceneError as error:
            faults.append(error)
            rows.append({"name": size.title, "refused": str(error)})
    if not answers:
        raise SceneError([mistake for error in faults for mistake in error.mistakes][:5])
    return {"table": table, "maker": maker, "rows": rows, "summary": _summary(answers, sizes)}


def _row(answer: Inferred) -> Tables:
    worst = {word.replace(" ", "_") + "_error": answer.worst(word) for word in _QUANTITIES}
    numbers = {key: number.value for key, number in answer.numbers.items()}
    scatter = {f"{key}_scatter": number.scatter for key, number in answer.numbers.items()}
    internals = answer.printed.internals
    printed = {} if internals is None else {f"printed_{key}": value for key, value in attrs.asdict(internals).items()}
    return {"name": answer.printed.title, "practice": answer.practice, **numbers, **worst, **scatter, **printed}


def _summary(answers: list[Inferred], sizes: list[Printed]) -> Tables:
    """Largest errors of ratings, median and 90 % of stiffnesses, and how many printed internals are met; what is refused is not."""
    errors = {
        word: [abs(check.error) for answer in answers for check in answer.checks if check.quantity == word]
        for word in _QUANTITIES
    }
    stiff = errors["pair stiffness"]
    printed = [(answer.printed.internals, answer) for answer in answers if answer.printed.internals is not None]
    count = sum(size.internals is not None for size in sizes)

    def share(key: str, within: float) -> float | None:
        met = [abs(answer.numbers[key].value / getattr(balls, key) - 1.0) <= within for balls, answer in printed]
        return sum(met) / count if count else None

    return {
        "sizes": len(sizes),
        "inferred": len(answers),
        "designations": sum(len(answer.printed.ratings) for answer in answers),
        "dynamic_rating_error_max": max(errors["dynamic rating"]),
        "static_rating_error_max": max(errors["static rating"]),
        "pair_stiffnesses": len(stiff),
        "pair_stiffness_error_median": float(np.median(stiff)) if stiff else None,
        "pair_stiffness_error_90": float(np.quantile(stiff, 0.9)) if stiff else None,
        "internals_printed": count,
        "ball_count_right": share("ball_count", 0.0),
        "ball_diameter_within_1_percent": share("ball_diameter", 0.01),
        "pitch_diameter_within_1_percent": share("pitch_diameter", 0.01),
    }
