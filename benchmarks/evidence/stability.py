"""Stiff and extreme cases: the whole catalogue of ``raceway stability``, and the numbers that it is for."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from benchmarks.evidence import Row, below
from raceway.framework.registry import registry_with
from raceway.studies.stability.catalogue import catalogue
from raceway.studies.stability.study import stability
from raceway.studies.stability.workers import measure

TITLE = "Stability: stiff and extreme cases"
COMMAND = "raceway stability"
#: The whole table, row by row.
FOREIGN = [Path(__file__).resolve().parents[2] / "tests" / name for name in ("cubic_law.py", "hunt_crossley.py")]
#: Law, in words, plug-in.
LAWS = (
    ("cubic", "a foreign law, 2e17 N/m3 times the cube of the approach", "tests/cubic_law.py"),
    ("hunt_crossley", "a foreign law whose force depends on the rate (Hunt and Crossley)", "tests/hunt_crossley.py"),
    ("film", "the law film, which carries before surfaces touch", ""),
)
FOLDER = Path(__file__).resolve().parents[2] / "docs" / "reports" / "stability"
_SECONDS = 480.0


def rows() -> list[Row]:
    study = stability()
    content = study.to_dict()
    wall = f"wall time {content['seconds']:.0f} s, beside what else the cores did"
    study.write(FOLDER)
    found = content["rows"]
    out = [
        below(
            "rows that are not as expected", float(len(study.failed)), 0.0, COMMAND, f"of {len(found)}, {study.cases} cases"
        ),
        below("processor time of both processes over two [s]", 0.5 * content["cpu_s"], _SECONDS, COMMAND, wall),
    ]
    out += [*_any_law(found), *_limits(found), *_orbits(found), *_energy(found), *_chatter(found)]
    for name in dict.fromkeys(row["case"] for row in found):
        own = [row for row in found if row["case"] == name]
        good = sum(row["verdict"] == "as expected" for row in own)
        command = f"raceway stability --only {shlex.quote(name)} --all"
        out.append(Row(name, f"{good} of {len(own)}", "all", good == len(own), command, _missed(own)))
    return out


def _missed(rows: list[dict[str, Any]]) -> str:
    """What the rows that are not as expected have in common, and the farthest of them."""
    missed = [row for row in rows if row["verdict"] != "as expected"]
    numbers = [row for row in missed if row["observed"] is not None and row["predicted"]]
    if not numbers:
        return "; ".join(dict.fromkeys(row["note"] for row in missed))
    worst = max(numbers, key=lambda row: abs(row["observed"] / row["predicted"] - 1.0))
    setting = ", ".join(str(value) for value in worst["setting"].values())
    off = 100.0 * (worst["observed"] / worst["predicted"] - 1.0)
    return f"farthest: {setting}: {worst['quantity']}, {off:+.2g} %; {worst['note']}"


def _any_law(own: list[dict[str, Any]]) -> list[Row]:
    """Conforming laws that are unlike Hertz', each through every case of contact laws: stiffness, rate, reach and speed."""
    registry = registry_with(FOREIGN)
    whole, out = catalogue(registry), []
    for law, words, file in LAWS:
        cases = [one for one in whole if one.arguments.get("shown", {}).get("law") == law]
        found = [row["verdict"] for row in own if row["setting"].get("law") == law]
        if file:
            found = [row.verdict for rows in measure(cases, 2, registry, FOREIGN)[0] for row in rows]
        failed = found.count("failed")
        command = f"{COMMAND} --plugin {file}" if file else COMMAND
        out.append(
            below(
                f"rows that are not as expected of {words}",
                float(failed),
                0.0,
                command,
                f"of {len(found)}, {len(cases)} cases",
            )
        )
    return out


def _of(found: Iterable[dict[str, Any]], case: str, keep: Callable[[dict[str, Any]], bool]) -> list[dict[str, Any]]:
    return [row for row in found if row["case"].startswith(case) and keep(row) and row["observed"] is not None]


def _limits(found: list[dict[str, Any]]) -> list[Row]:
    out = []
    for words in ("linear", "small motions of the bearing"):
        case = f"steps around the limit, {words}"
        limits = _of(found, case, lambda row: row["quantity"].startswith("stable limit"))
        worst = max(abs(row["observed"] / row["predicted"] - 1.0) for row in limits)
        out.append(
            below(f"observed over predicted stable step, less 1: {words}", worst, 0.02, COMMAND, f"{len(limits)} limits")
        )
    return out


def _orbits(found: list[dict[str, Any]]) -> list[Row]:
    orbits = _of(found, "orbit at the safe limit", lambda row: True)
    worst = max(row["observed"] for row in orbits)
    opened = sum(row["setting"]["contacts open"] for row in orbits)
    note = f"{len(orbits)} orbits of every law and integrator, {opened} with lift-off"
    return [
        below(
            "0.9 of the limit at the orbit's largest tangent: distance from the orbit in turn 50 over its size",
            worst,
            0.5,
            COMMAND,
            note,
        )
    ]


def _energy(found: list[dict[str, Any]]) -> list[Row]:
    out = []
    steps = _of(found, "undamped steps", lambda row: True)
    for row in steps:
        setting = row["setting"]
        closed = setting["step/limit"] > 0.05
        dissipative = setting["integrator"] == "generalized_alpha"
        name = f"energy's trend in a million steps, {setting['integrator']}, {setting['law']}, {row['note']}"
        value = row["observed"] if dissipative else abs(row["observed"])
        note = "it may lose, not gain" if dissipative else f"step {setting['step/limit']:g} of the limit"
        out.append(below(name, value, 1e-6 if closed else 1e-3, COMMAND, note))
    return out


def _chatter(found: list[dict[str, Any]]) -> list[Row]:
    out = []
    for row in _of(found, "chatter", lambda row: True):
        setting = {key: value for key, value in row["setting"].items() if key != "law"}
        words = ", ".join(f"{key} {value}" if key != "integrator" else str(value) for key, value in setting.items())
        name = f"contact chatter, {row['setting']['law']}: {words}"
        out.append(Row(name, row["observed"], row["expected"], row["verdict"] == "as expected", COMMAND, row["note"]))
    return out
