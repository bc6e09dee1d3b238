"""The posterior of free numbers by an affine-invariant ensemble sampler (the optional package emcee).

Notes
-----
Even prior within the ranges that the scene's rules leave.  Stated errors make the likelihood; where none are stated, their common factor is
taken out with the prior 1 / s: the posterior goes with the sum of squares to the power -n / 2.

References
----------
Goodman, Weare, Comm. Appl. Math. Comp. Sci. 5 (2010) 65; Foreman-Mackey et al., PASP 125 (2013) 306.
"""

from __future__ import annotations

import attrs
import numpy as np

from raceway.errors import RacewayError, SceneError, extra
from raceway.pipeline.simulate import OnProgress
from raceway.storage.tables import Tables
from raceway.studies.fit.estimate import CONFIDENCE, Estimate, Residuals

#: Walkers per free number, and at least; part of the steps that is left out; autocorrelation times that a chain should be long.
_WALKERS, _LEAST, _BURN, _LONG = 8, 16, 0.3, 50.0
#: Spread of the walkers' start over the standard errors.
_START = 0.5


@attrs.frozen(eq=False)
class Posterior:
    """Samples of the posterior.

    Attributes
    ----------
    names, units : of the free numbers;  samples : (m, p);  steps, walkers : of the chain
    accepted : part of the proposals;  correlation : integrated autocorrelation time, steps
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    samples: np.ndarray
    steps: int
    walkers: int
    accepted: float
    correlation: float

    @property
    def limits(self) -> np.ndarray:
        """Ends of the central 95 % (2, p)."""
        out: np.ndarray = np.quantile(self.samples, [0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE], axis=0)
        return out

    @property
    def short(self) -> bool:
        """Whether the chain is too short for its autocorrelation."""
        return not self.steps * (1.0 - _BURN) > _LONG * self.correlation

    def to_dict(self) -> Tables:
        """Medians and limits, and 2000 samples at most."""
        low, high = self.limits
        every = max(len(self.samples) // 2000, 1)
        numbers = {
            name: {
                "median": float(np.median(self.samples[:, k])),
                "low": float(low[k]),
                "high": float(high[k]),
                "unit": self.units[k],
            }
            for k, name in enumerate(self.names)
        }
        chain: Tables = {"steps": self.steps, "walkers": self.walkers, "accepted": self.accepted}
        return chain | {
            "autocorrelation_steps": self.correlation,
            "numbers": numbers,
            "samples": self.samples[::every].tolist(),
        }


def require_emcee() -> None:
    """The sampler's package.

    Raises
    ------
    RacewayError
        It is missing.
    """
    try:
        import emcee  # noqa: F401  (whether it is there, before the fit takes its time)
    except ImportError as why:
        raise RacewayError(f"the posterior needs emcee: {extra('fit')} ({why})") from None


def posterior(
    problem: Residuals, found: Estimate, stated: bool, steps: int, seed: int = 1, on_progress: OnProgress | None = None
) -> Posterior:
    """Samples about an estimate.

    Parameters
    ----------
    steps : of each walker

    Raises
    ------
    SceneError
        Too few steps, or numbers that the data do not determine.
    RacewayError
        emcee is missing.
    """
    require_emcee()
    import emcee

    if steps < 10:
        raise SceneError.at("--posterior", steps, "must be at least 10 steps of each walker; some hundred are usual")
    if not np.isfinite(found.half).all():
        raise SceneError.at("--posterior", steps, "has no end: the data do not determine every free number. Free fewer keys")
    p, count = len(found.free), len(found.residuals)
    walkers = max(_WALKERS * p, _LEAST)
    low, high = (np.array([getattr(one, end) for one in found.free]) for end in ("low", "high"))

    def log_density(at: np.ndarray) -> float:
        if (at <= low).any() or (at >= high).any():
            return -np.inf
        try:
            residuals = problem.residuals(at)
        except RacewayError:  # no answer there: no such bearing
            return -np.inf
        squares = float(residuals @ residuals)
        return -0.5 * squares / found.widened**2 if stated else -0.5 * count * float(np.log(squares))

    random = np.random.default_rng(seed)
    spread = _START * np.linalg.cholesky(found.covariance + 1e-12 * np.diag(np.diag(found.covariance)))
    start = found.values + random.standard_normal((walkers, p)) @ spread.T
    edge = 1e-9 * np.array([one.size for one in found.free])
    start = np.clip(start, low + edge, high - edge)
    sampler = emcee.EnsembleSampler(walkers, p, log_density)
    sampler.random_state = np.random.RandomState(seed).get_state()  # noqa: NPY002  (what emcee takes)
    for done, _ in enumerate(sampler.sample(start, iterations=steps)):
        if on_progress is not None:
            on_progress("posterior", done + 1, steps)
    times = np.asarray(sampler.get_autocorr_time(quiet=True, tol=0))
    samples = sampler.get_chain(discard=int(_BURN * steps), flat=True)
    names, units = tuple(one.name for one in found.free), tuple(one.unit for one in found.free)
    return Posterior(
        names, units, samples, steps, walkers, float(np.mean(sampler.acceptance_fraction)), float(np.max(times))
    )
