"""Where the heat of friction goes: conductances and heats of a bearing's thermal network, and its temperatures.

Notes
-----
The heat of a contact goes to both of its bodies in halves, drag of the balls to the oil, that of seals to both rings in halves.  Conductances
that the table [heat] leaves out follow from ``raceway.core.thermal``: contacts at the mean load and angle of the loaded balls of each
row, with the film of Hamrock and Dowson between them where it is piezoviscous and elastic; convection at the temperature of the oil;
joints and emission from the sizes of the rings.  A scene with [heat] is solved for where the temperatures it is computed with are
those that follow (``raceway.pipeline.warm``).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

import attrs

from raceway.core.columns import is_column
from raceway.out.quantities import Quantity

if TYPE_CHECKING:
    import numpy as np

    from raceway.framework.contracts import SolvedPoints
    from raceway.planning.resolve import Problem
    from raceway.storage.tables import Tables

#: 0 degrees Celsius [K].
ZERO_C = 273.15
_NAMES = ("inner", "balls", "outer", "shaft", "housing", "oil")
_WORDS = {"inner": "the inner rings", "balls": "the balls", "outer": "the outer rings", "oil": "the oil in the bearing"}
_NUMBERS = (
    *(
        Quantity(f"temperature_{node}", "K", f"steady temperature of {_WORDS.get(node, 'the ' + node)}",
                 f"heat.temperatures_k.{node}", symbol=f"T_{node}", label=f"temperature, {node}")
        for node in _NAMES
    ),
    Quantity("heat_w", "W", "heat of friction in contacts, oil and seals", "heat.heat_w", symbol="P", label="heat"),
    Quantity("heat_to_oil", "W", "heat that the oil carries off", "heat.flows_w.oil", label="heat to the oil"),
    Quantity("heat_to_shaft", "W", "heat that the shaft gives to the ambient", "heat.flows_w.shaft", label="heat to the shaft"),
    Quantity("heat_to_housing", "W", "heat that the housing gives to the ambient", "heat.flows_w.housing",
             label="heat to the housing"),
)  # fmt: skip


@attrs.frozen
class Temperatures:
    """Steady temperatures of rings, balls, shaft, housing and oil, from the table [heat]."""

    name: ClassVar[str] = "heat"
    numbers: ClassVar[tuple[Quantity, ...]] = _NUMBERS

    def why_not(self, problem: Problem) -> str:
        return "" if problem.heat is not None else "a table [heat] says what carries the heat off"

    def compute(self, points: SolvedPoints) -> Mapping[str, np.ndarray]:
        return numbers(points)
