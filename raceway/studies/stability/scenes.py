"""Extreme scenes, run as a user would run them with every law and integrator: balances, closed forms, the steady orbit."""

from __future__ import annotations

from functools import cache

import attrs
import numpy as np

from raceway.bodies.basis import make_basis
from raceway.bodies.model import build_model
from raceway.errors import RacewayError, SceneError
from raceway.framework.registry import Registry
from raceway.pipeline.result import Result
from raceway.pipeline.run import run
from raceway.pipeline.settle import settle
from raceway.planning.closed_form import series_factor
from raceway.planning.plan import make_plan
from raceway.scene.scene import Scene
from raceway.storage.tables import Tables
from raceway.studies.stability.case import (
    AS_EXPECTED,
    FAILED,
    AtMost,
    Case,
    Measured,
    Near,
    Row,
    judged,
    refused,
    short,
    unexpected,
)
from raceway.studies.stability.own_force import axial_displacement, stiffer_than_hertz
from raceway.studies.stability.stored import axial_force
from raceway.studies.stability.systems import scene_at, transient

_BALANCE = Near(1e-8, "an equilibrium is solved to a residual of 1e-11")
#: Of the balls' loads, which push across the axis, too, and far more than along it where a film has flattened the contact angle.
_SLOPE = 1e-5
_SLOPE_WHY = "a difference over 1e-3 of the penetration, to 1e-8 of which elastic balls are placed: 1e-5 of the balls' loads"
_INVERTED = Near(1e-6, "the law's own force, inverted for one ball by bisection; both are solved to 1e-9 and better")
_ROUGH = Near(0.05, "the closed form's fit of the ellipse is good to 5 % (Hamrock and Brewe 1983)")
_ORBIT = Near(0.01, "time steps cost 0.02 %, what is left of the transient after 12 turns 0.1 %; ten times that")
_FINER = Near(0.01, "360 steps a turn cost 1e-5 as a rule, a few 1e-3 where balls rattle: errors are of second order")
#: Drift of the energy that a completed motion may show: 360 steps a turn and light contacts.
_ENERGY = AtMost(0.05, "steps of a turn / 360 balance energy to 1e-4 as a rule; impacts that few steps resolve cost more")
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
_STEADY = "|Z| [N/m], predicted by the steady motion"
_STEPS = "|Z| [N/m], predicted by 1440 steps a turn"


def extreme(case: Case, registry: Registry) -> list[Row]:
    """One scene with one law: its equilibrium, and its motion by every transient integrator."""
    a = case.arguments
    changes = dict(a["changes"])
    if "penalty_factor" in a:
        changes["contact.stiffness"] = a["penalty_factor"] * _default_penalty(a["tables"], changes, registry)
    shown = dict(a["shown"])
    if a.get("may_be_too_stiff") and (row := _too_stiff(case, shown, changes, registry)):
        return [row]
    rows = _at_rest(case, shown, changes, registry)
    if not a["judge"]:
        return rows
    known: complex | None = None
    note = ""
    judge = _JUDGES[a["judge"]]

    def truth() -> complex:
        return _dynamic(run(scene_at(a["tables"], {**changes, **judge}, registry), registry))

    try:
        known = truth()
    except RacewayError as why:
        if a["judge"] != "any" or not isinstance(why, SceneError):
            setting = {**shown, "integrator": judge["integrator.kind"]}
            return [*rows, unexpected(case.name, setting, _predicted(a["judge"])[0], _ORBIT, why)]
        note = f"no steady motion to compare with: {short(why)}"
    for name in transient(registry):
        more = {**changes, "integrator.kind": name}
        rows += _moving(case, {**shown, "integrator": name}, more, known, note, registry)
    return rows


def _predicted(judge: str) -> tuple[str, Near]:
    return (_STEPS, _FINER) if judge == "finer" else (_STEADY, _ORBIT)


def _moving(case: Case, setting: Tables, changes: Tables, known: complex | None, note: str, registry: Registry) -> list[Row]:
    """|Z| where it is known; the balance of energy where no orbit is steady."""
    tables, judge = case.arguments["tables"], case.arguments["judge"]

    @cache
    def result() -> Result:
        return run(scene_at(tables, changes, registry), registry)

    def motion() -> Measured:
        return abs(_dynamic(result())), result().stability["energy_drift"]

    def balance() -> Measured:
        drift = result().stability["energy_drift"]
        # No number fails the row: a motion whose energy nobody balances is not shown to be right.
        return (float("nan") if drift is None else drift), drift

    rows = []
    if known is not None:
        words, near = _predicted(judge)
        row = judged(case.name, setting, words, near, abs(known), motion)
        if row.verdict == FAILED and row.observed is not None:
            row = attrs.evolve(row, note=f"the result itself states an error of {_stated(result()):.2g}")
        rows.append(row)
    # Results tell no balance of energy for a law that loses some by itself.
    loses = scene_at(tables, changes, registry).contact.law.dissipative
    if known is None or (judge == "finer" and not loses):
        rows.append(judged(case.name, setting, "completed; energy not balanced by the work", _ENERGY, 0.0, balance, note))
    return rows


def _stated(result: Result) -> float:
    """The largest of the errors that a result states of its |Z|."""
    return max((value for value in result.error.values() if isinstance(value, float)), default=float("nan"))


def _dynamic(result: Result) -> complex:
    found = result.identification
    assert found is not None
    return found.dynamic_stiffness


def _at_rest(case: Case, shown: Tables, changes: Tables, registry: Registry) -> list[Row]:
    """Axial forces of the contacts against the load; the approach by a closed form where there is one."""
    a = case.arguments
    # Nothing turns and nothing rubs: the balls' loads are along their contact angles.
    quiet = {**changes, "kinematics.gyroscopic": "none", "contact.friction": 0.0}
    scene = scene_at(a["tables"], quiet, registry)
    rows = []

    def axial() -> Measured:
        model = build_model(scene, make_plan(scene))
        found = settle(model)
        if scene.bodies.name != "rigid":
            return axial_force(model, found), None
        load = found.contact_force[: model.system.ball_count]
        return float(np.sum(np.where(load > 0.0, load * np.sin(np.nan_to_num(found.angle_inner)), 0.0))), None

    rigid = scene.bodies.name == "rigid"
    words, bound = "sum of the balls' axial forces [N]", _BALANCE
    if not rigid:
        words, bound = "axial slope of the stored energy [N]", Near(_SLOPE * _load_ratio(scene), _SLOPE_WHY)
    rows.append(judged(case.name, shown, words, bound, scene.load.axial, axial))
    if a.get("closed_form"):
        alone = {**quiet, "kinematics.ball_inertia": False, "load.radial": [0.0, 0.0]}

        def approach() -> Measured:
            scene = scene_at(a["tables"], alone, registry)
            return float(settle(build_model(scene, make_plan(scene))).displacement[0]), None

        scene = scene_at(a["tables"], alone, registry)
        own = axial_displacement(build_model(scene, make_plan(scene)))
        rows.append(judged(case.name, shown, "axial displacement [m]", _INVERTED, own, approach))
    return rows


def _load_ratio(scene: Scene) -> float:
    """Sum of the balls' loads over the axial load; 1 where no equilibrium is found, which the row itself will tell."""
    try:
        found = settle(build_model(scene, make_plan(scene)))
    except RacewayError:
        return 1.0
    return 0.5 * float(found.contact_force.sum()) / scene.load.axial


def _too_stiff(case: Case, shown: Tables, changes: Tables, registry: Registry) -> Row | None:
    """The row of a law that elastic bodies refuse as too stiff, if they do: expected of no law softer than Hertz's."""
    tables = case.arguments["tables"]
    scene, stiff = (scene_at(tables, {**changes, "bodies.kind": kind}, registry) for kind in ("condensed", "rigid"))
    try:
        build_model(scene, make_plan(scene))
    except SceneError as why:
        if _TOO_STIFF not in str(why):
            raise
        load = make_basis(stiff).ball_load
        expected = stiffer_than_hertz(build_model(stiff, make_plan(stiff)), load)
        reason = (
            "the law's own slope at the ball's load, or five times it, is above Hertz's; elastic bodies leave that no room"
        )
        head = (case.name, shown, "message", f"refused: '{_TOO_STIFF}'", None, None, None)
        return Row(*head, AS_EXPECTED if expected else FAILED, reason, short(why))
    return None


def hertz_factor(case: Case, registry: Registry) -> list[Row]:
    """Hertz' contacts of a bearing, which laws are calibrated by, against a closed form."""
    scene = scene_at(case.arguments["tables"], case.arguments["changes"], registry)

    def softness() -> Measured:
        basis = make_basis(scene)
        return float(basis.inner.factor ** (-2.0 / 3.0) + basis.outer.factor ** (-2.0 / 3.0)), None

    quantity = "approach of both races over load^(2/3) [m/N^(2/3)]"
    return [judged(case.name, {}, quantity, _ROUGH, series_factor(scene) ** (-2.0 / 3.0), softness)]


def _default_penalty(tables: Tables, changes: Tables, registry: Registry) -> float:
    """The penalty [N/m3] that gives the inner races the stiffness of the default."""
    own, unit = ({**changes, "contact.stiffness": value} for value in (None, 1.0))
    factors = [_inner_factor(tables, each, registry) for each in (own, unit)]
    return factors[0] / factors[1]


def _inner_factor(tables: Tables, changes: Tables, registry: Registry) -> float:
    scene = scene_at(tables, changes, registry)
    from raceway.core.ring.surrogate import surrogate

    return float(surrogate(build_model(scene, make_plan(scene)).system).law_params[0, 0])


def refusal(case: Case, registry: Registry) -> list[Row]:
    """A scene that has no answer: the message says why."""
    a = case.arguments
    return [
        refused(case.name, a["shown"], a["words"], a["reason"], lambda: run(scene_at(a["tables"], a["changes"], registry)))
    ]


def warning(case: Case, registry: Registry) -> list[Row]:
    """A scene that has an answer, and something that a user must be told about it."""
    a = case.arguments
    result = run(scene_at(a["tables"], a["changes"], registry))
    found = next((text for text in result.warnings if a["words"] in text), None)
    head = (case.name, a["shown"], "warning", f"warned: '{a['words']}'", None, None, None)
    return [Row(*head, FAILED if found is None else AS_EXPECTED, a["reason"], found or "no such warning")]
