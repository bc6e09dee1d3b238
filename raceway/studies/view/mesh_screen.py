"""Tables of meshes.  Prints nothing by itself."""

from __future__ import annotations

from rich.console import Group, RenderableType

from raceway.out.table import Row, grouped, number, sections, written
from raceway.out.wrapping import Words
from raceway.storage.tables import ReadTables


def mesh_screen(found: ReadTables) -> RenderableType:
    """Numbers of the whole, then a line a body.

    Parameters
    ----------
    found : ``raceway.core.mesh.summary.summary`` with title, mesher, seconds and files
    """
    count = len(found["bodies"])
    size, jacobian = found["element_size_m"], found["scaled_jacobian"]
    rows: list[Row] = [
        (f"Mesh by '{found['mesher']}'", "", ""),
        ("hexahedra", str(found["elements"]), "1 body" if count == 1 else f"{count} bodies"),
        ("nodes", str(found["nodes"]), f"{3 * found['nodes']} degrees of freedom"),
        ("element edges", f"{1e3 * size['mean']:.3g} mm", f"mean; {1e3 * size['min']:.3g} to {1e3 * size['max']:.3g} mm"),
    ]
    patch = found["patch_size_m"]
    if patch is not None:
        for name, sizes in patch.items():
            low, high = (f"{1e3 * sizes[word]:.3g}" for word in ("min", "max"))
            rows.append((f"contact patch, {name}", f"{low} mm", f"to {high} mm, element edges"))
    rows += [
        ("scaled Jacobian", f"{jacobian['min']:.3g}", f"smallest; mean {jacobian['mean']:.3g}, 1 is a cube, 0 is flat"),
        ("aspect", f"{found['aspect']['max']:.3g}", f"largest; mean {found['aspect']['mean']:.3g}"),
        ("skew", f"{found['skew']['max']:.3g}", f"largest; mean {found['skew']['mean']:.3g}"),
        ("memory", f"{found['memory_bytes'] / 2**20:.1f} MiB", "points, cells and sets"),
        ("time", number(found["seconds"], "s", 3), "building the meshes; judging and writing them is apart"),
        ("Bodies", "", ""),
    ]
    bodies = {}
    for name, body in found["bodies"].items():
        words = f"hexahedra, {body['nodes']} nodes, scaled Jacobian {body['scaled_jacobian']['min']:.3g} and more"
        bodies[name] = str(body["elements"]), words
    rows += [
        (name, cells, f"each: {words}" if name.startswith("balls") else words) for name, (cells, words) in grouped(bodies)
    ]
    return Group(Words(found["title"], "bold"), sections(rows), *written(found["files"]))
