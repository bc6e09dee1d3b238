"""Calls of duties of the kind of bodies that a scene names: what it raises, or returns of another type, is put to its name.

Duties of contact laws that may be left out have their defaults here.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from raceway.errors import PluginError
from raceway.framework.contracts import Cost, LawReport, Traits
from raceway.framework.sources import blamed

if TYPE_CHECKING:
    import numpy as np

    from raceway.framework.contracts import ContactPairs

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


def same_bodies(scene: Any, other: Any) -> bool:
    """Whether two scenes whose bodies are of one kind have the same meshes; where bodies do not tell, unless [mesh] is there."""
    if not hasattr(scene.bodies, "same_bodies"):
        return scene.mesh is None or scene.bearing == other.bearing
    with blamed(f"bodies '{scene.bodies.name}'", "same_bodies()"):
        return bool(scene.bodies.same_bodies(scene, other))


def renews(law: Any) -> bool:
    """Whether a contact law's parameters follow the running speed and the loads; not unless it says so."""
    return bool(getattr(law, "renewed", False))


def reach_of(law: Any, pairs: ContactPairs) -> np.ndarray:
    """How far from touching the contacts of a law begin to carry (n,) [m]; 0 unless it says more.

    Raises
    ------
    PluginError
        It raises, or returns no such array.
    """
    import numpy as np

    n = len(pairs.curvature_a)
    if not hasattr(law, "reach"):
        return np.zeros(n)
    who = f"contact law '{law.name}'"
    with blamed(who, "reach()"):
        found = np.asarray(law.reach(pairs))
    if found.shape != (n,) or not (found >= 0.0).all() or not np.isfinite(found).all():
        raise PluginError(f"{who}: reach() must return {n} finite lengths of 0 or more, one for each contact")
    return found


def law_report(law: Any, pairs: ContactPairs) -> LawReport | None:
    """What a renewed law tells of its contacts; None unless it does."""
    if not renews(law) or not hasattr(law, "report"):
        return None
    who = f"contact law '{law.name}'"
    with blamed(who, "report()"):
        found = law.report(pairs)
    if not isinstance(found, LawReport):
        raise PluginError(f"{who}: report() returned {type(found).__name__}; it must be a LawReport")
    return found
