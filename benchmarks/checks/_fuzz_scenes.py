"""Scenes beyond those of ``_random_scenes``: every kind of plug-in, files of every sort, extreme numbers, other types and names."""

from __future__ import annotations

import os
from importlib.resources import files
from pathlib import Path
from typing import Any

from benchmarks.checks._random_scenes import GARBAGE, Chance, Tables, plausible
from raceway.framework.registry import default_registry
from raceway.scene.tables import PLUGIN_TABLES

#: What takes the place of a number, beside ``GARBAGE``.
EXTREME: tuple[Any, ...] = (
    0.0, -0.0, 5e-324, 1e-154, 1e-30, 1e-9, 1.0, 1e9, 1e30, 1e154, 1.7e308, -1e-9, -1e154, 2**31, 2**63, -(2**63), 10**400, 1e-3, 60.0,
    0.5, 0.4999999, 90.0, 180.0, 1e5,
)  # fmt: skip
_NAMES = ("", "a", "kind", "file", "axail", "speed_rpm", "Ω", "\n", "a.b", "x" * 300, "__class__", "preset")
#: A bearing and meshes that are small enough to be computed with all their nodes.
_TINY_MESH = {
    "kind": "structured", "element_size": 3.2e-3, "nodes_per_semi_axis": 1, "azimuth_cells": 12, "growth": 3.0, "patch": 0.5,
    "ball_load": 3e4,
}  # fmt: skip


def fill(folder: Path) -> None:
    """Put files there that scenes may name: good, damaged, without an end, and programs."""
    rows = "\n".join(f"{k * 1e-4:.5f},{300.0 * (k % 7):g},{-50.0 * (k % 5):g}" for k in range(200))
    (folder / "good.csv").write_text("t,Fy,Fz\n" + rows)
    (folder / "words.csv").write_text("t,Fy\n1,two\n")
    (folder / "bytes.csv").write_bytes(bytes(range(256)) * 8)
    (folder / "ring.inp").write_bytes(files("raceway").joinpath("data/meshes/ring.inp").read_bytes())
    (folder / "include.inp").write_text("*INCLUDE, INPUT=/dev/zero\n")
    (folder / "cut.vtu").write_text("<VTKFile type='UnstructuredGrid'><Unstr")
    (folder / "part.geo").write_text(f'SystemCall "touch {folder}/PWNED";\n')
    (folder / "part.step").write_text("ISO-10303-21;\n")
    (folder / "part.step.opt").write_text(f'SystemCall "touch {folder}/PWNED";\n')
    os.mkfifo(folder / "pipe.csv")
    os.mkfifo(folder / "pipe.inp")


def wild(chance: Chance, folder: Path) -> Tables:
    """One scene; a third of all as they are, the others with one to four keys spoiled."""
    tables = plausible(chance)
    if chance.happens(0.1):
        tables["excitation"] = {
            "kind": "measured",
            "file": str(_file(chance, folder)),
            "speed_rpm": chance.decades(100.0, 1e5),
        }
        tables["excitation"]["repeats"] = chance.happens(0.5)
    if chance.happens(0.02):
        tables |= _elastic(chance)
    elif chance.happens(0.05):
        kind = chance.one("file", "gmsh", "structured")
        tables["mesh"] = {"kind": kind} | (
            {chance.one("inner_ring", "ball"): str(_file(chance, folder))} if kind != "structured" else {}
        )
        tables["bodies"] = {"kind": chance.one("rigid", "condensed", "elastic")}
    if chance.happens(0.1):
        name = chance.one(*PLUGIN_TABLES)
        tables.setdefault(name, {})["kind"] = chance.one(*default_registry().names(PLUGIN_TABLES[name][0]))
    for _ in range(chance.one(0, 0, 1, 1, 2, 4)):
        _spoil(chance, tables)
    return tables


def _elastic(chance: Chance) -> Tables:
    return {
        "bearing": {"preset": "B7206C", "ball_count": 3},
        "bodies": {"kind": "elastic", "formulation": "one_point"},
        "mesh": dict(_TINY_MESH),
        "load": {"axial": chance.decades(500.0, 5000.0)},
        "rotor": {"mass": 0.5},
        "contact": {"kind": "penalty", "discretisation": "nodal", "stiffness": 3e14},
        "kinematics": {"ball_inertia": False},
        "excitation": {
            "kind": "bidirectional",
            "speed_rpm": 1e7,
            "amplitude": "constant",
            "force": chance.decades(10.0, 1000.0),
        },
        "integrator": {"kind": "central_difference", "turns": 1},
        "identifier": {"kind": "fft_1x"},
    }


def _file(chance: Chance, folder: Path) -> Path | str:
    inside = sorted(folder.iterdir())
    return chance.one(folder / "good.csv", folder / "good.csv", folder / "ring.inp", *inside, folder, folder / "gone.vtu",
                      "/dev/zero", "/dev/stdin", "")  # fmt: skip


def _spoil(chance: Chance, tables: Tables) -> None:
    """Another value, another name, or a table that is none."""
    name = chance.one(*sorted(tables))
    table = tables[name]
    way = chance.whole(0, 9)
    if way == 0 or not isinstance(table, dict) or not table:
        tables[name] = chance.one(*GARBAGE)
    elif way == 1:
        table[chance.one(*_NAMES)] = chance.one(*GARBAGE)
    elif way == 2:
        tables[chance.one(*_NAMES)] = chance.one({}, {"kind": "x"}, 3)
    elif way <= 5:
        table[chance.one(*sorted(table))] = chance.one(*GARBAGE)
    else:
        numbers = [
            key for key, value in sorted(table.items()) if isinstance(value, (int, float)) and not isinstance(value, bool)
        ]
        key = chance.one(*(numbers or sorted(table)))
        table[key] = chance.one(*EXTREME)
