"""Combinations that cannot run, each with the reason and the remedy: all at once, before anything is built."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from math import inf

import attrs

from raceway.core.time.schemes import missing_driver
from raceway.errors import Mistake, SceneError
from raceway.framework.duties import has_phase, renews, speed_rpm
from raceway.planning.resolve import Problem, recorded_per_turn
from raceway.scene.growth import growth_faults, loose_rings

#: Called as ``refuse(bad, path, value, why)``.
_Refuse = Callable[[bool, str, object, str], None]


def refuse_what_cannot_run(problem: Problem) -> None:
    """Raise ``SceneError`` with everything that this version, or this combination, cannot do."""
    faults: list[Mistake] = []

    def refuse(bad: bool, path: str, value: object, why: str) -> None:
        if bad:
            faults.append(Mistake(path, value, why))

    kinematics, contact, method = problem.kinematics, problem.contact, problem.integrator.method
    faults += problem.scene.body_kind.faults()
    law = contact.law
    if contact.discretisation not in law.discretisations:
        choice = " or ".join(f"'{d}'" for d in sorted(law.discretisations))
        faults.append(Mistake("contact.discretisation", contact.discretisation, f"law '{contact.kind}' supports {choice}"))
    _refuse_renewed(problem, refuse)
    _refuse_time_constant(problem, refuse)
    need_bore = "needs the bearing's `bore`"
    refuse(kinematics.ring_growth and problem.bearing.bore is None, "kinematics.ring_growth", True, need_bore)
    alone = kinematics.gyroscopic != "none" and not kinematics.ball_inertia
    why = "comes with the balls' centrifugal force, which alone presses an idle ball to its race: set ball_inertia = true"
    refuse(alone, "kinematics.gyroscopic", kinematics.gyroscopic, why)
    refuse(
        kinematics.orbiting and problem.spin_speed == 0.0, "kinematics.orbiting", True, "needs a spin speed: nothing turns"
    )
    compiled = problem.traits.compiled
    why = (
        f"has no terms that follow the changing speed of '{getattr(problem.excitation, 'name', None)}', which contact resultants on "
        "rigid or condensed bodies have; use those, or give one speed to balls, ring and rotor with kinematics.spin_speed_rpm"
    )
    refuse(problem.spin_changes and not compiled, *_slow(problem), why)
    why = "does not follow a speed that changes: set it false, or give one speed with kinematics.spin_speed_rpm"
    refuse(kinematics.ball_growth and problem.spin_changes, "kinematics.ball_growth", True, why)
    faults += growth_faults(problem.scene)
    _refuse_different_rows(problem, refuse)
    if problem.excitation is not None and problem.excitation.amplitude_n == 0.0:
        faults.append(Mistake("excitation", None, "its force is zero: leave the table out for a static problem"))
    if problem.excitation is not None:
        _refuse_identifier(problem, refuse)
        if "record" in problem.identifier.method.needs:
            _refuse_driver(problem, refuse)
        if method.steady and "record" in problem.identifier.method.needs:
            _refuse_steady(problem, refuse)
    if problem.recorded and method.inertial:
        if problem.inertia.mass <= 0.0:
            why = "nothing has mass: set it, or give bearing.bore and bearing.width so that the inner ring has its own"
            faults.append(Mistake("rotor.mass", problem.rotor.mass, why))
        if problem.supports.tilt != "locked" and problem.inertia.transverse <= 0.0:
            why = "free tilts need an inertia: set it, or give bearing.bore and bearing.width"
            faults.append(Mistake("rotor.transverse_inertia", problem.rotor.transverse_inertia, why))
    if faults:
        raise SceneError(faults)


def _refuse_renewed(problem: Problem, refuse: _Refuse) -> None:
    """Laws that follow the running speed, where nothing turns or bodies do not renew them."""
    contact = problem.contact
    if not renews(contact.law):
        return
    why = (
        "needs the speed at which its contacts run, and nothing turns: give excitation.speed_rpm or kinematics.spin_speed_rpm, or take "
        "kind = 'hertz', the dry law"
    )
    refuse(problem.spin_speed == 0.0, "contact.kind", contact.kind, why)
    if contact.discretisation in contact.law.discretisations:
        why = "follows the running speed, which contact resultants on rigid or condensed bodies do: take those, or kind = 'hertz'"
        refuse(not problem.traits.renews, "contact.kind", contact.kind, why)


def _refuse_time_constant(problem: Problem, refuse: _Refuse) -> None:
    """Damping in proportion to the stiffness, where bodies have none."""
    contact = problem.contact
    ways = {"damping": contact.damping if contact.in_a_band else None, "time_constant": contact.time_constant}
    ways["loss_factor"] = contact.loss_factor
    why = "is damping in proportion to a contact's stiffness, which contact resultants on rigid or condensed bodies have: take those, or contact.damping in N s/m"
    for key, value in ways.items():
        refuse(value is not None and not problem.traits.damps, f"contact.{key}", value, why)
    changing = problem.excitation is not None and problem.excitation.period_s is None
    why = "belongs to one frequency, and the excitation has none: give contact.time_constant"
    refuse(contact.loss_factor is not None and changing, "contact.loss_factor", contact.loss_factor, why)


def _refuse_different_rows(problem: Problem, refuse: _Refuse) -> None:
    """What holds one number for the balls of all rows."""
    if problem.bearing.equal_rows:
        return
    kinematics, rows = problem.kinematics, "the rows of this set are different bearings"
    why = f"{rows}, whose balls travel at different speeds: set it false"
    refuse(kinematics.orbiting, "kinematics.orbiting", True, why)
    why = f"{rows}: moments are computed for balls of one kind only. Set it 'none'"
    refuse(kinematics.gyroscopic != "none", "kinematics.gyroscopic", kinematics.gyroscopic, why)
    why = f"{rows}: friction is computed for balls of one kind only. Set it 0"
    refuse(problem.contact.friction > 0.0, "contact.friction", problem.contact.friction, why)
    why = f"{rows}: a speed that changes is followed by balls of one kind only. Give one with kinematics.spin_speed_rpm"
    refuse(problem.spin_changes, "excitation.kind", getattr(problem.excitation, "name", None), why)


def _slow(problem: Problem) -> tuple[str, str]:
    """The key, and its value, by which bodies have no compiled forces."""
    if problem.traits.every_node or problem.contact.discretisation == "resultant":
        return "bodies.kind", problem.bodies.name
    return "contact.discretisation", problem.contact.discretisation


def _refuse_driver(problem: Problem, refuse: _Refuse) -> None:
    """A method without the driver that the bodies ask for."""
    missing = missing_driver(problem.integrator.method.scheme, problem.traits.compiled)
    key, value = _slow(problem)
    why = (
        f"has no driver `{missing}`, which {key} = '{value}' needs: its forces are not compiled. Use 'newmark' or "
        "'quasi_static', or contact resultants on rigid or condensed bodies"
    )
    refuse(bool(missing), "integrator.kind", problem.integrator.kind, why)


def _refuse_identifier(problem: Problem, refuse: _Refuse) -> None:
    """Requirements of the identifier on the excitation."""
    needs, kind = problem.identifier.method.needs, problem.identifier.kind
    name, excitation = problem.excitation.name, problem.excitation
    changing = excitation.period_s is None and problem.sweeps
    why = f"needs one frequency, but excitation '{name}' changes its speed: use 'order_tracking'"
    refuse("period" in needs and changing, "identifier.kind", kind, why)
    why = f"needs the phase of the excitation, which '{name}' does not tell: use 'sine_fit'"
    fitted = getattr(problem.identifier.method, "harmonics", None)
    if fitted is not None and "record" in needs:
        samples = recorded_per_turn(problem.steps_per_turn, problem.turns)
        least = 2 * fitted + 2
        why = (
            f"{fitted} harmonics, mean and drift are {least} unknowns, but {samples} samples a turn are recorded: take at most "
            f"{max((samples - 2) // 2, 1)} harmonics, or steps_per_turn = {least} or more"
        )
        refuse(samples < least, "identifier.harmonics", fitted, why)
    why = f"needs the phase of the excitation, which '{name}' does not tell: use 'sine_fit'"
    refuse("phase" in needs and not has_phase(excitation), "identifier.kind", kind, why)
    why = f"runs several speeds, but excitation '{name}' has no key `speed_rpm` or changes its speed"
    several = "speeds" in needs
    unable = changing or speed_rpm(excitation) is None
    refuse(several and unable, "identifier.kind", kind, why)
    if several and not unable:
        for rpm in problem.identifier.method.speeds_rpm:
            why = f"runs several speeds, but excitation '{name}' does not repeat every turn at {rpm:g} r/min"
            bad = attrs.evolve(excitation, speed_rpm=float(rpm)).period_s is None
            refuse(bad, "identifier.kind", kind, why)
            if bad:
                break


def _refuse_steady(problem: Problem, refuse: _Refuse) -> None:
    """Scenes without a motion that repeats itself every turn and depends on the force alone."""
    kind, excitation = problem.integrator.kind, problem.excitation
    other = "use 'newmark'"
    why = f"needs a force that repeats every turn, which excitation '{excitation.name}' does not: {other}"
    refuse(excitation.period_s is None, "integrator.kind", kind, why)
    why = f"contact.friction: where a contact sticks depends on how the motion began, there is no single one: {other}"
    refuse(problem.contact.friction > 0.0, "integrator.kind", kind, why)
    why = f"contact law '{problem.contact.kind}' has a memory: its motion cannot be solved for by itself: {other}"
    refuse(problem.contact.law.state_size > 0, "integrator.kind", kind, why)
    alone = (
        excitation.sense != 0
        and not any(problem.load.radial)
        and not (any(problem.load.moment) and problem.supports.tilt != "locked")
    )
    why = (
        "kinematics.orbiting: balls pass at another frequency than the force, no motion repeats itself every turn unless the "
        f"force turns and no radial load acts: {other}"
    )
    refuse(problem.kinematics.orbiting and not alone, "integrator.kind", kind, why)


#: By unit or key the largest plausible size, and what is right: bearings of 2 m exist; rotors on ball bearings weigh tons at most.
_MOST = {
    "m": (1.0, " m", "lengths are in metres"),
    "rotor.mass": (1e4, " kg", "masses are in kilograms"),
    "contact.friction": (1.0, "", "steel on steel has about 0.1 with oil and 0.8 dry (Bowden and Tabor 1950)"),
}
#: Below this a Young's modulus [Pa] is reported: cages of soft plastics exist.
_YOUNG = 1e9
#: How far the estimate of the highest frequency may be off.
_ROUGH = 2.0
_TABLES = ("bearing", "rotor", "contact", "kinematics", "mesh", "supports", "mounting")


def implausible(problem: Problem) -> tuple[str, ...]:
    """A sentence for each value that is likely to be in another unit, and for each ring that is loose."""
    found = loose_rings(problem.scene)
    for table in _TABLES:
        for path, unit, value in _numbers(getattr(problem, table), table):
            most, symbol, right = _MOST.get(path) or _MOST.get(unit or "", (inf, "", ""))
            if abs(value) > most:
                found.append(f"`{path}` = {value:g}{symbol} is more than {most:g}{symbol}: {right}")
            if unit == "Pa" and value < _YOUNG:
                found.append(f"`{path}` = {value:g} Pa is less than {1e-9 * _YOUNG:g} GPa: steel has 2.1e11 Pa")
    return tuple(found)


def _numbers(table: attrs.AttrsInstance | None, path: str) -> Iterator[tuple[str, str | None, float]]:
    """Path, unit and value of every number in a table and the tables in it."""
    cls: type = type(table)
    for name, unit in _units(cls):
        value = getattr(table, name)
        if isinstance(value, float):
            yield f"{path}.{name}", unit, value
        elif attrs.has(type(value)):
            yield from _numbers(value, f"{path}.{name}")


@cache
def _units(cls: type) -> tuple[tuple[str, str | None], ...]:
    """Names of a table's keys, each with its unit; none of what is no table."""
    if not attrs.has(cls):
        return ()
    return tuple((field.name, field.metadata.get("unit")) for field in attrs.fields(cls))


def foreseen(problem: Problem) -> list[Mistake]:
    """Failures of a run that closed formulas foresee: for ``raceway check``."""
    found = []
    load, free = problem.load, problem.supports.axial != "displacement"
    moment = any(load.moment) and problem.supports.tilt != "locked"
    if free and not (load.axial or any(load.radial) or moment or problem.bearing.preloaded):
        found.append(Mistake("load.axial", load.axial, "nothing loads the bearing: there is no stiffness to find"))
    if not problem.recorded:
        return found
    window, turns = getattr(problem.identifier.method, "window_turns", None), problem.turns
    if window is not None and window > turns:
        why = f"is longer than the record of {turns} turns: shorten it, or integrate more turns"
        found.append(Mistake("identifier.window_turns", window, why))
    steps = problem.integrator.steps_per_turn
    if not problem.integrator.method.implicit and isinstance(steps, int) and not problem.traits.every_node:
        period = problem.period
        stable = problem.stable_step
        least = 0 if stable is None else int(period / stable)
        if steps * _ROUGH < least:
            why = f"is far above the stable step of an explicit method: some {least} steps a turn are needed, 'auto' takes enough"
            found.append(Mistake("integrator.steps_per_turn", steps, why))
    return found
