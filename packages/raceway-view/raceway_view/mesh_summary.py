"""Numbers of meshes: sizes, quality of cells, edges, and facets on the contact patches."""

from collections.abc import Mapping

import numpy as np

from raceway.extend import EDGES, HexMesh, Tables, cell_quality

#: Cells whose edges are measured at a time.
_BLOCK = 65536
#: Sets of facets that meshers name after contacts.
_PATCHES = ("inner_patch", "outer_patch", "band")


def summary(meshes: Mapping[str, HexMesh]) -> Tables:
    """Numbers of every body and of all.

    meshes : name of the body -> mesh

    Returns
    -------
    dict
        ``elements, nodes, memory_bytes, scaled_jacobian{min, mean}, aspect{max, mean}, skew{max, mean}``,
        ``element_size_m{min, mean, max}`` (edges), ``patch_size_m`` (edges on the contact patches: the shorter and the
        longer direction {min, max}, and the depth of the cells below {min, max}; None where no set is named after a
        contact), ``bodies{name: the same}``.

    A body whose array ``cells`` is the very same object as an earlier one's, with edges as long (balls: a rigid motion of
    one mesh), takes that one's numbers over.
    """
    bodies: dict[str, Tables] = {}
    first_names: dict[int, str] = {}
    for name, mesh in meshes.items():
        twin = first_names.setdefault(id(mesh.cells), name)
        # A rigid motion of the same cells leaves a sample of edges as long as it was.
        sample, size = mesh.cells[:: max(len(mesh.cells) // 1000, 1)], float(np.ptp(mesh.points, axis=0).max())
        mine, others = (_edges(one, sample) for one in (mesh, meshes[twin]))
        bodies[name] = bodies[twin] if twin != name and np.allclose(mine, others, 0.0, 1e-9 * size) else _body(mesh)
    weights = np.array([body["elements"] for body in bodies.values()], dtype=float)

    def over(key: str, word: str) -> float:
        values = np.array([body[key][word] for body in bodies.values()])
        return float({"min": values.min, "max": values.max}.get(word, lambda: np.average(values, weights=weights))())

    patches = [body["patch_size_m"] for body in bodies.values() if body["patch_size_m"] is not None]
    return {
        "elements": int(weights.sum()),
        "nodes": sum(body["nodes"] for body in bodies.values()),
        "memory_bytes": sum(body["memory_bytes"] for body in bodies.values()),
        "scaled_jacobian": {word: over("scaled_jacobian", word) for word in ("min", "mean")},
        "aspect": {word: over("aspect", word) for word in ("max", "mean")},
        "skew": {word: over("skew", word) for word in ("max", "mean")},
        "element_size_m": {word: over("element_size_m", word) for word in ("min", "mean", "max")},
        "patch_size_m": _widest(patches),
        "bodies": {name: dict(body) for name, body in bodies.items()},
    }


def _body(mesh: HexMesh) -> Tables:
    measures = cell_quality(mesh)
    least, total, largest = np.inf, 0.0, 0.0
    for first in range(0, len(mesh.cells), _BLOCK):
        length = _edges(mesh, mesh.cells[first : first + _BLOCK])
        least, largest, total = min(least, length.min()), max(largest, length.max()), total + length.sum()
    sizes = {"min": float(least), "mean": float(total / (12 * len(mesh.cells))), "max": float(largest)}
    patches = [_patch(mesh, name) for name in _PATCHES if len(mesh.facet_sets.get(name, ()))]
    return {
        "elements": len(mesh.cells),
        "nodes": len(mesh.points),
        "memory_bytes": mesh.memory_bytes,
        "scaled_jacobian": {"min": float(measures.scaled_jacobian.min()), "mean": float(measures.scaled_jacobian.mean())},
        "aspect": {"max": float(measures.aspect.max()), "mean": float(measures.aspect.mean())},
        "skew": {"max": float(measures.skew.max()), "mean": float(measures.skew.mean())},
        "element_size_m": sizes,
        "patch_size_m": _widest(patches),
    }


def _patch(mesh: HexMesh, name: str) -> dict[str, dict[str, float]]:
    a, b, c, d = np.moveaxis(mesh.points[mesh.facet_nodes(name)], 1, 0)
    sides = [
        0.5 * (np.linalg.norm(b - a, axis=1) + np.linalg.norm(c - d, axis=1)),
        0.5 * (np.linalg.norm(d - a, axis=1) + np.linalg.norm(c - b, axis=1)),
    ]
    area = mesh.facet_areas(name)
    depth = HexMesh(mesh.points, mesh.cells[mesh.facets(name)[:, 0]]).cell_volumes() / area
    values = {"short": np.minimum(*sides), "long": np.maximum(*sides), "depth": depth}
    return {word: {"min": float(v.min()), "max": float(v.max())} for word, v in values.items()}


def _widest(patches: list[dict[str, dict[str, float]]]) -> dict[str, dict[str, float]] | None:
    if not patches:
        return None
    return {k: {"min": min(p[k]["min"] for p in patches), "max": max(p[k]["max"] for p in patches)} for k in patches[0]}


def _edges(mesh: HexMesh, cells: np.ndarray) -> np.ndarray:
    ends = mesh.points[cells[:, EDGES]]
    return np.asarray(np.linalg.norm(ends[:, :, 1] - ends[:, :, 0], axis=2))
