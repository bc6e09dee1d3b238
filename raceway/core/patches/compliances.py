"""Patches from sections of rings and ball: compliances of the bodies on the points where they meet, from the cache."""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.mesh.ring_mesh import RingShape
from raceway.core.patches.patch import Ball, Patch, Race, Spacing, race_divisions
from raceway.core.revolution.ball import FreeBall, free_ball
from raceway.core.revolution.cached import cached_compliance
from raceway.core.revolution.grooves import groove_compliance
from raceway.core.revolution.profile import dofs
from raceway.core.revolution.ring_profile import graded_profile


@attrs.frozen
class Solid:
    """Material and element formulation of a body.

    Attributes
    ----------
    young [Pa], poisson, formulation : see ``raceway.core.revolution.body``; between points of a contact "full" converges
        faster than "incompatible" (at 4 points along a semi-axis the peak pressure is 0.4 % low, not 0.7 %)
    bulk : size of elements far from the contacts [m]
    """

    young: float
    poisson: float
    formulation: str = "full"
    bulk: float = 0.8e-3


@attrs.frozen
class RingBody:
    """One ring of a row.

    Attributes
    ----------
    shape, solid
    seat : "clamped" or the stiffness of a bed [N/m3]
    window : (2,) contact angles between which it has surface points [rad]
    """

    shape: RingShape
    solid: Solid
    seat: str | float
    window: tuple[float, float]


def make_patch(ring: RingBody, ball: Ball, spacing: Spacing, balls: int) -> Patch:
    """The patch of a ring for a ball, ``balls`` in a row; compliances along the groove where the ball has them.

    Raises
    ------
    MeshError
        A section that cannot be meshed, a window beyond the groove.
    """
    shape, sense = ring.shape, ring.shape.sign
    middle = 0.5 * (ring.window[0] + ring.window[1])
    finest = min(spacing.along, spacing.across)
    section = graded_profile(shape, spacing.along, ring.window, finest, ring.solid.bulk)
    count = race_divisions(shape.centre_r, shape.groove, sense, middle, spacing.across, balls)
    columns, rows = 2 * spacing.columns + 1, len(section.race)
    neighbours = np.arange(1, balls // 2 + 1) * (count // balls)
    steps = np.concatenate([np.arange(columns), neighbours])
    load = dofs(section.race)
    what = f"{'inner' if sense < 0.0 else 'outer'} ring, {count} x {len(section.quads)} elements, {rows} rows of points"
    full = cached_compliance(
        what, section, count, ring.solid.young, ring.solid.poisson, load, load, steps, ring.solid.formulation, ring.seat
    )
    normal = np.array([np.cos(section.angles), np.sin(section.angles)])  # radial, axial
    near = _projected(full[:columns], normal)
    along = np.array([-normal[1], normal[0]])
    shear = None if ball.shear is None else _projected(full[:columns], along)
    between = np.moveaxis(_projected(full[columns:], normal), 0, 2)
    low, high = shape.edges
    edges = (low, high) if sense > 0.0 else (-high, -low)
    crossing = np.zeros((balls, 2, 2))
    for k, block in enumerate(groove_compliance(section.angles, between, np.ones(rows)), start=1):
        crossing[k] = crossing[-k] = block[[0, 1, 1, 2]].reshape(2, 2)
    # What the ball itself moves its groove by is as exact as a vector, too, and not along each point's normal: any part of it
    # that leaves the points' own compliance positive will do.
    crossing[0] = crossing[1]
    along_axis = normal[::-1]
    near = np.ascontiguousarray(near - along_axis.T @ crossing[0] @ along_axis)
    race = Race(sense, shape.groove, shape.centre_r, section.angles, near, spacing.across, edges, crossing, shear)
    return Patch(ball, race, spacing.area)


def make_ball(radius: float, solid: Solid, spacing: Spacing, rows: int, shear: bool = False) -> Ball:
    """The floating ball on a grid of so many rows; ``shear``: with its compliance along the rows' direction, for friction."""
    steps = np.append(np.arange(rows), spacing.ball_divisions // 2)
    finest = min(spacing.along, spacing.across)

    def found(components: tuple[int, ...]) -> FreeBall:
        return free_ball(
            radius, solid.poisson, spacing.ball_divisions, spacing.across, (spacing.columns - 0.5) * spacing.across, finest, solid.bulk,
            steps, components, solid.formulation,
        )  # fmt: skip

    pressed = found((0, 2))
    assert len(pressed.latitudes) == 2 * spacing.columns + 1
    normal = np.array([np.cos(pressed.latitudes), np.sin(pressed.latitudes)])
    near = _projected(pressed.compliance(radius, solid.young), normal)
    middle = len(pressed.latitudes) // 2
    around = np.ascontiguousarray(found((1,)).compliance(radius, solid.young)[:-1]) if shear else None
    return Ball(radius, pressed.latitudes, np.ascontiguousarray(near[:-1]), float(near[-1, middle, middle]), around)


def _projected(full: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """(o, n, n) along directions normal (2, n), from (o, 2 n, 2 n) of two components."""
    n = normal.shape[1]
    parts = np.asarray(full).reshape(len(full), 2, n, 2, n)
    return np.ascontiguousarray(np.einsum("ci,ocidj,dj->oij", normal, parts, normal, optimize=True))
