"""A small scene for the suites that need one, and its result."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from raceway.pipeline.result import Result
    from raceway.scene.scene import Scene


@cache
def example_scene() -> Scene:
    """A bearing of 30 mm bore under axial load and a turning force, two turns."""
    from raceway import scene_from_dict

    return scene_from_dict(
        {
            "title": "conformance",
            "bearing": {"preset": "B7206C"},
            "load": {"axial": 1000.0},
            "excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 3.2e-4},
            "integrator": {"kind": "newmark", "turns": 2, "steps_per_turn": 90},
            "kinematics": {"ball_inertia": False},
        }
    )


@cache
def example_result() -> Result:
    """The scene's ``Result``."""
    from raceway.pipeline.run import run

    return run(example_scene())
