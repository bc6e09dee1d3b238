"""Values of a scene that are possible and unlikely, mostly in another unit; failures of a run that can be foreseen."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from math import inf

import attrs

from raceway.errors import Mistake
from raceway.framework.duties import bodies, traits_of
from raceway.planning.recording import turns_of
from raceway.scene.growth import loose_rings
from raceway.scene.scene import Scene

#: By unit or key the largest plausible size, and what is right: bearings of 2 m exist; rotors on ball bearings weigh tons at most.
_MOST = {
    "m": (1.0, " m", "lengths are in metres"),
    "rotor.mass": (1e4, " kg", "masses are in kilograms"),
    "contact.friction": (1.0, "", "steel on steel has about 0.1 with oil and 0.8 dry (Bowden and Tabor 1950)"),
}
#: Below this a Young's modulus [Pa] is reported: cages of soft plastics exist.
_YOUNG = 1e9
#: How far the estimate of the highest frequency may be off.
_ROUGH = 2.0
_TABLES = ("bearing", "rotor", "contact", "kinematics", "mesh", "supports", "mounting")


def implausible(scene: Scene) -> tuple[str, ...]:
    """A sentence for each value that is likely to be in another unit, and for each ring that is loose."""
    found = loose_rings(scene)
    for table in _TABLES:
        for path, unit, value in _numbers(getattr(scene, table), table):
            most, symbol, right = _MOST.get(path) or _MOST.get(unit or "", (inf, "", ""))
            if abs(value) > most:
                found.append(f"`{path}` = {value:g}{symbol} is more than {most:g}{symbol}: {right}")
            if unit == "Pa" and value < _YOUNG:
                found.append(f"`{path}` = {value:g} Pa is less than {1e-9 * _YOUNG:g} GPa: steel has 2.1e11 Pa")
    return tuple(found)


def _numbers(table: attrs.AttrsInstance | None, path: str) -> Iterator[tuple[str, str | None, float]]:
    """Path, unit and value of every number in a table and the tables in it."""
    cls: type = type(table)
    for name, unit in _units(cls):
        value = getattr(table, name)
        if isinstance(value, float):
            yield f"{path}.{name}", unit, value
        elif attrs.has(type(value)):
            yield from _numbers(value, f"{path}.{name}")


@cache
def _units(cls: type) -> tuple[tuple[str, str | None], ...]:
    """Names of a table's keys, each with its unit; none of what is no table."""
    if not attrs.has(cls):
        return ()
    return tuple((field.name, field.metadata.get("unit")) for field in attrs.fields(cls))


def foreseen(scene: Scene) -> list[Mistake]:
    """Failures of a run that closed formulas foresee: for ``raceway check``."""
    found = []
    load, free = scene.load, scene.supports.axial != "displacement"
    moment = any(load.moment) and scene.supports.tilt != "locked"
    if free and not (load.axial or any(load.radial) or moment or scene.bearing.preloaded):
        found.append(Mistake("load.axial", load.axial, "nothing loads the bearing: there is no stiffness to find"))
    if scene.excitation is None or "record" not in scene.identifier.method.needs:
        return found
    window, turns = getattr(scene.identifier.method, "window_turns", None), turns_of(scene)
    if window is not None and window > turns:
        why = f"is longer than the record of {turns} turns: shorten it, or integrate more turns"
        found.append(Mistake("identifier.window_turns", window, why))
    steps = scene.integrator.steps_per_turn
    if not scene.integrator.method.implicit and isinstance(steps, int) and not traits_of(scene).every_node:
        period = scene.excitation.period_s or 1.0 / scene.excitation.frequency_hz
        stable = bodies(scene, "stable_step")
        least = 0 if stable is None else int(period / stable)
        if steps * _ROUGH < least:
            why = f"is far above the stable step of an explicit method: some {least} steps a turn are needed, 'auto' takes enough"
            found.append(Mistake("integrator.steps_per_turn", steps, why))
    return found
