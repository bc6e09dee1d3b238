"""K, C and mass of a linear model from a record of force and displacement, in one direction or two.

F(w) = (K + j w C - w^2 m) X(w) + T(w) at the frequencies of a discrete Fourier transform of the full record.  T(w) is a real polynomial
in j w: the transient of the state at the beginning and the end of the record, which need not begin at rest nor hold full periods.
A measured velocity or acceleration stands for X times a power of j w; their values at both ends add as many negative powers to T.
With noise of both channels, residuals e = Z X + T - F have the variance s^2 = |Z|^2 sx^2 + sf^2; the sum of |e|^2 / s^2 is least,
s with Z, which removes the bias by noise in X.  sx^2 and sf^2, sums of white noise and powers of 1 / w, are determined by the residuals
themselves.  Tones in them (hum) are fitted beside T, with amplitudes that may grow or fall: a tone in X is Z at its frequency times the same,
but for a polynomial that T has.  Where residuals are not white then, each frequency's score determines the covariance (White's sandwich, with
leverages: HC3), and a force that is not over at half the sampling rate widens it.

Pintelon, Schoukens, System Identification: A Frequency Domain Approach, Wiley 2012, chapters 6 (leakage), 9 (errors in variables).
MacKinnon, White, J. Econometrics 29 (1985) 305: covariance where variances differ.
"""

from collections.abc import Sequence

import attrs
import numpy as np

from raceway import SceneError
from raceway_measure.fit.estimate import Estimate, Free, estimate, judged
from raceway_measure.fit.fitted import Fitted, Series, refuse_few
from raceway_measure.fit.response import FrequencyResponse
from raceway_measure.fit.signals import Signals
from raceway_measure.fit.spectra import TONES, Spectra, aliasing_error, largest_tone, spectra_of, spectrum_of, uneven_block

#: Powers of j w in T; iterations of weights and estimate, of them with all frequencies; steps of variances, and the change that ends them;
#: powers of 1 / w in noise.
_LEAKAGE, _ITERATIONS, _ALL, _STEPS, _CONVERGED, _COLOURS = 5, 5, 2, 50, 1e-6, 3
#: Squared force at a frequency over the variance of its residual from which it determines Z.
_ABOVE = 9.0
#: Part of the force's power at tones from which these are the force's; noise at the lowest frequencies over its white part that is
#: reported; least part of a residual that its leverage leaves.
_TONAL, _COLOURED, _LEVER = 0.25, 2.0, 0.1
#: Part of a record's force above which the residual of the model is reported.
_RESIDUAL = 0.1
_UNITS = {"K": "N/m", "C": "N s/m", "mass": "kg"}


def free_parts(names: Sequence[str], spectra: Spectra, mass: float | None) -> list[Free]:
    """Free numbers of the linear model, by words K, C and mass; in two directions K stands for its four parts, or they by name.

    A mass that is None is free, too.
    """
    words = {word: [word] for word in _UNITS}
    if len(spectra.axes) == 2:
        words |= {word: [f"{word.lower()}{a}{b}" for a in spectra.axes for b in spectra.axes] for word in ("K", "C")}
        words |= {part: [part] for word in ("K", "C") for part in words[word]}
    parts: list[str] = []
    for word in (name.strip() for name in names if name.strip()):
        if word not in words:
            why = f"is no number of the linear model of a record of force and displacement: use {', '.join(words)}"
            raise SceneError.at("--free", word, why)
        parts += [part for part in words[word] if part not in parts]
    if not parts:
        raise SceneError.at("--free", None, f"names no number: use {', '.join(words)}")
    if "mass" in parts and mass is not None:
        raise SceneError.at("--mass", mass, "is free, too: a mass is either known or fitted")
    parts += ["mass"] * (mass is None and "mass" not in parts)
    omega = float(spectra.omega.mean())
    size = float(np.linalg.norm(spectra.force) / np.linalg.norm(spectra.displacement))
    sizes = {"K": size, "C": size / omega, "mass": size / omega**2}
    return [Free(p, _UNITS[_word(p)], sizes["K"] if p in ("K", "kyy", "kzz") else 0.0, sizes[_word(p)]) for p in parts]


def _word(part: str) -> str:
    return part if part in _UNITS else part[0].upper()


@attrs.define(eq=False)
class LinearResiduals:
    """Weighted residuals of the spectra, ``raceway_measure.fit.estimate.Residuals``: free numbers, then the parts of T."""

    spectra: Spectra
    free: Sequence[Free]
    mass: float  # where it is not free [kg]
    noise: np.ndarray  # variances (2, k, d) of displacement and force at the lowest frequency, by power of 1 / w
    tones: tuple[float, ...] = ()  # frequencies of hum [rad/s]
    remarks: list[str] = attrs.field(factory=list, init=False)  # on residuals and force
    #: (n,) frequencies whose force stands out of the noise; the others, where Z stays ``before`` (n, d, d), determine noise
    #: and leakage alone
    excited: np.ndarray = attrs.field(init=False)
    before: np.ndarray = attrs.field(factory=lambda: np.empty((0, 0, 0)), init=False)
    slopes: np.ndarray = attrs.field(init=False)  # derivatives of Z by the free numbers (n, d, d, p)
    _parts: np.ndarray = attrs.field(init=False)

    def __attrs_post_init__(self) -> None:
        omega, axes, time = self.spectra.omega, self.spectra.axes, self.spectra.time
        self.excited = np.ones(len(omega), bool)
        x, turns = 1j * omega / omega[-1], np.outer(time, self.tones)
        growth = (time / time[-1:])[:, None]
        waves = [wave * size for wave in (np.cos(turns), np.sin(turns)) for size in (1.0, growth)] if len(time) else []
        hum = [spectrum_of(wave)[self.spectra.indices] for wave in waves]
        powers_of_x = x[:, None] ** np.arange(-self.spectra.order, _LEAKAGE if len(time) else 0)
        self._parts = np.hstack([powers_of_x / np.abs(powers_of_x[:1]).clip(1.0), *hum])
        powers = {"K": np.ones_like(omega) + 0j, "C": 1j * omega, "mass": -(omega**2) + 0j}
        self.slopes = np.zeros((len(omega), len(axes), len(axes), len(self.free)), complex)
        for k, number in enumerate(self.free):
            same = [(a, a) for a in range(len(axes))]
            pairs = same if number.name in powers else [(axes.index(number.name[1]), axes.index(number.name[2]))]
            for a, b in pairs:
                self.slopes[:, a, b, k] = powers[_word(number.name)]

    @property
    def colours(self) -> np.ndarray:
        """Spectra of noise of displacement and force (2, n, k), 1 at the lowest frequency."""
        powers = np.arange(_COLOURS) + 2 * self.spectra.order * np.array([[1], [0]])
        return np.asarray((self.spectra.omega[0] / self.spectra.omega[:, None]) ** powers[:, None])

    @property
    def nuisance(self) -> list[Free]:
        """Parts of T and of tones, in sizes of the force."""
        size, count = float(np.abs(self.spectra.force).max()), self._parts.shape[1]
        return [Free(f"leakage {k} {axis}", "", 0.0, size) for axis in self.spectra.axes for k in range(count)]

    def stiffness(self, at: np.ndarray) -> np.ndarray:
        """Z (n, d, d) at the free numbers."""
        z: np.ndarray = self.slopes @ at[: len(self.free)]
        if self.mass:
            z = z - self.mass * (self.spectra.omega**2)[:, None, None] * np.eye(len(self.spectra.axes))
        return z if self.excited.all() else np.where(self.excited[:, None, None], z, self.before)

    def select_excited(self, at: np.ndarray) -> None:
        """From here on only frequencies whose force the noise does not hide determine Z."""
        self.before = self.stiffness(at)
        visible = (np.abs(self.spectra.force) ** 2 > _ABOVE * self.variance(at)).any(axis=1)
        self.excited = visible if visible.any() else np.ones_like(visible)

    def unweighted(self, at: np.ndarray) -> np.ndarray:
        """Residuals e (n, d) [N]."""
        d, p = len(self.spectra.axes), len(self.free)
        parts = self._parts @ at[p:].reshape(d, -1).T
        return np.einsum("nab,nb->na", self.stiffness(at), self.spectra.displacement) + parts - self.spectra.force

    def variance(self, at: np.ndarray) -> np.ndarray:
        """s^2 (n, d)."""
        displacement, force = self.colours @ self.noise
        return np.asarray(np.einsum("nab,nb->na", np.abs(self.stiffness(at)) ** 2, displacement) + force)

    def residuals(self, at: np.ndarray) -> np.ndarray:
        e = np.sqrt(2.0) * self.unweighted(at) / np.sqrt(self.variance(at))
        return np.concatenate([e.real, e.imag]).ravel()

    def jacobian(self, at: np.ndarray) -> np.ndarray:
        e, s2, z = self.unweighted(at), self.variance(at), self.stiffness(at)
        d = len(self.spectra.axes)
        basis = self.slopes * self.excited[:, None, None, None]
        slopes = np.einsum("nabp,nb->nap", basis, self.spectra.displacement)
        widths = 2.0 * np.einsum("nab,nabp,nb->nap", z.conj(), basis, self.colours[0] @ self.noise[0]).real
        columns = slopes / np.sqrt(s2)[..., None] - 0.5 * (e / s2**1.5)[..., None] * widths
        parts = np.einsum("nl,na,ab->nabl", self._parts, 1.0 / np.sqrt(s2), np.eye(d)).reshape(len(e), d, -1)
        return _real_and_imaginary(np.sqrt(2.0) * np.concatenate([columns, parts], axis=2))


def _real_and_imaginary(columns: np.ndarray) -> np.ndarray:
    """Columns (2 n d, p) of complex ones (n, d, p), as residuals are ordered."""
    return np.concatenate([columns.real, columns.imag]).reshape(-1, columns.shape[2])


def _fit_spectra(spectra: Spectra, free: Sequence[Free], mass: float) -> tuple[Estimate, LinearResiduals, np.ndarray]:
    """Free numbers with their intervals, the model with its noise, and its residuals e (n, d) [N]."""
    without_tones = answer, problem = _iterate(spectra, free, mass, ())
    while len(spectra.time) and (
        hum := largest_tone(problem.unweighted(answer.values), problem.variance(answer.values), spectra.omega)
    ):
        tones = (*problem.tones, hum)
        near = (np.abs(spectra.omega[:, None] - np.array(tones)) < 1.5 * (spectra.omega[1] - spectra.omega[0])).any(axis=1)
        if len(tones) > TONES or (np.abs(spectra.force[near]) ** 2).sum() > _TONAL * (np.abs(spectra.force) ** 2).sum():
            answer, problem = without_tones  # a model that misses the force itself does so at the force's frequencies
            break
        answer, problem = _iterate(spectra, free, mass, tones)
    residuals = problem.unweighted(answer.values)
    for omega in sorted(problem.tones):
        hz = omega / 2.0 / np.pi
        problem.remarks.append(f"residual concentrated at {hz:.4g} Hz: a tone there (hum?) is fitted beside the model")
    return attrs.evolve(_without_nuisance(answer, len(free), problem), free=tuple(free)), problem, residuals


def _iterate(
    spectra: Spectra, free: Sequence[Free], mass: float, tones: tuple[float, ...]
) -> tuple[Estimate, LinearResiduals]:
    """Estimate and variances by turns, beside tones of known frequencies [rad/s]."""
    d = len(spectra.axes)
    problem = LinearResiduals(spectra, free, mass, np.stack([np.zeros((_COLOURS, d)), np.ones((_COLOURS, d))]), tones)
    numbers = [*free, *problem.nuisance]
    for iteration in range(_ITERATIONS):  # linear at first, the force's noise alone: the end does not depend on the start
        answer = estimate(problem, numbers, stated=False)
        # Variances (2, k, d) of displacement and force by which
        z2, e2 = np.abs(problem.stiffness(answer.values)) ** 2, np.abs(problem.unweighted(answer.values)) ** 2
        n, d = e2.shape
        both = np.stack([z2, np.broadcast_to(np.eye(d), (n, d, d))])
        regressors = np.einsum("cnab,cnk->nackb", both, problem.colours).reshape(n, d, -1)
        shares = regressors.mean(axis=(0, 1))
        variances = np.full(shares.size, float(e2.mean())) / shares / shares.size
        for _ in range(_STEPS):
            mean = regressors @ variances
            # Multiplicative steps of the likelihood's gradient: variances stay positive.
            up = np.einsum("nak,na->k", regressors, e2 / mean**2)
            down = np.einsum("nak,na->k", regressors, 1.0 / mean)
            step = np.sqrt(up / down)
            variances = variances * step
            if np.abs(step - 1.0).max() < _CONVERGED:
                break
        problem.noise = np.asarray(variances.reshape(2, _COLOURS, d))
        if iteration >= _ALL:
            problem.select_excited(answer.values)
        numbers = [attrs.evolve(n, start=float(value)) for n, value in zip(numbers, answer.values, strict=True)]
    return estimate(problem, numbers, stated=False), problem


def _without_nuisance(answer: Estimate, count: int, problem: LinearResiduals) -> Estimate:
    """The free numbers alone, the parts of T taken out of the derivatives, where they are fitted whatever the numbers are.

    Residuals that are not white and a force that is folded back widen the intervals.
    """
    spectra, variance = problem.spectra, problem.variance(answer.values)
    d, hz = len(spectra.axes), spectra.omega / 2.0 / np.pi
    j, t = answer.jacobian[:, :count], answer.jacobian[:, count:]
    slopes, scores = j, None
    if t.size:
        basis = np.linalg.svd(t * [number.size for number in answer.free[count:]], full_matrices=False)[0]
        slopes = j - basis @ (basis.T @ j)
    white = attrs.evolve(problem, noise=problem.noise * (np.arange(_COLOURS) == 0)[:, None]).variance(answer.values)
    if (growth := float(np.sqrt((variance / white)[: max(len(hz) // 16, 1)].mean()))) > _COLOURED:
        text = f"noise grows toward low frequencies (1/f): at {hz[0]:.4g} Hz {growth:.2g} times its white part"
        problem.remarks.append(f"{text}; weights follow it")
    if largest := uneven_block((answer.residuals.reshape(2, -1, d) ** 2).sum(axis=0)):
        lever = 1.0 - (np.linalg.qr(answer.jacobian)[0] ** 2).sum(axis=1)
        scores = (slopes * (answer.residuals / np.maximum(lever, _LEVER))[:, None]).reshape(2, -1, count).sum(axis=0)
        text = f"residuals are not white: their power near {hz[largest[0]]:.4g} Hz is {largest[1]:.2g} times the mean"
        problem.remarks.append(f"{text}; intervals follow from each line's own")
    alone = judged(answer.free[:count], answer.values[:count], answer.residuals, slopes, False, answer.evaluations, scores)
    force, share = aliasing_error(spectra.signal, variance.min(axis=0)) if len(spectra.signal) else (spectra.signal, 0.0)
    if not share:
        return alone
    problem.remarks.append(
        f"the force is not over at half the sampling rate ({0.5 / spectra.time[1]:.4g} Hz), where it has {100.0 * share:.2g} % of its "
        "largest line: without a filter, higher frequencies are aliased. Filter the signal, or sample faster"
    )
    alias_shift = force[spectra.indices][:, None, :] * np.array([1.0, 1j])[:, None] * np.sqrt(2.0 / variance)[:, None, :]
    columns = np.einsum("nkb,ab->nakb", alias_shift, np.eye(d)).reshape(len(hz), d, -1)
    return alone.with_shifts("aliasing", _real_and_imaginary(columns))


def fit_record(record: Signals | FrequencyResponse, names: list[str], mass: float | None) -> Fitted:
    """K, C and mass of a linear model from a record of force and displacement, or their frequency response.

    mass : where it is not free [kg]; None: it is free, named or not
    """
    if mass is not None and mass < 0.0:
        raise SceneError.at("mass", mass, "must be at least 0 kg")
    if isinstance(record, Signals):
        spectra = spectra_of(record)
    else:
        omega, receptance, empty = 2.0 * np.pi * record.hz, record.receptance[:, None], np.empty(0)
        spectra = Spectra(omega, np.ones_like(receptance), receptance, ("y",), np.arange(len(omega)), empty, empty)
    free = free_parts(names, spectra, mass)
    refuse_few(2 * spectra.force.size, len(free) + len(spectra.axes), record.source)
    answer, model, residuals = _fit_spectra(spectra, free, mass or 0.0)
    words, notes = {_word(number.name) for number in free}, [*getattr(record, "notes", ())]
    if mass is None and not any("mass" in name for name in names):
        notes.append("mass was neither free nor given: it is free, too. Set it by --mass; 0 where no mass moves")
    if absent := [word for word in ("K", "C") if word not in words]:
        notes.append(f"{' and '.join(absent)} {'are' if len(absent) > 1 else 'is'} not free: taken as 0")
    notes += model.remarks
    part = float(np.linalg.norm(residuals[model.excited]) / np.linalg.norm(spectra.force[model.excited]))
    if part > _RESIDUAL:
        missing = " and ".join([*absent, *(["mass"] if mass is not None else [])])
        remedy = f"{f'free {missing} or ' if missing else ''}cut the record to frequencies below the next resonance"
        notes.append(f"the model leaves {100.0 * part:.2g} % of the force (root mean square): {remedy}")
    for number, value, half in zip(answer.free, answer.values, answer.half, strict=True):
        if number.name in ("K", "mass", "kyy", "kzz") and value + half < 0.0:
            question = "check the signs of force and displacement, and the mass"
            notes.append(f"{number.name} is negative: {question}")
    title = f"F = K x + C x' + m x'', {spectra.omega[0] / 2.0 / np.pi:.4g} to {spectra.omega[-1] / 2.0 / np.pi:.4g} Hz"
    # F / x over frequency beside the model's, per axis. Of two axes the force that moves the other one is taken off, and so
    # is what beginning and end of the record add.
    spectra, visible = model.spectra, model.excited
    series: list[Series] = []
    hz, variance = spectra.omega[visible] / 2.0 / np.pi, model.variance(answer.values)[visible]
    stiffness, slopes = model.stiffness(answer.values)[visible], model.slopes[visible]
    for k, axis in enumerate(spectra.axes):
        displacement = spectra.displacement[visible, k]
        data = stiffness[:, k, k] - residuals[visible, k] / displacement
        error = np.sqrt(0.5 * variance[:, k]) / np.abs(displacement)
        for word, component in (("real", np.real), ("imaginary", np.imag)):
            name, band = f"F / x along {axis}, {word} part", answer.half_widths(component(slopes[:, k, k]))
            model_values = component(stiffness[:, k, k])
            series.append(Series(name, "N/m", "frequency", "Hz", hz, component(data), model_values, error, band))
    dynamic_stiffness = 1.0 / (series[0].measured + 1j * series[1].measured)
    response = FrequencyResponse(record.source, series[0].x, dynamic_stiffness) if isinstance(record, Signals) else record
    return Fitted(title, record.source, "record", False, answer, tuple(series), (), tuple(notes), response)
