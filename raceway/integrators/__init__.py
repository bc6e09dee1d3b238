"""Built-in integrators, one a file."""

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
