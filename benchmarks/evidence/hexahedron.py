"""The hexahedron: what each formulation fulfils, and the speed of its kernels."""

from __future__ import annotations

import numpy as np
from scipy.sparse import diags_array
from scipy.sparse.linalg import eigsh

from benchmarks.evidence import Row, below
from benchmarks.kernel import STEEL, measure
from raceway import load_scene
from raceway.core.hexahedron.operator import HexOperator
from raceway.core.hexahedron.strain import KINDS
from raceway.plugins.meshers.structured import Structured
from validation.hexahedra import distorted, errors

TITLE = "Hexahedra: correctness and speed"
COMMAND = "pytest tests/hexahedron"
SPEED = "python -m benchmarks.kernel --json"
#: A linear displacement, u = SLOPES x.
SLOPES = np.array([[1.0, 0.3, -0.2], [0.1, -0.7, 0.5], [0.4, 0.2, 0.6]])


def rows() -> list[Row]:
    return [row for kind in KINDS for row in _formulation(kind)] + _step() + _speed()


def _formulation(kind: str) -> list[Row]:
    points, cells, inner = distorted((4, 4, 4))
    op = HexOperator(points, cells, *STEEL, kind)
    K, exact, free = op.stiffness().toarray(), (points @ SLOPES.T).ravel(), np.repeat(inner, 3)
    u = exact.copy()
    u[free] = np.linalg.solve(K[np.ix_(free, free)], -K[np.ix_(free, ~free)] @ u[~free])
    patch = float(np.abs(u - exact).max() / np.abs(exact).max())
    noise = np.random.default_rng(0).standard_normal(points.shape)
    force = op.internal_force(noise)
    kernel = float(np.abs(K @ noise.ravel() - force.ravel()).max() / np.abs(force).max())
    modes = np.linalg.eigvalsh(K)
    zero = int(np.sum(np.abs(modes) <= 1e-12 * modes[-1]))
    rates = np.log2(errors(kind, 8) / errors(kind, 16))
    return [
        below(f"patch test on a distorted mesh, {kind}: error of the displacement", patch, 1e-12, COMMAND),
        below(f"assembled stiffness against the force kernel, {kind}: difference", kernel, 1e-13, COMMAND),
        Row(
            f"zero-energy modes, {kind}",
            zero,
            "6",
            zero == 6,
            COMMAND,
            f"the seventh: {modes[6] / modes[-1]:.1e} of the last",
        ),
        Row(f"rate of the error in L2, {kind}", float(rates[0]), "2 within 0.1", abs(rates[0] - 2.0) <= 0.1, COMMAND),
        Row(f"rate of the error in H1, {kind}", float(rates[1]), "1 within 0.1", abs(rates[1] - 1.0) <= 0.1, COMMAND),
    ]


def _step() -> list[Row]:
    """The step from single elements over 2 / w of the assembled mesh, w its largest angular frequency."""
    bearing = load_scene("examples/minimal.toml").bearing
    meshes = Structured(element_size=1.2e-3, nodes_per_semi_axis=2, growth=1.6).mesh(bearing)
    cases = {
        "equal cubes": distorted((8, 8, 8), 0.0)[:2],
        "distorted cubes": distorted((8, 8, 8))[:2],
        "graded inner ring": (meshes["inner_ring"].points, meshes["inner_ring"].cells),
        "graded ball": (meshes["ball_00"].points, meshes["ball_00"].cells),
    }
    out = []
    for name, (points, cells) in cases.items():
        op = HexOperator(points, cells, *STEEL)
        root = diags_array(1.0 / np.sqrt(np.repeat(op.lumped_mass(), 3)))
        start = np.random.default_rng(0).standard_normal(points.size)
        square = eigsh(root @ op.stiffness() @ root, 1, which="LA", v0=start, tol=1e-6, return_eigenvectors=False)[0]
        ratio = float(op.stable_step() * np.sqrt(square) / 2.0)
        out.append(below(f"stable step over the mesh's own, {name} ({len(cells)})", ratio, 1.0 + 1e-6, COMMAND))
    return out


def _speed() -> list[Row]:
    found = measure()
    out = []
    for row in found["rows"]:
        size = f"{row['elements']:.2g} elements"
        note = f"{row['ns_per_element']:.0f} ns an element; the triad of the same run: {found['triad_gb_s']:.1f} GB/s"
        csr = f"{row['csr_ns_per_element']:.0f} ns; {row['csr_bytes_per_element']:.0f} bytes an element"
        loop = f"{row['readable_ns_per_element']:.0f} ns with the gradient at the centre"
        shuffled = f"{row['random_numbering_ns_per_element']:.0f} ns before renumbering"
        out += [
            _above(f"assembled product over force kernel, {size}", row["csr_over_force"], 2.5, f"{csr}; force {note}"),
            _above(f"readable loop over force kernel, {size}", row["readable_over_force"], 5.0, loop),
            below(f"explicit step over force alone, {size}", row["step_over_force"], 2.0, SPEED),
            below(f"random numbering, renumbered, over ordered, {size}", row["renumbered_over_force"], 1.2, SPEED, shuffled),
            below(f"memory of the explicit step, {size}: bytes an element", row["bytes_per_element"], 1000.0, SPEED),
        ]
        threads = row["two_threads_ns_per_element"]
        shown = threads if isinstance(threads, str) else f"{threads:.1f} ns an element"
        out.append(Row(f"force with two threads, {size}", shown, "for information", True, SPEED))
    return out


def _above(quantity: str, value: float, bound: float, note: str) -> Row:
    return Row(quantity, float(value), f"at least {bound:g}", value >= bound, SPEED, note)
