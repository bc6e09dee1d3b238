"""Compliances kept on disk: whatever changes the answer changes the key."""

from __future__ import annotations

import numpy as np
import pytest

from raceway.core.revolution.body import Revolution
from raceway.core.revolution.cached import cached_compliance
from raceway.core.revolution.profile import dofs
from tests.revolution.sections import ring

DIVISIONS = 12
BASE = {"young": 212e9, "poisson": 0.29, "formulation": "incompatible", "seat": "clamped", "hourglass": 0.005}
CHANGES = [
    {"young": 300e9},
    {"poisson": 0.2},
    {"formulation": "full"},
    {"formulation": "one_point"},
    {"formulation": "one_point", "hourglass": 0.05},
    {"seat": 5e11},
    {"seat": 1e11},
]


@pytest.fixture(autouse=True)
def empty_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("RACEWAY_CACHE_DIR", str(tmp_path))


def test_every_input_is_part_of_the_key():
    """All of them in one cache: an answer of another material, seat or element would be read back bit for bit."""
    section = ring(True, 1e-3, 3e-3)
    load = dofs(section.race)[:2]
    for change in [{}, *CHANGES, {}]:
        given = {**BASE, **change}
        found = cached_compliance("test", section, DIVISIONS, load_dofs=load, observed_dofs=load, **given)
        body = Revolution(
            section,
            DIVISIONS,
            given["young"],
            given["poisson"],
            1.0,
            given["formulation"],
            given["seat"],
            given["hourglass"],
        )
        np.testing.assert_array_equal(found, body.compliance(load, load, None, "sampled"), err_msg=str(change))


def test_other_divisions_harmonics_and_loads_are_other_answers():
    section = ring(True, 1e-3, 3e-3)
    load = dofs(section.race)[:2]
    first = cached_compliance("test", section, DIVISIONS, 212e9, 0.29, load, load)
    finer = cached_compliance("test", section, 2 * DIVISIONS, 212e9, 0.29, load, load)
    other = cached_compliance("test", section, DIVISIONS, 212e9, 0.29, load[1:], load)
    assert finer.shape != first.shape or not np.array_equal(first, finer)
    np.testing.assert_array_equal(other, first[..., 1:])
