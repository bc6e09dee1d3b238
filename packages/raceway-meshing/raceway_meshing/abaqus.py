"""Input files of Abaqus and CalculiX: nodes, hexahedra, *NSET and *SURFACE."""

import re
import warnings
from collections.abc import Iterator
from io import StringIO
from pathlib import Path
from typing import Any, ClassVar

import attrs
import numpy as np

from raceway import MeshError, one_of, option
from raceway.extend import HexMesh, memory_for
from raceway_meshing import formats as exchange

#: Keyword, options and lines of a part of the file.
Block = tuple[str, dict[str, str], list[str]]
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
        content, blocks = exchange.load(path, _content)
        cells, first = exchange.hexahedra(path, content)
        members = dict[str, np.ndarray]()  # (k,) hexahedra of an element set, which is given block by block
        for name, rows in content.cell_sets.items():
            parts = [np.asarray(b, dtype=int) + start for b, start in zip(rows, first, strict=True) if start is not None]
            members[name.lower()] = np.concatenate(parts) if parts else np.zeros(0, dtype=int)
        surfaces = [
            (options["NAME"], [tuple(part.strip() for part in line.split(",")[:2]) for line in lines])
            for keyword, options, lines in blocks
            if keyword == "SURFACE" and options.get("TYPE", "ELEMENT").upper() == "ELEMENT" and "NAME" in options
        ]
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


def _content(path: Path) -> tuple[Any, list[Block]]:
    """Nodes, elements and their sets, by rows, and the file's blocks.

    meshio is given nodes and elements only: it keeps the last block of nodes alone and puts sets of elements on those of other blocks.
    """
    blocks: list[Block] = []
    for line in map(str.strip, Path(path).read_text(encoding="utf-8").splitlines()):
        if line.startswith("*") and not line.startswith("**"):
            keyword, *words = line[1:].split(",")
            pairs = [word.partition("=")[::2] for word in words]
            blocks.append((keyword.strip().upper(), {key.strip().upper(): value.strip() for key, value in pairs}, []))
        elif line and not line.startswith("**") and blocks:
            blocks[-1][2].append(line)
    text = ["*NODE", *(line for keyword, _, lines in blocks if keyword == "NODE" for line in lines)]
    for keyword, options, lines in blocks:
        if keyword == "ELEMENT":
            text += [f"*ELEMENT, TYPE={options['TYPE'].upper()}", *lines]
    content = exchange.meshio().abaqus.read(StringIO("\n".join(text)))
    cells = iter(content.cells)
    nodes, elements = [np.zeros(0, dtype=int)], list[np.ndarray]()  # numbers in the file, block by block
    sets: dict[str, dict[str, np.ndarray]] = {"NSET": {}, "ELSET": {}}  # numbers of members
    for keyword, options, lines in blocks:
        kind = {"NODE": "NSET", "ELEMENT": "ELSET"}.get(keyword, keyword)
        if kind not in sets:
            continue
        entries = [e for line in lines for e in map(str.strip, line.split(",")) if e and keyword != "NODE"]
        known = {name.lower(): name for name in sets[kind]}
        if keyword == "NODE":
            nodes.append(members := np.array([line.partition(",")[0] for line in lines], dtype=int))
        elif keyword == "ELEMENT":
            width = len(entries) // max(len(next(cells).data), 1)
            elements.append(members := np.array(entries[:: max(width, 1)], dtype=int))
        elif "GENERATE" in options:
            first, last, step = map(int, entries)
            members = np.arange(first, last + 1, step)
        else:  # numbers, and names of other sets
            parts = [sets[kind][known[e.lower()]] if e.lower() in known else np.array([e], dtype=int) for e in entries]
            members = np.concatenate([nodes[0], *parts])
        if name := options.get(kind):
            name = known.get(name.lower(), name)
            sets[kind][name] = np.concatenate([sets[kind].get(name, members[:0]), members])
    for word, numbers in (("node", nodes), ("element", elements)):
        found, counts = np.unique(np.concatenate(numbers), return_counts=True)
        if (counts > 1).any():
            raise ValueError(f"{word} {found[counts > 1][0]} is given twice")
    content.point_sets = {name: np.flatnonzero(np.isin(np.concatenate(nodes), n)) for name, n in sets["NSET"].items()}
    content.cell_sets = {name: [np.flatnonzero(np.isin(e, n)) for e in elements] for name, n in sets["ELSET"].items()}
    return content, blocks


def _facets(path: Path, name: str, lines: list[tuple[str, ...]], members: dict[str, np.ndarray]) -> np.ndarray:
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
