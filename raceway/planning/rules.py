"""Combinations that cannot run, each with the reason and the remedy, and values that are possible and unlikely."""

from collections.abc import Iterator
from functools import cache
from math import inf

import attrs

from raceway.core.columns import is_table
from raceway.core.time.schemes import missing_driver
from raceway.errors import Mistake, SceneError
from raceway.framework.contracts import said
from raceway.framework.duties import has_phase, renews, speed_rpm
from raceway.framework.rules import Rule, mistakes, speaking
from raceway.planning.resolve import GROWTH, MOMENTS, ROWS, Problem, recorded_per_turn
from raceway.scene.growth import LOOSE, SIZES
from raceway.scene.unused import unused


def _slow_key(p: Problem) -> str:
    """The key by which bodies have no compiled forces."""
    by_bodies = p.traits.every_node or p.contact.discretisation == "resultant"
    return "bodies.kind" if by_bodies else "contact.discretisation"


def _slow(p: Problem) -> str:
    """The same with its value."""
    key = _slow_key(p)
    return f"{key} = '{p.bodies.name if key == 'bodies.kind' else p.contact.discretisation}'"


def _has_law(p: Problem) -> bool:
    """Whether the law can stand for the contacts."""
    return p.contact.discretisation in p.contact.law.discretisations


def _changing(p: Problem) -> bool:
    """Whether the force runs through speeds without repeating."""
    return p.excitation.period_s is None and p.sweeps


def _runs_speeds(p: Problem) -> bool:
    """Whether motions at several speeds are asked for of a force that has one."""
    return p.several_speeds and speed_rpm(p.excitation) is not None and not _changing(p)


def _unsteady_speed(p: Problem) -> float | None:
    """The first of several speeds [r/min] at which the force does not repeat every turn."""
    speeds = p.identifier.method.speeds_rpm if _runs_speeds(p) else ()
    return next((rpm for rpm in speeds if attrs.evolve(p.excitation, speed_rpm=float(rpm)).period_s is None), None)


def _samples(p: Problem) -> int:
    return recorded_per_turn(p.steps_per_turn, p.turns)


def _unknowns(p: Problem) -> int:
    """Of a fit of harmonics, mean and drift to a turn; 0 where none is fitted."""
    harmonics = getattr(p.identifier.method, "harmonics", None)
    return 0 if harmonics is None or not p.recorded else 2 * harmonics + 2


def _inertial(p: Problem) -> bool:
    return p.recorded and p.integrator.method.inertial


_DAMPS = "is damping proportional to the contact stiffness, which contact resultants on rigid or condensed bodies support: use those, or contact.damping in N s/m"

#: What no bodies, or no other part, can compute, before the growth of grooves is looked at.
_CONTACTS: tuple[Rule[Problem], ...] = (
    Rule(
        "contact.discretisation", lambda p: not _has_law(p),
        lambda p: f"law '{p.contact.kind}' supports {' or '.join(repr(d) for d in sorted(p.contact.law.discretisations))}",
    ),
    Rule(
        "contact.kind", lambda p: renews(p.contact.law) and p.spin_speed == 0.0,
        "needs the running speed of its contacts: set excitation.speed_rpm or kinematics.spin_speed_rpm, or use kind = 'hertz', the dry law",
    ),
    Rule(
        "contact.kind", lambda p: renews(p.contact.law) and _has_law(p) and not p.traits.renews,
        "depends on the running speed, which contact resultants on rigid or condensed bodies support: use those, or kind = 'hertz'",
    ),
    Rule("contact.damping", lambda p: p.contact.in_a_band and not p.traits.damps, _DAMPS),
    Rule("contact.time_constant", lambda p: p.contact.time_constant is not None and not p.traits.damps, _DAMPS),
    Rule("contact.loss_factor", lambda p: p.contact.loss_factor is not None and not p.traits.damps, _DAMPS),
    Rule(
        "contact.loss_factor",
        lambda p: p.contact.loss_factor is not None and p.excitation is not None and p.excitation.period_s is None,
        "needs an excitation of one frequency: set contact.time_constant",
    ),
    *GROWTH,
    *MOMENTS,
    Rule("kinematics.orbiting", lambda p: p.kinematics.orbiting and p.spin_speed == 0.0, "needs kinematics.spin_speed_rpm"),
    *(
        Rule(
            key, lambda p, key=key: p.spin_changes and not p.traits.compiled and _slow_key(p) == key,  # type: ignore[misc]
            lambda p: f"has no terms that follow the changing speed of '{p.excitation.name}', which contact resultants on rigid or "
            "condensed bodies have; use those, or give one speed to balls, ring and rotor with kinematics.spin_speed_rpm",
        )
        for key in ("bodies.kind", "contact.discretisation")
    ),
    Rule(
        "kinematics.ball_growth", lambda p: p.kinematics.ball_growth and p.spin_changes,
        "does not support a changing speed: set it false, or fix the speed by kinematics.spin_speed_rpm",
    ),
)  # fmt: skip

_HEAT: tuple[Rule[Problem], ...] = (
    Rule(
        "heat", lambda p: p.heat is not None and p.lubricant is None, "needs the oil's viscosity: give a table [lubricant]",
    ),
    Rule("heat", lambda p: p.heat is not None and p.traits.line_contacts, "friction of rollers, its source, is not computed: delete it"),
    *(
        Rule(
            f"mounting.{node}_temperature",
            lambda p, node=node: p.heat is not None and getattr(p.scene.mounting, f"{node}_temperature"),  # type: ignore[misc]
            "is computed by the table [heat]: delete one of them",
        )
        for node in ("inner", "outer", "ball")
    ),
    *(
        Rule(
            f"heat.{key}",
            lambda p, key=key, sizes=sizes: p.heat is not None and getattr(p.heat, key) == "auto"  # type: ignore[misc]
            and any(getattr(row, size) is None for row in p.bearing.of_rows for size in sizes),
            f"is 'auto': set a number, or the bearing's {' and '.join(f'`{size}`' for size in sizes)}, from which it follows",
        )
        for keys, sizes in (
            (("inner_oil", "outer_oil"), ("width",)),
            (("inner_shaft",), ("bore", "width")),
            (("outer_housing",), ("outer_diameter", "width")),
            (("shaft_ambient", "housing_ambient"), ("bore", "outer_diameter", "width")),
        )
        for key in keys
    ),
)  # fmt: skip

_MOTION: tuple[Rule[Problem], ...] = (
    Rule(
        "integrator.least_step", lambda p: not p.traits.every_node and getattr(p.integrator.method, "least_step", None) is not None,
        "adds mass to the finite elements of bodies.kind = 'elastic': use those, or leave it out",
    ),
    Rule(
        "kinematics.orbiting", lambda p: not p.bearing.equal_rows and p.kinematics.orbiting,
        f"{ROWS}, whose balls travel at different speeds: set it false",
    ),
    Rule(
        "contact.friction", lambda p: not p.bearing.equal_rows and p.contact.friction > 0.0,
        f"{ROWS}: friction is computed for balls of one kind only. Set it 0",
    ),
    Rule(
        "excitation.kind", lambda p: not p.bearing.equal_rows and p.spin_changes,
        f"{ROWS}: a changing speed is supported for balls of one kind only. Fix it by kinematics.spin_speed_rpm",
    ),
    Rule(
        "excitation", lambda p: p.excitation is not None and p.excitation.amplitude_n == 0.0,
        "the force is zero: delete the table for a static scene",
    ),
    Rule(
        "identifier.kind", lambda p: p.excitation is not None and "period" in p.identifier.method.needs and _changing(p),
        lambda p: f"needs one frequency, but excitation '{p.excitation.name}' changes its speed: use 'order_tracking'",
    ),
    Rule(
        "identifier.harmonics", lambda p: _unknowns(p) and _samples(p) < _unknowns(p),
        lambda p: f"{p.identifier.method.harmonics} harmonics, mean and drift are {_unknowns(p)} unknowns, but {_samples(p)} samples "
        f"a turn are recorded: use at most {max((_samples(p) - 2) // 2, 1)} harmonics, or steps_per_turn = {_unknowns(p)} or more",
    ),
    Rule(
        "identifier.kind",
        lambda p: p.excitation is not None and "phase" in p.identifier.method.needs and not has_phase(p.excitation),
        lambda p: f"needs the phase of the excitation, which '{p.excitation.name}' does not define: use 'sine_fit'",
    ),
    Rule(
        "identifier.kind", lambda p: p.several_speeds and not _runs_speeds(p),
        lambda p: f"runs several speeds, but excitation '{p.excitation.name}' has no key `speed_rpm` or changes its speed",
    ),
    Rule(
        "identifier.kind", lambda p: _unsteady_speed(p) is not None,
        lambda p: f"runs several speeds, but excitation '{p.excitation.name}' does not repeat every turn at {_unsteady_speed(p):g} r/min",
    ),
    Rule(
        "integrator.kind", lambda p: p.recorded and missing_driver(p.integrator.method.scheme, p.traits.compiled),
        lambda p: f"has no driver `{missing_driver(p.integrator.method.scheme, p.traits.compiled)}`, which {_slow(p)} needs: its "
        "forces are not compiled. Use 'newmark' or 'quasi_static', or contact resultants on rigid or condensed bodies",
    ),
    Rule(
        "integrator.device", lambda p: p.recorded and said(p.integrator.method, "device") == "gpu" and not p.traits.every_node,
        "is for bodies.kind = 'elastic', whose every node moves: use 'cpu', or 'auto' for scenes of both",
    ),
    Rule(
        "integrator.kind", lambda p: p.recorded and p.integrator.method.steady and p.unsteady,
        lambda p: f"{p.unsteady}: use 'newmark'",
    ),
    Rule(
        "rotor.mass", lambda p: _inertial(p) and p.inertia.mass <= 0.0,
        "the moving mass is 0: set it, or bearing.bore and bearing.width, which give the inner ring a mass",
    ),
    Rule(
        "rotor.transverse_inertia", lambda p: _inertial(p) and p.tilts and p.inertia.transverse <= 0.0,
        "free tilts need an inertia: set it, or give bearing.bore and bearing.width",
    ),
)  # fmt: skip


def refuse_what_cannot_run(problem: Problem) -> None:
    """Raise ``SceneError`` with everything that this version, or this combination, cannot do."""
    try:
        growth = mistakes(SIZES, problem.running)
    except SceneError as error:  # a body that lacks its thermal expansion
        growth = error.mistakes
    faults = [
        *problem.body_kind.faults(), *mistakes(_CONTACTS, problem), *mistakes(_HEAT, problem), *growth, *mistakes(_MOTION, problem),
    ]  # fmt: skip
    if faults:
        raise SceneError(faults)


#: How far the estimate of the highest frequency may be off.
_ROUGH = 2.0


def _least_steps(p: Problem) -> int:
    """Steps a turn that an explicit method needs where their number is given; 0 where nothing is known of it."""
    with_given_steps = p.recorded and not p.integrator.method.implicit and isinstance(p.integrator.steps_per_turn, int)
    stable = p.stable_step if with_given_steps and not p.traits.every_node else None
    return 0 if stable is None else int(p.period / stable)


#: Failures of a run that closed formulas foresee.
_FORESEEN: tuple[Rule[Problem], ...] = (
    Rule(
        "load.axial", lambda p: p.supports.axial != "displacement" and not (
            p.load.axial or any(p.load.radial) or (any(p.load.moment) and p.tilts) or p.bearing.preloaded
        ), "no load acts: the stiffness is undefined",
    ),
    Rule(
        "identifier.window_turns",
        lambda p: p.recorded and (getattr(p.identifier.method, "window_turns", None) or 0) > p.turns,
        lambda p: f"is longer than the record of {p.turns} turns: shorten it, or integrate more turns",
    ),
    Rule(
        "integrator.steps_per_turn", lambda p: (least := _least_steps(p)) and p.steps_per_turn * _ROUGH < least,
        lambda p: f"is far above the stable step of an explicit method: some {_least_steps(p)} steps per turn are needed, which 'auto' chooses",
    ),
)  # fmt: skip


def foreseen(problem: Problem) -> list[Mistake]:
    """Failures of a run that closed formulas foresee: for ``raceway check``."""
    return mistakes(_FORESEEN, problem)


#: By unit or key the largest plausible size, and what is right: bearings of 2 m exist; rotors on ball bearings weigh tons at most.
_MOST = {
    "m": (1.0, " m", "lengths are in metres"),
    "rotor.mass": (1e4, " kg", "masses are in kilograms"),
    "contact.friction": (1.0, "", "steel on steel has about 0.1 with oil and 0.8 dry (Bowden and Tabor 1950)"),
}
#: Below this a Young's modulus [Pa] is reported: cages of soft plastics exist.
_YOUNG = 1e9
_TABLES = ("bearing", "rotor", "contact", "kinematics", "mesh", "supports", "mounting")


def scene_warnings(problem: Problem) -> tuple[str, ...]:
    """A sentence for each ring that is loose, each value that is likely to be in another unit, and each key without effect."""
    sentences = [words for _, words in speaking(LOOSE, problem.running)]
    for table in _TABLES:
        for path, unit, value in _table_numbers(getattr(problem, table), table):
            most, symbol, right = _MOST.get(path) or _MOST.get(unit or "", (inf, "", ""))
            if abs(value) > most:
                sentences.append(f"`{path}` = {value:g}{symbol} is more than {most:g}{symbol}: {right}")
            if unit == "Pa" and value < _YOUNG:
                sentences.append(f"`{path}` = {value:g} Pa is less than {1e-9 * _YOUNG:g} GPa: steel has 2.1e11 Pa")
    return (*sentences, *unused(problem.scene))


def _table_numbers(table: attrs.AttrsInstance | None, path: str) -> Iterator[tuple[str, str | None, float]]:
    """Path, unit and value of every number in a table and the tables in it."""
    cls: type = type(table)
    for name, unit in _units(cls):
        value = getattr(table, name)
        if isinstance(value, float):
            yield f"{path}.{name}", unit, value
        elif is_table(type(value)):
            yield from _table_numbers(value, f"{path}.{name}")


@cache
def _units(cls: type) -> tuple[tuple[str, str | None], ...]:
    """Names of a table's keys, each with its unit; none of what is no table."""
    if not attrs.has(cls):
        return ()
    return tuple((field.name, field.metadata.get("unit")) for field in attrs.fields(cls))
