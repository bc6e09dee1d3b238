"""Balls and grooves of a bearing from what its maker prints, for Python: ``raceway.infer``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from raceway.errors import SceneError
from raceway.framework.doors import door
from raceway.scene.units import number_in
from raceway.studies.infer.infer import infer_printed
from raceway.studies.infer.inferred import Inferred
from raceway.studies.infer.printed import PairStiffness, Printed, Rating

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
