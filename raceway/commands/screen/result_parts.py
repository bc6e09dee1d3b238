"""Sections of a run below its answer: equilibrium, dynamic stiffness, error, cost."""

from __future__ import annotations

from collections.abc import Sequence

from raceway.commands.screen.result_answer import loaded_balls, tangent_rows
from raceway.commands.screen.text import Row, number, tilt_words
from raceway.framework.shown import in_micro, read_in, within
from raceway.storage.tables import ReadTables

#: Axial forces below this are rounding.
_ROUNDING_N = 1e-6


def equilibrium_rows(result: ReadTables) -> list[Row]:
    """Displacement and loads; the tangent stiffness where it is not the answer itself."""
    found, tilt = result["equilibrium"], result["scene"]["supports"]["tilt"]
    moved, dynamic = found["displacement"], result["identification"] is not None
    rows = [
        ("Equilibrium under the constant loads", "", ""),
        ("displacement x", number(1e6 * moved["x"], "µm"), "axial, positive seats the bearing"),
        ("displacement y, z", f"{in_micro(moved['y'])}, {in_micro(moved['z'])} µm", "radial"),
    ]
    if tilt != "locked":
        tilts = ", ".join(in_micro(moved[name]) for name in ("tilt_y", "tilt_z"))
        rows.append(("tilt_y, tilt_z", f"{tilts} µrad", tilt_words(tilt)))
    rows += _mounted(found)
    rows += loaded_balls(result, ["most", "least"] if dynamic else ["least"])
    return rows + (tangent_rows(result) if dynamic else [])


def film_rows(result: ReadTables) -> list[Row]:
    """The thinnest film of both races, where the law has one: the ball, its regime, and Lambda."""
    found = result["equilibrium"]
    if "inner_film_minimum_m" not in found["balls"][0]:
        return []
    law, rows = found["law"], list[Row]()
    told = f"{number(1e3 * law['viscosity_pa_s'], 'mPa s')}, {number(1e9 * law['pressure_viscosity_per_pa'], '1/GPa')}"
    reduced = min(ball[f"{race}_film_thermal_reduction"] for ball in found["balls"] for race in ("inner", "outer"))
    heat = "isothermal" if law["inlet_heating"] == "none" else f"thermal reduction {reduced:.2g}"
    rows.append(("Oil film", "", f"Hamrock and Dowson: smooth, {heat}; it stands the surfaces off"))
    rows.append(("viscosity, alpha", told, "at the running temperature; pressure-viscosity coefficient"))
    for race in ("inner", "outer"):
        index, ball = min(enumerate(found["balls"]), key=lambda item: item[1][f"{race}_film_minimum_m"])
        central, least = (1e6 * ball[f"{race}_film_{name}_m"] for name in ("central", "minimum"))
        parameter = ball[f"{race}_film_parameter"]
        smooth = "no contact.roughness: no Lambda" if parameter is None else f"Lambda {parameter:.3g}"
        value = f"{central:.4g}, {least:.4g} µm"
        speed = number(ball[f"{race}_entraining_speed_m_per_s"], "m/s")
        rows.append((f"{race} h_c, h_min", value, f"ball {index}, {speed}, {ball[f'{race}_film_regime']}; {smooth}"))
    return rows


def _mounted(found: ReadTables) -> list[Row]:
    """Preload and held axial force: running, mounted and before mounting."""
    rows, preload, held = [], found["preload"], found["held_axial"]
    if preload is not None:
        forces = ", ".join(number(force) for force in preload["rows_n"])
        what = {"rigid": "the offset of the rows", "spring": "the force of the rows on the spring"}[preload["kind"]]
        first = dict.fromkeys(f"{preload[name]:.5g}" for name in ("before_mounting_n", "second_before_mounting_n"))
        before = f"before mounting {' and '.join(first)} N, mounted {preload['mounted_n']:.5g} N"
        how = f"running, without loads; {before}; {what} stays"
        rows.append(("preload", number(preload["running_n"], "N"), how))
        rows.append(("axial force of rows", f"{forces} N", f"rows 1 to {len(preload['rows_n'])} under the loads"))
    if held is not None:
        before = f"before mounting {held['before_mounting_n']:g} N, mounted {held['mounted_n']:.5g} N"
        how = f"what the held displacement takes now; {before}"
        running = held["running_n"] if abs(held["running_n"]) > _ROUNDING_N else 0.0
        rows.append(("axial force", number(running, "N"), how))
    return rows


def ball_pass_rows(found: ReadTables) -> list[Row]:
    """Frequencies of cage, balls and ball passes over the shaft's, of each row that differs."""
    words = ("contact_angle_deg", "ftf", "bsf", "bpfo", "bpfi")
    rows: list[Row] = []
    told = {tuple(f"{one[word]:.4g}" for word in words): (k, one) for k, one in reversed([*enumerate(found["rows"], 1)])}
    for (angle, cage, spin, outer, inner), (k, one) in sorted(told.items(), key=lambda item: item[1][0]):
        row = f" of row {k}" if len(told) > 1 else ""
        rows.append((f"Ball pass{row} at {angle} deg, times the shaft's speed", "", ""))
        rows.append(("cage FTF, ball BSF", f"{cage}, {spin}", _hertz(one, found["speed_rpm"], "ftf", "bsf")))
        rows.append(("passes BPFO, BPFI", f"{outer}, {inner}", _hertz(one, found["speed_rpm"], "bpfo", "bpfi")))
    return rows


def _hertz(one: ReadTables, speed: float, *names: str) -> str:
    return ", ".join(f"{one[name + '_hz']:.5g}" for name in names) + " Hz" if speed else ""


def tolerance_rows(found: ReadTables | None) -> list[Row]:
    """The band over the scene's tolerances to first order; of each answer the tolerance that makes most of it."""
    if not found:
        return []
    rows: list[Row] = [("Tolerances, 95 % to first order", "", found["why"])]
    for name, one in found["quantities"].items():
        (low, unit), (high, _) = (read_in(one[end], one["unit"]) for end in ("low", "high"))
        key, share = max(one["shares"].items(), key=lambda item: item[1], default=("", 0.0))
        told = [f"{100.0 * share:.0f} % of the variance by {key}"] if share else []
        told += [one["definition"]] if name in ("kyy", "kyy_tilts_follow", "largest_ball_load") else []
        rows.append((name.replace("_", " "), f"{low:.5g} to {high:.5g} {unit}", "; ".join(told)))
    rows += [("", "", f"without {one['key']}: {one['reason']}") for one in found["left_out"]]
    return rows


def stiffness_rows(result: ReadTables) -> list[Row]:
    """Parts of Z and the force that they belong to."""
    found = result["identification"]
    if found is None:
        return []
    z, across, definition = found["dynamic_stiffness"], found["dynamic_stiffness_imag_error"], found["definition"]
    excited = result["scene"]["excitation"]["kind"]
    lag = found["phase_lag_deg"], found["phase_lag_error_deg"]
    return [
        ("Dynamic stiffness Z", "", definition.partition(", ")[0]),
        ("force", number(found["force_amplitude_n"], "N"), f"{excited}, {found['frequency_hz']:g} Hz"),
        ("Z real", number(1e-6 * z["real"], "N/µm"), "force over displacement"),
        within("Z imaginary", z["imag"], across, 1e-6, "N/µm", "w C"),
        within("phase lag", *lag, 1.0, "deg", "displacement behind force"),
    ]


def error_rows(result: ReadTables) -> list[Row]:
    """Relative errors of Z, each with how it was estimated; of a static scene those that are known."""
    error = result["error"]
    rows: list[Row] = [("Relative error of Z", "", "")]
    static = result["identification"] is None
    for name in ("total", "time_step", "transient", "identification", "mesh", "contact"):
        value = error.get(name)
        if value is not None or not static:
            rows.append((name.replace("_", " "), "not estimated" if value is None else f"{value:.1e}", error["short"][name]))
    if static:
        return [("Relative error of stiffness", "", ""), *rows[1:]] if rows[1:] else []
    known = [one for one in result["identification"].get("series", []) if one["error"] is not None]
    if known:
        worst = max(known, key=lambda one: one["error"])
        how = f"at {worst['speed_rpm']:.6g} r/min; of {len(known)} windows, each with its own in result.json"
        rows.insert(2, ("largest of the series", f"{worst['error']:.1e}", how))
    return rows


def orbit_rows(found: Sequence[ReadTables]) -> list[Row]:
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


def cost_rows(cost: ReadTables) -> list[Row]:
    """Time and memory."""
    memory, threads = cost["peak_memory_bytes"] / 2**20, cost["threads"]
    kept = "kernels were in the cache (raceway cache)"
    if cost["compile_s"]:
        kept = "once; kept for the next run (raceway cache)"
        if not cost.get("compiled_kept", True):
            kept = "not kept: the cache cannot be written; the next run compiles again"
    processor = f"{number(cost['cpu_s'], 'CPU-s', 3)}, " if "cpu_s" in cost else ""
    told = f"{processor}{cost['steps']} steps, {memory:.0f} MiB, {threads} thread{'' if threads == 1 else 's'}"
    return [
        ("Cost", "", ""),
        ("wall time", number(cost["wall_s"], "s", 3), told),
        ("compiling, apart", number(cost["compile_s"], "s", 3), kept),
    ]


def stability_rows(found: ReadTables) -> list[Row]:
    """How the motion ended; nothing where none was integrated."""
    limit, drift = found["critical_time_step_s"], found["energy_drift"]
    words = [] if limit is None else [f"explicit limit {limit:.3g} s"]
    words += [] if drift is None else [f"energy drift {drift:.1e}"]
    return [("Stability", "", ""), ("status", found["status"], ", ".join(words))] if words else []
