"""Random scenes, valid and invalid: each ends in a result without NaN, or in a message with exit code 1 or 2."""

from __future__ import annotations

from collections import Counter

import pytest

from benchmarks.checks._random_scenes import FAILED, FINISHED, REFUSED, try_scenes

COUNT = 100


@pytest.mark.slow
def test_every_scene_ends_in_a_result_or_a_message():
    """The same scenes in every run; ``python -m benchmarks.checks random_scenes`` tries 10 000."""
    found: Counter[str] = Counter()

    def note(outcome: str) -> None:
        found[outcome] += 1

    try_scenes(COUNT, note)
    # All three ends are met, so that none of them is the test's own doing.
    assert min(found[FINISHED], found[REFUSED], found[FAILED]) >= 5, found
