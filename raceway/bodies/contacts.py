"""Contacts of balls in grooves: their angles, and ellipses that run over the edge."""

import numpy as np

from raceway.bodies.basis import Basis
from raceway.core.contact.hertz import Ellipse
from raceway.core.ring.ring import COORDINATES, Ring
from raceway.core.ring.system import System, surrogate
from raceway.framework.duties import is_foundation
from raceway.planning.resolve import Problem
from raceway.scene.growth import groove_depth, groove_edge, load_at_edge
from raceway.storage.tables import Tables


def contact_angles(centre: np.ndarray, placed: bool, ball: np.ndarray, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Inner and outer contact angles (..., Z) [rad]; nan where the contact carries nothing.

    centre : (..., Z, 2) from the outer to the inner groove centres, axial and radial
    placed : whether ``ball[..., :2]`` are the balls' places; else they lie between the groove centres
    """
    z, axial, radial = centre.shape[-2], centre[..., 0], centre[..., 1]
    if not placed:
        inner = outer = np.arctan2(axial, radial)
    else:
        inner = np.arctan2(axial - ball[..., 0], radial - ball[..., 1])
        outer = np.arctan2(ball[..., 0], ball[..., 1])
    return np.where(force[..., :z] > 0, inner, np.nan), np.where(force[..., z:] > 0, outer, np.nan)


def beyond_the_groove(problem: Problem, basis: Basis, inner: np.ndarray, outer: np.ndarray, force: np.ndarray) -> list[str]:
    """A sentence for each race whose contact ellipses run over the groove's edge; angles (Z,), forces (2 Z,)."""
    edges, warnings = groove_edges(problem, basis), []
    overs = ellipse_ends(basis, inner, outer, force)
    for race, (word, angle, over) in enumerate(zip(("inner", "outer"), (inner, outer), overs, strict=True)):
        if (over > edges).any():
            ball = int(np.nanargmax(over - edges))
            bearing, edge, reach = problem.bearing.of_rows[basis.row[ball]], edges[ball], over[ball]
            depth = groove_depth(bearing)
            begins = load_at_edge(basis.of_ball(ball)[race], 0.5 * bearing.ball_diameter, edge - abs(angle[ball]))
            assumed = "" if problem.bearing.shoulder_height else ", assumed 0.2 D"
            warnings.append(
                f"the contact ellipse on the {word} race reaches {np.degrees(reach):.1f} deg, beyond the groove's edge at "
                f"{np.degrees(edge):.1f} deg (bearing.shoulder_height = {depth:.3g} m{assumed}): it is truncated there in reality, at this contact "
                f"angle from {begins:.3g} N per ball"
            )
    return warnings


def groove_edges(problem: Problem, basis: Basis) -> np.ndarray:
    """(Z,) angle from the groove's bottom to its edge, seen from the ball's centre, of every ball's row [rad]."""
    return np.array([groove_edge(bearing) for bearing in problem.bearing.of_rows])[basis.row]


def ellipse_ends(basis: Basis, inner: np.ndarray, outer: np.ndarray, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angle (..., Z) of the far end of each contact ellipse, inner and outer; angles (..., Z), forces (..., 2 Z)."""
    z, radius = force.shape[-1] // 2, basis.ball_radius
    return (
        np.abs(inner) + basis.inner.semi_axes(force[..., :z])[0] / radius,
        np.abs(outer) + basis.outer.semi_axes(force[..., z:])[0] / radius,
    )


#: Halvings of an interval of approaches: to the last bit.
_HALVINGS = 80


def law_of_pair(ring: Ring, race: int, approach: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Force (n,) [N] and stiffness (n,) [N/m] of the law at rest at approaches (n,) [m] of one race (0 inner, 1 outer)."""
    system, n = surrogate(ring), len(approach)
    row, z = race * system.ball_count, system.ball_count
    # A number of contacts that is that of the balls is theirs: rows may differ.
    rows = np.arange(row, row + z) if n == z else np.full(n, row)
    params, state = (np.ascontiguousarray(each[rows]) for each in (system.law_params, system.law_state))
    force, d_gap, d_rate = np.empty(n), np.empty(n), np.empty(n)
    system.law(-np.ascontiguousarray(approach), np.zeros(n), params, state, state.copy(), 0.0, force, d_gap, d_rate)
    return force, -d_gap


def approach_at_load(ring: Ring, diameter: float, race: int, load: np.ndarray) -> np.ndarray:
    """(n,) approach [m] at which the law gives a load (n,) [N], by bisection; 0 where there is none."""
    load = np.asarray(load, dtype=float)
    low, high = np.zeros_like(load), np.full_like(load, 1e-3 * diameter)
    while (short := law_of_pair(ring, race, high)[0] < load).any():
        high = np.where(short, 2.0 * high, high)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        below = law_of_pair(ring, race, middle)[0] < load
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return np.where(load > 0.0, high, 0.0)


def contact_ellipse(
    problem: Problem, basis: Basis, ring: Ring, race: int, load: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Peak pressure (n,) [Pa] and semi-axes a, b (n,) [m] of the contacts of a race at loads (n,) [N].

    Of a foundation, whose pressure p(g) follows from the overlap g at each place, the force on the overlap ellipse
    A x^2 + B y^2 <= delta is F = pi / sqrt(A B) int_0^delta p dg.  So the peak pressure is p(delta) = sqrt(A B) / pi dF/ddelta,
    and the semi-axes are sqrt(delta / A), sqrt(delta / B).
    """
    ellipse: Ellipse = (basis.inner, basis.outer)[race]
    contact = problem.contact
    if not problem.bearing.equal_rows and len(load) != len(basis.azimuth):
        # Loads of no particular balls: of the row in which they press hardest.
        each = [geometry.ellipses(basis.modulus)[race] for geometry in basis.geometries]
        ellipse = max(each, key=lambda geometry: float(geometry.peak_pressure(1.0)))
    if not problem.traits.resultants or not is_foundation(contact.law):
        return ellipse.peak_pressure(load), *ellipse.semi_axes(load)
    a, b = ellipse.curvatures
    approach = approach_at_load(ring, basis.geometry.ball_diameter, race, load)
    slope = law_of_pair(ring, race, approach)[1]
    return np.sqrt(a * b) / np.pi * slope, np.sqrt(approach / a), np.sqrt(approach / b)


def rigid_rings(rigid: System, guess: np.ndarray) -> tuple[Tables, np.ndarray]:
    """The table ``model.rigid_rings`` of result.json, of the same scene with rigid bodies, and its stiffness (5, 5)."""
    q, ball, _ = rigid.solve_equilibrium(guess)
    now = rigid.evaluate(q, ball=ball)
    stiffness, _ = rigid.rows_following(q, now, now.stiffness, now.damping)
    return {"displacement": dict(zip(COORDINATES, q.tolist(), strict=True)), "stiffness": stiffness.tolist()}, stiffness


def elasticity(elastic: np.ndarray, rigid: np.ndarray, least: float) -> list[list[float | None]]:
    """(5, 5) relative differences of stiffness entries; None where rigid bodies have less than ``least`` sqrt(K_ii K_jj)."""
    scale = np.sqrt(np.abs(np.outer(np.diag(rigid), np.diag(rigid))))
    return [
        [float(elastic[i, j] / rigid[i, j] - 1.0) if abs(rigid[i, j]) > least * scale[i, j] else None for j in range(5)]
        for i in range(5)
    ]
