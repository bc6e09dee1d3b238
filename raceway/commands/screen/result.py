"""Tables of ``raceway run``, from the content of result.json."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Group, RenderableType
from rich.text import Text

from raceway.commands.screen.text import Row, number, number_within, sections, tilt_words, written
from raceway.storage.tables import ReadTables

_LEFT_OUT_SHOWN = 3


def run_screen(result: ReadTables, files: Sequence[str]) -> RenderableType:
    """One run.

    Parameters
    ----------
    result : content of result.json;  files : what was written
    """
    rows = [*_equilibrium(result), *_identification(result), *_error(result), *_bodies(result.get("model"))]
    rows += _orbits((result.get("motion") or {}).get("orbits") or [])
    rows += _cost(result["cost"])
    rows += _stability(result["stability"])
    # What makes the numbers doubtful is read before them.
    parts: list[RenderableType] = [Text(f"warning: {text}", style="yellow") for text in result["warnings"]]
    parts += [
        Text(result["title"], style="bold"),
        Text(_bearing(result), style="dim"),
        sections(rows),
    ]
    left_out = result["plan"]["left_out"]
    shown = "; ".join(f"{p['part']} ({p['why']})" for p in left_out[:_LEFT_OUT_SHOWN])
    more = len(left_out) - _LEFT_OUT_SHOWN
    parts.append(Text(f"left out: {shown}{f'; and {more} more, see raceway plan' if more > 0 else ''}", style="dim"))
    parts += written(files)
    return Group(*parts)


def _bearing(result: ReadTables) -> str:
    scene, angle = result["scene"], f"{result['equilibrium']['free_contact_angle_deg']:.5g} deg"
    b, load = scene["bearing"], scene["load"]
    if b.get("radial_clearance") and not b.get("contact_angle_deg"):
        angle += ", from the clearance"
    balls = f"{b['ball_count']} balls of {1e3 * b['ball_diameter']:g} mm on {1e3 * b['pitch_diameter']:g} mm"
    words = [
        f"{b.get('preset', 'own geometry')}: {balls}, contact angle {angle}",
        f"{scene['bodies']['kind']} bodies, law {scene['contact']['kind']}, {scene['contact']['discretisation']}",
        f"axial {load['axial']:g} N, radial {load['radial'][0]:g}, {load['radial'][1]:g} N",
    ]
    if any(load["moment"]):
        words[-1] += f", moment {load['moment'][0]:g}, {load['moment'][1]:g} N m"
    return "\n".join(words)


def _equilibrium(result: ReadTables) -> list[Row]:
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
    rows += _mounted(found)
    for word, pick in (("most", max), ("least", min)):
        index, ball = pick(balls, key=lambda item: item[1]["load_inner_n"])
        angle = ball["contact_angle_inner_deg"]
        at = f"ball {index} at {ball['azimuth_deg']:.4g} deg"
        pressure = f"{_pressure(ball)}, {angle:.2f} deg" if angle is not None else "open"
        rows.append((f"{word} loaded ball", number(ball["load_inner_n"], "N"), f"{at}; inner race {pressure}"))
    rows.append(("tangent kxx", number(1e-6 * k[0][0], "N/µm"), "axial, all other motions held"))
    rows.append(("tangent kyy", number(1e-6 * k[1][1], "N/µm"), "radial, tilt and all other motions held"))
    if tilt != "locked":
        follow = number(1e-6 * found["kyy_tilts_follow_n_per_m"], "N/µm")
        rows.append((f"kyy, {tilt_words(tilt)}", follow, "tilts follow, x and z held"))
    return rows


def _mounted(found: ReadTables) -> list[Row]:
    """Preload and held axial force: mounted and running."""
    rows, preload, held = [], found["preload"], found["held_axial"]
    if preload is not None:
        forces = ", ".join(f"{force:.5g}" for force in preload["rows_n"])
        what = {"rigid": "the offset of the rows", "spring": "the second row's force"}[preload["kind"]]
        how = f"running, without loads; mounted {preload['mounted_n']:g} N, {what} stays; rows under the loads {forces} N"
        rows.append(("preload", number(preload["running_n"], "N"), how))
    if held is not None:
        how = f"what the held displacement takes now; mounted {held['mounted_n']:g} N"
        rows.append(("axial force", number(held["running_n"], "N"), how))
    return rows


def _pressure(ball: ReadTables) -> str:
    """Of the inner race; where finite elements tell their own, both of theirs and Hertz's by name."""
    names = {"points": "peak_pressure_points_inner_pa", "nodal": "peak_pressure_nodal_inner_pa"}
    told = [f"{1e-6 * ball[key]:.0f} MPa {word}" for word, key in names.items() if ball.get(key) is not None]
    hertz = f"{1e-6 * ball['peak_pressure_inner_pa']:.0f} MPa"
    return ", ".join([*told, f"{hertz} by Hertz"]) if told else hertz


def _small(metres: float) -> str:
    """Micro-units; rounding noise of a symmetric state is shown as 0."""
    return "0" if abs(metres) < 1e-15 else f"{1e6 * metres:.4g}"


def _identification(result: ReadTables) -> list[Row]:
    found = result["identification"]
    if found is None:
        return [("Dynamic stiffness", "", ""), ("none", "-", "static scene: add a table [excitation] to identify one")]
    z, orbit = found["dynamic_stiffness"], found["orbit"]
    excited = result["scene"]["excitation"]["kind"]
    mass, across = found["mass_used_kg"], found["dynamic_stiffness_imag_error"]
    return [
        (f"Dynamic stiffness at {found['speed_rpm']:g} r/min, {tilt_words(found['tilt'])}", "", ""),
        (f"  {found['definition']}", "", ""),
        ("force", number(found["force_amplitude_n"], "N"), f"{excited}, {found['frequency_hz']:g} Hz"),
        ("Z real", number(1e-6 * z["real"], "N/µm"), "force over displacement"),
        _resolved("Z imaginary", 1e-6 * z["imag"], None if across is None else 1e-6 * across, "N/µm", "w C"),
        ("|Z|", number(1e-6 * z["abs"], "N/µm"), ""),
        _stiffness(found, f"Re Z + m w^2, m = {mass:.4g} kg"),
        _resolved(
            "equivalent damping C", found["equivalent_damping"], found["equivalent_damping_error"], "N s/m", "Im Z / w"
        ),
        _resolved(
            "phase lag", found["phase_lag_deg"], found["phase_lag_error_deg"], "deg", "of the displacement behind the force"
        ),
        ("orbit, semi-axes", f"{1e6 * orbit['major_m']:.4g} x {1e6 * orbit['minor_m']:.4g} µm", "of the 1x line"),
    ]


def _stiffness(found: ReadTables, remark: str) -> Row:
    """K with the absolute error of Z, which is larger than the same share of K where m w^2 cancels K."""
    name, value, error = "equivalent stiffness K", found["equivalent_stiffness"], found["equivalent_stiffness_error"]
    if error is None:
        return name, number(1e-6 * value, "N/µm"), remark
    told = f"{number(1e-6 * error, 'N/µm', 2)}; {remark}"
    if abs(value) < error:
        return name, "not resolved", f"below its error of {told}"
    return name, number_within(1e-6 * value, 1e-6 * error, "N/µm"), f"+- {told}"


def _resolved(name: str, value: float, error: float | None, unit: str, remark: str) -> Row:
    """A small part of Z beside its absolute error; what is smaller than its error is not shown as a number."""
    if error is None:
        return name, number(value, unit, 3), remark
    if abs(value) < error:
        return name, "not resolved", f"below its error of {number(error, unit, 2)}; {remark}"
    return name, number(value, unit, 3), f"+- {number(error, unit, 2)}; {remark}"


def _error(result: ReadTables) -> list[Row]:
    error = result["error"]
    how = error["how"]
    rows = [("Relative error of Z", "", "")]
    for name in ("total", "time_step", "transient", "identification", "mesh", "contact"):
        value = error.get(name)
        rows.append((name.replace("_", " "), "not estimated" if value is None else f"{value:.1e}", how.get(name, "")))
    known = [one for one in (result["identification"] or {}).get("series", []) if one["error"] is not None]
    if known:
        worst = max(known, key=lambda one: one["error"])
        how = f"at {worst['speed_rpm']:.6g} r/min; of {len(known)} windows, each with its own in result.json"
        rows.insert(2, ("largest of the series", f"{worst['error']:.1e}", how))
    return rows


def _bodies(model: ReadTables | None) -> list[Row]:
    """Effect of elasticity, quality of the mesh, and error of the missing inertia; each where the result has it."""
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
    sure = mesh.get("replaced_uncertainty")
    if sure is not None:
        values = ", ".join(f"{1e9 * mesh[f'replaced_{race}_m_per_n']:.2f}" for race in ("inner", "outer"))
        how = f"inner, outer: what the mesh gives way under a contact; known to {100.0 * sure:.1g} % of the contact's compliance"
        rows.append(("replaced by the law", f"{values} nm/N", how))
    share, unbalanced, energies = (model.get(name) for name in ("penetration_share", "unbalanced_n", "energies_j"))
    if share is not None:
        rows.append(
            ("penetration share", number(100.0 * share, "%", 3), "of the approach, at most: what the law lets overlap")
        )
    if unbalanced is not None:
        rows.append(("unbalanced force", number(unbalanced, "N", 2), "largest, reaction against load"))
    if energies is not None:
        shown = ", ".join(f"{name} {1e3 * value:.3g}" for name, value in energies.items())
        rows.append(("energies", "", f"{shown} mJ"))
    inertia = model.get("inertia")
    if inertia is not None:
        rows += _inertia(inertia)
    return rows


def _inertia(inertia: ReadTables) -> list[Row]:
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


def _orbits(found: Sequence[ReadTables]) -> list[Row]:
    """Steady motions under the same force, where more than one was found."""
    if len(found) < 2:
        return []
    rows: list[Row] = [("Steady motions that were found", "", "")]
    for k, one in enumerate(found):
        z, word = one["dynamic_stiffness"], "unstable" if not one["stable"] else one["verdict"]
        grows = f"{word}, multiplier {one['multiplier']:.4g} a turn, found {one['found']}{'; reported above' if one['taken'] else ''}"
        value = f"{1e-6 * z['real']:.5g} {'-' if z['imag'] < 0.0 else '+'} {1e-6 * abs(z['imag']):.4g}j N/µm"
        rows.append((f"Z of motion {k + 1}", value, f"{1e6 * one['amplitude_m']:.4g} µm; {grows}"))
    return rows


def _cost(cost: ReadTables) -> list[Row]:
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


def _stability(found: ReadTables) -> list[Row]:
    limit, drift = found["critical_time_step_s"], found["energy_drift"]
    words = [] if limit is None else [f"explicit limit {limit:.3g} s"]
    words += [] if drift is None else [f"energy drift {drift:.1e}"]
    return [("Stability", "", ""), ("status", found["status"], ", ".join(words) or "no motion was integrated")]
