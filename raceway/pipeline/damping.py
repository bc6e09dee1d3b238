"""Where the damping of a scene comes from, and a run at both ends of the band of time constants."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import attrs

from raceway.scene.scene import Scene
from raceway.scene.tables import TIME_CONSTANTS
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.pipeline.result import Result

#: Of scenes without any damping.
DRY = "dry: no damping is modelled"


def damping_origin(scene: Scene) -> str:
    """What damps a scene, in words."""
    contact, found = scene.contact, []
    low, high = TIME_CONSTANTS
    if contact.in_a_band:
        found.append(
            f"c = tau k at the contacts, tau from {low:g} to {high:g} s: the band of rolling bearings (Kraemer 1993)"
        )
    elif contact.loss_factor is not None:
        found.append(
            f"contact.loss_factor {contact.loss_factor:g}: c = tau k at the contacts, tau = {scene.time_constant:.4g} s"
        )
    elif contact.time_constant is not None:
        found.append(f"contact.time_constant: c = tau k at the contacts, tau = {contact.time_constant:g} s")
    elif contact.dashpot > 0.0:
        found.append(f"contact.damping: {contact.dashpot:g} N s/m at each contact")
    if contact.law.dissipative:
        found.append(f"contact law '{contact.kind}'")
    if contact.friction > 0.0:
        found.append("contact.friction")
    if scene.rotor.damping > 0.0:
        found.append(f"rotor.damping: {scene.rotor.damping:g} N s/m")
    return "; ".join(found) or DRY


def run_band(scene: Scene, run: Callable[[Scene], Result]) -> Result:
    """The result at the low end of the band, with ``band`` from both ends; cost is that of both runs."""
    ends = [
        run(attrs.evolve(scene, contact=attrs.evolve(scene.contact, damping=0.0, time_constant=tau)))
        for tau in TIME_CONSTANTS
    ]
    low, high = ends
    both = {key: value + high.cost[key] for key, value in low.cost.items() if key not in ("peak_memory_bytes", "threads")}
    model = attrs.evolve(low.model, scene=attrs.evolve(low.model.scene, contact=scene.contact))
    warnings = tuple(dict.fromkeys((*low.warnings, *high.warnings)))
    return attrs.evolve(low, model=model, cost={**high.cost, **both}, band=_band(ends), warnings=warnings)


def _band(ends: list[Result]) -> Tables:
    """``identification.band``: numbers of both ends, [low, high]."""
    found = [one.identification for one in ends]
    assert all(one is not None for one in found), "static scenes have no band"
    known = [one for one in found if one is not None]
    return {
        "time_constant_s": list(TIME_CONSTANTS),
        "equivalent_damping": [one.equivalent_damping for one in known],
        "equivalent_damping_error": [one.equivalent_damping_error for one in ends],
        "equivalent_stiffness": [one.equivalent_stiffness for one in known],
        "loss_factor": [one.equivalent_damping * one.speed / one.equivalent_stiffness for one in known],
        "phase_lag_deg": [one.phase_lag_deg for one in known],
    }
