"""Extreme scenes, run as a user would run them with every law and integrator: balances, closed forms, the steady orbit."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from typing import TYPE_CHECKING

import attrs
import numpy as np

from raceway.bodies.basis import make_basis
from raceway.core.ring.surrogate import surrogate
from raceway.errors import RacewayError, SceneError
from raceway.framework.registry import Registry
from raceway.pipeline.run import run
from raceway.pipeline.settle import settle
from raceway.planning.closed_form import series_factor
from raceway.storage.tables import Tables
from raceway.studies.stability.case import FAILED, Measured, Rows, short
from raceway.studies.stability.own_force import axial_displacement, stiffer_than_hertz
from raceway.studies.stability.stored import axial_force
from raceway.studies.stability.systems import model_at, scene_at, transient

if TYPE_CHECKING:
    from raceway.bodies.equilibrium import Equilibrium
    from raceway.bodies.model import Model
    from raceway.pipeline.result import Result

#: Of the balls' loads, which push across the axis, too, and far more than along it where a film has flattened the contact angle.
_SLOPE = 1e-5
_SLOPE_WHY = "a difference over 1e-3 of the penetration, to 1e-8 of which elastic balls are placed: 1e-5 of the balls' loads"
#: What |Z| of a motion is held against; "any": a user's scene, which ``periodic`` may be unable to take; "finer": no orbit is
#: steady, or friction remembers how the motion began, so that the same motion in finer steps is the truth.
_JUDGES: dict[str, Tables] = {
    "orbit": {"integrator.kind": "periodic"},
    "slow": {"integrator.kind": "quasi_static"},
    "any": {"integrator.kind": "periodic"},
    "finer": {"integrator.kind": "newmark", "integrator.steps_per_turn": 1440},
}
#: Of the message about a law that leaves elastic bodies no compliance.
_TOO_STIFF = "stiffer than elastic bodies allow"
_STEADY_WHY = "time steps cost 0.02 %, what is left of the transient after 12 turns 0.1 %; ten times that"
_FINER_WHY = "360 steps a turn cost 1e-5 as a rule, a few 1e-3 where balls rattle: errors are of second order"
#: Largest relative error of |Z|, and the drift that a completed motion may show: 360 steps a turn and light contacts.
_Z_ERROR, _DRIFT = 0.01, 0.05
_DRIFT_WHY = "steps of a turn / 360 balance energy to 1e-4 as a rule; impacts that few steps resolve cost more"


def extreme(
    rows: Rows, registry: Registry, tables: Tables, changes: Tables, judge: str = "", closed_form: bool = False,
    penalty_factor: float | None = None, may_be_too_stiff: bool = False,
) -> None:  # fmt: skip
    """One scene with one law: its equilibrium, and its motion by every transient integrator."""
    if penalty_factor is not None:
        changes = {**changes, "contact.stiffness": penalty_factor * _default_penalty(tables, changes, registry)}
    if may_be_too_stiff and _too_stiff(rows, registry, tables, changes):
        return
    _at_rest(rows, registry, tables, changes, closed_form)
    if not judge:
        return
    words, why = "|Z| [N/m], predicted by the steady motion", _STEADY_WHY
    if judge == "finer":
        words, why = "|Z| [N/m], predicted by 1440 steps a turn", _FINER_WHY
    known, note = None, ""
    try:
        known = _stiffness(run(scene_at(tables, {**changes, **_JUDGES[judge]}, registry), registry))
    except RacewayError as error:
        if judge != "any" or not isinstance(error, SceneError):
            rows.lost(f"refused, unexpectedly: {short(error)}", {"integrator": _JUDGES[judge]["integrator.kind"]})
            return
        note = f"no steady motion to compare with: {short(error)}"
    for name in transient(registry):
        more, setting = {**changes, "integrator.kind": name}, {"integrator": name}

        @cache
        def result(more: Tables = more) -> Result:
            return run(scene_at(tables, more, registry), registry)

        def motion(found: Callable[[], Result] = result) -> Measured:
            return abs(_stiffness(found())), found().stability["energy_drift"]

        def balance(found: Callable[[], Result] = result) -> Measured:
            drift = found().stability["energy_drift"]
            # No number fails the row: a motion whose energy nobody balances is not shown to be right.
            return (float("nan") if drift is None else drift), drift

        if known is not None:
            row = rows.check(words, motion, why, near=abs(known), within=_Z_ERROR, at=setting)
            if row.verdict == FAILED and row.observed is not None:
                stated = max((value for value in result().error.values() if isinstance(value, float)), default=float("nan"))
                rows.written[-1] = attrs.evolve(row, note=f"the result itself states an error of {stated:.2g}")
        # Results tell no balance of energy for a law that loses some by itself.
        if known is None or (judge == "finer" and not scene_at(tables, more, registry).contact.law.dissipative):
            quantity = "completed; energy not balanced by the work"
            rows.check(quantity, balance, _DRIFT_WHY, at_most=_DRIFT, at=setting, note=note)


def _stiffness(result: Result) -> complex:
    found = result.identification
    assert found is not None
    return found.dynamic_stiffness


def _at_rest(rows: Rows, registry: Registry, tables: Tables, changes: Tables, closed_form: bool) -> None:
    """Axial forces of the contacts against the load; the approach by a closed form where there is one."""
    # Nothing turns and nothing rubs: the balls' loads are along their contact angles.
    quiet = {**changes, "kinematics.gyroscopic": "none", "contact.friction": 0.0}
    scene = scene_at(tables, quiet, registry)

    @cache
    def settled() -> tuple[Model, Equilibrium]:
        model = model_at(tables, quiet, registry)
        return model, settle(model)

    def axial() -> float:
        model, found = settled()
        load = found.contact_force[: model.system.ball_count]
        return float(np.sum(np.where(load > 0.0, load * np.sin(np.nan_to_num(found.angle_inner)), 0.0)))

    load = scene.load.axial
    if scene.bodies.name == "rigid":
        why = "an equilibrium is solved to a residual of 1e-11"
        rows.check("sum of the balls' axial forces [N]", axial, why, near=load, within=1e-8)
    else:
        try:
            ratio = 0.5 * float(settled()[1].contact_force.sum()) / load
        except RacewayError:
            ratio = 1.0  # the row itself tells that there is no equilibrium
        words = "axial slope of the stored energy [N]"
        rows.check(words, lambda: axial_force(*settled()), _SLOPE_WHY, near=load, within=_SLOPE * ratio)
    if closed_form:
        model = model_at(tables, {**quiet, "kinematics.ball_inertia": False, "load.radial": [0.0, 0.0]}, registry)
        why = "the law's own force, inverted for one ball by bisection; both are solved to 1e-9 and better"
        own, words = axial_displacement(model), "axial displacement [m]"
        rows.check(words, lambda: float(settle(model).displacement[0]), why, near=own, within=1e-6)


def _too_stiff(rows: Rows, registry: Registry, tables: Tables, changes: Tables) -> bool:
    """Whether elastic bodies refuse a law as too stiff: expected of no law softer than Hertz's."""
    try:
        model_at(tables, {**changes, "bodies.kind": "condensed"}, registry)
    except SceneError as error:
        if _TOO_STIFF not in str(error):
            raise
        stiff = {**changes, "bodies.kind": "rigid"}
        load = make_basis(scene_at(tables, stiff, registry)).ball_load
        allowed = stiffer_than_hertz(model_at(tables, stiff, registry), load)
        why = "the law's own slope at the ball's load, or five times it, is above Hertz's; elastic bodies leave that no room"
        row = rows.refused(_TOO_STIFF, why, partial(_raise, error))
        if not allowed:
            rows.written[-1] = attrs.evolve(row, verdict=FAILED)
        return True
    return False


def _raise(error: RacewayError) -> None:
    raise error


def hertz_factor(rows: Rows, registry: Registry, tables: Tables, changes: Tables) -> None:
    """Hertz' contacts of a bearing, which laws are calibrated by, against a closed form."""
    scene = scene_at(tables, changes, registry)
    basis = make_basis(scene)
    softness = float(basis.inner.factor ** (-2.0 / 3.0) + basis.outer.factor ** (-2.0 / 3.0))
    near, why = (
        series_factor(scene) ** (-2.0 / 3.0),
        "the closed form's fit of the ellipse is good to 5 % (Hamrock and Brewe 1983)",
    )
    rows.check("approach of both races over load^(2/3) [m/N^(2/3)]", softness, why, near=near, within=0.05)


def _default_penalty(tables: Tables, changes: Tables, registry: Registry) -> float:
    """The penalty [N/m3] that gives the inner races the stiffness of the default."""
    models = [model_at(tables, {**changes, "contact.stiffness": value}, registry) for value in (None, 1.0)]
    default, unit = (float(surrogate(model.system).law_params[0, 0]) for model in models)
    return default / unit


def refusal(rows: Rows, registry: Registry, tables: Tables, changes: Tables, words: str, reason: str) -> None:
    """A scene that has no answer: the message says why."""
    rows.refused(words, reason, lambda: run(scene_at(tables, changes, registry)))


def warning(rows: Rows, registry: Registry, tables: Tables, changes: Tables, words: str, reason: str) -> None:
    """A scene that has an answer, and something that a user must be told about it."""
    rows.warned(words, reason, run(scene_at(tables, changes, registry)).warnings)
