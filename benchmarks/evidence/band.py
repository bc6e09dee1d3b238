"""Bands over tolerances: a published function, what a preload moves, and what samples cost."""

from __future__ import annotations

from typing import Any

import numpy as np

from benchmarks.evidence import Row, below
from raceway.core.jit import working_processor_time
from raceway.studies.band.front import band
from raceway.studies.band.sobol import design, indices
from raceway.studies.sensitivities.front import sensitivities

TITLE = "Bands over tolerances"
COMMAND = "python -m benchmarks.evidence band"
#: Per cent by which kxx of a bearing moves with 10 % of its preload: issue of this feature, which names no preload.
_MOVES = {"7206C": 4.8, "7206A5": 3.9, "7206A": 3.5}
_PRELOAD = 400.0
_STATIC, _ORBITS = 2048, 128


def rows() -> list[Row]:
    return [*_ishigami(), *_preload(), *_cost()]


def _ishigami() -> list[Row]:
    """Ishigami, Homma, Proc. ISUMA 1990: sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1 on [-pi, pi]^3, its indices in closed form."""
    a, b = 7.0, 0.1
    x = np.pi * (2.0 * design(4096, 3, seed=1) - 1.0)
    found = indices((np.sin(x[:, 0]) + a * np.sin(x[:, 1]) ** 2 + b * x[:, 2] ** 4 * np.sin(x[:, 0]))[None], 3)
    v1, v2, v13 = 0.5 * (1.0 + b * np.pi**4 / 5.0) ** 2, a**2 / 8.0, b**2 * np.pi**8 * (1.0 / 18.0 - 1.0 / 50.0)
    exact = np.array([[v1, v2, 0.0], [v1 + v13, v2, v13]]) / (v1 + v2 + v13)
    note = "4096 rows of Saltelli's design, as raceway band makes and reads them; estimators of scipy.stats.sobol_indices"
    names = ("first-order", "total")
    return [
        below(
            f"Ishigami's function: largest error of {name} indices", float(np.abs(one[0] - other).max()), 0.02, COMMAND, note
        )
        for name, one, other in zip(names, (found.first, found.total), exact, strict=True)
    ]


def _preload() -> list[Row]:
    result = []
    for name, wanted in _MOVES.items():
        scene: dict[str, Any] = {"bearing": {"preset": name, "arrangement": "DB", "preload": _PRELOAD}}
        share = sensitivities(scene, ["bearing.preload"])["bearing.preload"].influence["kxx"]
        note = f"by the derivative, DB pair at {_PRELOAD:g} N; {10.0 * share:.2f} % against {wanted:g} %"
        name = f"10 % of preload moves kxx of {name}: distance from {wanted:g} %, percentage points"
        result.append(below(name, abs(10.0 * share - wanted), 0.3, COMMAND, note))
    return result


def _cost() -> list[Row]:
    result = []
    still: dict[str, Any] = {"bearing": {"preset": "B7206C"}, "load": {"axial": 400.0}}
    force = {"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 1e-4}
    moving = {**still, "rotor": {"mass": 2.0}, "excitation": force}
    given = {"load.axial": "±10 %", "bearing.contact_angle_deg": "±1 deg"}
    for name, scene, count, limit in (("static", still, _STATIC, 60.0), ("steady orbit, one pitch", moving, _ORBITS, 150.0)):
        band(scene, given, count=2)  # kernels
        begun = working_processor_time()
        found = band(scene, given, count=count)
        seconds = working_processor_time() - begun
        note = f"from {found.samples} samples in {seconds:.1f} s, in one process, others at work beside it; each sample is a scene checked, planned and built in Python"
        label = f"10 000 samples of a band, {name}: processor time [s]"
        result.append(below(label, seconds * 10_000 / found.samples, limit, COMMAND, note))
    return result
