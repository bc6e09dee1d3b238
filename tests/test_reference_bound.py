"""The bound of a precision study's reference, held against runs whose exact answer is known."""

from __future__ import annotations

from typing import Any

import attrs
import numpy as np
import pytest

from raceway.studies.precision.design import make_design
from raceway.studies.precision.reference import find_reference
from raceway.testing import b7206c, default_registry

EXACT = 2.3e8
MOVING = {"kind": "bidirectional", "speed_rpm": 12000.0, "amplitude": "constant", "force": 100.0}
#: A vibration of so many periods a turn; w^2 becomes (2 / dt tan(w dt / 2))^2 and (2 / dt sin(w dt / 2))^2.
ORDER = 60.0
ERRORS = {"newmark": (1.0 / 6.0, 17.0 / 720.0), "central_difference": (-1.0 / 12.0, 1.0 / 360.0)}


@attrs.frozen
class KnownErrors:
    """Stands for the runner: steps of x = w dt leave the errors c2 x^2 + c4 x^4 of theory."""

    registry: Any = attrs.field(factory=default_registry)

    def at(self, setting: Any, values: dict[str, Any]) -> dict[str, Any] | None:
        kind = values.get("integrator.kind", setting.scene.integrator.kind)
        if kind == "periodic":
            return None
        x = 2.0 * np.pi * ORDER / values["integrator.steps_per_turn"]
        second, fourth = ERRORS.get(kind, (0.0, 1e-4))
        z = EXACT * (1.0 + second * x**2 + fourth * x**4)
        return {"quantities": {"z_real": z, "z_imag": 0.0}, "own_error": None, "transient_error": 0.0}


def reference(kind: str, steps: int) -> Any:
    integrator = {"kind": kind, "turns": 4}
    tables = b7206c(excitation=MOVING, integrator=integrator)
    design = make_design(tables, [f"integrator.steps_per_turn={steps}"], 1e9, default_registry())
    return find_reference(list(design.settings), KnownErrors(), None)


@pytest.mark.parametrize("steps", [45, 90])
@pytest.mark.parametrize("kind", ["newmark", "quasi_static"])
def test_the_bound_holds_the_error_and_is_of_its_size(kind, steps):
    found = reference(kind, steps)
    true = abs(found.values["z_real"] / EXACT - 1.0)
    assert true <= found.bound
    # The bound is a change of the last refinement, or a distance of two methods: it has no reason to be far above the error.
    assert found.bound <= max(40.0 * true, 1e-9)
