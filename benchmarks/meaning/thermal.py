"""Heat: expansion of bodies that are not of steel, fits of two materials, planes that rows grow apart by, films at spindle speed."""

from __future__ import annotations

from contextlib import suppress
from math import radians
from typing import Any

import numpy as np

import raceway as rw
from benchmarks.evidence import Row, below, near
from raceway.bodies.mounting import preload_table
from raceway.contact_laws.film import Film
from raceway.contact_laws.lubricant import GRADES, Walther
from raceway.core.contact.film import thermal_reduction
from raceway.errors import SceneError
from raceway.pipeline.run import run
from raceway.pipeline.settle import settle
from raceway.planning.plan import make_plan
from raceway.scene.growth import inner_fit, outer_fit
from validation.film import OIL, SPINDLE, inlet_film, skf_reduction
from validation.fits import fits_by_hand
from validation.reference.ring import Ring
from validation.reference.row_set import RowSet, press, warmed

COMMAND = "python -m benchmarks.meaning thermal"
_WARM = ("inner_temperature", "outer_temperature", "ball_temperature")
_NITRIDE = {"young": 310e9, "poisson": 0.27, "density": 3240.0}
_DB = {"preset": "B7206C", "arrangement": "DB", "preload": 300.0}
_STEEL = 12.5e-6


def rows() -> list[Row]:
    return [*_expansion(), *_fits(), *_planes(), *_film()]


def _scene(bearing: dict[str, Any], **tables: Any) -> rw.Scene:
    return rw.Scene.from_dict({"bearing": {**_DB, **bearing}, **tables})


def _kxx(bearing: dict[str, Any], **mounting: Any) -> float:
    return float(1e-6 * run(_scene(bearing, mounting=mounting)).equilibrium.stiffness[0, 0])


def _accepted(scenes: list[tuple[dict[str, Any], dict[str, Any]]]) -> int:
    count = 0
    for bearing, mounting in scenes:
        with suppress(SceneError):
            make_plan(_scene(bearing, mounting=mounting))
            count += 1
    return count


def _expansion() -> list[Row]:
    """Warm bodies that are not of steel."""
    warm = dict.fromkeys(_WARM, 40.0)
    named, given = (
        _kxx({"balls": one}, **warm) for one in ({"material": "Si3N4"}, {**_NITRIDE, "thermal_expansion": 3.2e-6})
    )
    steel = _kxx({"balls": {**_NITRIDE, "thermal_expansion": _STEEL}}, **warm)
    command = "raceway run examples/minimal.toml --set bearing.balls.young=310e9 --set mounting.ball_temperature=40"
    note = f"before: {steel:.1f} N/µm, silently, with the expansion of steel; now refused until the expansion is given"
    bodies: list[Any] = [
        ({"balls": {"young": young}}, {"ball_temperature": kelvin})
        for young in (70e9, 200e9, 310e9)
        for kelvin in (-40.0, 40.0)
    ]
    bodies += [({}, {"shaft_material": {"young": 70e9}, "inner_temperature": 10.0})]
    cold: list[Any] = [({}, {name: kelvin}) for name in _WARM for kelvin in (-293.2, -1e4)]
    return [
        near("DB of 300 N, hybrid balls by numbers, all at +40 K: kxx [N/µm], as of material = 'Si3N4'", given, named, 1e-12, command, note),
        near("the same: kxx as independent solvers had it [N/µm]", given, 17.05, 1e-3, command),
        below(f"of {len(bodies)} scenes whose warm body is not of steel and has no expansion: accepted", _accepted(bodies), 0, COMMAND),
        below(f"of {len(cold)} scenes below absolute zero: accepted", _accepted(cold), 0, COMMAND, "before: all, or another refusal"),
    ]  # fmt: skip


def _fits() -> list[Row]:
    """Against two annuli by their own displacements; an aluminium housing that warms up."""
    rng, worst = np.random.default_rng(32), 0.0
    for _ in range(200):
        low, high = np.array([40e9, 0.2, 0.0]), np.array([400e9, 0.4, 3e-5])
        keys = ("young", "poisson", "thermal_expansion")
        shaft, housing = (dict(zip(keys, rng.uniform(low, high).tolist(), strict=True)) for _ in range(2))
        mounting = {
            "shaft_bore": rng.uniform(0.0, 25e-3),
            "housing_diameter": rng.uniform(66e-3, 0.3),
            "inner_temperature": 6.0,
        }
        mounting |= {"shaft_interference": 8e-6, "housing_interference": 5e-6, "outer_temperature": -4.0}
        one = _scene(
            {"arrangement": "single", "preload": 0.0},
            mounting={**mounting, "shaft_material": shaft, "housing_material": housing},
        )
        hand = fits_by_hand(one)
        found = inner_fit(one, one.bearing), outer_fit(one, one.bearing)
        worst = max(worst, *(abs(a - b) / 1e-6 for a, b in zip(found, hand, strict=True)))
    cold, warm = {"housing_interference": 10e-6}, {"housing_interference": 10e-6, **dict.fromkeys(_WARM, 20.0)}
    steel, soft = _kxx({}, **warm), _kxx({}, housing_material="AlMgSi", **warm)
    free = _kxx({}, **dict.fromkeys(_WARM, 20.0))
    command = "raceway run examples/duplex_db.toml --set mounting.housing_interference=10e-6 --set mounting.housing_material=AlMgSi"
    note = f"before: {steel:.2f} N/µm, a housing of steel for want of another; cold {_kxx({}, housing_material='AlMgSi', **cold):.2f}"
    return [
        below("growth of raceways by 200 random fits of two materials against two annuli, over 1 µm", worst, 1e-9, COMMAND),
        near("DB, fit of 10 µm in an aluminium housing, +20 K: kxx [N/µm], as without any fit, which 13 µm take", soft, free, 1e-9, command, note),
    ]  # fmt: skip


def _planes() -> list[Row]:
    """Warm outer rings: the rows' force against rows whose every point grows away from the origin."""
    one = _scene({"row_distance": 16e-3}, kinematics={"ball_inertia": False}, mounting={"outer_temperature": 10.0})
    model = rw.build_model(one, make_plan(one))
    table = preload_table(model, settle(model))
    assert table is not None, "a set with preload"

    def ring() -> Ring:
        return Ring(9.525e-3, 46e-3, 12, radians(15.0), 0.522, 0.522)

    strain, shift = 10.0 * _STEEL, press(ring(), 300.0)
    sides, places = (list(column) for column in zip(*one.bearing.rows, strict=True))
    forces = []
    for beyond in (0.0, 0.022 * 9.525e-3 * np.sin(radians(15.0))):  # of the inner groove centres beyond the balls' plane
        grown = [warmed(ring(), (0.0, strain, 0.0), side, place) for side, place in one.bearing.rows]
        expected = RowSet(grown, sides, places, [shift - strain * beyond] * 2)
        forces.append(expected.rows(expected.settle(np.zeros(3)))[0])
    command = "raceway run examples/duplex_db.toml --set mounting.outer_temperature=10"
    note = f"before, with the balls' plane for that of the groove centres: {forces[1] / forces[0] - 1.0:.1e}"
    return [below("DB, outer rings +10 K: force of a row against planes that grow by themselves, relative", abs(table["running_n"] / forces[0] - 1.0), 1e-6, command, note)]  # fmt: skip


def _film() -> list[Row]:
    """A DB pair of 7014C, 300 N, at 18 000 r/min in VG 32 at 40 C; the factor; warnings at ordinary speeds."""
    laws = ({"kind": "hertz"}, {**OIL, "inlet_heating": "none"}, OIL)
    found = [
        run(rw.Scene.from_dict({"bearing": SPINDLE, "contact": law, "kinematics": {"spin_speed_rpm": 18000.0}}))
        for law in laws
    ]
    dry, cold, hot = (one.to_dict()["equilibrium"]["preload"]["running_n"] for one in found)
    command = "raceway run PAIR --set contact.kind=film --set 'contact.oil=VG 32' --set contact.temperature_c=40"
    note = f"dry {dry:.0f} N, isothermal film {cold:.0f} N (before), with the heat of the inlet {hot:.0f} N; "
    note += "the estimate 'about half' had beta = 0.035 1/K, 0.61; by default beta is the slope of the oil's line, 0.043 1/K"
    known = Film(viscosity=0.02784, temperature_viscosity=0.035, conductivity=0.14)
    factor = thermal_reduction(np.array(known.dynamic_viscosity * known.beta * 42.0**2 / known.conductivity))
    loadings = (0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0)
    inlet = max(abs(float(thermal_reduction(np.array(loading))) / inlet_film(loading) - 1.0) for loading in loadings)
    away = 0.0
    for oil in ("VG 10", "VG 32", "VG 68", "VG 100"):
        line = Walther(*GRADES[oil])
        for celsius in (40.0, 60.0, 80.0):
            for diameter in np.array([1e5, 3e5, 1e6, 2e6]) / 2e4 * 1e-3:
                speed = np.pi * diameter * 2e4 / 120.0  # of rolling at a small g
                loading = 870e-6 * line.viscosity(celsius) * line.thinning(celsius) * speed**2 / 0.14
                skf = skf_reduction(2e4, float(diameter), 1e-6 * line.viscosity(celsius))
                away = max(away, abs(float(thermal_reduction(np.array(loading))) - skf))
    warned = 0
    for name in ("B7206C", "7014C", "B7206E", "7014A"):
        for load in (100.0, 400.0, 1600.0):
            tables = {"preset": name, "arrangement": "single", "preload": 0.0}
            one = _scene(
                tables, contact={**OIL, "roughness": None}, load={"axial": load}, kinematics={"spin_speed_rpm": 3000.0}
            )
            warned += any("film" in warning for warning in run(one).warnings)
    return [
        near("part of an isothermal film's gain of preload that the heat of the inlet takes", (cold - hot) / (cold - dry), 0.5, 0.2, command, note),
        near("thermal reduction at 42 m/s, beta 0.035 1/K, 0.14 W/m/K", float(factor), 0.45, 0.02, COMMAND),
        below("thermal reduction, L from 0.1 to 100, against the integrated inlet, relative", inlet, 0.15, COMMAND),
        below("thermal reduction less SKF's of its friction moment, VG 10 to 100, 40 to 80 C, n d_m to 2e6", away, 0.12, COMMAND),
        below("of 12 bearings at 3000 r/min: with a warning of their film", warned, 0, COMMAND, "before: all, of U, W and k"),
    ]  # fmt: skip
