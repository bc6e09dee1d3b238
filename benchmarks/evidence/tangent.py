"""Symmetry of the consistent tangent, and its difference from central differences of the force."""

from __future__ import annotations

import numpy as np

from benchmarks.evidence import Row, below
from raceway.errors import RacewayError
from raceway.pipeline.settle import settle
from validation.scenes import model_of, random_tables
from validation.tangent import DIFFERENCES, SYMMETRY, asymmetry, cases, deviation

TITLE = "Consistent 5x5 tangent"
COMMAND = "python -m benchmarks.evidence tangent"


def rows() -> list[Row]:
    found = []
    for name, tables in cases().items():
        model = model_of(tables)
        now = settle(model)
        found.append(below(f"{name}: asymmetry", asymmetry(now.stiffness, model.system.arm), SYMMETRY, COMMAND))
        found.append(
            below(
                f"{name}: difference to central differences",
                deviation(model, now.displacement, now.ball),
                DIFFERENCES,
                COMMAND,
            )
        )
    rng = np.random.default_rng(11)
    worst, farthest, count = 0.0, 0.0, 0
    while count < 200:
        model = model_of(random_tables(rng, "penalty" if count % 4 == 3 else "hertz"))
        try:
            now = settle(model)
        except RacewayError:
            continue
        count += 1
        worst = max(worst, asymmetry(now.stiffness, model.system.arm))
        farthest = max(farthest, deviation(model, now.displacement, now.ball))
    found.append(below(f"{count} random scenes: largest asymmetry", worst, SYMMETRY, COMMAND))
    found.append(below(f"{count} random scenes: largest difference to central differences", farthest, DIFFERENCES, COMMAND))
    return found
