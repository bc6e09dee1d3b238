"""The combinations: names from the registry, so that whatever is installed takes part; and one scene for each."""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import cache
from itertools import product
from typing import Any

import attrs

from raceway.errors import RacewayError, SceneError
from raceway.plan import BODIES
from raceway.registry import default_registry
from raceway.run import run
from raceway.scene_file import scene_from_dict

DISCRETISATIONS = ("resultant", "nodal")
TILTS: tuple[str | float, ...] = ("locked", "free", 3e4)
KINDS = ("excitation", "contact_law", "integrator", "identifier")


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


#: Rigid bodies run in every combination.  What bodies of other kinds have of their own meets every choice in cells that
#: differ from one of these in at most so many words: the loops, laws and identifiers behind them are the same.
NEAR = {
    "resultant": (("bidirectional", "hertz", "resultant", "newmark", "fft_1x", "locked"), 2),
    "nodal": (("bidirectional", "hertz", "nodal", "quasi_static", "tangent", "locked"), 1),
}


def combinations() -> Iterator[Combination]:
    """Every registered excitation x law x discretisation x integrator x identifier x tilt boundary x bodies kind.

    Of bodies that are not rigid those ``NEAR`` a plain one.
    """
    excitations, laws, integrators, identifiers = (default_registry().names(kind) for kind in KINDS)
    for cell in product(excitations, laws, DISCRETISATIONS, integrators, identifiers, TILTS, BODIES):
        plain, words = NEAR[cell[2]]
        near = sum(a != b for a, b in zip(cell, plain, strict=False)) <= words
        # Several speeds or many turns of points at every step say nothing new of the identifier, and take half a minute.
        cheap = cell[2] != "nodal" or cell[4] in ("tangent", "fft_1x")
        if cell[-1] == "rigid" or (near and cheap):
            yield Combination(*cell)


class NeedsOptions(Exception):
    """A plug-in with required options and no ``examples()`` to take them from."""


@cache
def options(kind: str, name: str) -> dict[str, Any]:
    """Options of a plug-in for a scene: its first example's, else none, if it needs none.

    Raises
    ------
    NeedsOptions
    """
    plugin = default_registry().find(kind, name).plugin
    if hasattr(plugin, "examples"):
        given = {f.name: getattr(plugin.examples()[0], f.name) for f in attrs.fields(plugin) if f.init}
        return {key: list(v) if isinstance(v, tuple) else v for key, v in given.items() if v is not None}
    if any(f.init and f.default is attrs.NOTHING for f in attrs.fields(plugin)):
        raise NeedsOptions(f"{kind} {name}")
    return {}


def tables(cell: Combination) -> dict[str, Any]:
    """A short run: 6 turns of 120 steps; more steps where an explicit method asks for them."""
    implicit = default_registry().find("integrator", cell.integrator).plugin.implicit
    # Few points where pressures at points are computed: every path of the program, not every digit.
    mesh = {"mesh": {"kind": "structured", "nodes_per_semi_axis": 2}} if cell.discretisation == "nodal" else {}
    return {
        **(mesh if cell.bodies != "rigid" else {}),
        "title": str(cell),
        "bearing": {"preset": "B7206C"},
        "load": {"axial": 2000.0},
        "rotor": {"mass": 2.0},
        "supports": {"tilt": cell.tilt},
        "bodies": {"kind": cell.bodies},
        "excitation": {"kind": cell.excitation, **options("excitation", cell.excitation)},
        "contact": {"kind": cell.law, "discretisation": cell.discretisation, **options("contact_law", cell.law)},
        "integrator": {
            "kind": cell.integrator,
            "turns": 6,
            "steps_per_turn": 120 if implicit else "auto",
            **options("integrator", cell.integrator),
        },
        "identifier": {"kind": cell.identifier, **options("identifier", cell.identifier)},
    }


@attrs.frozen
class Outcome:
    """What a run is judged by (its record would take gigabytes over the whole matrix).

    Attributes
    ----------
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
    return Outcome(
        json.dumps(result.as_dict(), allow_nan=False),
        result.stability["energy_drift"],
        found.equivalent_stiffness,
        found.dynamic_stiffness,
        found.speed,
        float(result.model.system.mass[1, 1]),
    )


@cache
def reference(excitation: str, tilt: str | float, bodies: str) -> complex | None:
    """Z of the same physics and bodies by Hertz, Newmark and the first identifier that takes this excitation."""
    for identifier in ("fft_1x", "order_tracking", "sine_fit"):
        found = outcome(Combination(excitation, "hertz", "resultant", "newmark", identifier, tilt, bodies))
        if isinstance(found, Outcome):
            return found.dynamic
    return None
