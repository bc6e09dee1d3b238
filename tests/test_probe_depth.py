"""Laws that break their contract only deep in contact, or read beyond their parameters, are refused by name before a run."""

from __future__ import annotations

import attrs
import numba
import numpy as np
import pytest

from raceway import LAW, PluginError, build_model, make_plan, scene_from_dict
from raceway.contact_laws.hertz import Hertz
from raceway.testing import b7206c, run, settle


@numba.njit(LAW)
def negative_when_deep(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    for i in range(gap.size):
        depth = max(-gap[i], 0.0)
        force[i] = params[i, 0] * depth**1.5 if depth < 12e-6 else -1.0
        d_gap[i] = -1.5 * params[i, 0] * depth**0.5
        d_rate[i] = 0.0


@numba.njit(LAW)
def beyond_its_columns(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    for i in range(gap.size):
        depth = max(-gap[i], 0.0)
        force[i] = (params[i, 0] + 0.0 * params[i, 3]) * depth**1.5
        d_gap[i] = -1.5 * params[i, 0] * depth**0.5
        d_rate[i] = 0.0


def with_law(kernel, axial, build=None):
    @attrs.frozen
    class Broken(Hertz):
        name = "broken"

        def kernel(self):
            return kernel

        def build(self, pairs):
            return super().build(pairs) if build is None else build(pairs)

    scene = scene_from_dict(b7206c(load={"axial": axial}))
    return attrs.evolve(scene, contact=attrs.evolve(scene.contact, kind="broken", law=Broken()))


def test_a_law_that_fails_as_deep_as_the_scene_presses():
    with pytest.raises(PluginError, match="contact law 'broken'.*force -1 at gap .*never negative"):
        run(with_law(negative_when_deep, 8000.0))


def test_a_law_that_reads_beyond_its_columns():
    with pytest.raises(PluginError, match="contact law 'broken'.*one contact alone.*reads beyond the 1 columns"):
        run(with_law(beyond_its_columns, 1000.0))


def test_a_build_that_raises_is_put_to_its_name():
    def build(pairs):
        raise KeyError("stiffness")

    with pytest.raises(PluginError, match=r"contact law 'broken': build\(\) raises KeyError"):
        run(with_law(Hertz().kernel(), 1000.0, build))


def test_a_sound_law_passes_at_any_depth():
    for axial in (1.0, 1000.0, 50_000.0):
        scene = with_law(Hertz().kernel(), axial)
        assert np.isfinite(settle(build_model(scene, make_plan(scene))).displacement).all()
