"""A rotor in ROSS on two B7206C, as stiff as its own unbalance finds them: pip install './packages/raceway-rotor[ross]', python examples/ross_rotor.py."""

import sys

import numpy as np

import raceway as rw

try:
    from raceway.ross import RollingBearing, run_unbalance_response
except rw.RacewayError as why:
    sys.exit(str(why))
import ross

speed = 12000.0 * np.pi / 30.0  # rad/s
steel = ross.Material(name="steel", rho=7810.0, E=2.1e11, G_s=8.1e10)
for axial in (1000.0, 400.0):  # N
    shaft = [ross.ShaftElement(L=0.05, idl=0.0, odl=0.03, material=steel) for _ in range(6)]
    disc = ross.DiskElement(n=3, m=3.0, Id=4.1e-3, Ip=8.05e-3)
    bearings = [RollingBearing("B7206C", axial, n=0), RollingBearing("B7206C", -axial, n=6)]
    found = run_unbalance_response(ross.Rotor(shaft, [disc], bearings), 3, 6.39e-4, 0.0, [speed])
    small, k = bearings[0].K(speed)[0, 0], found.stiffness[bearings[0].tag][0, 0, 0]
    force = abs(found.force[bearings[0].tag][0, 0])
    print(f"{axial:g} N axial: K {1e-6 * small:.4f} N/µm for small motions, {1e-6 * k:.4f} N/µm under {force:.1f} N")
