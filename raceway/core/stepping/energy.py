"""Balance of the energies that a stepped system tells."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

#: What is stored in the system, and what has left it.
STORED, LOST = ("elastic", "kinetic", "contact"), ("friction", "damping")


def drift(energies: Mapping[str, np.ndarray]) -> float | None:
    """Largest change of stored + lost - external work, over the largest of these energies' ranges; None without energies.

    Notes
    -----
    "external" is the work of loads and excitation, summed over all steps with the mean force of each step.
    """
    if "external" not in energies:
        return None
    kept = [energies[name] for name in (*STORED, *LOST) if name in energies]
    total = np.sum(kept, axis=0) - energies["external"]
    size = max([float(np.ptp(one)) for one in (*kept, energies["external"])] + [1e-300])
    return float(np.abs(total - total[0]).max() / size)


def largest_share(energies: Mapping[str, np.ndarray], part: str, whole: str) -> float:
    """Largest part over the largest whole, for instance "hourglass" of "elastic"."""
    return float(energies[part].max(initial=0.0) / max(energies[whole].max(initial=0.0), 1e-300))


def friction_lost(energies: Mapping[str, np.ndarray]) -> float:
    """What friction took between the first sample and the last [J]."""
    lost = energies["friction"]
    return float(lost[-1] - lost[0]) if len(lost) else 0.0
