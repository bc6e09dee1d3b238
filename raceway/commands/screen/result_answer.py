"""The answer of a run, which stands first: K, C, |Z| and orbit; of a static scene the tangent stiffness and the loads."""

from __future__ import annotations

from collections.abc import Sequence

from raceway.commands.screen.damping import dry_damping_note
from raceway.commands.screen.text import Row, number, number_within, tilt_words
from raceway.storage.tables import ReadTables

#: An orbit whose minor axis is a smaller share of the major one is a line: the rest is rounding.
_LINE = 1e-9


def answer_rows(result: ReadTables) -> list[Row]:
    """The first section."""
    found = result["identification"]
    if found is None:
        return _static(result)
    z, orbit, mass = found["dynamic_stiffness"], found["orbit"], found["mass_used_kg"]
    thin = orbit["minor_m"] <= _LINE * orbit["major_m"]
    minor = "0" if thin else f"{1e6 * orbit['minor_m']:.4g}"
    dry = dry_damping_note(result)
    return [
        (f"Answer at {found['speed_rpm']:g} r/min, {tilt_words(found['tilt'])}", "", ""),
        _stiffness(found, f"K = Re Z + m w^2, m = {mass:.4g} kg"),
        *damping_rows(found),
        ("|Z|", number(1e-6 * z["abs"], "N/µm"), "dynamic stiffness, force over displacement"),
        ("orbit, semi-axes", f"{1e6 * orbit['major_m']:.4g} x {minor} µm", f"1x motion{', a line' if thin else ''}"),
        *([("", "", dry)] if dry else []),
    ]


def damping_rows(found: ReadTables) -> list[Row]:
    """C with its origin; of a band C, loss factor and phase at both ends."""
    band, origin = found["band"], found["damping_origin"]
    if band is None:
        row = resolved(
            "equivalent damping C", found["equivalent_damping"], found["equivalent_damping_error"], "N s/m", origin
        )
        return [row]
    return [
        ("equivalent damping C", _range(band["equivalent_damping"], "N s/m"), origin),
        ("loss factor", _range(band["loss_factor"]), "w C / K at both ends; all else is that of the low end"),
        ("phase lag", _range(band["phase_lag_deg"], "deg"), "displacement behind force"),
    ]


def _range(ends: Sequence[float], unit: str = "") -> str:
    return f"{ends[0]:.3g} to {ends[1]:.3g} {unit}".rstrip()


def _static(result: ReadTables) -> list[Row]:
    return [
        ("Answer of a static scene", "", "without a table [excitation] there is no K(w), C or orbit to identify"),
        *tangent_rows(result),
        *loaded_balls(result, ["most"]),
    ]


def tangent_rows(result: ReadTables) -> list[Row]:
    """kxx, kyy, and kyy with tilts that follow."""
    found, tilt = result["equilibrium"], result["scene"]["supports"]["tilt"]
    k = found["stiffness"]
    rows = [
        ("tangent kxx", number(1e-6 * k[0][0], "N/µm"), "axial, other motions held"),
        ("tangent kyy", number(1e-6 * k[1][1], "N/µm"), "radial, tilt and other motions held"),
    ]
    if tilt != "locked":
        follow = number(1e-6 * found["kyy_tilts_follow_n_per_m"], "N/µm")
        rows.append((f"kyy, {tilt_words(tilt)}", follow, "tilts follow, x and z held"))
    return rows


def loaded_balls(result: ReadTables, words: Sequence[str]) -> list[Row]:
    """The ``most`` and the ``least`` loaded ball, each where it is asked for; one row where all balls carry the same."""
    loads = [ball["load_inner_n"] for ball in result["equilibrium"]["balls"]]
    if number(min(loads), "N") == number(max(loads), "N") and min(loads) > 0.0:
        return [_loaded_ball(result, "most", True)] if "most" in words else []
    return [_loaded_ball(result, word, False) for word in words]


def _loaded_ball(result: ReadTables, word: str, alike: bool) -> Row:
    """By row and number in its row, with load, azimuth and pressure."""
    balls = result["equilibrium"]["balls"]
    pick = max if word == "most" else min
    index, ball = pick(enumerate(balls), key=lambda item: item[1]["load_inner_n"])
    place = sum(one.get("row") == ball.get("row") for one in balls[:index])
    name = f"row {ball['row']}, ball {place}" if "row" in ball else f"ball {place}"
    angle = ball["contact_angle_inner_deg"]
    pressure = f"inner race {_pressure(ball)}, {angle:.2f} deg" if angle is not None else "open"
    if alike:
        return "all balls, each", number(ball["load_inner_n"], "N"), pressure
    return f"{word} loaded ball", number(ball["load_inner_n"], "N"), f"{name} at {ball['azimuth_deg']:.4g} deg; {pressure}"


def _pressure(ball: ReadTables) -> str:
    """Of the inner race; where finite elements tell their own, both of theirs and Hertz's by name."""
    names = {"points": "peak_pressure_points_inner_pa", "nodal": "peak_pressure_nodal_inner_pa"}
    told = [f"{1e-6 * ball[key]:.0f} MPa {word}" for word, key in names.items() if ball.get(key) is not None]
    hertz = f"{1e-6 * ball['peak_pressure_inner_pa']:.0f} MPa"
    return ", ".join([*told, f"{hertz} by Hertz"]) if told else hertz


def _stiffness(found: ReadTables, remark: str) -> Row:
    """K with the absolute error of Z, which is larger than the same share of K where m w^2 cancels K."""
    name, value, error = "equivalent stiffness K", found["equivalent_stiffness"], found["equivalent_stiffness_error"]
    if error is None:
        return name, number(1e-6 * value, "N/µm"), f"error not estimated; {remark}"
    told = f"{number(1e-6 * error, 'N/µm', 2)}; {remark}"
    if abs(value) < error:
        return name, "not resolved", f"below its error of {told}"
    return name, number_within(1e-6 * value, 1e-6 * error, "N/µm"), f"+- {told}"


def resolved(name: str, value: float, error: float | None, unit: str, remark: str) -> Row:
    """A small part of Z beside its absolute error; what is smaller than its error is not shown as a number."""
    if error is None:
        return name, number(value, unit, 3), remark
    if abs(value) < error:
        return name, "not resolved", f"below its error of {number(error, unit, 2)}; {remark}"
    return name, number(value, unit, 3), f"+- {number(error, unit, 2)}; {remark}"
