"""Temperatures of a bearing at solved points, by its thermal network.

A scene with [heat] is solved where the temperatures that it is computed with are those that follow from it (``raceway.pipeline.warm``).

The heat of a contact goes to both of its bodies in halves, drag of the balls to the oil, that of seals to both rings in halves.  Conductances
that are 'auto' in the table [heat] follow from ``raceway.core.quantities.thermal``: contacts at the mean load and angle of the loaded balls of each
row, with the piezoviscous-elastic film of Hamrock and Dowson between them; convection with the viscosity of the contacts' inlets; joints and
emission from the sizes of the rings.  Oil reaches the inner ring against the centrifugal field only where it passes between the balls: of
its surface the share of the gaps, 1 - Z D / (pi d_m), is wetted, an estimate from geometry.
"""

from collections.abc import Callable, Mapping, Sequence
from math import isinf, isnan
from typing import Any, ClassVar

import attrs
import numpy as np

from raceway.answers.quantities import Quantity
from raceway.core.columns import Number
from raceway.core.contact.film import film, thermal_reduction
from raceway.core.contact.hertz import contact_modulus
from raceway.core.quantities.thermal import JOINT, Network, oil_convection, rolling_contact, seat_emission
from raceway.framework.contracts import Problem, SolvedPoints
from raceway.framework.shown import Fact, number
from raceway.scene.bearing import Bearing
from raceway.storage.tables import ReadTables, Tables

#: 0 degrees Celsius [K].
ZERO_C = 273.15
#: What is said of an oil of one viscosity.
NO_THINNING = (
    "lubricant.viscosity is one number: it does not fall with temperature, so heat and temperatures are overestimated. Set "
    "lubricant.oil, or viscosity_40 and viscosity_100"
)
#: Rows of ``heat.band`` that are shown as intervals alone: key, unit and what it is times the key's.
_BANDS = {"running preload": ("running_preload_n", "N", 1.0), "kxx": ("kxx_n_per_m", "N/µm", 1e-6),
          "kyy": ("kyy_n_per_m", "N/µm", 1e-6), "life L10r": ("l10r_hours", "h", 1.0)}  # fmt: skip
_NODES = {"inner": "the inner rings", "balls": "the balls", "outer": "the outer rings", "shaft": "the shaft",
          "housing": "the housing", "oil": "the oil in the bearing"}  # fmt: skip
_FLOWS = {"oil": "throughput", "shaft": "shaft_ambient", "housing": "housing_ambient"}


@attrs.frozen
class Temperatures:
    """Steady temperatures of rings, balls, shaft, housing and oil, from the table [heat]."""

    name: ClassVar[str] = "heat"
    numbers: ClassVar[tuple[Quantity, ...]] = (
        *(
            Quantity(f"temperature_{node}_k", "K", f"steady temperature of {words}", f"heat.temperatures_k.{node}", symbol=f"T_{node}")
            for node, words in _NODES.items()
        ),
        *(
            Quantity(f"heat_to_{way}_w", "W", f"friction heat removed by the {way}", f"heat.flows_w.{way}")
            for way in _FLOWS
        ),
        Quantity("heat_w", "W", "of friction in contacts, oil and seals", "heat.heat_w"),
    )  # fmt: skip

    @staticmethod
    def example_scene() -> Tables:
        heat = {"oil_inlet_c": 40.0, "oil_flow": 1e-5}
        return {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}, "lubricant": {"oil": "VG 32"}, "heat": heat}

    def why_not(self, problem: Problem) -> str:
        return "" if problem.heat is not None else "temperatures need a table [heat]"

    def compute(self, points: SolvedPoints) -> Mapping[str, np.ndarray]:
        network = _network(points)
        level, flows = network.temperatures + ZERO_C, network.flows
        return {
            **{f"temperature_{node}_k": level[:, k] for k, node in enumerate(_NODES)},
            **{f"heat_to_{way}_w": flows[link] for way, link in _FLOWS.items()},
            "heat_w": network.heats.sum(axis=1),
        }

    def table(self, points: SolvedPoints, values: Mapping[str, np.ndarray]) -> Tables:
        """``temperatures_k``, ``flows_w`` (also along each link of the network, null where it is infinite) and ``heat_w``."""
        import numpy as np

        network = _network(points)
        numbers = {name: float(value[0]) for name, value in values.items()}
        conductances = {name: float(np.reshape(value, -1)[0]) for name, value in network.conductances.items()}
        return {
            "temperatures_k": {node: numbers[f"temperature_{node}_k"] for node in _NODES},
            "flows_w": {way: numbers[f"heat_to_{way}_w"] for way in _FLOWS},
            "heat_w": numbers["heat_w"],
            "links_w": {name: None if isnan(flow[0]) else float(flow[0]) for name, flow in network.flows.items()},
            "conductances_w_per_k": {name: None if isinf(value) else value for name, value in conductances.items()},
        }

    def warnings(self, points: SolvedPoints, values: Mapping[str, np.ndarray]) -> list[str]:
        """Where the oil does not thin, or is beyond the temperatures of its viscosity."""
        oil = points.problem.lubricant
        if oil is not None and not oil.thins:
            return [NO_THINNING]
        return [] if oil is None or oil.temperature_c is None else list(filter(None, [beyond_oil(oil.temperature_c)]))

    @staticmethod
    def rows(table: ReadTables) -> list[Fact]:
        """Temperatures, heat and running preload, with their bands."""
        band = table.get("band", {})
        rows: list[Fact] = [("Temperatures", "", "steady; within the bands of friction and conductances")]
        levels = {node: kelvin and kelvin - ZERO_C for node, kelvin in table["temperatures_k"].items()}
        rings, others = (
            ", ".join(number(levels.get(name), "", 3) for name in names) for names in (("inner", "outer"), ("balls", "oil"))
        )
        rows.append(("inner, outer ring", f"{rings} °C", f"balls, oil {others} °C"))
        for node, celsius in levels.items():
            within = _within(band.get("temperatures_k", {}).get(node), ZERO_C, "°C")
            if node in ("shaft", "housing"):
                rows.append((node, number(celsius, "°C", 4), within))
            elif within:
                rows.append((f"{node} within", *within.partition(": ")[::2]))
        ways = ", ".join(f"{number(value, 'W', 3)} by the {way}" for way, value in table["flows_w"].items())
        within = "; ".join(filter(None, (_within(band.get("heat_w"), 0.0, "W"), ways)))
        rows.append(("heat", number(table["heat_w"], "W", 4), within))
        for label, (name, unit, factor) in _BANDS.items():
            if name in band:
                ends = [None if end is None else factor * end for end in band[name]]
                value, _, remark = _within(ends, 0.0, unit).partition(": ")
                rows.append((label, value, remark or "within the bands"))
        if why := band.get("not_computed"):
            rows.append(("K, C, torque", "no band", f"of the heat: {why}"))
        return rows


def _network(points: SolvedPoints) -> Network:
    network: Network = points.once("network", lambda: thermal_network(points))
    return network


def beyond_oil(temperature_c: float) -> str:
    """Warning of an oil beyond the temperatures that its viscosity is known at; empty within them."""
    from raceway.scene.lubricant import COLDEST, HOTTEST

    if COLDEST <= temperature_c <= HOTTEST:
        return ""
    cold = "Oil or surroundings are too cold (heat.oil_inlet_c, heat.ambient_c)"
    return (
        f"the oil in the contacts is at {temperature_c:.4g} °C: its viscosity is known from {COLDEST:g} to {HOTTEST:g} °C and is continued "
        f"along Walther's line. {'Give more oil (heat.oil_flow)' if temperature_c > HOTTEST else cold}"
    )


def _within(ends: Sequence[Any] | None, less: float, unit: str) -> str:
    if ends is None:
        return ""
    if None in ends:
        pairs = zip(ends, ("more", "less"), strict=True)
        known = [f"{end - less:.4g} {unit} or {word}: " for end, word in pairs if end is not None]
        return f"{''.join(known)}no steady temperature at one end of the bands"
    return f"{ends[0] - less:.4g} to {ends[1] - less:.4g} {unit}"


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
