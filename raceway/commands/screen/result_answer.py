"""The answer of a run, which stands first: K, C, |Z| and orbit; of a static scene the tangent stiffness and the loads."""

from __future__ import annotations

from collections.abc import Sequence

from raceway.commands.screen.damping import dry_damping_note
from raceway.commands.screen.text import Row, number, tilt_words
from raceway.framework.shown import percents, within
from raceway.storage.tables import ReadTables

#: An orbit whose minor axis is a smaller share of the major one is a line: the rest is rounding.
_LINE = 1e-9
#: Rows that stand or fall with Z.
_OF_Z = (
    "equivalent stiffness K", "equivalent damping C", "|Z|", "Z real", "Z imaginary", "loss factor", "phase lag", "orbit, semi-axes",
)  # fmt: skip
#: Relative change of a stiffness by a hypothesis below which it is not told.
LEAST_CHANGE = 1e-3


def answer_rows(result: ReadTables) -> list[Row]:
    """The first section."""
    found = result["identification"]
    if found is None:
        return _static(result)
    z, orbit, mass = found["dynamic_stiffness"], found["orbit"], found["mass_used_kg"]
    thin = orbit["minor_m"] <= _LINE * orbit["major_m"]
    minor = "0" if thin else f"{1e6 * orbit['minor_m']:.4g}"
    dry, remark = dry_damping_note(result), f"K = Re Z + m w^2, m = {mass:.4g} kg"
    return [
        (f"Answer at {found['speed_rpm']:g} r/min, {tilt_words(found['tilt'])}", "", ""),
        # The error of Z: larger than the same share of K where m w^2 cancels K.
        within(
            "equivalent stiffness K",
            found["equivalent_stiffness"],
            found["equivalent_stiffness_error"],
            1e-6,
            "N/µm",
            remark,
        ),
        *model_rows(result, "equivalent_stiffness", "kyy_tilts_follow", "kyy"),
        *damping_rows(found),
        ("|Z|", number(1e-6 * z["abs"], "N/µm"), "dynamic stiffness, force over displacement"),
        ("orbit, semi-axes", f"{1e6 * orbit['major_m']:.4g} x {minor} µm", f"1x motion{', a line' if thin else ''}"),
        *([("", "", dry)] if dry else []),
    ]


def only_resolved(rows: Sequence[Row], error: ReadTables) -> list[Row]:
    """The rows without the numbers that a part of the error of Z is as large as, or larger."""
    parts = error.get("unresolved")
    why = f"the error of Z ({', '.join(parts)}) is as large as Z" if parts else ""
    return [(name, "not resolved", why) if parts and name in _OF_Z else (name, value, note) for name, value, note in rows]


def damping_rows(found: ReadTables) -> list[Row]:
    """C with its origin; of a band C, loss factor and phase at both ends."""
    band, origin = found["band"], found["damping_origin"]
    if band is None:
        damping, error = found["equivalent_damping"], found["equivalent_damping_error"]
        return [within("equivalent damping C", damping, error, 1.0, "N s/m", origin)]
    return [
        ("equivalent damping C", _range(band["equivalent_damping"], "N s/m"), origin),
        ("loss factor", _range(band["loss_factor"]), "w C / K at both ends; all else is that of the low end"),
        ("phase lag", _range(band["phase_lag_deg"], "deg"), "displacement behind force"),
    ]


def _range(ends: Sequence[float], unit: str = "") -> str:
    return f"{ends[0]:.3g} to {ends[1]:.3g} {unit}".rstrip()


def model_rows(result: ReadTables, *quantities: str) -> list[Row]:
    """Change of the first quantity known by each hypothesis left at its default and by all of them; nothing below 0.1 %."""
    spread, why = result["error"]["model"], result["error"]["short"]["model"]
    if spread is None:
        return [("", "", f"model: change by hypotheses left at their defaults {why}")] if why else []
    name = next((one for one in quantities if spread[one] is not None), "")
    of = "" if name in ("", "equivalent_stiffness") else f"{name.replace('_', ' ')} "
    rows: list[Row] = []
    for key, what in (("kinematics.gyroscopic", "gyroscopic moments"), ("kinematics.ring_growth", "ring growth")):
        changes = [one[name] for one in spread["hypotheses"] if name and one["key"] == key and one[name] is not None]
        if max(map(abs, changes), default=0.0) >= LEAST_CHANGE:
            rows.append(("", "", f"model: {what} would give {of}{percents(*changes)}: {key}"))
    together = [("", "", f"model: over all of them {of}{percents(*spread[name])}: error.model")] if len(rows) > 1 else []
    return rows + together


def _static(result: ReadTables) -> list[Row]:
    return [
        ("Answer of a static scene", "", "without a table [excitation] there is no K(w), C or orbit to identify"),
        *tangent_rows(result),
        *model_rows(result, "kyy_tilts_follow", "kyy"),
        *loaded_balls(result, ["most"]),
    ]


def tangent_rows(result: ReadTables) -> list[Row]:
    """kxx, kyy, and kyy with tilts that follow."""
    found, tilt = result["equilibrium"], result["scene"]["supports"]["tilt"]
    k = found["stiffness"]
    rows = [
        ("tangent kxx", number(1e-6 * k[0][0], "N/µm"), "axial, other motions held"),
        ("tangent kyy", number(1e-6 * k[1][1], "N/µm"), "radial, tilts and other motions held"),
    ]
    if tilt != "locked":
        follow = number(1e-6 * found["kyy_tilts_follow_n_per_m"], "N/µm")
        rows.append(("kyy tilts follow", follow, f"{tilt_words(tilt)}: tilts follow, x and z held"))
    if found["stiffness_rows_held"] is not None:
        held = number(1e-6 * found["stiffness_rows_held"][0][0], "N/µm")
        rows.append(("kxx, rows held", held, "rows on the spring held as within a motion; above they follow"))
    return rows


def loaded_balls(result: ReadTables, words: Sequence[str]) -> list[Row]:
    """The ``most`` and the ``least`` loaded ball, each where it is asked for; one row where all balls carry the same."""
    loads = [ball["load_inner_n"] for ball in result["equilibrium"]["balls"]]
    if number(min(loads), "N") == number(max(loads), "N") and min(loads) > 0.0:
        return [_loaded_ball(result, "most", True)] if "most" in words else []
    return [_loaded_ball(result, word, False) for word in words]


def _loaded_ball(result: ReadTables, word: str, alike: bool) -> Row:
    """By row and number in its row, with azimuth; the most loaded one on the race where that is, then on the other one."""
    found, balls = result["equilibrium"], result["equilibrium"]["balls"]
    outer = word == "most" and found["largest_ball_load_race"] == "outer"
    own, other = ("outer", "inner") if outer else ("inner", "outer")
    pick = max if word == "most" else min
    index, ball = pick(enumerate(balls), key=lambda item: item[1][f"load_{own}_n"])
    place = sum(one.get("row") == ball.get("row") for one in balls[:index])
    name = f"row {ball['row']}, ball {place}" if "row" in ball else f"ball {place}"
    load, contact = number(ball[f"load_{own}_n"], "N"), f"{own} race {_contact(ball, own)}"
    if word == "most":
        contact += f"; {other} race {number(ball[f'load_{other}_n'], 'N')}, {_contact(ball, other)}"
    if alike:
        return "all balls, each", load, contact
    return f"{word} loaded ball", load, f"{name} at {ball['azimuth_deg']:.4g} deg; {contact}"


def _contact(ball: ReadTables, race: str) -> str:
    """Pressure and angle; where finite elements tell their own pressures, both of theirs and Hertz's by name."""
    angle = ball[f"contact_angle_{race}_deg"]
    if angle is None:
        return "open"
    names = {"points": f"peak_pressure_points_{race}_pa", "nodal": f"peak_pressure_nodal_{race}_pa"}
    told = [f"{1e-6 * ball[key]:.0f} MPa {word}" for word, key in names.items() if ball.get(key) is not None]
    hertz = f"{1e-6 * ball[f'peak_pressure_{race}_pa']:.0f} MPa{' by Hertz' if told else ''}"
    return ", ".join([*told, hertz, f"{angle:.2f} deg"])
