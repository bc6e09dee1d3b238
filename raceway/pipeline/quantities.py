"""Quantities of plug-ins at one solved point: their numbers, tables of result.json and warnings."""

from collections.abc import Iterable
from functools import partial

import attrs
import numpy as np

from raceway.bodies.model import Equilibrium, Model
from raceway.core.record import Record
from raceway.framework.contracts import ContactPairs, SolvedPoints
from raceway.framework.duties import fitting_quantities, missing_quantities, quantities_at, quantity_report
from raceway.planning.resolve import Problem
from raceway.storage.tables import Tables


@attrs.frozen(eq=False)
class StatedQuantities:
    """What plug-ins of quantities state of a result.

    values : name -> number, or array over the quantity's dimensions;  tables : plug-in -> what result.json has;  warnings : sentences
    missing : plug-in -> what the problem lacks for it
    """

    values: dict[str, float | np.ndarray]
    tables: dict[str, Tables]
    warnings: tuple[str, ...]
    missing: dict[str, str]


def stated_quantities(model: Model, equilibrium: Equilibrium, record: Record | None) -> StatedQuantities:
    """Of every plug-in whose numbers the problem has.

    PluginError: A plug-in that breaks a duty.
    """
    points, tables, warnings = solved_point(model, equilibrium, record), dict[str, Tables](), list[str]()
    values: dict[str, float | np.ndarray] = {}
    why_not = missing_quantities(model.problem)
    for plugin in (getattr(model.problem.quantities, name) for name, why in why_not.items() if not why):
        numbers = quantities_at(plugin, points)
        tables[plugin.name], sentences = quantity_report(plugin, points, numbers)
        warnings += sentences
        values |= {name: value[0] if value.ndim > 1 else float(value[0]) for name, value in numbers.items()}
    missing = {name: why for name, why in why_not.items() if why}
    given = model.scene.source.get("quantities", {})
    warnings += [f"[quantities.{name}] has no effect: {why}" for name, why in missing.items() if given.get(name)]
    return StatedQuantities(values, tables, tuple(warnings), missing)


def plugins_stating(problem: Problem, number: str) -> list[str]:
    """Names of the plug-ins of quantities that a problem has and that state a number."""
    return [one.name for one in fitting_quantities(problem) if number in {each.name for each in one.numbers}]


def stated_numbers(points: SolvedPoints, names: Iterable[str]) -> dict[str, np.ndarray]:
    """(n,) by name of plug-ins by their names; arrays are left out."""
    numbers: dict[str, np.ndarray] = {}
    for plugin in (getattr(points.problem.quantities, name) for name in names):
        computed = quantities_at(plugin, points)
        numbers |= {number.name: computed[number.name] for number in plugin.numbers if not number.dims}
    return numbers


def solved_point(model: Model, equilibrium: Equilibrium, record: Record | None) -> SolvedPoints:
    """One point as quantities see it; ``record`` : of the motion, in the turns that are used."""
    problem, z = model.problem, model.system.ball_count
    angles = equilibrium.angle_inner, equilibrium.angle_outer

    def ellipse(load: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        races = (model.bearing.contact_ellipse(model, race, load[0, race]) for race in (0, 1))
        pressure, major, minor = (np.stack(pair)[np.newaxis] for pair in zip(*races, strict=True))
        return pressure, major, minor

    def running() -> ContactPairs:
        from raceway.bodies.running import running_pairs

        return running_pairs(problem, model.basis, equilibrium.contact_force, angles)

    repeats = record is not None and problem.excitation is not None and problem.excitation.period_s is not None
    return SolvedPoints(
        problem=problem,
        row=model.basis.row,
        side=np.array([side for side, _ in problem.bearing.rows])[model.basis.row],
        speed=np.array([problem.spin_speed]),
        load=equilibrium.contact_force.reshape(1, 2, z),
        contact_angles=lambda: np.stack(angles)[np.newaxis],
        displacement=equilibrium.displacement[np.newaxis],
        stiffness=equilibrium.stiffness[np.newaxis],
        running_contacts=running,
        ellipse=ellipse,
        turn=partial(_turn, record, problem.period) if repeats and record is not None else None,
    )


def _turn(record: Record, period: float, count: int) -> np.ndarray:
    """(1, T, 2, Z) contact forces over the last turn, between its samples along straight lines."""
    last = record.time > record.time[-1] - period * (1.0 - 1e-9)
    times, forces = period * np.arange(count) / count, record.contact_force[last]
    columns = [np.interp(times, record.time[last], column, period=period) for column in forces.T]
    return np.stack(columns, axis=1).reshape(1, count, 2, -1)
