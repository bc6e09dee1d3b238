"""What a person sees: tables made from the same dictionaries that ``--json`` prints.  Prints nothing by itself."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from datetime import datetime
from math import acos, degrees, pi
from typing import TYPE_CHECKING, Any

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.markup import escape
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

if TYPE_CHECKING:
    pass

_LEFT_OUT_SHOWN = 3
#: Columns of numbers in the table of ``verify`` and their significant digits.
_VERIFIED = (("reference", 5), ("computed", 5), ("error", 2), ("tolerance", 2))


Row = tuple[str, str, str]


def sections(rows: Iterable[Row]) -> RenderableType:
    """Quantity, value, remark; a row without a value is a heading with its remark."""
    parts: list[RenderableType] = []
    for quantity, value, remark in rows:
        if not value:
            parts.append(Text.assemble((quantity, "bold"), (f"  {remark}" if remark else "", "dim")))
            table = Table.grid(padding=(0, 2))
            table.add_column(width=24)
            table.add_column(justify="right", min_width=16, no_wrap=True)
            table.add_column(style="dim", overflow="fold")
            parts.append(Padding(table, (0, 0, 0, 2)))
        else:
            table.add_row(escape(quantity), escape(value), escape(remark))
    return Group(*parts)


def number(value: float | None, unit: str = "", digits: int = 5) -> str:
    """Significant digits and unit; a dash for what is not there."""
    if value is None:
        return "-"
    text = f"{value + 0.0:.{digits}g}"
    return f"{text} {unit}" if unit else text


def tilt_words(tilt: float | str) -> str:
    """The tilt boundary, which belongs to every stiffness."""
    return f"tilt {tilt}" if isinstance(tilt, str) else f"tilt against {tilt:g} N m/rad"


def run_screen(result: Mapping[str, Any], files: Sequence[str]) -> RenderableType:
    """One run.

    Parameters
    ----------
    result : content of result.json;  files : what was written
    """
    rows = [*_equilibrium(result), *_identification(result), *_error(result["error"]), *_bodies(result.get("model"))]
    rows += _cost(result["cost"])
    rows += _stability(result["stability"])
    parts: list[RenderableType] = [
        Text(result["title"], style="bold"),
        Text(_bearing(result["scene"]), style="dim"),
        sections(rows),
    ]
    left_out = result["plan"]["left_out"]
    shown = "; ".join(f"{p['part']} ({p['why']})" for p in left_out[:_LEFT_OUT_SHOWN])
    more = len(left_out) - _LEFT_OUT_SHOWN
    parts.append(Text(f"left out: {shown}{f'; and {more} more, see raceway plan' if more > 0 else ''}", style="dim"))
    parts += [Text(f"warning: {text}", style="yellow") for text in result["warnings"]]
    parts += written(files)
    return Group(*parts)


def written(files: Sequence[str]) -> list[RenderableType]:
    """The files' names, each unbroken on its line, so that it can be copied."""
    return [Text(f"written: {name}", no_wrap=True, overflow="ignore") for name in files]


def _bearing(scene: Mapping[str, Any]) -> str:
    b, load = scene["bearing"], scene["load"]
    angle = f"{b['contact_angle_deg']:g} deg" if b.get("contact_angle_deg") else _angle_of_clearance(b)
    balls = f"{b['ball_count']} balls of {1e3 * b['ball_diameter']:g} mm on {1e3 * b['pitch_diameter']:g} mm"
    words = [
        f"{b.get('preset', 'own geometry')}: {balls}, contact angle {angle}",
        f"{scene['bodies']['kind']} bodies, law {scene['contact']['kind']}, {scene['contact']['discretisation']}",
        f"axial {load['axial']:g} N, radial {load['radial'][0]:g}, {load['radial'][1]:g} N",
    ]
    if any(load["moment"]):
        words[-1] += f", moment {load['moment'][0]:g}, {load['moment'][1]:g} N m"
    return "\n".join(words)


def _angle_of_clearance(b: Mapping[str, Any]) -> str:
    distance = (b["conformity_inner"] + b["conformity_outer"] - 1.0) * b["ball_diameter"]
    clearance = b.get("radial_clearance") or 0.0
    return f"{degrees(acos(1.0 - clearance / (2.0 * distance))):.2f} deg, from the clearance" if clearance else "0 deg"


def _equilibrium(result: Mapping[str, Any]) -> list[Row]:
    found, tilt = result["equilibrium"], result["scene"]["supports"]["tilt"]
    moved, k = found["displacement"], found["stiffness"]
    balls = list(enumerate(found["balls"]))
    rows = [
        ("Equilibrium under the constant loads", "", ""),
        ("displacement x", number(1e6 * moved["x"], "µm"), "axial, seats the bearing"),
        ("displacement y, z", f"{_small(moved['y'])}, {_small(moved['z'])} µm", "radial"),
    ]
    if tilt != "locked":
        tilts = ", ".join(_small(moved[name]) for name in ("tilt_y", "tilt_z"))
        rows.append(("tilt_y, tilt_z", f"{tilts} µrad", tilt_words(tilt)))
    for word, pick in (("most", max), ("least", min)):
        index, ball = pick(balls, key=lambda item: item[1]["load_inner_n"])
        angle = ball["contact_angle_inner_deg"]
        at = f"ball {index} at {ball['azimuth_deg']:.4g} deg"
        pressure = f"{1e-6 * ball['peak_pressure_inner_pa']:.0f} MPa, {angle:.2f} deg" if angle is not None else "open"
        rows.append((f"{word} loaded ball", number(ball["load_inner_n"], "N"), f"{at}; inner race {pressure}"))
    rows.append(("tangent kxx", number(1e-6 * k[0][0], "N/µm"), "axial, all other motions held"))
    rows.append(("tangent kyy", number(1e-6 * k[1][1], "N/µm"), "radial, tilt and all other motions held"))
    if tilt != "locked":
        rows.append((f"kyy, {tilt_words(tilt)}", number(1e-6 * _condensed(k, tilt), "N/µm"), "tilts follow, x and z held"))
    return rows


def _small(metres: float) -> str:
    """Micro-units; rounding noise of a symmetric state is shown as 0."""
    return "0" if abs(metres) < 1e-15 else f"{1e6 * metres:.4g}"


def _condensed(k: Sequence[Sequence[float]], tilt: float | str) -> float:
    """Radial tangent with the tilts following: kyy - k_yt (k_tt + k_shaft)^-1 k_ty."""
    shaft = tilt if isinstance(tilt, float) else 0.0
    a, b, c, d = k[3][3] + shaft, k[3][4], k[4][3], k[4][4] + shaft
    determinant = a * d - b * c
    along = k[1][3] * (d * k[3][1] - b * k[4][1]) + k[1][4] * (a * k[4][1] - c * k[3][1])
    return k[1][1] - along / determinant if determinant else k[1][1]


def _identification(result: Mapping[str, Any]) -> list[Row]:
    found = result["identification"]
    if found is None:
        return [("Dynamic stiffness", "", ""), ("none", "-", "static scene: add a table [excitation] to identify one")]
    z, orbit = found["dynamic_stiffness"], found["orbit"]
    excited = result["scene"]["excitation"]["kind"]
    mass = found["mass_used_kg"]
    return [
        (f"Dynamic stiffness at {found['speed_rpm']:g} r/min, {tilt_words(found['tilt'])}", "", ""),
        (f"  {found['definition']}", "", ""),
        ("force", number(found["force_amplitude_n"], "N"), f"{excited}, {found['frequency_hz']:g} Hz"),
        ("Z real", number(1e-6 * z["real"], "N/µm"), "force over displacement"),
        _resolved("Z imaginary", 1e-6 * z["imag"], _times(found, z), "N/µm", "w C"),
        ("|Z|", number(1e-6 * z["abs"], "N/µm"), ""),
        ("equivalent stiffness K", number(1e-6 * found["equivalent_stiffness"], "N/µm"), f"Re Z + m w^2, m = {mass:.4g} kg"),
        _resolved(
            "equivalent damping C", found["equivalent_damping"], found["equivalent_damping_error"], "N s/m", "Im Z / w"
        ),
        _resolved(
            "phase lag", found["phase_lag_deg"], found["phase_lag_error_deg"], "deg", "of the displacement behind the force"
        ),
        ("orbit, semi-axes", f"{1e6 * orbit['major_m']:.4g} x {1e6 * orbit['minor_m']:.4g} µm", "of the 1x line"),
    ]


def _times(found: Mapping[str, Any], z: Mapping[str, float]) -> float | None:
    """Absolute error of Z [N/um]."""
    error = found["phase_lag_error_deg"]
    return None if error is None else 1e-6 * z["abs"] * error * pi / 180.0


def _resolved(name: str, value: float, error: float | None, unit: str, remark: str) -> Row:
    """A small part of Z beside its absolute error; what is smaller than its error is not shown as a number."""
    if error is None:
        return name, number(value, unit, 3), remark
    if abs(value) < error:
        return name, "not resolved", f"below its error of {number(error, unit, 2)}; {remark}"
    return name, number(value, unit, 3), f"+- {number(error, unit, 2)}; {remark}"


def _error(error: Mapping[str, Any]) -> list[Row]:
    how = error["how"]
    rows = [("Relative error of Z", "", "")]
    for name in ("total", "time_step", "transient", "identification", "mesh", "contact"):
        value = error.get(name)
        rows.append((name.replace("_", " "), "not estimated" if value is None else f"{value:.1e}", how.get(name, "")))
    return rows


def _bodies(model: Mapping[str, Any] | None) -> list[Row]:
    """What elastic bodies change, how good their mesh is, and what their inertia would; each where it is told."""
    if not model:
        return []
    rows = [("Elastic bodies", "", str(model.get("bodies", "")))]
    elasticity = model.get("elasticity")
    if elasticity is not None:
        told = ", ".join("-" if elasticity[i][i] is None else f"{100 * elasticity[i][i]:+.1f} %" for i in (0, 1))
        rows.append(("kxx, kyy changed by", told, "against rigid rings and balls under the same loads"))
    taken = model.get("compliance")
    if taken is not None:
        values = ", ".join(f"{1e9 * taken[name]:.2f}" for name in ("inner_m_per_n", "outer_m_per_n"))
        angle = f"inner, outer contact at {taken['contact_angle_deg']:.1f} deg, beyond Hertz"
        rows.append(("structural compliance", f"{values} nm/N", angle))
    mesh = model.get("mesh") or {}
    along, change = mesh.get("nodes_per_semi_axis"), mesh.get("change_from_coarser")
    if along is not None:
        how = "not estimated" if change is None else f"{mesh['how']}: {change:.1e}"
        rows.append(("nodes per semi-axis", number(along, digits=3), how))
    inertia = model.get("inertia")
    if inertia is not None:
        rows += _inertia(inertia)
    return rows


def _inertia(inertia: Mapping[str, Any]) -> list[Row]:
    """The slowest motion that is taken to follow at once."""
    names = {
        "inner_supported": "inner ring",
        "outer_supported": "outer ring",
        "ball_along_grooves": "ball along its grooves",
    }
    known = {word: name for name, word in names.items() if inertia.get(f"{name}_hz") is not None}
    if not known:
        return []
    slowest = min(known, key=lambda word: inertia[f"{known[word]}_hz"])
    error = inertia[f"{known[slowest]}_error"]
    moves = " is part of the motion" if slowest.startswith("ball") and inertia.get("ball_along_grooves_in_motion") else ""
    costs = moves if error is None else f" follows at once, which is off by (w / w1)^2 = {error:.1e}"
    rings = min(inertia[f"{known[word]}_hz"] for word in known if word != "ball along its grooves")
    remark = f"{slowest}{costs}; rings as supported from {1e-3 * rings:.3g} kHz"
    return [("slowest own motion", number(1e-3 * inertia[f"{known[slowest]}_hz"], "kHz", 3), remark)]


def _cost(cost: Mapping[str, Any]) -> list[Row]:
    memory = cost["peak_memory_bytes"] / 2**20
    kept = (
        "once: kept for the next run (raceway cache)" if cost["compile_s"] else "kernels were in the cache (raceway cache)"
    )
    return [
        ("Cost", "", ""),
        (
            "wall time",
            number(cost["wall_s"], "s", 3),
            f"{cost['steps']} steps, {memory:.0f} MiB, {_threads(cost['threads'])}",
        ),
        ("compiling, apart", number(cost["compile_s"], "s", 3), kept),
    ]


def _threads(count: int) -> str:
    return f"{count} thread{'' if count == 1 else 's'}"


def _stability(found: Mapping[str, Any]) -> list[Row]:
    limit, drift = found["critical_time_step_s"], found["energy_drift"]
    words = [] if limit is None else [f"explicit limit {limit:.3g} s"]
    words += [] if drift is None else [f"energy drift {drift:.1e}"]
    return [("Stability", "", ""), ("status", found["status"], ", ".join(words) or "no motion was integrated")]


def plan_screen(title: str, plan: Mapping[str, Any]) -> RenderableType:
    """What would be built, what not, and the predictions."""
    step = number(plan["time_step_s"], "s", 3) if plan["time_step_s"] else "none"
    rows = [
        ("Size and cost, predicted", "", ""),
        ("degrees of freedom", str(plan["dofs"]), "ring and balls"),
        ("time step", step, f"{plan['predicted_steps']} steps"),
        ("wall time", number(plan["predicted_wall_s"], "s", 2), "with compiled kernels in the cache"),
    ]
    if plan["mesh"] is not None:
        rows += _mesh_rows(plan["mesh"])
    unused = [
        {"part": one["module"].removeprefix("raceway.core."), "why": one["why"]}
        for one in plan["modules"]
        if not one["needed"]
    ]
    parts = [_reasons("Kept", plan["kept"]), _reasons("Left out", plan["left_out"])]
    parts += [_reasons("Modules not imported, hence not compiled", unused), sections(rows)]
    return Group(Text(title, style="bold"), *parts)


def _mesh_rows(mesh: Mapping[str, Any]) -> list[Row]:
    """Predicted cells and memory of all bodies and of each; balls in one line."""
    rows: list[Row] = [
        ("Mesh, predicted", "", ""),
        ("hexahedra", str(mesh["cells"]), f"{mesh['bytes'] / 2**20:.4g} MiB at the peak while they are made"),
    ]
    for name, bodies in grouped({body["name"]: (body["cells"], body["bytes"]) for body in mesh["bodies"]}):
        cells, size = bodies
        rows.append((name, str(cells), f"{size / 2**20:.3g} MiB" + (" each" if name.startswith("balls (") else "")))
    return rows


def grouped(bodies: Mapping[str, Any]) -> list[tuple[str, Any]]:
    """Bodies with what is said of them; balls of which the same is said share a line, ``balls (12)``."""
    rows: list[tuple[str, Any]] = []
    balls: list[tuple[Any, int]] = []
    for name, said in bodies.items():
        if not name.startswith("ball"):
            rows.append((name, said))
            continue
        at = next((i for i, (other, _) in enumerate(balls) if other == said), None)
        if at is None:
            balls.append((said, 1))
        else:
            balls[at] = said, balls[at][1] + 1
    return rows + [(f"balls ({count})", said) for said, count in balls]


def _reasons(heading: str, items: Sequence[Mapping[str, str]]) -> RenderableType:
    table = Table.grid(padding=(0, 2))
    table.add_column(width=32)
    table.add_column(style="dim", overflow="fold")
    for item in items:
        table.add_row(escape(item["part"]), escape(item["why"]))
    return Group(Text(heading, style="bold"), Padding(table, (0, 0, 0, 2)))


def rows_table(rows: Sequence[Mapping[str, Any]], title: str = "") -> RenderableType:
    """A table of dictionaries with the same keys; underscores become blanks, numbers are aligned."""
    table = Table(title=title or None, title_justify="left", header_style="bold", box=SIMPLE_HEAD, pad_edge=False)
    keys = list(dict.fromkeys(key for row in rows for key in row))
    for key in keys:
        numeric = any(isinstance(row.get(key), float | int) for row in rows)
        table.add_column(
            key if "." in key else key.replace("_", " "), justify="right" if numeric else "left", overflow="fold"
        )
    for row in rows:
        table.add_row(*(_cell(row.get(key)) for key in keys))
    return table


def _cell(value: Any) -> str:
    if isinstance(value, bool):
        return "[green]yes[/]" if value else "[red]no[/]"
    return escape(number(value) if isinstance(value, float) else "-" if value is None else str(value))


#: Cases of which every number is shown: the pressures of the article, load by load, with their mesh independence.
_IN_FULL = ("seed-static-pressures",)


def verify_screen(verification: Mapping[str, Any], passed: bool, every: bool = False) -> RenderableType:
    """Published cases, what was computed, and whether it agrees.

    Parameters
    ----------
    every : a line for each number, not only the worst of each case and those that are off
    """
    table = Table(header_style="bold", box=SIMPLE_HEAD, pad_edge=False, padding=(0, 1))
    table.add_column("number" if every else "case: the worst of its numbers", min_width=28, overflow="fold")
    for name, _ in _VERIFIED:
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("")
    before = None
    for row in verification["rows"] if every else _worst(verification["rows"]):
        if row["case"] != before:
            table.add_row(f"[bold]{escape(row['case'])}[/]")
        numbers = (
            number(row["reference"]),
            number(row["computed"]),
            number(row["error"], "", 2),
            number(row["tolerance"], "", 2),
        )
        verdict = "[green]ok[/]" if row["ok"] else f"[red]off[/] {escape(row.get('note') or '')}"
        table.add_row(f"  {escape(row['quantity'])}", *numbers, verdict)
        before = row["case"]
    kept = sum(bool(row["ok"]) for row in verification["rows"])
    style = "green" if passed else "red"
    parts: list[RenderableType] = [table]
    parts.append(Text(f"{kept} of {len(verification['rows'])} numbers within their tolerance", style=style))
    return Group(*parts)


def _worst(rows: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Of each case the number closest to its tolerance, all that are off and all of ``_IN_FULL``, in their order."""

    def strain(row: Mapping[str, Any]) -> float:
        return float("inf") if row["error"] is None or not row["tolerance"] else row["error"] / row["tolerance"]

    closest = {case: max((r for r in rows if r["case"] == case), key=strain) for case in {r["case"] for r in rows}}
    return [row for row in rows if not row["ok"] or row["case"] in _IN_FULL or closest[row["case"]] is row]


def cache_screen(found: Mapping[str, Any]) -> RenderableType:
    rows = [("Compiled kernels", "", f"in {found['root']}")]
    for folder in found["folders"]:
        size = f"{folder['bytes'] / 2**20:.1f} MiB"
        rows.append((folder["name"], size, f"{folder['kernels']} kernels{', current' if folder['current'] else ''}"))
    if not any(folder["current"] for folder in found["folders"]):
        rows.append((found["current"], "empty", "current: the next run compiles, which takes some ten seconds"))
    total, most = found["arrays_bytes"] / 2**20, found["arrays_limit_bytes"] / 2**20
    rows.append(("Compliances of bodies", "", f"{total:.1f} of at most {most:.0f} MiB, in {found['arrays_root']}"))
    for entry in found["arrays"]:
        used = datetime.fromtimestamp(entry["used"]).strftime("%Y-%m-%d %H:%M")
        remark = f"{entry['what']}; made in {entry['made_in_s']:.1f} CPU-s, used {used}"
        rows.append((entry["kind"], f"{entry['bytes'] / 2**20:.2f} MiB", remark))
    if not found["arrays"]:
        rows.append(("none", "empty", "a condensed bearing makes them in seconds"))
    return sections(rows)


def compare_screen(
    title: str, rows: Sequence[Mapping[str, Any]], words: Sequence[str], files: Sequence[str]
) -> RenderableType:
    """A line for each point, and what causes what in words."""
    parts: list[RenderableType] = [Text(title, style="bold"), rows_table(rows)]
    parts += [Text(text) for text in words]
    parts += written(files)
    return Group(*parts)


#: Points of a sweep that a screen shows one by one.
_MOST_ROWS, _MOST_REASONS = 30, 5


def sweep_screen(content: Mapping[str, Any], rows: Iterable[Mapping[str, Any]], files: Sequence[str]) -> RenderableType:
    """How many points are in each state, the first of them with their stiffness, and why points failed."""
    shown: list[dict[str, str]] = []
    reasons: list[str] = []
    for row in rows:
        if len(shown) < _MOST_ROWS:
            shown.append(_sweep_row(row))
        if row["status"] == "failed" and len(reasons) < _MOST_REASONS:
            point = ", ".join(f"{key} = {value}" for key, value in row["point"].items())
            reasons.append(f"{point}: {row['reason'].splitlines()[0]}")
    states, total = content["states"], content["states"]["total"]
    counted = ", ".join(f"{states[name]} {name}" for name in ("done", "failed", "running", "waiting") if states[name])
    parts: list[RenderableType] = [Text(content["title"], style="bold"), rows_table(shown)]
    if total > len(shown):
        parts.append(Text(f"and {total - len(shown)} more points in {content['store']}", style="dim"))
    parts.append(Text(f"{total} points: {counted}"))
    parts += [Text(f"failed: {reason}") for reason in reasons]
    return Group(*parts, *written(files))


def _sweep_row(row: Mapping[str, Any]) -> dict[str, str]:
    from raceway.studies.axes import shown

    values = row["values"]
    last = [key.rpartition(".")[2] for key in row["point"]]
    short = {key: name if last.count(name) == 1 else key for key, name in zip(row["point"], last, strict=True)}
    text = {short[key]: shown(value) for key, value in row["point"].items()}
    k, z, kyy = values.get("equivalent_stiffness"), values.get("z_real"), values.get("stiffness")
    if k is not None and z is not None:
        text |= {"K N/um": f"{k / 1e6:.3f}", "Re Z N/um": f"{z / 1e6:.3f}"}
    else:
        text |= {"K N/um": "", "Re Z N/um": ""}
    text["kyy N/um"] = "" if kyy is None else f"{kyy[1][1] / 1e6:.3f}"
    error = values.get("error_total")
    return {**text, "error %": "" if error is None else f"{100.0 * error:.2g}", "status": row["status"]}


def precision_screen(
    title: str, rows: Sequence[Mapping[str, Any]], words: Sequence[str], files: Sequence[str]
) -> RenderableType:
    """A line for each setting, and what they come to in words."""
    table = Table(header_style="bold", box=SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    # A column of blanks would cost the settings their room.
    names = [name for name in rows[0] if any(row[name] for row in rows)]
    for name in names:
        text = name in ("setting", "status")
        table.add_column(name, justify="left" if text else "right", overflow="fold", min_width=0 if text else 6)
    for row in rows:
        table.add_row(*(escape(row[name]) for name in names))
    parts: list[RenderableType] = [Text(title, style="bold"), table]
    parts.append(Text("* on the front; ~ known to the reference's bound only", style="dim"))
    parts += [Text(text) for text in words]
    parts += written(files)
    return Group(*parts)


def stability_screen(content: Mapping[str, Any], every: bool, files: Sequence[str]) -> RenderableType:
    """A line for each case, or for each row; what is not as expected in full."""
    rows = content["rows"]
    bad = [row for row in rows if row["verdict"] == "failed"]
    table = Table(header_style="bold", box=SIMPLE_HEAD, pad_edge=False, padding=(0, 1))
    if every:
        for name in ("case", "setting", "quantity", "expected", "predicted", "observed", "verdict"):
            table.add_column(name, overflow="fold")
        for row in rows:
            table.add_row(*(escape(cell) for cell in _stability_cells(row)))
    else:
        for name in ("case", "rows", "as expected"):
            table.add_column(name, justify="left" if name == "case" else "right")
        for case in dict.fromkeys(row["case"] for row in rows):
            own = [row for row in rows if row["case"] == case]
            good = sum(row["verdict"] == "as expected" for row in own)
            table.add_row(escape(case), str(len(own)), str(good) if good == len(own) else f"[red]{good}[/red]")
    parts: list[RenderableType] = [Text(content["title"], style="bold"), table]
    for row in bad:
        cells = _stability_cells(row)
        parts.append(
            Text(f"failed: {', '.join(cell for cell in cells[:6] if cell)}. {row['note'] or row['reason']}", style="red")
        )
    kept = f", {content['reused']} kept from before" if content["reused"] else ""
    words = (
        f"{len(rows) - len(bad)} of {len(rows)} rows as expected, {content['cases']} cases{kept}, {content['seconds']:.0f} s"
    )
    parts.append(Text(words))
    parts += written(files)
    return Group(*parts)


def _stability_cells(row: Mapping[str, Any]) -> list[str]:
    setting = ", ".join(f"{key} {value}" for key, value in row["setting"].items())
    numbers = ("" if row[name] is None else f"{row[name]:.6g}" for name in ("predicted", "observed"))
    return [row["case"], setting, row["quantity"], row["expected"], *numbers, row["verdict"]]
