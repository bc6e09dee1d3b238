"""Tables of ``raceway run``, from the content of result.json: the answer first."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Group, RenderableType

from raceway.commands.screen.result_answer import answer_rows, only_resolved
from raceway.commands.screen.result_model import bodies_rows
from raceway.commands.screen.result_parts import (
    ball_pass_rows,
    cost_rows,
    equilibrium_rows,
    error_rows,
    film_rows,
    orbit_rows,
    stability_rows,
    stiffness_rows,
    tolerance_rows,
)
from raceway.commands.screen.text import micro, sections, written
from raceway.commands.screen.wrapping import Words
from raceway.scene.sets import GEOMETRY, signs_of
from raceway.storage.tables import ReadTables

_LEFT_OUT_SHOWN = 3


def run_screen(result: ReadTables, files: Sequence[str]) -> RenderableType:
    """One run.

    Parameters
    ----------
    result : content of result.json;  files : what was written
    """
    rows = [
        *answer_rows(result),
        *equilibrium_rows(result),
        *film_rows(result),
        *ball_pass_rows(result["ball_pass"]),
        *stiffness_rows(result),
        *tolerance_rows(result.get("tolerances")),
        *error_rows(result),
    ]
    rows = only_resolved(rows, result["error"])
    rows += bodies_rows(result.get("model"))
    rows += orbit_rows((result.get("motion") or {}).get("orbits") or [])
    rows += [*cost_rows(result["cost"]), *stability_rows(result["stability"])]
    # What makes the numbers doubtful is read before them.
    parts: list[RenderableType] = [Words(f"warning: {micro(text)}", "yellow") for text in result["warnings"]]
    parts += [
        Words(result["title"], "bold"),
        Words(_bearing(result), "dim"),
        sections(rows),
        Words(_left_out(result), "dim"),
        Words("notes in full: result.json", "dim"),
    ]
    return Group(*parts, *written(files))


def _left_out(result: ReadTables) -> str:
    left_out = result["plan"]["left_out"]
    parts = "; ".join(f"{row['part']} ({row['why']})" for row in left_out[:_LEFT_OUT_SHOWN])
    more = len(left_out[_LEFT_OUT_SHOWN:])
    return f"left out: {parts}{f'; and {more} more, see raceway plan' if more else ''}"


def _bearing(result: ReadTables) -> str:
    """Geometry, arrangement, model and loads, a line each."""
    scene, angle = result["scene"], f"{result['equilibrium']['free_contact_angle_deg']:.5g} deg"
    b, load = scene["bearing"], scene["load"]
    if b.get("radial_clearance") and not b.get("contact_angle_deg"):
        angle += ", from the clearance"
    balls = f"{b['ball_count']} balls of {1e3 * b['ball_diameter']:g} mm on {1e3 * b['pitch_diameter']:g} mm"
    words = [f"{b.get('preset') or 'own geometry'}: {balls}, contact angle {angle}"]
    if b.get("arrangement", "single") != "single" or b.get("row"):
        words.append(_set(b))
    if result.get("geometry"):
        words.append(result["geometry"]["words"])
    words += [
        f"{scene['bodies']['kind']} bodies, law {scene['contact']['kind']}, {scene['contact']['discretisation']}",
        f"axial {load['axial']:g} N, radial {load['radial'][0]:g}, {load['radial'][1]:g} N",
    ]
    if any(load["moment"]):
        words[-1] += f", moment {load['moment'][0]:g}, {load['moment'][1]:g} N m"
    return "\n".join(words)


#: How the rows of a pair stand to each other.
_PAIRS = {"DB": "back to back", "DF": "face to face", "DT": "tandem"}


def _set(bearing: ReadTables) -> str:
    """Arrangement, distances and preload of a set of rows."""
    kind, own = bearing.get("arrangement", "single"), bearing.get("row") or []
    forces = f"{bearing['preload']:g} N" if bearing.get("preload") else "the rows' own forces"
    if bearing.get("second_preload"):
        forces += f" and {bearing['second_preload']:g} N"
    braced = bearing.get("preload") or any(row.get("preload") for row in own)
    each = " of each row, as ground" if bearing.get("preload_of") == "row" else ""
    mounted = f"preload {forces}{each} before mounting ({bearing['preload_kind']})" if braced else "without preload"
    count = len(own) if kind == "single" else len(signs_of(kind))
    apart = bearing.get("row_distance") or bearing.get("width")
    placed = own and all(row.get("position") is not None for row in own)
    places = (
        ", ".join(f"{1e3 * row['position']:g}" for row in own) + " mm" if placed else f"{1e3 * (apart or 0.0):g} mm apart"
    )
    what = "rows that differ, see bearing.row" if any(set(row) & set(GEOMETRY) for row in own) else "rows of these balls"
    name = f"pair {kind}, {_PAIRS[kind]}" if kind in _PAIRS else f"set {kind}" if kind != "single" else "set of rows"
    return f"{name}: {'two' if count == 2 else count} {what}, {places}, {mounted}"
