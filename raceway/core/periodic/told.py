"""The motions that a search found, as result.json and the screen tell them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from raceway.core.periodic.collocation import Solved
from raceway.core.periodic.sampling import displacements
from raceway.core.periodic.search import Found
from raceway.core.periodic.sweep import forces
from raceway.core.signals.identification import stiffness
from raceway.storage.tables import Tables

#: Samples of a turn for its 1x line: a path has no more intervals as a rule, and harmonics up to this order alias nothing.
_SAMPLES = 360

_WAYS = {
    "+1": "through +1: it drifts to another motion",
    "-1": "through -1: the period doubles",
    "pair": "as a pair: a second frequency comes in",
}


def orbits(found: Sequence[Found]) -> list[Tables]:
    """``motion.orbits`` of result.json: every motion that was found, the one that is taken first."""
    return [_orbit(one, one is found[0]) for one in found]


def _orbit(found: Found, taken: bool) -> Tables:
    """Z [N/m] and amplitude [m] of the 1x line of one motion, and what becomes of disturbances."""
    fate = found.fate
    z, amplitude = first_line(found.refined.solved)
    return {
        "dynamic_stiffness": {"real": z.real, "imag": z.imag, "abs": abs(z)},
        "amplitude_m": amplitude,
        "multiplier": fate.largest,
        "verdict": fate.verdict,
        "leaves_by": fate.leaves_by or None,
        "stable": fate.verdict != "unstable",
        "found": found.how,
        "taken": taken,
    }


def first_line(solved: Solved) -> tuple[complex, float]:
    """Z [N/m] along the force and the major semi-axis [m] of the radial motion's 1x line."""
    problem = solved.problem
    angles = 2.0 * np.pi * np.arange(_SAMPLES) / _SAMPLES
    push = np.empty((_SAMPLES, 5))
    forces(problem.system.force, problem.system.force_params, angles / problem.clock, push)
    turned = 2.0 / _SAMPLES * np.exp(-1j * angles)
    line, force = turned @ displacements(solved, angles), turned @ push
    forward, backward = 0.5 * abs(line[1] - 1j * line[2]), 0.5 * abs(line[1] + 1j * line[2])
    return complex(stiffness(force, line)), float(forward + backward)


def several(told: list[Tables]) -> tuple[str, ...]:
    """What a user should know where more than one motion exists that a ring can stay on."""
    lasting = [one for one in told if one["stable"]]
    if len(lasting) < 2:
        return ()
    values = " and ".join(_complex(one) for one in lasting)
    return (
        f"{len(lasting)} steady motions that are not unstable exist here, Z = {values} N/um: which one a ring takes depends on "
        "how it came here. The first is reported; motion.orbits lists all that were found, others may exist",
    )


def unstable(one: Tables) -> str:
    """Growth of disturbances of a motion, in words."""
    return f"disturbances grow {one['multiplier']:.4g} times a turn, {_WAYS[one['leaves_by']]}"


def _complex(one: Tables) -> str:
    z = one["dynamic_stiffness"]
    return f"{1e-6 * z['real']:.5g} {'-' if z['imag'] < 0.0 else '+'} {1e-6 * abs(z['imag']):.4g}j"
