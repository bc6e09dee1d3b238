"""Contact laws that each break one duty; what finds them is said in the tests."""

from typing import ClassVar

import attrs
import numpy as np
from numba import float64, njit, void

from checks.validation.scenes import built_in
from raceway import LAW, jit, option

Hertz = built_in("contact_law", "hertz")


def of_one_contact(function):
    """The kernel of a law from force, d force / d gap and d force / d rate of one contact."""
    one = njit(function)

    @jit(LAW)
    def kernel(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
        for i in range(gap.size):
            force[i], d_gap[i], d_rate[i] = one(params[i, 0], max(-gap[i], 0.0), gap_rate[i], gap[i])

    return kernel


@of_one_contact
def negative(k, deep, rate, gap):
    return (-1e6 * gap - 1e5 * rate, -1e6, -1e5) if gap < 0.0 else (0.0, 0.0, 0.0)


@of_one_contact
def sticky(k, deep, rate, gap):
    return 1e6 * max(1e-6 - gap, 0.0), -1e6 if gap < 1e-6 else 0.0, 0.0


@of_one_contact
def not_a_number(k, deep, rate, gap):
    return k * (-gap) ** 1.5, 0.0, 0.0


@of_one_contact
def raising(k, deep, rate, gap):
    if deep > 5e-6:
        raise ValueError("too deep")
    return 0.0, 0.0, 0.0


@of_one_contact
def wrong_slope(k, deep, rate, gap):
    return k * deep**1.5, -1.51 * k * deep**0.5, 0.0


@of_one_contact
def double_slope(k, deep, rate, gap):
    return k * deep**1.5, -3.0 * k * deep**0.5, 0.0


@of_one_contact
def half_a_damper(k, deep, rate, gap):
    factor = max(1.0 - rate, 0.0)
    return k * deep * factor, -k * factor, -0.5 * k * deep


@of_one_contact
def losing(k, deep, rate, gap):
    factor = max(1.0 - 0.5 * rate, 0.0)
    return k * deep**1.5 * factor, -1.5 * k * deep**0.5 * factor, -0.5 * k * deep**1.5 * (factor > 0.0)


@of_one_contact
def gaining(k, deep, rate, gap):
    factor = max(1.0 + 0.5 * rate, 0.0)
    return k * deep**1.5 * factor, -1.5 * k * deep**0.5 * factor, 0.5 * k * deep**1.5 * (factor > 0.0)


@of_one_contact
def falling(k, deep, rate, gap):
    return k * deep**1.5 * max(1.0 - deep / 1.5e-5, 0.0) ** 2, 0.0, 0.0


@of_one_contact
def infinite(k, deep, rate, gap):
    more = np.exp(1e3 * deep)
    return k * deep**1.5 + more - 1.0, -1.5 * k * deep**0.5 - 1e3 * more * (deep > 0.0), 0.0


@jit(LAW)
def incomplete(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    for i in range(gap.size):
        if gap[i] < 0.0:
            force[i] = params[i, 0] * (-gap[i]) ** 1.5
            d_gap[i] = -1.5 * params[i, 0] * (-gap[i]) ** 0.5
            d_rate[i] = 0.0


@jit(LAW)
def writing(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    for i in range(gap.size):
        approach = max(-gap[i], 0.0)
        state_old[i, 0] = approach
        state_new[i, 0] = approach
        force[i] = params[i, 0] * approach**1.5
        d_gap[i] = -1.5 * params[i, 0] * np.sqrt(approach)
        d_rate[i] = 0.0


@jit(LAW)
def endless(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    i = 0
    while i < gap.size + 1:
        force[:], d_gap[:], d_rate[:] = 0.0, 0.0, 0.0
        i -= 1 if gap.size > 0 else -1


@jit(LAW)
def far_beyond(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    for i in range(1 << 34):
        force[i] = 0.0


@jit(LAW, allocates=True)
def allocating(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    approach = np.maximum(-gap, 0.0)
    for i in range(gap.size):
        force[i] = params[i, 0] * approach[i] ** 1.5
        d_gap[i] = -1.5 * params[i, 0] * np.sqrt(approach[i])
        d_rate[i] = 0.0


@jit(LAW)
def neighbours(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    for i in range(gap.size):
        approach = max(-gap[i], 0.0)
        force[i] = params[0, 0] * approach**1.5
        d_gap[i] = -1.5 * params[0, 0] * np.sqrt(approach)
        d_rate[i] = 0.0


@njit(void(float64[:], float64[:], float64[:, :]))
def other_signature(gap, force, params):
    pass


def plain_python(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    force[:] = 0.0


@attrs.frozen
class Broken(Hertz):
    """A law with any of the kernels above."""

    name: ClassVar[str] = "broken"
    function = option(help="the kernel")
    state_size: int = option(0, help="columns of memory")

    def kernel(self):
        return self.function


@attrs.frozen
class OwnUnits(Hertz):
    """Hides a length of its own."""

    name: ClassVar[str] = "own_units"
    hertzian: ClassVar[bool] = True

    def build(self, pairs):
        return (pairs.hertz_factor / (1.0 + 1e-6 * pairs.curvature_b))[:, None].copy()


@attrs.frozen
class FollowsLoad(Hertz):
    """Follows the load and does not say so."""

    name: ClassVar[str] = "follows_load"
    discretisations: ClassVar[frozenset[str]] = frozenset({"resultant"})

    def build(self, pairs):
        return (pairs.hertz_factor * (1.0 if pairs.load is None else pairs.load / pairs.reference_load))[:, None].copy()


@attrs.frozen
class StandsOff(Hertz):
    """Stands off at any speed."""

    name: ClassVar[str] = "stands_off"
    discretisations: ClassVar[frozenset[str]] = frozenset({"resultant"})
    renewed: ClassVar[bool] = True

    def reach(self, pairs):
        return 1e-3 / pairs.curvature_b


@attrs.frozen
class FlatParameters(Hertz):
    name: ClassVar[str] = "flat"

    def build(self, pairs):
        return pairs.hertz_factor


@attrs.frozen
class NeedsOption(Hertz):
    name: ClassVar[str] = "needs_option"
    stiffness: float = option(unit="N/m3", help="required")


@attrs.define
class Thawed:
    name: ClassVar[str] = "thawed"
    discretisations: ClassVar[frozenset[str]] = frozenset({"resultant"})
    state_size: ClassVar[int] = 0
    dissipative: ClassVar[bool] = False
    factor: float = option(1.0, help="a number")

    build = Hertz.build
    kernel = Hertz.kernel
