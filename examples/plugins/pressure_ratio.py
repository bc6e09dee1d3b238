import attrs

from raceway import Quantity, hookimpl, option, positive


@attrs.frozen
class PressureRatio:
    """Largest contact pressure over a limit."""

    name = "pressure_ratio"
    numbers = (Quantity("largest_pressure_ratio", "1", "largest Hertz pressure over its limit", "pressure_ratio.largest"),)

    limit: float = option(2.0e9, unit="Pa", help="pressure that is compared with", rule=positive())

    def why_not(self, problem):
        return ""  # else the keys that a scene lacks for it

    def compute(self, points):
        return {"largest_pressure_ratio": points.peak_pressure.max(axis=(1, 2)) / self.limit}


@hookimpl
def raceway_quantities():
    return [PressureRatio]
