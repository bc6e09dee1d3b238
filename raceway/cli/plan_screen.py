"""Tables of ``raceway plan``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.table import Table

from raceway.out.table import Row, grouped, number, sections
from raceway.out.wrapping import Words
from raceway.storage.tables import ReadTables


def plan_screen(title: str, plan: ReadTables) -> RenderableType:
    """Parts kept and left out, and the predictions."""
    step = number(plan["time_step_s"], "s", 3) if plan["time_step_s"] else "none"
    rows = [
        ("Size and cost, predicted", "", ""),
        ("degrees of freedom", str(plan["dofs"]), "ring and balls"),
        ("time step", step, f"{plan['predicted_steps']} steps"),
        _wall_time(plan),
    ]
    if plan["mesh"] is not None:
        rows += _mesh_rows(plan["mesh"])
    parts = [_reasons("Kept", plan["kept"]), _reasons("Left out", plan["left_out"])]
    return Group(Words(title, "bold"), *parts, sections(rows))


def _wall_time(plan: ReadTables) -> Row:
    if plan["predicted_at_least"]:
        return ("wall time", "not known", "before the mesh is read: how large it is")
    return ("wall time", number(plan["predicted_wall_s"], "s", 2), "with compiled kernels in the cache")


def _mesh_rows(mesh: ReadTables) -> list[Row]:
    """Predicted cells and memory of all bodies and of each; balls in one line."""
    rows: list[Row] = [
        ("Mesh, predicted", "", ""),
        ("hexahedra", str(mesh["cells"]), f"{mesh['bytes'] / 2**20:.4g} MiB at the peak while they are made"),
    ]
    for name, bodies in grouped({body["name"]: (body["cells"], body["bytes"]) for body in mesh["bodies"]}):
        cells, size = bodies
        rows.append((name, str(cells), f"{size / 2**20:.3g} MiB" + (" each" if name.startswith("balls (") else "")))
    return rows


def _reasons(heading: str, items: Sequence[Mapping[str, str]]) -> RenderableType:
    table = Table.grid(padding=(0, 2))
    table.add_column(width=32)
    table.add_column()
    for item in items:
        table.add_row(Words(item["part"]), Words(item["why"], "dim"))
    return Group(Words(heading, "bold"), Padding(table, (0, 0, 0, 2)))
