"""A tolerance: a continuous key of a scene and by how much its number may differ, evenly distributed.

The table ``[tolerances]`` of a scene has a text for each key, such as ``"±1 deg"``, and may name the class of the bearing and the grade of
its balls: ``class = "P4"``, ``balls = "G5"`` (``raceway.scene.tolerance``).
"""

import re
from collections.abc import Iterable, Mapping

import attrs

from raceway.errors import SceneError
from raceway.framework.options import nearest
from raceway.scene.inputs import leaves
from raceway.scene.keys import Key, key_of, with_number
from raceway.scene.tables import SceneTables
from raceway.scene.units import number_in

#: Keys of the table [tolerances] that are names, no paths.
NAMES = ("class", "balls")
#: (over, up to and including [mm], deviation [µm]) of the mean bore diameter by class, and of the outside diameter; upper deviation 0.
_EDGES = (2.5, 10.0, 18.0, 30.0, 50.0, 80.0, 120.0, 150.0, 180.0, 250.0, 315.0)
_BORE = {
    "Normal": (8.0, 8.0, 10.0, 12.0, 15.0, 20.0, 25.0, 25.0, 30.0, 35.0),
    "P6": (7.0, 7.0, 8.0, 10.0, 12.0, 15.0, 18.0, 18.0, 22.0),
    "P5": (5.0, 5.0, 6.0, 8.0, 9.0, 10.0, 13.0, 13.0, 15.0, 18.0),
    "P4": (4.0, 4.0, 5.0, 6.0, 7.0),
    "P2": (2.5, 2.5, 2.5, 2.5, 4.0, 5.0, 7.0, 7.0),
}
_OUTER_EDGES = (18.0, 30.0, 50.0, 80.0, 120.0, 150.0, 180.0, 250.0, 315.0, 400.0)
_OUTER = {
    "Normal": (9.0, 11.0, 13.0, 15.0, 18.0, 25.0, 30.0, 35.0, 40.0),
    "P6": (8.0, 9.0, 11.0, 13.0, 15.0, 18.0, 20.0, 25.0, 28.0),
    "P5": (6.0, 7.0, 9.0, 10.0, 11.0, 13.0, 15.0, 18.0, 20.0),
    "P4": (5.0, 6.0, 7.0, 8.0, 9.0),
    "P2": (4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 8.0),
}
_ALSO = {"P0": "Normal", "ABEC 1": "Normal", "ABEC 3": "P6", "ABEC 5": "P5", "ABEC 7": "P4", "ABEC 9": "P2"}
#: Grade -> variation of the ball lot diameter [µm].
_BALLS = {
    "G3": 0.13, "G5": 0.25, "G10": 0.5, "G16": 0.8, "G20": 1.0, "G24": 1.2, "G28": 1.4, "G40": 2.0, "G60": 3.0, "G100": 5.0,
    "G200": 10.0,
}  # fmt: skip


def _ranges_of(scene: SceneTables, key: str, name: str) -> dict[str, tuple[float, float]]:
    """Path -> how far the number at it may lie below and above the scene's [m].

    key : one of ``NAMES``;  name : such as "P4", "ABEC 7" or "G5"

    SceneError: no such name; a size that the class's table does not have; a class that changes nothing, or that leaves a
        ring loose.
    """
    if key == "balls":
        variation = 1e-6 * _BALLS[_member(key, name, [*_BALLS])]
        return {"bearing.ball_diameter": (0.5 * variation, 0.5 * variation)}
    column = _member(key, name, [*_BORE, *_ALSO])
    column, warm, ranges = _ALSO.get(column, column), scene.mounting, {}
    if warm.shaft_interference > 0.0:
        bore = _deviation(key, name, "bore", scene.bearing.bore, _EDGES, _BORE[column])
        ranges["mounting.shaft_interference"] = (0.0, bore)
    if warm.housing_interference > 0.0:
        outer = _deviation(key, name, "outer_diameter", scene.bearing.outer_diameter, _OUTER_EDGES, _OUTER[column])
        if outer >= warm.housing_interference:
            why = (
                f"leaves outer rings loose: their diameter may be {1e6 * outer:.3g} µm smaller, the fit has "
                f"{1e6 * warm.housing_interference:.3g} µm. Use a tighter one, or give tolerances of the fits by their keys"
            )
            raise SceneError.at(key, name, why)
        ranges["mounting.housing_interference"] = (outer, 0.0)
    if not ranges:
        why = (
            "changes nothing here: a class limits bore and outside diameter, which act through fits, and the scene has none. Give "
            "mounting.shaft_interference or mounting.housing_interference, or leave it out"
        )
        raise SceneError.at(key, name, why)
    return ranges


def _member(key: str, name: str, names: list[str]) -> str:
    if name not in names:
        raise SceneError.at(key, name, f"must be one of {', '.join(names)}{nearest(name, names)}")
    return name


def _deviation(
    key: str, name: str, dimension: str, size: float | None, edges: tuple[float, ...], values: tuple[float, ...]
) -> float:
    """Of a dimension [m], in metres."""
    millimetres = 1e3 * (size or 0.0)
    for low, high, value in zip(edges, edges[1:], values, strict=False):
        if low < millimetres <= high:
            return 1e-6 * value
    why = f"has no value here for bearing.{dimension} = {millimetres:g} mm: its table goes from {edges[0]:g} to {edges[len(values)]:g} mm"
    raise SceneError.at(key, name, f"{why}. Give tolerances of the fits by their keys")


_FORM = "must be text such as '±10 %', '±1 deg' or '+0.002 -0.001', in the unit of the key or with one"
_SYMMETRIC = re.compile(r"\s*(?:±|\+/?-)\s*(.+?)\s*")
_ENDS = re.compile(r"\s*\+\s*([^-+]+?)\s*-\s*([^-+]+?)\s*")


@attrs.frozen
class Tolerance:
    """A key whose number lies evenly between ``low`` and ``high``, in its unit."""

    key: Key
    low: float
    high: float


def tolerances_of(scene: SceneTables, texts: Iterable[str] | Mapping[str, str]) -> tuple[Tolerance, ...]:
    """Tolerances from texts ``KEY=TEXT`` or a mapping.

    SceneError: No tolerance at all; a key that is not continuous or given twice; a text that is no tolerance, or empty; a range that the
        key's rule refuses.
    """
    pairs = list(texts.items()) if isinstance(texts, Mapping) else [_split(text) for text in texts]
    if not pairs:
        raise SceneError.at("tolerances", None, "none is given: a band needs one, such as load.axial='±10 %'")
    tolerances: dict[str, Tolerance] = {}
    for path, text in pairs:
        if path in NAMES:
            ranges = _ranges_of(scene, path, str(text).strip())
            of_text = [_within_rule(scene, key_of(scene, fit), str(text), *ends) for fit, ends in ranges.items()]
        else:
            key, text = key_of(scene, path), str(text)
            if match := _SYMMETRIC.fullmatch(text):
                above = below = _size(key, match[1], text)
            elif match := _ENDS.fullmatch(text):
                above, below = (_size(key, part, text) for part in match.groups())
            else:
                raise SceneError.at(key.path, text, _FORM)
            of_text = [_within_rule(scene, key, text, below, above)]
        for tolerance in of_text:
            if tolerance.key.path in tolerances:
                raise SceneError.at(tolerance.key.path, text, "has two tolerances: give one")
            tolerances[tolerance.key.path] = tolerance
    return tuple(tolerances.values())


def stated_tolerances(scene: SceneTables) -> dict[str, str]:
    """The scene's own table: key -> text; empty without one."""
    return dict(leaves(scene.source.get("tolerances", {})))


def check_tolerances(scene: SceneTables) -> None:
    """Refuse mistakes of the scene's own table by ``SceneError``."""
    try:
        tolerances_of(scene, stated_tolerances(scene))
    except SceneError as why:
        paths = [f"tolerances.{mistake.path}".replace("tolerances.tolerances", "tolerances") for mistake in why.mistakes]
        raise SceneError([attrs.evolve(one, path=path) for one, path in zip(why.mistakes, paths, strict=True)]) from None


def _split(text: str) -> tuple[str, str]:
    path, sign, width = text.partition("=")
    if not sign or not path.strip():
        raise SceneError.at("tolerance", text, "must have the form KEY=TEXT, such as load.axial='±10 %'")
    return path.strip(), width


def _within_rule(scene: SceneTables, key: Key, text: str, below: float, above: float) -> Tolerance:
    """From ``below`` to ``above`` the number at a key."""
    low, high = key.value - below, key.value + above
    if not low < high:
        raise SceneError.at(key.path, text, "is empty: the number cannot differ")
    for end in (low, high):
        try:
            with_number(scene, key.path, end)
        except ValueError as why:
            raise SceneError.at(key.path, text, f"reaches {end:.6g}, which {why}") from None
    return Tolerance(key, low, high)


def _size(key: Key, part: str, text: str) -> float:
    try:
        if part.endswith("%"):
            size = abs(key.value) * float(part[:-1]) / 100.0
        else:
            size = number_in(key.unit, part) if re.search(r"[^\d.eE+-]", part) else float(part)
    except ValueError:
        raise SceneError.at(key.path, text, _FORM) from None
    if size < 0.0:
        raise SceneError.at(key.path, text, "a tolerance has no sign of its own")
    return size
