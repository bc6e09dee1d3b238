"""Axial loads, either way, at which rows of a set lift off, contacts reach their groove's edge and pressures a limit.

Notes
-----
The ring is moved axially, the other coordinates held at zero, and every row's force follows: no equilibrium has to be solved
for.  Preload, speed, fits and temperatures are those of the scene, its loads are not.  Rows on a spring keep its force, as their
outer rings follow.
"""

from __future__ import annotations

from collections.abc import Callable

import attrs
import numpy as np

from raceway.bodies.model import Model, build_model
from raceway.core.ring.kernels.layout import CAGE
from raceway.errors import ConvergenceError, SceneError
from raceway.framework.duties import traits_of
from raceway.framework.registry import Registry
from raceway.planning.plan import make_plan
from raceway.scene.reading import scene_from_dict
from raceway.scene.scene import Scene
from raceway.storage.tables import Tables

#: Peak pressure of a ball bearing's static load rating [Pa].  Source: ISO 76:2006, 4200 MPa for ball bearings.
STATIC_PRESSURE = 4.2e9
#: Halvings of an interval of displacements: to the last bit.
_HALVINGS = 100
#: First step of a displacement over the distance of the groove centres.
_STEP = 1e-3


@attrs.frozen
class Limit:
    """The axial load at which something happens, and the row where it does, from 1; None where it never does."""

    load_n: float | None
    row: int | None


@attrs.frozen
class AxialLimits:
    """Limits of one direction of the axial load.

    Attributes
    ----------
    direction : "+x" or "-x"
    lift_off : of the first row that carries nothing any more;  over_preload : that load over the given preload
    edge : of the first contact ellipse that reaches its groove's edge;  pressure : of the first contact with the limiting pressure
    """

    direction: str
    lift_off: Limit
    over_preload: float | None
    edge: Limit
    pressure: Limit

    @property
    def limiting(self) -> float | None:
        """The smaller load of edge and pressure [N]."""
        loads = [abs(one.load_n) for one in (self.edge, self.pressure) if one.load_n is not None]
        return min(loads, default=None)


@attrs.frozen(eq=False)
class _State:
    """Forces at one axial displacement: of the set [N], of each row in its seating direction [N], of contacts (2 Z,)."""

    axial: float
    rows: np.ndarray
    inner: np.ndarray
    outer: np.ndarray
    contact: np.ndarray


@attrs.frozen(eq=False)
class _Moved:
    """A bearing moved axially, without loads in other directions."""

    model: Model

    @property
    def sprung(self) -> np.ndarray:
        """(rows,) whether a row sits on a spring."""
        rows, sprung = self.model.scene.bearing.rows, self.model.system.sliding is not None
        return np.array([sprung and side != rows[0][0] for side, _ in rows])

    def at(self, x: float, rest: _State | None = None) -> _State:
        """The forces; rows on a spring keep those of ``rest``."""
        model, q = self.model, np.array([x, 0.0, 0.0, 0.0, 0.0])
        system = model.system.without(CAGE)
        now, z = system.evaluate(q), system.ball_count
        inner, outer = model.bearing.contact_angles(model, q, now.ball, now.contact_force)
        contact = now.contact_force
        axial = contact[:z] * np.sin(np.nan_to_num(inner))
        rows = np.bincount(model.basis.row, axial)
        if rest is not None:
            kept = self.sprung[model.basis.row]
            inner, outer = np.where(kept, rest.inner, inner), np.where(kept, rest.outer, outer)
            contact = np.where(np.tile(kept, 2), rest.contact, contact)
            rows = np.where(self.sprung, rest.rows, rows)
        sides = np.array([side for side, _ in model.scene.bearing.rows])
        return _State(float(sides @ rows), rows, inner, outer, contact)

    def rest(self) -> float:
        """The displacement [m] at which the set carries no load; 0 where it is not braced."""
        system = self.model.system.without(CAGE)
        one = np.array([1.0, 0.0, 0.0, 0.0, 0.0])
        if len(set(self.model.scene.bearing.signs)) < 2:
            return 0.0
        try:
            return float(attrs.evolve(system, load=0.0 * one, free=one).settle(np.zeros(5))[0][0])
        except ConvergenceError:
            return 0.0


def axial_limits(
    scene: Scene, pressure: float = STATIC_PRESSURE, registry: Registry | None = None
) -> tuple[AxialLimits, AxialLimits]:
    """Limits under axial loads along +x and -x.

    Parameters
    ----------
    pressure : peak pressure that a contact shall not exceed [Pa]

    Raises
    ------
    SceneError
        A pressure that is none, bodies whose forces are not compiled, or what a run refuses.
    """
    if not 0.0 < pressure < np.inf:
        raise SceneError.at("--pressure", pressure, "must be a pressure in Pa above 0")
    if not traits_of(scene).compiled:
        why = "has no compiled forces to move the ring through: use contact resultants on rigid or condensed bodies"
        raise SceneError.at("bodies.kind", scene.bodies.name, why)
    tables = scene.to_dict()
    tables["load"], tables["supports"] = {}, {**tables["supports"], "tilt": "locked", "axial": "force"}
    alone = scene_from_dict(tables, registry)
    moved = _Moved(build_model(alone, make_plan(alone)))
    return _one_way(moved, 1.0, pressure), _one_way(moved, -1.0, pressure)


def limits_table(scene: Scene, found: tuple[AxialLimits, AxialLimits], pressure: float) -> Tables:
    """What ``raceway study limits`` prints."""
    b = scene.bearing
    return {
        "title": scene.title,
        "rows": [
            {"row": k + 1, "direction": sign, "position_m": place, "contact_angle_deg": float(np.degrees(one.contact_angle))}
            for k, (sign, (_, place), one) in enumerate(zip(b.signs, b.rows, b.of_rows, strict=True))
        ],
        "preload_n": b.preload,
        "preload_of": b.preload_of,
        "pressure_pa": pressure,
        "limits": [{**attrs.asdict(one), "limiting_n": one.limiting} for one in found],
    }


def _one_way(moved: _Moved, sense: float, pressure: float) -> AxialLimits:
    """Limits of loads of one sign."""
    model, start = moved.model, moved.rest()
    first = moved.at(start)
    keep = first if moved.sprung.any() else None
    sides = np.array([side for side, _ in model.scene.bearing.rows])
    unloading = sides != sense

    def lifted(now: _State) -> np.ndarray:
        return np.asarray((now.rows <= 0.0) & unloading)

    def over_edge(now: _State) -> np.ndarray:
        over = [model.bearing.over_edges(model, *_only(now, model.basis.row == k)) for k in range(len(sides))]
        return np.array(over)

    def pressed(now: _State) -> np.ndarray:
        z = len(model.basis.row)
        peaks = [model.bearing.contact_ellipse(model, race, now.contact[race * z : race * z + z])[0] for race in (0, 1)]
        highest = np.max(peaks, axis=0)
        return np.array([highest[model.basis.row == k].max() >= pressure for k in range(len(sides))])

    found = [_first(moved, start, sense, keep, test) for test in (lifted, over_edge, pressed)]
    preload = model.scene.bearing.preload
    lift = found[0].load_n
    over = None if lift is None or preload == 0.0 else abs(lift) / preload
    return AxialLimits("+x" if sense > 0.0 else "-x", found[0], over, found[1], found[2])


def _only(now: _State, chosen: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Angles and forces of one row; the other balls carry nothing."""
    return (
        np.where(chosen, now.inner, np.nan),
        np.where(chosen, now.outer, np.nan),
        np.where(np.tile(chosen, 2), now.contact, 0.0),
    )


def _first(moved: _Moved, start: float, sense: float, keep: _State | None, test: Callable[[_State], np.ndarray]) -> Limit:
    """The load at which a test, which rows (rows,) do not pass any more, is met first on the way from ``start``."""
    end = moved.model.bearing.largest_motion
    low, step = start, _STEP * end
    if test(moved.at(start, keep)).any():
        return Limit(0.0, int(np.argmax(test(moved.at(start, keep)))) + 1)
    while True:
        high = start + sense * step
        now = moved.at(high, keep)
        if test(now).any():
            break
        if step >= end:
            return Limit(None, None)
        low, step = high, min(2.0 * step, end)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        met = moved.at(middle, keep)
        if test(met).any():
            high, now = middle, met
        else:
            low = middle
    return Limit(now.axial, int(np.argmax(test(now))) + 1)
