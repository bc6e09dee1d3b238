"""Extreme scenes, run as a user would run them with every law and integrator: balances, closed forms, the steady orbit.

Contacts at surface points of condensed bodies are compared with the calibrated law on the same bodies; an equilibrium takes a second
and a step a tenth of one, so there are few steps.  Of bodies whose every node is a degree of freedom coarse meshes know the
displacement with one calibrated force a contact: it is compared with condensed bodies.  With pressures at points they do not (the
result says so): there the seat's force and the slope of the stored energy are compared with the load.  Equilibria know no friction;
motions do.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from typing import TYPE_CHECKING, Any, cast

import attrs
import numpy as np

from raceway.bodies.basis import make_basis
from raceway.core.record import Motion, Schedule, drift
from raceway.core.ring.system import surrogate
from raceway.core.time.schemes import integrate
from raceway.elastic.ring import at_rest
from raceway.errors import RacewayError, SceneError
from raceway.pipeline.equilibrium import solve_equilibrium
from raceway.planning.resolve import resolve, series_factor
from raceway.storage.tables import Tables
from raceway.studies.stability.catalogue import COARSE, STATIC, transient
from raceway.studies.stability.study import FAILED, Limit, Measured, Rows, short
from raceway.studies.stability.systems import Bench, axial_displacement, axial_force, stiffer_than_hertz

if TYPE_CHECKING:
    from raceway.bodies.model import Equilibrium, Model
    from raceway.pipeline.result import Result

#: Of the balls' loads, which push across the axis, too, and far more than along it where a film has flattened the contact angle.
_SLOPE = 1e-5
_SLOPE_WHY = "a difference over 1e-3 of the penetration, to 1e-8 of which elastic balls are placed: 1e-5 of the balls' loads"
#: What |Z| of a motion is compared with; "any": a user's scene, which ``periodic`` may be unable to take; "finer": no orbit is
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
_CALIBRATED: Tables = {"contact.kind": "hertz", "contact.discretisation": "resultant"}
_COARSE = "two points along a semi-axis are off by percents; converged ones differ by 1 %"
#: Steps of implicit methods, each of a time in which an explicit one takes ``_EXPLICIT`` at 0.9 of its limit.
_IMPLICIT, _EXPLICIT = 20, 20
#: Step [s] and steps of a motion with friction: a third of a period of the ring on its contacts.
_RUBBING = 1e-5, 15
#: How much larger the second of two loads is between which stored energies are compared.
_MORE = 0.02
#: Tolerance of implicit steps, and drift of the energy.
_TOLERANCE, _UNBALANCED = 1e-6, 1e-3


def extreme(
    rows: Rows, bench: Bench, judge: str = "", closed_form: bool = False, penalty_factor: float | None = None,
    may_be_too_stiff: bool = False,
) -> None:  # fmt: skip
    """One scene with one law: its equilibrium, and its motion by every transient integrator."""
    if penalty_factor is not None:
        bench = bench.changed({"contact.stiffness": penalty_factor * _default_penalty(bench)})
    if may_be_too_stiff and _too_stiff(rows, bench):
        return
    _at_rest(rows, bench, closed_form)
    if not judge:
        return
    words, why = "|Z| [N/m], predicted by the steady motion", _STEADY_WHY
    if judge == "finer":
        words, why = "|Z| [N/m], predicted by 1440 steps a turn", _FINER_WHY
    near, note = None, ""
    try:
        near = abs(_stiffness(bench.changed(_JUDGES[judge]).result()))
    except RacewayError as error:
        if judge != "any" or not isinstance(error, SceneError):
            rows.lost(f"refused, unexpectedly: {short(error)}", {"integrator": _JUDGES[judge]["integrator.kind"]})
            return
        note = f"no steady motion to compare with: {short(error)}"
    for name in transient(bench.registry):
        by_name, setting = {"integrator.kind": name}, {"integrator": name}

        @cache
        def result(by_name: Tables = by_name) -> Result:
            return bench.changed(by_name).result()

        def motion(result: Callable[[], Result] = result) -> Measured:
            return abs(_stiffness(result())), result().stability["energy_drift"]

        def balance(result: Callable[[], Result] = result) -> Measured:
            unbalanced = result().stability["energy_drift"]
            # No number fails the row: a motion whose energy nobody balances is not shown to be right.
            return (float("nan") if unbalanced is None else unbalanced), unbalanced

        if near is not None:
            row = rows.check(words, motion, why, Limit.equal(near, _Z_ERROR), at=setting)
            if row.verdict == FAILED and row.observed is not None:
                stated = max((value for value in result().error.values() if isinstance(value, float)), default=float("nan"))
                rows.written[-1] = attrs.evolve(row, note=f"the result itself states an error of {stated:.2g}")
        # Results tell no balance of energy for a law that loses some by itself.
        if near is None or (judge == "finer" and not bench.changed(by_name).scene.contact.law.dissipative):
            quantity = "completed; energy not balanced by the work"
            rows.check(quantity, balance, _DRIFT_WHY, Limit.at_most(_DRIFT), at=setting, note=note)


def _stiffness(result: Result) -> complex:
    assert result.identification is not None
    return result.identification.dynamic_stiffness


def _at_rest(rows: Rows, bench: Bench, closed_form: bool) -> None:
    """Axial forces of the contacts against the load; the approach by a closed form where there is one."""
    # Nothing turns and nothing rubs: the balls' loads are along their contact angles.
    bench = bench.changed({"kinematics.gyroscopic": "none", "contact.friction": 0.0})
    scene = bench.scene

    @cache
    def settled() -> tuple[Model, Equilibrium]:
        model = bench.model()
        return model, solve_equilibrium(model)

    def axial() -> float:
        model, equilibrium = settled()
        load = equilibrium.contact_force[: model.system.ball_count]
        return float(np.sum(np.where(load > 0.0, load * np.sin(np.nan_to_num(equilibrium.angle_inner)), 0.0)))

    load = scene.load.axial
    if scene.bodies.name == "rigid":
        why = "an equilibrium is solved to a residual of 1e-11"
        rows.check("sum of the balls' axial forces [N]", axial, why, Limit.equal(load, 1e-8))
    else:
        try:
            ratio = 0.5 * float(settled()[1].contact_force.sum()) / load
        except RacewayError:
            ratio = 1.0  # the row itself tells that there is no equilibrium
        words = "axial slope of the stored energy [N]"
        rows.check(words, lambda: axial_force(*settled()), _SLOPE_WHY, Limit.equal(load, _SLOPE * ratio))
    if closed_form:
        model = bench.changed({"kinematics.ball_inertia": False, "load.radial": [0.0, 0.0]}).model()
        why = "the law's own force, inverted for one ball by bisection; both are solved to 1e-9 and better"
        near, words = axial_displacement(model), "axial displacement [m]"
        rows.check(words, lambda: float(solve_equilibrium(model).displacement[0]), why, Limit.equal(near, 1e-6))


def _too_stiff(rows: Rows, bench: Bench) -> bool:
    """Whether elastic bodies refuse a law as too stiff: expected of no law softer than Hertz's."""
    try:
        bench.changed({"bodies.kind": "condensed"}).model()
    except SceneError as error:
        if _TOO_STIFF not in str(error):
            raise
        rigid = bench.changed({"bodies.kind": "rigid"}).model()
        allowed = stiffer_than_hertz(rigid, make_basis(rigid.problem).ball_load)
        why = "the law's own slope at the ball's load, or five times it, is above Hertz's; elastic bodies leave that no room"
        row = rows.refused(_TOO_STIFF, why, partial(_raise, error))
        if not allowed:
            rows.written[-1] = attrs.evolve(row, verdict=FAILED)
        return True
    return False


def _raise(error: RacewayError) -> None:
    raise error


def hertz_factor(rows: Rows, bench: Bench) -> None:
    """Hertz' contacts of a bearing, which laws are calibrated by, against a closed form."""
    scene = bench.scene
    basis = make_basis(resolve(scene))
    softness = float(basis.inner.factor ** (-2.0 / 3.0) + basis.outer.factor ** (-2.0 / 3.0))
    near, words = series_factor(scene.bearing) ** (-2.0 / 3.0), "approach of both races over load^(2/3) [m/N^(2/3)]"
    why = "the closed form's fit of the ellipse is good to 5 % (Hamrock and Brewe 1983)"
    rows.check(words, softness, why, Limit.equal(near, 0.05))


def _default_penalty(bench: Bench) -> float:
    """The penalty [N/m3] that gives the inner races the stiffness of the default."""
    models = [bench.changed({"contact.stiffness": value}).model() for value in (None, 1.0)]
    default, unit = (float(surrogate(model.system).law_params[0, 0]) for model in models)
    return default / unit


def refusal(rows: Rows, bench: Bench, words: str, reason: str) -> None:
    """A scene that has no answer: the message says why."""
    rows.refused(words, reason, lambda: bench.result())


def warning(rows: Rows, bench: Bench, words: str, reason: str) -> None:
    """A scene that has an answer, and something that a user must be told about it."""
    rows.warned(words, reason, bench.result().warnings)


def _calibrated(bench: Bench) -> Bench:
    """The same bodies with the calibrated law, steps apart."""
    same = {key: value for key, value in bench.changes.items() if key != "mesh" and not key.startswith("integrator.")}
    return attrs.evolve(bench, changes={**same, **_CALIBRATED})


def condensed_at_rest(rows: Rows, bench: Bench) -> None:
    """The axial displacement, and the balls' axial forces against the load."""
    bench = bench.changed({"excitation": None})
    results = [each.result() for each in (bench, _calibrated(bench))]
    balls = results[0].to_dict()["equilibrium"]["balls"]
    pressed = [ball for ball in balls if ball["contact_angle_inner_deg"] is not None]
    axial = sum(ball["load_inner_n"] * np.sin(np.radians(ball["contact_angle_inner_deg"])) for ball in pressed)
    x, near = (float(result.equilibrium.displacement[0]) for result in results)
    rows.check("axial displacement [m], predicted by Hertz on these bodies", x, _COARSE, Limit.equal(near, 0.06))
    why = "a ball's angle is that of its centre, the resultant of its pressures leans by a degree from it"
    rows.check("sum of the balls' axial forces [N]", axial, why, Limit.equal(results[0].model.problem.load.axial, 0.02))


def turn(rows: Rows, bench: Bench, integrator: str) -> None:
    """The dynamic stiffness of one turn."""
    steady, stepped = (
        each.changed({"integrator.kind": kind}) for each, kind in ((_calibrated(bench), "periodic"), (bench, integrator))
    )
    near, stiffness = (abs(_stiffness(each.result())) for each in (steady, stepped))
    rows.check("|Z| [N/m], predicted by Hertz on these bodies", stiffness, _COARSE, Limit.equal(near, 0.05))


def calibrated_at_rest(rows: Rows, bench: Bench) -> None:
    """Axial displacement and radial stiffness against condensed bodies; what the seat carries against the load."""
    condensed = bench.over(STATIC).changed({"bodies.kind": "condensed"}).result().equilibrium
    result = bench.over(COARSE).result()
    why = "elements of 3.2 mm, two through a wall, bend too little: 1 % as a rule; twice that"
    near, value = float(condensed.displacement[0]), float(result.equilibrium.displacement[0])
    rows.check("axial displacement [m], predicted by condensed bodies", value, why, Limit.equal(near, 0.02))
    near, value = float(condensed.stiffness[1, 1]), float(result.equilibrium.stiffness[1, 1])
    rows.check("radial stiffness [N/m], predicted by condensed bodies", value, why, Limit.equal(near, 0.02))
    _on_the_seat(rows, result)


def _on_the_seat(rows: Rows, result: Result) -> None:
    seat, load = -float(result.to_dict()["model"]["reaction_n"]["x"]), result.model.problem.load.axial
    why = "an equilibrium of all nodes is solved to 1e-7 of its forces"
    rows.check("axial force on the outer seat [N]", seat, why, Limit.equal(load, 1e-5))


def points_at_rest(rows: Rows, bench: Bench) -> None:
    """What the outer seat carries, and the stored energy over the axial way between two loads, against the load."""

    def settled(axial: float) -> tuple[float, float, Result]:
        result = bench.changed({"load.axial": axial}).result()
        stored = result.to_dict()["model"]["energies_j"]
        return float(result.equilibrium.displacement[0]), stored["elastic"] + stored["contact"], result

    load = bench.scene.load.axial
    x, stored, result = settled(load)
    _on_the_seat(rows, result)

    def slope() -> float:
        further, more, _ = settled((1.0 + _MORE) * load)
        return (more - stored) / (further - x)

    why = "points are looked up anew on the race's facets after 0.02 of a facet's half width, as on another mesh"
    words = "change of the stored energy over the axial way [N]"
    rows.check(words, slope, why, Limit.equal((1.0 + 0.5 * _MORE) * load, 0.02))


def _loaded_at_rest(bench: Bench) -> tuple[Any, Motion, Equilibrium]:
    """Elastic bodies at rest, as a force meets them."""
    model = bench.model()
    equilibrium, system = solve_equilibrium(model), cast("Any", model.system)
    return system, at_rest(system, False), equilibrium


def sudden_force(rows: Rows, bench: Bench, integrator: str) -> None:
    """A force that acts at once: a balance of energies; a step above the stable limit is refused."""
    ring, start, equilibrium = _loaded_at_rest(bench)
    limit, method = float(ring.critical_time_step(equilibrium.stiffness)), bench.method(integrator, _TOLERANCE)
    step, steps = 0.9 * limit, _IMPLICIT * _EXPLICIT
    if method.implicit:
        step, steps = _EXPLICIT * step, _IMPLICIT

    def balance() -> tuple[float, float]:
        worst = drift(integrate(method, ring, start, Schedule(step, steps, 1)).energies) or 0.0
        return worst, worst

    why = "steps of nanoseconds follow all but the waves of single elements, which carry little"
    setting = {"steps": steps, "step/limit": step / limit}
    rows.check("energy not balanced by the work", balance, why, Limit.at_most(_UNBALANCED), at=setting)
    if not method.implicit:
        far = partial(integrate, method, ring, start, Schedule(1.02 * limit, 10, 1))
        rows.refused("above the stable limit", "it is refused before it blows up", far, {"steps": 1, "step/limit": 1.02})


def rubbing(rows: Rows, bench: Bench) -> None:
    """A force that meets contacts with friction at rest: the balance of energies, and that friction takes part."""
    ring, start, _ = _loaded_at_rest(bench)
    step, steps = _RUBBING
    setting = {"integrator": "newmark", "steps": steps, "step_s": step}
    energies = integrate(bench.method("newmark", _TOLERANCE), ring, start, Schedule(step, steps, 1)).energies
    worst = drift(energies) or 0.0
    why = "a period of the ring takes forty of these steps; waves of single elements carry little"
    rows.check("energy not balanced by the work", (worst, worst), why, Limit.at_most(_UNBALANCED), at=setting)
    share = float(energies["friction"][-1] / (energies["external"][-1] - energies["external"][0]))
    why = "the rims of contacts slip at any force; rounding is 1e-12, and without friction it is nothing"
    rows.check("energy that friction took over the work", (share, worst), why, Limit.at_least(1e-6), at=setting)
