"""Built-in integrators.

methods  Newmark's method, generalised-alpha, central differences, series of equilibria, steady orbits
"""

from __future__ import annotations

from raceway.framework.hookspecs import hookimpl
from raceway.integrators.methods import CentralDifference, GeneralizedAlpha, Newmark, Periodic, QuasiStatic


@hookimpl
def raceway_integrators() -> list[type]:
    return [Newmark, GeneralizedAlpha, CentralDifference, QuasiStatic, Periodic]
