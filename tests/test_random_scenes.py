"""Random scenes, valid and invalid: a result without NaN, or a message with exit code 1 or 2; never anything else."""

from __future__ import annotations

from tests.random_scenes import counted


def test_every_scene_ends_in_a_result_or_in_a_message():
    found = counted(200)
    assert sum(found.values()) >= 200
    # The scenes are neither all wrong nor all right.
    assert all(found[way] >= 5 for way in ("result", "exit code 1", "exit code 2")), found
