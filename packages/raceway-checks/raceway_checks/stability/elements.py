"""Finite elements at their worst: slender ones, nearly incompressible ones, bodies of very different stiffness."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from raceway.extend import KINDS, HexOperator, solve_static
from raceway_checks.stability.study import Limit, Rows

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

_YOUNG, _POISSON, _DENSITY = 212e9, 0.29, 7810.0
_STEPS = 400
#: What bounds the tip of a nearly incompressible cantilever, by kind of elements; others bend.
_LOCKS = {
    "full": "full integration locks: why it is not the default",
    "one_point": "its hourglass control is a share of lambda + 2 mu, which grows without limit: it locks, too",
}
_BENDS = "E is the same, so that the deflection hardly depends on Poisson's ratio"


def slender_steps(rows: Rows, _bench: None, aspect: float) -> None:
    """Explicit steps of a free block of slender elements, around the limit of its fastest mode."""
    points, cells = _block((3, 3, 3), (3e-3 * aspect, 3e-3, 3e-3))
    for kind in KINDS:
        op = HexOperator(points, cells, _YOUNG, _POISSON, _DENSITY, kind)
        mass = np.repeat(op.lumped_mass(), 3)
        fastest = np.linalg.eigvalsh(op.stiffness().toarray() / np.sqrt(mass[:, None] * mass))[-1]
        limit, setting = 2.0 / np.sqrt(fastest), {"elements": kind, "aspect": aspect}
        share, why = op.stable_step() / limit, "no mode of the mesh is faster than its fastest element"
        rows.check("predicted safe step over the mesh's limit", share, why, Limit.at_most(1.0 + 1e-9), at=setting)
        words = f"largest over first displacement, {_STEPS} steps"
        why = "1 / sqrt(1 - 0.98^2) = 5, and modes add up"
        rows.check(words, _growth(op, 0.98 * limit), why, Limit.at_most(20.0), at={**setting, "step/limit": 0.98})
        rows.check(words, _growth(op, 1.02 * limit), "1.49 a step", Limit.at_least(1e3), at={**setting, "step/limit": 1.02})


def _growth(op: HexOperator, dt: float) -> float:
    u = np.random.default_rng(3).standard_normal(op.points.shape) * 1e-12
    mass = op.lumped_mass()
    u -= np.average(u, axis=0, weights=mass)
    v, first = np.zeros_like(u), float(np.abs(u).max())
    for _ in range(_STEPS):
        v -= dt * op.internal_force(u) / mass[:, None]
        u += dt * v
    return float(np.abs(u).max() / first)


def slender_bar(rows: Rows, _bench: None, aspect: float, poisson: float, young: float) -> None:
    """A bar of slender elements under tension: its lengthening F l / E A, exact for any element."""
    length, side, force = 4e-3 * aspect, 3e-3, 1.0
    points, cells = _block((4, 3, 3), (length, side, side))
    why = "constant strain is exact in every element; the matrix's condition costs up to ten digits"
    for kind in KINDS:
        matrix = HexOperator(points, cells, young, poisson, _DENSITY, kind).stiffness()
        setting = {"elements": kind, "aspect": aspect, "poisson": poisson, "young": young}
        value, near = partial(_lengthening, matrix, points, force), force * length / (young * side**2)
        rows.check("lengthening [m]", value, why, Limit.equal(near, 1e-5), at=setting)


def soft_on_hard(rows: Rows, _bench: None) -> None:
    """Rubber bonded on ceramic, pressed flat between plates that slide: uniform stress, strains in series."""
    hard, soft, side, force = 310e9, 2e6, 1e-3, 1.0
    points, cells = _block((8, 3, 3), (8 * side, 3 * side, 3 * side))
    half = points[cells].mean(axis=1)[:, 0] > 4 * side
    near = force * 4 * side / (9 * side**2) * (1.0 / hard + 1.0 / soft)
    for kind in KINDS:
        parts = ((half, soft), (~half, hard))
        rubber, ceramic = (HexOperator(points, cells[part], young, 0.0, 1e3, kind).stiffness() for part, young in parts)
        value = partial(_lengthening, (rubber + ceramic).tocsr(), points, force)
        why = "uniform stress is exact; the stiffnesses differ by 1.6e5"
        setting = {"elements": kind, "ratio of moduli": hard / soft}
        rows.check("shortening [m]", value, why, Limit.equal(near, 1e-6), at=setting)


def _lengthening(matrix: csr_matrix, points: np.ndarray, force: float) -> float:
    """Of an eighth of a bar under a uniform traction at its end [m], held on its planes of symmetry; shortening under pressure."""
    length, side, _ = points.max(axis=0)
    end = points[:, 0] > length * (1.0 - 1e-12)
    edge = (np.isclose(points[end, 1:], 0.0, atol=1e-9 * side) | np.isclose(points[end, 1:], side)).sum(axis=1)
    load, share = np.zeros_like(points), 0.5**edge  # of a node in the traction on a uniform grid
    load[end, 0] = force * share / share.sum()
    displacement = solve_static(matrix, points, load, points == 0.0, tolerance=1e-7).displacement
    return float(displacement[end, 0].mean())


def locking(rows: Rows, _bench: None) -> None:
    """A nearly incompressible cantilever: elements that bend, and elements that are known to lock."""
    beam, words = _tip("mean_dilatation", 0.3), "tip deflection over that at Poisson's ratio 0.3, E the same"
    for kind in KINDS:
        limit = Limit.at_most(0.75) if kind in _LOCKS else Limit.at_least(0.8)
        setting = {"elements": kind, "poisson": 0.4999}
        rows.check(words, _tip(kind, 0.4999) / beam, _LOCKS.get(kind, _BENDS), limit, at=setting)


def _tip(kind: str, poisson: float) -> float:
    points, cells = _block((16, 4, 4), (8.0, 1.0, 1.0))
    op = HexOperator(points, cells, 1.0, poisson, 1.0, kind)
    end = points[:, 0] > 8.0 - 1e-9
    load = np.zeros_like(points)
    load[end, 2] = 1.0 / end.sum()
    fixed_dofs = np.repeat(points[:, :1] < 1e-9, 3, axis=1)
    return float(solve_static(op.stiffness(), points, load, fixed_dofs, tolerance=1e-6).displacement[end, 2].mean())


def bad_elements(rows: Rows, _bench: None) -> None:
    """An element turned inside out, and one without a volume."""
    points, cells = _block((1, 1, 1), (1.0, 1.0, 1.0))
    for name, corner_x in (("inside out", -2.0), ("flat", -1.0)):
        bad = points + np.where(points[:, :1] == 1.0, [corner_x, 0.0, 0.0], 0.0)
        build = partial(_explicit_step, bad, cells)
        rows.refused("inverted or degenerate", "MeshError: such an element has no mass", build, {"element": name})


def _explicit_step(points: np.ndarray, cells: np.ndarray) -> float:
    return HexOperator(points, cells, _YOUNG, _POISSON, _DENSITY).stable_step()


def _block(counts: tuple[int, int, int], sides: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3) and cells (m, 8) of a box, x running fastest."""
    axes = [np.linspace(0.0, side, count + 1) for count, side in zip(counts, sides, strict=True)]
    z, y, x = np.meshgrid(axes[2], axes[1], axes[0], indexing="ij")
    k, j, i = np.meshgrid(*(np.arange(count) for count in counts[::-1]), indexing="ij")
    row, layer = counts[0] + 1, (counts[0] + 1) * (counts[1] + 1)
    n = (k * layer + j * row + i).ravel()
    cells = np.stack([n, n + 1, n + 1 + row, n + row], axis=1)
    return np.stack([x, y, z], axis=-1).reshape(-1, 3), np.concatenate([cells, cells + layer], axis=1)
