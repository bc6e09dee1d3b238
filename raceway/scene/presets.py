"""The table [bearing] with the numbers of presets and named materials below what the user says."""

from __future__ import annotations

from raceway.errors import Mistake, SceneError
from raceway.scene.catalogue import preset
from raceway.scene.materials import with_material
from raceway.scene.sets import GEOMETRY
from raceway.storage.tables import Tables


def _with_preset(table: Tables, mistakes: list[Mistake]) -> Tables:
    table = _with_rows(table, mistakes)
    name = table.get("preset")
    if name is None:
        return with_materials(table, {}, mistakes)
    try:
        values = preset(name)
    except SceneError as error:
        mistakes += error.mistakes
        return {**_PLACEHOLDER, **table, "preset": None}
    merged = {**values, **table}
    if "radial_clearance" in table and "contact_angle_deg" not in table:
        merged["contact_angle_deg"] = 0.0
    if "contact_angle_deg" in table and "radial_clearance" not in table:
        merged.pop("radial_clearance", None)
    return with_materials(merged, values, mistakes)


def with_materials(table: Tables, preset: Tables, mistakes: list[Mistake], name: str = "bearing") -> Tables:
    """The table [bearing] or [mounting] with the numbers of named materials, and those of the preset below what the user says."""
    made = dict(table)
    for part in ("rings", "balls", "shaft_material", "housing_material"):
        own = table.get(part)
        own = {"material": own} if isinstance(own, str) and name == "mounting" else own
        if isinstance(own, dict):
            try:
                made[part] = with_material(own, f"{name}.{part}", preset.get(part, {}))
            except SceneError as error:
                mistakes += error.mistakes
                made[part] = {**preset.get(part, {}), **own, "material": None}
    return made


def _with_rows(table: Tables, mistakes: list[Mistake]) -> Tables:
    """The [bearing] table whose rows have the numbers of their presets; without a bearing of its own it is the first row's."""
    rows = table.get("row")
    if not isinstance(rows, list | tuple):
        return table
    found = []
    for k, row in enumerate(rows):
        name = row.get("preset") if isinstance(row, dict) else None
        if name is not None:
            try:
                values = preset(name)
            except SceneError as error:
                mistakes += [Mistake(f"bearing.row[{k}].preset", one.value, one.message) for one in error.mistakes]
                row = {key: value for key, value in row.items() if key != "preset"}
            else:
                row = {**{key: value for key, value in values.items() if key in GEOMETRY}, **row}
        found.append(row)
    if (
        rows
        and "preset" not in table
        and "ball_diameter" not in table
        and isinstance(found[0], dict)
        and "preset" in found[0]
    ):
        table = {**table, "preset": found[0]["preset"]}
    return {**table, "row": found}


#: Stands in for a preset that does not exist, so that the other keys of the table are still checked.
_PLACEHOLDER = {
    "ball_diameter": 0.01,
    "pitch_diameter": 0.05,
    "width": 0.015,
    "ball_count": 8,
    "conformity_inner": 0.52,
    "conformity_outer": 0.52,
}
