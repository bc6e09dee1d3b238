"""Superelements of large parts, kept on disk: they do not depend on loads, contacts in touch, or time."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from raceway.core.elastic.copies import Copies
from raceway.core.elastic.superelements.closed import Closed
from raceway.core.elastic.superelements.loose import Loose
from raceway.core.elastic.superelements.part import Part
from raceway.core.hexahedron.operator import HexOperator
from raceway.storage.array_cache import kept

#: Cells of a part from which factors take seconds, and reading them pays.
LEAST_CELLS = 8000
#: The code that the numbers depend on.
SOURCES = (
    "core/linear/dissection.py",
    "core/linear/fronts.py",
    "core/linear/rigid_motions.py",
    "core/hexahedron",
    *(f"core/elastic/superelements/{name}.py" for name in ("closed", "kept", "loose", "part")),
)

Arrays = dict[str, np.ndarray]
#: Called with what is done, how much of it, and how much there is.
OnProgress = Callable[[str, int, int], None]
Bed = tuple[np.ndarray, np.ndarray]


def kept_ring(
    name: str,
    copies: Copies,
    operator: HexOperator,
    contact: np.ndarray,
    free: np.ndarray,
    mass: float,
    bed: Bed | None,
    on_progress: OnProgress | None = None,
) -> Loose | Closed:
    """A ring, or its sectors.  Parameters: see ``Part.of``; ``name`` is for people."""
    kind: type[Loose] | type[Closed] = Closed if len(copies.turns) > 1 else Loose

    def make() -> Arrays:
        return kind.of(Part.of(copies, operator, contact, free, mass, bed, _telling(name, copies, on_progress))).arrays()

    inputs = {"free": free, "bed": list(bed or ()), "turns": copies.turns, "planes": [copies.before, copies.behind]}
    return kind.of_arrays(copies, contact, _kept(name, copies, operator, contact, mass, inputs, make))


def kept_ball(
    name: str,
    copies: Copies,
    operator: HexOperator,
    contact: np.ndarray,
    mass: float,
    caged: np.ndarray,
    apply: Callable[[np.ndarray], np.ndarray],
    on_progress: OnProgress | None = None,
) -> tuple[Loose, np.ndarray]:
    """A ball, held by springs on its mean motions, which the caller takes off again, and its answers (3 n, c) to its cage.

    Parameters
    ----------
    caged : (3 n, c) forces of the cage;  apply : function of displacements (3 n, m) -> forces, those springs left out
    """
    free = np.ones(len(copies.points), dtype=bool)

    def make() -> Arrays:
        told = _telling(name, copies, on_progress)
        loose = Loose.of(Part.of(copies, operator, contact, free, mass, None, told), held=True)
        return loose.arrays() | {"response": loose.solved(caged, apply)}

    arrays = _kept(name, copies, operator, contact, mass, {"held": True, "caged": caged}, make)
    return Loose.of_arrays(copies, contact, arrays), arrays["response"]


def _telling(name: str, copies: Copies, on_progress: OnProgress | None) -> Callable[[int, int], None] | None:
    if on_progress is None:
        return None
    what = f"factoring {'a sector of the ' if len(copies.before) else ''}{_of_people(name)}, {len(copies.cells)} elements"
    return partial(on_progress, what)


def _of_people(name: str) -> str:
    return name.rstrip("_0123456789").replace("_", " ")


def _kept(
    name: str,
    copies: Copies,
    operator: HexOperator,
    contact: np.ndarray,
    mass: float,
    inputs: dict[str, object],
    make: Callable[[], Arrays],
) -> Arrays:
    cells = len(copies.cells)
    if cells < LEAST_CELLS:
        return make()
    inputs |= {
        "points": copies.points,
        "cells": copies.cells,
        "contact": contact,
        "mass": float(mass),
        "moduli": operator.moduli,
        "density": operator.density if mass else None,
        "formulation": operator.formulation,
    }
    what = f"{_of_people(name)}, {cells} elements, {operator.formulation}" + (f", mass {mass:.6g}/s2" if mass else "")
    return kept("superelement", what, inputs, SOURCES, make)
