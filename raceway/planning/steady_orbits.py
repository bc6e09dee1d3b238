"""Steady orbits that a run searches for, and their purpose."""

from __future__ import annotations

from raceway.framework.duties import traits_of
from raceway.scene.scene import Scene


def searches_orbits(scene: Scene) -> bool:
    """Whether a transient begins on a steady orbit that can be searched for: forces are compiled and have no memory."""
    ramped = getattr(scene.excitation, "ramp_turns", 0.0) > 0.0
    return scene.integrator.start == "orbit" and not ramped and has_orbits(scene)


def has_orbits(scene: Scene) -> bool:
    """Whether steady orbits of a transient, or of it without friction, can be searched for."""
    method, excitation, contact = scene.integrator.method, scene.excitation, scene.contact
    if excitation is None or method.steady or not method.inertial:
        return False
    repeats = excitation.period_s is not None or getattr(excitation, "steady", None) is not None
    return repeats and traits_of(scene).compiled and contact.law.state_size == 0


def remembers_its_start(scene: Scene) -> bool:
    """Whether the answer depends on how the motion began, and a second run tells how far.

    Notes
    -----
    With friction contacts stick where the slip before has left them, also in a series of equilibria.  Of elastic bodies and of
    fits over several speeds no transient is estimated: a second run of them would tell nothing more.
    """
    if scene.excitation is None or scene.contact.friction == 0.0 or traits_of(scene).every_node:
        return False
    needs = scene.identifier.method.needs
    return "record" in needs and "speeds" not in needs


def compares_with_steady_motion(scene: Scene) -> bool:
    """Whether the error of a transient is its distance from the steady motion.

    Notes
    -----
    A motion that starts on its orbit is near it already.  Bodies that are stepped from Python, friction and laws with memory
    have no steady motion that can be solved for by itself.
    """
    method, excitation = scene.integrator.method, scene.excitation
    if excitation is None or not method.inertial or method.steady:
        return False
    if not traits_of(scene).compiled or scene.contact.friction > 0.0 or scene.contact.law.state_size > 0:
        return False
    if excitation.period_s is None:
        return getattr(excitation, "steady", None) is not None
    ramped = getattr(excitation, "ramp_turns", 0.0) > 0.0
    return ramped or scene.integrator.start != "orbit" or "speeds" in scene.identifier.method.needs
