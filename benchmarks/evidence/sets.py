"""Sets of rows: makers' printed factors, lift-off and limiting loads, different rows, running and warm sets, what they cost."""

from __future__ import annotations

from math import radians
from time import process_time

import numpy as np

from benchmarks.evidence import Row, below, near
from raceway import RacewayError, build_model, make_plan, run, scene_from_dict
from raceway.bodies.model import Model
from raceway.bodies.mounting import preload_table
from raceway.pipeline.settle import settle
from raceway.scene.scene import Scene
from raceway.storage.tables import Tables
from raceway.studies.limits.study import AxialLimits, axial_limits
from validation.reference.ring import Ring
from validation.reference.row_set import RowSet, press, press_together, warmed

TITLE = "Sets of rows against makers' factors, an independent program and an independent ring"
COMMAND = "python -m benchmarks.evidence sets"
LIMITS = "raceway study limits examples/set_tbt.toml --set bearing.arrangement={}"
_BEARINGS = ("B7206C", "B7206E", "7206A")
#: Each row was ground for this [N].
_PRELOAD, _DISTANCE = 200.0, 16e-3
#: Factors over those of a pair of the same bearings, as makers of spindle bearings print them.
_PRINTED = {
    "TBT": {"preload": (1.35, 1.36), "axial stiffness": (1.45, 1.48), "radial stiffness": (1.54, 1.54)},
    "QBT": {"preload": (1.6, 1.6), "axial stiffness": (1.8, 1.8)},
    "QBC": {"preload": (2.0, 2.0), "axial stiffness": (2.0, 2.0), "radial stiffness": (2.0, 2.0)},
}
_TANDEM = {2: ("DT", 0.63), 3: ("TT", 0.48), 4: ("QT", 0.40)}
#: Lift-off over preload by an independent rigid-ring program, and with a constant contact angle.
_LIFT = {"DB": (2.95, 1), "TBT": (5.91, 2), "QBC": (5.91, 2), "QBT": (8.87, 3)}
#: Of a printed factor, and of the program's digits.
_CLOSE, _SAME = 0.05, 0.01
#: Agreement with the independent ring, whose own equilibria are solved to 1e-9 or so.
_REFERENCE = 1e-5
_UNEQUAL = {"DB, 25 and 15 deg": ("DB", (25, 15)), "TBT, 25, 25 and 15 deg": ("TBT", (25, 25, 15)), "QBC, 25, 25, 15 and 15 deg": ("QBC", (25, 25, 15, 15))}  # fmt: skip
_REPEATS = 9


def rows() -> list[Row]:
    return [*_factors(), *_tandem(), *_lift_off(), *_unequal(), *_running(), *_cost(), _bad_input()]


def _scene(word: str, **tables: Tables) -> Scene:
    bearing = {"preset": "B7206E", "arrangement": word, "row_distance": _DISTANCE, **tables.pop("bearing", {})}
    kinematics = {"ball_inertia": False, **tables.pop("kinematics", {})}
    return scene_from_dict({"title": word, "bearing": bearing, "kinematics": kinematics, **tables})


def _built(scene: Scene) -> Model:
    return build_model(scene, make_plan(scene))


def _ground(word: str, preset: str = "B7206E") -> Scene:
    return _scene(word, bearing={"preset": preset, "preload": _PRELOAD, "preload_of": "row"})


def _factors() -> list[Row]:
    """Of sets whose rows were all ground for one preload, over the pair."""
    found = {}
    for preset in _BEARINGS:
        for word in ("DB", *_PRINTED):
            model = _built(_ground(word, preset))
            now = settle(model)
            table = preload_table(model, now)
            values = (table["mounted_n"] if table else 0.0, now.stiffness[0, 0], now.stiffness[1, 1])
            found[word, preset] = dict(zip(("preload", "axial stiffness", "radial stiffness"), values, strict=True))
    out = []
    for word, printed in _PRINTED.items():
        for name, (low, high) in printed.items():
            ratios = [found[word, preset][name] / found["DB", preset][name] for preset in _BEARINGS]
            ok = all((1.0 - _CLOSE) * low <= ratio <= (1.0 + _CLOSE) * high for ratio in ratios)
            words = f"{low:g}" if low == high else f"{low:g} to {high:g}"
            note = f"rows of {', '.join(_BEARINGS)}, each ground for {_PRELOAD:g} N"
            if word == "TBT" and name == "radial stiffness":
                note += (
                    "; rows that share one offset give 1.433 at a constant angle, radially as axially; the printed 1.54 is (1 + 3^(2/3)) / 2, "
                    "which is the sum over 3 + 1 rows whose preload is not raised"
                )
            quantity = f"{word}: {name} over that of a pair, at 15, 25 and 30 deg"
            text = ", ".join(f"{ratio:.3f}" for ratio in ratios)
            out.append(Row(quantity, text, f"{words} within {100 * _CLOSE:g} %", ok, COMMAND, note))
    return out


def _tandem() -> list[Row]:
    out = []
    load = {"axial": _PRELOAD}
    single = settle(_built(_scene("single", load=load))).displacement[0]
    for count, (word, printed) in _TANDEM.items():
        ratio = settle(_built(_scene(word, load=load))).displacement[0] / single
        out.append(
            near(f"deflection of {count} rows in tandem over that of one, {_PRELOAD:g} N", ratio, printed, _CLOSE, COMMAND)
        )
    return out


def _ring(angle: float = 25.0, rpm: float = 0.0, balls: int = 12) -> Ring:
    return Ring(9.525e-3, 46e-3, balls, radians(angle), 0.522, 0.522, spin_speed=rpm * np.pi / 30.0)


def _lift_off() -> list[Row]:
    out = []
    note = "the requirement names neither bearing nor preload: B7206E, rows ground for 200 N"
    for word, (told, count) in _LIFT.items():
        found = axial_limits(_ground(word))[0]
        ratio = found.over_preload or 0.0
        command = LIMITS.format(word)
        more = f"{note}; {count * 2.0**1.5:.2f} at a constant contact angle"
        out.append(near(f"{word}: lift-off over preload, an independent program", ratio, told, _SAME, command, more))
        sides, places = zip(*_ground(word).bearing.rows, strict=True)
        offset = press(_ring(), _PRELOAD)
        reference = RowSet([_ring() for _ in sides], list(sides), list(places), [offset] * len(sides))
        off = abs((found.lift_off.load_n or 0.0) / reference.lift_off(1.0) - 1.0)
        out.append(below(f"{word}: lift-off load, relative difference from an independent ring", off, _REFERENCE, COMMAND))
    return out


def _unequal() -> list[Row]:
    """Limiting loads of sets with unequal angles, reported."""
    out = []
    for name, (word, angles) in _UNEQUAL.items():
        own = [{"contact_angle_deg": float(angle)} for angle in angles]
        scene = _scene(word, bearing={"preload": 2.0 * _PRELOAD, "row": own})
        for one in axial_limits(scene):
            text = ", ".join(_told(one, key) for key in ("lift_off", "edge", "pressure"))
            quantity = f"{name}, mounted with {2.0 * _PRELOAD:g} N, load along {one.direction}: lift-off, groove's edge, 4200 MPa [N]"
            out.append(Row(quantity, text, "reported", True, LIMITS.format(word)))
    return out


def _told(one: AxialLimits, key: str) -> str:
    limit = getattr(one, key)
    return "never" if limit.load_n is None else f"{limit.load_n:.4g} (row {limit.row})"


def _running() -> list[Row]:
    """Different rows at speed under loads, and a warm set, against the independent ring."""
    angles, sides = (25.0, 15.0, 15.0), [1.0, 1.0, -1.0]
    places, rpm = [-_DISTANCE, 0.0, _DISTANCE], 15000.0
    bearing = {"preload": _PRELOAD, "row": [{"contact_angle_deg": angle} for angle in angles]}
    kinematics, load = {"ball_inertia": True, "spin_speed_rpm": rpm}, {"axial": 60.0, "radial": [50.0, 20.0]}
    now = settle(_built(_scene("TBT", bearing=bearing, kinematics=kinematics, load=load)))
    still = [_ring(angle) for angle in angles]
    shifts = [press_together(still[:2], _PRELOAD)] * 2 + [press(still[2], _PRELOAD)]
    reference = RowSet([_ring(angle, rpm) for angle in angles], sides, places, shifts)
    q = reference.settle(np.array([60.0, 50.0, 20.0]))
    off = np.abs(np.diag(now.stiffness) / np.diag(reference(q)[1]) - 1.0).max()
    name = "TBT of 25, 15 and 15 deg at 15 000 r/min, loads in all directions: largest difference of a diagonal stiffness"
    out = [below(name, float(off), _REFERENCE, COMMAND)]
    warm = {"inner_temperature": 14.0, "outer_temperature": 5.0, "ball_temperature": 11.0}
    scene = _scene("TBT", bearing={"preload": _PRELOAD}, mounting=warm)
    model = _built(scene)
    running = preload_table(model, settle(model))
    strains = [scene.bearing.rings.thermal_expansion * value for value in warm.values()]
    shifts = [press(_ring(), 0.5 * _PRELOAD)] * 2 + [press(_ring(), _PRELOAD)]
    rings = [warmed(_ring(), (strains[0], strains[1], strains[2]), side, x) for side, x in zip(sides, places, strict=True)]
    reference = RowSet(rings, sides, places, shifts)
    expected = reference.rows(reference.settle(np.zeros(3)))[2]
    off = abs((running["running_n"] if running else 0.0) / expected - 1.0)
    name = "TBT, inner rings +14 K, outer +5 K, balls +11 K: relative difference of the running preload"
    note = f"{expected:.1f} N of {_PRELOAD:g} N mounted"
    return [*out, below(name, off, _REFERENCE, COMMAND, note)]


def _cost() -> list[Row]:
    """Processor time of a run of a set over the number of its rows times that of one row; the runs take turns."""
    turning = {"kind": "bidirectional", "speed_rpm": 12000, "unbalance": 1e-4}
    integrator = {"turns": 24, "steps_per_turn": 1440}
    words = {1: "single", 2: "DT", 4: "QT"}
    tables = {"excitation": turning, "integrator": integrator, "load": {"axial": 800.0}, "rotor": {"mass": 2.0}}
    scenes = {count: _scene(word, kinematics={"ball_inertia": True}, **tables) for count, word in words.items()}
    least = dict.fromkeys(words, float("inf"))
    for _ in range(_REPEATS):
        for count, scene in scenes.items():
            begin = process_time()
            run(scene)
            least[count] = min(least[count], process_time() - begin)
    note = f"{_REPEATS} runs each, the fastest: {1e3 * least[1]:.0f} ms for one row; 5 % is what times scatter here"
    return [
        below(f"processor time of a run of {count} rows over {count} times that of one row", least[count] / (count * least[1]), 1.05, COMMAND, note)
        for count in (2, 4)
    ]  # fmt: skip


#: What is wrong, and words of the one message.
_BAD: list[tuple[Tables, str]] = [
    ({"bearing": {"arrangement": "TT", "preload": 100.0}}, "face one way only"),
    ({"bearing": {"arrangement": "--", "preload": 100.0}}, "face one way only"),
    ({"bearing": {"arrangement": "DBX"}}, "must be one of"),
    ({"bearing": {"arrangement": "DBT"}}, "is ambiguous"),
    ({"bearing": {"arrangement": "DB", "preload": 100.0, "preload_kind": "spring", "spring_travel": 0.0}}, "without travel"),
    ({"bearing": {"arrangement": "DB", "preload": 100.0}, "mounting": {"inner_temperature": 400.0}}, "close the bearing"),
    ({"bearing": {"arrangement": "DB", "preload": 100.0}, "mounting": {"outer_temperature": 900.0}}, "open the bearing"),
    ({"bearing": {"arrangement": "DB", "preload": 100.0}, "mounting": {"outer_temperature": 60.0}}, "is gone"),
    ({"bearing": {"arrangement": "DB", "row": [{}]}}, "is 2 rows"),
    (
        {"bearing": {"arrangement": "DB", "row": [{}, {"contact_angle_deg": 15}]}, "contact": {"friction": 0.1}},
        "one kind only",
    ),
]


def _bad_input() -> Row:
    told = 0
    for tables, words in _BAD:
        try:
            run(_scene("single", **{name: dict(table) for name, table in tables.items()}))
        except RacewayError as error:
            told += words in str(error) and "Traceback" not in str(error)
    limit = f"{len(_BAD)} of {len(_BAD)}"
    return Row(
        "bad sets that are refused with one message that says why",
        f"{told} of {len(_BAD)}",
        limit,
        told == len(_BAD),
        COMMAND,
    )
