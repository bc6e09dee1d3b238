"""Wrong arguments at the doors of ``import raceway``: each has one message, no exception of Python's own."""

from __future__ import annotations

import inspect
import random
import tempfile
import warnings
from collections.abc import Callable, Iterator
from contextlib import chdir
from pathlib import Path
from typing import Any

import numpy as np

import raceway as rw
from benchmarks.evidence import Row, below
from raceway.errors import RacewayError

CALLS, SEED = 500, 32
COMMAND = "python -m benchmarks.meaning doors"
#: Tools of plug-ins' authors, whose arguments a decorator or a class of attrs reads; and what carries an error.
_NO_DOORS = ("jit", "hookimpl", "option", "worded", "optional", "word_or", "LAW", "FORCE", "Mistake")
_STATIC = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}
_MOVING = _STATIC | {
    "excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "amplitude": "constant", "force": 50.0},
    "rotor": {"mass": 2.0, "damping": 1000.0},
    "integrator": {"kind": "periodic"},
}
_TIME = np.arange(0.0, 0.1, 5e-5)


def _signals() -> dict[str, np.ndarray]:
    angle = 2.0 * np.pi * 200.0 * _TIME
    return {
        "time_s": _TIME,
        "y_um": 15.0 * np.cos(angle),
        "z_um": 15.0 * np.sin(angle),
        "speed_rpm": 12000.0 + 0.0 * _TIME,
    }


def arguments() -> dict[str, dict[str, Any]]:
    """Right arguments of each function, cheap ones; keywords that are not here take their defaults."""
    rig = _STATIC | {"rig": {}, "integrator": {"kind": "quasi_static"}}
    table = {"axial [N]": [400.0, 1000.0, 2000.0], "kxx [N/um]": [39.38, 67.43, 98.77]}
    swept = rw.sweep(_STATIC, {"kinematics.spin_speed_rpm": "0:20000:5"})
    ratings = {15: ("47 kN", "43 kN"), 25: ("44.5 kN", "41 kN")}
    scene = rw.scene_from_dict(_STATIC)
    return {
        "run": {"scene": _STATIC},
        "plan": {"scene": _STATIC},
        "check": {"scene": _STATIC},
        "evolve": {"scene": _STATIC, "changes": "load.axial=400"},
        "compare": {"scene": _STATIC, "vary": {"load.axial": [400.0, 1000.0]}},
        "sweep": {"scene": _STATIC, "axes": {"load.axial": [400.0, 1000.0]}},
        "follow": {"scene": _MOVING, "over": "excitation.speed_rpm=11000:12000"},
        "precision": {"scene": _MOVING, "vary": {"excitation.force": [50.0, 60.0]}, "repeats": 1},
        "band": {"scene": _STATIC, "tolerances": {"load.axial": "±10 %"}, "count": 4},
        "sensitivities": {"scene": _STATIC, "keys": ["load.axial"]},
        "identify": {"signals": _signals(), "scene": rig},
        "fit": {"data": table, "scene": _STATIC, "free": "bearing.contact_angle_deg"},
        "export_ross": {"data": swept},
        "export_coefficients": {"data": swept, "kind": "nastran"},
        "view": {"scene": _STATIC},
        "infer": {"bore": "70 mm", "outer_diameter": "110 mm", "ratings": ratings},
        "catalogue": {"pattern": "7014*"},
        "law": {"name": "hertz"},
        "load_scene": {"path": "examples/b7206.toml"},
        "scene_from_dict": {"tables": _STATIC},
        "make_plan": {"scene": scene},
        "build_model": {"scene": scene, "plan": rw.make_plan(scene)},
        "at_least": {"low": 0.0},
        "above": {"low": 0.0},
        "between": {"low": 0.0, "high": 1.0},
        "inside": {"low": 0.0, "high": 1.0},
        "one_of": {"choices": "a"},
    }


def _of_methods(answers: dict[str, Any]) -> Iterator[tuple[str, Callable[..., Any], dict[str, Any]]]:
    """Methods with arguments of what functions answer; right arguments of those that need one."""
    right = {"folder": "made", "path": "made/file.toml", "what": None, "pictures": False, "contact_angle_deg": 25}
    right |= {"keys": [], "key": "load.axial", "quantity": "kxx", "part": "tilts", "name": "load.axial", "names": ("kyy",)}
    for name, answer in answers.items():
        if type(answer).__name__ not in rw.__all__:
            continue
        for method, function in inspect.getmembers(answer, callable):
            if method.startswith("_") or not inspect.signature(function).parameters:
                continue
            needed = [one for one, p in inspect.signature(function).parameters.items() if p.default is p.empty]
            fitting = {one: right[one] for one in needed if one in right}
            if name == "run":
                fitting |= {"path": "load.axial"} if method == "gradient" else {}
            yield f"{name}().{method}", function, fitting


def _wrong(chance: random.Random) -> Any:
    """A value of some type, mostly not what an argument wants; counts are far beyond any, so that none is begun."""
    return chance.choice(
        [
            None, 3, -1, 10**12, 2.5, float("nan"), float("inf"), True, 1j, "x", "", "a=b", "x\0y", b"x", [], [3], [None], ["x"], {},
            {"x": 3}, {3: "x"}, {"load.axial": None}, object(), Path("missing/file"), Path("x\0y"), int, len, np.ones(2), np.float64(-2.0),
            (1, 2), ("a", "b"), range(2), iter([1]), {1, 2},
        ]
    )  # fmt: skip


def _called(function: Callable[..., Any], right: dict[str, Any]) -> Any:
    """A call by keywords, what is many values (``*changes``) behind the others."""
    parameters = inspect.signature(function).parameters.values()
    several = next((p.name for p in parameters if p.kind is p.VAR_POSITIONAL), None)
    before = [p.name for p in parameters if p.kind is p.POSITIONAL_OR_KEYWORD]
    many = next((p.name for p in parameters if p.kind is p.VAR_KEYWORD), None)
    if several in right:
        given = dict(right)
        first = [given.pop(name) for name in before if name in given]
        return function(*first, given.pop(several), **given)
    return function(**({"load": right[many]} if many in right else right))


def wrong_calls(calls: int = CALLS, seed: int = SEED) -> tuple[int, list[str]]:
    """Calls that were refused, and what came out that is no ``RacewayError``: one argument of each call is wrong."""
    chance, raw, refused = random.Random(seed), [], 0
    doors = [(name, getattr(rw, name), right) for name, right in arguments().items()]
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        answers = {name: _called(function, right) for name, function, right in doors if name not in ("view", "build_model")}
        answers |= {"Scene": rw.scene_from_dict(_STATIC)}
        doors += list(_of_methods(answers))
        for name in ("from_dict", "from_toml"):
            doors.append((f"Scene.{name}", getattr(rw.Scene, name), {}))
        with chdir(folder):
            for _ in range(calls):
                name, function, right = chance.choice(doors)
                argument, value = chance.choice(list(inspect.signature(function).parameters)), _wrong(chance)
                try:
                    _called(function, {**right, argument: value})
                except RacewayError:
                    refused += 1
                except BaseException as error:
                    raw.append(f"{name}({argument}={value!r}): {type(error).__name__}: {error}"[:200])
    return refused, raw


def rows() -> list[Row]:
    """Of the table of this subject."""
    refused, raw = wrong_calls()
    note = f"{refused} refused, the others right by chance" + "".join(f"; {one}" for one in raw[:3])
    return [below(f"raw exceptions in {CALLS} calls with one wrong argument", len(raw), 0, COMMAND, note)]
