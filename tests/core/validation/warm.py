"""Warm bearings against hand calculations and published measurements."""

from typing import Any

import numpy as np

import raceway as rw
from raceway.core.quantities import rolling_friction
from raceway.pipeline.warm import band_of_heat

_LINKS = ("inner_balls", "outer_balls", "inner_oil", "balls_oil", "outer_oil", "inner_shaft", "outer_housing")
#: Of conductances that are all given [W/K]: nothing but friction depends on the state.
_GIVEN = {"inner_balls": 0.5, "outer_balls": 0.5, "inner_oil": 0.5, "balls_oil": 0.5, "outer_oil": 0.5, "inner_shaft": 50.0,
          "shaft_ambient": 1.0, "outer_housing": "infinite", "housing_ambient": 50.0}  # fmt: skip


def warm_pair(heat: dict[str, object] | None = None, **tables: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """A DB pair of B7206C, preloaded rigidly by 300 N, at 12 000 r/min in VG 32."""
    scene: dict[str, dict[str, Any]] = {
        "bearing": {"preset": "B7206C", "arrangement": "DB", "preload": 300.0},
        "kinematics": {"spin_speed_rpm": 12_000.0, "gyroscopic": "none", "ring_growth": False},
        "lubricant": {"oil": "VG 32"},
        "heat": {"oil_inlet_c": 40.0, "oil_flow": 8e-6, **(heat or {})},
    }
    return {name: {**scene.get(name, {}), **tables.get(name, {})} for name in {**scene, **tables}}


def runaway_pair(preload: float) -> dict[str, dict[str, Any]]:
    """A pair that is cooled from outside, in an oil that does not thin, without centrifugal forces."""
    heat = {"oil_inlet_c": 20.0, "oil_flow": 1e-6, **_GIVEN}
    scene = warm_pair(heat, bearing={"preload": preload}, kinematics={"spin_speed_rpm": 12_000.0, "ball_inertia": False})
    return {**scene, "lubricant": {"viscosity": 0.01}}


def runaway_speed(preload: float) -> float:
    """Speed [r/min] above which that pair has no steady temperature, as a run says."""
    try:
        rw.run(runaway_pair(preload))
    except rw.ConvergenceError as failure:
        return float(str(failure).split(" r/min")[0].split()[-1])
    return np.inf


def runaway_by_hand(preload: float) -> float:
    """Speed [r/min] at which the pair of ``_GIVEN`` runs away: the fold of Q = K (d0 + growth(T(heat(Q))))^1.5.

    The approach d grows linearly with the temperatures along the contact's line, Hertz gives the ball load Q, friction at that load
    its heat, the network of four nodes its temperatures.
    """
    scene = rw.Scene.from_dict({"bearing": {"preset": "B7206C"}, "load": {"axial": preload}})
    b, alone = scene.bearing, rw.run(scene)
    reach = (b.conformity_inner + b.conformity_outer - 1.0) * b.ball_diameter
    along, across = reach * np.sin(b.contact_angle) + alone.displacement[0], reach * np.cos(b.contact_angle)
    angle, approach = np.arctan2(along, across), np.hypot(along, across) - reach
    hertz = alone.equilibrium.contact_force.mean() / approach**1.5
    inner = 0.5 * b.pitch_diameter + (b.conformity_inner - 0.5) * b.ball_diameter * np.cos(b.contact_angle)
    outer = 0.5 * b.pitch_diameter - (b.conformity_outer - 0.5) * b.ball_diameter * np.cos(b.contact_angle)
    apart = 0.5 * b.width * np.sin(angle)  # rings and sleeves move the rows' inner grooves apart
    by_kelvin = 12.5e-6 * np.array([
        inner * np.cos(angle) - apart - b.conformity_inner * b.ball_diameter,
        b.ball_diameter,
        reach * np.sin(b.contact_angle) * np.sin(angle) + apart - outer * np.cos(angle) - b.conformity_outer * b.ball_diameter,
    ])  # fmt: skip
    links = [(0, 1, 0.5), (2, 1, 0.5), (0, 3, 0.5), (1, 3, 0.5), (2, 3, 0.5)]
    network = np.diag([1.0 / (1.0 / 50.0 + 1.0), 0.0, 50.0, 1e-6 * 870.0 * 2000.0])
    for i, j, conductance in links:
        network[[i, j, i, j], [i, j, j, i]] += conductance * np.array([1.0, 1.0, -1.0, -1.0])
    units = 0.5 / (1e-6 * 870.0 * 2000.0)
    inlet = 0.5 * (1.0 / units - 1.0 / np.expm1(units))  # the outer ring's film begins at its temperature, 0 here
    network[[2, 3], 3] += [inlet, -inlet]
    cold = {name: table for name, table in runaway_pair(preload).items() if name != "heat"}
    losses = rw.function(
        cold, ["kinematics.radial_expansion", "kinematics.spin_speed_rpm"], ["ball_load", "torque_nm", "torque_drag_nm"]
    )
    squeezed = {**cold, "kinematics": {"spin_speed_rpm": 4500.0, "ball_inertia": False, "radial_expansion": 8e-6}}
    places = rw.run(squeezed).to_dict()["friction"]["heat_w"]
    share, squeeze = places["inner"] / (places["inner"] + places["outer"]), np.linspace(0.0, 30e-6, 300)

    def steady(rpm: float) -> bool:
        answer, turns = losses(squeeze, rpm), rpm * np.pi / 30.0
        contacts, load = turns * (answer["torque_nm"] - answer["torque_drag_nm"]), answer["ball_load"].mean(axis=(1, 2))
        heats = np.stack(
            [0.5 * share * contacts, 0.5 * contacts, 0.5 * (1.0 - share) * contacts, turns * answer["torque_drag_nm"]]
        )
        grown = approach + by_kelvin @ np.linalg.solve(network, heats)[:3]
        return bool((hertz * np.maximum(grown, 0.0) ** 1.5 < load).any())

    low, high = 100.0, 20_000.0
    while high - low > 1.0:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if steady(middle) else (low, middle)
    return low


def isothermal_difference() -> float:
    """Between infinite conductances and a scene at the inlet's temperature: of temperatures, stiffness and ball loads, over the largest."""
    infinite = dict.fromkeys(_LINKS, "infinite") | {"oil_flow": "infinite"}
    warm = rw.run(warm_pair(infinite, load={"radial": [200.0, 0.0]}))
    given = warm_pair(load={"radial": [200.0, 0.0]}, mounting={f"{k}_temperature": 20.0 for k in ("inner", "outer", "ball")})
    given["lubricant"]["temperature_c"] = 40.0
    del given["heat"]
    cold = rw.run(given).equilibrium
    level = np.array(list(warm.to_dict()["heat"]["temperatures_k"].values()))
    pairs = (
        (level, np.array([313.15])), (warm.equilibrium.stiffness, cold.stiffness),
        (warm.equilibrium.contact_force, cold.contact_force),
    )  # fmt: skip
    return float(max(np.abs(a - b).max() / np.abs(b).max() for a, b in pairs))


def energy_imbalance() -> float:
    """Of a pair: heat of friction less what leaves, over it."""
    heat = rw.run(warm_pair()).to_dict()["heat"]
    return abs(sum(heat["flows_w"].values()) / heat["heat_w"] - 1.0)


def heat_at_rest() -> float:
    """[W]."""
    return float(rw.run(warm_pair(kinematics={"spin_speed_rpm": 0.0})).to_dict()["heat"]["heat_w"])


#: NASA TP-2275 as read off a figure, docs/measurements.md: r/min, heat [W], inner and outer ring [K].
MEASURED = (
    (28e3, 350.0, 422.0, 413.0), (48e3, 700.0, 443.0, 425.0), (64e3, 1100.0, 458.0, 435.0), (72e3, 1400.0, 468.0, 443.0),
)  # fmt: skip
#: Bearings of that report by bore: ball and pitch diameter, bore, outer diameter, width [m], balls, angle [deg], axial load [N].
_SIZES = {
    35: (7.14e-3, 46.5e-3, 0.035, 0.062, 0.014, 16, 24.0, 667.0),
    120: (20.64e-3, 0.160, 0.120, 0.200, 0.038, 15, 25.0, 22_240.0),
    167: (22.23e-3, 0.196, 0.167, 0.225, 0.036, 23, 20.0, 22_240.0),
}
_KEYS = ("ball_diameter", "pitch_diameter", "bore", "outer_diameter", "width", "ball_count", "contact_angle_deg")
#: Bore, r/min, flow [cm3/min] and heat [W] of its runs.
HEATS = (
    *((35, rpm, 760.0, watt) for rpm, watt, *_ in MEASURED),
    *((120, rpm, flow, watt) for flow in (2280.0, 8700.0) for rpm, watt in ((5e3, 2500.0), (8e3, 4800.0), (12e3, 8800.0))),
    *((167, rpm, 10_600.0, watt) for rpm, watt in ((6e3, 5e3), (8.4e3, 9e3), (12e3, 18e3), (15e3, 25e3))),
)


def jet_bearing(bore: int, rpm: float, flow: float, ambient_c: float = 394.0 - 273.15) -> dict[str, dict[str, Any]]:
    """A bearing of these measurements, every coefficient at its default; its surroundings as warm as the oil that fills them."""
    *sizes, load = _SIZES[bore]
    return {
        "bearing": dict(zip(_KEYS, sizes, strict=True)) | {"conformity_inner": 0.535, "conformity_outer": 0.535},
        "load": {"axial": load},
        "kinematics": {"spin_speed_rpm": rpm, "gyroscopic": "none", "ring_growth": False},
        "lubricant": {"viscosity_40": 27.6e-6, "viscosity_100": 5.1e-6, "density": 930.0},
        "heat": {"oil_inlet_c": 394.0 - 273.15, "oil_flow": f"{flow} cm3/min", "ambient_c": ambient_c},
    }


def heat_by_factors(bore: int, rpm: float, flow: float) -> tuple[float, float]:
    """Heat [W] of a bearing with the least and the largest factor of friction that ``MEASURED`` of the core has for it."""
    scene = jet_bearing(bore, rpm, flow)
    scene["heat"]["conductance_band"] = 0.0
    known = next(one for one in rolling_friction.MEASURED if one.name.startswith(f"{bore} mm"))
    low, high = band_of_heat(rw.Scene.from_dict(scene), (known.least, known.largest))["heat_w"]
    return low, high


def heat_and_band(bore: int, rpm: float, flow: float) -> tuple[float, float, float]:
    """Heat of friction of one of these bearings, and the ends of its band [W], the upper one infinite where nothing is steady there."""
    heat = rw.run(jet_bearing(bore, rpm, flow)).to_dict()["heat"]
    low, high = heat["band"]["heat_w"]
    return heat["heat_w"], low, np.inf if high is None else high


def outside_the_others() -> list[str]:
    """Bearings of ``MEASURED`` of the core outside the band of friction that the others would give them."""
    out = []
    for one in rolling_friction.MEASURED:
        others = tuple(known for known in rolling_friction.MEASURED if known is not one)
        low, high = rolling_friction.measured_factors(
            one.pitch_diameter, one.fastest * np.pi / 3e4 / one.pitch_diameter, others
        )
        out += [] if low < one.least <= one.largest < high else [one.name]
    return out


def rings_and_band(rpm: float) -> tuple[dict[str, float], tuple[float, float]]:
    """Of the 35 mm bearing the temperatures [K], and the band of the inner ring's less the outer one's."""
    heat = rw.run(jet_bearing(35, rpm, 760.0)).to_dict()["heat"]
    return heat["temperatures_k"], tuple(heat["band"]["inner_less_outer_k"])
