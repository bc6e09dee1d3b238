"""Built-in integrators, one a file.

newmark              Newmark's method
generalized_alpha    generalised-alpha
central_difference   explicit central differences
quasi_static         the orbit as a series of equilibria
periodic             the steady orbit, solved for directly
"""

from __future__ import annotations

from raceway.framework.hookspecs import hookimpl
from raceway.integrators.central_difference import CentralDifference
from raceway.integrators.generalized_alpha import GeneralizedAlpha
from raceway.integrators.newmark import Newmark
from raceway.integrators.periodic import Periodic
from raceway.integrators.quasi_static import QuasiStatic


@hookimpl
def raceway_integrators() -> list[type]:
    return [Newmark, GeneralizedAlpha, CentralDifference, QuasiStatic, Periodic]
