"""Input files of Abaqus and CalculiX: nodes, hexahedra, *NSET and *SURFACE."""

import re
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import ClassVar

import attrs
import numpy as np

from raceway import MeshError, one_of, option
from raceway.extend import HexMesh, memory_for
from raceway_meshing import formats as exchange

#: Element types that both programs know, by this program's word for the hexahedron.
_TYPES = {"one_point": "C3D8R", "full": "C3D8", "incompatible": "C3D8I"}
#: CalculiX reads 20 characters of a number: ten decimals leave room for a sign and an exponent of three figures.
_NUMBER = "%.10e"
#: Entries of a line of *ELSET and *NSET; both programs read at most 16.
_ENTRIES = 16


@attrs.frozen
class Abaqus:
    """Hexahedral meshes as .inp; facet sets are element surfaces, faces S1 to S6. Sets of elements are not stored.

    Coordinates are written with eleven significant figures, and every element belongs to the set EALL, which a section needs.
    """

    name: ClassVar[str] = "abaqus"
    suffixes: ClassVar[tuple[str, ...]] = (".inp",)

    formulation: str = option(
        "incompatible",
        help="element type that is written: 'one_point' C3D8R, 'full' C3D8, 'incompatible' C3D8I, as in bodies.formulation",
        rule=one_of(*_TYPES),
    )

    def read(self, path: Path) -> HexMesh:
        """A mesh; raises ``MeshError`` for files that are unreadable or without hexahedra."""
        exchange.readable(path)
        # A mesh is one file: what *INCLUDE names may be anything, a device without end too.
        with open(path, encoding="utf-8", errors="replace") as stream, memory_for(0):
            for number, line in enumerate(stream, 1):
                if "INCLUDE" in line.upper() and line.partition(",")[0].strip().replace("*", "").upper() == "INCLUDE":
                    raise MeshError(f"'{path}', line {number}: *INCLUDE is not supported: insert what is in that file")
        content = exchange.load(path, exchange.meshio().abaqus.read)
        cells, first = exchange.hexahedra(path, content)
        members = dict[str, np.ndarray]()  # (k,) hexahedra of an element set, which meshio gives block by block
        for name, blocks in content.cell_sets.items():
            parts = [np.asarray(b, dtype=int) + start for b, start in zip(blocks, first, strict=False) if start is not None]
            members[name.lower()] = np.concatenate(parts) if parts else np.zeros(0, dtype=int)
        surfaces = list(_surfaces(Path(path).read_text(encoding="utf-8")))
        facets = {name: _facets(path, name, lines, members) for name, lines in surfaces}
        in_use = {line[0].lower() for _, lines in surfaces for line in lines}
        others = sorted(name for name, elements in members.items() if name not in in_use and len(elements) < len(cells))
        if others:
            warnings.warn(
                f"'{path}': element sets {', '.join(others)} are ignored: only sets of nodes (*NSET) and of faces (*SURFACE) are "
                "read",
                stacklevel=2,
            )
        return exchange.used_only(path, content.points, cells, content.point_sets, facets)

    def write(self, path: Path, mesh: HexMesh) -> None:
        """Write a mesh; each facet set as element sets NAME_S1 to NAME_S6 and the *SURFACE made of them."""
        lines = ["*HEADING", "hexahedra written by raceway", "*NODE"]
        numbers = [", ".join(_NUMBER % x for x in point) for point in mesh.points]
        lines += [f"{number}, {text}" for number, text in enumerate(numbers, 1)]
        lines.append(f"*ELEMENT, TYPE={_TYPES[self.formulation]}, ELSET=EALL")
        lines += [f"{number}, {', '.join(map(str, nodes))}" for number, nodes in enumerate((mesh.cells + 1).tolist(), 1)]
        for name, nodes in mesh.node_sets.items():
            lines += [f"*NSET, NSET={name}", *_entries(nodes)]
        for name, facets in mesh.facet_sets.items():
            faces = np.unique(facets[:, 1])
            for face in faces:
                lines += [f"*ELSET, ELSET={name}_S{face + 1}", *_entries(facets[facets[:, 1] == face, 0])]
            lines.append(f"*SURFACE, NAME={name}, TYPE=ELEMENT")
            lines += [f"{name}_S{face + 1}, S{face + 1}" for face in faces]
        text = "\n".join(lines) + "\n"
        exchange.store(path, lambda target, content: Path(target).write_text(content, encoding="utf-8"), text)

    def example_content(self) -> HexMesh:
        return exchange.example()


def _entries(numbers: np.ndarray) -> Iterator[str]:
    """Lines of a set whose members (k,) are counted from 0."""
    for first in range(0, len(numbers), _ENTRIES):
        yield ", ".join(map(str, (numbers[first : first + _ENTRIES] + 1).tolist()))


def _surfaces(text: str) -> Iterator[tuple[str, list[tuple[str, str]]]]:
    """Name and lines (element set, face) of each element surface."""
    for head, body in re.findall(r"^\*SURFACE\s*,([^\n]*)\n((?:(?!\*)[^\n]*\n?)*)", text, re.MULTILINE | re.IGNORECASE):
        words = dict(word.strip().split("=", 1) for word in head.split(",") if "=" in word)
        options = {key.strip().upper(): value.strip() for key, value in words.items()}
        if options.get("TYPE", "ELEMENT").upper() == "ELEMENT" and "NAME" in options:
            lines = [tuple(part.strip() for part in line.split(",")[:2]) for line in body.splitlines() if line.strip()]
            yield options["NAME"], lines


def _facets(path: Path, name: str, lines: list[tuple[str, str]], members: dict[str, np.ndarray]) -> np.ndarray:
    facets = [np.zeros((0, 2), dtype=int)]
    for line in lines:
        word, face = (*line, "")[:2]
        if word.lower() not in members or not re.fullmatch(r"[sS][1-6]", face):
            raise MeshError(
                f"'{path}': surface '{name}' has the line '{', '.join(line)}'; it must be the name of an *ELSET and a face S1 "
                f"to S6. Known element sets: {', '.join(sorted(members)) or 'none'}"
            )
        elements = members[word.lower()]
        facets.append(np.column_stack([elements, np.full(len(elements), int(face[1]) - 1)]))
    return np.concatenate(facets)
