"""Turns, steps and samples of a motion, predicted and recorded; records that would not fit are refused."""

from __future__ import annotations

from math import ceil, sqrt

from raceway.errors import SceneError
from raceway.framework.duties import bodies
from raceway.scene.scene import Scene

#: Steps a turn where the scene says "auto", and samples a turn that are kept of short runs.
STEPS_PER_TURN = 360
#: Part of the stable limit, taken at the stiffest tangent of the orbit, that "auto" steps take. Balls that leave and meet the
#: races each turn pump motions up a little below the limit of the frozen tangent: one orbit at 0.885 of it grew in 49 turns.
SAFETY = 0.8
#: Samples of a long run's record.
_SAMPLES = 72_000
#: What a record takes at the peak over its own arrays: 3.7 times measured with 12 balls and 400 turns.  Records above the limit are refused [bytes].
_COPIES = 4
_MEMORY_LIMIT = 4 * 2**30


def turns_of(scene: Scene) -> int:
    """Turns that are integrated: the scene's, or as many as the excitation lasts."""
    duration = getattr(scene.excitation, "duration_s", None)
    if duration is None:
        return scene.integrator.turns
    return max(int(duration * scene.excitation.frequency_hz + 0.5), 1)


def predicted_steps_per_turn(scene: Scene) -> int:
    """The scene's number; for 'auto' 360, or the multiple of it that a rough stiffness asks of an explicit method."""
    given = scene.integrator.steps_per_turn
    if isinstance(given, int):
        return given
    if scene.integrator.method.implicit:
        return STEPS_PER_TURN
    period = scene.excitation.period_s or 1.0 / scene.excitation.frequency_hz
    stable = bodies(scene, "stable_step")
    return STEPS_PER_TURN if stable is None else stable_steps_per_turn(period, damped_limit(stable, scene.time_constant))


def damped_limit(limit: float, time_constant: float) -> float:
    """Rough stable limit of explicit steps [s] with dashpots c = tau k at the contacts, from that without them.

    Notes
    -----
    ``Ring.damped_time_step`` for one mode: with w = 2 / limit and the damping ratio z = tau w / 2 = tau / limit it is
    limit (sqrt(1 + 4 z^2) - 2 z).
    """
    doubled = 2.0 * time_constant / limit
    return limit * (sqrt(1.0 + doubled**2) - doubled)


def stable_steps_per_turn(period: float, limit: float) -> int:
    """Steps of 'auto' for an explicit method: the least multiple of 360 within ``SAFETY`` of the stable limit.

    Parameters
    ----------
    period : of a turn [s];  limit : stable step [s]
    """
    return STEPS_PER_TURN * max(1, ceil(period / (SAFETY * limit) / STEPS_PER_TURN))


def recorded_per_turn(steps_per_turn: int, turns: int, inertial: bool = True) -> int:
    """Samples a turn that are really recorded: a divisor of the steps near ``samples_per_turn``, or all steps."""
    wanted = samples_per_turn(turns, inertial)
    fitting = (s for s in range(wanted, min(2 * wanted, steps_per_turn) + 1) if steps_per_turn % s == 0)
    return next(fitting, steps_per_turn)


def samples_per_turn(turns: int, inertial: bool = True) -> int:
    """Samples a turn that are recorded: 360, fewer in runs of more than 200 turns, never below 24.

    Parameters
    ----------
    inertial : False for a series of equilibria, of which up to 72 000 are recorded in all: no inertia keeps the harmonics
        of the contacts small, and those beyond the samples would show as 1x
    """
    most = _SAMPLES // max(turns, 1)
    return max(24, min(STEPS_PER_TURN, most) if inertial else most)


def record_bytes(turns: int, steps_per_turn: int, count: int, inertial: bool = True) -> int:
    """Bytes that a run of so many balls takes for its record, with what identification and energy balance copy of it."""
    return _COPIES * 8 * turns * recorded_per_turn(steps_per_turn, turns, inertial) * (16 + 8 * count)


def fits(turns: int, steps_per_turn: int, count: int, inertial: bool = True) -> bool:
    """Whether a record is not refused."""
    return record_bytes(turns, steps_per_turn, count, inertial) <= _MEMORY_LIMIT


def refuse_memory(scene: Scene, turns: int, steps_per_turn: int, count: int) -> None:
    """Records that will not fit are refused before anything is computed."""
    needed = record_bytes(turns, steps_per_turn, count, scene.integrator.method.inertial)
    if needed > _MEMORY_LIMIT:
        raise SceneError.at(
            "integrator.turns",
            scene.integrator.turns,
            f"the record of {turns} turns would take {needed / 2**30:.1f} GiB, above {_MEMORY_LIMIT / 2**30:.0f} GiB: take "
            "fewer turns, or steps_per_turn = 360 or a multiple of it",
        )
