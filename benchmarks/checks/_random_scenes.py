"""Random scenes, valid and invalid, and what becomes of them."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from typing import Any

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from raceway import scene_from_dict
from raceway.errors import RacewayError
from raceway.pipeline.result import Result
from raceway.pipeline.run import run
from raceway.planning.closed_form import highest_frequency
from raceway.planning.plan import make_plan
from raceway.planning.wall_time import START_S
from raceway.scene.catalogue import single_presets

Tables = dict[str, Any]
FINISHED, REFUSED, FAILED, PLANNED = "finished", "refused, exit code 2", "failed, exit code 1", "planned only"
#: Longer runs are planned and not run: steps, seconds beyond start-up, and natural frequencies over the force's for steady orbits.
_STEPS, _SECONDS, _ORDER = 3000, 0.5, 200.0
#: What stands where something else belongs.
GARBAGE: tuple[Any, ...] = (
    float("nan"), float("inf"), -float("inf"), -1.0, 0.0, 1e300, -(10**30), "", "free", "42", True, None, [], [1.0], {}, {"a": 1},
    [[1.0, float("nan")], [2.0, 3.0]], 0.5, 3, "\x00", "../../etc", 1e-300,
)  # fmt: skip


class Chance:
    """Draws of one scene."""

    def __init__(self, seed: int) -> None:
        self._rng = np.random.default_rng(seed)

    def decades(self, low: float, high: float) -> float:
        """A number spread evenly over decades."""
        return float(f"{10.0 ** self._rng.uniform(math.log10(low), math.log10(high)):.5g}")

    def between(self, low: float, high: float) -> float:
        return float(self._rng.uniform(low, high))

    def whole(self, low: int, high: int) -> int:
        """From low to high, both included."""
        return int(self._rng.integers(low, high + 1))

    def one(self, *choices: Any) -> Any:
        return choices[self.whole(0, len(choices) - 1)]

    def happens(self, share: float) -> bool:
        return bool(self._rng.random() < share)


def bearing(chance: Chance) -> Tables:
    if chance.happens(0.5):
        found: Tables = {"preset": chance.one(*sorted(single_presets()))}
    else:
        ball, count = chance.decades(1e-3, 0.1), chance.whole(1, 24)
        least = ball / math.sin(math.pi / count) if count > 1 else 2.0 * ball
        found = {
            "ball_diameter": ball,
            "pitch_diameter": max(least, 1.5 * ball) * chance.between(0.99, 3.0),
            "ball_count": count,
            "conformity_inner": chance.between(0.5005, 0.6),
            "conformity_outer": chance.between(0.5005, 0.6),
        }
        if chance.happens(0.6):
            found["contact_angle_deg"] = chance.between(0.0, 60.0)
        else:
            found["radial_clearance"] = chance.decades(1e-7, 1e-3)
    if chance.happens(0.15):
        found |= {"arrangement": chance.one("DB", "DF", "DT"), "row_distance": chance.between(0.005, 0.05)}
        if found["arrangement"] != "DT" and chance.happens(0.5):
            found["preload"] = chance.decades(1.0, 1e4)
    if chance.happens(0.15):
        found["balls"] = {"young": chance.decades(1e6, 1e12), "poisson": chance.between(-0.5, 0.4999)}
    return found


def excitation(chance: Chance) -> Tables:
    kind = chance.one("bidirectional", "bidirectional", "bidirectional", "unidirectional", "unidirectional", "run_up")
    found: Tables = {"kind": kind, "speed_rpm": chance.decades(10.0, 2e5), "unbalance": chance.decades(1e-9, 1e-2)}
    if kind == "run_up":
        found |= {"first_speed_rpm": chance.decades(10.0, 2e5), "duration_s": chance.decades(1e-4, 0.05)}
    elif chance.happens(0.5):
        del found["unbalance"]
        found |= {"amplitude": "constant", "force": chance.decades(1e-3, 1e5)}
    return found


def plausible(chance: Chance) -> Tables:
    """A scene that follows the rules for single keys, mostly."""
    tables: Tables = {
        "bearing": bearing(chance),
        "load": {"axial": chance.decades(0.1, 1e5) * chance.one(1.0, 1.0, 1.0, 1.0, -1.0, 0.0)},
        "supports": {"tilt": chance.one("locked", "free", chance.decades(1.0, 1e8))},
        "rotor": {"mass": chance.decades(1e-2, 1e4), "transverse_inertia": chance.decades(1e-6, 10.0)},
        "contact": {
            "kind": chance.one("hertz", "hertz", "penalty"),
            "damping": chance.one(0.0, 1e-3, 1.0, 300.0, 1e4),
            "friction": chance.one(0.0, 0.0, 0.0, 0.0, 0.03, 1.0),
        },
        "kinematics": {"ball_inertia": chance.happens(0.5), "orbiting": chance.happens(0.1)},
        "integrator": {
            "kind": chance.one("newmark", "generalized_alpha", "central_difference", "quasi_static", "periodic"),
            "turns": chance.whole(1, 4),
            "steps_per_turn": chance.one(8, 24, 48, 96, "auto"),
            "start": chance.one("orbit", "ramp", "static"),
        },
        "identifier": {"kind": chance.one("fft_1x", "fft_1x", "fft_1x", "sine_fit", "tangent")},
    }
    if tables["kinematics"]["ball_inertia"] or chance.happens(0.05):
        tables["kinematics"]["gyroscopic"] = chance.one("none", "none", "outer_race", "shared")
    if chance.happens(0.8):
        tables["excitation"] = excitation(chance)
        if tables["excitation"]["kind"] == "run_up" and chance.happens(0.9):
            tables["identifier"] = {"kind": "order_tracking", "window_turns": chance.one(2.0, 6.0)}
        elif chance.happens(0.05):
            speeds = [chance.decades(10.0, 1e5) for _ in range(chance.whole(1, 3))]
            tables["identifier"] = {"kind": "impedance_fit", "speeds_rpm": speeds}
    if chance.happens(0.5):
        size = chance.decades(1.0, 1e5)
        tables["load"]["radial"] = [chance.between(-size, size), chance.between(-size, size)]
    if chance.happens(0.2):
        tables["load"]["moment"] = [chance.between(-100.0, 100.0), chance.between(-100.0, 100.0)]
    if chance.happens(0.1):
        tables["supports"]["axial"] = "displacement"
    if chance.happens(0.03):
        # One section, whose matrices are computed once; other bodies take a second and a half each.
        tables["bearing"] = {"preset": "B7206C"}
        tables |= {"bodies": {"kind": "condensed"}, "mesh": {"kind": "structured", "element_size": 1.5e-3}}
    if chance.happens(0.1):
        tables["kinematics"]["spin_speed_rpm"] = chance.decades(1e-3, 3e5)
    return tables


@st.composite
def scenes(draw: st.DrawFn) -> Tables:
    """Two of three scenes as they are; in the others one or two keys hold something else, or have another name."""
    chance = Chance(draw(st.integers(0, 2**62)))
    tables = plausible(chance)
    for _ in range(chance.one(0, 0, 0, 0, 0, 0, 1, 2)):
        name = draw(st.sampled_from(sorted(tables)))
        table = tables[name]
        way = draw(st.integers(0, 3))
        if way == 0 or not isinstance(table, dict) or not table:
            tables[name] = draw(st.sampled_from(GARBAGE))
        elif way == 1:
            table[draw(st.text(max_size=8))] = draw(st.sampled_from(GARBAGE))
        else:
            table[draw(st.sampled_from(sorted(table)))] = draw(st.sampled_from(GARBAGE))
    return tables


def outcome(tables: Tables) -> str:
    """What becomes of a scene.

    Raises
    ------
    AssertionError
        A result with a NaN, or a refusal without a message.  Whatever else leaves the program passes through.
    """
    try:
        scene = scene_from_dict(tables)
        plan = make_plan(scene)
        if plan.predicted_steps > _STEPS or plan.predicted_work_s - START_S > _SECONDS + 3.0 * (
            scene.bodies.name == "condensed"
        ):
            return PLANNED
        if scene.integrator.kind == "periodic" and scene.excitation is not None:
            order = highest_frequency(scene) / (2.0 * math.pi * scene.excitation.frequency_hz)
            if order > _ORDER:
                return PLANNED
        result = run(scene)
    except RacewayError as error:
        assert error.exit_code in (1, 2), error.exit_code
        assert str(error).strip(), "no message"
        assert error.exit_code == 2 or "nan" not in str(error).split(), str(error)
        return FAILED if error.exit_code == 1 else REFUSED
    refuse_nan(result)
    return FINISHED


def refuse_nan(result: Result) -> None:
    """Raise ``AssertionError`` for a number that is none, in arrays too: result.json has null where arrays have NaN."""
    json.dumps(result.to_dict(), allow_nan=False)
    still = result.equilibrium
    arrays = {"equilibrium": still.displacement, "tangent": still.stiffness, "ball loads": still.contact_force}
    if result.identification is not None:
        z = result.identification.dynamic_stiffness
        arrays["dynamic stiffness"] = np.array([z.real, z.imag])
    if result.simulation is not None:
        whole = result.simulation.whole
        arrays |= {"displacement": whole.displacement, "velocity": whole.velocity, "contact force": whole.contact_force}
    bad = [name for name, array in arrays.items() if not np.isfinite(array).all()]
    assert not bad, f"not finite: {', '.join(bad)}"


def try_scenes(count: int, note: Callable[[str], None], derandomize: bool = True) -> None:
    """Try ``count`` random scenes; ``note`` gets every outcome.

    Raises
    ------
    AssertionError
        Or whatever left the program; the smallest scene that does so is in the notes of the exception.
    """

    @settings(max_examples=count, deadline=None, database=None, derandomize=derandomize,
              suppress_health_check=list(HealthCheck))  # fmt: skip
    @given(scenes())
    def attempt(tables: Tables) -> None:
        note(outcome(tables))

    attempt()
