"""The combinations: names from the registry, so that whatever is installed takes part; and one scene for each."""

import json
from collections.abc import Iterator
from functools import cache
from itertools import combinations as chosen
from itertools import product
from typing import Any

import attrs
import pytest

from raceway import RacewayError, SceneError, scene_from_dict
from raceway.testing import default_registry, run

TILTS: tuple[str | float, ...] = ("locked", "free", 3e4)
KINDS = ("excitation", "contact_law", "integrator", "identifier", "bodies")


@attrs.frozen
class Combination:
    """One cell of the matrix."""

    excitation: str
    law: str
    discretisation: str
    integrator: str
    identifier: str
    tilt: str | float
    bodies: str

    def __str__(self) -> str:
        return "-".join(str(value) for value in attrs.astuple(self))


def combinations() -> Iterator[Combination]:
    """Every registered excitation x law x discretisation x integrator x identifier x tilt boundary x bodies kind."""
    excitations, laws, integrators, identifiers, bodies = (default_registry().names(kind) for kind in KINDS)
    for cell in product(excitations, laws, ("resultant", "nodal"), integrators, identifiers, TILTS, bodies):
        yield Combination(*cell)


def together(kinds: int) -> Iterator[Combination]:
    """Those in which so many of the kinds meet for the first time: all that they do to each other, in a small part of the product."""
    met = set[tuple[Any, ...]]()
    for cell in combinations():
        groups = set(chosen(enumerate(attrs.astuple(cell)), kinds))
        if not groups <= met:
            met |= groups
            yield cell


#: Rigid bodies run in every combination.  Of the cells of condensed bodies that the plan accepts, those run that differ from
#: a plain one in so many options: loops, laws and identifiers behind them are the same.
RESULTANT = Combination("bidirectional", "hertz", "resultant", "newmark", "fft_1x", "locked", "condensed")
#: Contacts at surface points take milliseconds a step; a run-up or several speeds would take thousands of steps.
PLAIN = Combination("bidirectional", "unilateral", "nodal", "newmark", "fft_1x", "locked", "condensed")


def only_planned(cell: Combination) -> bool:
    """Whether a cell is judged by the plan alone."""
    if cell.bodies != "condensed":
        return False
    if cell.discretisation == "nodal" and "speeds" in default_registry().find("identifier", cell.identifier).plugin.needs:
        return True
    plain, options = (PLAIN, 1) if cell.discretisation == "nodal" else (RESULTANT, 2)
    changed = sum(a != b for a, b in zip(attrs.astuple(cell), attrs.astuple(plain), strict=True))
    return changed > options


def crossed() -> list[Any]:
    """Parameters ``excitation, integrator``; quick are those with the plain one of either, but no run-up: thousands of steps."""
    pairs = product(*(default_registry().names(kind) for kind in ("excitation", "integrator")))
    return [
        pytest.param(
            *pair, marks=() if "run_up" not in pair and {"bidirectional", "newmark"} & {*pair} else pytest.mark.slow
        )
        for pair in pairs
    ]


class NeedsOptions(Exception):
    """A plug-in with required options and no ``examples()`` to take them from."""


@cache
def options(kind: str, name: str) -> dict[str, Any]:
    """Options of a plug-in for a scene: its first example's, else none, if it needs none.  NeedsOptions"""
    plugin = default_registry().find(kind, name).plugin
    if hasattr(plugin, "examples"):
        given = {f.name: getattr(plugin.examples()[0], f.name) for f in attrs.fields(plugin) if f.init}
        return {key: list(v) if isinstance(v, tuple) else v for key, v in given.items() if v is not None}
    if any(f.init and f.default is attrs.NOTHING for f in attrs.fields(plugin)):
        raise NeedsOptions(f"{kind} {name}")
    return {}


#: Cells with elastic bodies that run, each in seconds; the others have no [mesh] and are refused.
ELASTIC = (
    ("unidirectional", "hertz", "nodal", "quasi_static", "sine_fit", "locked"),
    ("bidirectional", "hertz", "nodal", "newmark", "tangent", "free"),
    ("unidirectional", "hertz", "resultant", "newmark", "fft_1x", "free"),
    ("bidirectional", "penalty", "resultant", "quasi_static", "sine_fit", "locked"),
)
#: What every law that serves whole contacts runs with on elastic bodies.
WHOLE = Combination("bidirectional", "hertz", "resultant", "newmark", "fft_1x", "locked", "elastic")


def runs_elastic(cell: Combination) -> bool:
    """Whether a cell of elastic bodies has a mesh to run on."""
    if cell.bodies != "elastic":
        return False
    whole = "resultant" in default_registry().find("contact_law", cell.law).plugin.discretisations
    return attrs.astuple(cell)[:6] in ELASTIC or (whole and attrs.evolve(cell, law=WHOLE.law) == WHOLE)


def elastic_tables(cell: Combination) -> dict[str, Any]:
    """A bearing of three balls on some thousand hexahedra, for one turn of 8 steps; nothing for other bodies.

    Whole contacts take no refined cells, and a load of a ball as under 1000 N on twelve: a law that is calibrated there, but
    stiffer than Hertz's, has more compliance than the mesh even under five times that load.  The force is a fifth of it.
    """
    if not runs_elastic(cell):
        return {}
    nodal = cell.discretisation == "nodal"
    fine = {"nodes_per_semi_axis": 1, "growth": 3.0, "patch": 0.5, "ball_load": 3e4}
    mesh = {"kind": "structured", "element_size": 3.2e-3, "azimuth_cells": 12}
    given = {"kind": cell.excitation, **options("excitation", cell.excitation)}
    return {
        "bearing": {"preset": "B7206C", "ball_count": 3},
        "excitation": given if nodal else given | {"unbalance": 3e-5},
        "bodies": {"kind": "elastic", "formulation": "one_point" if nodal else "incompatible"},
        "mesh": mesh | (fine if nodal else {"nodes_per_semi_axis": 0}),
        "load": {"axial": 2500.0 if nodal else 240.0},
        "integrator": {"kind": cell.integrator, "turns": 1, "steps_per_turn": 8 if nodal else 32, "tolerance": 1e-5},
        # Eight samples a turn tell three harmonics.
        **({"identifier": {"kind": "sine_fit", "harmonics": 3}} if nodal and cell.identifier == "sine_fit" else {}),
    }


def tables(cell: Combination) -> dict[str, Any]:
    """A short run: 6 turns of 120 steps; more steps where an explicit method asks for them, fewer where they are costly."""
    implicit = default_registry().find("integrator", cell.integrator).plugin.implicit
    nodal = (cell.discretisation, cell.bodies) == (PLAIN.discretisation, PLAIN.bodies)
    turns, steps = (1 if cell.identifier in ("fft_1x", "sine_fit") else 6, 24) if nodal else (6, 120)
    points = {"mesh": {"kind": "structured", "nodes_per_semi_axis": 3, "element_size": 1.2e-3}}
    return {
        **(points if nodal else {}),
        "title": str(cell), "bearing": {"preset": "B7206C"}, "load": {"axial": 2000.0}, "rotor": {"mass": 2.0},
        "supports": {"tilt": cell.tilt}, "bodies": {"kind": cell.bodies},
        "excitation": {"kind": cell.excitation, **options("excitation", cell.excitation)},
        "contact": {"kind": cell.law, "discretisation": cell.discretisation, **options("contact_law", cell.law)},
        "integrator": {
            "kind": cell.integrator, "turns": turns, "steps_per_turn": steps if implicit else "auto",
            **options("integrator", cell.integrator),
        },
        "identifier": {"kind": cell.identifier, **options("identifier", cell.identifier)},
    } | elastic_tables(cell)  # fmt: skip


@attrs.frozen
class Outcome:
    """What a run is judged by (its record would take gigabytes over the whole matrix).

    text : its result.json;  drift : of its energy;  stiffness : K [N/m];  dynamic : Z [N/m];  speed : w [rad/s]
    mass : carried by the bearing [kg]
    """

    text: str
    drift: float | None
    stiffness: float
    dynamic: complex
    speed: float
    mass: float


@cache
def outcome(cell: Combination) -> Outcome | SceneError:
    """The run, or its refusal."""
    try:
        result = run(scene_from_dict(tables(cell)))
    except SceneError as refused:
        return refused
    except RacewayError as failed:
        raise AssertionError(f"{cell} failed: {failed}") from failed
    found = result.identification
    text, drift = json.dumps(result.to_dict(), allow_nan=False), result.stability["energy_drift"]
    mass = float(result.model.system.mass[1, 1])
    return Outcome(text, drift, found.equivalent_stiffness, found.dynamic_stiffness, found.speed, mass)


@cache
def reference(excitation: str, tilt: str | float, bodies: str) -> complex | None:
    """Z of the same physics and bodies by Hertz, Newmark and the first identifier that takes this excitation."""
    for identifier in ("fft_1x", "order_tracking", "sine_fit"):
        found = outcome(Combination(excitation, "hertz", "resultant", "newmark", identifier, tilt, bodies))
        if isinstance(found, Outcome):
            return found.dynamic
    return None
