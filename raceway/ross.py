"""Bearings under a rotor in ROSS, computed where ROSS asks for them.  Importing it imports ROSS, in raceway-rotor's extra ``ross``.

RollingBearing            a ``ross.BearingElement`` that computes K and C itself at (frequency, speed)
run_unbalance_response    ROSS's, with the stiffness that each bearing has at its own motion
UnbalanceResponse         what it returns
run_time_response         ROSS's, with the bearings' nonlinear forces

Examples
--------
>>> import ross
>>> from raceway.ross import RollingBearing, run_unbalance_response
>>> steel = ross.Material(name="steel", rho=7810.0, E=2.1e11, G_s=8.1e10)
>>> shaft = [ross.ShaftElement(L=0.05, idl=0.0, odl=0.03, material=steel) for _ in range(6)]
>>> disc = ross.DiskElement(n=3, m=3.0, Id=4.1e-3, Ip=8.05e-3)
>>> rotor = ross.Rotor(shaft, [disc], [RollingBearing("B7206C", 1000.0, n=0), RollingBearing("B7206C", -1000.0, n=6)])
>>> response = run_unbalance_response(rotor, 3, 6.39e-4, 0.0, [1256.6])
>>> round(1e-6 * response.stiffness["B7206C, node 0"][0, 0, 0], 1)  # kxx [N/um]
230.3
"""

from raceway.framework.loading.registry import further_name

__all__ = ["RollingBearing", "UnbalanceResponse", "run_time_response", "run_unbalance_response"]  # noqa: F822


def __getattr__(name: str) -> object:
    if name not in __all__:
        raise AttributeError(f"module 'raceway.ross' has no attribute '{name}'")
    return further_name(f"ross.{name}")
