"""Difference of |Z| and K(w) in a comparison, in sentences made from its rows."""

from __future__ import annotations

import math
from itertools import product
from typing import TYPE_CHECKING

from raceway.studies.compare.phrases import LABELS, percent, step
from raceway.studies.many.axes import Axis

if TYPE_CHECKING:
    from raceway.studies.compare.findings import Findings


def inertia(comparison: Findings, leading: Axis | None) -> list[str]:
    """The mass that was used, the size of m w^2, and where |Z| and K(w) go different ways."""
    found = [row.result["identification"] for row in comparison.rows if row.doubt is None]
    mass = [one["mass_used_kg"] for one in found]
    if max(mass) <= 0.0:
        return ["No inertia was used (mass 0): |Z| is the modulus of K + j w C."]
    force = [m * (2.0 * math.pi * one["frequency_hz"]) ** 2 for m, one in zip(mass, found, strict=True)]
    share = [100.0 * f / one["equivalent_stiffness"] for f, one in zip(force, found, strict=True)]
    z = [one["dynamic_stiffness"] for one in found]
    damping = max(1.0 - abs(one["real"]) / one["abs"] for one in z)
    masses = f"{min(mass):.3f}" if max(mass) - min(mass) < 5e-4 else f"{min(mass):.3f} to {max(mass):.3f}"
    added = "less than 0.01" if damping < 1e-4 else f"up to {100 * damping:.2g}"
    less = (
        f"|Z| is K(w) less m w^2, with m = {masses} kg: {min(force) / 1e6:.2f} to {max(force) / 1e6:.2f} N/µm, which is "
        f"{min(share):.1f} to {max(share):.1f} % of K(w); damping adds {added} % of |Z|."
    )
    return [less] if leading is None else [less, *_opposite(comparison, leading)]


def _opposite(comparison: Findings, leading: Axis) -> list[str]:
    """Where |Z| falls although K rises, and by how much each changes."""
    k, z = (comparison.factorials[name] for name in LABELS)
    others = [key for key in k.keys if key != leading.key]
    settings = [dict(zip(others, ends, strict=True)) for ends in product((0, 1), repeat=len(others))]
    opposite = sum(k.resolved_change(leading.key, at) > 0.0 > z.resolved_change(leading.key, at) for at in settings)
    text = (
        f"{step(leading)} changes |Z| by {percent(z.log_change(leading.key))} and K(w) by "
        f"{percent(k.log_change(leading.key))} on average; "
    )
    if opposite:
        text += (
            f"in {opposite} of {len(settings)} settings |Z| falls although K(w) rises: there the fall is the inertia of the "
            "carried mass, not the bearing."
        )
    else:
        text += "nowhere does |Z| fall while K(w) rises."
    parts = []
    for given, where in comparison.settings(("supports.tilt", "excitation.amplitude")):
        if given and leading.key not in given:
            changes = percent(k.log_change(leading.key, given)), percent(z.log_change(leading.key, given))
            parts.append(f"{where}: K(w) {changes[0]}, |Z| {changes[1]}")
    return [text, f"Change along {step(leading)}: {'; '.join(parts)}."] if parts else [text]
