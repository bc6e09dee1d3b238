"""A picture of meshes, drawn without a display: a sector of the rings is taken away, so that balls and grooves are seen."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from raceway.core.mesh import HexMesh
from raceway.errors import RacewayError
from raceway.files import write_whole

#: Inner ring, outer ring, everything else.
_COLOURS = {"inner": "#4f8fc0", "outer": "#c9a24d"}
_OTHER = "#b8bfc6"
#: What is cut away: azimuths [rad] from +y towards +z.
_CUT = (0.0, 0.5 * np.pi)
_HEXAHEDRON = 12  # VTK's number of the cell type
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
        message = 'the picture needs pyvista: pip install "raceway[view]", or leave out --picture'
        raise RacewayError(message) from None
    try:
        plotter: Any = pyvista.Plotter(off_screen=True, window_size=list(_SIZE))
        plotter.background_color = "white"
        for name, mesh in meshes.items():
            surface = _surface(pyvista, name, mesh)
            if surface.n_cells:
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
        image = plotter.screenshot(return_img=True)
        plotter.close()
    except (RuntimeError, OSError) as error:
        raise RacewayError(f"the picture cannot be drawn: {error}. Leave out --picture") from None
    return write_whole(_png(image), path)


def _surface(pyvista: Any, name: str, mesh: HexMesh) -> Any:
    """Outer faces of the cells that stay."""
    cells = mesh.cells
    if not name.startswith("ball"):
        middle = mesh.points[cells].mean(axis=1)
        azimuth = np.arctan2(middle[:, 2], middle[:, 1])
        cells = cells[(azimuth < _CUT[0]) | (azimuth > _CUT[1])]
    grid: Any = pyvista.UnstructuredGrid({_HEXAHEDRON: cells}, mesh.points)
    return grid.extract_geometry()


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
