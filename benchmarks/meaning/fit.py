"""Intervals of fits where noise is not white, and where numbers that are not free are off by what is stated of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from benchmarks.evidence import Row
from raceway.front.evolve import evolve
from raceway.front.run import run
from raceway.scene.catalogue import catalogue
from raceway.studies.fit.fitted import Fitted
from raceway.studies.fit.front import fit
from raceway.testing import b7206c
from validation.shaker import hammer_record, record

COMMAND = "python -m benchmarks.meaning fit"
_SEEDS = 40
#: Share of intervals at 95 % that hold the true number.
_LEAST = 0.90
_TRUE = {"K": 5e7, "C": 800.0, "mass": 2.0}
_ANGLE, _LOADS = "bearing.contact_angle_deg", (400.0, 900.0, 1800.0, 2800.0)
#: Half-width over the median error that a normal distribution has, and what is more than wide.
_NORMAL, _WIDE = 2.9, 8.0

Signals = dict[str, np.ndarray]


def rows() -> list[Row]:
    found = [*_tables()]
    for what, made in _RECORDS.items():
        fits = [fit(made(seed), free="K,C,mass") for seed in range(_SEEDS)]
        found += [row for name, true in _TRUE.items() for row in _covered(f"record, {what}", name, true, fits)]
    return found


def _hum(size: float, white: bool) -> Callable[[int], Signals]:
    """50 Hz in both channels, of this part of their root mean squares; with 40 dB of white noise or none."""

    def made(seed: int) -> Signals:
        one, random = record(*_TRUE.values(), seed, 40.0 if white else 300.0), np.random.default_rng(1000 + seed)
        for name in ("force_n", "x_m"):
            wave = np.cos(2.0 * np.pi * 50.0 * one["time_s"] + random.uniform(0.0, 2.0 * np.pi))
            one[name] = one[name] + size * np.sqrt(2.0) * one[name].std() * wave
        return one

    return made


def _pink(seed: int) -> Signals:
    """40 dB of noise with the power 1 / f in both channels, cut from longer signals."""
    one, random = record(*_TRUE.values(), seed, 300.0), np.random.default_rng(1000 + seed)
    count = len(one["time_s"])
    frequency = np.maximum(np.arange(4 * count + 1), 1)
    for name in ("force_n", "x_m"):
        noise = np.fft.irfft(np.fft.rfft(random.standard_normal(8 * count)) / np.sqrt(frequency))[:count]
        one[name] = one[name] + 0.01 * one[name].std() * (noise - noise.mean()) / noise.std()
    return one


_RECORDS: dict[str, Callable[[int], Signals]] = {
    "hum of 50 Hz alone, 0.1 of the signals": _hum(0.1, False),
    "hum of 50 Hz, 0.1 of the signals, and 40 dB of white noise": _hum(0.1, True),
    "1/f noise of 40 dB": _pink,
    "4 hammer pulses of 0.25 to 0.45 ms at 8 kHz without a filter, 40 dB": lambda seed: hammer_record(*_TRUE.values(), seed),
}


def _tables() -> Iterator[Row]:
    """Angle of 17 deg from kxx of bearings whose grooves are off as the catalogue says; the scene has the catalogue's."""
    scatter = next(one.scatter for one in catalogue()["B7206C"].facts if one.key == "conformity_inner")
    scene, random = b7206c(load={"axial": 1000.0}), np.random.default_rng(7)
    alike, apart = ([_fitted(scene, scatter, random, together) for _ in range(_SEEDS)] for together in (True, False))
    yield from _covered("kxx at 4 loads, grooves off by their stated scatter, both alike", _ANGLE, 17.0, alike)
    yield from _covered("kxx at 4 loads, grooves off by their stated scatter, each by itself", _ANGLE, 17.0, apart)


def _fitted(scene: dict, scatter: float, random: np.random.Generator, together: bool) -> Fitted:
    off = np.full(2, random.standard_normal()) if together else random.standard_normal(2)
    inner, outer = 0.522 * (1.0 + scatter * off)
    made = {
        **scene,
        "bearing": {**scene["bearing"], "contact_angle_deg": 17.0, "conformity_inner": inner, "conformity_outer": outer},
    }
    exact = np.array([run(evolve(made, f"load.axial={axial}")).stiffness[0, 0] for axial in _LOADS])
    error = 0.001 * exact
    data = {
        "load.axial [N]": _LOADS,
        "kxx [N/m]": exact + error * random.standard_normal(4),
        "kxx error [N/m]": 1.96 * error,
    }
    return fit(data, scene, _ANGLE)


def _covered(what: str, name: str, true: float, fits: list[Fitted]) -> Iterator[Row]:
    off = np.array([abs(one[name] - true) for one in fits])
    half = np.array([one.half_width(name) for one in fits])
    share, wide = float((off <= half).mean()), float(np.median(half) / np.median(off))
    note = f"median error {100.0 * np.median(off) / true:.2g} %, half-width {100.0 * np.median(half) / true:.2g} %"
    yield Row(
        f"{what}: share of true {name} within the stated 95 %, {len(fits)} seeds",
        share,
        "0.90 to 1.00",
        share >= _LEAST,
        COMMAND,
        note,
    )
    text = f"{what}: half-width of {name} over the median error (normal: {_NORMAL:g})"
    yield Row(text, wide, f"at most {_WIDE:g}", wide <= _WIDE, COMMAND)
