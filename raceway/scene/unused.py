"""Keys that a user wrote and that change nothing in this scene, each with the reason."""

from __future__ import annotations

from collections.abc import Collection
from contextlib import suppress

import attrs

from raceway.errors import RacewayError
from raceway.framework.options import unused_options
from raceway.framework.registry import Registry
from raceway.scene.reading import scene_from_dict
from raceway.scene.scene import Scene
from raceway.storage.tables import ReadTables, Tables


def unused(scene: Scene) -> tuple[str, ...]:
    """A sentence for each key that is given and has no effect."""
    return tuple(f"`{path}` has no effect: {why}" for path, why in _idle(scene))


def without_inherited(base: ReadTables, changed: ReadTables, said: Collection[str], registry: Registry) -> Tables:
    """Changed tables without the keys of the base that lose their effect by the change: nobody said those for this scene.

    Parameters
    ----------
    base : tables of a file;  changed : the same with some keys changed;  said : those keys, which stay and are told of

    Notes
    -----
    A key that has no effect in the base either is the base's own mistake, and stays.  Tables that make no scene are left as
    they are: what reads them says what is wrong.
    """
    result = dict(changed)
    try:
        lost = {path for path, _ in _idle(scene_from_dict(changed, registry))} - set(said)
    except RacewayError:
        return result
    lost = {path for path in lost if not any(path.startswith(f"{key}.") for key in said)}
    if lost:
        with suppress(RacewayError):  # a base that is complete with the changes only has no mistakes of its own to tell of
            lost -= {path for path, _ in _idle(scene_from_dict(base, registry))}
    for path in lost:
        name, _, key = path.partition(".")
        if isinstance(result.get(name), dict):
            result[name] = {word: value for word, value in result[name].items() if word != key}
    return result


def _idle(scene: Scene) -> list[tuple[str, str]]:
    """Path and reason: of the plug-ins by their own word, of the core here."""
    plugins = {
        "bodies": scene.bodies,
        "contact": scene.contact.law,
        "integrator": scene.integrator.method,
        "identifier": scene.identifier.method,
        "excitation": scene.excitation,
    }
    own = [(f"{table}.{option}", why) for table, plugin in plugins.items() for option, why in unused_options(plugin).items()]
    return [*own, *_core(scene)]


def _core(scene: Scene) -> list[tuple[str, str]]:
    given = {f"{table}.{key}" for table, keys in scene.source.items() if isinstance(keys, dict) for key in keys}
    found: list[tuple[str, str]] = []

    def told(idle: bool, why: str, *paths: str) -> None:
        found.extend((path, why) for path in paths if idle and path in given)

    dynamic = scene.excitation is not None
    recorded = dynamic and "record" in scene.identifier.method.needs
    integration = [f"integrator.{key}" for key in ("turns", "steps_per_turn", "start")]
    told(not dynamic, "the scene has no [excitation]", *integration)
    still = dynamic and not recorded
    told(still, f"identifier '{scene.identifier.kind}' needs no recorded motion", *integration)
    steady = recorded and scene.integrator.method.steady
    told(
        steady,
        f"integrator '{scene.integrator.kind}' solves for the steady motion",
        "integrator.start",
        "excitation.ramp_turns",
    )
    one = steady and "phase" not in scene.identifier.method.needs and not scene.kinematics.orbiting
    told(one, f"integrator '{scene.integrator.kind}' needs one turn", "integrator.turns")
    slow = recorded and not scene.integrator.method.inertial
    rotor = [f"rotor.{key}" for key in ("mass", "transverse_inertia", "polar_inertia", "damping")]
    why = f"integrator '{scene.integrator.kind}' knows neither inertia nor rates"
    dashpots = [f"contact.{key}" for key in ("damping", "time_constant", "loss_factor")]
    told(slow, why, *rotor, *dashpots)
    told(not dynamic, "the scene has no [excitation]", *dashpots)
    locked = scene.supports.tilt == "locked"
    told(locked and not slow, "supports.tilt is locked", "rotor.transverse_inertia", "rotor.polar_inertia")
    told(scene.contact.friction == 0.0, "contact.friction is 0", "contact.stick_stiffness")
    for path, why in scene.body_kind.unused():
        told(True, why, path)
    own = {field.name for field in attrs.fields(type(scene.bodies))}
    others = [f"bodies.{key}" for key in scene.source.get("bodies", {}) if key != "kind" and key not in own]
    told(True, f"bodies.kind is '{scene.bodies.name}'", *others)
    told(len(scene.bearing.rows) == 1, "the bearing has one row", "bearing.row_distance")
    without = "bearing.preload is 0"
    told(not scene.bearing.preloaded, without, "bearing.preload_kind", "bearing.preload_of", "bearing.spring_travel")
    told(scene.bearing.preload_kind == "rigid", "bearing.preload_kind is 'rigid'", "bearing.spring_travel")
    warm, turns = scene.mounting, scene.kinematics.ring_growth
    fitted = warm.shaft_interference or turns or (warm.shaft_material and warm.inner_temperature)
    told(not fitted, "mounting.shaft_interference is 0", "mounting.shaft_bore", "mounting.shaft_material")
    fitted = warm.housing_interference or (warm.housing_material and warm.outer_temperature)
    told(not fitted, "mounting.housing_interference is 0", "mounting.housing_diameter", "mounting.housing_material")
    return found
