"""The article's procedure as it is printed: detrend, denoise, whole-turn Fourier transform, shaft correction, impedance.

Notes
-----
The article's section 3.3: F_tr = m e w^2 / 2; Z = F_tr / delta, delta = delta_c - delta_s, delta_s = delta_st / (1 - r^2),
delta_st = m e w^2 a (3 L^2 - 16 a^2) / (192 E I), with the distance a of the sensor from the bearing and the span L.  What it
leaves open is chosen here: one channel; a straight line is taken off; a zero-phase Butterworth low-pass of order 4 at five
times the speed; the critical speed of the rotor on the bearings' stiffness at rest; m of K = Re Z + m w^2 is the inner ring's.

A simply supported beam of span L under a force P at mid-span bends by P a (3 L^2 - 4 a^2) / (48 E I) at a (Timoshenko, Strength
of Materials), to which the printed formula is equal for an L of twice the span.  Beyond its supports, it is straight:
-P a L^2 / (16 E I).
"""

from __future__ import annotations

from math import pi

import attrs
import numpy as np

from raceway.scene.rig import Rig
from raceway.studies.fit.shaft_angle import Turning
from raceway.studies.shaft.bearing import Bearing
from raceway.studies.shaft.rotor import shaft

_LOW_PASS_ORDERS = 5.0


@attrs.frozen
class Reading:
    """K [N/m] and C [N s/m] by one way to correct for the shaft."""

    correction: str
    stiffness: float
    damping: float


def amplitude(found: Turning) -> complex:
    """1x line of the y channel [m], phase against the mark, as the article has it."""
    from scipy.signal import butter, sosfiltfilt

    time, y = found.recording.time, found.recording.y
    mean = float(found.angle[-1] - found.angle[0]) / float(time[-1] - time[0])
    rate = 1.0 / float(np.median(np.diff(time)))
    straight = y - np.polyval(np.polyfit(time, y, 1), time)
    corner = min(_LOW_PASS_ORDERS * mean / (2.0 * pi), 0.45 * rate)
    denoised = sosfiltfilt(butter(4, corner, fs=rate, output="sos"), straight)
    samples = round(found.turns * 2.0 * pi / mean * rate)
    denoised = denoised[:samples]
    line = 2.0 * np.fft.rfft(denoised)[found.turns] / len(denoised)
    return complex(line * np.exp(-1j * found.angle[0]))


def critical_speed(rig: Rig, held: Bearing | None) -> float:
    """First critical speed [rad/s] on the bearings' stiffness at rest, or on rigid supports that let the shaft tilt."""
    line = shaft(rig)
    radial, tilt = (1e12, 0.0) if held is None else np.diag(np.linalg.inv(held.compliance))
    for place in rig.bearings:
        line = line.with_spring(place, radial, tilt)
    return float(line.critical_speeds()[0])


def readings(rig: Rig, held: Bearing, speed: float, line: complex) -> list[Reading]:
    """K and C from the 1x line at the sensor [m] against the unbalance, by the article's correction and others."""
    inertia = pi / 64.0 * rig.shaft_diameter**4
    whole, a = rig.unbalance * speed**2, rig.sensor_distance

    def printed(span: float) -> float:
        return whole * a * (3.0 * span**2 - 16.0 * a**2) / (192.0 * rig.young * inertia)

    def supported(span: float) -> float:
        if rig.sensor_side == "outside":
            return -whole * a * span**2 / (16.0 * rig.young * inertia)
        return whole * a * (3.0 * span**2 - 4.0 * a**2) / (48.0 * rig.young * inertia)

    def grown(other: Bearing | None) -> float:
        return 1.0 / (1.0 - (speed / critical_speed(rig, other)) ** 2)

    def reading(words: str, bow: float, force: float) -> Reading:
        z = force / (line - bow)
        return Reading(words, z.real + held.mass * speed**2, z.imag / speed)

    half, elastic = 0.5 * whole, grown(held)
    return [
        reading("as printed", printed(rig.span) * elastic, half),
        reading("as printed, critical speed on rigid supports", printed(rig.span) * grown(None), half),
        reading("as printed, with L twice the span", printed(2.0 * rig.span) * elastic, half),
        reading("none", 0.0, half),
        reading("simply supported beam, amplified bow", supported(rig.span) * elastic, half),
        reading("simply supported beam, amplified bow and force", supported(rig.span) * elastic, half * elastic),
    ]
