"""Meshes that the user brings: a file for each body, balls from the mesh of one ball, sets mapped to the program's names."""

from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from typing import Any, ClassVar

import attrs
import numpy as np

from raceway import MeshError, PluginError, option, positive
from raceway.extend import Bearing, HexMesh, Mesher, blamed, nearest

BODIES = ("inner_ring", "outer_ring", "ball")
BALL = "file of one ball about its centre: x rolling, y across, z towards the outer contact"


def ring_path(ring: str) -> Any:
    """The option that names the file of a ring."""
    return option(None, help=f"file of the {ring} ring, in the bearing's coordinates", path=True)


def ball_path() -> Any:
    """The option that names the file of one ball, from which all are made."""
    return option(None, help=BALL, path=True)


def file_unit(words: str) -> Any:
    """The option that says what one unit of the files is."""
    return option(1.0, unit="m", help=f"one unit of {words}; 1e-3 for millimetres", rule=positive())


def bodies(mesher: Mesher, bearing: Bearing, make: Callable[[str, str], HexMesh]) -> dict[str, HexMesh]:
    """Meshes of the bodies whose paths the mesher's options name; the ball's mesh at each ball's place.

    make : (name of the body, path) -> mesh

    MeshError: A pair of rows, or what ``make`` raises.
    """
    from raceway.extend import azimuth, ball_names, placed

    if len(bearing.rows) > 1:
        raise MeshError(f"mesh.kind = '{mesher.name}' makes one row; use 'structured' for a pair of rows")
    out: dict[str, HexMesh] = {}
    for body in BODIES:
        path = getattr(mesher, body)
        if path is None:
            continue
        mesh = make(body, path)
        if body != "ball":
            out[body] = mesh
            continue
        for index, name in enumerate(ball_names(bearing)):
            out[name] = attrs.evolve(mesh, points=placed(mesh.points, bearing, azimuth(bearing, index)))
    return out


def refuse_no_body(mesher: Mesher) -> None:
    """Raise ``ValueError`` when no body has a path."""
    if all(getattr(mesher, body) is None for body in BODIES):
        raise ValueError(f"names no body: give at least one of {', '.join(f'`{b}`' for b in BODIES)}, each a path")


def with_node_sets(mesh: HexMesh) -> HexMesh:
    """The mesh with a node set for each facet set that has none of its name."""
    from raceway.extend import nodes_of

    more = {name: nodes_of(mesh.cells, f) for name, f in mesh.facet_sets.items() if name not in mesh.node_sets}
    return attrs.evolve(mesh, node_sets={**mesh.node_sets, **more}) if more else mesh


@attrs.frozen
class File:
    """Hexahedra from files of any installed format (.vtu, .inp, .msh), one for each body; [mesh.sets.BODY] names their sets."""

    name: ClassVar[str] = "file"

    inner_ring: str | None = ring_path("inner")
    outer_ring: str | None = ring_path("outer")
    ball: str | None = ball_path()
    scale: float = file_unit("the files")
    sets: dict[str, dict[str, str]] | None = option(
        None, help="for each body: the program's name of a set = its name in the file"
    )

    def __attrs_post_init__(self) -> None:
        refuse_no_body(self)
        for body in self.sets or {}:
            if body not in BODIES or getattr(self, body) is None:
                bodies = [b for b in BODIES if getattr(self, b) is not None]
                raise ValueError(f"`sets.{body}`: there is no such body{nearest(body, bodies)}; given: {', '.join(bodies)}")

    @classmethod
    def examples(cls) -> "list[File]":
        """A coarse ring of the package's data."""
        path = str(files("raceway_meshing").joinpath("data/meshes/ring.inp"))
        return [cls(inner_ring=path, scale=1e-3, sets={"inner_ring": {"raceway": "OUTSIDE"}})]

    def mesh(self, bearing: Bearing) -> dict[str, HexMesh]:
        """Meshes of the bodies that have files, renumbered.

        MeshError: Files that cannot be read or hold other solids, sets that are missing or empty, bad cells.
        """
        return bodies(self, bearing, self._body)

    def _body(self, body: str, path: str) -> HexMesh:
        from raceway.extend import default_registry, refuse_bad_cells

        try:  # the format that has the file's ending, of those that this process knows
            form = default_registry().format_of(path)
        except PluginError as why:
            raise MeshError(str(why)) from None
        with blamed(str(form), "read()"):
            mesh = form.plugin().read(path)
        if not isinstance(mesh, HexMesh):
            raise MeshError(f"'{path}': {form} reads no mesh from it, but {type(mesh).__name__}")
        nodes, facets = dict(mesh.node_sets), dict(mesh.facet_sets)
        for name, file_name in (self.sets or {}).get(body, {}).items():
            try:
                if file_name in facets or file_name not in nodes:
                    facets[name] = mesh.facets(file_name)
                if file_name in nodes:
                    nodes[name] = mesh.nodes(file_name)
            except MeshError as why:
                raise MeshError(f"`mesh.sets.{body}.{name}`: '{path}': {why}") from why
        for kind, sets in (("node", nodes), ("facet", facets)):
            empty = [name for name, members in sets.items() if not len(members)]
            if empty:
                raise MeshError(f"'{path}': {kind} set '{empty[0]}' is empty")
        mesh = attrs.evolve(mesh, points=self.scale * mesh.points, node_sets=nodes, facet_sets=facets)
        refuse_bad_cells(mesh, f"{body} ({Path(path).name})")
        try:
            _refuse_doubled(mesh, f"{body} ({Path(path).name})")
        except MeshError as why:
            if body != "ball":
                raise
            raise MeshError.at(f"mesh.{body}", path, f"{why}. It must be the {BALL}; copies are placed") from why
        return with_node_sets(mesh.renumbered())


def _refuse_doubled(mesh: HexMesh, body: str) -> None:
    """Refuse what cannot be one body: cells that are duplicated, points that coincide and are not one, parts that do not hang together.

    MeshError: How many, and where the first is.
    """
    _, first, counts = np.unique(np.sort(mesh.cells, axis=1), axis=0, return_index=True, return_counts=True)
    if (counts > 1).any():
        cell = int(first[counts > 1].min())
        raise MeshError(f"`{body}`: {int((counts - 1).sum())} cells are duplicated; the first is {cell}: remove the copies")
    points = mesh.points[np.unique(mesh.cells)]
    grain = 1e-9 * float(np.ptp(points, axis=0).max())
    _, first, counts = np.unique(np.round(points / grain), axis=0, return_index=True, return_counts=True)
    if (counts > 1).any():
        where = ", ".join(f"{x:.6g}" for x in points[first[counts > 1].min()])
        raise MeshError(
            f"`{body}`: {int((counts - 1).sum())} points coincide with others without being merged, the first at ({where}) m: "
            "touching parts are not connected there. Merge coincident nodes"
        )
    # Sets of cells that share nodes with no other set
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    count = int(mesh.cells.max()) + 1
    rows, columns = np.repeat(np.arange(len(mesh.cells)), 8), mesh.cells.reshape(-1)
    owns = coo_matrix((np.ones(rows.size, dtype=np.int8), (rows, columns + len(mesh.cells))), (len(mesh.cells) + count,) * 2)
    _, label = connected_components(owns, directed=False)
    parts = len(np.unique(label[: len(mesh.cells)]))
    if parts > 1:
        raise MeshError(f"`{body}`: its cells form {parts} parts that are not connected: give one connected body")
