"""The probe at plan time refuses laws and excitations that would corrupt a run, by name and with the contract's words."""

import attrs
import numpy as np
import pytest

from checks.validation.scenes import built_in
from raceway import FORCE, LAW, PluginError, build_model, jit, scene_from_dict
from raceway.testing import b7206c, run, solve_equilibrium
from tests import broken_laws

Hertz = built_in("contact_law", "hertz")
Bidirectional = built_in("excitation", "bidirectional")

#: Contacts of B7206C.
N = 24


def refused(kernel, *found):
    """A scene with a law's kernel is refused before anything is computed, in these words."""
    with pytest.raises(PluginError, match="contact law 'broken' .*" + ".*".join(found)):
        build_model(with_law(kernel, 1000.0, lambda pairs: np.full((N, 1), 1e10)))


@pytest.mark.parametrize(("kernel", "found"), [
    ("negative", "force -2000 at gap -1e-09 m, rate 0.02 m/s; the contract says never negative"),
    ("sticky", "force 0.999 at gap 1e-09 m, rate 0 m/s, outside contact; the contract says zero for gap >= 0"),
    ("not_a_number", "the kernel gives `force` = nan at gap 0.001 m"),
    ("incomplete", "the kernel leaves `force` as it was at gap 0.001 m"),
    ("raising", "the kernel raises ValueError: too deep at gap -1e-05 m"),
    ("other_signature", "its kernel has .* the rule is .*: decorate it with @jit"),
    ("plain_python", "which is not compiled: decorate it with @jit"),
    ("double_slope", "`d_gap` = .* at gap -.* m, rate -0.02 m/s, where differences of the force give"),
    ("wrong_slope", "`d_gap` = .*where differences of the force give"),
    ("half_a_damper", "`d_rate` = .*where differences of the force give"),
])  # fmt: skip
def test_broken_kernels_are_refused(kernel, found):
    refused(getattr(broken_laws, kernel), found)


@jit(LAW)
def clamped(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    """Hertz's law, which leaves no approach in ``gap``."""
    for i in range(gap.size):
        gap[i] = max(-gap[i], 0.0)
        force[i] = params[i, 0] * gap[i] ** 1.5
        d_gap[i] = -1.5 * params[i, 0] * gap[i] ** 0.5
        d_rate[i] = 0.0


@jit(LAW)
def wearing(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    """Hertz's law, which wears where a contact presses hard and halves the rate."""
    for i in range(gap.size):
        deep = max(-gap[i], 0.0)
        force[i] = params[i, 0] * deep**1.5
        d_gap[i] = -1.5 * params[i, 0] * deep**0.5
        d_rate[i] = 0.0
        gap_rate[i] *= 0.5
        params[i, 0] *= 0.999 if params[i, 0] > 9.9e9 and deep > 5e-6 else 1.0


@pytest.mark.parametrize(("kernel", "found"), [
    (broken_laws.writing, "state_old at gap -1e-09"), (clamped, "gap at gap 0.001"),
    (wearing, "params at gap -1e-05 m, one contact alone"),
])  # fmt: skip
def test_a_kernel_that_writes_into_its_inputs_is_refused(kernel, found):
    refused(kernel, f"changes {found}", "inputs are read only")


def test_a_rate_that_a_kernel_writes_is_refused_in_a_run():
    with pytest.raises(PluginError, match="contact law 'broken' .*changes gap_rate at gap .* rate -0.02"):
        run(with_law(wearing, 1000.0, lambda pairs: np.full((len(pairs.hertz_factor), 1), 1e9)))


@jit(FORCE)
def counting(t, params, out):
    params[0] += 1.0
    out[:] = params[0]


@pytest.mark.parametrize(("params", "found"), [
    (
        np.full(N, 1e10),
        r"build\(\) returned parameters of shape \(24,\); it must be \(24, k\): a row for each ball-race pair",
    ),
    (np.full((3, 1), 1.0), r"of shape \(3, 1\)"), ([1.0], r"of shape \(1,\)"), (np.full((N, 1), np.nan), "not finite"),
])  # fmt: skip
def test_wrong_parameters_are_refused(params, found):
    with pytest.raises(PluginError, match=f"contact law 'broken'.*: .*{found}"):
        build_model(with_law(Hertz().kernel(), 1000.0, lambda pairs: params))


@jit(FORCE)
def half(t, params, out):
    out[0] = 1.0
    out[1] = 2.0


@jit(FORCE)
def diverging(t, params, out):
    for i in range(5):
        out[i] = t / 0.0 if t > 0.001 else 1.0


@jit(FORCE)
def undefined(t, params, out):
    for i in range(5):
        out[i] = np.sqrt(-t)


@pytest.mark.parametrize(("kernel", "found"), [
    (half, "leaves `out` as it was at t = 0 s"), (diverging, "gives `out` = inf"),
    (undefined, "gives `out` = nan"),
    (counting, "changes params at t = 0 s; the contract says inputs are read only"),
    (broken_laws.sticky, "its kernel has .* the rule is .*: decorate it with @jit.FORCE"),
])  # fmt: skip
def test_broken_excitations_are_refused(kernel, found):
    with pytest.raises(PluginError, match=f"excitation 'broken' .*{found}"):
        build_model(with_force(kernel=lambda _: kernel))


def test_sound_excitations_pass_and_wrong_parameters_do_not():
    build_model(with_force())
    with pytest.raises(PluginError, match=r"parameters\(\) returned shape \(1, 7\); it must be \(k,\)"):
        build_model(with_force(parameters=lambda self: Bidirectional.parameters(self)[None]))


def with_force(**methods):
    broken = attrs.frozen(type("Broken", (Bidirectional,), {"name": "broken", **methods}))
    turning = {"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 1e-4}
    scene = scene_from_dict(b7206c(rotor={"mass": 2.0}, excitation=turning))
    return attrs.evolve(scene, excitation=broken(**attrs.asdict(Bidirectional.examples()[0])))


@jit(LAW)
def negative_when_deep(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    for i in range(gap.size):
        depth = max(-gap[i], 0.0)
        force[i] = params[i, 0] * depth**1.5 if depth < 12e-6 else -1.0
        d_gap[i] = -1.5 * params[i, 0] * depth**0.5
        d_rate[i] = 0.0


@jit(LAW)
def beyond_its_columns(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    for i in range(gap.size):
        depth = max(-gap[i], 0.0)
        force[i] = (params[i, 0] + 0.0 * params[i, 3]) * depth**1.5
        d_gap[i] = -1.5 * params[i, 0] * depth**0.5
        d_rate[i] = 0.0


def with_law(kernel, axial, build=None):
    size = int(kernel is broken_laws.writing)

    @attrs.frozen
    class Broken(Hertz):
        name = "broken"
        state_size = size

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
        assert np.isfinite(solve_equilibrium(build_model(scene)).displacement).all()
