"""The other tables of a scene file as frozen attrs classes, SI; a table with ``kind`` holds the chosen plug-in's own options in
its last attribute."""

from __future__ import annotations

from functools import cache
from math import pi
from typing import Any, ClassVar

import attrs

from raceway.framework.options import (
    Rule,
    at_least,
    between,
    finite,
    inside,
    length,
    one_of,
    option,
    optional,
    positive,
    word_or,
    worded,
)
from raceway.framework.registry import Registry
from raceway.scene.bearing import Bearing, Material
from raceway.scene.heat import Heat
from raceway.scene.lubricant import Lubricant


def _each(low: float, words: str) -> Rule:
    def check(_instance: object, _attribute: object, value: tuple[float, ...]) -> None:
        if not value or min(value) <= low or len(set(value)) < len(value):
            raise ValueError(f"must be {words}, each once")

    return worded(check, words)


@attrs.frozen
class Signals:
    """Signals of the simulated rig's sensors."""

    sampling_hz: float = option(10_000.0, unit="Hz", help="sampling rate", rule=between(100.0, 1e7))
    duration: float = option(1.0, unit="s", help="length of a record", rule=between(0.01, 3600.0))
    noise_db: float = option(
        40.0, unit="dB", help="rms of the response at the speed over rms of the white noise", rule=between(0.0, 300.0)
    )
    mark_noise: float = option(
        0.0, help="rms of the white noise on the keyphasor's voltage, over its range", rule=between(0.0, 1.0)
    )
    drift: float = option(
        5e-6, unit="m", help="drift of the gap over a record: half linear, half a half-wave", rule=at_least(0.0)
    )
    run_out: float = option(5e-6, unit="m", help="run-out of the measured track, 1x", rule=at_least(0.0))
    run_out_angle_deg: float = option(70.0, unit="deg", help="angle of the run-out from the mark", rule=finite())
    slow_roll_rpm: float = option(300.0, unit="r/min", help="speed of the slow-roll record", rule=positive())
    speed_drift: float = option(0.0, help="change of speed over a record, relative", rule=between(-0.5, 0.5))
    seed: int = option(1, help="of the noise", rule=at_least(0))


@attrs.frozen
class Rig:
    """A shaft on two equal bearings, mirror images of each other about a disc at mid-span.

    Notes
    -----
    The tested bearing is the left one; the shaft's axis runs from the left end to the right one.
    """

    shaft_length: float = option(0.426, unit="m", help="end to end", rule=positive())
    shaft_diameter: float = option(0.030, unit="m", help="diameter of the shaft", rule=positive())
    span: float = option(0.175, unit="m", help="distance of the bearings' centres", rule=positive())
    disc_radius: float = option(0.090, unit="m", help="radius of the disc", rule=positive())
    disc_thickness: float = option(0.020, unit="m", help="width of the disc", rule=positive())
    hub_diameter: float | None = option(
        None, unit="m", help="bending diameter within the disc; default: the shaft's", rule=optional(positive())
    )
    young: float = option(212e9, unit="Pa", help="Young's modulus of the shaft", rule=positive())
    poisson: float = option(0.29, help="Poisson's ratio of the shaft", rule=inside(-1.0, 0.5))
    density: float = option(7810.0, unit="kg/m3", help="of shaft and disc", rule=positive())
    unbalance_mass: float = option(7.1e-3, unit="kg", help="added to the disc", rule=positive())
    unbalance_radius: float = option(0.090, unit="m", help="distance of that mass from the axis", rule=positive())
    unbalance_angle_deg: float = option(0.0, unit="deg", help="angle of that mass from the mark", rule=finite())
    arrangement: str = option(
        "DB",
        help="a force on the shaft towards the disc ('DB') or away from it ('DF') preloads a bearing",
        rule=one_of("DB", "DF"),
    )
    sensor_distance: float = option(0.025, unit="m", help="from the tested bearing's centre", rule=at_least(0.0))
    sensor_side: str = option(
        "inside", help="'inside': between bearing and disc; 'outside': towards the shaft's end", rule=one_of("inside", "outside")
    )  # fmt: skip
    speeds_rpm: tuple[float, ...] = option(
        (11_000.0, 13_000.0, 15_000.0), unit="r/min", help="speeds of the study",
        rule=_each(0.0, "a list of speeds greater than 0"),
    )  # fmt: skip
    axial_loads: tuple[float, ...] = option(
        (400.0, 2000.0), unit="N", help="loads of the study",
        rule=_each(0.0, "a list of loads greater than 0"),
    )  # fmt: skip
    signals: Signals = attrs.field(factory=Signals, metadata={"help": "signals of the sensors"})

    def __attrs_post_init__(self) -> None:
        if self.span >= self.shaft_length:
            raise ValueError(
                f"`span` = {self.span:g} m must be less than `shaft_length` = {self.shaft_length:g} m: both bearings sit on it"
            )
        if self.shaft_diameter >= 2.0 * self.disc_radius:
            raise ValueError(
                f"`shaft_diameter` = {self.shaft_diameter:g} m must be less than the disc's, {2.0 * self.disc_radius:g} m"
            )
        if self.hub_diameter is not None and not self.shaft_diameter <= self.hub_diameter <= 2.0 * self.disc_radius:
            raise ValueError(
                f"`hub_diameter` = {self.hub_diameter:g} m must lie between the shaft's, {self.shaft_diameter:g} m, and the disc's, "
                f"{2.0 * self.disc_radius:g} m"
            )
        if self.disc_thickness >= self.span:
            raise ValueError(f"`disc_thickness` = {self.disc_thickness:g} m must be less than `span` = {self.span:g} m")
        if self.unbalance_radius > self.disc_radius:
            raise ValueError(
                f"`unbalance_radius` = {self.unbalance_radius:g} m exceeds the disc radius of {self.disc_radius:g} m"
            )
        self._check_sensor()

    def _check_sensor(self) -> None:
        if self.sensor_side == "outside":
            room = 0.5 * (self.shaft_length - self.span)
            end = "beyond the shaft's end"
        else:
            room = 0.5 * (self.span - self.disc_thickness)
            end = "in the disc or beyond it"
        if self.sensor_distance > room:
            raise ValueError(
                f"`sensor_distance` = {self.sensor_distance:g} m puts the sensor {end}: at most {room:g} m {self.sensor_side} "
                "the tested bearing"
            )

    @property
    def unbalance(self) -> float:
        """m e [kg m]."""
        return self.unbalance_mass * self.unbalance_radius

    @property
    def bearings(self) -> tuple[float, float]:
        """Places of the tested and the other bearing from the left end [m]."""
        return 0.5 * (self.shaft_length - self.span), 0.5 * (self.shaft_length + self.span)

    @property
    def sensor(self) -> float:
        """Place of the sensor from the left end [m]."""
        return self.bearings[0] + (self.sensor_distance if self.sensor_side == "inside" else -self.sensor_distance)

    @property
    def disc_mass(self) -> float:
        """Of the solid disc [kg]; the shaft through it is part of it."""
        return self.density * pi * self.disc_radius**2 * self.disc_thickness

    @property
    def mass(self) -> float:
        """Shaft and disc [kg]."""
        shaft = self.density * pi / 4.0 * self.shaft_diameter**2
        return self.disc_mass + shaft * (self.shaft_length - self.disc_thickness)


_AROUND = (
    "must be one number: a seat that differs around the ring is not axisymmetric. Mesh what it sits in, with "
    "bodies.kind = 'elastic'"
)


@attrs.frozen
class Supports:
    tilt: float | str = option(
        "locked",
        unit="N m/rad",
        help="'free': no restoring moment; a number: tilt stiffness of the shaft",
        rule=word_or(positive(), "locked", "free"),
    )
    axial: str = option(
        "force",
        help="'force': load.axial acts; 'displacement': constant displacement, that of load.axial alone before mounting",
        rule=one_of("force", "displacement"),
    )
    outer_seat: float | str = option(
        "rigid",
        unit="N/m3",
        help="outer cylinder: 'rigid' or stiffness of an elastic foundation",
        rule=word_or(positive(), "rigid"),
        no_list=_AROUND,
    )
    inner_seat: float | str = option(
        "rigid",
        unit="N/m3",
        help="bore: 'rigid' or stiffness of an elastic foundation",
        rule=word_or(positive(), "rigid"),
        no_list=_AROUND,
    )


@attrs.frozen
class Rotor:
    mass: float = option(
        0.0, unit="kg", help="share of the rotor carried by this bearing, without the inner ring", rule=at_least(0.0)
    )
    transverse_inertia: float = option(
        0.0, unit="kg m2", help="about the reference point, without the inner ring", rule=at_least(0.0)
    )
    polar_inertia: float = option(
        0.0, unit="kg m2", help="for gyroscopic moments, without the inner ring", rule=at_least(0.0)
    )
    damping: float = option(0.0, unit="N s/m", help="viscous damping of the translations", rule=at_least(0.0))


@attrs.frozen
class Load:
    axial: float = option(0.0, unit="N", help="positive preloads the bearing", rule=finite())
    radial: tuple[float, float] = option((0.0, 0.0), unit="N", help="along y, z")
    moment: tuple[float, float] = option((0.0, 0.0), unit="N m", help="about y, z")


@attrs.frozen
class Kinematics:
    orbiting: bool = option(False, help="balls travel at cage speed")
    ball_inertia: bool = option(True, help="centrifugal force of the balls at cage speed")
    gyroscopic: str = option(
        "auto",
        help="who carries the balls' gyroscopic moments; 'traction': both races within friction; 'auto': 'traction' where it can be computed",
        rule=one_of("auto", "none", "outer_race", "shared", "traction"),
    )
    spin_speed_rpm: float | None = option(
        None,
        unit="r/min",
        help="default: excitation.speed_rpm, which a run_up changes; 0 in a static scene",
        rule=optional(between(0.0, 1e9)),
    )
    radial_expansion: float = option(0.0, unit="m", help="growth of the inner raceway (fit, temperature)", rule=finite())
    ring_growth: bool | str = option(
        "auto",
        help="centrifugal growth of the inner ring: true free of the shaft, 'with_shaft' together with it, beyond a given fit; 'auto': 'with_shaft'",
        rule=one_of("auto", "with_shaft", True, False),
    )
    ball_growth: bool = option(False, help="adds the centrifugal growth of the balls")


#: Differences [K] from the temperature of mounting, 20 C (reference temperature of ISO 1): none below absolute zero.
_WARMER = between(-293.15, 1e3)


@attrs.frozen
class Mounting:
    inner_temperature: float = option(0.0, unit="K", help="of inner rings and shaft, above 20 °C", rule=_WARMER)
    outer_temperature: float = option(0.0, unit="K", help="of outer rings and housing, above 20 °C", rule=_WARMER)
    ball_temperature: float = option(0.0, unit="K", help="of the balls, above 20 °C", rule=_WARMER)
    shaft_interference: float = option(
        0.0, unit="m", help="shaft less bore, on the diameter, at standstill", rule=at_least(0.0)
    )
    shaft_bore: float = option(0.0, unit="m", help="diameter of the hole in the shaft; 0: solid", rule=at_least(0.0))
    housing_interference: float = option(0.0, unit="m", help="outer ring less housing, on the diameter", rule=at_least(0.0))
    housing_diameter: float | None = option(
        None, unit="m", help="outer diameter of the housing; default: large", rule=optional(length())
    )
    shaft_material: Material | None = option(None, help="a name, or a table as [bearing.rings]; default: the rings'")
    housing_material: Material | None = option(None, help="a name, or a table as [bearing.rings]; default: the rings'")

    @property
    def changes(self) -> dict[str, float]:
        """Temperatures and interferences that are not zero, by key."""
        return {
            key: value
            for key, value in attrs.asdict(self).items()
            if value and not key.endswith(("bore", "diameter", "material"))
        }

    @property
    def fitted(self) -> bool:
        """Whether a ring sits with interference."""
        return self.shaft_interference > 0.0 or self.housing_interference > 0.0


#: Band of a rolling bearing's damping over its stiffness [s]: Kraemer, Dynamics of Rotors and Foundations (1993), as ROSS cites it
#: for ``ross.BallBearingElement``.
TIME_CONSTANTS = (0.25e-5, 2.5e-5)


@attrs.frozen
class Contact:
    kind: str = option("hertz", help="contact law")
    discretisation: str = option(
        "resultant", help="one force per contact, or pressure at points", rule=one_of("resultant", "nodal")
    )
    friction: float = option(0.0, help="Coulomb coefficient", rule=at_least(0.0))
    stick_stiffness: float | None = option(
        None,
        unit="N/m",
        help="of a sticking contact; default: Mindlin's along the major axis, at the ball load under the axial load",
        rule=optional(positive()),
    )
    damping: float | str = option(
        0.0,
        unit="N s/m",
        help="normal, per contact; 'band': both ends of the band of time constants of rolling bearings",
        rule=word_or(at_least(0.0), "band"),
    )
    time_constant: float | None = option(
        None, unit="s", help="tau of a dashpot c = tau k per contact, k its stiffness", rule=optional(positive())
    )
    loss_factor: float | None = option(
        None, help="eta of a dashpot c = eta k / w per contact, w the excitation's frequency", rule=optional(positive())
    )
    law: Any = attrs.field(default=None, metadata={"plugin": "contact_law"})

    def __attrs_post_init__(self) -> None:
        ways = {"damping": self.damping, "time_constant": self.time_constant, "loss_factor": self.loss_factor}
        stated = [f"`{name}`" for name, value in ways.items() if value]
        if len(stated) > 1:
            raise ValueError(
                f"{' and '.join(stated)} exclude each other: each is the damping of the contacts. Give one of them"
            )

    @property
    def dashpot(self) -> float:
        """The same dashpot at every contact [N s/m]; 0 where damping goes with the stiffness."""
        return 0.0 if isinstance(self.damping, str) else self.damping

    @property
    def in_a_band(self) -> bool:
        """Whether both ends of the band of time constants are run."""
        return isinstance(self.damping, str)


@attrs.frozen
class AutoIntegrator:
    """The steady orbit where the force repeats every turn and contacts have no memory, else 'newmark': planning chooses."""

    name: ClassVar[str] = "auto"
    implicit: ClassVar[bool] = True
    inertial: ClassVar[bool] = True
    steady: ClassVar[bool] = False


@attrs.frozen
class Integration:
    kind: str = option(AutoIntegrator.name, help="integrator")
    turns: int = option(12, help="turns of the excitation", rule=between(1, 10_000_000))
    steps_per_turn: int | str = option(
        "auto", help="'auto': 360, or more where an explicit step needs it", rule=word_or(between(8, 100_000_000), "auto")
    )
    start: str = option(
        "orbit",
        help="'orbit': the steady orbit; 'ramp': smoothly growing force; 'static': sudden force",
        rule=one_of("orbit", "ramp", "static"),
    )
    method: Any = attrs.field(default=None, metadata={"plugin": "integrator"})


@attrs.frozen
class Identifying:
    kind: str = option("fft_1x", help="identifier")
    method: Any = attrs.field(default=None, metadata={"plugin": "identifier"})


#: The tables of a scene file, in the order in which people write them.
TABLES: dict[str, type] = {
    "bearing": Bearing,
    "supports": Supports,
    "rotor": Rotor,
    "load": Load,
    "contact": Contact,
    "lubricant": Lubricant,
    "heat": Heat,
    "kinematics": Kinematics,
    "mounting": Mounting,
    "integrator": Integration,
    "identifier": Identifying,
}


#: Tables whose ``kind`` names a plug-in: the plug-in's kind, and the kind where the table names none.
PLUGIN_TABLES = {
    "excitation": ("excitation", None),
    "bodies": ("bodies", "rigid"),
    "mesh": ("mesher", "structured"),
    "contact": ("contact_law", "hertz"),
    "integrator": ("integrator", AutoIntegrator.name),
    "identifier": ("identifier", "fft_1x"),
}


#: Tables that may be absent, which means something.
OPTIONAL_TABLES = ("excitation", "mesh", "lubricant", "heat")


#: Tables whose kinds are swapped most: keys of another kind stay without effect, which ``raceway.scene.unused`` tells.
SWAPPED_TABLES = ("bodies",)


@cache
def _quantities(plugins: tuple[type, ...]) -> type:
    fields = {
        plugin.name: attrs.field(factory=plugin, type=plugin, metadata={"help": (plugin.__doc__ or "").partition("\n")[0]})  # type: ignore[attr-defined]
        for plugin in plugins
    }
    return attrs.make_class("Quantities", fields, frozen=True)


def quantities_table(registry: Registry) -> type:
    """The table [quantities]: a table of options for each plug-in of quantities."""
    entries = registry.all()
    return _quantities(
        tuple(e.plugin for e in entries if e.kind == "quantity" and len(registry.entries[e.kind, e.name]) == 1)
    )


#: Tables that a study reads beside the scene, which keeps them in ``source``.
STUDY_TABLES: dict[str, type] = {"rig": Rig}
