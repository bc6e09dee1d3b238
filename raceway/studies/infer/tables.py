"""A table of printed bearings, all sizes inferred, and how well the answers meet what is printed."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from raceway.errors import SceneError
from raceway.storage.tables import Tables
from raceway.studies.infer.infer import infer_printed
from raceway.studies.infer.inferred import Inferred
from raceway.studies.infer.printed import Printed, Table, printed_by, read_table, sizes_of

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
