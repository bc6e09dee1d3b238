"""Random scenes, valid and invalid, for `hypothesis`: each must end in a result without NaN, or in one message."""

from __future__ import annotations

import json
from collections import Counter
from typing import Any

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from raceway.errors import RacewayError
from raceway.run import run
from raceway.scene_file import scene_from_dict

#: What is no sensible value of any key.
WRONG = st.sampled_from([-1.0, 0.0, 1e300, -1e300, float("nan"), float("inf"), "word", "", True, None, [], [1.0, 2.0], {}])


def _or_wrong(good: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    """One value in 150 is wrong: most scenes of ten keys are still valid."""
    return st.integers(0, 150).flatmap(lambda n: WRONG if n == 0 else good)


def _decades(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_nan=False).map(lambda e: 10.0**e)


def _table(**keys: st.SearchStrategy[Any]) -> st.SearchStrategy[dict[str, Any]]:
    return st.fixed_dictionaries({}, optional={name: _or_wrong(value) for name, value in keys.items()})


def _signed(low: float, high: float) -> st.SearchStrategy[float]:
    return st.tuples(st.sampled_from([1.0, -1.0, 0.0]), _decades(low, high)).map(lambda pair: pair[0] * pair[1])


_MATERIAL = _table(young=_decades(6, 13), poisson=st.floats(-0.9, 0.4999), density=_decades(2, 5))
_PRESET = st.builds(
    lambda more: {"preset": "B7206C", **more},
    _table(
        ball_count=st.integers(3, 14), conformity_inner=st.floats(0.501, 0.7), conformity_outer=st.floats(0.501, 0.7),
        contact_angle_deg=st.floats(0.0, 60.0), arrangement=st.sampled_from(["single", "single", "single", "DB", "DF", "DT"]),
        first_ball_azimuth_deg=st.floats(-400.0, 400.0), rings=_MATERIAL, balls=_MATERIAL,
        tilt_arm=st.sampled_from(["groove", "pitch"]),
    ),
)  # fmt: skip
_OWN = _table(
    ball_diameter=_decades(-4, -1), pitch_diameter=_decades(-3, 0), ball_count=st.integers(1, 60),
    conformity_inner=st.floats(0.501, 0.9), conformity_outer=st.floats(0.501, 0.9), radial_clearance=_decades(-7, -3),
)  # fmt: skip
_EXCITATION = st.builds(
    lambda kind, more: {"kind": kind, "speed_rpm": 12000.0, "unbalance": 6e-4, **more},
    st.sampled_from(["bidirectional", "unidirectional"]),
    _table(
        speed_rpm=_decades(0, 5.3), unbalance=_decades(-8, -2), load_share=st.floats(0.0, 1.0),
        amplitude=st.sampled_from(["unbalance", "constant"]), force=_decades(-2, 4),
    ),
)  # fmt: skip

_LOADS = _table(
    axial=_signed(-1, 5),
    radial=st.lists(_signed(-1, 4), min_size=2, max_size=2),
    moment=st.lists(_signed(-2, 2), min_size=2, max_size=2),
)
SCENES = st.fixed_dictionaries(
    {
        "bearing": st.integers(0, 5).flatmap(lambda n: _OWN if n == 0 else _PRESET),
        "load": st.builds(lambda axial, more: {"axial": axial, **more}, _decades(0, 5), _LOADS),
    },
    optional={
        "rotor": _table(mass=_decades(-3, 4), transverse_inertia=_decades(-6, 1), polar_inertia=_decades(-6, 1), damping=_decades(-3, 4)),
        "supports": _table(tilt=st.one_of(st.sampled_from(["locked", "free"]), _decades(0, 8)), axial=st.sampled_from(["force", "displacement"])),
        "excitation": _EXCITATION,
        "contact": _table(
            kind=st.sampled_from(["hertz", "hertz", "hertz", "penalty", "penalty", "unilateral"]), discretisation=st.sampled_from(["resultant"] * 8 + ["nodal"]),
            friction=st.floats(0.0, 1.0), damping=_decades(-4, 3),
        ),
        "kinematics": _table(
            orbiting=st.sampled_from([False, False, True]), ball_inertia=st.booleans(), gyroscopic=st.sampled_from(["none", "none", "none", "outer_race", "shared"]),
            spin_speed_rpm=_decades(0, 5.3), radial_expansion=_signed(-7, -4), ring_growth=st.booleans(),
        ),
        "identifier": _table(kind=st.sampled_from(["fft_1x", "fft_1x", "sine_fit", "tangent", "order_tracking", "impedance_fit"])),
    },
)  # fmt: skip
#: Short runs: what counts is how they end.
INTEGRATORS = st.builds(
    lambda kind, more: {"kind": kind, "turns": 2, "steps_per_turn": 48, **more},
    st.sampled_from(["newmark", "generalized_alpha", "central_difference", "quasi_static", "periodic"]),
    _table(turns=st.integers(1, 3), steps_per_turn=st.integers(8, 100), start=st.sampled_from(["orbit", "ramp", "static"])),
)


def ends(tables: dict[str, Any]) -> str:
    """How a scene ends: "result", or the exit code of its message; whatever else it raises passes through."""
    try:
        result = run(scene_from_dict({"title": "random", **tables}))
        json.dumps(result.as_dict(), allow_nan=False)  # refuses NaN and infinities
    except RacewayError as error:
        assert error.exit_code in (1, 2) and str(error).strip()
        return f"exit code {error.exit_code}"
    return "result"


def counted(count: int) -> Counter[str]:
    """How many of ``count`` scenes end in which way; the same scenes at each call."""
    found: Counter[str] = Counter()

    @settings(max_examples=count, deadline=None, derandomize=True, database=None, suppress_health_check=list(HealthCheck))
    @given(scene=SCENES, integrator=INTEGRATORS)
    def run_one(scene: dict[str, Any], integrator: dict[str, Any]) -> None:
        found[ends({**scene, "integrator": integrator})] += 1

    run_one()
    return found
