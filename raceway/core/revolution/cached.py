"""Compliances through the cache on disk: the body is only built when they are not there."""

from __future__ import annotations

import numpy as np

from raceway.core.revolution.body import HOURGLASS, Revolution
from raceway.core.revolution.profile import Profile
from raceway.storage.array_cache import kept

#: The code on which the numbers depend; whoever keeps something made of compliances adds its own.
SOURCES = ("core/revolution", "core/hexahedron")


def cached_compliance(
    what: str,
    profile: Profile,
    divisions: int,
    young: float,
    poisson: float,
    load_dofs: np.ndarray,
    observed_dofs: np.ndarray,
    offsets: np.ndarray | None = None,
    formulation: str = "incompatible",
    seat: str | float = "clamped",
    harmonics: str = "sampled",
    hourglass: float = HOURGLASS,
) -> np.ndarray:
    """``Revolution.compliance`` [m/N], read-only when it comes from the cache.

    Parameters
    ----------
    what : what `raceway cache` says of it, for instance "inner ring of B7206C, 4 nodes per semi-axis"
    """
    inputs = {
        "points": profile.points,
        "quads": profile.quads,
        "seat_nodes": profile.seat if seat != "free" else None,
        "divisions": divisions,
        "young": float(young),
        "poisson": float(poisson),
        "loads": np.asarray(load_dofs, dtype=np.int64),
        "observed": np.asarray(observed_dofs, dtype=np.int64),
        "offsets": None if offsets is None else np.asarray(offsets, dtype=np.int64),
        "formulation": formulation,
        "hourglass": hourglass if formulation == "one_point" else None,
        "seat": seat,
        "harmonics": harmonics,
    }

    def make() -> dict[str, np.ndarray]:
        body = Revolution(profile, divisions, young, poisson, 1.0, formulation, seat, hourglass)
        return {"compliance": body.compliance(load_dofs, observed_dofs, offsets, harmonics)}

    return kept("compliance", what, inputs, SOURCES, make)["compliance"]
