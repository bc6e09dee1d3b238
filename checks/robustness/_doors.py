"""Random calls of all public functions and of the methods of their answers, from their signatures, some arguments wrong."""

import inspect
import itertools
import json
import traceback
import warnings
from collections.abc import Callable
from contextlib import chdir
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import pyplot

import raceway as rw
from checks.robustness._scenes import GARBAGE, Chance, Tables, example, scene, scene_keys
from raceway import RacewayError


def _raises(self: object, *_: object, **__: object) -> Any:
    raise OSError("closed")


#: Nothing that one asks of the last ones has an answer.
_WRONG: tuple[Any, ...] = (
    *GARBAGE, b"x", object(), np.array([1.0, np.nan]), {"a", "b"}, print, iter(()), 1j, "load.axial", range(3), 10**400, 5, "x", [[]],
    {0: (1, 2, 3, 4)}, [["kyy"]], np.array(["x"]), np.array([None]), np.empty(0),
    *(type("Raises", (), {f"__{word}__": _raises})() for word in ["array", "float", "index", "str", "repr", "fspath", "iter", "len", "bool", "getattr"]),
)  # fmt: skip
_SPEED, _AXIAL = "excitation.speed_rpm", "load.axial"
_TABLE = {"axial [N]": [400.0, 1000.0, 2000.0], "kxx [N/um]": [39.38, 67.43, 98.77]}
_ANGLE = np.arange(0.0, 0.1, 5e-5) * 400.0 * np.pi
_SIGNALS = {
    "time_s": _ANGLE / (400.0 * np.pi), "y_um": 15.0 * np.cos(_ANGLE), "z_um": 15.0 * np.sin(_ANGLE),
    "speed_rpm": 0.0 * _ANGLE + 12e3,
}  # fmt: skip
_RATINGS = {15: ("47 kN", "43 kN"), 25: ("44.5 kN", "41 kN")}
#: Arguments of each function that reads its own by name: what it takes, a tuple is a choice; beside its scene.
GOOD: dict[str, Tables] = {
    "band": {"tolerances": {"bearing.contact_angle_deg": "±10 %"}, "count": 2},
    "catalogue": {"pattern": "70*C"}, "check": {}, "compare": {"vary": {_AXIAL: [400.0, 1000.0]}},
    "build_model": {"scene": None}, "evolve": {},
    "export_coefficients": {"data": None, "kind": ("csv", "json", "nastran", "ansys")},
    "export_fmu": {"ranges": {_AXIAL: (400.0, 500.0)}, "outputs": ["kyy"], "tolerance": 1e-3},
    "export_ross": {"data": None}, "fit": {"data": _TABLE, "free": "bearing.contact_angle_deg"},
    "follow": {"over": f"{_SPEED}=9000:9500", "points": 3}, "function": {"inputs": [_AXIAL], "outputs": ["kyy"]},
    "identify": {"signals": _SIGNALS},
    "infer": {"bore": "70 mm", "outer_diameter": "110 mm", "ratings": _RATINGS, "width": "20 mm"},
    "law": {"name": "hertz"},
    "load_scene": {"path": Path(__file__).parents[2] / "examples" / "minimal.toml", "changes": [f"{_AXIAL}=400"]},
    "make_plan": {"scene": None}, "plan": {},
    "precision": {"vary": {"integrator.steps_per_turn": [24, 48]}, "repeats": 1},
    "run": {}, "scene_from_dict": {}, "sensitivities": {"keys": ["bearing.contact_angle_deg"]},
    "sweep": {"axes": {_AXIAL: [400.0, 1000.0]}}, "view": {},
}  # fmt: skip
#: Scenes whose answer takes milliseconds.
_SCENES = ("steady_orbit", "set_tbt", "test_rig", "test_rig")


#: What is no front: rules and parts of plug-ins, and the app, which serves until it is stopped.
_OTHERS = {"app", "above", "at_least", "between", "door", "finite", "inside", "jit", "length", "one_of", "option", "optional", "positive",
           "word_or", "worded"}  # fmt: skip
#: Arguments of methods, by their names, where they must be given; and methods of ``Function`` for columns that it has made itself.
_GIVEN: Tables = {"folder": "here", "files": [], "path": "here.toml", "physics": "rigid"}
_INNER = ("slopes", "columns", "looped", "with_reasons", "refuse_time", "texts", "tables")


@cache
def fronts() -> dict[str, Callable[..., Any]]:
    """Functions of the package that take a scene, or data."""
    return {name: f for name in rw.__all__ if inspect.isfunction(f := getattr(rw, name)) and name not in _OTHERS}


@cache
def methods() -> dict[str, Callable[..., Any]]:
    """Public methods with arguments of one answer of each front."""
    found = {}
    for name in fronts().keys() - {"view", "load_scene", "scene_from_dict", "catalogue", "build_model"}:
        given = {place: one[0] if isinstance(one, tuple) else one for place, one in GOOD[name].items()}
        answer = fronts()[name](**_completed(name, given, example("test_rig")))
        for word, method in inspect.getmembers(answer, callable):
            own = (not word.startswith("_") or word in ("__call__", "__getitem__")) and word not in _INNER
            if own and type(answer).__module__.startswith("raceway") and inspect.signature(method).parameters:
                found[f"{type(answer).__name__}.{word}"] = method
    return dict(sorted(found.items()))


@cache
def _swept() -> Any:
    return rw.sweep(example("test_rig"), {_SPEED: "9000:12000:5"})


def _completed(name: str, given: Tables, tables: Tables) -> Tables:
    """Arguments with what a front takes as its scene, or its data."""
    given = {place: _swept() if place == "data" and one is None else one for place, one in given.items()}
    scene = rw.scene_from_dict(tables) if "scene" in given else tables
    return given | dict.fromkeys({"scene", "tables"} & set(inspect.signature(fronts()[name]).parameters), scene)


def called(seed: int, folder: Path) -> tuple[str, str, list[list[str]]]:
    """Name of a function or method, how its call ended, and what is wrong with that.

    folder : of the files that a scene may name; what is written falls below it
    """
    chance, names = Chance(seed), [*sorted(fronts()), *methods()]
    name = names[seed % len(names)]
    function, given = (fronts() | methods())[name], {}
    parameters = list(inspect.signature(function).parameters.values())
    below = folder / "calls" / "here"
    below.mkdir(parents=True, exist_ok=True)
    try:
        with chdir(below), warnings.catch_warnings(action="error", category=RuntimeWarning):
            if name in fronts():
                drawn = {place: chance.one(*one) if isinstance(one, tuple) else one for place, one in GOOD[name].items()}
                given = _completed(name, drawn, _scene(chance, folder))
            else:
                given = {p.name: _GIVEN.get(p.name, _AXIAL) for p in parameters if p.default is p.empty}
            for _ in range(chance.one(0, 1, 1, 2)):
                given[chance.one(*parameters).name] = chance.one(*_WRONG)
            columns = [p.name for p in parameters if p.kind is p.VAR_POSITIONAL and p.name in given]
            first = [
                given.pop(p.name, p.default)
                for p in itertools.takewhile(lambda p: p.name not in columns, parameters)
                if columns
            ]
            found = function(*first, *map(given.pop, columns), **given)
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
        told = ", ".join(f"{place}={repr(value)[:60]}" for place, value in given.items())
        return name, "broken", [[word, name, f"{name}({told}): {traceback.format_exc()[-900:]}"]]
    finally:
        pyplot.close("all")
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
