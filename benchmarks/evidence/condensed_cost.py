"""One scene by every kind of bodies: error against cost."""

from __future__ import annotations

import tempfile
import time
import tomllib
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.evidence import Row
from benchmarks.evidence._files import ROOT
from benchmarks.evidence.condensed_calibrated import quantities, tables
from raceway.bodies.model import build_model
from raceway.errors import RacewayError
from raceway.pipeline.settle import settle
from raceway.planning.plan import make_plan
from raceway.scene.reading import scene_from_dict
from raceway.storage import array_cache

TITLE = "Error against cost on one scene: B7206C, 1000 N axial, 500 N radial, tilt locked"
COMMAND = "python -m benchmarks.condensed"
#: Points along a semi-axis of the reference.
REFERENCE = 12
#: Another program, general and with faceted contact surfaces, on this bearing: typed here, not computed by this package.
OTHER = {
    "setting": "CalculiX, C3D8R, 63 000 elements", "displacement": 1.0, "stiffness": None, "set_up_s": None, "solve_s": 334.0,
    "note": "factor 2 off: facets of the concave groove cut into the balls (typed from earlier measurements with that program; deck and date not kept)",
}  # fmt: skip
NOTES = {
    "elastic, nodal": "one node along a semi-axis: contacts are not resolved, and no mesh that resolves them is as cheap",
    "elastic, resultant": "3000 elements: the mesh's own compliance under a contact is taken off",
}


def settings() -> dict[str, dict[str, Any]]:
    """What is changed in the scene, by name."""
    nodal = {"kind": "unilateral", "discretisation": "nodal"}
    return {
        "rigid": {"bodies": {"kind": "rigid"}},
        "condensed, resultant": {},
        **{
            f"condensed, nodal, {n} points per semi-axis": {
                "contact": nodal, "mesh": {"kind": "structured", "nodes_per_semi_axis": n},
            }
            for n in (2, 4, 8)
        },
        "elastic, nodal, 3.2 mm elements": {
            "bodies": {"kind": "elastic", "formulation": "incompatible"},
            "contact": {"kind": "penalty", "discretisation": "nodal"},
            "mesh": {
                "kind": "structured", "element_size": 3.2e-3, "nodes_per_semi_axis": 1, "azimuth_cells": 36, "growth": 3.0,
                "patch": 0.5, "ball_load": 300.0,
            },
        },
        "elastic, resultant, 3.2 mm elements": elastic("b7206_elastic_coarse"),
    }  # fmt: skip


def elastic(name: str) -> dict[str, Any]:
    """Bodies, mesh and contact of an example."""
    with open(ROOT / "examples" / f"{name}.toml", "rb") as file:
        example = tomllib.load(file)
    return {name: example[name] for name in ("bodies", "mesh", "contact")}


def table() -> list[dict[str, Any]]:
    """Rows ``setting, displacement, stiffness`` (relative errors), ``set_up_s, solve_s`` (CPU, nothing kept), ``note``."""
    fine = {"contact": {"kind": "unilateral", "discretisation": "nodal"}}
    reference = _measured({**fine, "mesh": {"kind": "structured", "nodes_per_semi_axis": REFERENCE}})
    out = []
    loaded = set()
    for name, changes in settings().items():
        kind = name.split(" points")[0].rstrip("0123456789")
        try:
            if kind not in loaded and not name.startswith("elastic"):  # half a minute: its kernels' seconds do not count
                _measured(changes)  # the first of its kind loads kernels
                loaded.add(kind)
            found = _anew(partial(_measured, changes))
        except RacewayError as why:
            out.append(
                {
                    "setting": name,
                    "displacement": None,
                    "stiffness": None,
                    "set_up_s": None,
                    "solve_s": None,
                    "note": str(why),
                }
            )
            continue
        out.append({"setting": name, **_errors(found, reference), "note": NOTES.get(",".join(name.split(",")[:2]), "")})
    return [*out, OTHER]


def _errors(found: dict[str, Any], reference: dict[str, Any]) -> dict[str, Any]:
    apart = {name: abs(found["values"][name] / reference["values"][name] - 1.0) for name in ("x", "y", "kxx", "kyy", "kzz")}
    return {
        "displacement": max(apart["x"], apart["y"]),
        "stiffness": max(apart[name] for name in ("kxx", "kyy", "kzz")),
        "set_up_s": found["set_up_s"],
        "solve_s": found["solve_s"],
    }


def _measured(changes: dict[str, Any]) -> dict[str, Any]:
    scene = scene_from_dict({**tables(), **changes})
    begin = time.process_time()
    model = build_model(scene, make_plan(scene))
    middle = time.process_time()
    equilibrium = settle(model)
    return {
        "values": quantities(equilibrium), "set_up_s": middle - begin, "solve_s": time.process_time() - middle,
    }  # fmt: skip


def _anew(what: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    """With an empty cache of compliances."""
    usual = array_cache.folder
    with tempfile.TemporaryDirectory() as folder:
        array_cache.folder = lambda: Path(folder)
        try:
            return what()
        finally:
            array_cache.folder = usual


def rows() -> list[Row]:
    out = []
    for line in table():
        error = line["displacement"]
        value = "none" if error is None else f"{100.0 * error:.3g} %"
        cost = [f"{word} {line[key]:.3g} CPU-s" for key, word in (("set_up_s", "set-up"), ("solve_s", "equilibrium"))
                if line[key] is not None]  # fmt: skip
        stiffness = line["stiffness"]
        parts = [*cost, *([] if stiffness is None else [f"stiffness {100.0 * stiffness:.3g} %"]), line["note"]]
        what = f"{line['setting']}: largest error of x and y, against {REFERENCE} points per semi-axis"
        ok = error is None or bool(np.isfinite(error))
        out.append(Row(what, value, "reported", ok, COMMAND, "; ".join(filter(None, parts))))
    return out
