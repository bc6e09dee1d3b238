"""Bearing from two shaker tests: frequency response of a rig less that of its free shaft, then K, C as `raceway fit` identifies them.

Frequency-based substructuring in the dual form (LM-FBS): with Y = diag(Y_rig, -Y_shaft) and B = [I, -I] on the shared degrees of
freedom, Y - Y B^T (B Y B^T)^-1 B Y is the receptance of what the rig has beside the shaft.  pyFBS leaves the same line to numpy.

References
----------
de Klerk, Rixen, Voormeeren (2008), General framework for dynamic substructuring, AIAA Journal 46, section on the dual assembly in the
frequency domain; Voormeeren, Rixen (2012), decoupling as the coupling of a negative part, MSSP 27.
"""

from pathlib import Path

import numpy as np
import pyuff

import raceway as rw

HZ = np.arange(20.0, 600.0, 2.0)
#: Masses of the shaft at the bearing and at the disc [kg], stiffness between them [N/m]; noise of both tests, relative.
SHAFT_KG, DISC_KG, SHAFT_N_PER_M, NOISE = 1.2, 1.8, 9e7, 1e-3


def less(whole: np.ndarray, part: np.ndarray) -> np.ndarray:
    """Receptances (n, k, k) of an assembly less those of a part at the same k degrees of freedom [m/N]."""
    n, k = whole.shape[:2]
    y, b = np.zeros((n, 2 * k, 2 * k), complex), np.hstack([np.eye(k), -np.eye(k)])
    y[:, :k, :k], y[:, k:, k:] = whole, -part
    return (y - y @ b.T @ np.linalg.inv(b @ y @ b.T) @ b @ y)[:, :k, :k]


def tested(stiffness: float, damping: float, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Receptances (n, 1, 1) at the bearing of the shaft on it, and of the free shaft, as a shaker test would give them."""
    w, random = 2.0 * np.pi * HZ, np.random.default_rng(seed)
    spring = SHAFT_N_PER_M * np.array([[1.0, -1.0], [-1.0, 1.0]])
    free = spring - w[:, None, None] ** 2 * np.diag([SHAFT_KG, DISC_KG])
    held = free + (stiffness + 1j * w * damping)[:, None, None] * np.diag([1.0, 0.0])
    noise = 1.0 + NOISE * (random.standard_normal((2, len(w))) + 1j * random.standard_normal((2, len(w))))
    rig, shaft = (scale[:, None, None] * np.linalg.inv(z)[:, :1, :1] for scale, z in zip(noise, (held, free), strict=True))
    return rig, shaft


def write(receptance: np.ndarray, path: Path) -> Path:
    """A drive-point receptance [m/N] as a universal file, type 58."""
    labels = {"func_type": 4, "rsp_node": 1, "rsp_dir": 2, "ref_node": 1, "ref_dir": 2, "abscissa_spec_data_type": 18}
    units = {
        "ordinate_spec_data_type": 8,
        "ordinate_axis_units_lab": "m",
        "orddenom_spec_data_type": 13,
        "orddenom_axis_units_lab": "N",
    }
    data = {"type": 58, "binary": 1, "id1": "rig less shaft", "abscissa_spacing": 0, "x": HZ, "data": receptance}
    pyuff.UFF(str(path)).write_sets([data | labels | units])
    return path


if __name__ == "__main__":
    still = rw.run({"bearing": {"preset": "B7206C"}, "load": {"axial": "1 kN"}, "contact": {"damping": 300.0}})
    truth = {"K": still.stiffness[1, 1], "C": still.damping[1, 1]}
    rig, shaft = tested(truth["K"], truth["C"])
    fitted = rw.fit(write(less(rig, shaft)[:, 0, 0], Path("bearing.uff")), None, "K,C")
    for name, value in truth.items():
        print(f"{name}: {fitted[name]:.5g} +- {fitted.half_width(name):.2g}, of the bearing {value:.5g}")
