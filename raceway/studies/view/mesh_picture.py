"""A picture of meshes, drawn without a display: a sector of the rings is taken away, so that balls and grooves are seen."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from raceway.core.mesh.hex_mesh import FACES, HexMesh, boundary
from raceway.errors import RacewayError, extra
from raceway.plugins.system_libraries import refuse_pictures
from raceway.storage.files import write_whole

if TYPE_CHECKING:
    from types import ModuleType

#: Inner ring, outer ring, everything else.
_COLOURS = {"inner": "#4f8fc0", "outer": "#c9a24d"}
_OTHER = "#b8bfc6"
#: What is cut away: azimuths [rad] from +y towards +z.
_CUT = (0.0, 0.5 * np.pi)
_SIZE = (1600, 1200)


def draw(meshes: Mapping[str, HexMesh], title: str, path: Path) -> Path:
    """Draw all bodies with their edges, one colour a kind of body.

    Raises
    ------
    RacewayError
        pyvista is missing or cannot draw here, or the file cannot be written.
    """
    try:
        import pyvista
    except ImportError:
        message = f"the picture needs pyvista: {extra('view')}, or leave out --picture"
        raise RacewayError(message) from None
    refuse_pictures(", or leave out --picture")
    try:
        # Without a display VTK says so on standard error, and then draws in memory as it was asked to.
        with pyvista.vtk_verbosity("off"):
            image = _image(pyvista, meshes, title)
    except (RuntimeError, OSError) as error:
        raise RacewayError(f"the picture cannot be drawn: {error}. Leave out --picture") from None
    return write_whole(_png(image), path)


def _image(pyvista: ModuleType, meshes: Mapping[str, HexMesh], title: str) -> np.ndarray:
    """(rows, columns, 3) bytes."""
    plotter = pyvista.Plotter(off_screen=True, window_size=list(_SIZE))
    plotter.background_color = "white"
    outside: dict[int, np.ndarray] = {}  # balls share one array of cells
    for name, mesh in meshes.items():
        quads = _shared(outside, mesh) if name.startswith("ball") else _cut(mesh)
        if len(quads):
            surface = pyvista.PolyData.from_regular_faces(mesh.points, quads)
            colour = next((value for word, value in _COLOURS.items() if name.startswith(word)), _OTHER)
            plotter.add_mesh(
                surface,
                color=colour,
                show_edges=True,
                edge_color="#20262c",
                line_width=0.6,
                edge_opacity=0.45,
                ambient=0.3,
            )
    plotter.add_text(title, position="upper_edge", font_size=13, color="#20262c")
    plotter.enable_anti_aliasing("ssaa")
    # Seen from the side where the sector is missing, a little from the front.
    plotter.camera_position = [(1.35, 1.0, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)]
    plotter.reset_camera()
    plotter.camera.zoom(1.25)
    image = np.asarray(plotter.screenshot(return_img=True))
    plotter.close()
    return image


def _shared(known: dict[int, np.ndarray], mesh: HexMesh) -> np.ndarray:
    """(k, 4) outer faces, found once for each array of cells."""
    if id(mesh.cells) not in known:
        known[id(mesh.cells)] = _outside(mesh.cells)
    return known[id(mesh.cells)]


def _cut(mesh: HexMesh) -> np.ndarray:
    """(k, 4) outer faces of the cells that stay."""
    middle = mesh.points[mesh.cells].mean(axis=1)
    azimuth = np.arctan2(middle[:, 2], middle[:, 1])
    stays = (azimuth < _CUT[0]) | (azimuth > _CUT[1])
    return _outside(mesh.cells[stays]) if stays.any() else np.zeros((0, 4), dtype=np.int64)


def _outside(cells: np.ndarray) -> np.ndarray:
    """(k, 4) nodes of the outer faces of cells."""
    facets = boundary(cells)
    return np.asarray(cells[facets[:, :1], FACES[facets[:, 1]]])


def _png(image: np.ndarray) -> bytes:
    """An image (rows, columns, 3) of bytes as a PNG file: zlib's stream of unfiltered rows."""
    import struct
    import zlib

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    height, width = image.shape[:2]
    rows = b"".join(b"\0" + row.tobytes() for row in np.ascontiguousarray(image[:, :, :3]))
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows, 6)) + chunk(b"IEND", b"")
