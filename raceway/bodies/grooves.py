"""Contacts of balls in grooves: their angles, ellipses that run over the edge, loads that no ball carries."""

from __future__ import annotations

import numpy as np

from raceway.bodies.basis import Basis
from raceway.core.ring.ring import Ring
from raceway.errors import ConvergenceError
from raceway.scene.inner_ring import groove_depth, load_at_edge
from raceway.scene.scene import Scene


def contact_angles(
    system: Ring, placed: bool, q: np.ndarray, ball: np.ndarray, force: np.ndarray, t: np.ndarray | float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Inner and outer contact angles (Z,) [rad]; nan where the contact carries nothing.  Of several states: (n, Z).

    Parameters
    ----------
    placed : whether ``ball[..., :2]`` are the balls' places; else they lie between the groove centres
    """
    z = system.ball_count
    centre = system.centre_vectors(q, t, ball)[0]
    axial, radial = centre[..., 0], centre[..., 1]
    if not placed:
        inner = outer = np.arctan2(axial, radial)
    else:
        inner = np.arctan2(axial - ball[..., 0], radial - ball[..., 1])
        outer = np.arctan2(ball[..., 0], ball[..., 1])
    return np.where(force[..., :z] > 0, inner, np.nan), np.where(force[..., z:] > 0, outer, np.nan)


def beyond_the_groove(scene: Scene, basis: Basis, inner: np.ndarray, outer: np.ndarray, force: np.ndarray) -> list[str]:
    """A sentence for each race whose contact ellipses run over the groove's edge; angles (Z,), forces (2 Z,)."""
    edges, found = groove_edges(scene, basis), []
    overs = ellipse_ends(basis, inner, outer, force)
    for race, (word, angle, over) in enumerate(zip(("inner", "outer"), (inner, outer), overs, strict=True)):
        beyond = over - edges
        if np.nanmax(beyond, initial=0.0) > 0.0:
            ball = int(np.nanargmax(beyond))
            bearing, edge, reach = scene.bearing.of_rows[basis.row[ball]], edges[ball], over[ball]
            depth = groove_depth(bearing)
            begins = load_at_edge(basis.of_ball(ball)[race], 0.5 * bearing.ball_diameter, edge - abs(angle[ball]))
            assumed = "" if scene.bearing.shoulder_height else ", assumed 0.2 D"
            found.append(
                f"the contact ellipse on the {word} race reaches {np.degrees(reach):.1f} deg, beyond the groove's edge at "
                f"{np.degrees(edge):.1f} deg (bearing.shoulder_height = {depth:.3g} m{assumed}): it is cut off there in reality, at this "
                f"contact angle from {begins:.3g} N a ball"
            )
    return found


def groove_edges(scene: Scene, basis: Basis) -> np.ndarray:
    """(Z,) angle from the groove's bottom to its edge, seen from the ball's centre, of every ball's row [rad]."""
    rows = [np.arccos(1.0 - groove_depth(one) / (0.5 * one.ball_diameter)) for one in scene.bearing.of_rows]
    return np.asarray(np.array(rows)[basis.row])


def ellipse_ends(basis: Basis, inner: np.ndarray, outer: np.ndarray, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angle (..., Z) of the far end of each contact ellipse, inner and outer; angles (..., Z), forces (..., 2 Z)."""
    z, radius = force.shape[-1] // 2, basis.ball_radius
    return (
        np.abs(inner) + basis.inner.semi_axes(force[..., :z])[0] / radius,
        np.abs(outer) + basis.outer.semi_axes(force[..., z:])[0] / radius,
    )


def refuse_impossible_ellipses(basis: Basis, force: np.ndarray, state: dict[str, np.ndarray] | None = None) -> None:
    """Loads (2 Z,) [N] that no ball can carry: a contact ellipse longer than half its circumference.

    Raises
    ------
    ConvergenceError
        With ``state``, the solution that says so.
    """
    z, radius = len(force) // 2, basis.ball_radius
    for race, ellipse, load in (("inner", basis.inner, force[:z]), ("outer", basis.outer, force[z:])):
        half = ellipse.semi_axes(load)[0] / radius
        if half.max(initial=0.0) >= 0.5 * np.pi:
            raise ConvergenceError(
                f"the contact ellipse on the {race} race would be {np.degrees(2.0 * half.max()):.0f} deg of the ball long, more than half "
                f"its circumference, under {load[np.argmax(half)]:.3g} N a ball: no such contact exists. Check units and loads "
                "(bearing.rings.young in Pa, lengths in m)",
                state,
            )
