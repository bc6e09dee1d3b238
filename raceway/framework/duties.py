"""Calls of duties of the kind of bodies that a scene names: what it raises, or returns of another type, is put to its name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from raceway.errors import PluginError
from raceway.framework.contracts import Cost, Traits
from raceway.framework.sources import blamed

#: Duty -> what it returns.
_RETURNS: dict[str, tuple[type, ...]] = {
    "faults": (list,),
    "traits": (Traits,),
    "stable_step": (float, type(None)),
    "decide": (type(None),),
    "unused": (list,),
    "cost": (Cost,),
    "imports": (Mapping,),
    "build": (object,),
}


def bodies(scene: Any, duty: str, *arguments: Any) -> Any:
    """What a duty of ``raceway.framework.contracts.BodiesKind`` returns for a scene.

    Raises
    ------
    PluginError
        It raises anything but a ``RacewayError``, or returns another type.
    """
    who = f"bodies '{scene.bodies.name}'"
    with blamed(who, f"{duty}()"):
        found = getattr(scene.bodies, duty)(scene, *arguments)
    if not isinstance(found, _RETURNS[duty]):
        words = " or ".join("None" if one is type(None) else one.__name__ for one in _RETURNS[duty])
        raise PluginError(f"{who}: {duty}() returned {type(found).__name__}; it must be {words}")
    return found


def traits_of(scene: Any) -> Traits:
    """Of the bodies in a scene."""
    found: Traits = bodies(scene, "traits")
    return found
