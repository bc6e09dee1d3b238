"""Rig less shaft is the bearing: exact without noise, and with it `fit` holds K and C within their intervals."""

import numpy as np
import pytest
from raceway_measure.fit.linear import fit_record
from raceway_measure.fit.response import FrequencyResponse

import raceway as rw

pytest.importorskip("pyuff")
from examples import substructuring as example  # noqa: E402  pyuff is needed

TRUTH = {"K": 2.38e8, "C": 800.0}


def test_without_noise_the_difference_is_the_bearing_at_any_number_of_shared_points(monkeypatch):
    monkeypatch.setattr(example, "NOISE", 0.0)
    w = 2.0 * np.pi * example.HZ
    bearing = example.less(*example.tested(*TRUTH.values()))[:, 0, 0]
    np.testing.assert_allclose(1.0 / bearing, TRUTH["K"] + 1j * w * TRUTH["C"], rtol=1e-9)
    random = np.random.default_rng(2)
    first, second = (random.standard_normal((5, 3, 3)) + 4.0 * np.eye(3) for _ in range(2))
    assembly = np.linalg.inv(np.linalg.inv(first) + np.linalg.inv(second))
    np.testing.assert_allclose(example.less(assembly, first), second, rtol=1e-9, atol=1e-9)


@pytest.mark.slow
def test_intervals_of_the_difference_hold_what_they_state(tmp_path):
    inside = dict.fromkeys(TRUTH, 0)
    for seed in range(60):
        bearing = example.less(*example.tested(*TRUTH.values(), seed))[:, 0, 0]
        fitted = fit_record(FrequencyResponse("rig less shaft", example.HZ, bearing), list(TRUTH), None)
        for name, value in TRUTH.items():
            inside[name] += abs(fitted[name] - value) < fitted.half_width(name)
    assert min(inside.values()) >= 51  # of a binomial distribution with 0.95 less are 1 in 1000
    fitted = rw.fit(example.write(bearing, tmp_path / "bearing.uff"), None, "K,C")
    assert fitted["K"] == pytest.approx(TRUTH["K"], rel=1e-3)
