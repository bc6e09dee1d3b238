"""Numbers of a scene that have derivatives, their slopes by a key, and their band over tolerances to first order.

Over tolerances numbers are even in their ranges and independent, as ``raceway band`` takes them; an answer is the nominal one plus the
sum of its derivatives by each number times what that lies off.  The density of the sum is the convolution of even ones, from which the
limits of 95 % are taken.  Tolerances that bend the answer within their range need ``raceway band``.
"""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from raceway.answers.quantities import (
    AMPLITUDE,
    DIFFERENTIABLE,
    KXX,
    KYY,
    KYY_TILTS_FOLLOW,
    LARGEST_BALL_LOAD,
    C,
    K,
    X,
    quantity_of,
    read_in,
)
from raceway.bodies.model import Equilibrium, Model, tilts_follow
from raceway.errors import ConvergenceError, SceneError
from raceway.framework.loading.registry import default_registry
from raceway.framework.shown import Fact, race_words, tilt_words
from raceway.pipeline.equilibrium import race_of
from raceway.pipeline.gradient import Gradient, Gradients, NoDerivative, StaticGradient, SteadyOrbit
from raceway.scene.tolerance import stated_tolerances, tolerances_of
from raceway.storage.tables import Tables

_NONE_LEFT = "no intervals: every tolerance is left out"
_SOME_LEFT = "some tolerances are left out: wider intervals are likely"
#: Part of |Z| below which w C is no number that an orbit resolves.
_RESOLVED = 1e-6
#: Share of the answers in a band; points of a density.
_COVERAGE, _POINTS = 0.95, 4001


def values(model: Model, equilibrium: Equilibrium, orbit: SteadyOrbit | None) -> dict[str, float]:
    """The numbers that a scene has, by their symbols: of the steady orbit, and at rest."""
    numbers: dict[str, float] = {}
    if orbit is not None:
        real, damping, stiffness, amplitude, imag = orbit.line.tolist()
        numbers |= {K.symbol: stiffness, AMPLITUDE.symbol: amplitude}
        if resolved(real, imag):
            numbers[C.symbol] = damping
    numbers |= _at_rest(equilibrium, equilibrium)
    if (follows := tilts_follow(equilibrium.stiffness, model.problem.supports.tilt)) is not None:
        numbers[KYY_TILTS_FOLLOW.symbol] = follows
    return {name: numbers[name] for name in DIFFERENTIABLE if name in numbers}


def resolved(real: np.ndarray | float, imag: np.ndarray | float) -> np.ndarray:
    """Whether an orbit of this Z [N/m] has a damping that is a number."""
    return np.abs(imag) > _RESOLVED * np.abs(real)


def described(name: str, value: float, words: dict[str, str]) -> Tables:
    """A number as JSON files hold it; ``words`` as ``definitions`` has them."""
    return {"value": value, "unit": quantity_of(name).unit, "definition": words[name]}


def definitions(model: Model, equilibrium: Equilibrium) -> dict[str, str]:
    """What each number of ``values`` is."""
    inner, outer = equilibrium.contact_force.reshape(2, -1).max(axis=1).tolist()
    return {
        **{symbol: quantity.words for symbol, quantity in DIFFERENTIABLE.items()},
        KYY_TILTS_FOLLOW.symbol: f"radial, {tilt_words(model.problem.supports.tilt)}: tilts follow, x and z held",
        LARGEST_BALL_LOAD.symbol: f"static, {race_words(race_of(inner, outer))}; the larger of both",
    }


def derivatives(model: Model, equilibrium: Equilibrium, gradient: Gradient) -> dict[str, float]:
    """Of the same, by the number at the gradient's key."""
    statics, motion = gradient.statics, gradient.motion
    slopes: dict[str, float] = {}
    if motion is not None:
        slopes |= {quantity.symbol: getattr(motion, quantity.name) for quantity in (K, C, AMPLITUDE)}
    slopes |= _at_rest(equilibrium, statics)
    if (tilt := model.problem.supports.tilt) != "locked":
        by = float(statics.key.path == "supports.tilt")
        stiffness = equilibrium.stiffness
        back = np.linalg.pinv(stiffness[3:, 3:] + (tilt if isinstance(tilt, float) else 0.0) * np.eye(2))
        left, right = np.r_[1.0, -stiffness[1, 3:] @ back], np.r_[1.0, -back @ stiffness[3:, 1]]
        slope = statics.stiffness[np.ix_([1, 3, 4], [1, 3, 4])] + by * np.diag([0.0, 1.0, 1.0])
        slopes[KYY_TILTS_FOLLOW.symbol] = float(left @ slope @ right)
    return slopes


def _at_rest(equilibrium: Equilibrium, state: Equilibrium | StaticGradient) -> dict[str, float]:
    """The numbers that every scene has, of the equilibrium or of its slopes."""
    return {
        KXX.symbol: float(state.stiffness[0, 0]),
        KYY.symbol: float(state.stiffness[1, 1]),
        X.symbol: float(state.displacement[0]),
        LARGEST_BALL_LOAD.symbol: float(state.contact_force[np.argmax(equilibrium.contact_force)]),
    }


def first_order_band(
    model: Model, equilibrium: Equilibrium, tolerances: Iterable[str] | Mapping[str, str] = ()
) -> Tables | None:
    """The table ``tolerances`` of result.json, of the scene's own tolerances or of others; None without any.

    quantities : name -> value, unit, definition, low, high, and ``shares`` of the variance by key
    left_out : keys without a derivative, with reasons
    why : why there are no quantities, none of the motion, or intervals of a part of the tolerances; empty else
    """
    scene = model.scene
    if not tolerances and "tolerances" not in scene.source:
        return None
    ranges = tolerances_of(scene, tolerances or stated_tolerances(scene))
    try:
        gradients = Gradients(model, equilibrium)
    except SceneError as refusal:
        return {"quantities": {}, "left_out": [], "why": refusal.mistakes[0].message}
    why, orbit = "", None
    try:
        orbit = gradients.orbit
    except (SceneError, ConvergenceError) as failure:
        why = f"at rest only: {failure.mistakes[0].message if isinstance(failure, SceneError) else failure}"
        gradients = Gradients(model, equilibrium, moving=False)
    words, slopes, left_out = definitions(model, equilibrium), {}, []
    for tolerance, answer in zip(ranges, gradients.by_all([tolerance.key for tolerance in ranges]), strict=True):
        key = tolerance.key
        if isinstance(answer, NoDerivative):
            left_out.append({"key": key.path, "reason": str(answer)})
        else:
            by_name = dict(zip(gradients.stated, answer.statics.stated.tolist(), strict=True))
            by_name |= derivatives(model, equilibrium, answer)
            slopes[key.path] = tolerance.low - key.value, tolerance.high - key.value, by_name
    words |= {name: quantity_of(name).words for name in gradients.stated}
    if left_out:
        why = "; ".join(filter(None, (why, _SOME_LEFT if slopes else _NONE_LEFT)))
    quantities: Tables = {}
    if left_out and not slopes:
        return {"quantities": quantities, "left_out": left_out, "why": why}
    for name, value in {**values(model, equilibrium, orbit), **gradients.stated}.items():
        ends = [sorted(slope[name] * end for end in (low, high)) for low, high, slope in slopes.values()]
        low, high = limits(ends)
        widths = np.array([(above - below) ** 2 for below, above in ends])
        shares = widths / widths.sum() if widths.any() else widths
        quantities[name] = {
            **described(name, value, words),
            "low": value + low,
            "high": value + high,
            "shares": dict(zip(slopes, shares.tolist(), strict=True)),
        }
    return {"quantities": quantities, "left_out": left_out, "why": why}


def tolerance_rows(band: Tables | None) -> list[Fact]:
    """The band over the scene's tolerances to first order, as rows of a screen; of each answer the tolerance that makes most of it.

    Of a plug-in's numbers the first one.
    """
    if not band:
        return []
    plugins = (entry.plugin for entry in default_registry().of_kind("quantity"))
    leading = {plugin.numbers[0].name: plugin.numbers[0].label for plugin in plugins}
    rows: list[Fact] = [("Tolerances, 95 % to first order", "", band["why"])]
    for name, quantity in band["quantities"].items():
        if name not in DIFFERENTIABLE and name not in leading:
            continue
        (low, unit), (high, _) = (read_in(quantity[end], quantity["unit"]) for end in ("low", "high"))
        key, share = max(quantity["shares"].items(), key=lambda item: item[1], default=("", 0.0))
        remarks = [f"{100.0 * share:.0f} % of the variance by {key}"] if share else []
        remarks += [quantity["definition"]] if name in ("kyy", "kyy_tilts_follow", "largest_ball_load") else []
        rows.append((leading.get(name, name).replace("_", " "), f"{low:.5g} to {high:.5g} {unit}", "; ".join(remarks)))
    rows += [("", "", f"without {left_out['key']}: {left_out['reason']}") for left_out in band["left_out"]]
    return rows


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
        integral = np.concatenate([[0.0], np.cumsum(0.5 * (below[1:] + below[:-1]) * np.diff(x))])
        ahead = np.interp(x + half, x, integral) + np.maximum(x + half - reach, 0.0)
        below = (ahead - np.interp(x - half, x, integral)) / (2.0 * half)
    out = 0.5 * (1.0 - share)
    return middle + float(np.interp(out, below, x)), middle + float(np.interp(1.0 - out, below, x))
