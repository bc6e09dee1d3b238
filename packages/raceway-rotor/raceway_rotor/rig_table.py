"""The table [rig] of a scene: a shaft on two equal bearings, its disc, sensors and their signals."""

from math import pi

import attrs

from raceway import Mistake, Scene, SceneError, at_least, between, finite, inside, one_of, option, positive, worded
from raceway.extend import Rule, structure


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

    The tested bearing is the left one; the shaft's axis runs from the left end to the right one.
    """

    shaft_length: float = option(0.426, unit="m", help="end to end", rule=positive())
    shaft_diameter: float = option(0.030, unit="m", help="diameter of the shaft", rule=positive())
    span: float = option(0.175, unit="m", help="distance of the bearings' centres", rule=positive())
    disc_radius: float = option(0.090, unit="m", help="radius of the disc", rule=positive())
    disc_thickness: float = option(0.020, unit="m", help="width of the disc", rule=positive())
    hub_diameter: float | None = option(
        None, unit="m", help="bending diameter within the disc; default: the shaft's", rule=positive()
    )
    young: float = option(212e9, unit="Pa", help="Young's modulus of the shaft", rule=positive())
    poisson: float = option(0.29, help="Poisson's ratio of the shaft", rule=inside(-1.0, 0.5))
    density: float = option(7810.0, unit="kg/m3", help="of shaft and disc", rule=positive())
    unbalance_mass: float = option(7.1e-3, unit="kg", help="added to the disc", rule=positive())
    unbalance_radius: float = option(0.090, unit="m", help="distance of that mass from the axis", rule=positive())
    unbalance_angle_deg: float = option(0.0, unit="deg", help="angle of that mass from the mark", rule=finite())
    arrangement: str = option(
        "DB", help="a force on the shaft to the disc ('DB') or from it ('DF') preloads a bearing", rule=one_of("DB", "DF")
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
                f"`unbalance_radius` = {self.unbalance_radius:g} m exceeds the disc radius, {self.disc_radius:g} m"
            )
        if self.sensor_side == "outside":
            room = 0.5 * (self.shaft_length - self.span)
            end = "beyond the shaft's end"
        else:
            room = 0.5 * (self.span - self.disc_thickness)
            end = "in the disc or beyond it"
        if self.sensor_distance > room:
            remedy = f"at most {room:g} m {self.sensor_side} the tested bearing"
            raise ValueError(f"`sensor_distance` = {self.sensor_distance:g} m puts the sensor {end}: {remedy}")

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


def rig_of(scene: Scene) -> Rig:
    """The table ``[rig]`` of a scene; SceneError where there is none."""
    if "rig" not in scene.source:
        raise SceneError.at("rig", None, "is required: a table [rig] with shaft, disc and sensor (examples/test_rig.toml)")
    mistakes: list[Mistake] = []
    rig = structure(scene.source["rig"], Rig, "rig", mistakes)
    if rig is None:
        raise SceneError(mistakes)
    return rig
