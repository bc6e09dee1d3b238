"""The scene: what the user said, as a frozen tree of attrs objects, validated, SI.

``raceway.scene.file`` reads it from TOML.  Each class here is one table of the file; a table with ``kind`` holds the
chosen plug-in's own options in its last attribute.
"""

from __future__ import annotations

from functools import cache, lru_cache
from math import acos, asin, cos, degrees, pi, radians, sin
from typing import TYPE_CHECKING, Any

import attrs

from raceway.errors import MeshError
from raceway.framework.options import (
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
)
from raceway.framework.shown import Fact, Shown
from raceway.scene.sets import GEOMETRY, Row, arrangement, check_set, places_of, signs_of, travel
from raceway.storage.tables import ReadTables, Tables

if TYPE_CHECKING:
    import os

    from raceway.scene.given import Given


@attrs.frozen
class Material:
    material: str | None = option(None, help="name in the table of materials; other keys override its numbers")
    young: float = option(212e9, unit="Pa", help="Young's modulus", rule=positive())
    poisson: float = option(0.29, help="Poisson's ratio", rule=inside(-1.0, 0.5))
    density: float = option(7810.0, unit="kg/m3", help="density", rule=positive())
    thermal_expansion: float = option(
        12.5e-6,
        unit="1/K",
        help="linear, where [mounting] gives temperatures; the default is that of bearing steel",
        rule=at_least(0.0),
    )


@attrs.frozen
class Bearing:
    ball_diameter: float = option(unit="m", help="D", rule=length())
    pitch_diameter: float = option(unit="m", help="d_m", rule=length())
    ball_count: int = option(help="Z", rule=at_least(1))
    conformity_inner: float = option(help="groove radius / ball diameter, inner", rule=inside(0.5, 1.0))
    conformity_outer: float = option(help="groove radius / ball diameter, outer", rule=inside(0.5, 1.0))
    contact_angle_deg: float | None = option(None, unit="deg", help="free contact angle", rule=optional(between(0.0, 75.0)))
    radial_clearance: float | None = option(
        None, unit="m", help="internal radial clearance as catalogues give it, on the diameter", rule=optional(at_least(0.0))
    )
    bore: float | None = option(None, unit="m", help="bore diameter", rule=optional(length()))
    outer_diameter: float | None = option(None, unit="m", help="outer diameter", rule=optional(length()))
    width: float | None = option(None, unit="m", help="width", rule=optional(length()))
    shoulder_height: float | None = option(
        None, unit="m", help="depth of the grooves; default 0.2 D, as usual in catalogues", rule=optional(length())
    )
    inner_profile: tuple[tuple[float, float], ...] | None = option(
        None, unit="m", help="section of the inner ring, groove not cut, as points [x, radius]; x = 0 in the balls' plane"
    )
    outer_profile: tuple[tuple[float, float], ...] | None = option(
        None, unit="m", help="section of the outer ring, groove not cut, as points [x, radius]; x = 0 in the balls' plane"
    )
    first_ball_azimuth_deg: float = option(0.0, unit="deg", help="azimuth of ball 0 from +y towards +z", rule=finite())
    tilt_arm: str = option(
        "groove",
        help="arm of tilts and moments: 'groove' (radius of the inner groove centres) or 'pitch' (half the pitch diameter)",
        rule=one_of("groove", "pitch"),
    )
    arrangement: str = option(
        "single",
        help="'single' row, or a set: a pair back to back 'DB', face to face 'DF', in tandem 'DT'; more rows by their makers' names",
        rule=arrangement(),
    )
    row: tuple[Row, ...] = option(
        (),
        help="rows one by one, in tables [[bearing.row]]: places, directions, preloads, and what differs from this bearing",
    )
    preload: float = option(
        0.0,
        unit="N",
        help="axial preload of rows that brace each other, mounted: at standstill, before anything grows",
        rule=at_least(0.0),
    )
    second_preload: float | None = option(
        None,
        unit="N",
        help="of the rows that face the other way than the first, where it is another force: mounted under the difference as an axial load",
        rule=optional(positive()),
    )
    preload_of: str = option(
        "set",
        help="'set': the force between the rows of either direction; 'row': each row was ground flush under it, as makers do",
        rule=one_of("set", "row"),
    )
    preload_kind: str = option(
        "rigid",
        help="'rigid': the rows' offset stays as mounted; 'spring': the force on the rows that face the other way than the first "
        "stays, their outer rings slide together",
        rule=one_of("rigid", "spring"),
    )
    spring_travel: float | None = option(
        None,
        unit="m",
        help="by which those rings can slide against the spring from where they were mounted, either way; default: any",
        rule=optional(travel()),
    )
    row_distance: float | None = option(
        None,
        unit="m",
        help="axial distance of neighbouring rows, between the planes of their inner groove centres; default: the width of one bearing",
        rule=optional(length()),
    )
    preset: str | None = option(None, help="name in the catalogue; other keys override it")
    rings: Material = attrs.field(factory=Material, metadata={"help": "material of both rings"})
    balls: Material = attrs.field(factory=Material, metadata={"help": "material of the balls"})

    def __attrs_post_init__(self) -> None:
        d, dm = self.ball_diameter, self.pitch_diameter
        if d >= dm:
            raise ValueError(f"`ball_diameter` = {d:g} m must be smaller than `pitch_diameter` = {dm:g} m")
        if self.ball_count > 1 and sin(pi / self.ball_count) * dm < d:
            most = int(pi / asin(d / dm))
            raise ValueError(
                f"`ball_count` = {self.ball_count} balls of {d:g} m do not fit a pitch circle of {dm:g} m: at most {most}"
            )
        if self.bore is not None and self.bore >= dm - d:
            raise ValueError(f"`bore` = {self.bore:g} m cuts the inner raceway: it must be below d_m - D = {dm - d:g} m")
        if self.outer_diameter is not None and self.outer_diameter <= dm + d:
            raise ValueError(
                f"`outer_diameter` = {self.outer_diameter:g} m cuts the outer raceway: it must exceed d_m + D = {dm + d:g} m"
            )
        if self.shoulder_height is not None and self.shoulder_height >= 0.5 * d:
            raise ValueError(
                f"`shoulder_height` = {self.shoulder_height:g} m must be below half the ball's diameter, {0.5 * d:g} m: "
                "no groove is deeper than its ball's centre"
            )
        self._check_clearance()
        check_set(self)
        self._check_profiles()

    def _check_profiles(self) -> None:
        for profile, inner in ((self.inner_profile, True), (self.outer_profile, False)):
            if profile is not None:
                from raceway.core.mesh.ring_shape import ring_shape

                try:
                    ring_shape(self, inner)
                except MeshError as why:
                    raise ValueError(str(why)) from None

    @property
    def preloaded(self) -> bool:
        """Whether rows press against each other as mounted."""
        return self.preload > 0.0 or any(row.preload for row in self.row)

    @property
    def signs(self) -> str:
        """'+' or '-' for each row: the way that it faces."""
        signs = signs_of(self.arrangement)
        if not self.row:
            return signs
        own = signs if self.arrangement != "single" else "+" * len(self.row)
        return "".join(row.direction or sign for row, sign in zip(self.row, own, strict=True))

    @property
    def rows(self) -> tuple[tuple[float, float], ...]:
        """(side, axial place [m]) of each row: side +1 is seated by a positive axial motion of the inner ring."""
        word = self.arrangement if self.arrangement != "single" or not self.row else self.signs
        rows = places_of(word, self.row_distance or self.width or 0.0)
        if not self.row:
            return rows
        places = [place if row.position is None else row.position for row, (_, place) in zip(self.row, rows, strict=True)]
        return tuple((1.0 if sign == "+" else -1.0, place) for sign, place in zip(self.signs, places, strict=True))

    @property
    def of_rows(self) -> tuple[Bearing, ...]:
        """The bearing of each row by itself."""
        return _of_rows(self)

    @property
    def equal_rows(self) -> bool:
        """Whether the rows differ in nothing but places, directions, preloads and azimuths."""
        if not self.row:
            return True
        alike = {attrs.evolve(one, first_ball_azimuth_deg=0.0) for one in self.of_rows}
        return len(alike) == 1

    @property
    def balls_in_all(self) -> int:
        """Balls of all rows."""
        return sum(one.ball_count for one in self.of_rows)

    def of_row(self, row: Row | None) -> Bearing:
        """The bearing of one row of a set."""
        given = {key: getattr(row, key) for key in GEOMETRY} if row is not None else {}
        given = {key: value for key, value in given.items() if value is not None}
        if "contact_angle_deg" in given:
            given["radial_clearance"] = None
        if not {"ball_diameter", "pitch_diameter"}.isdisjoint(given):
            # Dimensions of the set's bearing belong to its balls.
            lost = ("bore", "outer_diameter", "width", "shoulder_height", "inner_profile", "outer_profile")
            given = {**dict.fromkeys(lost), **given}
        plain = {"arrangement": "single", "row": (), "preload": 0.0, "second_preload": None, "row_distance": None}
        return attrs.evolve(self, **{**plain, **given})

    def _check_clearance(self) -> None:
        clearance, angle = self.radial_clearance, self.contact_angle_deg
        distance = (self.conformity_inner + self.conformity_outer - 1.0) * self.ball_diameter
        if clearance is None:
            return
        if clearance >= 2.0 * distance:
            raise ValueError(
                f"`radial_clearance` = {clearance:g} m must be below twice the groove-centre distance, {2 * distance:g} m"
            )
        if not angle:
            return
        fitting = 2.0 * distance * (1.0 - cos(radians(angle)))
        if abs(fitting - clearance) > 1e-3 * distance:
            own = degrees(acos(1.0 - clearance / (2.0 * distance)))
            raise ValueError(
                f"`radial_clearance` = {clearance:g} m and `contact_angle_deg` = {angle:g} contradict each other: that "
                f"clearance gives {own:.3f} deg, that angle {fitting:.4g} m. Give one of them"
            )

    @property
    def contact_angle(self) -> float:
        """Free contact angle [rad]: given, or from the radial clearance."""
        if self.radial_clearance and not self.contact_angle_deg:
            distance = (self.conformity_inner + self.conformity_outer - 1.0) * self.ball_diameter
            return acos(1.0 - self.radial_clearance / (2.0 * distance))
        return radians(self.contact_angle_deg or 0.0)


@lru_cache(maxsize=256)
def _of_rows(bearing: Bearing) -> tuple[Bearing, ...]:
    """The bearing of each row by itself; the same one for rows that have no table."""
    if not bearing.row:
        return (bearing.of_row(None),) * len(signs_of(bearing.arrangement))
    return tuple(bearing.of_row(row) for row in bearing.row)


_AROUND = (
    "must be one number: a seat that differs around the ring is not axisymmetric. Mesh what it sits in, with "
    "bodies.kind = 'elastic'"
)


@attrs.frozen
class Supports:
    tilt: float | str = option(
        "locked",
        unit="N m/rad",
        help="'locked', 'free' (massless shaft), or the shaft's stiffness against tilts",
        rule=word_or(positive(), "locked", "free"),
    )
    axial: str = option(
        "force",
        help="'force': load.axial acts; 'displacement': what load.axial alone gives, mounted, is held",
        rule=one_of("force", "displacement"),
    )
    outer_seat: float | str = option(
        "rigid",
        unit="N/m3",
        help="outer cylinder: 'rigid' or the bed's stiffness",
        rule=word_or(positive(), "rigid"),
        no_list=_AROUND,
    )
    inner_seat: float | str = option(
        "rigid", unit="N/m3", help="bore: 'rigid' or the bed's stiffness", rule=word_or(positive(), "rigid"), no_list=_AROUND
    )


@attrs.frozen
class Rotor:
    mass: float = option(0.0, unit="kg", help="carried by this bearing, added to the inner ring's own", rule=at_least(0.0))
    transverse_inertia: float = option(
        0.0, unit="kg m2", help="about the reference point, added to the ring's own", rule=at_least(0.0)
    )
    polar_inertia: float = option(
        0.0, unit="kg m2", help="gyroscopic moments on the tilts, beside those of the inner ring", rule=at_least(0.0)
    )
    damping: float = option(0.0, unit="N s/m", help="viscous, on the translations", rule=at_least(0.0))


@attrs.frozen
class Load:
    axial: float = option(0.0, unit="N", help="positive seats the bearing", rule=finite())
    radial: tuple[float, float] = option((0.0, 0.0), unit="N", help="along y, z")
    moment: tuple[float, float] = option((0.0, 0.0), unit="N m", help="about y, z")


@attrs.frozen
class Kinematics:
    orbiting: bool = option(False, help="balls travel at cage speed")
    ball_inertia: bool = option(True, help="centrifugal force of the balls at cage speed")
    gyroscopic: str = option(
        "none", help="gyroscopic moment of the balls: the hypothesis", rule=one_of("none", "outer_race", "shared")
    )
    spin_speed_rpm: float | None = option(
        None,
        unit="r/min",
        help="default: excitation.speed_rpm, which a run_up changes; 0 in a static scene",
        rule=optional(between(0.0, 1e9)),
    )
    radial_expansion: float = option(0.0, unit="m", help="growth of the inner raceway (fit, temperature)", rule=finite())
    ring_growth: bool = option(False, help="adds the centrifugal growth of the inner ring")
    ball_growth: bool = option(False, help="adds the centrifugal growth of the balls")


@attrs.frozen
class Mounting:
    inner_temperature: float = option(0.0, unit="K", help="of inner rings and shaft above that of mounting", rule=finite())
    outer_temperature: float = option(0.0, unit="K", help="of outer rings and housing above that of mounting", rule=finite())
    ball_temperature: float = option(0.0, unit="K", help="of the balls above that of mounting", rule=finite())
    shaft_interference: float = option(
        0.0, unit="m", help="by which the shaft is larger than the bore, on the diameter, at standstill", rule=at_least(0.0)
    )
    shaft_bore: float = option(0.0, unit="m", help="diameter of the hole in the shaft; 0: solid", rule=at_least(0.0))
    housing_interference: float = option(
        0.0, unit="m", help="by which the housing is smaller than the outer ring, on the diameter", rule=at_least(0.0)
    )
    housing_diameter: float | None = option(
        None, unit="m", help="outer diameter of the housing; default: much larger than the bearing", rule=optional(length())
    )

    @property
    def changes(self) -> dict[str, float]:
        """Temperatures and interferences that are not zero, by key."""
        return {
            name: value for name, value in attrs.asdict(self).items() if value and not name.endswith(("_bore", "_diameter"))
        }


#: Band of a rolling bearing's damping over its stiffness [s]: Kraemer, Dynamics of Rotors and Foundations (1993), as ROSS cites it
#: for ``ross.BallBearingElement``.
TIME_CONSTANTS = (0.25e-5, 2.5e-5)


@attrs.frozen
class Contact:
    kind: str = option("hertz", help="contact law")
    discretisation: str = option(
        "resultant", help="one force a ball-race pair, or pressure at points", rule=one_of("resultant", "nodal")
    )
    friction: float = option(0.0, help="Coulomb coefficient", rule=at_least(0.0))
    stick_stiffness: float | None = option(
        None,
        unit="N/m",
        help="of a sticking contact; default: of the contact ellipse along its major axis (Mindlin), at the ball load under the axial load",
        rule=optional(positive()),
    )
    damping: float | str = option(
        0.0,
        unit="N s/m",
        help="normal, each contact; 'band': runs both ends of the band of time constants of rolling bearings",
        rule=word_or(at_least(0.0), "band"),
    )
    time_constant: float | None = option(
        None, unit="s", help="tau of a dashpot c = tau k at each contact, k its stiffness", rule=optional(positive())
    )
    loss_factor: float | None = option(
        None, help="eta of a dashpot c = eta k / w at each contact, w the excitation's frequency", rule=optional(positive())
    )
    law: Any = attrs.field(default=None, metadata={"plugin": "contact_law"})

    def __attrs_post_init__(self) -> None:
        ways = {"damping": self.damping, "time_constant": self.time_constant, "loss_factor": self.loss_factor}
        given = [f"`{name}`" for name, value in ways.items() if value]
        if len(given) > 1:
            raise ValueError(
                f"{' and '.join(given)} exclude each other: each is the damping of the contacts. Give one of them"
            )

    @property
    def dashpot(self) -> float:
        """The same dashpot at every contact [N s/m]; 0 where damping goes with the stiffness."""
        return self.damping if isinstance(self.damping, float) else 0.0

    @property
    def in_a_band(self) -> bool:
        """Whether both ends of the band of time constants are run."""
        return self.damping == "band"


@attrs.frozen
class Integration:
    kind: str = option("newmark", help="integrator")
    turns: int = option(12, help="turns of the excitation", rule=between(1, 10_000_000))
    steps_per_turn: int | str = option(
        "auto", help="'auto': 360, or more where an explicit step needs it", rule=word_or(between(8, 100_000_000), "auto")
    )
    start: str = option(
        "orbit",
        help="'orbit': on the steady orbit; 'ramp': the force grows smoothly; 'static': a sudden load",
        rule=one_of("orbit", "ramp", "static"),
    )
    method: Any = attrs.field(default=None, metadata={"plugin": "integrator"})


@attrs.frozen
class Identifying:
    kind: str = option("fft_1x", help="identifier")
    method: Any = attrs.field(default=None, metadata={"plugin": "identifier"})


@attrs.frozen(repr=False)
class Scene(Shown):
    """One scene: what is computed, in SI units, every key checked.

    Attributes
    ----------
    title : str, says in its second line what was changed since it was read
    bearing, supports, rotor, load, contact, kinematics, mounting, integrator, identifier : tables of the scene file
    excitation, bodies, mesh : plug-ins with their options; excitation and mesh may be None
    source : the tree of plain tables it was made from, presets resolved
    given : what the user said, presets not resolved, from which ``with_`` goes on

    Examples
    --------
    >>> import raceway as rw
    >>> scene = rw.Scene.from_dict({"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}})
    >>> scene.load.axial  # [N]
    1000.0
    >>> scene
    untitled
      bearing  preset = B7206C
      load     axial = 1000
    """

    title: str
    bearing: Bearing
    supports: Supports
    rotor: Rotor
    load: Load
    excitation: Any
    bodies: Any
    mesh: Any
    contact: Contact
    kinematics: Kinematics
    mounting: Mounting
    integrator: Integration
    identifier: Identifying
    source: Tables = attrs.field(repr=False, eq=False)
    given: Given | None = attrs.field(default=None, repr=False, eq=False)

    @classmethod
    def from_toml(cls, source: str | os.PathLike[str]) -> Scene:
        """Read a scene from a TOML file, or from TOML text.

        Parameters
        ----------
        source : path of a file (str or Path), or the text itself

        Raises
        ------
        SceneError
            With every mistake that was found.

        Examples
        --------
        >>> import raceway as rw
        >>> rw.Scene.from_toml('bearing.preset = "B7206C"').bearing.ball_count
        12
        """
        from raceway.scene.given import as_scene

        return as_scene(source)

    @classmethod
    def from_dict(cls, tables: ReadTables) -> Scene:
        """Read a scene from a dict of tables, as a TOML file would give them.

        Raises
        ------
        SceneError
            With every mistake that was found.

        Examples
        --------
        >>> import raceway as rw
        >>> rw.Scene.from_dict({"bearing": {"preset": "B7206C"}, "supports": {"tilt": "free"}}).supports.tilt
        'free'
        """
        from raceway.scene.given import as_scene

        return as_scene(tables)

    def with_(self, **tables: Any) -> Scene:
        """This scene with some keys changed; the plug-ins of this process are known.

        Parameters
        ----------
        tables : by name, each a dict that is merged into the table; None takes a table or key out

        Raises
        ------
        SceneError
            With every mistake that was found.

        Examples
        --------
        >>> import raceway as rw
        >>> scene = rw.Scene.from_dict({"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}})
        >>> scene.with_(load={"axial": 400.0}, supports={"tilt": "free"}).load.axial
        400.0
        """
        from raceway.scene.given import as_scene

        return as_scene(self, tables)

    @property
    def spin_speed(self) -> float:
        """Speed of the inner ring [rad/s]."""
        rpm = self.kinematics.spin_speed_rpm
        if rpm is None:
            rpm = getattr(self.excitation, "speed_rpm", 0.0) if self.excitation is not None else 0.0
        return rpm * pi / 30.0

    @property
    def time_constant(self) -> float:
        """Of the contacts' dashpots c = tau k [s]; 0 where there are none of this kind, of a band the low end."""
        contact = self.contact
        if contact.in_a_band:
            return TIME_CONSTANTS[0]
        if contact.loss_factor is not None and self.excitation is not None:
            return contact.loss_factor / (2.0 * pi * float(self.excitation.frequency_hz))
        return contact.time_constant or 0.0

    @property
    def spin_changes(self) -> bool:
        """Whether the spin speed is that of an excitation that changes its speed, and changes with it."""
        excitation = self.excitation
        changing = excitation is not None and excitation.period_s is None and hasattr(excitation, "phase")
        return changing and self.kinematics.spin_speed_rpm is None and self.spin_speed > 0.0

    def _shown(self) -> tuple[str, list[Fact]]:
        """What was said, a table a row; defaults and a preset's numbers are left out."""
        from raceway.scene.file import told
        from raceway.scene.given import as_given, leaves

        rows: list[Fact] = []
        for name, table in as_given(self).merged().items():
            if isinstance(table, dict):
                said = [f"{key} = {told(value)}" for key, value in leaves(table)]
                rows.append((name, "", ", ".join(said) or "defaults"))
        return self.title, rows

    def to_dict(self) -> Tables:
        """Every key of the scene file with its value, defaults too; loads again as the same scene."""
        tables: Tables = {"title": self.title}
        for name in TABLES:
            part = getattr(self, name)
            if part is not None:
                tables[name] = _plain(part)
        for name in ("bodies", "excitation", "mesh"):
            plugin = getattr(self, name)
            if plugin is not None:
                tables[name] = {"kind": plugin.name, **_plain(plugin)}
        return tables


#: The tables of a scene file, in the order in which people write them.
TABLES: dict[str, type] = {
    "bearing": Bearing,
    "supports": Supports,
    "rotor": Rotor,
    "load": Load,
    "contact": Contact,
    "kinematics": Kinematics,
    "mounting": Mounting,
    "integrator": Integration,
    "identifier": Identifying,
}


def _plain(part: attrs.AttrsInstance) -> Tables:
    out: Tables = {}
    cls: type = type(part)
    for name, plugin in _keys(cls):
        value = getattr(part, name)
        if plugin:
            out.update(_plain(value))
        elif isinstance(value, float | str):
            out[name] = value
        elif attrs.has(type(value)):
            out[name] = _plain(value)
        elif value is not None and value != ():
            out[name] = _lists(value)
    return out


@cache
def _keys(cls: type) -> tuple[tuple[str, bool], ...]:
    """Names of a table's keys, and whether it is the slot of a plug-in."""
    return tuple((field.name, "plugin" in field.metadata) for field in attrs.fields(cls))


def _lists(value: Any) -> object:
    if isinstance(value, tuple):
        return [_lists(part) for part in value]
    return _plain(value) if attrs.has(type(value)) else value
