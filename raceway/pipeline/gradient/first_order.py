"""The band of an answer over the tolerances of its scene, to first order: derivatives times ranges, nothing is solved again.

Notes
-----
Numbers are even in their ranges and independent, as ``raceway band`` takes them; an answer is the nominal one plus the sum of its
derivatives by each number times what that lies off.  The density of the sum is the convolution of even ones, from which the limits
of 95 % are taken.  Tolerances that bend the answer within their range need ``raceway band``.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model
from raceway.errors import ConvergenceError, SceneError
from raceway.pipeline.gradient.gradients import Gradient, Gradients
from raceway.pipeline.gradient.quantities import definitions, derivatives, described, values
from raceway.pipeline.gradient.statics import static_gradient
from raceway.pipeline.gradient.variation import NoDerivative
from raceway.scene.given import leaves
from raceway.scene.tolerance import tolerances_of
from raceway.storage.tables import Tables

#: Share of the answers in a band; points of a density.
_COVERAGE, _POINTS = 0.95, 4001


def first_order_band(model: Model, equilibrium: Equilibrium) -> Tables | None:
    """The table ``tolerances`` of result.json; None where the scene has none.

    Returns
    -------
    quantities : name -> value, unit, definition, low, high, and ``shares`` of the variance by key;  left_out : keys without a derivative, with reasons
    why : why there are no quantities, or none of the motion; empty else
    """
    scene = model.scene
    if "tolerances" not in scene.source:
        return None
    tolerances = tolerances_of(scene, dict(leaves(scene.source["tolerances"])))
    orbit, why = None, ""
    try:
        gradients = Gradients(model, equilibrium)
    except SceneError as none:
        return {"quantities": {}, "left_out": [], "why": none.mistakes[0].message}
    try:
        orbit = gradients.orbit
    except (SceneError, ConvergenceError) as none:
        why = f"at rest only: {none.mistakes[0].message if isinstance(none, SceneError) else none}"
    now, words = values(model, equilibrium, orbit), definitions(model, equilibrium)
    slopes, left_out = {}, []
    for one in tolerances:
        try:
            statics = static_gradient(model, equilibrium, one.key)
            found = Gradient(statics, None if orbit is None else orbit.gradient(statics))
        except NoDerivative as reason:
            left_out.append({"key": one.key.path, "reason": str(reason)})
            continue
        slopes[one.key.path] = one.low - one.key.value, one.high - one.key.value, derivatives(model, equilibrium, found)
    quantities = {}
    for name, value in now.items():
        ends = [sorted(slope[name] * end for end in (low, high)) for low, high, slope in slopes.values()]
        low, high = limits(ends)
        widths = np.array([(two - one) ** 2 for one, two in ends])
        shares = widths / widths.sum() if widths.any() else widths
        quantities[name] = {
            **described(name, value, words),
            "low": value + low,
            "high": value + high,
            "shares": dict(zip(slopes, shares.tolist(), strict=True)),
        }
    return {"quantities": quantities, "left_out": left_out, "why": why}


def limits(ends: Sequence[Sequence[float]], share: float = _COVERAGE) -> tuple[float, float]:
    """Limits of a share of the sum of independent numbers that are even between their ends, (d, 2); 0 of none."""
    middle = sum(0.5 * (low + high) for low, high in ends)
    halves = [0.5 * (high - low) for low, high in ends if high > low]
    if not halves:
        return middle, middle
    reach = sum(halves)
    x = np.linspace(-reach, reach, _POINTS)
    # The distribution of one, then its mean over each of the others in turn.
    below = np.clip((x + halves[0]) / (2.0 * halves[0]), 0.0, 1.0)
    for half in halves[1:]:
        whole = np.concatenate([[0.0], np.cumsum(0.5 * (below[1:] + below[:-1]) * np.diff(x))])
        ahead = np.interp(x + half, x, whole) + np.maximum(x + half - reach, 0.0)
        below = (ahead - np.interp(x - half, x, whole)) / (2.0 * half)
    out = 0.5 * (1.0 - share)
    return middle + float(np.interp(out, below, x)), middle + float(np.interp(1.0 - out, below, x))
