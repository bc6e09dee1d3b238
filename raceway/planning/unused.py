"""Keys that a user wrote and that change nothing in this scene, each with the reason."""

from __future__ import annotations

import attrs

from raceway.framework.duties import bodies
from raceway.framework.options import unused_options
from raceway.scene.tables import Scene


def unused(scene: Scene) -> tuple[str, ...]:
    """A sentence for each key that is given and has no effect: of the plug-ins by their own word, of the core here."""
    plugins = {
        "bodies": scene.bodies,
        "contact": scene.contact.law,
        "integrator": scene.integrator.method,
        "identifier": scene.identifier.method,
        "excitation": scene.excitation,
    }
    own = [
        f"`{table}.{option}` has no effect: {why}"
        for table, plugin in plugins.items()
        for option, why in unused_options(plugin).items()
    ]
    return (*own, *(f"`{path}` has no effect: {why}" for path, why in _core(scene)))


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
    told(slow, why, *rotor, "contact.damping")
    locked = scene.supports.tilt == "locked"
    told(locked and not slow, "supports.tilt is locked", "rotor.transverse_inertia", "rotor.polar_inertia")
    told(scene.contact.friction == 0.0, "contact.friction is 0", "contact.stick_stiffness")
    for path, why in bodies(scene, "unused"):
        told(True, why, path)
    own = {field.name for field in attrs.fields(type(scene.bodies))}
    others = [f"bodies.{key}" for key in scene.source.get("bodies", {}) if key != "kind" and key not in own]
    told(True, f"bodies.kind is '{scene.bodies.name}'", *others)
    told(scene.bearing.arrangement == "single", "the bearing has one row", "bearing.row_distance")
    told(scene.bearing.preload == 0.0, "bearing.preload is 0", "bearing.preload_kind")
    return found
