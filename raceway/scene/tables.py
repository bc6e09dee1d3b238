"""The other tables of a scene file as frozen attrs classes, SI; a table with ``kind`` holds the chosen plug-in's own options in
its last attribute."""

import json
from functools import cache
from typing import Any, ClassVar

import attrs

from raceway.framework.loading.registry import Registry
from raceway.framework.options import at_least, between, finite, inside, length, one_of, option, positive, word_or
from raceway.scene.bearing import Bearing, Material
from raceway.scene.lubricant import Lubricant
from raceway.storage.tables import Tables

_AROUND = "must be one number: a seat that differs around the ring is not axisymmetric. Mesh what it sits in, with bodies.kind = 'elastic'"


def _seat(of: str) -> float | str:
    text, rule = f"{of}: 'rigid' or stiffness of an elastic foundation", word_or(positive(), "rigid")
    return option("rigid", unit="N/m3", help=text, rule=rule, no_list=_AROUND)


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
    outer_seat: float | str = _seat("outer cylinder")
    inner_seat: float | str = _seat("bore")


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
        None, unit="r/min", help="default: excitation.speed_rpm, which run_up changes; 0 if static", rule=between(0.0, 1e9)
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
        None, unit="m", help="outer diameter of the housing; default: large", rule=length()
    )
    shaft_material: Material | None = option(None, help="a name, or a table as [bearing.rings]; default: the rings'")
    housing_material: Material | None = option(None, help="a name, or a table as [bearing.rings]; default: the rings'")

    @property
    def changes(self) -> dict[str, float]:
        """Temperatures and interferences that are not zero, by key."""
        return {k: v for k, v in attrs.asdict(self).items() if v and not k.endswith(("bore", "diameter", "material"))}

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
        rule=positive(),
    )
    damping: float | str = option(
        0.0,
        unit="N s/m",
        help="normal, per contact; 'band': both ends of the band of time constants of rolling bearings",
        rule=word_or(at_least(0.0), "band"),
    )
    time_constant: float | None = option(
        None, unit="s", help="tau of a dashpot c = tau k per contact, k its stiffness", rule=positive()
    )
    loss_factor: float | None = option(
        None, help="eta of a dashpot c = eta k / w per contact, w the excitation's frequency", rule=positive()
    )
    law: Any = attrs.field(default=None, metadata={"plugin": "contact_law"})

    def __attrs_post_init__(self) -> None:
        ways = {"damping": self.damping, "time_constant": self.time_constant, "loss_factor": self.loss_factor}
        names = [f"`{name}`" for name, value in ways.items() if value]
        if len(names) > 1:
            raise ValueError(f"{' and '.join(names)} exclude each other, each a damping of the contacts: give one")

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

    STEADY: ClassVar[str] = "periodic"
    TRANSIENT: ClassVar[str] = "newmark"
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


#: Conductance [W/K] beyond which it is 'infinite': differences of temperatures, known to 1e-13 K, no longer give the heat to 1e-8 W.
_INFINITE = 1e5


def _conductance(between_words: str, *words: str) -> float | str:
    rule = word_or(inside(1e-12, _INFINITE), "auto", *words)
    return option("auto", unit="W/K", help=f"conductance between {between_words}", rule=rule)


def _to_ambient(node: str) -> float | str:
    return _conductance(f"{node} and ambient; 'auto': by ISO 15312")


@attrs.frozen
class Heat:
    """Temperatures of rings, balls and oil are computed from the heat of friction; conductances are those of all rows together.

    Conductances that are 'auto' follow from correlations (``raceway.core.quantities.thermal``), those to the ambient from ISO 15312.
    """

    oil_inlet_c: float = option(unit="°C", help="temperature of the supplied oil", rule=between(-273.15, 1e3))
    oil_flow: float | str = option(
        unit="m3/s", help="oil through all rows; 'infinite': one temperature", rule=word_or(inside(1e-18, 1.0), "infinite")
    )
    ambient_c: float = option(20.0, unit="°C", help="temperature around shaft and housing", rule=between(-150.0, 1e3))
    oil_heat_capacity: float = option(2000.0, unit="J/kg/K", help="of the oil; usually 1900 to 2300", rule=between(1.0, 1e5))
    inner_wetting: float | str = option(
        "auto",
        help="wetted share of the inner rings, a factor of inner_oil 'auto'; 'auto': 1 - Z D / (pi d_m), the gaps between the balls; under-race lubrication: 1",
        rule=word_or(between(1e-3, 1.0), "auto"),
    )
    inner_balls: float | str = _conductance("inner rings and balls", "infinite")
    outer_balls: float | str = _conductance("outer rings and balls", "infinite")
    inner_oil: float | str = _conductance("inner rings and oil", "infinite")
    balls_oil: float | str = _conductance("balls and oil", "infinite")
    outer_oil: float | str = _conductance("outer rings and oil", "infinite")
    inner_shaft: float | str = _conductance("inner rings and shaft", "infinite")
    outer_housing: float | str = _conductance("outer rings and housing", "infinite")
    shaft_ambient: float | str = _to_ambient("shaft")
    housing_ambient: float | str = _to_ambient("housing")
    conductance_band: float = option(
        0.5, help="r: 'auto' conductances are uncertain by factors 1/(1 + r) to 1 + r", rule=between(0.0, 100.0)
    )


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
    entries = registry.of_kind("quantity")
    return _quantities(tuple(e.plugin for e in entries if len(registry.entries[e.kind, e.name]) == 1))


def told(value: object) -> str:
    """A value as it stands in a scene file, words without quotes; 400.0 is 400."""
    if value is None:
        return "none"
    if isinstance(value, str):
        return value
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        value = int(value)
    return json.dumps(value, default=str)


@attrs.frozen(repr=False)
class SceneTables:
    """Tables of a scene file, and plug-ins with their options; excitation, mesh, lubricant and heat may be None.

    source : the tree of plain tables they were made from, presets resolved
    """

    bearing: Bearing
    supports: Supports
    rotor: Rotor
    load: Load
    excitation: Any
    bodies: Any
    mesh: Any
    contact: Contact
    lubricant: Lubricant | None
    heat: Heat | None
    kinematics: Kinematics
    mounting: Mounting
    integrator: Integration
    identifier: Identifying
    quantities: Any
    source: Tables = attrs.field(repr=False, eq=False)


def plain_table(part: attrs.AttrsInstance) -> Tables:
    """Keys and values of a table of a scene, those of its plug-in among them."""
    out: Tables = {}
    cls: type = type(part)
    for name, plugin in _keys(cls):
        value = getattr(part, name)
        if plugin:
            out.update(plain_table(value))
        elif isinstance(value, float | str):
            out[name] = value
        elif attrs.has(type(value)):
            out[name] = plain_table(value)
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
    return plain_table(value) if attrs.has(type(value)) else value
