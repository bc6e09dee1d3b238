"""Series of equilibria: the error that a result states against its true error.

The true value is a series of 4999 a turn, whose harmonics beyond the samples are below 1e-8.
"""

from typing import Any

from checks.validation.scenes import rotating
from raceway import scene_from_dict
from raceway.testing import run

_TRUE_STEPS = 4999

#: Axial load [N], amplitude of the force [N], its kind, tilt, radial load [N].
SERIES: tuple[tuple[float, float, str, str, tuple[float, float]], ...] = (
    (100.0, 2000.0, "unidirectional", "locked", (0.0, 0.0)), (100.0, 2000.0, "unidirectional", "free", (0.0, 0.0)),
    (400.0, 700.0, "bidirectional", "locked", (0.0, 0.0)), (200.0, 1500.0, "bidirectional", "free", (0.0, 0.0)),
    (1000.0, 1000.0, "unidirectional", "free", (0.0, 0.0)), (50.0, 800.0, "bidirectional", "locked", (0.0, 0.0)),
    (100.0, 1000.0, "unidirectional", "locked", (50.0, 80.0)), (150.0, 900.0, "bidirectional", "free", (100.0, 30.0)),
)  # fmt: skip


def series(axial: float, force: float, kind: str, tilt: str, radial: tuple[float, float], steps: int) -> dict[str, Any]:
    """A constant force in a series of equilibria."""
    tables = rotating(axial, tilt, 12000.0, True, "quasi_static")
    return {
        **tables,
        "load": {"axial": axial, "radial": list(radial)},
        "excitation": {"kind": kind, "speed_rpm": 12000.0, "amplitude": "constant", "force": force},
        "integrator": {"kind": "quasi_static", "steps_per_turn": steps},
    }


def series_errors(place: int, steps: int) -> tuple[float, float]:
    """Estimated and true relative error of a series of ``SERIES``."""
    found, true = (run(scene_from_dict(series(*SERIES[place], count))) for count in (steps, _TRUE_STEPS))
    wanted = true.identification.dynamic_stiffness
    return found.error["total"], abs(found.identification.dynamic_stiffness - wanted) / abs(wanted)
