"""The verdict on multipliers, and multipliers of a motion whose growth is known in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from raceway.core.periodic.floquet import Floquet, fate_of


@pytest.mark.parametrize(
    "largest, verdict",
    [(0.5, "stable"), (1.0 - 1e-5, "stable"), (1.0 - 1e-8, "neutral"), (1.0 + 1e-8, "neutral"),
     (1.0 + 1e-5, "unstable"), (1.1, "unstable"), (1.19, "unstable"), (3.0, "unstable")],
)  # fmt: skip
def test_what_grows_is_called_unstable(largest, verdict):
    """A part in 1e5 a turn is a factor e in some minutes at 12 000 r/min: a real ring does not stay there."""
    for turn in (1.0, -1.0, np.exp(0.7j)):
        multipliers = np.array([largest * turn, 1.0 / largest * turn.conjugate() if largest > 1 else 0.1])
        found = Floquet(multipliers.astype(complex), multipliers.astype(complex))
        assert found.verdict == verdict
        assert bool(found.leaves_by) == (verdict == "unstable")


def test_what_dies_within_a_span_has_the_multiplier_zero(recwarn):
    """Dashpots of 1e5 N s/m leave nothing: it was not a number, with a warning of numpy's, and all of them "neutral"."""
    over = np.diag([0.0, 0.5, -0.9])
    assert fate_of(over, np.pi / 6.0).multipliers == pytest.approx([0.9**12, 0.5**12, 0.0])
    assert fate_of(0.0 * over, np.pi / 6.0).verdict == "stable"
    assert not recwarn.list
