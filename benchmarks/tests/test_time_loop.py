"""The composed loop against one that is fused by hand."""

import pytest

from benchmarks.time_loop import SAME, compare


@pytest.mark.slow
@pytest.mark.parametrize("inertial", [True, False])
@pytest.mark.parametrize("kind", ["newmark", "central_difference"])
def test_the_composed_loop_computes_what_a_hand_fused_one_does(kind, inertial):
    # How fast it is, report speed tells.
    loop = compare(kind, inertial, repeats=1)
    assert loop.deviation < SAME, loop
