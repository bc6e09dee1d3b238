"""Keys that a user wrote and that change nothing in this scene, each with the reason."""

from collections.abc import Collection
from contextlib import suppress

import attrs

from raceway.errors import RacewayError
from raceway.framework.duties import speed_rpm, unused_with_bodies
from raceway.framework.loading.registry import Registry
from raceway.framework.options import unused_options
from raceway.framework.rules import Rule, speaking
from raceway.scene.reading import read_tables
from raceway.scene.tables import SceneTables
from raceway.storage.tables import ReadTables, Tables


def unused(scene: SceneTables) -> tuple[str, ...]:
    """A sentence for each key that is given and has no effect."""
    return tuple(f"`{path}` has no effect: {why}" for path, why in _idle(scene))


def without_inherited(base: ReadTables, tables: ReadTables, changed_keys: Collection[str], registry: Registry) -> Tables:
    """Changed tables without the keys of the base that lose their effect by the change: nobody said those for this scene.

    base : tables of a file;  changed : the same with some keys changed;  changed_keys : those keys, which stay and are reported

    A key that has no effect in the base either is the base's own mistake, and stays.  Tables that make no scene are left as
    they are: what reads them says what is wrong.
    """
    result = dict(tables)
    try:
        idle = {path for path, _ in _idle(read_tables(tables, registry)[2])} - set(changed_keys)
    except RacewayError:
        return result
    idle = {path for path in idle if not any(path.startswith(f"{key}.") for key in changed_keys)}
    if idle:
        with suppress(RacewayError):  # a base that is complete with the changes only has no mistakes of its own to tell of
            idle -= {path for path, _ in _idle(read_tables(base, registry)[2])}
    for path in idle:
        name, _, key = path.partition(".")
        if isinstance(result.get(name), dict):
            result[name] = {word: value for word, value in result[name].items() if word != key}
    return result


def _idle(scene: SceneTables) -> list[tuple[str, str]]:
    """Path and reason: of the plug-ins by their own word, of the core by ``_RULES``."""
    plugins = {
        "bodies": scene.bodies,
        "contact": scene.contact.law,
        "integrator": scene.integrator.method,
        "identifier": scene.identifier.method,
        "excitation": scene.excitation,
    }
    given_keys = {f"{table}.{key}" for table, keys in scene.source.items() if isinstance(keys, dict) for key in keys}
    options = {"kind", *(field.name for field in attrs.fields(type(scene.bodies)))}
    why_foreign, of_bodies = f"bodies.kind is '{scene.bodies.name}'", scene.source.get("bodies", {})
    foreign = [(f"bodies.{key}", why_foreign) for key in of_bodies if key not in options]
    unused = {table: unused_options(plugin) for table, plugin in plugins.items()}
    by_plugins = [(f"{table}.{option}", why) for table, whys in unused.items() for option, why in whys.items()]
    core = [*speaking(_RULES, scene), *unused_with_bodies(scene)]
    return [*by_plugins, *((key, why) for key, why in core if key in given_keys), *foreign]


def _has_record(s: SceneTables) -> bool:
    return s.excitation is not None and "record" in s.identifier.method.needs


def _solves_steady(s: SceneTables) -> bool:
    return _has_record(s) and s.integrator.method.steady


def _slow(s: SceneTables) -> bool:
    """Whether the motion is a series of equilibria."""
    return _has_record(s) and not s.integrator.method.inertial


def _turns(s: SceneTables) -> bool:
    """Whether the inner ring has a speed."""
    rpm = s.kinematics.spin_speed_rpm
    return bool(speed_rpm(s.excitation) if rpm is None else rpm)


_INTEGRATION = ("integrator.turns", "integrator.steps_per_turn", "integrator.start")
_DASHPOTS = ("contact.damping", "contact.time_constant", "contact.loss_factor")
_ROTOR = ("rotor.mass", "rotor.transverse_inertia", "rotor.polar_inertia", "rotor.damping")

#: Keys of the core, when they change nothing, and why.
_RULES: tuple[Rule[SceneTables], ...] = (
    Rule(_INTEGRATION, lambda s: s.excitation is None, "the scene has no [excitation]"),
    Rule(
        _INTEGRATION, lambda s: s.excitation is not None and not _has_record(s),
        lambda s: f"identifier '{s.identifier.kind}' needs no recorded motion",
    ),
    Rule(
        ("integrator.start", "excitation.ramp_turns"), _solves_steady,
        lambda s: f"integrator '{s.integrator.kind}' solves for the steady motion",
    ),
    Rule(
        "integrator.turns",
        lambda s: _solves_steady(s) and "phase" not in s.identifier.method.needs and not s.kinematics.orbiting,
        lambda s: f"integrator '{s.integrator.kind}' needs one turn",
    ),
    Rule((*_ROTOR, *_DASHPOTS), _slow, lambda s: f"integrator '{s.integrator.kind}' knows neither inertia nor rates"),
    Rule(_DASHPOTS, lambda s: s.excitation is None, "the scene has no [excitation]"),
    Rule(
        ("rotor.transverse_inertia", "rotor.polar_inertia"), lambda s: s.supports.tilt == "locked" and not _slow(s),
        "supports.tilt is locked",
    ),
    Rule("contact.stick_stiffness", lambda s: s.contact.friction == 0.0, "contact.friction is 0"),
    Rule("lubricant.temperature_c", lambda s: s.heat is not None, "[heat] computes it, beginning with heat.oil_inlet_c"),
    Rule("bearing.maker", lambda s: not any(b.preset for b in s.bearing.of_rows), "the bearing is no `preset`"),
    Rule("bearing.row_distance", lambda s: len(s.bearing.rows) == 1, "the bearing has one row"),
    Rule(
        ("bearing.preload_kind", "bearing.preload_of", "bearing.spring_travel"), lambda s: not s.bearing.preloaded,
        "bearing.preload is 0",
    ),
    Rule("bearing.spring_travel", lambda s: s.bearing.preload_kind == "rigid", "bearing.preload_kind is 'rigid'"),
    Rule(
        ("mounting.shaft_bore", "mounting.shaft_material"),
        lambda s: not (
            s.mounting.shaft_interference
            or (s.kinematics.ring_growth and (s.kinematics.ring_growth != "auto" or _turns(s)))
            or (s.mounting.shaft_material and s.mounting.inner_temperature)
        ),
        "mounting.shaft_interference is 0",
    ),
    Rule(
        ("mounting.housing_diameter", "mounting.housing_material"),
        lambda s: not (s.mounting.housing_interference or (s.mounting.housing_material and s.mounting.outer_temperature)),
        "mounting.housing_interference is 0",
    ),
)  # fmt: skip
