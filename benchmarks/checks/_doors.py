"""Random calls of all functions of ``import raceway`` that read their arguments by name, on random scenes, some arguments wrong."""

from __future__ import annotations

import inspect
import json
import traceback
from collections.abc import Callable
from contextlib import chdir
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import raceway as rw
from benchmarks.checks._scenes import GARBAGE, Chance, Tables, example, scene, scene_keys
from raceway.errors import RacewayError

_WRONG: tuple[Any, ...] = (
    *GARBAGE,
    b"x",
    object(),
    np.array([1.0, np.nan]),
    {"a", "b"},
    print,
    iter(()),
    1j,
    "load.axial",
    range(3),
)
_SPEED, _AXIAL = "excitation.speed_rpm", "load.axial"
_TABLE = {"axial [N]": [400.0, 1000.0, 2000.0], "kxx [N/um]": [39.38, 67.43, 98.77]}
_ANGLE = np.arange(0.0, 0.1, 5e-5) * 400.0 * np.pi
_SIGNALS = {
    "time_s": _ANGLE / (400.0 * np.pi),
    "y_um": 15.0 * np.cos(_ANGLE),
    "z_um": 15.0 * np.sin(_ANGLE),
    "speed_rpm": 0.0 * _ANGLE + 12e3,
}
_RATINGS = {15: ("47 kN", "43 kN"), 25: ("44.5 kN", "41 kN")}
#: Arguments of each function that reads its own by name: what it takes, a tuple is a choice; beside its scene.
GOOD: dict[str, Tables] = {
    "band": {"tolerances": {"bearing.contact_angle_deg": "±10 %"}, "count": 2},
    "catalogue": {"pattern": "70*C"},
    "check": {},
    "compare": {"vary": {_AXIAL: [400.0, 1000.0]}},
    "evolve": {},
    "export_coefficients": {"data": None, "kind": ("csv", "json", "nastran", "ansys")},
    "export_ross": {"data": None},
    "fit": {"data": _TABLE, "free": "bearing.contact_angle_deg"},
    "follow": {"over": f"{_SPEED}=9000:9500", "points": 3},
    "identify": {"signals": _SIGNALS},
    "infer": {"bore": "70 mm", "outer_diameter": "110 mm", "ratings": _RATINGS, "width": "20 mm"},
    "law": {"name": "hertz"},
    "load_scene": {"path": Path(__file__).parents[2] / "examples" / "minimal.toml", "changes": [f"{_AXIAL}=400"]},
    "plan": {},
    "precision": {"vary": {"integrator.steps_per_turn": [24, 48]}, "repeats": 1},
    "run": {},
    "scene_from_dict": {},
    "sensitivities": {"keys": ["bearing.contact_angle_deg"]},
    "sweep": {"axes": {_AXIAL: [400.0, 1000.0]}},
    "view": {},
}
#: Scenes whose answer takes milliseconds.
_SCENES = ("steady_orbit", "set_tbt", "test_rig", "test_rig")


@cache
def fronts() -> dict[str, Callable[..., Any]]:
    """Functions of the package that take a scene, or data; those of plug-ins, of rules and of parts are others."""
    found = {name: getattr(rw, name) for name in rw.__all__}
    return {name: f for name, f in found.items() if inspect.isfunction(f) and (".front" in f.__module__ or name in GOOD)}


@cache
def _swept() -> Any:
    return rw.sweep(example("test_rig"), {_SPEED: "9000:12000:5"})


def called(seed: int, folder: Path) -> tuple[str, str, list[list[str]]]:
    """Name of a function, how its call ended, and what is wrong with that.

    Parameters
    ----------
    folder : of the files that a scene may name; what is written falls below it
    """
    chance, names = Chance(seed), sorted(fronts())
    name = names[seed % len(names)]
    function, parameters = fronts()[name], inspect.signature(fronts()[name]).parameters
    given = {place: chance.one(*one) if isinstance(one, tuple) else one for place, one in GOOD[name].items()}
    if given.get("data", 0) is None:
        given["data"] = _swept()
    for place in {"scene", "tables"} & set(parameters):
        given[place] = _scene(chance, folder)
    extra = [p for p in parameters.values() if p.kind is not p.VAR_POSITIONAL]
    for _ in range(chance.one(0, 0, 1, 2)):
        given[chance.one(*extra).name] = chance.one(*_WRONG)
    below = folder / "calls" / "here"
    below.mkdir(parents=True, exist_ok=True)
    try:
        with chdir(below):
            found = function(**given)
            if not hasattr(found, "dims"):  # no labelled arrays, which have places for what there is not
                told = found.to_dict() if hasattr(found, "to_dict") else None
                json.dumps(told, allow_nan=False)
            for show in ("__repr__", "_repr_html_", "to_xarray"):
                getattr(found, show, str)()
    except RacewayError as error:
        good = error.exit_code in (1, 2) and bool(str(error).strip())
        return name, "refused", [] if good else [["traceback", name, f"{error!r}, exit code {error.exit_code}"]]
    except Exception as error:
        word = "nan" if "JSON compliant" in str(error) else "traceback"
        return name, "broken", [[word, name, f"{name}({given!r:.600}): {traceback.format_exc()[-900:]}"]]
    return name, "answered", []


def _scene(chance: Chance, folder: Path) -> Tables:
    """Quick ones; half of them with a key from the schema."""
    if chance.happens(0.1):
        return scene(chance.whole(len(scene_keys()), 10**6), folder)
    tables = example(chance.one(*_SCENES))
    if chance.happens(0.5):
        key = chance.one(*scene_keys())
        more = scene(scene_keys().index(key), folder).get(key.table)
        if key.table != "integrator":
            both = isinstance(more, dict) and isinstance(tables.get(key.table), dict) and not key.kind
            tables[key.table] = tables[key.table] | more if both else more
    return tables
