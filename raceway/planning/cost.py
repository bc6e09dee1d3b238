"""Predicted time of a run of compiled rings, from measured times of its parts.

Constants are seconds of processor time of the reference machine of ``raceway.planning.machine``, with all that a run does
for its error beside its answer: tests/evidence/test_cost.py holds whole runs against them.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import cos, log, pi, sin, sqrt

import attrs

from raceway.framework.duties import changes_speed
from raceway.planning.resolve import Balls, Motion, recorded_per_turn, remembers_its_start
from raceway.scene.growth import ring_inertia
from raceway.scene.scene import Scene

#: How much less a step of an explicit method takes, whose steps iterate less.
_EXPLICIT = 0.5
#: An equilibrium of a series, over a step in time.
_EQUILIBRIUM = 6.0
#: Steps of a run with a third one from another start, over those of two.
_FROM_ANOTHER_START = 4.0 / 3.0
#: A step in which the speed changes: one call from Python each.
_CHANGING_S = 130.0e-6
#: A steady orbit; the search for further ones, and from which amplitude over the axial load on: a force along a fixed
#: direction on free tilts meets internal resonances.  The search takes 0.3 to 9 s: what it will meet is not known before.
_ORBIT_S, _SEARCH_S, _SEARCH_FROM = 0.02, 3.0, 0.4
#: Start-up with warm caches, to the first result.
START_S = 1.2


@attrs.frozen
class Times:
    """Measured times of one kind of compiled rings with 12 balls [s].

    Attributes
    ----------
    step : of an implicit method, by the kind of the balls;  sample : of the record: lines, energies and extremes
    search : of a steady orbit, over that of rigid rings
    """

    step: Mapping[str, float]
    sample: float
    search: float


def balls_of(scene: Scene) -> int:
    """Balls of all rows."""
    return int(scene.bearing.balls_in_all)


def runs(scene: Scene, motion: Motion) -> float:
    """Motions that are integrated for the answer and its error, over those without memory of the start."""
    return _FROM_ANOTHER_START if motion.recorded and remembers_its_start(scene) else 1.0


def compiled_motion(scene: Scene, balls: Balls, motion: Motion, times: Times, more: float = 0.0) -> float:
    """Processor time of the motion of a compiled ring [s]; ``more`` : of a step with 12 balls."""
    if not motion.recorded:
        return 0.0
    method, share = scene.integrator.method, balls_of(scene) / 12.0
    each = runs(scene, motion) * share * (times.step[balls.kind] + more)
    each *= (1.0 if method.implicit else _EXPLICIT) * (1.0 if method.inertial else _EQUILIBRIUM)
    if changes_speed(scene.excitation):
        each += _CHANGING_S
    samples = motion.turns * recorded_per_turn(motion.steps_per_turn, motion.turns, method.inertial)
    steps = 0 if method.steady else motion.turns * motion.steps_per_turn
    return times.search * _orbit(scene) + samples * share * times.sample + steps * each


def _orbit(scene: Scene) -> float:
    """Time [s] for the steady orbit of rigid rings that is the answer, or that a transient starts on."""
    if not scene.integrator.method.inertial:
        return 0.0
    searched = scene.supports.tilt != "locked" and scene.excitation.sense == 0
    searched = searched and scene.excitation.amplitude_n > _SEARCH_FROM * abs(scene.load.axial)
    return _SEARCH_S if searched else _ORBIT_S


#: Of the axial displacement at most; a dozen do.
_ITERATIONS = 60


def series_factor(scene: Scene) -> float:
    """K [N/m^1.5] of both races of a ball in series.

    References
    ----------
    Hamrock, Brewe: Simplified solution for stresses and deformations, J. Lubr. Tech. 105 (1983): within 5 %.
    """
    b = scene.bearing
    e = 1.0 / ((1 - b.rings.poisson**2) / b.rings.young + (1 - b.balls.poisson**2) / b.balls.young)
    d, g = b.ball_diameter, b.ball_diameter * cos(b.contact_angle) / b.pitch_diameter
    softness = 0.0
    for f, rolling in ((b.conformity_inner, 2 * g / (1 - g)), (b.conformity_outer, -2 * g / (1 + g))):
        along, across = (2.0 - 1.0 / f) / d, (2.0 + rolling) / d
        ratio = across / along
        ellipticity = 1.0339 * ratio**0.636
        second, first = 1.0003 + 0.5968 / ratio, 1.5277 + 0.6023 * log(ratio)
        factor = pi * ellipticity * 2.0 * e * sqrt(second / (along + across) / (4.5 * first**3))
        softness += factor ** (-2.0 / 3.0)
    return softness**-1.5


def axial_approach(scene: Scene) -> tuple[float, float]:
    """(x [m], load of a ball [N]) under the axial load alone, by Newton's iteration on the axial displacement."""
    b = scene.bearing
    factor, alpha = series_factor(scene), b.contact_angle
    distance = (b.conformity_inner + b.conformity_outer - 1.0) * b.ball_diameter
    target = abs(scene.load.axial)

    def state(x: float) -> tuple[float, float]:
        a, r = distance * sin(alpha) + x, distance * cos(alpha)
        s = sqrt(a * a + r * r)
        load = factor * max(s - distance, 0.0) ** 1.5
        return b.ball_count * load * a / s, load

    high = distance
    while state(high)[0] < target and high < 100.0 * distance:
        high *= 2.0
    # The force grows faster than the displacement: Newton's iteration stays above and falls, until rounding ends it.
    for _ in range(_ITERATIONS):
        axial, load = state(high)
        a, r = distance * sin(alpha) + high, distance * cos(alpha)
        s = sqrt(a * a + r * r)
        slope = b.ball_count * (1.5 * factor * sqrt(max(s - distance, 0.0)) * (a / s) ** 2 + load * r * r / s**3)
        step = (axial - target) / slope if slope > 0.0 else 0.0
        if not 0.0 < step <= high or step <= 1e-15 * high:
            break
        high -= step
    return high, state(high)[1]


def highest_frequency(scene: Scene) -> float:
    """Largest natural frequency of the ring on its contacts [rad/s], roughly."""
    b = scene.bearing
    _, load = axial_approach(scene)
    if scene.excitation is not None:
        load += scene.excitation.amplitude_n * (5.0 / b.ball_count)  # of any size that is a number
    normal = 1.5 * load / (load / series_factor(scene)) ** (2.0 / 3.0) if load > 0.0 else 1.0
    mass, inertia, _ = ring_inertia(scene)
    mass, inertia = mass + scene.rotor.mass, inertia + scene.rotor.transverse_inertia
    alpha = b.contact_angle
    best = b.ball_count * normal * max(sin(alpha) ** 2, 0.5 * cos(alpha) ** 2) / mass
    if scene.supports.tilt != "locked" and inertia > 0.0:
        shaft = scene.supports.tilt if isinstance(scene.supports.tilt, float) else 0.0
        best = max(best, (0.5 * b.ball_count * normal * (sin(alpha) * b.pitch_diameter / 2.0) ** 2 + shaft) / inertia)
    return sqrt(best) + 1e-6 * pi
