"""A tolerance: a continuous key of a scene and by how much its number may differ, evenly distributed.

The table ``[tolerances]`` of a scene has a text for each key, such as ``"±1 deg"``, and may name the class of the bearing and the grade of
its balls: ``class = "P4"``, ``balls = "G5"`` (``raceway.scene.tolerance_class``).
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

import attrs

from raceway.errors import Mistake, SceneError
from raceway.scene.continuous import Key, key_of, with_number
from raceway.scene.given import leaves
from raceway.scene.scene import Scene
from raceway.scene.tolerance_class import NAMES, ranges_of
from raceway.scene.units import number_in

_FORM = "must be text such as '±10 %', '±1 deg' or '+0.002 -0.001', in the unit of the key or with one"
_SYMMETRIC = re.compile(r"\s*(?:±|\+/?-)\s*(.+?)\s*")
_ENDS = re.compile(r"\s*\+\s*([^-+]+?)\s*-\s*([^-+]+?)\s*")


@attrs.frozen
class Tolerance:
    """A key whose number lies evenly between ``low`` and ``high``, in its unit."""

    key: Key
    low: float
    high: float


def tolerances_of(scene: Scene, given: Iterable[str] | Mapping[str, str]) -> tuple[Tolerance, ...]:
    """Tolerances from texts ``KEY=TEXT`` or a mapping.

    Raises
    ------
    SceneError
        No tolerance at all; a key that is not continuous or given twice; a text that is no tolerance, or empty; a range that the
        key's rule refuses.
    """
    pairs = list(given.items()) if isinstance(given, Mapping) else [_split(text) for text in given]
    if not pairs:
        raise SceneError.at("tolerances", None, "none is given: a band needs one, such as load.axial='±10 %'")
    found: dict[str, Tolerance] = {}
    for path, text in pairs:
        if path in NAMES:
            ranges = ranges_of(scene, path, str(text).strip())
            some = [_checked(scene, key_of(scene, one), str(text), *ends) for one, ends in ranges.items()]
        else:
            some = [_tolerance(scene, key_of(scene, path), str(text))]
        for one in some:
            if one.key.path in found:
                raise SceneError.at(one.key.path, text, "has two tolerances: give one")
            found[one.key.path] = one
    return tuple(found.values())


def check_tolerances(scene: Scene) -> list[Mistake]:
    """Mistakes of the scene's own table; an absent one has none."""
    try:
        if "tolerances" in scene.source:
            tolerances_of(scene, dict(leaves(scene.source["tolerances"])))
    except SceneError as why:
        return [
            attrs.evolve(one, path=f"tolerances.{one.path}".replace("tolerances.tolerances", "tolerances"))
            for one in why.mistakes
        ]
    return []


def _split(text: str) -> tuple[str, str]:
    path, sign, rest = text.partition("=")
    if not sign or not path.strip():
        raise SceneError.at("tolerance", text, "must have the form KEY=TEXT, such as load.axial='±10 %'")
    return path.strip(), rest


def _tolerance(scene: Scene, key: Key, text: str) -> Tolerance:
    if match := _SYMMETRIC.fullmatch(text):
        above = below = _size(key, match[1], text)
    elif match := _ENDS.fullmatch(text):
        above, below = (_size(key, part, text) for part in match.groups())
    else:
        raise SceneError.at(key.path, text, _FORM)
    return _checked(scene, key, text, below, above)


def _checked(scene: Scene, key: Key, text: str, below: float, above: float) -> Tolerance:
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
