"""How a motion begins: on a steady orbit, under a growing force, or suddenly."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import attrs

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model
from raceway.core.ring.orbit import Orbit, steady_orbit
from raceway.core.ring.ring import Ring
from raceway.core.ring.surrogate import compiled
from raceway.errors import ConvergenceError
from raceway.planning.steady_orbits import searches_orbits

Watch = Callable[[], None]
#: Slips that a start leaves in contacts which stick stay there.
_STICKS = (
    "friction: where contacts stick depends on how the motion began, so that several steady motions exist: "
    "integrator.start = 'orbit', 'ramp' and 'static' lead to different ones"
)


@attrs.frozen(eq=False)
class Start:
    """How a motion begins.

    Attributes
    ----------
    kind : "orbit", "ramp" or "static"
    orbit : that it begins on
    orbits : ``motion.orbits`` of result.json: the steady motions that were found in the search for it
    settled : False where turns need not repeat: no orbit was found, or only one that is unstable
    warnings : what a user should know
    """

    kind: str
    orbit: Orbit | None = None
    orbits: tuple[dict[str, Any], ...] = ()
    settled: bool = True
    warnings: tuple[str, ...] = ()


def chosen_start(model: Model, equilibrium: Equilibrium, watch: Watch | None = None) -> Start:
    """The scene's start; an orbit that cannot be found becomes a ramp, with a warning.

    Parameters
    ----------
    watch : called in the search for orbits, which what it raises ends
    """
    scene, method = model.scene, model.scene.integrator.method
    if method.steady:
        return Start("static")
    kind = "ramp" if getattr(scene.excitation, "ramp_turns", 0.0) > 0.0 else scene.integrator.start
    if scene.contact.friction > 0.0:
        begun = _begun(model, equilibrium, kind, watch)
        return attrs.evolve(begun, warnings=(*begun.warnings, _STICKS))
    return _begun(model, equilibrium, kind, watch)


def _begun(model: Model, equilibrium: Equilibrium, kind: str, watch: Watch | None) -> Start:
    if kind != "orbit" or not model.scene.integrator.method.inertial:
        return Start(kind)
    excitation, system = model.excitation, model.bearing.orbiting(model.system.at_speed(0.0))
    if excitation.period_s is None:
        # What changes its speed starts on the orbit of its first moment.
        steady = getattr(excitation, "steady", None)
        if steady is None:
            why = "the excitation does not repeat every turn: started with a ramp instead of on the orbit"
            return Start("ramp", settled=False, warnings=(why,))
        excitation = steady()
        system = attrs.evolve(system, force=excitation.kernel(), force_params=excitation.parameters())
    return _on_orbit(model, equilibrium, system, excitation.period_s, watch)


def _on_orbit(model: Model, equilibrium: Equilibrium, system: Ring, period: float, watch: Watch | None) -> Start:
    """On the motion that the search for periodic motions takes, or on the collocated one where it does not search."""
    q = equilibrium.displacement
    try:
        ring = compiled(system)
        if searches_orbits(model.scene) and ring is not None:
            from raceway.core.periodic.beginning import beginning

            found = beginning(ring, period, q, watch)
            if found is not None and not found.told:
                return Start("orbit", found.orbit)
            if found is not None:
                return _told(model, found.orbit, found.told, found.warnings)
        return Start("orbit", steady_orbit(system, period, q))
    except ConvergenceError as why:
        return Start("ramp", settled=False, warnings=(f"{why}: started with a ramp instead",))


def _told(model: Model, orbit: Orbit, orbits: list[dict[str, Any]], warnings: tuple[str, ...]) -> Start:
    """Of a scene whose motion is not that of its start, the orbits are told in warnings only."""
    scene = model.scene
    other = {
        "without friction": scene.contact.friction > 0.0,
        "with balls that do not orbit": scene.kinematics.orbiting,
        "at its first speed": model.excitation.period_s is None,
    }
    words = ", ".join(word for word, here in other.items() if here)
    if words:
        return Start("orbit", orbit, (), orbits[0]["stable"], tuple(f"{words}: {text}" for text in warnings))
    return Start("orbit", orbit, tuple(orbits), orbits[0]["stable"], warnings)
