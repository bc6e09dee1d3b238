"""Random scenes made from the schema: scenes of the examples with any keys of any table and plug-in, in their range and beyond.

A key is drawn from the day that the schema has it: the first seeds draw each key once, alone, in a small scene.
"""

import copy
import math
import os
import re
import tomllib
from collections.abc import Iterator
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import attrs
import numpy as np
from raceway_checks.stability.catalogue import TINY

from raceway.extend import scene_schema

Tables = dict[str, Any]
_EXAMPLES = Path(__file__).parents[2] / "examples"
#: What stands where something else belongs.
GARBAGE: tuple[Any, ...] = (
    float("nan"), float("inf"), -float("inf"), -1.0, 0.0, 1e300, -(10**30), "", "free", "42", True, None, [], [1.0], {}, {"a": 1},
    [[1.0, float("nan")], [2.0, 3.0]], 0.5, 3, "\x00", "../../etc", 1e-300,
)  # fmt: skip
#: What takes the place of a number, beside ``GARBAGE``.
EXTREME: tuple[Any, ...] = (
    0.0, -0.0, 5e-324, 1e-154, 1e-30, 1e-9, 1.0, 1e9, 1e30, 1e154, 1.7e308, -1e-9, -1e154, 2**31, 2**63, -(2**63), 10**400, 1e-3, 60.0,
    0.5, 0.4999999, 90.0, 180.0, 1e5,
)  # fmt: skip
_NAMES = ("", "a", "kind", "file", "axail", "speed_rpm", "Ω", "\n", "a.b", "x" * 300, "__class__", "preset")
_WORDS = ("VG 46", "46", "ISO VG 32", "P4", "", "free", "Ω", "\x00")
#: Decades of numbers without a default, by unit.
_DECADES = {
    "m": (-6.0, -1.0), "N": (-1.0, 5.0), "Pa": (6.0, 12.0), "kg": (-2.0, 4.0), "r/min": (1.0, 5.3), "N s/m": (-3.0, 4.0),
    "kg m2": (-6.0, 1.0), "kg m": (-9.0, -2.0), "deg": (-1.0, 2.0), "C": (0.0, 2.3), "s": (-5.0, 0.0), "": (-3.0, 2.0),
}  # fmt: skip
#: What an option of a plug-in stands in, by table and kind: tables of a scene that is planned, one of them.
_TURNING: Tables = {"speed_rpm": 12000.0, "unbalance": 3.2e-4}
_RUN_UP: Tables = {
    "excitation": {"kind": "run_up", "first_speed_rpm": 3000.0, "duration_s": 0.02, **_TURNING}, "identifier": {"kind": "order_tracking"},
}  # fmt: skip
_CONDENSED: Tables = {"bodies": {"kind": "condensed"}, "mesh": {"kind": "structured", "element_size": 1.5e-3}}
#: Explicit steps of three balls at a speed of which a turn is a few; implicit ones take half a second each.
_ELASTIC: Tables = copy.deepcopy(TINY) | {
    "contact": {"kind": "penalty", "discretisation": "nodal", "stiffness": 3e14}, "kinematics": {"ball_inertia": False},
    "excitation": {"kind": "bidirectional", "speed_rpm": 1e7, "amplitude": "constant", "force": 100.0},
    "integrator": {"kind": "central_difference", "turns": 1},
}  # fmt: skip
_GROUND: dict[tuple[str, str], tuple[Tables, ...]] = {
    ("contact", "film"): (
        {"contact": {"kind": "film", "oil": "VG 46", "temperature_c": 60.0}},
        {"contact": {"kind": "film", "viscosity_40": 46e-6, "viscosity_100": 7e-6, "temperature_c": 60.0}},
        {"contact": {"kind": "film", "viscosity": 0.02}},
    ),
    ("contact", "unilateral"): ({**_CONDENSED, "contact": {"kind": "unilateral", "discretisation": "nodal"}},),
    ("excitation", "bidirectional"): ({"excitation": {"kind": "bidirectional", **_TURNING}},),
    ("excitation", "unidirectional"): ({"excitation": {"kind": "unidirectional", **_TURNING}},),
    ("excitation", "measured"): ({"excitation": {"kind": "measured", "file": "good.csv", "speed_rpm": 12000.0}},),
    ("excitation", "run_up"): (_RUN_UP,),
    ("identifier", "order_tracking"): (_RUN_UP,),
    ("identifier", "impedance_fit"): ({"identifier": {"kind": "impedance_fit", "speeds_rpm": [9000.0, 12000.0]}},),
    ("bodies", "condensed"): (_CONDENSED,),
    ("bodies", "elastic"): (_ELASTIC,),
    ("mesh", "structured"): (_CONDENSED, _ELASTIC),
}


class Chance:
    """Draws of one scene."""

    def __init__(self, seed: int) -> None:
        self._rng = np.random.default_rng(seed)

    def between(self, low: float, high: float) -> float:
        return float(self._rng.uniform(low, high))

    def decades(self, low: float, high: float) -> float:
        """A number spread evenly over decades."""
        return float(f"{10.0 ** self.between(math.log10(low), math.log10(high)):.5g}")

    def whole(self, low: int, high: int) -> int:
        """From low to high, both included."""
        return int(self._rng.integers(low, high + 1))

    def one(self, *choices: Any) -> Any:
        return choices[self.whole(0, len(choices) - 1)]

    def happens(self, share: float) -> bool:
        return bool(self._rng.random() < share)


@attrs.frozen
class Key:
    """A key of a scene: its table, the plug-in whose option it is or "", the names below the table, its schema."""

    table: str
    kind: str
    path: tuple[str, ...]
    schema: Tables = attrs.field(eq=False, repr=False)

    @property
    def name(self) -> str:
        return ".".join([self.table + (f"[{self.kind}]" if self.kind else ""), *self.path])


@cache
def scene_keys() -> tuple[Key, ...]:
    """Every key that the schema has."""
    found: list[Key] = []
    for name, table in scene_schema()["properties"].items():
        if "oneOf" in table:
            for branch in table["oneOf"]:
                found += _below(name, branch["properties"]["kind"]["const"], (), branch)
        else:
            found += _below(name, "", (), table) if "properties" in table else [Key(name, "", (), table)]
    return tuple(found)


def _below(table: str, kind: str, path: tuple[str, ...], schema: Tables) -> Iterator[Key]:
    for name, one in schema["properties"].items():
        if "properties" in one:
            yield from _below(table, kind, (*path, name), one)
        else:
            yield Key(table, kind, (*path, name), one)


def scene(seed: int, folder: Path, drawn: set[str] | None = None) -> Tables:
    """One scene; each key of the schema alone first, then examples with some keys, a third of them with one to four spoiled.

    folder : of the files that a scene may name, see ``fill``;  drawn : the names of keys are put there
    """
    chance, keys = Chance(seed), scene_keys()
    tables, several = example("minimal" if seed < len(keys) else chance.one(*_names())), [keys[seed % len(keys)]]
    if tables.get("integrator", {}).get("kind") != "periodic":
        short = {"turns": chance.whole(1, 3), "steps_per_turn": chance.one(8, 24, 48, 96)}
        tables["integrator"] = tables.get("integrator", {}) | short
    if seed >= len(keys):
        tables |= copy.deepcopy(_ELASTIC) if chance.happens(0.02) else {}
        several = [chance.one(*keys) for _ in range(chance.one(0, 1, 1, 2, 3, 6))]
    for key in several:
        _put(chance, tables, key, folder)
        if drawn is not None:
            drawn.add(key.name)
    for _ in range(0 if seed < len(keys) else chance.one(0, 0, 0, 0, 1, 1, 2, 4)):
        _spoil(chance, tables)
    return tables


@cache
def _names() -> list[str]:
    return sorted(path.stem for path in _EXAMPLES.glob("*.toml"))


@cache
def _read(name: str) -> Tables:
    return tomllib.loads((_EXAMPLES / f"{name}.toml").read_text(encoding="utf-8"))


def example(name: str) -> Tables:
    """The tables of an example, which may be changed."""
    return copy.deepcopy(_read(name))


def _put(chance: Chance, tables: Tables, key: Key, folder: Path) -> None:
    """Draw a key; where another plug-in's table stands, this one's takes its place."""
    if not key.path:
        tables[key.table] = _tolerances(chance) if key.table == "tolerances" else value(chance, key.schema, folder)
        return
    table = tables.setdefault(key.table, {})
    if key.kind and table.get("kind") != key.kind:
        known = _GROUND.get((key.table, key.kind), ({key.table: {"kind": key.kind}},))
        fitting = [one for one in known if key.path[0] in one[key.table]]
        tables |= copy.deepcopy(chance.one(*(fitting or known)))
        table = tables[key.table]
        if "file" in table:
            table["file"] = str(folder / table["file"])
    for name in key.path[:-1]:
        table = table.setdefault(name, {})
    table[key.path[-1]] = value(chance, key.schema, folder)


def _tolerances(chance: Chance) -> Tables:
    some = {
        chance.one(*scene_keys()).name: chance.one("±10 %", "±5 um", "0 to 1", "10", "") for _ in range(chance.whole(0, 2))
    }
    classes = {
        "class": chance.one("P4", "P2", "P0", "ABEC 7", "P9"), "balls": chance.one("G5", "G10", "X"),
        "load.axial": "±10 %",
    }  # fmt: skip
    return some | {name: word for name, word in classes.items() if chance.happens(0.5)}


def value(chance: Chance, schema: Tables, folder: Path, unit: str = "") -> Any:
    """What a schema allows."""
    unit = unit or (found[1] if (found := re.search(r"\[([^\]]+)\]$", schema.get("description", ""))) else "")
    if "const" in schema:
        return schema["const"]
    if "enum" in schema:
        return chance.one(*schema["enum"])
    if "anyOf" in schema:
        limits = {"default": schema["default"]} if "default" in schema else {}
        return value(chance, {**limits, **chance.one(*schema["anyOf"])}, folder, unit)
    kind = schema.get("type")
    if kind == "boolean":
        return chance.happens(0.5)
    if kind in ("number", "integer"):
        return _number(chance, schema, unit)
    if kind == "array":
        count = chance.whole(schema.get("minItems", 0), schema.get("maxItems", 3))
        return [value(chance, schema["items"], folder, unit) for _ in range(count)]
    if kind == "object":
        some = {name: one for name, one in schema.get("properties", {}).items() if chance.happens(0.3)}
        return {name: value(chance, one, folder) for name, one in some.items()}
    if schema.get("pattern") == "^[+-]+$":
        return "".join(chance.one("+", "-") for _ in range(chance.whole(1, 5)))
    if "pattern" in schema:
        return f"{_number(chance, {**schema, 'type': 'number'}, unit):.4g} {unit or 'mm'}"
    return str(chance.one(*_WORDS, chance.one(*sorted(folder.iterdir()), folder / "gone.vtu", "/dev/zero", "/dev/stdin")))


def _number(chance: Chance, schema: Tables, unit: str) -> float | int:
    """Within its limits: decades around its default, or those of its unit; now and then a limit itself."""
    low, high = (
        next((float(schema[word]) for word in (f"{end}imum", f"exclusive{end.capitalize()}imum") if word in schema), None)
        for end in ("min", "max")
    )
    default, integer = schema.get("default"), schema["type"] == "integer"
    if low is not None and chance.happens(0.05):
        found = low
    elif isinstance(default, int | float) and default > 0.0:
        found = chance.decades(0.1 * default, 10.0 * default)
    elif low is not None and high is not None and high < 1e3:
        found = chance.between(low, high)
    else:
        found = 10.0 ** chance.between(*_DECADES.get(unit, _DECADES[""])) + (1.0 if integer else 0.0)
        found *= chance.one(1.0, 1.0, 1.0, -1.0) if low is None else 1.0
    found = found if low is None else max(found, low)
    found = found if high is None else min(found, high)
    return round(found) if integer else float(f"{found:.6g}")


def fill(folder: Path) -> None:
    """Put files there that scenes may name: good, damaged, without an end, and programs."""
    rows = "\n".join(f"{k * 1e-4:.5f},{300.0 * (k % 7):g},{-50.0 * (k % 5):g}" for k in range(200))
    (folder / "good.csv").write_text("t,Fy,Fz\n" + rows)
    (folder / "words.csv").write_text("t,Fy\n1,two\n")
    (folder / "bytes.csv").write_bytes(bytes(range(256)) * 8)
    (folder / "ring.inp").write_bytes(files("raceway_meshing").joinpath("data/meshes/ring.inp").read_bytes())
    (folder / "include.inp").write_text("*INCLUDE, INPUT=/dev/zero\n")
    (folder / "cut.vtu").write_text("<VTKFile type='UnstructuredGrid'><Unstr")
    (folder / "part.geo").write_text(f'SystemCall "touch {folder}/PWNED";\n')
    (folder / "part.step").write_text("ISO-10303-21;\n")
    (folder / "part.step.opt").write_text(f'SystemCall "touch {folder}/PWNED";\n')
    os.mkfifo(folder / "pipe.csv")
    os.mkfifo(folder / "pipe.inp")


def _spoil(chance: Chance, tables: Tables) -> None:
    """Another value, another name, or a table that is none."""
    name = chance.one(*sorted(tables))
    table, way = tables[name], chance.whole(0, 9)
    if way == 0 or not isinstance(table, dict) or not table:
        tables[name] = chance.one(*GARBAGE)
    elif way == 1:
        table[chance.one(*_NAMES)] = chance.one(*GARBAGE)
    elif way == 2:
        tables[chance.one(*_NAMES)] = chance.one({}, {"kind": "x"}, 3)
    elif way <= 5:
        table[chance.one(*sorted(table))] = chance.one(*GARBAGE)
    else:
        numbers = [key for key, one in sorted(table.items()) if isinstance(one, int | float) and not isinstance(one, bool)]
        table[chance.one(*(numbers or sorted(table)))] = chance.one(*EXTREME)
