"""K, C and mass of a linear model from a record of force and displacement, in one direction or two.

Notes
-----
F(w) = (K + j w C - w^2 m) X(w) + T(w) at the lines of a discrete Fourier transform of the whole record.  T(w) is a real polynomial
in j w: what the state at the beginning and the end of the record adds, so that it need not begin at rest nor hold whole periods.
With noise of both channels, residuals e = Z X + T - F have the variance s^2 = |Z|^2 sx^2 + sf^2; the sum of |e|^2 / s^2 is least,
s with Z, which takes the bias off that noise in X brings.  sx^2 and sf^2, sums of white noise and powers of 1 / w, are told by the residuals
themselves.  Tones in them (hum) are fitted beside T, with amplitudes that may grow or fall: a tone in X is Z at its frequency times the same,
but for a polynomial that T has.  Where residuals are not white then, each line's own score tells the covariance (White's sandwich, with
leverages: HC3), and a force that is not over at half the sampling rate widens it (``disturbed``).

References
----------
Pintelon, Schoukens, System Identification: A Frequency Domain Approach, Wiley 2012, chapters 6 (leakage), 9 (errors in variables).
MacKinnon, White, J. Econometrics 29 (1985) 305: covariance where variances differ.
"""

from __future__ import annotations

from collections.abc import Sequence

import attrs
import numpy as np

from raceway.errors import SceneError
from raceway.studies.fit.disturbances import TONES, aliased, spectrum, tone, uneven
from raceway.studies.fit.estimate import Estimate, Free, estimate, judged
from raceway.studies.fit.signals import Signals

#: Part of the force's power that lies below and above the band of lines that are used, and how far these reach beyond it.
_OUTSIDE, _WIDER = 5e-4, 0.5
#: Powers of j w in T; turns of weights and estimate, of them with all lines; steps of variances, and their change that ends them; powers
#: of 1 / w in noise.
_LEAKAGE, _TURNS, _ALL, _STEPS, _STAYS, _COLOURS = 5, 5, 2, 50, 1e-6, 3
#: Squared size of a line's force over the variance of its residual from which it tells Z.
_ABOVE = 9.0
#: Part of the force's power at lines of tones from which these are the force's own; noise at the lowest lines over its white part that is
#: told; least part of a line that its fit leaves it.
_TONAL, _COLOURED, _LEVER = 0.25, 2.0, 0.1
#: Intervals of a record may differ by this part: transforms need even ones.
_EVEN = 1e-3
_UNITS = {"K": "N/m", "C": "N s/m", "mass": "kg"}
_ONE, _TWO = (("y", "force"), ("y", "force_y"), ("z", "force_z")), (("y", "force_y"), ("z", "force_z"))


@attrs.frozen(eq=False)
class Lines:
    """Lines of a record: ``omega`` (n,) [rad/s]; force [N] and displacement [m], (n, d) each; ``axes``: the directions.

    ``places`` (n,) of the lines in the whole transform;  ``time`` (N,) [s] and ``signal`` (N, d) of the force [N] it is made of.
    """

    omega: np.ndarray
    force: np.ndarray
    displacement: np.ndarray
    axes: tuple[str, ...]
    places: np.ndarray
    time: np.ndarray
    signal: np.ndarray


def lines_of(signals: Signals) -> Lines:
    """Lines of the excited band.

    Raises
    ------
    SceneError
        A record without force and displacement along one axis, with uneven intervals, or without a force that changes.
    """
    columns, source = signals.columns, signals.source
    pairs = (
        _TWO
        if all(name in columns for pair in _TWO for name in pair)
        else next(([p] for p in _ONE if p[0] in columns and p[1] in columns), ())
    )
    if not pairs or ("force" in columns and "z" in columns and "y" in columns):
        raise SceneError.at(
            source, None,
            f"force and displacement along the same axis are needed: time_s, force_n, x_um, or force_y_n, force_z_n, y_um, z_um of two axes. It "
            f"was read ({signals.told()}); --map \"HEAD=ignore\" leaves a column out",
        )  # fmt: skip
    steps = np.diff(columns["time"])
    if np.ptp(steps) > 2.0 * _EVEN * steps.mean():
        text = f"intervals from {steps.min():.6g} to {steps.max():.6g} s: a Fourier transform needs even ones. Record at a fixed rate"
        raise SceneError.at(source, None, text)
    force = np.column_stack([columns[name] for _, name in pairs])
    moved = np.column_stack([columns[name] for name, _ in pairs])
    for values, name in zip((*force.T, *moved.T), [*(f for _, f in pairs), *(x for x, _ in pairs)], strict=True):
        if np.ptp(values) <= 1e-12 * np.abs(values).max():
            raise SceneError.at(source, None, f"'{name}' is constant: it tells nothing. Is it connected?")
    count = len(force)
    omega = 2.0 * np.pi * np.fft.rfftfreq(count, float(steps.mean()))
    spectra = [spectrum(values) for values in (force, moved)]
    power = np.cumsum((np.abs(spectra[0]) ** 2).sum(axis=1))
    low, high = (omega[int(np.searchsorted(power, part * power[-1]))] for part in (_OUTSIDE, 1.0 - _OUTSIDE))
    chosen = (omega > 0.0) & (omega >= (1.0 - _WIDER) * low) & (omega <= (1.0 + _WIDER) * high) & (omega < omega[-1])
    axes, time = tuple(name for name, _ in pairs), float(steps.mean()) * np.arange(count)
    return Lines(omega[chosen], spectra[0][chosen], spectra[1][chosen], axes, np.flatnonzero(chosen), time, force)


def free_parts(names: Sequence[str], lines: Lines, mass: float | None) -> list[Free]:
    """Free numbers of the linear model, by words K, C and mass; in two directions K stands for its four parts, or they by name.

    A mass that is None is free, too.

    Raises
    ------
    SceneError
        A word that the model does not have.
    """
    known = {word: [word] for word in _UNITS}
    if len(lines.axes) == 2:
        known |= {word: [f"{word.lower()}{a}{b}" for a in lines.axes for b in lines.axes] for word in ("K", "C")}
        known |= {part: [part] for word in ("K", "C") for part in known[word]}
    found: list[str] = []
    for word in (name.strip() for name in names if name.strip()):
        if word not in known:
            why = f"is no number of the linear model of a record of force and displacement: take {', '.join(known)}"
            raise SceneError.at("--free", word, why)
        found += [part for part in known[word] if part not in found]
    if not found:
        raise SceneError.at("--free", None, f"names no number: take {', '.join(known)}")
    if "mass" in found and mass is not None:
        raise SceneError.at("--mass", mass, "is free, too: a mass is either known or fitted")
    found += ["mass"] * (mass is None and "mass" not in found)
    omega = float(lines.omega.mean())
    size = float(np.linalg.norm(lines.force) / np.linalg.norm(lines.displacement))
    sizes = {"K": size, "C": size / omega, "mass": size / omega**2}
    return [
        Free(part, _UNITS[_word(part)], sizes["K"] if part in ("K", "kyy", "kzz") else 0.0, sizes[_word(part)])
        for part in found
    ]


def _word(part: str) -> str:
    return part if part in _UNITS else part[0].upper()


@attrs.define(eq=False)
class Linear:
    """Weighted residuals of the lines, ``raceway.studies.fit.estimate.Residuals``: free numbers, then the parts of T.

    Attributes
    ----------
    mass : where it is not free [kg];  noise : variances (2, k, d) of displacement and force at the lowest line, by power of 1 / w
    tones : frequencies of hum [rad/s];  remarks : what residuals and force show
    rest : e (n, d) at the end of the fit [N]
    excited : (n,) lines whose force is told from noise; the others, where Z stays ``before`` (n, d, d), tell noise and leakage alone
    """

    lines: Lines
    free: Sequence[Free]
    mass: float
    noise: np.ndarray
    rest: np.ndarray = attrs.field(factory=lambda: np.empty((0, 0)), init=False)
    excited: np.ndarray = attrs.field(factory=lambda: np.empty(0, bool), init=False)
    before: np.ndarray = attrs.field(factory=lambda: np.empty((0, 0, 0)), init=False)
    tones: tuple[float, ...] = ()
    remarks: list[str] = attrs.field(factory=list, init=False)
    slopes: np.ndarray = attrs.field(init=False)
    _parts: np.ndarray = attrs.field(init=False)

    def __attrs_post_init__(self) -> None:
        """Derivatives of Z by the free numbers (n, d, d, p); all lines count as excited."""
        self.excited = np.ones(len(self.lines.omega), bool)
        x, turns = 1j * self.lines.omega / self.lines.omega[-1], np.outer(self.lines.time, self.tones)
        grown = (self.lines.time / self.lines.time[-1])[:, None]
        waves = [wave * size for wave in (np.cos(turns), np.sin(turns)) for size in (1.0, grown)]
        self._parts = np.hstack([x[:, None] ** np.arange(_LEAKAGE), *(spectrum(one)[self.lines.places] for one in waves)])
        omega, d = self.lines.omega, len(self.lines.axes)
        powers = {"K": np.ones_like(omega) + 0j, "C": 1j * omega, "mass": -(omega**2) + 0j}
        self.slopes = np.zeros((len(omega), d, d, len(self.free)), complex)
        for k, one in enumerate(self.free):
            if one.name in ("K", "C", "mass"):
                for a in range(d):
                    self.slopes[:, a, a, k] = powers[one.name]
            else:
                a, b = (self.lines.axes.index(axis) for axis in one.name[1:])
                self.slopes[:, a, b, k] = powers[_word(one.name)]

    @property
    def colours(self) -> np.ndarray:
        """Spectra of noise (n, k), 1 at the lowest line."""
        return (self.lines.omega[0] / self.lines.omega[:, None]) ** np.arange(_COLOURS)

    @property
    def nuisance(self) -> list[Free]:
        """Parts of T and of tones, in sizes of the force."""
        size = float(np.abs(self.lines.force).max())
        return [Free(f"leakage {k} {axis}", "", 0.0, size) for axis in self.lines.axes for k in range(self._parts.shape[1])]

    def stiffness(self, at: np.ndarray) -> np.ndarray:
        """Z (n, d, d) at the free numbers."""
        z: np.ndarray = self.slopes @ at[: len(self.free)]
        if self.mass:
            z = z - self.mass * (self.lines.omega**2)[:, None, None] * np.eye(len(self.lines.axes))
        return z if self.excited.all() else np.where(self.excited[:, None, None], z, self.before)

    def tell_apart(self, at: np.ndarray) -> None:
        """Only lines whose force the noise does not hide tell Z from here on."""
        before = self.stiffness(at)
        excited = (np.abs(self.lines.force) ** 2 > _ABOVE * self.variance(at)).any(axis=1)
        self.before = before
        self.excited = excited if excited.any() else np.ones_like(excited)

    def apart(self, at: np.ndarray) -> np.ndarray:
        """e (n, d) [N]."""
        d, p = len(self.lines.axes), len(self.free)
        parts = self._parts @ at[p:].reshape(d, -1).T
        return np.einsum("nab,nb->na", self.stiffness(at), self.lines.displacement) + parts - self.lines.force

    def variance(self, at: np.ndarray) -> np.ndarray:
        """s^2 (n, d)."""
        moved, force = self.colours @ self.noise
        return np.asarray(np.einsum("nab,nb->na", np.abs(self.stiffness(at)) ** 2, moved) + force)

    def residuals(self, at: np.ndarray) -> np.ndarray:
        return _real(np.sqrt(2.0) * self.apart(at) / np.sqrt(self.variance(at)))

    def jacobian(self, at: np.ndarray) -> np.ndarray:
        e, s2, z = self.apart(at), self.variance(at), self.stiffness(at)
        d = len(self.lines.axes)
        basis = self.slopes * self.excited[:, None, None, None]
        slopes = np.einsum("nabp,nb->nap", basis, self.lines.displacement)
        widths = 2.0 * np.einsum("nab,nabp,nb->nap", z.conj(), basis, self.colours @ self.noise[0]).real
        columns = slopes / np.sqrt(s2)[..., None] - 0.5 * (e / s2**1.5)[..., None] * widths
        parts = np.einsum("nl,na,ab->nabl", self._parts, 1.0 / np.sqrt(s2), np.eye(d)).reshape(len(e), d, -1)
        whole = np.sqrt(2.0) * np.concatenate([columns, parts], axis=2)
        return np.concatenate([whole.real, whole.imag]).reshape(-1, whole.shape[2])


def fit_lines(lines: Lines, free: Sequence[Free], mass: float) -> tuple[Estimate, Linear]:
    """Free numbers with their intervals, and the model with the noise that it sees.

    Raises
    ------
    ConvergenceError
        The search finds no end.
    """
    alone = found, problem = _turned(lines, free, mass, ())
    while hum := tone(problem.apart(found.values), problem.variance(found.values), lines.omega):
        if len(problem.tones) == TONES or _of_force(lines, (*problem.tones, hum)) > _TONAL:
            found, problem = alone  # a model that misses the force itself does so at the lines that this has
            break
        found, problem = _turned(lines, free, mass, (*problem.tones, hum))
    problem.rest = problem.apart(found.values)
    for omega in sorted(problem.tones):
        hz = omega / 2.0 / np.pi
        problem.remarks.append(f"residual concentrated at {hz:.4g} Hz: a tone there (hum?) is fitted beside the model")
    return attrs.evolve(_disturbed(found, len(free), problem), free=tuple(free)), problem


def _of_force(lines: Lines, tones: Sequence[float]) -> float:
    """Part of the force's power at the lines of tones."""
    near = (np.abs(lines.omega[:, None] - np.array(tones)) < 1.5 * (lines.omega[1] - lines.omega[0])).any(axis=1)
    return float((np.abs(lines.force[near]) ** 2).sum() / (np.abs(lines.force) ** 2).sum())


def _turned(lines: Lines, free: Sequence[Free], mass: float, tones: tuple[float, ...]) -> tuple[Estimate, Linear]:
    """Estimate and variances in turns, beside tones of known frequencies [rad/s]."""
    d = len(lines.axes)
    problem = Linear(lines, free, mass, np.stack([np.zeros((_COLOURS, d)), np.ones((_COLOURS, d))]), tones)
    every = [*free, *problem.nuisance]
    for turn in range(_TURNS):  # linear at first, the force's noise alone: wherever it begins, it ends at one place
        found = estimate(problem, every, stated=False)
        problem.noise = _variances(problem, found.values)
        if turn >= _ALL:
            problem.tell_apart(found.values)
        every = [attrs.evolve(one, start=float(value)) for one, value in zip(every, found.values, strict=True)]
    return estimate(problem, every, stated=False), problem


def _variances(problem: Linear, at: np.ndarray) -> np.ndarray:
    """Variances (2, k, d) of displacement and force by which |e|^2 (n, d) is likeliest: exponential with the mean s^2."""
    z2, e2 = np.abs(problem.stiffness(at)) ** 2, np.abs(problem.apart(at)) ** 2
    n, d = e2.shape
    both = np.stack([z2, np.broadcast_to(np.eye(d), (n, d, d))])
    regressors = np.einsum("cnab,nk->nackb", both, problem.colours).reshape(n, d, -1)
    shares = regressors.mean(axis=(0, 1))
    found = np.full(shares.size, float(e2.mean())) / shares / shares.size
    for _ in range(_STEPS):
        mean = regressors @ found
        # Multiplicative steps of the likelihood's gradient: variances stay positive.
        up = np.einsum("nak,na->k", regressors, e2 / mean**2)
        down = np.einsum("nak,na->k", regressors, 1.0 / mean)
        step = np.sqrt(up / down)
        found = found * step
        if np.abs(step - 1.0).max() < _STAYS:
            break
    return np.asarray(found.reshape(2, _COLOURS, d))


def _disturbed(found: Estimate, count: int, problem: Linear) -> Estimate:
    """The free numbers alone, the parts of T taken out of the derivatives, where they are fitted whatever the numbers are.

    Residuals that are not white and a force that is folded back widen the intervals.
    """
    lines, variance = problem.lines, problem.variance(found.values)
    d, hz = len(lines.axes), lines.omega / 2.0 / np.pi
    j, t = found.jacobian[:, :count], found.jacobian[:, count:]
    basis = np.linalg.svd(t * [one.size for one in found.free[count:]], full_matrices=False)[0]
    slopes, scores = j - basis @ (basis.T @ j), None
    white = attrs.evolve(problem, noise=problem.noise * (np.arange(_COLOURS) == 0)[:, None]).variance(found.values)
    if (grows := float(np.sqrt((variance / white)[: max(len(hz) // 16, 1)].mean()))) > _COLOURED:
        text = f"noise grows toward low frequencies (1/f): at {hz[0]:.4g} Hz {grows:.2g} times its white part"
        problem.remarks.append(f"{text}; weights follow it")
    if off := uneven((found.residuals.reshape(2, -1, d) ** 2).sum(axis=0)):
        lever = 1.0 - (np.linalg.qr(found.jacobian)[0] ** 2).sum(axis=1)
        scores = (slopes * (found.residuals / np.maximum(lever, _LEVER))[:, None]).reshape(2, -1, count).sum(axis=0)
        text = f"residuals are not white: their power near {hz[off[0]]:.4g} Hz is {off[1]:.2g} times the mean"
        problem.remarks.append(f"{text}; intervals follow from each line's own")
    alone = judged(found.free[:count], found.values[:count], found.residuals, slopes, False, found.evaluations, scores)
    force, part = aliased(lines.signal, variance.min(axis=0))
    if not part:
        return alone
    problem.remarks.append(
        f"the force is not over at half the sampling rate ({0.5 / lines.time[1]:.4g} Hz), where it has {100.0 * part:.2g} % of its "
        "largest line: sampled without a filter, what lies beyond is folded back. Filter it, or sample faster"
    )
    moved = force[lines.places][:, None, :] * np.array([1.0, 1j])[:, None] * np.sqrt(2.0 / variance)[:, None, :]
    columns = np.einsum("nkb,ab->nakb", moved, np.eye(d)).reshape(len(hz), d, -1)
    return alone.with_shifts("aliasing", np.concatenate([columns.real, columns.imag]).reshape(-1, columns.shape[2]))


def _real(one: np.ndarray) -> np.ndarray:
    return np.concatenate([one.real, one.imag]).ravel()
