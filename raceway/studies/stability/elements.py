"""Finite elements at their worst: slender ones, nearly incompressible ones, bodies of very different stiffness."""

from __future__ import annotations

from functools import partial

import numpy as np

from raceway.core.hexahedron.operator import HexOperator
from raceway.core.hexahedron.strain import KINDS
from raceway.core.linear.statics import solve_static
from raceway.errors import MeshError
from raceway.framework.registry import Registry
from raceway.studies.stability.case import AtLeast, AtMost, Case, Measured, Near, Row, judged, refused

_YOUNG, _POISSON, _DENSITY = 212e9, 0.29, 7810.0
_STEPS = 400


def slender_steps(case: Case, registry: Registry) -> list[Row]:
    """Explicit steps of a free block of slender elements, around the limit of its fastest mode."""
    aspect = case.arguments["aspect"]
    points, cells = _block((3, 3, 3), (3e-3 * aspect, 3e-3, 3e-3))
    rows = []
    for kind in KINDS:
        op = HexOperator(points, cells, _YOUNG, _POISSON, _DENSITY, kind)
        limit = _limit(op)
        setting = {"elements": kind, "aspect": aspect}
        safe = AtMost(1.0 + 1e-9, "no mode of the mesh is faster than its fastest element")
        share = partial(_share, op, limit)
        rows.append(judged(case.name, setting, "predicted safe step over the mesh's limit", safe, None, share))
        for factor in (0.98, 1.02):
            bound = (
                AtMost(20.0, "1 / sqrt(1 - 0.98^2) = 5, and modes add up") if factor < 1.0 else AtLeast(1e3, "1.49 a step")
            )
            rows.append(
                judged(
                    case.name, {**setting, "step/limit": factor}, f"largest over first displacement, {_STEPS} steps", bound,
                    None, partial(_growth, op, factor * limit),
                )
            )  # fmt: skip
    return rows


def _limit(op: HexOperator) -> float:
    """2 / (fastest angular frequency of the mesh) [s], from all its eigenvalues."""
    mass = np.repeat(op.lumped_mass(), 3)
    scaled = op.stiffness().toarray() / np.sqrt(mass[:, None] * mass)
    return float(2.0 / np.sqrt(np.linalg.eigvalsh(scaled)[-1]))


def _share(op: HexOperator, limit: float) -> Measured:
    return op.stable_step() / limit, None


def _growth(op: HexOperator, dt: float) -> Measured:
    rng = np.random.default_rng(3)
    u = rng.standard_normal(op.points.shape) * 1e-12
    mass = op.lumped_mass()
    u -= np.average(u, axis=0, weights=mass)
    v, first = np.zeros_like(u), float(np.abs(u).max())
    op.advance(u, v, np.zeros_like(u), 1.0 / mass, dt, _STEPS)
    return float(np.abs(u).max() / first), None


def slender_bar(case: Case, registry: Registry) -> list[Row]:
    """A bar of slender elements under tension: its lengthening F l / E A, exact for any element."""
    aspect, poisson, young = (case.arguments[name] for name in ("aspect", "poisson", "young"))
    length, side, force = 4e-3 * aspect, 3e-3, 1.0
    points, cells = _block((4, 3, 3), (length, side, side))
    rows = []
    for kind in KINDS:
        op = HexOperator(points, cells, young, poisson, _DENSITY, kind)

        def lengthening(o: HexOperator = op) -> Measured:
            # The end faces' nodes take the shares of a uniform traction.
            end = points[:, 0] > length * (1.0 - 1e-12)
            load = np.zeros_like(points)
            load[end, 0] = force * _shares(points[end, 1:], side)
            held = np.zeros(points.shape, dtype=bool)
            held[points[:, 0] == 0.0, 0] = True
            held[points[:, 1] == 0.0, 1] = held[points[:, 2] == 0.0, 2] = True
            found = solve_static(o.stiffness(), points, load, held, tolerance=1e-7).displacement
            return float(found[end, 0].mean()), None

        close = Near(1e-5, "constant strain is exact in every element; the matrix's condition costs up to ten digits")
        setting = {"elements": kind, "aspect": aspect, "poisson": poisson, "young": young}
        predicted = force * length / (young * side**2)
        rows.append(judged(case.name, setting, "lengthening [m]", close, predicted, lengthening))
    return rows


def locking(case: Case, registry: Registry) -> list[Row]:
    """A nearly incompressible cantilever: elements that bend, and elements that are known to lock."""
    rows = []
    beam = _tip("mean_dilatation", 0.3)
    for kind in KINDS:
        setting = {"elements": kind, "poisson": 0.4999}
        if kind == "full":
            bound: AtMost | AtLeast = AtMost(0.75, "full integration locks: why it is not the default")
        elif kind == "one_point":
            bound = AtMost(
                0.75, "its hourglass control is a share of lambda + 2 mu, which grows without limit: it locks, too"
            )
        else:
            bound = AtLeast(0.8, "E is the same, so that the deflection hardly depends on Poisson's ratio")
        quantity = "tip deflection over that at Poisson's ratio 0.3, E the same"
        rows.append(judged(case.name, setting, quantity, bound, None, partial(_bends, kind, beam)))
    return rows


def _bends(kind: str, beam: float) -> Measured:
    return _tip(kind, 0.4999) / beam, None


def _tip(kind: str, poisson: float) -> float:
    points, cells = _block((16, 4, 4), (8.0, 1.0, 1.0))
    op = HexOperator(points, cells, 1.0, poisson, 1.0, kind)
    end = points[:, 0] > 8.0 - 1e-9
    load = np.zeros_like(points)
    load[end, 2] = 1.0 / end.sum()
    held = np.repeat(points[:, :1] < 1e-9, 3, axis=1)
    return float(solve_static(op.stiffness(), points, load, held, tolerance=1e-6).displacement[end, 2].mean())


def soft_on_hard(case: Case, registry: Registry) -> list[Row]:
    """Rubber bonded on ceramic, pressed flat between plates that slide: uniform stress, strains in series."""
    hard, soft, side, force = 310e9, 2e6, 1e-3, 1.0
    points, cells = _block((8, 3, 3), (8 * side, 3 * side, 3 * side))
    half = points[cells].mean(axis=1)[:, 0] > 4 * side
    rows = []
    for kind in KINDS:

        def shortening(k: str = kind) -> Measured:
            matrix = sum(
                HexOperator(points, cells[part], young, 0.0, 1000.0, k).stiffness()
                for part, young in ((half, soft), (~half, hard))
            )
            end = points[:, 0] > 8 * side * (1.0 - 1e-12)
            load = np.zeros_like(points)
            load[end, 0] = -force * _shares(points[end, 1:], 3 * side)
            held = np.zeros(points.shape, dtype=bool)
            held[points[:, 0] == 0.0, 0] = True
            held[points[:, 1] == 0.0, 1] = held[points[:, 2] == 0.0, 2] = True
            found = solve_static(matrix.tocsr(), points, load, held, tolerance=1e-7).displacement
            return float(-found[end, 0].mean()), None

        predicted = force * 4 * side / (9 * side**2) * (1.0 / hard + 1.0 / soft)
        close = Near(1e-6, "uniform stress is exact; the stiffnesses differ by 1.6e5")
        rows.append(
            judged(
                case.name, {"elements": kind, "ratio of moduli": hard / soft}, "shortening [m]", close, predicted, shortening
            )
        )
    return rows


def bad_elements(case: Case, registry: Registry) -> list[Row]:
    """An element turned inside out, and one without a volume."""
    points, cells = _block((1, 1, 1), (1.0, 1.0, 1.0))
    rows = []
    for name, moved in (("inside out", -2.0), ("flat", -1.0)):
        bad = points.copy()
        bad[points[:, 0] == 1.0, 0] += moved

        def build(p: np.ndarray = bad) -> float:
            return HexOperator(p, cells, _YOUNG, _POISSON, _DENSITY).stable_step()

        rows.append(
            refused(
                case.name,
                {"element": name},
                "inverted or degenerate",
                f"{MeshError.__name__}: such an element has no mass",
                build,
            )
        )
    return rows


def _shares(places: np.ndarray, side: float) -> np.ndarray:
    """Shares of nodes (n, 2) of a uniform grid in a uniform traction on a square."""
    edge = (np.isclose(places, 0.0, atol=1e-9 * side) | np.isclose(places, side)).sum(axis=1)
    share = 0.5**edge
    return np.asarray(share / share.sum())


def _block(counts: tuple[int, int, int], sides: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3) and cells (m, 8) of a box, x running fastest."""
    axes = [np.linspace(0.0, side, count + 1) for count, side in zip(counts, sides, strict=True)]
    z, y, x = np.meshgrid(axes[2], axes[1], axes[0], indexing="ij")
    k, j, i = np.meshgrid(*(np.arange(count) for count in counts[::-1]), indexing="ij")
    row, layer = counts[0] + 1, (counts[0] + 1) * (counts[1] + 1)
    n = (k * layer + j * row + i).ravel()
    cells = np.stack([n, n + 1, n + 1 + row, n + row], axis=1)
    return np.stack([x, y, z], axis=-1).reshape(-1, 3), np.concatenate([cells, cells + layer], axis=1)
