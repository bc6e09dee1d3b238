"""The thermal network of a bearing at solved points.

The heat of a contact goes to both of its bodies in halves, drag of the balls to the oil, that of seals to both rings in halves.  Conductances
that are 'auto' in the table [heat] follow from ``raceway.core.thermal``: contacts at the mean load and angle of the loaded balls of each
row, with the piezoviscous-elastic film of Hamrock and Dowson between them; convection with the viscosity of the contacts' inlets; joints and
emission from the sizes of the rings.  Oil reaches the inner ring against the centrifugal field only where it passes between the balls: of
its surface the share of the gaps, 1 - Z D / (pi d_m), is wetted, an estimate from geometry.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from raceway.core.columns import Number
from raceway.core.contact.film import film, thermal_reduction
from raceway.core.contact.hertz import contact_modulus
from raceway.core.thermal import JOINT, Network, oil_convection, rolling_contact, seat_emission
from raceway.framework.contracts import SolvedPoints
from raceway.scene.bearing import Bearing


def thermal_network(
    points: SolvedPoints, traction: Number = 1.0, conductance: Number = 1.0, inner_oil: Number = 1.0
) -> Network:
    """The network of n points, temperatures in degrees Celsius.

    traction, conductance : factors of the heat of friction and of conductances by correlations, numbers or columns (n,)
    inner_oil : of the conductance by correlation from the inner rings to the oil, instead of ``conductance``
    """
    heat = points.problem.heat
    assert heat is not None, "rules refuse scenes without it"
    lost = points.problem.quantities.friction.losses(points)
    inner, outer = lost.contact_power.sum(axis=2).T
    heats = np.zeros((len(points.load), 6))  # inner rings, balls, outer rings, shaft, housing, oil
    heats[:, 0] = 0.5 * (inner + lost.seal_power)
    heats[:, 1] = 0.5 * (inner + outer)
    heats[:, 2] = 0.5 * (outer + lost.seal_power)
    heats[:, 5] = lost.drag_power
    heats *= np.reshape(traction, (-1, 1))
    return Network(_conductances(points, conductance, inner_oil), heats, heat.oil_inlet_c, heat.ambient_c)


def _conductances(points: SolvedPoints, factor: Number, inner: Number) -> dict[str, Number]:
    """Of all links [W/K]: those of [heat], else by correlations times a factor, summed over rows."""
    heat, oil, rows = points.problem.heat, points.problem.lubricant, points.problem.bearing.of_rows
    assert heat is not None and oil is not None, "rules refuse scenes without them"
    capacity = oil.density * heat.oil_heat_capacity

    def convection(b: Bearing, area: Number) -> Number:
        ratio = b.ball_diameter * np.cos(b.contact_angle) / b.pitch_diameter
        fluid = oil.kinematic_viscosity, oil.conductivity, capacity
        return np.pi * area * oil_convection(points.speed, ratio, *fluid, b.ball_diameter)

    def wetted(b: Bearing) -> Number:
        gaps = 1.0 - b.ball_count * b.ball_diameter / (np.pi * b.pitch_diameter)
        return gaps if isinstance(heat.inner_wetting, str) else heat.inner_wetting

    by_row: dict[str, Callable[[int, Any], Number]] = {
        "inner_balls": lambda k, b: _contact_conductance(points, k, 0),
        "outer_balls": lambda k, b: _contact_conductance(points, k, 1),
        "inner_oil": lambda k, b: wetted(b) * convection(b, (b.pitch_diameter - b.ball_diameter) * b.width),
        "outer_oil": lambda k, b: convection(b, (b.pitch_diameter + b.ball_diameter) * b.width),
        "balls_oil": lambda k, b: convection(b, b.ball_diameter**2 * b.ball_count),
        "inner_shaft": lambda k, b: JOINT * np.pi * b.bore * b.width,
        "outer_housing": lambda k, b: JOINT * np.pi * b.outer_diameter * b.width,
        "shaft_ambient": lambda k, b: seat_emission(b.bore, b.bore + b.outer_diameter, b.width),
        "housing_ambient": lambda k, b: seat_emission(b.outer_diameter, b.bore + b.outer_diameter, b.width),
    }
    conductances: dict[str, Number] = {"throughput": capacity * _number(heat.oil_flow)}
    for name, of_row in by_row.items():
        value = getattr(heat, name)
        auto = isinstance(value, str) and value == "auto"
        share = inner if name == "inner_oil" else factor
        conductances[name] = share * sum(map(of_row, range(len(rows)), rows)) if auto else _number(value)
    return conductances


def _number(value: Number) -> Number:
    """What a key of [heat] says; it has one word, 'infinite'."""
    return float("inf") if isinstance(value, str) else value


def _contact_conductance(points: SolvedPoints, row: int, race: int) -> np.ndarray:
    """(n,) between the balls and a race of one row [W/K]: of as many equal contacts as are loaded."""
    b, oil, of_row = points.problem.bearing.of_rows[row], points.problem.lubricant, points.row == row
    assert oil is not None, "rules refuse scenes without it"
    load = points.load[:, race, of_row]
    loaded = load > 0.0
    count = loaded.sum(axis=1)

    def mean(values: np.ndarray) -> np.ndarray:
        total: np.ndarray = np.where(loaded, values, 0.0).sum(axis=1)
        return total / np.maximum(count, 1)

    major, minor = (mean(axis[:, race, of_row]) for axis in points.semi_axes)
    ratio = b.ball_diameter / b.pitch_diameter * mean(np.cos(points.contact_angle[:, race, of_row]))
    speed = 0.25 * points.speed * b.pitch_diameter * (1.0 - ratio**2)
    conformity, one = (b.conformity_inner, b.conformity_outer)[race], np.ones_like(ratio)
    along = 0.5 * b.ball_diameter * (1.0 + (-1.0, 1.0)[race] * ratio)
    across = conformity * b.ball_diameter / (2.0 * conformity - 1.0) * one
    modulus = 2.0 * contact_modulus(b.rings.young, b.rings.poisson, b.balls.young, b.balls.poisson) * one
    ellipticity = np.where(count > 0, major, 1.0) / np.where(count > 0, minor, 1.0)
    viscosity, carried = oil.dynamic_viscosity, np.maximum(mean(load), 1e-3)
    apart = film(viscosity * speed, oil.alpha, modulus, along, across, carried, ellipticity).central
    apart = apart * thermal_reduction(viscosity * oil.beta * speed**2 / oil.conductivity)
    return np.asarray(count * rolling_contact(major, minor, speed, apart, oil.conductivity))
