"""Input files of Abaqus and CalculiX: nodes, hexahedra, *NSET and *SURFACE."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any, ClassVar

import attrs
import numpy as np

from raceway.core.mesh import HexMesh
from raceway.errors import MeshError
from raceway.plugins.formats import _exchange as exchange


@attrs.frozen
class Abaqus:
    """Hexahedral meshes as .inp; facet sets are element surfaces, faces S1 to S6. Sets of whole elements are not kept."""

    name: ClassVar[str] = "abaqus"
    suffixes: ClassVar[tuple[str, ...]] = (".inp",)

    def read(self, path: Any) -> HexMesh:
        """A mesh; raises ``MeshError`` for files that are unreadable or without hexahedra."""
        content = exchange.load(path, exchange.meshio().abaqus.read)
        cells, first = exchange.hexahedra(path, content)
        members = {name.lower(): _members(blocks, first) for name, blocks in content.cell_sets.items()}
        surfaces = list(_surfaces(Path(path).read_text(encoding="utf-8")))
        facets = {name: _facets(path, name, lines, members) for name, lines in surfaces}
        used = {line[0].lower() for _, lines in surfaces for line in lines}
        left = sorted(name for name, found in members.items() if name not in used and len(found) < len(cells))
        if left:
            warnings.warn(
                f"'{path}': element sets {', '.join(left)} are not taken over: what is used are sets of nodes (*NSET) and of "
                "faces (*SURFACE)",
                stacklevel=2,
            )
        return exchange.used_only(path, content.points, cells, content.point_sets, facets)

    def write(self, path: Any, what: HexMesh) -> None:
        """Write a mesh; each facet set as element sets NAME_S1 to NAME_S6 and the *SURFACE made of them."""
        package = exchange.meshio()
        sets, text = {}, ""
        for name, facets in what.facet_sets.items():
            text += f"*SURFACE, NAME={name}, TYPE=ELEMENT\n"
            for face in np.unique(facets[:, 1]):
                word = f"{name}_S{face + 1}"
                sets[word] = [facets[facets[:, 1] == face, 0]]
                text += f"{word}, S{face + 1}\n"
        content = package.Mesh(what.points, [("hexahedron", what.cells)], point_sets=what.node_sets, cell_sets=sets)
        exchange.store(path, package.abaqus.write, content)
        with Path(path).open("a", encoding="utf-8") as file:
            file.write(text)

    def example_content(self) -> HexMesh:
        return exchange.example()


def _members(blocks: Any, first: list[int | None]) -> np.ndarray:
    """(k,) hexahedra of an element set, which meshio gives block by block."""
    parts = [np.asarray(b, dtype=int) + start for b, start in zip(blocks, first, strict=False) if start is not None]
    return np.concatenate(parts) if parts else np.zeros(0, dtype=int)


def _surfaces(text: str) -> Iterator[tuple[str, list[tuple[str, str]]]]:
    """Name and lines (element set, face) of each element surface."""
    for head, body in re.findall(r"^\*SURFACE\s*,([^\n]*)\n((?:(?!\*)[^\n]*\n?)*)", text, re.MULTILINE | re.IGNORECASE):
        words = dict(word.strip().split("=", 1) for word in head.split(",") if "=" in word)
        options = {key.strip().upper(): value.strip() for key, value in words.items()}
        if options.get("TYPE", "ELEMENT").upper() == "ELEMENT" and "NAME" in options:
            lines = [tuple(part.strip() for part in line.split(",")[:2]) for line in body.splitlines() if line.strip()]
            yield options["NAME"], lines


def _facets(path: Any, name: str, lines: list[tuple[str, str]], members: dict[str, np.ndarray]) -> np.ndarray:
    found = [np.zeros((0, 2), dtype=int)]
    for line in lines:
        word, face = (*line, "")[:2]
        if word.lower() not in members or not re.fullmatch(r"[sS][1-6]", face):
            raise MeshError(
                f"'{path}': surface '{name}' has the line '{', '.join(line)}'; it must be the name of an *ELSET and a face S1 "
                f"to S6. Known element sets: {', '.join(sorted(members)) or 'none'}"
            )
        chosen = members[word.lower()]
        found.append(np.column_stack([chosen, np.full(len(chosen), int(face[1]) - 1)]))
    return np.concatenate(found)
