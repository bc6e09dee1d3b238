"""Balls and grooves of a bearing, or of a table of bearings, from what makers print: ``raceway.infer`` and the command."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, ClassVar

import attrs
import numpy as np

from raceway import Answer, SceneError, door, positive
from raceway.extend import FINITE, Fact, Part, Reader, Tables, Words, number_in, rows_table
from raceway_catalogue.inferred import QUANTITIES, Inferred, infer_printed
from raceway_catalogue.printed import PairStiffness, Printed, Rating, Table, printed_by, read_table

#: A number in SI units, or text with a unit.
Quantity = float | str
_RATINGS = Reader(
    "a mapping of angles to (C, C0) or (C, C0, f_0)",
    lambda v: {FINITE.read(angle): (*c[:2], *map(FINITE.read, c[2:])) for angle, c in v.items() if Rating(0.0, *c)},
)
_PAIRS = Reader(
    "(angle, preload, axial stiffness) each, with or without the radial stiffness behind",
    lambda v: [(FINITE.read(angle), *{2: k, 3: k}[len(k)]) for angle, *k in v],
)


@door
def infer(
    bore: Quantity,
    outer_diameter: Quantity,
    ratings: Annotated[Mapping[float, Sequence[Quantity]], _RATINGS],
    *,
    width: Quantity | None = None,
    pairs: Annotated[Iterable[Sequence[Quantity]], _PAIRS] = (),
    name: str = "",
    maker: str | None = None,
    conformity: Annotated[float | None, positive()] = None,
) -> Inferred:
    """Ball count, ball diameter, pitch diameter and conformity of an angular-contact or deep-groove bearing from what its maker prints.

    Parameters
    ----------
    bore, outer_diameter, width : [m], or text such as "70 mm"
    ratings : by contact angle [deg], basic load ratings (dynamic C, static C0) [N]; all angles of a size that are printed.  0 deg is a
        deep-groove bearing, whose factor f_0 may follow: {0: ("14 kN", "7.85 kN", 13.9)}
    pairs : (contact angle [deg], preload [N], axial stiffness [N/m]) of pairs back to back or face to face; a fourth number is their
        radial stiffness [N/m], tilt locked, which gives the contact angle as manufactured
    name : designation
    maker : "NSK" and "NMB" rate by the tables of ISO 281 and ISO 76, "GMN" by its own grooves; None: what explains the ratings better
    conformity : of both grooves, where it is known; None: from ``pairs``, else 0.522

    Returns
    -------
    Inferred
        Each number with its uncertainty and reason; ``bearing()`` is the [bearing] table of a scene

    Raises
    ------
    SceneError
        Ratings that contradict each other, that no whole number of balls explains, or that are no numbers of their unit;
        stiffnesses that no groove gives.

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
        bore=_value("bore", "m", bore),
        outer_diameter=_value("outer diameter", "m", outer_diameter),
        width=None if width is None else _value("width", "m", width),
        ratings=tuple(
            Rating(angle, _value("dynamic rating", "N", c), _value("static rating", "N", c0), *map(float, factor))
            for angle, (c, c0, *factor) in ratings.items()
        ),
        pairs=tuple(
            PairStiffness(float(angle), _value("preload", "N", load), *(_value("stiffness", "N/m", k) for k in stiff))
            for angle, load, *stiff in pairs
        ),
        names=(name,) if name else (),
    )
    return infer_printed(size, maker, conformity)


def _value(name: str, unit: str, value: Quantity) -> float:
    """A number in the unit, from text with any of its dimension; SceneError: no number, or another dimension."""
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
_TABLES = {"nsk": "NSK", "gmn": "GMN", "nsk_deep_groove": "NSK", "nmb_deep_groove": "NMB"}


@attrs.frozen(eq=False, repr=False)
class _InferredTable(Answer):
    """Inferred sizes of a table, and what could not be inferred."""

    stem: ClassVar[str] = "inferred"
    #: table, maker : what was read
    table: str
    maker: str | None
    sizes: int  # how many, and ``internals`` of them with printed balls
    internals: int
    #: inferred sizes, and what is refused, in the order of the table: a name, or a reason by name
    answers: list[Inferred | tuple[str, str]]

    @property
    def inferred(self) -> list[Inferred]:
        """What was not refused."""
        return [answer for answer in self.answers if isinstance(answer, Inferred)]

    @property
    def summary(self) -> Tables:
        """Largest errors of ratings, median and 90 % of stiffnesses, and how many printed internals are met; what is refused is not."""
        checks = [check for answer in self.inferred for check in answer.checks]
        errors = {word: [abs(check.error) for check in checks if check.quantity == word] for word in QUANTITIES}
        stiff = errors["pair stiffness"]
        pairs = [(a.printed.internals, a.numbers) for a in self.inferred if a.printed.internals is not None]

        def share(key: str, within: float) -> float | None:
            values = [(getattr(balls, key), numbers[key].value) for balls, numbers in pairs]
            hits = [abs(value / right - 1.0) <= within for right, value in values if right is not None]
            return sum(hits) / self.internals if hits else None

        return {
            "sizes": self.sizes,
            "inferred": len(self.inferred),
            "designations": sum(len(answer.printed.ratings) for answer in self.inferred),
            "dynamic_rating_error_max": max(errors["dynamic rating"]),
            "static_rating_error_max": max(errors["static rating"]),
            "pair_stiffnesses": len(stiff),
            "pair_stiffness_error_median": float(np.median(stiff)) if stiff else None,
            "pair_stiffness_error_90": float(np.quantile(stiff, 0.9)) if stiff else None,
            "internals_printed": self.internals,
            "ball_count_right": share("ball_count", 0.0),
            "ball_diameter_within_1_percent": share("ball_diameter", 0.01),
            "pitch_diameter_within_1_percent": share("pitch_diameter", 0.01),
        }

    def to_dict(self) -> Tables:
        """A row a size, and the summary."""
        rows = [_fields(a) if isinstance(a, Inferred) else {"name": a[0], "refused": a[1]} for a in self.answers]
        return {"table": self.table, "maker": self.maker, "rows": rows, "summary": self.summary}

    def _sentences(self) -> list[str]:
        summary = {key: 100.0 * value if isinstance(value, float) else value for key, value in self.summary.items()}
        sentences = [
            "{inferred} of {sizes} sizes, {designations} designations; printed C met within {dynamic_rating_error_max:.2f} %, "
            "C0 within {static_rating_error_max:.2f} %"
        ]
        if summary["pair_stiffnesses"]:
            sentences.append(
                "{pair_stiffnesses} axial stiffnesses of pairs: median error {pair_stiffness_error_median:.2f} %, "
                "90 % within {pair_stiffness_error_90:.1f} %"
            )
        if summary["internals_printed"]:
            sentences.append(
                "{internals_printed} with printed balls, each inferred from the others: Z right in {ball_count_right:.1f} %, "
                "D within 1 % in {ball_diameter_within_1_percent:.1f} %"
            )
        if summary["pitch_diameter_within_1_percent"] is not None:
            sentences[-1] += f", d_m in {summary['pitch_diameter_within_1_percent']:.1f} %"
        return [sentence.format(**summary) for sentence in sentences]

    def _facts(self) -> tuple[str, list[Fact]]:
        return f"Inferred from {self.table}", [(sentence, "", "") for sentence in self._sentences()]

    def report(self) -> list[Part]:
        lines = [Words(f"refused: {answer[1]}", "yellow") for answer in self.answers if not isinstance(answer, Inferred)]
        return [rows_table(list(map(_size_line, self.inferred)), f"Inferred from {self.table}"), *lines, *self._sentences()]


def _fields(answer: Inferred) -> Tables:
    worst = {word.replace(" ", "_") + "_error": answer.worst(word) for word in QUANTITIES}
    numbers = {key: number.value for key, number in answer.numbers.items()}
    scatter = {f"{key}_scatter": number.scatter for key, number in answer.numbers.items()}
    internals = answer.printed.internals
    print_values = {} if internals is None else {f"printed_{key}": value for key, value in attrs.asdict(internals).items()}
    return {"name": answer.printed.title, "practice": answer.practice, **numbers, **worst, **scatter, **print_values}


def _size_line(answer: Inferred) -> dict[str, str]:
    name, internals = answer.printed.title, answer.printed.internals
    line = {
        "name": name if len(name) < 20 else name.partition(",")[0] + " ...",
        "Z": str(answer.ball_count.value),
        "D mm": f"{1e3 * answer.ball_diameter.value:.3f}",
        "d_m mm": f"{1e3 * answer.pitch_diameter.value:.4g}",
        "f_i": f"{answer.conformity_inner.value:.4f}",
    }
    for word, quantity in zip(("C %", "C0 %", "pairs %", "radial %"), QUANTITIES, strict=True):
        error = answer.worst(quantity)
        line[word] = "-" if error is None else f"{100.0 * error:.2f}"
    if internals is not None:
        line |= {"printed Z": str(internals.ball_count), "D mm ": f"{1e3 * internals.ball_diameter:.3f}"}
    return line


def lines_by_size(lines: Iterable[Printed]) -> list[Printed]:
    """Lines that differ in the contact angle alone, together: the same designation but for its suffix, or the same dimensions
    where they say no internals of their own."""
    groups: dict[object, list[Printed]] = {}
    for line in lines:
        key = line.names if line.internals is not None else (line.bore, line.outer_diameter, line.width)
        groups.setdefault(key, []).append(line)
    return [
        attrs.evolve(
            group[0],
            ratings=tuple(rating for line in group for rating in line.ratings),
            pairs=tuple(pair for line in group for pair in line.pairs),
            names=tuple(name for line in group for name in line.names),
        )
        for group in groups.values()
    ]


def _infer_table(table: str, maker: str | None = None, conformity: float | None = None) -> _InferredTable:
    """All sizes of a table.

    table : a CSV file, or the name of a table of the package
    maker, conformity : as in ``infer_printed``; a table of the package names its maker
    SceneError: a table that cannot be read, or of which no size can be inferred.
    """
    of_package = table.lower() in _TABLES and not Path(table).exists()
    read = Table(printed_by(table.lower()), ()) if of_package else read_table(Path(table))
    sizes = lines_by_size(read.lines)
    maker = maker or (_TABLES[table.lower()] if of_package else None)
    answers: list[Inferred | tuple[str, str]] = [(fault.path, str(fault)) for fault in read.faults]
    faults: list[SceneError] = []
    for size in sizes:
        try:
            answers.append(infer_printed(size, maker, conformity))
        except SceneError as error:
            faults.append(error)
            answers.append((size.title, str(error)))
    if len(faults) == len(sizes):
        raise SceneError([mistake for error in faults for mistake in error.mistakes][:5])
    return _InferredTable(table, maker, len(sizes), sum(size.internals is not None for size in sizes), answers)


def infer_texts(
    table: str | None = None, bore: str | None = None, outer_diameter: str | None = None, width: str | None = None,
    ratings: Iterable[str] = (), pairs: Iterable[str] = (), maker: str | None = None, conformity: float | None = None,
) -> Inferred | _InferredTable:  # fmt: skip
    """Infer ball count, ball diameter, pitch diameter and conformity, each with its uncertainty and reason.

    Inverts ISO 281 and ISO 76 for all contact angles of a size together. TABLE is a CSV file with the columns name,
    bore_mm, outer_diameter_mm, width_mm, contact_angle_deg, dynamic_rating_n, static_rating_n, optionally preload_1_n,
    stiffness_1_n_per_um, radial_stiffness_1_n_per_um, preload_2_n ...; static_factor (f_0) of deep-groove bearings; ball_count, ball_diameter_mm,
    pitch_diameter_mm are compared only. Included tables: "nsk", "gmn", "nsk_deep_groove", "nmb_deep_groove".

    Parameters
    ----------
    table : CSV file, or the name of a table of the package
    bore : with a unit: "70 mm"
    outer_diameter : with a unit: "110 mm"
    width : with a unit: "20 mm"
    ratings : contact angle [deg], dynamic and static rating: "15:47 kN:43 kN"
    pairs : axial, or axial and radial, stiffness of a preloaded pair: "15:127 N:60.1 N/µm:335 N/µm"
    maker : rating conventions of NSK, NMB or GMN; None: those that fit better
    conformity : of both grooves, above 0.5 and at most 0.6; None: from --pair, else 0.522
    """
    if conformity is not None and not 0.5 < conformity <= 0.6:
        raise SceneError.at("conformity", conformity, "must be above 0.5 and at most 0.6")
    single, ratings = {"--bore": bore, "--outer-diameter": outer_diameter, "--rating": tuple(ratings)}, tuple(ratings)
    if table is not None:
        if any((*single.values(), *pairs)):
            raise SceneError.at("TABLE", table, "give it, or --bore, --outer-diameter and --rating, not both")
        return _infer_table(table, maker, conformity)
    if missing := [word for word, value in single.items() if not value]:
        raise SceneError.at("TABLE", None, f"is missing, or {', '.join(missing)}")
    assert bore is not None and outer_diameter is not None
    by_angle: dict[float, tuple[Quantity, Quantity]] = {}
    for text in ratings:
        angle, (dynamic, static) = _split("ratings", text, "15:47 kN:43 kN")
        if angle in by_angle:
            raise SceneError.at("ratings", text, f"{angle:g} deg is given twice")
        by_angle[angle] = dynamic, static
    parts = [_split("pairs", text, "15:145 N:51 N/µm", radial=1) for text in pairs]
    stiff: list[Sequence[Quantity]] = [(angle, *numbers) for angle, numbers in parts]
    return infer(bore, outer_diameter, by_angle, width=width, pairs=stiff, maker=maker, conformity=conformity)


def _split(name: str, text: str, example: str, radial: int = 0) -> tuple[float, list[str]]:
    """Angle [deg], and two numbers, or up to ``radial`` more."""
    angle, *numbers = text.split(":")
    try:
        if 2 <= len(numbers) <= 2 + radial:
            return float(angle.removesuffix("deg")), numbers
    except ValueError:
        pass
    raise SceneError.at(name, text, f'must be parts with colons between, the first an angle in deg: "{example}"')
