"""What a run says in short: ``repr`` and table of a Result, K with its error first."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from raceway.framework.shown import Fact, in_micro, largest_facts, number, percents, tilt_words, within
from raceway.pipeline.error.hypotheses import NEGLIGIBLE
from raceway.pipeline.motion import largest_contacts, pressures
from raceway.storage.tables import Tables

if TYPE_CHECKING:
    from raceway.pipeline.result import Result


def facts(result: Result) -> list[Fact]:
    """Name, value with unit, remark."""
    count = len(result.warnings)
    warned = [(f"{count} warning{'' if count == 1 else 's'}", "see .warnings", result.warnings[0])] if count else []
    return [*_identified(result), *warned, *_equilibrium(result), *_computed(result)]


def _identified(result: Result) -> list[Fact]:
    found = result.identification
    if found is None:
        return []
    k, c, z = found.equivalent_stiffness, found.equivalent_damping, found.dynamic_stiffness
    band = result.band
    total, damping_error = result.error["total"], result.equivalent_damping_error
    held = tilt_words(result.model.scene.supports.tilt)
    rows = [
        within(
            "stiffness K", k, result.equivalent_stiffness_error, 1e-6, "N/µm", f"{60.0 * found.frequency_hz:g} r/min, {held}"
        ),
        within("damping C", c, damping_error, 1.0, "N s/m", "Im Z / w")
        if band is None
        else _ends(band["equivalent_damping"]),
        ("|Z|", number(1e-6 * abs(z), "N/µm"), "force over displacement of the 1x line"),
        ("orbit", f"{in_micro(found.orbit_major)} x {in_micro(found.orbit_minor)} µm", "semi-axes of the 1x line"),
    ]
    rows = [(name, "not resolved" if result.error["unresolved"] else value, remark) for name, value, remark in rows]
    return [
        *rows,
        *_spread(result),
        ("error of Z", "not estimated" if total is None else f"{total:.1e}", "relative, estimated"),
    ]


def _spread(result: Result) -> list[Fact]:
    """Change of K by hypotheses left at their defaults, where it is worth a sentence."""
    ends = (result.model_spread[0] or {}).get("equivalent_stiffness")
    if not ends or max(map(abs, ends)) < NEGLIGIBLE:
        return []
    return [("model of K", percents(*ends), "hypotheses left at their defaults: .model_spread")]


def _ends(ends: list[float]) -> Fact:
    return (
        "damping C",
        f"{ends[0]:.3g} to {ends[1]:.3g} N s/m",
        "both ends of the band of time constants; all else is the low end's",
    )


def _equilibrium(result: Result) -> list[Fact]:
    k, moved, loads = result.stiffness, result.displacement, result.ball_loads
    forces, follows = result.equilibrium.contact_force, result.kyy_tilts_follow
    return [
        ("tangent kxx, kyy", f"{1e-6 * k[0, 0]:.5g}, {1e-6 * k[1, 1]:.5g} N/µm", "static, all other motions held"),
        *([] if follows is None else [("kyy tilts follow", f"{1e-6 * follows:.5g} N/µm", "static, x and z held")]),
        ("displacement x", number(1e6 * moved[0], "µm"), "static, axial"),
        ("ball loads", f"{np.min(loads):.5g} to {np.max(loads):.5g} N", f"static, {len(loads)} balls, inner race"),
        *largest_facts(largest_contacts(forces, pressures(result.model, forces), "largest"), "static"),
    ]


def _computed(result: Result) -> list[Fact]:
    scene, cost = result.model.scene, result.cost
    bearing: Tables = scene.source["bearing"]
    kind = f"{scene.bodies.name} bodies, {scene.contact.kind}, {scene.integrator.kind}"
    steps = f"{cost['steps']} steps" if cost["steps"] else "static"
    compiled = f"; compiling, apart and once: {cost['compile_s']:.2g} s" if cost["compile_s"] else ""
    rows: list[Fact] = [
        ("bearing", str(bearing.get("preset") or "own geometry"), kind),
        ("cost", number(cost["wall_s"], "s", 3), f"{steps}{compiled}"),
    ]
    if result.geometry is not None:
        rows.insert(1, ("geometry", "inferred", result.geometry["words"].partition(": ")[2]))
    return rows
