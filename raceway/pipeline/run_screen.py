"""Tables of ``raceway run``, from the content of result.json: the answer first."""

from logging import INFO, getLogger
from typing import NamedTuple

from raceway.answers import quantities as q
from raceway.answers.answer import Part
from raceway.answers.table import WIDTH, Row, Words, height, in_a_line, lines_of, micro, rooms, sections, tilt_words
from raceway.framework.duties import has_rollers
from raceway.framework.loading.registry import default_registry
from raceway.pipeline import run_parts
from raceway.pipeline.content import Content
from raceway.pipeline.run_parts import bodies_rows, cost_row, equilibrium_rows, error_rows, orbit_rows, stability_rows
from raceway.scene.designation import GEOMETRY, signs_of
from raceway.storage.tables import ReadTables

#: An orbit whose minor axis is a smaller share of the major one is a line: the rest is rounding.
_LINE = 1e-9
#: Rows that stand or fall with Z.
_OF_Z = (
    *(quantity.label for quantity in (q.K, q.C, q.Z, q.PHASE_LAG)), "loss factor", "orbit, semi-axes",
)  # fmt: skip


def _answer_rows(result: Content) -> list[Row]:
    identification = result["identification"]
    if identification is None:
        spin = result["scene"]["kinematics"].get("spin_speed_rpm")
        at = f"{spin:g} r/min" if spin else "rest"
        return [
            (f"Answer at {at}, {tilt_words(result['scene']['supports']['tilt'])}", "", ""),
            *run_parts.interval_rows(result, q.KXX, q.KYY, q.KYY_TILTS_FOLLOW),
            *run_parts.held_rows(result),
            *run_parts.loaded_balls(result, ["most"]),
        ]
    major, minor = q.ORBIT_MAJOR.of(result), q.ORBIT_MINOR.of(result)
    thin = minor <= _LINE * major
    axes = (
        f"{q.ORBIT_MAJOR.read(major):.4g} x {'0' if thin else f'{q.ORBIT_MINOR.read(minor):.4g}'} {q.ORBIT_MAJOR.read_unit}"
    )
    force = f"{q.FORCE_AMPLITUDE.text(q.FORCE_AMPLITUDE.of(result), 4)} {result['scene']['excitation']['kind']}"
    return [
        (f"Answer at {q.SPEED.of(result):g} r/min, {force}, {tilt_words(identification['tilt'])}", "", ""),
        *run_parts.interval_rows(result, q.K),
        *_damping_rows(result, identification),
        q.Z.fact(result, f"{identification['definition'].partition(':')[0]}, m = {q.MASS.of(result):.4g} kg"),
        ("orbit, semi-axes", axes, f"synchronous (1x){', a line' if thin else ''}"),
    ]


def _damping_rows(result: Content, identification: ReadTables) -> list[Row]:
    """C with its origin; of a band C, loss factor and phase at both ends."""
    band, origin = identification["band"], identification["damping_origin"]
    if band is None:
        name, value, remark = q.C.fact(result, origin)
        rule = (q.dry_damping_note(result) or "").partition(" gives ")[2].partition(":")[0]
        return [(name, value, f"{'dry; ' if origin == q.DRY else ''}by 1.25e-5 s K: {rule}" if rule else remark)]
    low, high = band["loss_factor"]
    return [
        (q.C.label, q.C.span(band[q.C.name], 3), origin),
        ("loss factor", f"{low:.3g} to {high:.3g}", "w C / K at both ends; other numbers are of the low end"),
        (q.PHASE_LAG.label, q.PHASE_LAG.span(band["phase_lag_deg"], 3), q.PHASE_LAG.words),
    ]


#: Lines of a screen, of which one names the file.
_LINES = 28
#: Rows that a full screen has no room for, the first first, by their names, or by what remarks without a name begin with.
_DETAILS = (
    "energies", "unbalanced force", "penetration share", "phase lag", "stability", "axial force of rows", "FTF", "row 1: FTF", "row 2: FTF",
    "row 3: FTF", "tilt_y, tilt_z", "replaced by the law", "structural compliance", "load P, static s0", "equivalent load P",
    "nodes per semi-axis", "lowest elastic mode", "displacement y, z", "loss factor", "kxx, rows held", "least loaded ball",
)  # fmt: skip


class Screen(NamedTuple):
    """What is shown of a run: title, bearing and model (lines), sentences of doubt, quantities with value and remark, what is left out."""

    title: str
    bearing: str
    warnings: list[str]
    rows: list[Row]
    left_out: str


def screen(result: Content) -> Screen:
    """Of one run, from the content of result.json."""
    rows = [*_answer_rows(result), *equilibrium_rows(result), *run_parts.quantity_rows(result)]
    if result["tolerances"]:
        from raceway.pipeline.first_order import tolerance_rows

        rows += tolerance_rows(result["tolerances"])
    # The rows without the numbers that a part of the error of Z is as large as, or larger.
    parts = result["error"]["unresolved"]
    lost = {name: "-" for name, _, _ in rows if name in _OF_Z and parts}
    why = dict.fromkeys(list(lost)[:1], f"not resolved: the error of Z ({', '.join(parts or ())}) is as large as Z")
    rows = [(name, lost.get(name, value), why.get(name, "" if name in lost else note)) for name, value, note in rows]
    rows += bodies_rows(result["model"])
    rows += orbit_rows(result["motion"]["orbits"] if result["motion"] else [])
    rows += [("Error and cost", "", ""), *error_rows(result), *stability_rows(result["stability"])]
    rows.append(cost_row(result["cost"]))
    # Geometry, arrangement and model, one per line.
    scene, angle = result["scene"], f"{result['equilibrium']['free_contact_angle_deg']:.5g} deg"
    b = scene["bearing"]
    kinds = default_registry().entries.get(("bodies", scene["bodies"]["kind"]), [])
    rollers = any(has_rollers(entry.plugin) for entry in kinds)
    if b.get("radial_clearance") and not b.get("contact_angle_deg") and not rollers:
        angle += ", from the clearance"
    balls = f"{b['ball_count']} {'rollers' if rollers else 'balls'} of {1e3 * b['ball_diameter']:g} mm on {1e3 * b['pitch_diameter']:g} mm"
    geometry = result["geometry"] or {}
    maker = f"; maker {geometry['maker']}" if geometry.get("maker") else ""
    words = [f"{b.get('preset') or 'own geometry'}: {balls}, contact angle {angle}{maker}"]
    if b.get("arrangement", "single") != "single" or b.get("row"):
        # Arrangement, distances and preload of a set of rows.
        kind, own = b.get("arrangement", "single"), b.get("row") or []
        forces = f"{b['preload']:g} N" if b.get("preload") else "the rows' own forces"
        if b.get("second_preload"):
            forces += f" and {b['second_preload']:g} N"
        has_preload = b.get("preload") or any(row.get("preload") for row in own)
        each = " of each row, as ground" if b.get("preload_of") == "row" else ""
        mounting = f"preload {forces}{each} before mounting ({b['preload_kind']})" if has_preload else "without preload"
        count = len(own) if kind == "single" else len(signs_of(kind))
        apart = b.get("row_distance") or b.get("width")
        places = (
            ", ".join(f"{1e3 * row['position']:g}" for row in own) + " mm"
            if own and all(row.get("position") is not None for row in own)
            else f"{1e3 * (apart or 0.0):g} mm apart"
        )
        what = "unequal rows, see bearing.row" if any(set(row) & set(GEOMETRY) for row in own) else "rows of these balls"
        name = f"pair {kind}, {_PAIRS[kind]}" if kind in _PAIRS else f"set {kind}" if kind != "single" else "set of rows"
        words.append(f"{name}: {'two' if count == 2 else count} {what}, {places}, {mounting}")
    spread = scene["contact"]["discretisation"]
    law = f"law {scene['contact']['kind']}{'' if spread == 'resultant' else f', {spread}'}"
    if method := result["plan"].get("integrator"):  # ``raceway plan`` has the reason
        law += f"; integrator {method['kind']}"
    words.append(f"{scene['bodies']['kind']} bodies, {law}")
    words += ["static: without [excitation]"] if result["identification"] is None else []
    left_out = f"raceway plan: {len(result['plan']['left_out'])} parts left out"
    return Screen(result["title"], "\n".join(words), [micro(text) for text in result["warnings"]], rows, left_out)


def report(result: Content) -> list[Part]:
    """Of a terminal: the answer, what makes it doubtful, and what was computed; as much as fits, unless progress is reported."""
    shown = screen(result)
    bearing, *model = shown.bearing.splitlines()
    rows, warnings = shown.rows, shown.warnings
    last, title = "; ".join([*model, shown.left_out]), "; ".join(shown.title.splitlines())
    if not getLogger("raceway").isEnabledFor(INFO):
        cut = f"{last}; all rows and remedies: -v or result.json"
        warnings, title = [in_a_line(text, WIDTH - len("warning: ")) for text in warnings], in_a_line(title, 2 * WIDTH)
        room = _LINES - 1 - len(warnings) - len(lines_of(title, WIDTH))
        if height(rows) + len(lines_of(f"{bearing}\n{last}", WIDTH)) > room:
            rows = _rows_that_fit(result, rows, room - len(lines_of(f"{bearing}\n{cut}", WIDTH)))
        last = last if (rows, warnings) == (shown.rows, shown.warnings) else cut
    first = next(k for k, (name, value, _) in enumerate(rows) if k and name and not value)
    return [
        Words(title, "bold"),
        sections(rows[:first]),
        *(Words(f"warning: {text}", "yellow") for text in warnings),
        Words(bearing, "dim"),
        sections(rows[first:]),
        Words(last, "dim"),
    ]


def _rows_that_fit(result: Content, rows: list[Row], count: int) -> list[Row]:
    """At most so many, a line each: first go the rows of plug-ins of quantities but their first, then ``_DETAILS`` in their order."""
    if len(rows) > count:
        further, first = run_parts.quantity_rows(result), run_parts.quantity_rows(result, first=True)
        rows = [row for row in rows if row in first or row not in further]
    for label in _DETAILS:
        if len(rows) > count:
            rows = [row for row in rows if label not in (row[0], "" if row[1] else row[2][: len(label)])]
    return [(name, value, in_a_line(remark, room)) for (name, value, remark), room in zip(rows, rooms(rows), strict=True)]


#: How the rows of a pair stand to each other.
_PAIRS = {"DB": "back to back", "DF": "face to face", "DT": "tandem"}
