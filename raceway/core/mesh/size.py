"""Cells and bytes of a mesh before it is made, and refusal of sizes that cannot work."""

from __future__ import annotations

from collections.abc import Mapping

import attrs

from raceway.errors import MeshError

#: Bytes a cell that a mesh keeps: points, cells, sets (92 to 104 measured, more where sets are many).
BYTES_KEPT = 110
#: Bytes a cell beside them while a structured mesh is made and judged (80 to 103 measured, 1.1 and 0.5 million cells).
BYTES_BESIDE = 120
#: Above this a mesh is refused [bytes].
MEMORY_LIMIT = 4 * 2**30


@attrs.frozen
class Prediction:
    """Size of meshes that have not been made.

    Attributes
    ----------
    bodies : name of the body -> number of hexahedra
    beside_bytes : what is needed at the peak beside the meshes themselves
    """

    bodies: dict[str, int]
    beside_bytes: int

    @classmethod
    def of(cls, bodies: Mapping[str, float], beside_bytes: float | None = None) -> Prediction:
        """The prediction for bodies of so many cells; by default with what a structured mesh needs beside."""
        if beside_bytes is None:
            beside_bytes = BYTES_BESIDE * sum(bodies.values())
        return cls({name: int(cells) for name, cells in bodies.items()}, int(beside_bytes))

    @property
    def cells(self) -> int:
        """Hexahedra of all bodies."""
        return sum(self.bodies.values())

    @property
    def memory_bytes(self) -> int:
        """Bytes at the peak, while the meshes are made and judged."""
        return sum(map(body_bytes, self.bodies.values())) + self.beside_bytes


def body_bytes(cells: int) -> int:
    """Bytes that a mesh of so many cells keeps."""
    return BYTES_KEPT * cells


def refuse_memory(prediction: Prediction, key: str, value: float | str, remedy: str) -> None:
    """Refuse what will not fit.

    Raises
    ------
    MeshError
        With the predicted number of elements and bytes.
    """
    if prediction.memory_bytes > MEMORY_LIMIT:
        raise MeshError.at(
            key,
            value,
            f"would give about {float(prediction.cells):.3g} elements and take {prediction.memory_bytes / 2**30:.3g} GiB, above "
            f"{MEMORY_LIMIT / 2**30:.0f} GiB: {remedy}",
        )


def refuse_coarse(size: float, wall: float, where: str) -> None:
    """Refuse elements that are larger than what they shall fill.

    Raises
    ------
    MeshError
        With both numbers.
    """
    if size > wall:
        raise MeshError.at(
            "mesh.element_size", size, f"is larger than the {where}, {wall:.4g} m: take no more than that, in metres"
        )
