"""Tables of ``raceway run``, from the content of result.json: the answer first."""

from __future__ import annotations

from typing import NamedTuple

from raceway.answers.answer import Part
from raceway.answers.quantities import (
    DRY,
    FORCE_AMPLITUDE,
    KXX,
    KYY,
    KYY_TILTS_FOLLOW,
    MASS,
    ORBIT_MAJOR,
    ORBIT_MINOR,
    PHASE_LAG,
    SPEED,
    C,
    K,
    Z,
    dry_damping_note,
)
from raceway.answers.table import Row, Words, micro, sections, tilt_words
from raceway.framework.duties import has_rollers
from raceway.framework.registry import default_registry
from raceway.pipeline.content import Content
from raceway.pipeline.run_parts import (
    bodies_rows,
    cost_row,
    equilibrium_rows,
    error_rows,
    held_rows,
    interval_rows,
    loaded_balls,
    orbit_rows,
    quantity_rows,
    stability_rows,
)
from raceway.scene.sets import GEOMETRY, signs_of
from raceway.storage.tables import ReadTables

#: An orbit whose minor axis is a smaller share of the major one is a line: the rest is rounding.
_LINE = 1e-9
#: Rows that stand or fall with Z.
_OF_Z = (
    *(quantity.label for quantity in (K, C, Z, PHASE_LAG)), "loss factor", "orbit, semi-axes",
)  # fmt: skip


def _answer_rows(result: Content) -> list[Row]:
    """The first section."""
    identification = result["identification"]
    if identification is None:
        return [
            (
                f"Answer of a static scene, {tilt_words(result['scene']['supports']['tilt'])}",
                "",
                "without a table [excitation] no K(w), C or orbit is identified",
            ),
            *interval_rows(result, KXX, KYY, KYY_TILTS_FOLLOW),
            *held_rows(result),
            *loaded_balls(result, ["most"]),
        ]
    major, minor = ORBIT_MAJOR.of(result), ORBIT_MINOR.of(result)
    thin, dry = minor <= _LINE * major, dry_damping_note(result)
    axes = f"{ORBIT_MAJOR.read(major):.4g} x {'0' if thin else f'{ORBIT_MINOR.read(minor):.4g}'} {ORBIT_MAJOR.read_unit}"
    force = f"{FORCE_AMPLITUDE.text(FORCE_AMPLITUDE.of(result), 4)} {result['scene']['excitation']['kind']}"
    return [
        (f"Answer at {SPEED.of(result):g} r/min, {force}, {tilt_words(identification['tilt'])}", "", ""),
        *interval_rows(result, K),
        *_damping_rows(result, identification),
        Z.fact(result, f"{identification['definition'].partition(':')[0]}, m = {MASS.of(result):.4g} kg"),
        ("orbit, semi-axes", axes, f"synchronous (1x){', a line' if thin else ''}"),
        *([("", "", dry)] if dry else []),
    ]


def _damping_rows(result: Content, identification: ReadTables) -> list[Row]:
    """C with its origin; of a band C, loss factor and phase at both ends."""
    band, origin = identification["band"], identification["damping_origin"]
    if band is None:
        name, value, remark = C.fact(result, origin)
        return [(name, value, origin if origin == DRY else remark)]
    low, high = band["loss_factor"]
    return [
        (C.label, C.span(band[C.name], 3), origin),
        ("loss factor", f"{low:.3g} to {high:.3g}", "w C / K at both ends; other numbers are of the low end"),
        (PHASE_LAG.label, PHASE_LAG.span(band["phase_lag_deg"], 3), PHASE_LAG.words),
    ]


_LEFT_OUT_SHOWN = 2


class Screen(NamedTuple):
    """What is shown of a run: title, bearing and model (lines), sentences of doubt, quantities with value and remark, what is left out."""

    title: str
    bearing: str
    warnings: list[str]
    rows: list[Row]
    left_out: str


def screen(result: Content) -> Screen:
    """Of one run, from the content of result.json."""
    rows = [*_answer_rows(result), *equilibrium_rows(result), *quantity_rows(result)]
    if result["tolerances"]:
        from raceway.pipeline.first_order import tolerance_rows

        rows += tolerance_rows(result["tolerances"])
    # The rows without the numbers that a part of the error of Z is as large as, or larger.
    parts = result["error"]["unresolved"]
    why = f"the error of Z ({', '.join(parts)}) is as large as Z" if parts else ""
    rows = [(name, "not resolved", why) if parts and name in _OF_Z else (name, value, note) for name, value, note in rows]
    rows += bodies_rows(result["model"])
    rows += orbit_rows(result["motion"]["orbits"] if result["motion"] else [])
    rows += [("Error and cost", "", ""), *error_rows(result), *stability_rows(result["stability"]), cost_row(result["cost"])]
    # Geometry, arrangement and model, one per line.
    scene, angle = result["scene"], f"{result['equilibrium']['free_contact_angle_deg']:.5g} deg"
    b = scene["bearing"]
    kinds = default_registry().entries.get(("bodies", scene["bodies"]["kind"]), [])
    rollers = any(has_rollers(entry.plugin) for entry in kinds)
    if b.get("radial_clearance") and not b.get("contact_angle_deg") and not rollers:
        angle += ", from the clearance"
    balls = f"{b['ball_count']} {'rollers' if rollers else 'balls'} of {1e3 * b['ball_diameter']:g} mm on {1e3 * b['pitch_diameter']:g} mm"
    geometry = result["geometry"] or {}
    maker = f"; maker {geometry['maker'] or 'not said'}" if geometry else ""
    words = [f"{b.get('preset') or 'own geometry'}: {balls}, contact angle {angle}{maker}"]
    if b.get("arrangement", "single") != "single" or b.get("row"):
        # Arrangement, distances and preload of a set of rows.
        bearing = b
        kind, own = bearing.get("arrangement", "single"), bearing.get("row") or []
        forces = f"{bearing['preload']:g} N" if bearing.get("preload") else "the rows' own forces"
        if bearing.get("second_preload"):
            forces += f" and {bearing['second_preload']:g} N"
        has_preload = bearing.get("preload") or any(row.get("preload") for row in own)
        each = " of each row, as ground" if bearing.get("preload_of") == "row" else ""
        mounting = (
            f"preload {forces}{each} before mounting ({bearing['preload_kind']})" if has_preload else "without preload"
        )
        count = len(own) if kind == "single" else len(signs_of(kind))
        apart = bearing.get("row_distance") or bearing.get("width")
        places = (
            ", ".join(f"{1e3 * row['position']:g}" for row in own) + " mm"
            if own and all(row.get("position") is not None for row in own)
            else f"{1e3 * (apart or 0.0):g} mm apart"
        )
        what = "unequal rows, see bearing.row" if any(set(row) & set(GEOMETRY) for row in own) else "rows of these balls"
        name = f"pair {kind}, {_PAIRS[kind]}" if kind in _PAIRS else f"set {kind}" if kind != "single" else "set of rows"
        words.append(f"{name}: {'two' if count == 2 else count} {what}, {places}, {mounting}")
    words += [geometry["designation"]] if "designation" in geometry else []
    law = f"law {scene['contact']['kind']}, {scene['contact']['discretisation']}"
    if method := result["plan"].get("integrator"):  # ``raceway plan`` has the reason
        law += f"; integrator {method['kind']}{', by default' if method['why'] else ''}"
    words.append(f"{scene['bodies']['kind']} bodies, {law}")
    omitted = [row["part"] for row in result["plan"]["left_out"]]
    more = f" and {len(omitted) - _LEFT_OUT_SHOWN} more" if len(omitted) > _LEFT_OUT_SHOWN else ""
    left_out = f"left out: {', '.join(omitted[:_LEFT_OUT_SHOWN])}{more} (raceway plan)"
    return Screen(result["title"], "\n".join(words), [micro(text) for text in result["warnings"]], rows, left_out)


def report(result: Content) -> list[Part]:
    """Of a terminal: what makes the numbers doubtful is read before them, how the bearing is arranged and modelled after them."""
    rows = screen(result)
    bearing, *model = rows.bearing.splitlines()
    return [
        *(Words(f"warning: {text}", "yellow") for text in rows.warnings),
        Words(rows.title, "bold"),
        Words(bearing, "dim"),
        sections(rows.rows),
        Words("\n".join([*model, rows.left_out]), "dim"),
    ]


#: How the rows of a pair stand to each other.
_PAIRS = {"DB": "back to back", "DF": "face to face", "DT": "tandem"}
