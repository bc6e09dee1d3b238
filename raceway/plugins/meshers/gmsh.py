"""Solids meshed by Gmsh: STEP and BREP files, or scripts of Gmsh, as hexahedra."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import attrs
import numpy as np

from raceway.errors import MeshError
from raceway.options import one_of, option, positive
from raceway.plugins.meshers._bodies import bodies, refuse_no_body, with_node_sets

if TYPE_CHECKING:
    from raceway.core.mesh import HexMesh

_SOLIDS = {4: "tetrahedra", 5: "hexahedra", 6: "prisms", 7: "pyramids"}
_SUFFIXES = (".step", ".stp", ".brep", ".geo")


@attrs.frozen
class Gmsh:
    """Hexahedra from solids (.step, .stp, .brep, .geo) by the program Gmsh, one file for each body."""

    name: ClassVar[str] = "gmsh"

    inner_ring: str | None = option(None, help="solid of the inner ring, in the bearing's coordinates", path=True)
    outer_ring: str | None = option(None, help="solid of the outer ring, in the bearing's coordinates", path=True)
    ball: str | None = option(
        None, help="solid of one ball about its centre: x rolling, y across, z towards the outer contact", path=True
    )
    element_size: float = option(1e-3, unit="m", help="aimed at", rule=positive())
    method: str = option(
        "transfinite",
        help="'transfinite': six-sided volumes; 'subdivision': tetrahedra, each split in 4; 'as_written': the .geo's own",
        rule=one_of("transfinite", "subdivision", "as_written"),
    )
    scale: float = option(
        1.0, unit="m", help="one unit of .geo and .brep files; STEP files name their own unit", rule=positive()
    )

    def __attrs_post_init__(self) -> None:
        refuse_no_body(self)

    @classmethod
    def examples(cls) -> list[Gmsh]:
        """A coarse ring of the package's data."""
        path = str(files("raceway").joinpath("data/meshes/ring.geo"))
        return [cls(inner_ring=path, scale=1e-3, method="as_written")]

    def mesh(self, bearing: Any) -> dict[str, HexMesh]:
        """Meshes of the bodies that have files, renumbered; physical surfaces, or else all surfaces, become sets.

        Raises
        ------
        MeshError
            Gmsh is absent, files cannot be read or meshed with hexahedra, elements are too large or too small.
        """
        return bodies(self, bearing, self._body)

    def _body(self, body: str, path: str) -> HexMesh:
        from raceway.core.mesh_quality import refuse_bad_cells

        suffix = Path(path).suffix.lower()
        if suffix not in _SUFFIXES:
            raise MeshError(f"'{path}': mesh.kind = 'gmsh' reads {', '.join(_SUFFIXES)}, not '{suffix}'")
        if not Path(path).is_file():
            raise MeshError(f"'{path}' does not exist")
        if suffix in (".step", ".stp"):
            with Path(path).open("rb") as file:  # Gmsh's reader would write its complaints to standard output
                if b"ISO-10303-21" not in file.read(4096):
                    raise MeshError(f"'{path}' cannot be read: it is not a STEP file (no ISO-10303-21 at its beginning)")
        try:
            import gmsh
        except (ImportError, OSError) as why:  # OSError: its library lacks a system library
            raise MeshError(f"mesh.kind = 'gmsh' needs the package gmsh: pip install 'raceway[gmsh]' ({why})") from why
        gmsh.initialize([], readConfigFiles=False, interruptible=False)
        try:
            mesh = self._meshed(gmsh, path, 1.0 if suffix in (".step", ".stp") else self.scale)
        except MeshError:
            raise
        except Exception as why:  # gmsh raises plain exceptions for all it fails at
            raise MeshError(f"'{path}' cannot be meshed: {why}") from why
        finally:
            gmsh.finalize()
        refuse_bad_cells(mesh, f"{body} ({Path(path).name})")
        return with_node_sets(mesh.renumbered())

    def _meshed(self, gmsh: Any, path: str, scale: float) -> HexMesh:
        from raceway.core.mesh import HexMesh
        from raceway.plugins.formats._exchange import facets_of_quads

        number = gmsh.option.setNumber
        number("General.Terminal", 0)
        gmsh.option.setString("Geometry.OCCTargetUnit", "M")
        gmsh.open(path)
        if not gmsh.model.getEntities(3):
            raise MeshError(f"'{path}' holds no solid")
        size = self.element_size / scale
        self._refuse_sizes(gmsh, path, scale)
        for word, value in (("MeshSizeMax", size), ("RandomSeed", 1), ("ElementOrder", 1), ("Optimize", 1)):
            number(f"Mesh.{word}", value)
        if self.method == "transfinite":
            number("Mesh.MeshSizeMin", size)
            gmsh.model.mesh.setTransfiniteAutomatic()
        elif self.method == "subdivision":
            number("Mesh.MeshSizeMax", 2.0 * size)
            number("Mesh.SubdivisionAlgorithm", 2)
        gmsh.model.mesh.generate(3)
        cells = self._hexahedra(gmsh, path)
        tags, coordinates, _ = gmsh.model.mesh.getNodes()
        place = np.full(int(tags.max()) + 1, -1)
        used = np.isin(tags, cells)
        place[tags[used].astype(int)] = np.arange(used.sum())
        points = scale * coordinates.reshape(-1, 3)[used]
        quads = {}
        for name, surfaces in _surfaces(gmsh).items():
            found = [gmsh.model.mesh.getElementsByType(3, surface)[1].reshape(-1, 4) for surface in surfaces]
            quads[name] = place[np.concatenate(found).astype(int)]
        own = place[cells]
        return HexMesh(points, own, {}, {name: facets_of_quads(path, own, q) for name, q in quads.items() if len(q)})

    def _refuse_sizes(self, gmsh: Any, path: str, scale: float) -> None:
        from raceway.core.meshing.size import Prediction, refuse_coarse, refuse_memory

        box = scale * np.array(gmsh.model.getBoundingBox(-1, -1)).reshape(2, 3)
        if self.method == "as_written":
            return
        refuse_coarse(self.element_size, float(np.ptp(box, axis=0).min()), f"smallest extent of '{Path(path).name}'")
        try:
            volume = sum(gmsh.model.occ.getMass(3, tag) for _, tag in gmsh.model.getEntities(3)) * scale**3
        except Exception:  # a built-in geometry kernel knows no volumes: its box bounds them
            volume = float(np.ptp(box, axis=0).prod())
        predicted = Prediction.of(volume / self.element_size**3)
        refuse_memory(predicted, "mesh.element_size", self.element_size, "take larger elements")

    def _hexahedra(self, gmsh: Any, path: str) -> np.ndarray:
        """(m, 8) node tags of the hexahedra; ``MeshError`` where there is any other solid."""
        types, elements, nodes = gmsh.model.mesh.getElements(3)
        counts = {_SOLIDS.get(int(t), f"solids of type {t}"): len(e) for t, e in zip(types, elements, strict=True)}
        others = {word: count for word, count in counts.items() if word != "hexahedra"}
        if others or not counts:
            told = ", ".join(f"{count} {word}" for word, count in others.items()) or "no solid elements"
            remedy = {
                "transfinite": "use method = 'subdivision', or cut the solid into volumes with six four-sided faces",
                "subdivision": "cut the solid into simpler volumes",
                "as_written": "give every volume 'Transfinite Volume' and 'Recombine Surface', or use method = 'subdivision'",
            }[self.method]
            raise MeshError(
                f"'{path}' cannot be meshed with hexahedra by method = '{self.method}': {told} came out; {remedy}"
            )
        return np.asarray(nodes[0].reshape(-1, 8).astype(np.int64))


def _surfaces(gmsh: Any) -> dict[str, list[int]]:
    """Name -> surfaces: the physical groups, or where there are none, each outer surface by its number."""
    groups = {}
    for dimension, tag in gmsh.model.getPhysicalGroups(2):
        name = gmsh.model.getPhysicalName(dimension, tag) or f"physical_{tag}"
        groups[name] = [int(t) for t in gmsh.model.getEntitiesForPhysicalGroup(dimension, tag)]
    if groups:
        return groups
    outer = gmsh.model.getBoundary(gmsh.model.getEntities(3), combined=True, oriented=False)
    return {f"surface_{tag}": [int(tag)] for _, tag in sorted(outer)}
