"""The conformance suite of meshers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from raceway.testing.scenes import example_scene
from raceway.testing.suite import Suite, duty, require

if TYPE_CHECKING:
    from raceway.framework.contracts import Mesher

#: Neighbours of each corner of a cell along its three axes.
AROUND = ((1, 3, 4), (2, 0, 5), (3, 1, 6), (0, 2, 7), (7, 5, 0), (4, 6, 1), (5, 7, 2), (6, 4, 3))


class MesherSuite(Suite):
    """Duties of ``raceway.framework.contracts.Mesher``."""

    kind = "mesher"

    @duty("mesh(bearing) returns meshes by name, each with points (n, 3) [m] and cells (m, 8)")
    def test_meshes(self, mesher: Mesher) -> None:
        meshes = mesher.mesh(example_scene().bearing)
        require(isinstance(meshes, Mapping) and meshes, f"mesh() returns {type(meshes).__name__}, not meshes by name")
        for name, mesh in meshes.items():
            points, cells = np.asarray(mesh.points), np.asarray(mesh.cells)
            require(points.ndim == 2 and points.shape[1] == 3, f"'{name}': points of shape {points.shape}, not (n, 3)")
            require(cells.ndim == 2 and cells.shape[1] == 8, f"'{name}': cells of shape {cells.shape}, not (m, 8)")
            require(np.issubdtype(cells.dtype, np.integer), f"'{name}': cells are {cells.dtype}, not integers")
            require(np.isfinite(points).all() and len(points), f"'{name}': points must be finite, and there must be some")
            require(
                len(cells) and cells.min() >= 0 and cells.max() < len(points),
                f"'{name}': cells name points that do not exist",
            )

    @duty("no cell is flat or inside out")
    def test_volumes(self, mesher: Mesher) -> None:
        for name, mesh in mesher.mesh(example_scene().bearing).items():
            corner = np.asarray(mesh.points)[np.asarray(mesh.cells)]
            # Nodes 0 to 3 around the bottom, 4 to 7 above them: the edges at each corner, right-handed.
            for at, ends in enumerate(AROUND):
                edges = corner[:, ends] - corner[:, [at]]
                volume = np.linalg.det(edges)
                require(
                    (volume > 0.0).all(), f"'{name}': {(volume <= 0.0).sum()} of {len(volume)} cells are inside out or flat"
                )

    @duty("sets, where there are some, name nodes (k,) and facets (k, 2) that exist")
    def test_sets(self, mesher: Mesher) -> None:
        for name, mesh in mesher.mesh(example_scene().bearing).items():
            for word, members in getattr(mesh, "node_sets", {}).items():
                nodes = np.asarray(members)
                good = nodes.ndim == 1 and len(nodes) and nodes.min() >= 0 and nodes.max() < len(mesh.points)
                require(good, f"'{name}': node set '{word}' is empty or names points that do not exist")
            for word, members in getattr(mesh, "facet_sets", {}).items():
                facets = np.asarray(members)
                good = facets.ndim == 2 and facets.shape[1] == 2 and len(facets) and facets.min() >= 0
                good = good and facets[:, 0].max() < len(mesh.cells) and facets[:, 1].max() < 6
                require(good, f"'{name}': facet set '{word}' is empty or names faces that do not exist")

    @duty("twice the same bearing gives the same mesh")
    def test_repeats(self, mesher: Mesher) -> None:
        first, second = (mesher.mesh(example_scene().bearing) for _ in range(2))
        require(set(first) == set(second), "the bodies differ")
        for name in first:
            same = np.array_equal(first[name].points, second[name].points) and np.array_equal(
                first[name].cells, second[name].cells
            )
            require(same, f"'{name}' differs")
