"""How many cells and bytes a mesh will take, before it is made, and the refusal of sizes that cannot work."""

from __future__ import annotations

import attrs

from raceway.errors import MeshError

#: Bytes a cell while a mesh is made, judged and renumbered: its arrays and the temporary ones beside them.
BYTES_PER_CELL = 500
#: Above this a mesh is refused [bytes].
MEMORY_LIMIT = 4 * 2**30


@attrs.frozen
class Prediction:
    """Size of a mesh that has not been made.

    Attributes
    ----------
    cells : number of hexahedra, all bodies
    memory_bytes : at the peak, while the mesh is made and judged
    """

    cells: int
    memory_bytes: int

    @classmethod
    def of(cls, cells: float) -> Prediction:
        return cls(int(cells), int(cells * BYTES_PER_CELL))


def refuse_memory(prediction: Prediction, key: str, value: float, remedy: str) -> None:
    """Refuse what will not fit.

    Raises
    ------
    MeshError
        With the predicted number of elements and bytes.
    """
    if prediction.memory_bytes > MEMORY_LIMIT:
        raise MeshError(
            f"`{key}` = {value:g} would give about {prediction.cells:.3g} elements and take {prediction.memory_bytes / 2**30:.3g} "
            f"GiB, above {MEMORY_LIMIT / 2**30:.0f} GiB: {remedy}"
        )


def refuse_coarse(size: float, wall: float, where: str) -> None:
    """Refuse elements that are larger than what they shall fill.

    Raises
    ------
    MeshError
        With both numbers.
    """
    if size > wall:
        raise MeshError(
            f"`mesh.element_size` = {size:g} m is larger than the {where}, {wall:.4g} m: take at most half of that, so that "
            "bending has two elements"
        )
