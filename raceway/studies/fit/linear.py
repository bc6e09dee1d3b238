"""K, C and mass of a linear model from a record of force and displacement, in one direction or two.

Notes
-----
F(w) = (K + j w C - w^2 m) X(w) + T(w) at the lines of a discrete Fourier transform of the whole record.  T(w) is a real polynomial
in j w: what the state at the beginning and the end of the record adds, so that it need not begin at rest nor hold whole periods.
With white noise of both channels, residuals e = Z X + T - F have the variance s^2 = |Z|^2 sx^2 + sf^2; the sum of |e|^2 / s^2 is least,
s with Z, which takes the bias off that noise in X brings.  sx and sf are told by the residuals themselves.

References
----------
Pintelon, Schoukens, System Identification: A Frequency Domain Approach, Wiley 2012, chapters 6 (leakage), 9 (errors in variables).
"""

from __future__ import annotations

from collections.abc import Sequence

import attrs
import numpy as np

from raceway.errors import SceneError
from raceway.studies.fit.estimate import Estimate, estimate, judged
from raceway.studies.fit.free import Free
from raceway.studies.measured.signals import Signals

#: Part of the force's power that lies below and above the band of lines that are used, and how far these reach beyond it.
_OUTSIDE, _WIDER = 5e-4, 0.5
#: Powers of j w in T; turns of weights and estimate, of them with all lines; steps of variances, and their change that ends them.
_LEAKAGE, _TURNS, _ALL, _STEPS, _STAYS = 3, 5, 2, 50, 1e-6
#: Squared size of a line's force over the variance of its residual from which it tells Z.
_ABOVE = 9.0
#: Intervals of a record may differ by this part: transforms need even ones.
_EVEN = 1e-3
_UNITS = {"K": "N/m", "C": "N s/m", "mass": "kg"}
_ONE, _TWO = (("y", "force"), ("y", "force_y"), ("z", "force_z")), (("y", "force_y"), ("z", "force_z"))


@attrs.frozen(eq=False)
class Lines:
    """Lines of a record: ``omega`` (n,) [rad/s]; force [N] and displacement [m], (n, d) each; ``axes``: the directions."""

    omega: np.ndarray
    force: np.ndarray
    displacement: np.ndarray
    axes: tuple[str, ...]


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
    spectra = [np.fft.rfft(values - values.mean(axis=0), axis=0) / count for values in (force, moved)]
    power = np.cumsum((np.abs(spectra[0]) ** 2).sum(axis=1))
    low, high = (omega[int(np.searchsorted(power, part * power[-1]))] for part in (_OUTSIDE, 1.0 - _OUTSIDE))
    chosen = (omega > 0.0) & (omega >= (1.0 - _WIDER) * low) & (omega <= (1.0 + _WIDER) * high) & (omega < omega[-1])
    return Lines(omega[chosen], spectra[0][chosen], spectra[1][chosen], tuple(name for name, _ in pairs))


def free_parts(names: Sequence[str], lines: Lines, mass: float) -> list[Free]:
    """Free numbers of the linear model, by words K, C and mass; in two directions K stands for its four parts, or they by name.

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
    if "mass" in found and mass:
        raise SceneError.at("--mass", mass, "is free, too: a mass is either known or fitted")
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
    mass : where it is not free [kg];  noise : variances (2, d) of displacement and force of a line
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
    _basis: np.ndarray = attrs.field(init=False)

    def __attrs_post_init__(self) -> None:
        """Derivatives of Z by the free numbers (n, d, d, p); all lines count as excited."""
        self.excited = np.ones(len(self.lines.omega), bool)
        omega, d = self.lines.omega, len(self.lines.axes)
        powers = {"K": np.ones_like(omega) + 0j, "C": 1j * omega, "mass": -(omega**2) + 0j}
        self._basis = np.zeros((len(omega), d, d, len(self.free)), complex)
        for k, one in enumerate(self.free):
            if one.name in ("K", "C", "mass"):
                for a in range(d):
                    self._basis[:, a, a, k] = powers[one.name]
            else:
                a, b = (self.lines.axes.index(axis) for axis in one.name[1:])
                self._basis[:, a, b, k] = powers[_word(one.name)]

    @property
    def nuisance(self) -> list[Free]:
        """Parts of T, in sizes of the force."""
        size = float(np.abs(self.lines.force).max())
        return [Free(f"leakage {power} {axis}", "", 0.0, size) for axis in self.lines.axes for power in range(_LEAKAGE)]

    def stiffness(self, at: np.ndarray) -> np.ndarray:
        """Z (n, d, d) at the free numbers."""
        z: np.ndarray = self._basis @ at[: len(self.free)]
        if self.mass:
            z = z - self.mass * (self.lines.omega**2)[:, None, None] * np.eye(len(self.lines.axes))
        return z if self.excited.all() else np.where(self.excited[:, None, None], z, self.before)

    def tell_apart(self, at: np.ndarray) -> None:
        """Only lines whose force the noise does not hide tell Z from here on."""
        before = self.stiffness(at)
        excited = (np.abs(self.lines.force) ** 2 > _ABOVE * self.variance(at)).any(axis=1)
        self.before = before
        self.excited = excited if excited.any() else np.ones_like(excited)

    def leakage(self) -> np.ndarray:
        """(n, powers): (j w / w_largest)^k."""
        x = 1j * self.lines.omega / self.lines.omega[-1]
        return np.stack([x**power for power in range(_LEAKAGE)], axis=1)

    def apart(self, at: np.ndarray) -> np.ndarray:
        """e (n, d) [N]."""
        d, p = len(self.lines.axes), len(self.free)
        parts = self.leakage() @ at[p:].reshape(d, _LEAKAGE).T
        return np.einsum("nab,nb->na", self.stiffness(at), self.lines.displacement) + parts - self.lines.force

    def variance(self, at: np.ndarray) -> np.ndarray:
        """s^2 (n, d)."""
        return np.asarray((np.abs(self.stiffness(at)) ** 2) @ self.noise[0] + self.noise[1])

    def residuals(self, at: np.ndarray) -> np.ndarray:
        return _real(np.sqrt(2.0) * self.apart(at) / np.sqrt(self.variance(at)))

    def jacobian(self, at: np.ndarray) -> np.ndarray:
        e, s2, z = self.apart(at), self.variance(at), self.stiffness(at)
        d = len(self.lines.axes)
        basis = self._basis * self.excited[:, None, None, None]
        slopes = np.einsum("nabp,nb->nap", basis, self.lines.displacement)
        widths = 2.0 * np.einsum("nab,nabp,b->nap", z.conj(), basis, self.noise[0]).real
        columns = slopes / np.sqrt(s2)[..., None] - 0.5 * (e / s2**1.5)[..., None] * widths
        parts = np.zeros((len(e), d, d * _LEAKAGE), complex)
        for a in range(d):
            parts[:, a, a * _LEAKAGE : (a + 1) * _LEAKAGE] = self.leakage() / np.sqrt(s2[:, a])[:, None]
        whole = np.sqrt(2.0) * np.concatenate([columns, parts], axis=2)
        return np.concatenate([whole.real, whole.imag]).reshape(-1, whole.shape[2])


def fit_lines(lines: Lines, free: Sequence[Free], mass: float) -> tuple[Estimate, Linear]:
    """Free numbers with their intervals, and the model with the noise that it sees.

    Raises
    ------
    ConvergenceError
        The search finds no end.
    """
    d = len(lines.axes)
    problem = Linear(lines, free, mass, np.vstack([np.zeros(d), np.ones(d)]))
    every = [*free, *problem.nuisance]
    for turn in range(_TURNS):  # linear at first, the force's noise alone: wherever it begins, it ends at one place
        found = estimate(problem, every, stated=False)
        problem.noise = _variances(problem, found.values)
        if turn >= _ALL:
            problem.tell_apart(found.values)
        every = [attrs.evolve(one, start=float(value)) for one, value in zip(every, found.values, strict=True)]
    found = estimate(problem, every, stated=False)
    problem.rest = problem.apart(found.values)
    return attrs.evolve(_without_leakage(found, len(free)), free=tuple(free)), problem


def _variances(problem: Linear, at: np.ndarray) -> np.ndarray:
    """Variances (2, d) of displacement and force by which |e|^2 (n, d) is likeliest: exponential with the mean s^2."""
    z2, e2 = np.abs(problem.stiffness(at)) ** 2, np.abs(problem.apart(at)) ** 2
    n, d = e2.shape
    regressors = np.concatenate([z2, np.broadcast_to(np.eye(d), (n, d, d))], axis=2)  # (n, d, 2 d)
    shares = regressors.mean(axis=(0, 1))
    found = np.full(2 * d, float(e2.mean())) / shares / (2 * d)
    for _ in range(_STEPS):
        mean = regressors @ found
        # Multiplicative steps of the likelihood's gradient: variances stay positive.
        up = np.einsum("nak,na->k", regressors, e2 / mean**2)
        down = np.einsum("nak,na->k", regressors, 1.0 / mean)
        step = np.sqrt(up / down)
        found = found * step
        if np.abs(step - 1.0).max() < _STAYS:
            break
    return np.asarray(found.reshape(2, d))


def _without_leakage(found: Estimate, count: int) -> Estimate:
    """The free numbers alone, the parts of T taken out of the derivatives, where they are fitted whatever the numbers are."""
    j, t = found.jacobian[:, :count], found.jacobian[:, count:]
    basis = np.linalg.svd(t * [one.size for one in found.free[count:]], full_matrices=False)[0]
    return judged(
        found.free[:count], found.values[:count], found.residuals, j - basis @ (basis.T @ j), False, found.evaluations
    )


def _real(one: np.ndarray) -> np.ndarray:
    return np.concatenate([one.real, one.imag]).ravel()
