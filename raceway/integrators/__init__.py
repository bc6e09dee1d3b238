"""Built-in integrators.

methods  Newmark's method, generalised-alpha, central differences, series of equilibria, steady orbits
"""

from raceway.framework.hookspecs import hookimpl


@hookimpl
def raceway_integrators() -> dict[str, str]:
    return {
        "newmark": "raceway.integrators.methods:Newmark",
        "generalized_alpha": "raceway.integrators.methods:GeneralizedAlpha",
        "central_difference": "raceway.integrators.methods:CentralDifference",
        "quasi_static": "raceway.integrators.methods:QuasiStatic",
        "periodic": "raceway.integrators.methods:Periodic",
    }
