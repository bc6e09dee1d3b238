"""
From an oscilloscope's file to K and C
======================================

A shaker's force and a probe's displacement, as a Tektronix MSO saves them, give K, C and mass with 95 % intervals.
The file here is made with K = 50 N/µm, C = 800 N s/m, 2 kg and noise; a measured one takes its place.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import raceway as rw

rng = np.random.default_rng(1)
time = np.arange(4000) / 8000.0  # s
tones = 2.0 * np.pi * np.arange(40, 1600, 20)  # rad/s
waves = np.exp(1j * (np.outer(time, tones) + rng.uniform(0.0, 2.0 * np.pi, tones.size)))
force = waves.real.sum(axis=1)  # N
moved = (waves / (5e7 + 800j * tones - 2.0 * tones**2)).real.sum(axis=1)  # m
volts = np.column_stack([force / 100.0, 1e6 * moved * 0.8])  # 100 N/V, 0.8 V/µm
volts += rng.normal(0.0, 0.002 * volts.std(axis=0), volts.shape)
scope = Path(tempfile.mkdtemp(), "tek0001.csv")
with scope.open("w") as file:
    file.write("Model,MSO54\nHorizontal Units,s\nVertical Units,V,V\n,,\nTIME,CH1,CH2\n")
    np.savetxt(file, np.column_stack([time, volts]), delimiter=",", fmt="%.9g")

fitted = rw.fit(scope, None, "K,C,mass", columns={"CH1": "force_n*100", "CH2": "x_um/0.8"})
k, half_width = 1e-6 * fitted["K"], 1e-6 * fitted.half_width("K")

spectra = np.fft.rfft(volts * [100.0, 1e-6 / 0.8], axis=0)[20:800:10]
frequencies = np.fft.rfftfreq(time.size, 1.0 / 8000.0)[20:800:10]
turning = 2j * np.pi * frequencies
model = fitted["K"] + turning * fitted["C"] + turning**2 * fitted["mass"]
plt.figure(layout="constrained")
plt.plot(
    frequencies, 1e-6 * (spectra[:, 0] / spectra[:, 1]).real, "o", color="0.7", label="measured"
)
plt.plot(frequencies, 1e-6 * model.real, label="fitted")
plt.xlabel("frequency [Hz]")
plt.ylabel("Re F/x [N/µm]")
plt.legend()
print(f"K = {k:.3f} ± {half_width:.3f} N/µm")
