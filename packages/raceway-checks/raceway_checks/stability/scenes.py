"""Extreme scenes, run as a user would run them with every law and integrator: balances, closed forms, the steady orbit.

Approaches are the inverse of a law's force function, found by bisection; forces on the ring are slopes of the stored energy.

Contacts at surface points of condensed bodies are compared with the calibrated law on the same bodies; an equilibrium takes a second
and a step a tenth of one, so there are few steps.  Of bodies whose every node is a degree of freedom coarse meshes know the
displacement with one calibrated force a contact: it is compared with condensed bodies.  With pressures at points they do not (the
result says so): there the seat's force and the slope of the stored energy are compared with the load.  Equilibria know no friction;
motions do.
"""

from collections.abc import Callable
from functools import cache, partial
from math import atan2, sin, sqrt
from typing import Any, cast

import attrs
import numpy as np

from raceway import RacewayError, Result, SceneError
from raceway.extend import (
    Equilibrium, Model, Motion, Record, Schedule, Tables, at_rest, drift, energy_balance, integrate, law_params,
    make_basis, reach_of, renews, resolve, running_pairs, series_factor, solve_equilibrium, standstill, surrogate,
)  # fmt: skip
from raceway_checks.stability.catalogue import COARSE, STATIC, transient
from raceway_checks.stability.study import FAILED, Limit, Measured, Rows, short
from raceway_checks.stability.systems import Bench, energy_of_contacts, inverted

#: Of the balls' loads, which push across the axis, too, and far more than along it where a film has flattened the contact angle.
_SLOPE = 1e-5
_SLOPE_WHY = "a difference over 1e-3 of the penetration, to 1e-8 of which elastic balls are placed: 1e-5 of the balls' loads"
#: What |Z| of a motion is compared with; "any": a user's scene, which ``periodic`` may be unable to take; "finer": no orbit is
#: steady, or friction: the motion depends on its start, so that the same motion in finer steps is the truth.
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
        # Of the penalty [N/m3] that gives the inner races the stiffness of the default.
        models = [bench.changed({"contact.stiffness": value}).model() for value in (None, 1.0)]
        default, unit = (float(surrogate(model.system).law_params[0, 0]) for model in models)
        bench = bench.changed({"contact.stiffness": penalty_factor * (default / unit)})
    if may_be_too_stiff and _too_stiff(rows, bench):
        return
    _check_rest(rows, bench, closed_form)
    if not judge:
        return
    truth, why = ("1440 steps a turn", _FINER_WHY) if judge == "finer" else ("the steady motion", _STEADY_WHY)
    words, near, note = f"|Z| [N/m], predicted by {truth}", None, ""
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
            drift = result().stability["energy_drift"]
            # No number fails the row: a motion whose energy nobody balances is not shown to be right.
            return (float("nan") if drift is None else drift), drift

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


#: Rounds in which the contact angle settles: films depend on its cosine, and move it by a thousandth of that.
_ANGLES = 6
#: Loads of a ball over the mean one at which bodies that deform refuse a law.
_LOADS = (1.0, 5.0)
#: Step of a difference over the deepest penetration: its error is the square of that.
_PART = 1e-3


def _force_and_slope(model: Model, pair: int, approach: float, params: np.ndarray | None = None) -> tuple[float, float]:
    """Force [N] and stiffness [N/m] of one ball-race pair at rest, by the law's kernel; ``params`` (2 Z, k): not the model's."""
    system = surrogate(model.system)
    law_params = system.law_params if params is None else params
    params, state = (np.ascontiguousarray(each[pair : pair + 1]) for each in (law_params, system.law_state))
    force, d_gap, d_rate = np.empty(1), np.empty(1), np.empty(1)
    system.law(np.array([-approach]), np.zeros(1), params, state, state.copy(), 0.0, force, d_gap, d_rate)
    return float(force[0]), -float(d_gap[0])


def _force_at(model: Model, pair: int, params: np.ndarray | None, approach: float) -> float:
    return _force_and_slope(model, pair, approach, params)[0]


def displacement_under_axial_load(model: Model) -> float:
    """Displacement [m] under the axial load alone, the balls weightless.

    All balls carry the same load Q at both races, so that groove centres are s = s0 + delta_i(Q) + delta_o(Q) apart; their
    radial distance r stays, and cos alpha = r / s, F = Z Q sin alpha, which grows with Q and is inverted.  A law that begins to
    carry before surfaces touch has its reach taken off delta; one that follows speed and loads is built at Q and alpha.
    """
    z, rest_axial, rest_radial = model.system.ball_count, *model.geometry.rest
    size = 1e-3 * model.geometry.ball_diameter

    def axial(load: float) -> float:
        angle = model.problem.bearing.contact_angle
        for _ in range(_ANGLES if renews(model.problem.contact.law) else 1):
            params, reach = _at_load(model, load, angle)
            approach = 0.0
            for pair in (0, z):
                force_at = partial(_force_at, model, pair, params)
                approach += inverted(force_at, load, size) - float(reach[pair])
            distance = model.geometry.centre_distance + approach
            displacement = sqrt(max(distance**2 - rest_radial**2, 0.0))
            angle = atan2(displacement, rest_radial)
        return displacement

    def force(load: float) -> float:
        displacement = axial(load)
        return z * load * displacement / sqrt(displacement**2 + rest_radial**2)

    total = model.problem.load.axial
    load = inverted(force, total, total / (z * max(sin(model.problem.bearing.contact_angle), 0.1)))
    return axial(load) - rest_axial


def _at_load(model: Model, load: float, angle: float) -> tuple[np.ndarray | None, np.ndarray]:
    """Parameters and reach (2 Z,) of the law where all contacts carry a load [N] at an angle [rad]."""
    z, law = model.system.ball_count, model.problem.contact.law
    if not renews(law):
        return None, np.zeros(2 * z)
    angles = np.full(z, angle)
    pairs = running_pairs(model.problem, model.basis, np.full(2 * z, load), (angles, angles))
    return law_params(law, pairs), reach_of(law, pairs)


def _stiffer_than_hertz(model: Model, ball_load: float) -> bool:
    """Whether the law's own slope is above Hertz's where bodies that deform look at it; they leave Hertz's law room.

    Above by more than the rounding of powers, which differs from one processor to the next: Hertz's law is not stiffer than itself.
    """
    for pair, ellipse in ((0, model.inner), (model.system.ball_count, model.outer)):
        for load in (factor * ball_load for factor in _LOADS):
            approach = float(ellipse.approach(load))
            if _force_and_slope(model, pair, approach)[1] > (1.0 + 1e-9) * 1.5 * load / approach:
                return True
    return False


def energy_slope(model: Model, equilibrium: Equilibrium) -> float:
    """Slope [N] of the stored energy along the ring's axial displacement, in equilibrium; for conservative forces.

    Balls are in equilibrium themselves, so that what follows of them does not count.  Unlike a sum over the balls' loads it
    holds what a compliance that varies with the contact angle pushes along the groove.
    """
    system, axis, q = surrogate(model.system), np.eye(5)[0], equilibrium.displacement
    step = _PART * float(np.max(-system.evaluate(q, ball=equilibrium.ball).gap))
    displacements = np.array([q + sign * step * axis for sign in (-1.0, 1.0)])
    states = [system.evaluate(each, ball=equilibrium.ball) for each in displacements]
    gap, force, ball = (np.array([getattr(state, name) for state in states]) for name in ("gap", "contact_force", "ball"))
    rates, final = np.zeros((2, 5)), at_rest(system, displacements[1], ball[1], False)
    record = Record(np.array([0.0, 1.0]), displacements, rates, rates, gap, force, ball, final, Schedule(1.0, 2, 1), {})
    energy = energy_balance(system, record).stored
    # Contacts by the law's force between both gaps: over the whole approach a law with a short transition at first touch, such
    # as a roughness, is integrated to 1e-5 only, which the small difference of two energies magnifies.
    before, after = (energy_of_contacts(system.law, system.law_params, system.law_state, each).sum() for each in gap)
    # What all contacts store [J] between both gaps
    (first, last), n, total = gap, gap.shape[1], 0.0
    for at, weight in zip(*np.polynomial.legendre.leggauss(4), strict=True):
        force, slopes = np.empty(n), np.empty((2, n))
        here = first + 0.5 * (1.0 + at) * (last - first)
        system.law(here, np.zeros(n), system.law_params, system.law_state, system.law_state.copy(), 0.0, force, *slopes)
        total -= 0.5 * weight * float((force * (last - first)).sum())
    change = energy[1] - energy[0] - float(after - before) + total
    # The stored energy counts the load's potential, too, whose slope is the load.
    return float(system.load[0] + change / (2.0 * step))


def _check_rest(rows: Rows, bench: Bench, closed_form: bool) -> None:
    """Axial forces of the contacts against the load; the approach by a closed form where there is one."""
    # Nothing turns and nothing rubs: the balls' loads are along their contact angles.
    bench = bench.changed({"kinematics.gyroscopic": "none", "contact.friction": 0.0})
    scene, load = bench.scene, bench.scene.load.axial

    @cache
    def equilibrium_of_model() -> tuple[Model, Equilibrium]:
        model = bench.model()
        return model, solve_equilibrium(model)

    def axial() -> float:
        model, equilibrium = equilibrium_of_model()
        load = equilibrium.contact_force[: model.system.ball_count]
        return float(np.sum(np.where(load > 0.0, load * np.sin(np.nan_to_num(equilibrium.angle_inner)), 0.0)))

    if resolve(scene).traits.contacts_alone:
        why = "an equilibrium is solved to a residual of 1e-11"
        rows.check("sum of the balls' axial forces [N]", axial, why, Limit.equal(load, 1e-8))
    else:
        try:
            ratio = 0.5 * float(equilibrium_of_model()[1].contact_force.sum()) / load
        except RacewayError:
            ratio = 1.0  # the row itself tells that there is no equilibrium
        words = "axial slope of the stored energy [N]"
        rows.check(words, lambda: energy_slope(*equilibrium_of_model()), _SLOPE_WHY, Limit.equal(load, _SLOPE * ratio))
    if closed_form:
        model = bench.changed({"kinematics.ball_inertia": False, "load.radial": [0.0, 0.0]}).model()
        why = "the law's own force, inverted for one ball by bisection; both are solved to 1e-9 and better"
        near, words = displacement_under_axial_load(model), "axial displacement [m]"
        rows.check(words, lambda: float(solve_equilibrium(model).displacement[0]), why, Limit.equal(near, 1e-6))


def _too_stiff(rows: Rows, bench: Bench) -> bool:
    """Whether elastic bodies refuse a law as too stiff: expected of no law softer than Hertz's."""
    try:
        bench.changed({"bodies.kind": "condensed"}).model()
    except SceneError as error:
        if _TOO_STIFF not in str(error):
            raise
        rigid = bench.changed({"bodies.kind": "rigid"}).model()
        excusable = _stiffer_than_hertz(rigid, make_basis(rigid.problem).ball_load)
        why = "the law's own slope at the ball's load, or five times it, is above Hertz's; elastic bodies leave that no room"
        row = rows.refused(_TOO_STIFF, why, partial(_raise, error))
        if not excusable:
            rows.written[-1] = attrs.evolve(row, verdict=FAILED)
        return True
    return False


def _raise(error: RacewayError) -> None:
    raise error


def hertz_factor(rows: Rows, bench: Bench) -> None:
    """Hertz' contacts of a bearing, which laws are calibrated by, against a closed form."""
    basis = make_basis(resolve(bench.scene))
    softness = float(basis.inner.factor ** (-2.0 / 3.0) + basis.outer.factor ** (-2.0 / 3.0))
    near, words = series_factor(bench.scene.bearing) ** (-2.0 / 3.0), "approach of both races over load^(2/3) [m/N^(2/3)]"
    why = "the closed form's fit of the ellipse is good to 5 % (Hamrock and Brewe 1983)"
    rows.check(words, softness, why, Limit.equal(near, 0.05))


def refusal(rows: Rows, bench: Bench, words: str, reason: str) -> None:
    """A scene that has no answer: the message says why."""
    rows.refused(words, reason, lambda: bench.result())


def warning(rows: Rows, bench: Bench, words: str, reason: str) -> None:
    """A scene that has an answer, and something that a user must know about it."""
    rows.warned(words, reason, bench.result().warnings)


def _with_calibration(bench: Bench) -> Bench:
    """The same bodies with the calibrated law, steps apart."""
    same = {key: value for key, value in bench.changes.items() if key != "mesh" and not key.startswith("integrator.")}
    return attrs.evolve(bench, changes={**same, **_CALIBRATED})


def condensed_at_rest(rows: Rows, bench: Bench) -> None:
    """The axial displacement, and the balls' axial forces against the load."""
    bench = bench.changed({"excitation": None})
    results = [each.result() for each in (bench, _with_calibration(bench))]
    balls = results[0].to_dict()["equilibrium"]["balls"]
    contact_balls = [ball for ball in balls if ball["contact_angle_inner_deg"] is not None]
    axial = sum(ball["load_inner_n"] * np.sin(np.radians(ball["contact_angle_inner_deg"])) for ball in contact_balls)
    x, near = (float(result.equilibrium.displacement[0]) for result in results)
    rows.check("axial displacement [m], predicted by Hertz on these bodies", x, _COARSE, Limit.equal(near, 0.06))
    why = "a ball's angle is that of its centre, the resultant of its pressures leans by a degree from it"
    rows.check("sum of the balls' axial forces [N]", axial, why, Limit.equal(results[0].model.problem.load.axial, 0.02))


def turn(rows: Rows, bench: Bench, integrator: str) -> None:
    """The dynamic stiffness of one turn."""
    steady = _with_calibration(bench).changed({"integrator.kind": "periodic"})
    dynamic = bench.changed({"integrator.kind": integrator})
    near, stiffness = (abs(_stiffness(each.result())) for each in (steady, dynamic))
    rows.check("|Z| [N/m], predicted by Hertz on these bodies", stiffness, _COARSE, Limit.equal(near, 0.05))


def calibrated_at_rest(rows: Rows, bench: Bench) -> None:
    """Axial displacement and radial stiffness against condensed bodies; what the seat carries against the load."""
    of_condensed = bench.over(STATIC).changed({"bodies.kind": "condensed"}).result().equilibrium
    result = bench.over(COARSE).result()
    why = "elements of 3.2 mm, two through a wall, bend too little: 1 % as a rule; twice that"
    near, value = float(of_condensed.displacement[0]), float(result.equilibrium.displacement[0])
    rows.check("axial displacement [m], predicted by condensed bodies", value, why, Limit.equal(near, 0.02))
    near, value = float(of_condensed.stiffness[1, 1]), float(result.equilibrium.stiffness[1, 1])
    rows.check("radial stiffness [N/m], predicted by condensed bodies", value, why, Limit.equal(near, 0.02))
    _on_the_seat(rows, result)


def _on_the_seat(rows: Rows, result: Result) -> None:
    seat, load = -float(result.to_dict()["model"]["reaction_n"]["x"]), result.model.problem.load.axial
    why = "an equilibrium of all nodes is solved to 1e-7 of its forces"
    rows.check("axial force on the outer seat [N]", seat, why, Limit.equal(load, 1e-5))


def points_at_rest(rows: Rows, bench: Bench) -> None:
    """What the outer seat carries, and the stored energy over the axial way between two loads, against the load."""

    def at_axial_load(axial: float) -> tuple[float, float, Result]:
        result = bench.changed({"load.axial": axial}).result()
        stored = result.to_dict()["model"]["energies_j"]
        return float(result.equilibrium.displacement[0]), stored["elastic"] + stored["contact"], result

    load = bench.scene.load.axial
    x, energies, result = at_axial_load(load)
    _on_the_seat(rows, result)

    def slope() -> float:
        further, more, _ = at_axial_load((1.0 + _MORE) * load)
        return (more - energies) / (further - x)

    why = "points are looked up anew on the race's facets after 0.02 of a facet's half width, as on another mesh"
    words = "change of the stored energy over the axial way [N]"
    rows.check(words, slope, why, Limit.equal((1.0 + 0.5 * _MORE) * load, 0.02))


def _loaded_at_rest(bench: Bench) -> tuple[Any, Motion, Equilibrium]:
    """Elastic bodies at rest, as a force meets them."""
    model = bench.model()
    equilibrium, system = solve_equilibrium(model), cast("Any", model.system)
    return system, standstill(system, False), equilibrium


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
