"""Temperatures of a bearing at solved points, by its thermal network.

A scene with [heat] is solved where the temperatures that it is computed with are those that follow from it (``raceway.pipeline.warm``).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isinf, isnan
from typing import TYPE_CHECKING, Any, ClassVar

import attrs

from raceway.answers.quantities import Quantity
from raceway.framework.contracts import Problem, SolvedPoints
from raceway.framework.shown import Fact, number
from raceway.storage.tables import ReadTables, Tables

if TYPE_CHECKING:
    import numpy as np

    from raceway.core.thermal import Network

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
    from raceway.plugins.quantities.thermal_network import thermal_network

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
    """Ends of a band in words."""
    if ends is None:
        return ""
    if None in ends:
        pairs = zip(ends, ("more", "less"), strict=True)
        known = [f"{end - less:.4g} {unit} or {word}: " for end, word in pairs if end is not None]
        return f"{''.join(known)}no steady temperature at one end of the bands"
    return f"{ends[0] - less:.4g} to {ends[1] - less:.4g} {unit}"
