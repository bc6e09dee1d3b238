"""Rows of ``raceway run``, section by section, from the content of result.json."""

from collections.abc import Mapping, Sequence
from typing import Any

from raceway.answers.quantities import HEADLINE, K_ERROR, KXX, KYY, KYY_TILTS_FOLLOW, STIFFNESSES, K, Quantity, X
from raceway.answers.table import Row, number, tilt_words
from raceway.errors import PluginError
from raceway.framework.duties import quantity_screen
from raceway.framework.loading.registry import default_registry
from raceway.framework.shown import in_micro
from raceway.pipeline.content import AtRest, Content
from raceway.pipeline.uncertainty import interval, stated
from raceway.storage.tables import ReadTables

#: Counts of elements at a contact, and where they are counted: four of each resolve its stresses.
_CELLS = {
    "cells_to_hertz_depth": "down to Hertz's depth",
    "cells_per_semi_major": "along the ellipse's major semi-axis",
    "cells_per_semi_minor": "along the ellipse's minor semi-axis",
}


def bodies_rows(model: ReadTables | None) -> list[Row]:
    """Effect of elasticity, quality of the mesh, and error of the missing inertia; each where the result has it."""
    if not model:
        return []
    rows = [("Elastic bodies", "", "")]
    elasticity = model.get("elasticity")
    if elasticity is not None:
        changes = ", ".join("-" if elasticity[i][i] is None else f"{100 * elasticity[i][i]:+.1f} %" for i in (0, 1))
        rows.append(("kxx, kyy changed by", changes, "against rigid rings and balls"))
    compliance = model.get("compliance")
    if compliance is not None:
        values = ", ".join(f"{1e9 * compliance[name]:.2f}" for name in ("inner_m_per_n", "outer_m_per_n"))
        angle = f"inner, outer over Hertz, {compliance['contact_angle_deg']:.1f} deg"
        rows.append(("structural compliance", f"{values} nm/N", angle))
    mesh = model.get("mesh") or {}
    along, change = mesh.get("nodes_per_semi_axis"), mesh.get("change_from_coarser")
    if along is not None:
        how = "not estimated" if change is None else f"a mesh twice as coarse: {change:.1e}"
        rows.append(("nodes per semi-axis", number(along, digits=3), how))
    sure = mesh.get("replaced_uncertainty")
    if sure is not None:
        values = ", ".join(f"{1e9 * mesh[f'replaced_{race}_m_per_n']:.2f}" for race in ("inner", "outer"))
        how = f"inner, outer mesh below contacts, +- {100.0 * sure:.1g} %"
        rows.append(("replaced by the law", f"{values} nm/N", how))
    share, imbalance, energies = (model.get(name) for name in ("penetration_share", "unbalanced_n", "energies_j"))
    if share is not None:
        rows.append(("penetration share", number(100.0 * share, "%", 3), "of the approach at most: penetration of the law"))
    # The largest shear stress below the most loaded contact of each race; no number that the mesh does not resolve.
    sides = model.get("subsurface") or []
    for race in dict.fromkeys(str(side["race"]) for side in sides):
        pair = [side for side in sides if side["race"] == race]
        fine, coarse = ([side for side in pair if bool(side["resolved"]) is state] for state in (True, False))
        value = ", ".join(f"{1e-6 * side['largest_shear_pa']:.0f}" for side in fine)
        lines = []
        if fine:
            bodies, depths = (", ".join(s["body"] for s in fine), ", ".join(f"{1e6 * s['depth_m']:.0f}" for s in fine))
            lines.append(f"{bodies}, {depths} µm deep")
        if coarse:
            worst, key = min(((side, key) for side in coarse for key in _CELLS), key=lambda pair: pair[0][pair[1]])
            bodies = " and ".join(side["body"] for side in coarse)
            which = "not resolved" if fine else "by this mesh"
            lines.append(f"{which} in {bodies}: {worst[key]:.2g} elements {_CELLS[key]}, not 4")
        lines.append(f"Hertz {1e-6 * pair[0]['hertz_largest_shear_pa']:.0f} MPa at {1e6 * pair[0]['hertz_depth_m']:.0f} µm")
        rows.append((f"largest shear, {race}", f"{value} MPa" if fine else "not resolved", "; ".join(lines)))
    if imbalance is not None:
        rows.append(("unbalanced force", number(imbalance, "N", 2), "largest, reaction against load"))
    if energies is not None:
        parts = ", ".join(f"{name} {1e3 * value:.3g}" for name, value in energies.items())
        rows.append(("", "", f"energies: {parts} mJ"))
    inertia = model.get("inertia")
    if inertia is not None:
        rows += _inertia(inertia)
    return rows


def _inertia(inertia: ReadTables) -> list[Row]:
    """The slowest motion that is taken to follow at once."""
    names = {"inner_supported": "inner ring", "outer_supported": "outer ring", "ball_along_grooves": "ball along grooves"}
    modes = {word: name for name, word in names.items() if inertia.get(f"{name}_hz") is not None}
    if not modes:
        return []
    slowest = min(modes, key=lambda word: inertia[f"{modes[word]}_hz"])
    error = inertia[f"{modes[slowest]}_error"]
    moves = " is part of the motion" if slowest.startswith("ball") and inertia.get("ball_along_grooves_in_motion") else ""
    remark = f"{slowest}{moves if error is None else f', off by {error:.1e}'}"
    return [("lowest elastic mode", number(1e-3 * inertia[f"{modes[slowest]}_hz"], "kHz", 3), remark)]


#: Axial forces below this are rounding; signs of a value that leaves its remark room.
_ROUNDING_N, _WIDE = 1e-6, 16


def equilibrium_rows(result: Content) -> list[Row]:
    """Displacement and loads; the tangent stiffness where it is not the answer itself."""
    equilibrium, tilt = result["equilibrium"], result["scene"]["supports"]["tilt"]
    displacement, dynamic = equilibrium["displacement"], result["identification"] is not None
    load = result["scene"]["load"]
    words = [f"{load['axial']:g} N axial"]
    words += [f"{load['radial'][0]:g}, {load['radial'][1]:g} N radial"] if any(load["radial"]) else []
    words += [f"{load['moment'][0]:g}, {load['moment'][1]:g} N m"] if any(load["moment"]) else []
    rows = [(f"Equilibrium under {', '.join(words)}", "", ""), X.fact(result, "axial, + preloads the bearing")]
    across = [in_micro(displacement[name]) for name in ("y", "z")]
    if across != ["0", "0"]:
        rows.append(("displacement y, z", f"{', '.join(across)} µm", "radial"))
    if tilt != "locked" and any(displacement[name] for name in ("tilt_y", "tilt_z")):
        tilts = ", ".join(in_micro(displacement[name]) for name in ("tilt_y", "tilt_z"))
        rows.append(("tilt_y, tilt_z", f"{tilts} µrad", tilt_words(tilt)))
    rows += mounting_rows(equilibrium)
    rows += loaded_balls(result, ["most", "least"] if dynamic else ["least"])
    if not dynamic:
        return rows
    # kxx, kyy and kyy with tilts that follow, each within its interval.
    facts = [stated(one, result) for one in (KXX, KYY, KYY_TILTS_FOLLOW) if one.of(result) is not None]
    axial, radial, *follows = [(label, value, words.partition(":")[0]) for label, value, words in facts]
    rows.append(("tangent kxx, kyy", f"{axial[1].partition(' ')[0]}, {radial[1]}", f"{axial[2]}, {radial[2]}"))
    # Without a load across, tilts follow by nothing.
    return [*rows, *(row for row in follows if row[1] != radial[1]), *held_rows(result)]


def mounting_rows(equilibrium: AtRest) -> list[Row]:
    """Preload and held axial force: running, mounted and before mounting."""
    rows, preload, axial = [], equilibrium["preload"], equilibrium["held_axial"]
    if preload is not None:
        forces = ", ".join(number(force) for force in preload["rows_n"])
        first = " and ".join(
            dict.fromkeys(f"{preload[name]:.4g}" for name in ("before_mounting_n", "second_before_mounting_n"))
        )
        mounted = f"{preload['mounted_n']:.4g}"
        how = f"running; {first} N before{' and' if mounted == first else f', {mounted}'} mounted"
        rows.append(("preload", number(preload["running_n"], "N"), how))
        if len(forces) > _WIDE:
            rows.append(("", "", f"axial force of rows 1 to {len(preload['rows_n'])} under the loads: {forces} N"))
        else:
            rows.append(("axial force of rows", f"{forces} N", "under the loads"))
        lifts = [*zip(preload["lift_off_axial_n"], preload["lift_off_row"], strict=True)]
        loads = ", ".join("never" if load is None else number(load, "N", 4) for load, _ in lifts)
        which = ", ".join(f"row {row} along {way}" for way, (_, row) in zip(("+x", "-x"), lifts, strict=True) if row)
        rows.append(("axial load at lift-off", loads, which))
    if axial is not None:
        how = f"held; {axial['before_mounting_n']:g} N before, {axial['mounted_n']:.4g} mounted"
        running = axial["running_n"] if abs(axial["running_n"]) > _ROUNDING_N else 0.0
        rows.append(("axial force", number(running, "N"), how))
    return rows


def quantity_rows(result: ReadTables, first: bool = False) -> list[Row]:
    """A section for each plug-in of quantities whose table the result has, of those that are installed; ``first``: of each its first row."""
    rows: list[Row] = []
    for entry in default_registry().of_kind("quantity"):
        if result.get(entry.name):
            try:
                section = quantity_screen(entry.plugin, result)
                rows += [row for row in section if row[1] or not row[0]][:1] if first else section
            except PluginError as why:  # its numbers are in the result
                rows.append((entry.name, "not shown", str(why)))
    return rows


#: Share of the total error below which a part of it is not shown.
_NEGLIGIBLE = 1e-2


def error_rows(result: Content) -> list[Row]:
    """Intervals of loads, pressure, life and preload; the numerical error of K with the parts of that of Z."""
    error, identification = result["error"], result["identification"]
    entries = {one.symbol.replace("_", " "): result["uncertainty"][one.name] for one in HEADLINE if one not in STIFFNESSES}
    texts = {name: interval(one) for name, one in entries.items() if one and one["parts"]["data"]["low"] is not None}
    intervals = ", ".join(f"{name.removeprefix('peak ')} {text.partition(' %:')[0]}" for name, text in texts.items())
    makers = any("other makers" in text.partition("not estimated: ")[2] for text in texts.values())
    rows: list[Row] = [("", "", f"{intervals} %{', for one maker' if makers else ''}")] if intervals else []
    # Laws other than Hertz's are no part of the total: they widen the intervals.
    names = ["time_step", "transient", "identification", "mesh", *(["contact"] if error["bodies"] else [])]
    numbers: ReadTables = error
    parts = {name.replace("_", " "): numbers.get(name) for name in names}
    least = _NEGLIGIBLE * (error["total"] or 0.0)
    sizes = {name: f"{name} {value:.1e}" for name, value in parts.items() if value and value > least}
    if identification is None:
        return [*rows, *([("relative error", "", f"of the stiffness: {', '.join(sizes.values())}")] if sizes else [])]
    rigid = result["model"] is None  # which have no mesh
    unknown = [name for name, value in parts.items() if value is None and not (rigid and name == "mesh")]
    largest = max(sizes, key=lambda name: parts[name] or 0.0, default="")
    words = [f"most by {largest}" if len(sizes) > 1 else largest] if sizes else []
    words += [f"{', '.join(unknown)} not estimated"] if unknown else []
    total = "not estimated" if error["total"] is None else f"{error['total']:.1e}"
    if (absolute := K_ERROR.of(result)) is None:
        rows.append(("relative error of Z", total, "; ".join(words)))
    else:
        rows.append(("numerical error of K", K.text(absolute, 2), f"of Z {total}, {'; '.join(words)}"))
    series = [(off, one["speed_rpm"]) for one in identification["series"] if (off := one["error"]) is not None]
    if series:
        worst, speed = max(series, key=lambda window: window[0])
        how = f"at {speed:.6g} r/min, of {len(series)} windows"
        rows.append(("largest of the series", f"{worst:.1e}", how))
    return rows


def orbit_rows(orbits: Sequence[ReadTables]) -> list[Row]:
    """Steady motions under the same force, where more than one was found."""
    if len(orbits) < 2:
        return []
    rows: list[Row] = [("Steady motions", "", "")]
    for k, one in enumerate(orbits):
        z, word = one["dynamic_stiffness"], "unstable" if not one["stable"] else one["verdict"]
        grows = f"{word}, multiplier {one['multiplier']:.4g} per turn, found {one['found']}{'; reported above' if one['taken'] else ''}"
        value = f"{1e-6 * z['real']:.5g} {'-' if z['imag'] < 0.0 else '+'} {1e-6 * abs(z['imag']):.4g}j N/µm"
        rows.append((f"Z of motion {k + 1}", value, f"{1e6 * one['amplitude_m']:.4g} µm; {grows}"))
    return rows


def cost_row(cost: Mapping[str, Any]) -> Row:
    """Time and memory; of a run that compiled, which happens once, time alone."""
    compile_s, digits = cost["compile_s"], 2 if cost["compile_s"] else 3
    words = [number(cost["cpu_s"], "CPU-s", digits)] if "cpu_s" in cost else []
    if compile_s:
        where = "cached" if cost.get("compiled_kept", True) else "not cached, the cache cannot be written"
        words.append(f"compiling {number(compile_s, 's', digits)}, {where}")
    else:
        words += [f"{cost['steps']} steps"] if cost["steps"] else []
        words += [f"{cost['peak_memory_bytes'] / 2**20:.0f} MiB"]
        words += [f"{cost['threads']} threads"] if cost["threads"] > 1 else []
        words += [f"steps on {cost['device']}"] if "device" in cost else []
    return "wall time", number(cost["wall_s"], "s", 3), ", ".join(words)


def stability_rows(stability: ReadTables) -> list[Row]:
    """How the motion ended; nothing where none was integrated."""
    limit, drift = stability["critical_time_step_s"], stability["energy_drift"]
    words = f"explicit limit {limit or 0.0:.3g} s" if drift is None else f"energy drift {drift:.1e}"
    return [] if limit is None and drift is None else [("stability", stability["status"], words)]


def interval_rows(result: Content, *quantities: Quantity) -> list[Row]:
    """Quantities that the result has, with their intervals; what makes an interval is a line of its own."""
    rows: list[Row] = []
    for label, value, words in (stated(quantity, result) for quantity in quantities if quantity.of(result) is not None):
        within, _, parts = words.partition(": ")
        rows += [(label, value, within), *([("", "", parts)] if parts else [])]
    return rows


def held_rows(result: Content) -> list[Row]:
    """kxx within a motion, of a set with rows on a spring."""
    stiffness = result["equilibrium"]["stiffness_rows_held"]
    how = "rows on the spring held as within a motion; above they follow"
    return [] if stiffness is None else [("kxx, rows held", KXX.text(stiffness[0][0]), how)]


def loaded_balls(result: Content, words: Sequence[str]) -> list[Row]:
    """The ``most`` and the ``least`` loaded ball, each where it is asked for; one row where all balls carry the same."""
    loads = [ball["load_inner_n"] for ball in result["equilibrium"]["balls"]]
    if number(min(loads), "N") == number(max(loads), "N") and min(loads) > 0.0:
        return [_loaded_ball(result, "most", True)] if "most" in words else []
    return [_loaded_ball(result, word, False) for word in words]


def _loaded_ball(result: Content, word: str, alike: bool) -> Row:
    """By row and number in its row, with azimuth; the most loaded one on the race where that is, then on the other one."""
    equilibrium, balls = result["equilibrium"], result["equilibrium"]["balls"]
    outer = word == "most" and equilibrium["largest_ball_load_race"] == "outer"
    own, other = ("outer", "inner") if outer else ("inner", "outer")
    pick = max if word == "most" else min
    index, ball = pick(enumerate(balls), key=lambda item: item[1][f"load_{own}_n"])
    place = sum(one.get("row") == ball.get("row") for one in balls[:index])
    name = f"row {ball['row']}, ball {place}" if "row" in ball else f"ball {place}"
    load, contact = number(ball[f"load_{own}_n"], "N"), f"{own} {_contact(ball, own)}"
    if word == "most":
        far = number(ball[f"load_{other}_n"], "N")
        contact += f"; {other} {f'{far}, ' if far != load else ''}{_contact(ball, other)}"
    if alike:
        return "all balls, each", load, contact
    return f"{word} loaded ball", load, f"{name} at {ball['azimuth_deg']:.4g} deg; {contact}"


def _contact(ball: ReadTables, race: str) -> str:
    """Pressure and angle; where finite elements tell their own pressures, both of theirs and Hertz's by name."""
    angle = ball[f"contact_angle_{race}_deg"]
    if angle is None:
        return "open"
    names = {"points": f"peak_pressure_points_{race}_pa", "nodal": f"peak_pressure_nodal_{race}_pa"}
    stresses = [f"{1e-6 * ball[key]:.0f} MPa {word}" for word, key in names.items() if ball.get(key) is not None]
    hertz = f"{1e-6 * ball[f'peak_pressure_{race}_pa']:.0f} MPa{' by Hertz' if stresses else ''}"
    return ", ".join([*stresses, hertz, f"{angle:.2f} deg"])
