"""Free numbers of a fit: where they begin, in what steps they are told, and how far they may go."""

from __future__ import annotations

from collections.abc import Iterable
from math import inf

import attrs

from raceway.errors import SceneError
from raceway.scene.continuous import key_of, with_number
from raceway.scene.scene import Scene

#: Size of a change at a number that is 0, by unit: what a bearing shows.
_SIZES = {"m": 1e-6, "N": 10.0, "N m": 0.1, "deg": 1.0, "r/min": 10.0, "K": 1.0, "kg": 0.1, "s": 1e-6, "N s/m": 10.0}
#: Doublings of a change before a number counts as without limit, and halvings that find a limit.
_DOUBLINGS, _HALVINGS = 40, 50


@attrs.frozen
class Free:
    """One free number.

    Attributes
    ----------
    name : key of the scene, or a word of the model;  unit : of the number
    start : where the search begins;  size : of a change that counts, the number itself where it is not 0
    low, high : ends of the range that the scene's rules leave
    """

    name: str
    unit: str
    start: float
    size: float
    low: float = -inf
    high: float = inf


def free_keys(scene: Scene, paths: Iterable[str]) -> list[Free]:
    """Free keys of a scene, each with its range.

    Raises
    ------
    SceneError
        No key, one twice, or one that is no continuous key of the scene.
    """
    paths = [path.strip() for path in paths if path.strip()]
    if not paths:
        raise SceneError.at("--free", None, "names no key: give at least one, such as bearing.contact_angle_deg")
    if twice := next((path for path in paths if paths.count(path) > 1), None):
        raise SceneError.at("--free", twice, "stands there twice")
    found = []
    for path in paths:
        key = key_of(scene, path)
        size = abs(key.value) or _SIZES.get(key.unit, 1.0)
        low, high = (_limit(scene, path, key.value, sign * size) for sign in (-1.0, 1.0))
        if low == high:
            raise SceneError.at(path, key.value, "has no room to either side: its range is this one number")
        # A search begins inside its range: a number at the end of it is moved in by a little.
        inside = 1e-6 * min(size, high - low)
        found.append(Free(path, key.unit, min(max(key.value, low + inside), high - inside), size, low, high))
    return found


def _limit(scene: Scene, path: str, value: float, step: float) -> float:
    """The last number that the rules of the scene's tables allow on the way from a value in steps of one sign."""
    inner = value
    for _ in range(_DOUBLINGS):
        outer = value + step
        if not _allowed(scene, path, outer):
            break
        inner, step = outer, 2.0 * step
    else:
        return inf if step > 0.0 else -inf
    for _ in range(_HALVINGS):
        middle = 0.5 * (inner + outer)
        if _allowed(scene, path, middle):
            inner = middle
        else:
            outer = middle
    return inner


def _allowed(scene: Scene, path: str, value: float) -> bool:
    try:
        with_number(scene, path, value)
    except ValueError:
        return False
    return True
