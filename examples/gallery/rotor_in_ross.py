"""
K over speed in ROSS
====================

A rotor of 3 kg on two B7206C is computed in ROSS with the K(speed) of the bearing, and with ROSS's closed formula for ball bearings.
The formula knows the balls and one load, not conformity, speed or tilt.
"""

import matplotlib.pyplot as plt
import numpy as np
import ross

import raceway as rw

bearing = {
    "bearing": {"preset": "B7206C"},
    "load": {"axial": "1 kN"},
    "excitation": {
        "kind": "bidirectional",
        "speed_rpm": 12000.0,
        "amplitude": "constant",
        "force": "10 N",
    },
}
table = rw.export_ross(rw.sweep(bearing, {"excitation.speed_rpm": np.linspace(1000, 31000, 16)}))


def formula(node):
    return ross.BallBearingElement(
        n=node, n_balls=12, d_balls=9.525e-3, fs=1000.0, alpha=np.radians(15.0)
    )


steel = ross.Material(name="steel", rho=7810.0, E=2.1e11, G_s=8.1e10)
disc = ross.DiskElement(n=3, m=3.0, Id=4.1e-3, Ip=8.05e-3)
speeds = np.linspace(1000, 31000, 61)  # r/min

figure, axes = plt.subplots(layout="constrained")
for label, element in {"Raceway's K(speed)": table.element, "closed formula": formula}.items():
    shaft = [ross.ShaftElement(L=0.05, idl=0.0, odl=0.03, material=steel) for _ in range(6)]
    rotor = ross.Rotor(shaft, [disc], [element(0), element(6)])
    response = rotor.run_unbalance_response(3, 6.39e-4, 0.0, list(speeds * np.pi / 30)).forced_resp
    amplitude = 1e6 * np.abs(response[3 * rotor.number_dof])
    axes.semilogy(speeds, amplitude, label=label)
    print(f"{label}: critical speed near {speeds[amplitude.argmax()]:.0f} r/min")
axes.set(xlabel="speed [r/min]", ylabel="amplitude of the disc [µm]")
axes.legend()
