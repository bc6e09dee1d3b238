"""The conformance suite of excitations."""

from __future__ import annotations

from math import radians
from typing import TYPE_CHECKING

import numpy as np

from raceway.testing.suite import Suite, check_class, check_kernel, duty, require

if TYPE_CHECKING:
    from raceway.framework.contracts import Excitation

_SAMPLES = 4096
_SAMPLED = 1e-4


def sampled(excitation: Excitation, times: np.ndarray, repeats: int = 1) -> np.ndarray:
    """(n, 5) the force at times (n,), into an array that is full of NaN before."""
    from raceway.testing.compiled import sample_force

    out = np.full((len(times), 5), np.nan)
    params = np.ascontiguousarray(excitation.parameters(), dtype=float)
    sample_force(repeats, excitation.kernel(), params, np.ascontiguousarray(times, dtype=float), out)
    return out


def fundamental(excitation: Excitation) -> np.ndarray:
    """(5,) complex line at ``frequency_hz`` over one period: the force is Re(line e^{jwt}) and other lines."""
    times = (excitation.period_s or 0.0) * np.arange(_SAMPLES) / _SAMPLES
    kernel = np.exp(-2j * np.pi * excitation.frequency_hz * times)
    return 2.0 * (kernel[:, None] * sampled(excitation, times)).mean(axis=0)


class ExcitationSuite(Suite):
    """Duties of ``raceway.framework.contracts.Excitation``."""

    kind = "excitation"

    @duty("attributes: frequency_hz, period_s, amplitude_n, sense, options")
    def test_declaration(self, excitation: Excitation) -> None:
        check_class("excitation", excitation)
        frequency, period, amplitude = excitation.frequency_hz, excitation.period_s, excitation.amplitude_n
        require(np.isfinite(frequency) and frequency > 0.0, f"`frequency_hz` = {frequency!r} must be finite and above 0")
        require(
            np.isfinite(amplitude) and amplitude >= 0.0, f"`amplitude_n` = {amplitude!r} must be finite and not negative"
        )
        require(excitation.sense in (-1, 0, 1), f"`sense` = {excitation.sense!r} must be +1, -1 or 0")
        if period is not None:
            require(np.isfinite(period) and period > 0.0, f"`period_s` = {period!r} must be above 0, or None")
            turns = period * frequency
            require(
                abs(turns - round(turns)) < 1e-9 * turns and turns > 0.5,
                f"`period_s` holds {turns:g} cycles of `frequency_hz`; it must be a whole number",
            )

    @duty("parameters() returns (k,) finite numbers")
    def test_parameters(self, excitation: Excitation) -> None:
        params = np.asarray(excitation.parameters())
        require(params.ndim == 1 and params.dtype == np.float64, f"parameters() is {params.dtype} of shape {params.shape}")
        require(np.isfinite(params).all(), "parameters() holds values that are not finite")

    @duty("kernel() is compiled with @jit(FORCE)")
    def test_signature(self, excitation: Excitation) -> None:
        from raceway.core.signatures import FORCE

        check_kernel(excitation.kernel(), FORCE, "FORCE")

    @duty("all five components are overwritten, in any order of times, the parameters untouched")
    def test_overwrites(self, excitation: Excitation) -> None:
        times = np.random.default_rng(1).uniform(0.0, 3.0 / excitation.frequency_hz, 200)
        forward, backward = sampled(excitation, times), sampled(excitation, times[::-1])
        require(
            not np.isnan(forward).any(),
            f"components {sorted(set(np.argwhere(np.isnan(forward))[:, 1]))} are not overwritten",
        )
        require(np.array_equal(forward, backward[::-1]), "the force depends on what was asked before")
        params = np.ascontiguousarray(excitation.parameters(), dtype=float)
        before, out = params.copy(), np.zeros(5)
        excitation.kernel()(0.1 / excitation.frequency_hz, params, out)
        require(np.array_equal(before, params), "the kernel changes its parameters")

    @duty("finite at any time")
    def test_extreme_times(self, excitation: Excitation) -> None:
        times = np.array([0.0, -0.0, 5e-324, 1e-12, 1.0, 1e3, 1e6, -1e-3])
        force = sampled(excitation, times)
        require(np.isfinite(force).all(), f"not finite at t = {times[~np.isfinite(force).all(axis=1)]} s")

    @duty("the kernel allocates no memory")
    def test_no_allocation(self, excitation: Excitation) -> None:
        from raceway.testing.allocation import counted
        from raceway.testing.compiled import sample_force

        times, out = np.linspace(0.0, 1.0, 100), np.zeros((100, 5))
        params, kernel = np.ascontiguousarray(excitation.parameters(), dtype=float), excitation.kernel()
        blocks = []
        for repeats in (1, 11):
            with counted() as block:
                sample_force(repeats, kernel, params, times, out)
            blocks.append(block.blocks)
        require(blocks[1] == blocks[0], f"a call allocates {(blocks[1] - blocks[0]) / 1000:g} blocks of memory")

    @duty("the force repeats itself after `period_s`")
    def test_period(self, excitation: Excitation) -> str:
        if excitation.period_s is None:
            return "not periodic"
        times = np.random.default_rng(2).uniform(0.0, 1.0, 300) * excitation.period_s
        first, later = sampled(excitation, times), sampled(excitation, times + 7.0 * excitation.period_s)
        # Rounding of the phase after seven periods, with a hundred for fast harmonics.
        wrong = np.abs(later - first).max() / max(np.abs(first).max(), 1e-300)
        require(wrong < 1e-10, f"after seven periods it differs by {wrong:.2g} of its largest value")
        return ""

    @duty("the line at `frequency_hz` has the amplitude `amplitude_n`")
    def test_amplitude(self, excitation: Excitation) -> str:
        if excitation.period_s is None:
            return "not periodic"
        line = fundamental(excitation)[:3]
        major = np.linalg.svd(np.array([line.real, line.imag]), compute_uv=False)[0]
        declared = excitation.amplitude_n
        # A force that is sampled 360 times a turn and joined by straight lines loses 2.5e-5 of its line.
        require(
            abs(major - declared) <= _SAMPLED * max(major, declared),
            f"`amplitude_n` = {declared:.6g} N; its line at {excitation.frequency_hz:g} Hz has {major:.6g} N",
        )
        return ""

    @duty("the line at `frequency_hz` turns as `sense` says: forward, backward, or not at all")
    def test_sense(self, excitation: Excitation) -> str:
        if excitation.period_s is None:
            return "not periodic"
        line = fundamental(excitation)[:3]
        forward, backward = abs(line[1] + 1j * line[2]), abs(line[1] - 1j * line[2])
        size = np.abs(line).max()
        found = 0 if abs(forward - backward) <= _SAMPLED * size else (1 if forward > backward else -1)
        require(found == excitation.sense, f"`sense` = {excitation.sense}, but the force turns with sense {found}")
        if excitation.sense == 0:
            minor = np.linalg.svd(np.array([line.real, line.imag]), compute_uv=False)[1]
            require(minor <= _SAMPLED * size, "`sense` = 0, but the force leaves its direction")
        return ""

    @duty("direction and phase are those of the options direction_deg and phase_lag_deg, where there are such")
    def test_direction_and_phase(self, excitation: Excitation) -> str:
        if excitation.period_s is None:
            return "not periodic"
        direction, lag = (getattr(excitation, word, None) for word in ("direction_deg", "phase_lag_deg"))
        if lag is None and direction is None:
            return "neither is an option"
        line, amplitude = fundamental(excitation)[:3], excitation.amplitude_n
        along = line[1]
        if excitation.sense == 0:
            angle = radians(direction or 0.0)
            along = line[1] * np.cos(angle) + line[2] * np.sin(angle)
            across = np.sqrt(max(np.sum(np.abs(line) ** 2) - abs(along) ** 2, 0.0))
            require(across <= 1e-7 * amplitude, f"{across:.3g} N act across `direction_deg` = {direction}")
        if lag is not None:
            wanted = amplitude * np.exp(-1j * radians(lag))
            off = np.degrees(np.angle(along / wanted)) if amplitude else 0.0
            require(abs(off) < 1e-6, f"the force lags by {lag - off:.6g} deg, `phase_lag_deg` = {lag:g}")
        return ""
