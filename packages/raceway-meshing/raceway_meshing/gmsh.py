"""Solids meshed by Gmsh, as hexahedra: STEP and BREP files, which are data.

Nothing is opened by ``gmsh.open``: it executes the .geo language, and for a file of any format the options beside it
(part.step.opt), which are the same language.
"""

import ctypes
import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.resources import files
from pathlib import Path
from types import ModuleType
from typing import ClassVar, TypeVar

import attrs
import numpy as np

from raceway import MeshError, one_of, option, positive
from raceway.extend import Bearing, HexMesh, Prediction, lacking
from raceway_meshing.formats import facets_of_quads, readable
from raceway_meshing.mesh_files import BODIES, ball_path, bodies, file_unit, refuse_no_body, ring_path, with_node_sets

_SOLIDS = {4: "tetrahedra", 5: "hexahedra", 6: "prisms", 7: "pyramids"}
#: Endings of files and OpenCASCADE's readers for them.
_READERS = {".step": "step", ".stp": "step", ".brep": "brep"}
_MILLIMETRE = 1e-3
#: Debian's packages that gmsh lacks; the Makefile's APT_PACKAGES contain them all.
DEBIAN = (
    "libfontconfig1", "libgl1", "libglu1-mesa", "libgomp1", "libxcursor1", "libxext6", "libxfixes3", "libxft2",
    "libxinerama1", "libxrender1",
)  # fmt: skip
#: Hexahedra of tetrahedra of twice the element's size, split in four, for each cube of that size (2.4 to 3 measured).
_SPLIT = 3.0
#: What Gmsh and the taking over of its mesh need beside the meshes: as such [bytes], and a cell (1450 to 1700 measured).
_BESIDE_BYTES, _BYTES_BESIDE = 30 * 2**20, 1800
Found = TypeVar("Found")


@attrs.frozen
class Gmsh:
    """Hexahedra from solids (.step, .stp, .brep) by the program Gmsh, one file for each body."""

    name: ClassVar[str] = "gmsh"

    inner_ring: str | None = ring_path("inner")
    outer_ring: str | None = ring_path("outer")
    ball: str | None = ball_path()
    element_size: float = option(1e-3, unit="m", help="aimed at", rule=positive())
    method: str = option(
        "transfinite",
        help="'transfinite': six-sided volumes; 'subdivision': tetrahedra, each split in 4",
        rule=one_of("transfinite", "subdivision"),
    )
    scale: float = file_unit(".brep files (STEP files name their own)")

    def __attrs_post_init__(self) -> None:
        refuse_no_body(self)

    @classmethod
    def examples(cls) -> "list[Gmsh]":
        """A coarse ring of the package's data."""
        path = str(files("raceway_meshing").joinpath("data/meshes/ring.brep"))
        return [cls(inner_ring=path, scale=1e-3, element_size=2e-3)]

    def mesh(self, bearing: Bearing) -> dict[str, HexMesh]:
        """Meshes of the bodies that have files, renumbered; physical surfaces, or else all surfaces, become sets.

        MeshError: Gmsh or its system libraries are absent, files cannot be read or meshed with hexahedra, elements are too large or
            too small.
        """
        from raceway.extend import refuse_bad_cells

        self.predict(bearing)  # refuses what cannot work

        def body(name: str, path: str) -> HexMesh:
            mesh = self._with_model(path, self._mesh_of)
            refuse_bad_cells(mesh, f"{name} ({Path(path).name})")
            return with_node_sets(mesh.renumbered())

        return bodies(self, bearing, body)

    def predict(self, bearing: Bearing) -> Prediction | None:
        """Size of the meshes from the solids' volumes and, but for 'subdivision', the divisions of their edges.

        MeshError: Gmsh is absent, files cannot be read, elements are too large or too small.

        Six-sided volumes of transfinite edges are counted exactly: of the numbers of cells along twelve edges, each of the
        three directions' occurs four times.
        """
        from raceway.extend import ball_names, refuse_memory

        cells: dict[str, float] = {}
        prediction: Prediction | None = None
        for body in BODIES:
            path = getattr(self, body)
            if path is None:
                continue
            _refuse_file(path)
            count = self._with_model(path, self._cells)
            cells.update(dict.fromkeys(ball_names(bearing) if body == "ball" else [body], count))
            # Bodies are made one after the other: the largest sets what Gmsh holds beside the meshes.
            prediction = Prediction.of(cells, _BESIDE_BYTES + _BYTES_BESIDE * max(cells.values()))
            refuse_memory(prediction, "mesh.element_size", self.element_size, "take larger elements")
        return prediction

    def _with_model(self, path: str, work: Callable[[ModuleType, str, float], Found]) -> Found:
        """What ``work(gmsh, path, scale)`` finds with the file open in Gmsh; all its failures are ``MeshError``."""
        _refuse_file(path)
        reader = _READERS[Path(path).suffix.lower()]
        try:
            import gmsh
        except OSError as why:  # of the loader of its library
            raise MeshError(f"mesh.kind = 'gmsh' cannot be used: {lacking('gmsh', DEBIAN)} ({why})") from why
        with signals_as_before():
            gmsh.initialize([], readConfigFiles=False, interruptible=False)
        try:
            gmsh.option.setNumber("General.Terminal", 0)
            gmsh.option.setString("Geometry.OCCTargetUnit", "MM")  # OpenCASCADE's own, which outlives this session
            with _silent_reader():
                gmsh.model.occ.importShapes(path, format=reader)
                gmsh.model.occ.synchronize()
            if not gmsh.model.getEntities(3):
                raise MeshError(f"'{path}' holds no solid")
            return work(gmsh, path, _MILLIMETRE if reader == "step" else self.scale)
        except MeshError:
            raise
        except Exception as why:  # gmsh raises plain exceptions for all it fails at
            raise MeshError(f"'{path}' cannot be meshed: {why}") from why
        finally:
            gmsh.finalize()

    def _mesh_of(self, gmsh: ModuleType, path: str, scale: float) -> HexMesh:
        self._set_sizes(gmsh, scale)
        gmsh.model.mesh.generate(3)
        # (m, 8) node tags of the hexahedra; ``MeshError`` where there is any other solid
        types, elements, nodes = gmsh.model.mesh.getElements(3)
        counts = {_SOLIDS.get(int(t), f"solids of type {t}"): len(e) for t, e in zip(types, elements, strict=True)}
        foreign = {word: count for word, count in counts.items() if word != "hexahedra"}
        if foreign or not counts:
            solids = ", ".join(f"{count} {word}" for word, count in foreign.items()) or "no solid elements"
            remedy = {
                "transfinite": "use method = 'subdivision', or cut the solid into volumes with six four-sided faces",
                "subdivision": "cut the solid into simpler volumes",
            }[self.method]
            words = f"'{path}' cannot be meshed with hexahedra by method = '{self.method}': {solids} came out; {remedy}"
            raise MeshError(words)
        cells = np.asarray(nodes[0].reshape(-1, 8).astype(np.int64))
        tags, coordinates, _ = gmsh.model.mesh.getNodes()
        number = np.full(int(tags.max()) + 1, -1)
        in_cells = np.isin(tags, cells)
        number[tags[in_cells].astype(int)] = np.arange(in_cells.sum())
        points = scale * coordinates.reshape(-1, 3)[in_cells]
        quads = {}
        for name, surfaces in _surfaces(gmsh).items():
            parts = [gmsh.model.mesh.getElementsByType(3, surface)[1].reshape(-1, 4) for surface in surfaces]
            quads[name] = number[np.concatenate(parts).astype(int)]
        cells = number[cells]
        return HexMesh(points, cells, {}, {name: facets_of_quads(path, cells, q) for name, q in quads.items() if len(q)})

    def _set_sizes(self, gmsh: ModuleType, scale: float) -> None:
        number, size = gmsh.option.setNumber, self.element_size / scale
        for word, value in (("MeshSizeMax", size), ("RandomSeed", 1), ("ElementOrder", 1), ("Optimize", 1)):
            number(f"Mesh.{word}", value)
        if self.method == "transfinite":
            number("Mesh.MeshSizeMin", size)
            gmsh.model.mesh.setTransfiniteAutomatic()
        elif self.method == "subdivision":
            number("Mesh.MeshSizeMax", 2.0 * size)
            number("Mesh.SubdivisionAlgorithm", 2)

    def _cells(self, gmsh: ModuleType, path: str, scale: float) -> float:
        """Predicted number of hexahedra of the open file."""
        from raceway.extend import refuse_coarse, refuse_memory

        volumes = {tag: gmsh.model.occ.getMass(3, tag) * scale**3 for _, tag in gmsh.model.getEntities(3)}
        box = scale * np.array(gmsh.model.getBoundingBox(-1, -1)).reshape(2, 3)
        refuse_coarse(self.element_size, float(np.ptp(box, axis=0).min()), f"smallest extent of '{Path(path).name}'")
        cubes = sum(volumes.values()) / self.element_size**3
        if self.method == "subdivision":
            return _SPLIT * cubes
        # Before the edges are divided: with tiny elements not even these would fit.
        refuse_memory(Prediction.of({"": cubes}), "mesh.element_size", self.element_size, "take larger elements")
        self._set_sizes(gmsh, scale)
        gmsh.model.mesh.generate(1)
        return float(sum(_cells_between_edges(gmsh, tag, volume / scale**3) for tag, volume in volumes.items()))


def _refuse_file(path: str) -> None:
    """``MeshError`` for a file of another kind, a missing one, or one that is no STEP file by its beginning."""
    suffix = Path(path).suffix.lower()
    if suffix not in _READERS:
        raise MeshError(f"'{path}': mesh.kind = 'gmsh' reads {', '.join(_READERS)}, not '{suffix}'")
    readable(path)
    if _READERS[suffix] == "step":
        with Path(path).open("rb") as file:
            if b"ISO-10303-21" not in file.read(4096):
                raise MeshError(f"'{path}' cannot be read: it is not a STEP file (no ISO-10303-21 at its beginning)")


@contextmanager
def signals_as_before() -> Iterator[None]:
    """Gmsh gives all signals back to the system: a closed pipe or connection would then end the process without a word."""
    if sys.platform == "win32":
        yield
        return
    sigaction = ctypes.CDLL(None).sigaction
    actions = {number: ctypes.create_string_buffer(256) for number in signal.valid_signals()}  # longer than the structure
    for number, action in actions.items():
        sigaction(int(number), None, action)
    try:
        yield
    finally:
        for number, action in actions.items():
            sigaction(int(number), action, None)


@contextmanager
def _silent_reader() -> Iterator[None]:
    """OpenCASCADE's readers complain on the process's standard output, past Gmsh and Python; what matters is raised."""
    sys.stdout.flush()
    output, nothing = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 1)
    try:
        yield
    finally:
        os.dup2(output, 1)
        os.close(output)
        os.close(nothing)


def _cells_between_edges(gmsh: ModuleType, tag: int, volume: float) -> float:
    """Hexahedra of a volume whose edges are divided already."""
    curves = {abs(c) for _, s in gmsh.model.getBoundary([(3, tag)]) for _, c in gmsh.model.getBoundary([(2, s)])}
    counts, lengths = [], 0.0
    for curve in curves:
        tags, nodes = gmsh.model.mesh.getElementsByType(1, curve)
        tags_of_nodes, places, _ = gmsh.model.mesh.getNodes(1, curve, includeBoundary=True)
        at = {int(n): x for n, x in zip(tags_of_nodes, places.reshape(-1, 3), strict=True)}
        ends = [at[int(n)] for n in nodes]
        counts.append(len(tags))
        lengths += float(np.linalg.norm(np.subtract(ends[::2], ends[1::2]), axis=1).sum()) if len(tags) else 0.0
    if len(counts) == 12 and min(counts) > 0:
        return float(np.prod(np.array(counts, dtype=float)) ** 0.25)
    size = lengths / max(sum(counts), 1)
    return volume / size**3 if size else 0.0


def _surfaces(gmsh: ModuleType) -> dict[str, list[int]]:
    """Name -> surfaces: the physical groups, or where there are none, each outer surface by its number."""
    groups = {}
    for dimension, tag in gmsh.model.getPhysicalGroups(2):
        name = gmsh.model.getPhysicalName(dimension, tag) or f"physical_{tag}"
        groups[name] = [int(t) for t in gmsh.model.getEntitiesForPhysicalGroup(dimension, tag)]
    if groups:
        return groups
    outer = gmsh.model.getBoundary(gmsh.model.getEntities(3), combined=True, oriented=False)
    return {f"surface_{tag}": [int(tag)] for _, tag in sorted(outer)}
