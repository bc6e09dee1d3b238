"""The table [bearing]: dimensions, rows and materials of a rolling bearing, checked."""

from __future__ import annotations

import tomllib
from functools import cache, cached_property, lru_cache
from importlib.resources import files
from math import asin, degrees, pi
from typing import Any, cast

import attrs

from raceway.core.columns import acos, cos, has_columns, radians, sin, some, with_values
from raceway.errors import MeshError, SceneError
from raceway.framework.options import at_least, between, finite, inside, length, nearest, one_of, option, optional, positive
from raceway.framework.rules import Rule, speaking
from raceway.scene.designation import GEOMETRY, RATINGS, arrangement, places_of, signs_of, travel
from raceway.storage.tables import Tables

#: Young's moduli of bearing steels [Pa], 206 to 212 GPa in catalogues with 1 % on either side, and their thermal expansion [1/K].
STEEL, STEEL_EXPANSION = (2.04e11, 2.14e11), 12.5e-6


@attrs.frozen
class Material:
    material: str | None = option(None, help="name in the table of materials; other keys override its numbers")
    young: float = option(212e9, unit="Pa", help="Young's modulus", rule=positive())
    poisson: float = option(0.29, help="Poisson's ratio", rule=inside(-1.0, 0.5))
    density: float = option(7810.0, unit="kg/m3", help="density", rule=positive())
    thermal_expansion: float | None = option(
        None,
        unit="1/K",
        help="linear coefficient; default where `young` is steel's (204 to 214 GPa): 12.5e-6, else required by temperatures",
        rule=at_least(0.0),
    )

    def __attrs_post_init__(self) -> None:
        if self.thermal_expansion is None and STEEL[0] <= self.young <= STEEL[1]:
            object.__setattr__(self, "thermal_expansion", STEEL_EXPANSION)

    def strain(self, path: str, kelvin: float) -> float:
        """Thermal strain; ``path`` of the table, for a ``SceneError`` where it is warm and has no thermal expansion."""
        if some(kelvin) and self.thermal_expansion is None:
            rule = f"is required: {kelvin:g} K act on a body of {1e-9 * self.young:.4g} GPa, which is not steel (204 to 214 GPa)"
            raise SceneError.at(f"{path}.thermal_expansion", None, f"{rule}. Give it, or `material` by its name")
        return kelvin * (0.0 if self.thermal_expansion is None else self.thermal_expansion)


@attrs.frozen
class _NamedMaterial:
    """young [Pa], poisson, density [kg/m3], thermal_expansion [1/K]; title and source."""

    name: str
    title: str
    young: float
    poisson: float
    density: float
    thermal_expansion: float
    source: str


@cache
def materials() -> dict[str, _NamedMaterial]:
    """All by name."""
    return {name: _NamedMaterial(name, **row) for name, row in data_table("materials").items()}


@cache
def data_table(name: str) -> Tables:
    """A file of the folder ``data``, by its name without the ending."""
    return tomllib.loads(files("raceway").joinpath(f"data/{name}.toml").read_text(encoding="utf-8"))


def with_material(table: Tables, path: str, preset: Tables) -> Tables:
    """A table [bearing.rings] or [bearing.balls] with the numbers of its ``material``; own keys override them, the preset's do not.

    SceneError: Unknown name, with the nearest one.
    """
    name = table.get("material")
    if name is None:
        return {**preset, **table}
    if not isinstance(name, str) or name not in materials():
        names = ", ".join(materials())
        raise SceneError.at(f"{path}.material", name, f"no such material{nearest(str(name), materials())}; known: {names}")
    material = attrs.asdict(materials()[name])
    return {**{key: material[key] for key in attrs.fields_dict(Material) if key in material}, **table}


@attrs.frozen
class Bearing:
    ball_diameter: float = option(unit="m", help="D", rule=length())
    pitch_diameter: float = option(unit="m", help="d_m", rule=length())
    ball_count: int = option(help="Z", rule=at_least(1))
    conformity_inner: float = option(help="groove radius / ball diameter, inner", rule=inside(0.5, 1.0))
    conformity_outer: float = option(help="groove radius / ball diameter, outer", rule=inside(0.5, 1.0))
    contact_angle_deg: float | None = option(None, unit="deg", help="free contact angle", rule=between(0.0, 75.0))
    radial_clearance: float | None = option(
        None, unit="m", help="internal radial clearance, on the diameter, as in catalogues", rule=at_least(0.0)
    )
    bore: float | None = option(None, unit="m", help="bore diameter", rule=length())
    outer_diameter: float | None = option(None, unit="m", help="outer diameter", rule=length())
    width: float | None = option(None, unit="m", help="width", rule=length())
    shoulder_height: float | None = option(None, unit="m", help="depth of the grooves; default 0.2 D", rule=length())
    dynamic_rating: float | None = option(
        None, unit="N", help="dynamic load rating C of one row; default: the catalogue's, else ISO 281", rule=positive()
    )
    static_rating: float | None = option(
        None, unit="N", help="static load rating C0 of one row; default: the catalogue's, else ISO 76", rule=positive()
    )
    inner_profile: tuple[tuple[float, float], ...] | None = option(
        None, unit="m", help="section of the inner ring without groove, points [x, radius]; x = 0: plane of the balls"
    )
    outer_profile: tuple[tuple[float, float], ...] | None = option(
        None, unit="m", help="section of the outer ring, likewise"
    )
    first_ball_azimuth_deg: float = option(0.0, unit="deg", help="azimuth of ball 0 from +y towards +z", rule=finite())
    tilt_arm: str = option(
        "groove",
        help="arm of tilts and moments: radius of the inner groove centres, or half the pitch diameter",
        rule=one_of("groove", "pitch"),
    )
    arrangement: str = option(
        "single", help="back to back 'DB', face to face 'DF', in tandem 'DT'; more rows by makers' names", rule=arrangement()
    )
    row: tuple[SetRow, ...] = option((), help="one row: position, direction, preload and keys that differ from [bearing]")
    preload: float = option(
        0.0, unit="N", help="axial preload between opposed rows, before mounting, at standstill", rule=at_least(0.0)
    )
    second_preload: float | None = option(
        None,
        unit="N",
        help="preload of the rows opposite to the first, if different: the difference is an axial load before mounting",
        rule=positive(),
    )
    preload_of: str = option(
        "set",
        help="'set': force between the rows of either direction; 'row': each row was ground flush under it",
        rule=one_of("set", "row"),
    )
    preload_kind: str = option(
        "rigid",
        help="'rigid': constant offset of the rows; 'spring': constant force on the rows opposite to the first, whose outer rings slide together",
        rule=one_of("rigid", "spring"),
    )
    spring_travel: float | None = option(
        None, unit="m", help="travel either way from the rings' unmounted position; default: unlimited", rule=travel()
    )
    row_distance: float | None = option(
        None, unit="m", help="axial distance of neighbouring inner groove centres; default: a bearing's width", rule=length()
    )
    preset: str | None = option(None, help="name in the catalogue; other keys override it")
    maker: str | None = option(
        None, help="whose bearing the preset is: NSK, NTN; default: that of its name, with the spread between makers"
    )
    rings: Material = attrs.field(factory=Material, metadata={"help": "material of both rings"})
    balls: Material = attrs.field(factory=Material, metadata={"help": "material of the balls"})

    def __attrs_post_init__(self) -> None:
        for _, words in speaking(DIMENSIONS, self):
            raise ValueError(words)
        clearance, angle, distance = self.radial_clearance, self.contact_angle_deg, self._centre_distance
        if clearance is not None and angle:
            fitting = 2.0 * distance * (1.0 - cos(radians(angle)))
            if abs(fitting - clearance) > 1e-3 * distance:
                by_clearance = degrees(acos(1.0 - clearance / (2.0 * distance)))
                both = f"`radial_clearance` = {clearance:g} m and `contact_angle_deg` = {angle:g} contradict each other"
                meaning = f"that clearance gives {by_clearance:.3f} deg, that angle {fitting:.4g} m"
                raise ValueError(f"{both}: {meaning}. Give one of them")
        self._check_set()
        for profile, inner in ((self.inner_profile, True), (self.outer_profile, False)):
            if profile is not None:
                from raceway.core.fem.mesh.part_meshes import ring_shape

                try:
                    ring_shape(self, inner)
                except MeshError as why:
                    raise ValueError(str(why)) from None

    @property
    def preloaded(self) -> bool:
        """Whether rows press against each other before mounting."""
        return self.preload > 0.0 or any(row.preload for row in self.row)

    @property
    def other_preload(self) -> float:
        """Preload of the rows that face the other way than the first, that of a spring where they are on one [N]."""
        return self.preload if self.second_preload is None else self.second_preload

    @property
    def signs(self) -> str:
        """'+' or '-' for each row: the way that it faces."""
        signs = signs_of(self.arrangement)
        if not self.row:
            return signs
        row_signs = signs if self.arrangement != "single" else "+" * len(self.row)
        return "".join(row.direction or sign for row, sign in zip(self.row, row_signs, strict=True))

    @cached_property
    def rows(self) -> tuple[tuple[float, float], ...]:
        """(side, axial place [m]) of each row: side +1 is seated by a positive axial motion of the inner ring."""
        word = self.arrangement if self.arrangement != "single" or not self.row else self.signs
        rows = places_of(word, 0.0 if word == "single" else self.row_distance or self.width or 0.0)
        if not self.row:
            return rows
        places = [x if row.position is None else row.position for row, (_, x) in zip(self.row, rows, strict=True)]
        return tuple((1.0 if sign == "+" else -1.0, position) for sign, position in zip(self.signs, places, strict=True))

    @cached_property
    def of_rows(self) -> tuple[Bearing, ...]:
        """The bearing of each row by itself."""
        if has_columns(self):  # has no tables of rows
            plain = {"arrangement": "single", "preload": 0.0, "second_preload": None, "row_distance": None}
            return (with_values(self, **plain),) * len(signs_of(self.arrangement))
        return _of_rows(self)

    @property
    def centred(self) -> bool:
        """Whether axial displacements count from the middle of the axial clearance: one row of deep grooves with a clearance."""
        angle = self.contact_angle_deg
        return (angle is None or not some(angle)) and self.radial_clearance is not None and len(self.rows) == 1

    @property
    def equal_rows(self) -> bool:
        """Whether the rows differ in nothing but places, directions, preloads and azimuths."""
        if not self.row:
            return True
        return len({attrs.evolve(bearing, first_ball_azimuth_deg=0.0) for bearing in self.of_rows}) == 1

    @property
    def balls_in_all(self) -> int:
        """Balls of all rows."""
        return sum(bearing.ball_count for bearing in self.of_rows)

    def of_row(self, row: SetRow | None) -> Bearing:
        """The bearing of one row of a set."""
        geometry = {key: getattr(row, key) for key in GEOMETRY} if row is not None else {}
        geometry = {key: value for key, value in geometry.items() if value is not None}
        if "contact_angle_deg" in geometry:
            geometry["radial_clearance"] = None
        if not {"ball_diameter", "pitch_diameter"}.isdisjoint(geometry):
            # Dimensions of the set's bearing belong to its balls.
            without = ("bore", "outer_diameter", "width", "shoulder_height", "inner_profile", "outer_profile")
            geometry = {**dict.fromkeys((*without, *RATINGS)), **geometry}
        if row is not None and row.preset is not None:
            geometry["preset"] = row.preset
        plain = {"arrangement": "single", "row": (), "preload": 0.0, "second_preload": None, "row_distance": None}
        return attrs.evolve(self, **{**plain, **geometry})

    @property
    def _centre_distance(self) -> float:
        return (self.conformity_inner + self.conformity_outer - 1.0) * self.ball_diameter

    def _check_set(self) -> None:
        """Refuse rows, arrangement and preload that contradict each other."""
        signs = signs_of(self.arrangement)
        if self.row and self.arrangement != "single" and len(self.row) != len(signs):
            raise ValueError(
                f"`row` has {len(self.row)} tables, but arrangement = '{self.arrangement}' is {len(signs)} rows"
            )
        without = [k for k, row in enumerate(self.row) if self.arrangement == "single" and row.direction is None]
        if without:
            raise ValueError(f"`row[{without[0]}]` has no `direction`: give each row '+' or '-', or an `arrangement`")
        with_positions = bool(self.row) and all(row.position is not None for row in self.row)
        if len(self.signs) > 1 and not with_positions and self.row_distance is None and self.width is None:
            reason = f"`arrangement` = '{self.arrangement}' needs `row_distance`, or the bearing's `width`, or a `position` in each row"
            raise ValueError(reason)
        places = [position for _, position in self.rows]
        if len(set(places)) < len(places):
            raise ValueError(f"`row` puts two rows at the same place: {', '.join(f'{position:g}' for position in places)} m")
        for k, row in enumerate(self.row):
            try:
                self.of_row(row)
            except ValueError as why:
                raise ValueError(f"`row[{k}]`: {why}") from None
        ground = next((k for k, row in enumerate(self.row) if row.preload is not None), None)
        if ground is not None and self.preload_of != "row":
            raise ValueError(f"`row[{ground}].preload` says what that row was ground for: set preload_of = 'row'")
        if self.second_preload is not None and self.preload_of == "row":
            raise ValueError("`second_preload` acts between rows: set preload_of = 'set', or give each row its `preload`")
        if not self.preloaded:
            if self.second_preload is not None:
                words = f"`second_preload` = {self.second_preload:g} N needs a `preload`, that of the first row's direction"
                raise ValueError(words)
            return
        if len(set(self.signs)) < 2:
            word = self.signs if self.row else self.arrangement
            rows = f"the {len(self.signs)} rows of '{word}' face" if len(self.signs) > 1 else "a single row faces"
            raise ValueError(
                f"`preload` = {self.preload:g} N needs rows that brace each other, such as arrangement = 'DB', 'DF' or 'TBT': "
                f"{rows} one way only. Give the force of a spring on such a bearing as load.axial"
            )
        if self.preload_of == "row" and self.preload_kind == "spring":
            raise ValueError("`preload_of` = 'row' is an offset that was ground: with preload_kind = 'spring' use 'set'")

    @cached_property
    def contact_angle(self) -> float:
        """Free contact angle [rad]: given, or from the radial clearance."""
        clearance, angle = self.radial_clearance, self.contact_angle_deg
        if clearance is not None and some(clearance) and (angle is None or not some(angle)):
            return acos(1.0 - clearance / (2.0 * self._centre_distance))
        return radians(angle) if angle is not None else 0.0


def _with_geometry(row: type, own: list[attrs.Attribute[Any]]) -> list[attrs.Attribute[Any]]:
    """Its own keys, and those of ``GEOMETRY`` as [bearing] declares them, each of which may be left out."""
    declared = attrs.fields_dict(Bearing)
    row.__annotations__ |= {key: f"{declared[key].type} | None" for key in GEOMETRY}
    rules = {key: optional(cast(Any, declared[key].validator)) for key in GEOMETRY}
    return [*own, *(declared[key].evolve(default=None, validator=rule) for key, rule in rules.items())]


@attrs.frozen(field_transformer=_with_geometry)
class SetRow:
    """One row of a set: where it stands, which way it faces, and what of its bearing differs from the set's."""

    direction: str | None = option(
        None, help="'+': positive axial motion of the inner ring loads it; default: the arrangement's", rule=one_of("+", "-")
    )
    position: float | None = option(
        None, unit="m", help="axial position of its inner groove centres; default: rows `row_distance` apart", rule=finite()
    )
    preload: float | None = option(
        None, unit="N", help="preload of the ground row (preload_of = 'row'); default: bearing.preload", rule=at_least(0.0)
    )
    preset: str | None = option(None, help="name in the catalogue; other keys override it")


#: Dimensions that leave no bearing; ``when`` of a bearing with columns is one of each point.
DIMENSIONS: tuple[Rule[Bearing], ...] = (
    Rule(
        "ball_diameter", lambda b: b.ball_diameter >= b.pitch_diameter,
        lambda b: f"`ball_diameter` = {b.ball_diameter:g} m must be smaller than `pitch_diameter` = {b.pitch_diameter:g} m",
    ),
    Rule(
        "ball_count", lambda b: (b.ball_count > 1) & (sin(pi / b.ball_count) * b.pitch_diameter < b.ball_diameter),
        lambda b: f"`ball_count` = {b.ball_count} balls of {b.ball_diameter:g} m do not fit a pitch circle of {b.pitch_diameter:g} m: "
        f"at most {int(pi / asin(b.ball_diameter / b.pitch_diameter))}",
    ),
    Rule(
        "bore", lambda b: b.bore is not None and b.bore >= b.pitch_diameter - b.ball_diameter,
        lambda b: f"`bore` = {b.bore:g} m cuts the inner raceway: it must be below d_m - D = {b.pitch_diameter - b.ball_diameter:g} m",
    ),
    Rule(
        "outer_diameter", lambda b: b.outer_diameter is not None and b.outer_diameter <= b.pitch_diameter + b.ball_diameter,
        lambda b: f"`outer_diameter` = {b.outer_diameter:g} m cuts the outer raceway: it must exceed d_m + D = {b.pitch_diameter + b.ball_diameter:g} m",
    ),
    Rule(
        "shoulder_height", lambda b: b.shoulder_height is not None and b.shoulder_height >= 0.5 * b.ball_diameter,
        lambda b: f"`shoulder_height` = {b.shoulder_height:g} m must be below half the ball's diameter, {0.5 * b.ball_diameter:g} m: "
        "no groove is deeper than its ball's centre",
    ),
    Rule(
        "radial_clearance", lambda b: b.radial_clearance is not None and b.radial_clearance >= 2.0 * b._centre_distance,
        lambda b: f"`radial_clearance` = {b.radial_clearance:g} m must be below twice the groove-centre distance, {2 * b._centre_distance:g} m",
    ),
)  # fmt: skip


@lru_cache(maxsize=256)
def _of_rows(bearing: Bearing) -> tuple[Bearing, ...]:
    """The bearing of each row by itself; the same one for rows that have no table."""
    if not bearing.row:
        return (bearing.of_row(None),) * len(signs_of(bearing.arrangement))
    return tuple(bearing.of_row(row) for row in bearing.row)
