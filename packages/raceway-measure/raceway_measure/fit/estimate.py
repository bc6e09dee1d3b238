"""Least squares with exact derivatives: free and uncertain numbers, estimate, covariance, and combinations that the data do not determine.

Numbers are searched for in multiples of their sizes, J is the derivative of the weighted residuals by these.  A right singular vector
v of J with singular value s is a combination of changes that moves the data by s; along it the standard error of the estimate is that
of the noise over s.  Where 95 % of that is more than the numbers themselves, or s is rounding, the data do not determine the combination.

Numbers of the scene that are not free are uncertain: a range of its [tolerances] counts by the root mean square deviation of an even
distribution from the number, the relative standard error of a preset's inferred numbers is in the catalogue.  Conformities of a preset
are one number that was inferred: they deviate together.  To first order they move the estimate by -(J' J)^-1 J' dr.

Seber, Wild, Nonlinear Regression, Wiley 1989, chapters 2 and 3: linearised region, Student's distribution of its half-widths.
"""

from collections.abc import Collection, Iterable, Mapping, Sequence
from math import inf
from typing import Protocol

import attrs
import numpy as np

from raceway import ConvergenceError, RacewayError, Scene, SceneError
from raceway.extend import continuous_keys, geometry_of, key_of, leaves, tolerances_of, with_number

#: Probability of intervals and regions.
CONFIDENCE = 0.95
#: Half-width at that probability over the standard error, of a normal distribution.
NORMAL = 1.959964
#: The same as data and records of a rig state it.
COVERAGE = 1.96
#: Singular value over the largest one that is rounding of derivatives; share in a combination below which a number is not named.
_ROUNDING, _NAMED = 1e-7, 0.1
#: Relative change of numbers and of the sum of squares that ends the search, and evaluations at most.
_TOLERANCE, _MOST = 1e-9, 100
#: Part of its size by which a number lies at the end of its range, and near to it.
_AT_LIMIT, _NEAR = 1e-4, 0.05
#: Probability below which residuals are too large for errors that are stated.
_UNLIKELY = 1e-3
#: Size of a change at a number that is 0, by unit: typical of a bearing.
_SIZES = {"m": 1e-6, "N": 10.0, "N m": 0.1, "deg": 1.0, "r/min": 10.0, "K": 1.0, "kg": 0.1, "s": 1e-6, "N s/m": 10.0}
#: Doublings of a change before a number counts as without limit, and halvings that bracket a limit.
_DOUBLINGS, _HALVINGS = 40, 50


@attrs.frozen
class Free:
    """One free number."""

    name: str  # key of the scene, or a word of the model
    unit: str  # of the number
    start: float  # where the search begins
    size: float  # of a change that counts, the number itself where it is not 0
    #: low, high : ends of the range that the scene's rules leave
    low: float = -inf
    high: float = inf

    def margin(self, value: float) -> float:
        """Distance of a value from the nearer end of the range, over the size."""
        return min(value - self.low, self.high - value) / self.size


def free_keys(scene: Scene, paths: Iterable[str]) -> list[Free]:
    """Free keys of a scene, each with its range; SceneError: none, one twice, or no continuous key."""
    paths = [path.strip() for path in paths if path.strip()]
    if not paths:
        raise SceneError.at("--free", None, "names no key; at least one is needed, such as bearing.contact_angle_deg")
    if twice := next((path for path in paths if paths.count(path) > 1), None):
        raise SceneError.at("--free", twice, "stands there twice")
    free = []
    for path in paths:
        key = key_of(scene, path)
        size = abs(key.value) or _SIZES.get(key.unit, 1.0)
        low, high = (_limit(scene, path, key.value, sign * size) for sign in (-1.0, 1.0))
        if low == high:
            raise SceneError.at(path, key.value, "has no range: only this one value is allowed")
        # A search begins inside its range: a number at the end of it is moved in by a little.
        inside = 1e-6 * min(size, high - low)
        free.append(Free(path, key.unit, min(max(key.value, low + inside), high - inside), size, low, high))
    return free


def _limit(scene: Scene, path: str, value: float, step: float) -> float:
    """The last number that the rules of the scene's tables allow on the way from a value in steps of one sign."""

    def within_range(number: float) -> bool:
        try:
            with_number(scene, path, number)
        except ValueError:
            return False
        return True

    inner = value
    for _ in range(_DOUBLINGS):
        outer = value + step
        if not within_range(outer):
            break
        inner, step = outer, 2.0 * step
    else:
        return inf if step > 0.0 else -inf
    for _ in range(_HALVINGS):
        middle = 0.5 * (inner + outer)
        if within_range(middle):
            inner = middle
        else:
            outer = middle
    return inner


def with_free(scene: Scene, free: Sequence[Free], values: np.ndarray) -> Scene:
    """The scene with values of its free keys; ``SceneError`` for one that a key's rule refuses."""
    for key, value in zip(free, values, strict=True):
        try:
            scene = with_number(scene, key.name, float(value))
        except ValueError as why:
            raise SceneError.at(key.name, float(value), str(why)) from None
    return scene


@attrs.frozen
class _Uncertain:
    """Numbers that deviate together.  ``cause``: in words;  ``sizes``: path -> standard error, in the unit of the key."""

    cause: str
    sizes: dict[str, float]

    def moved(self, scene: Scene, errors: float) -> Scene:
        """The scene with these numbers moved by some standard errors; ``ValueError`` where a key's rule refuses one."""
        for path, size in self.sizes.items():
            scene = with_number(scene, path, key_of(scene, path).value + errors * size)
        return scene


def uncertain(scene: Scene, free: Collection[str], measured: Collection[str] = ()) -> tuple[_Uncertain, ...]:
    """Uncertain numbers of a scene, without free ones.

    measured : keys that the data state, for which no catalogue counts

    SceneError: A tolerance that reaches what a rule refuses.
    """
    table = dict(leaves(scene.source.get("tolerances", {})))
    ranges = {}
    for tolerance in tolerances_of(scene, table) if table else ():
        above, below = tolerance.high - tolerance.key.value, tolerance.key.value - tolerance.low
        ranges[tolerance.key.path] = ((above**3 + below**3) / 3.0 / (above + below)) ** 0.5
    tables = scene.source if scene.given is None else scene.given.merged()
    geometry = geometry_of(scene.source["bearing"], tables.get("bearing", {})) or {}
    parts = [("bearing", geometry), *((f"bearing.row[{row['row']}]", row) for row in geometry.get("rows", ()))]
    scatters = {f"{name}.{key}": fact["scatter"] for name, part in parts for key, fact in part.get("inferred", {}).items()}
    errors = {
        key.path: scatters[key.path] * abs(key.value)
        for key in continuous_keys(scene)
        if scatters.get(key.path) and key.path not in {*ranges, *free, *measured}
    }
    grooves = {path: size for path, size in errors.items() if ".conformity" in path}
    alone = {path: size for path, size in {**ranges, **errors}.items() if path not in {*free, *grooves}}
    causes = [_Uncertain(path, {path: size}) for path, size in alone.items()]
    return tuple([*causes, _Uncertain("groove conformities", grooves)] if grooves else causes)


class Residuals(Protocol):
    """Weighted residuals (n,), (fit - datum) / standard error, and their derivatives (n, p) by the free numbers."""

    def residuals(self, values: np.ndarray) -> np.ndarray:
        """At numbers (p,); ConvergenceError or SceneError where the model has no answer."""
        ...

    def jacobian(self, values: np.ndarray) -> np.ndarray:
        """At the numbers (p,) of the last residuals."""
        ...


@attrs.frozen
class Combination:
    """Changes of free numbers, in their units, that the data do not distinguish from none.

    ``changes``: name -> change;  ``moves``: the data by that many standard errors at most.
    """

    changes: dict[str, float]
    moves: float


@attrs.frozen(eq=False)
class Estimate:
    """Numbers at the least sum of squares."""

    #: free, values : (p,)
    free: tuple[Free, ...]
    values: np.ndarray
    covariance: np.ndarray  # (p, p), of the linearised model by noise, along what the data determine
    reach: float  # half-width at 95 % over the standard error of noise
    half: np.ndarray  # (p,) half-widths, infinite where the data do not determine a number
    #: residuals, jacobian : (n,), (n, p), weighted, there
    residuals: np.ndarray
    jacobian: np.ndarray
    #: root of the sum of squares over the degrees of freedom: 1 where errors are as stated; None without freedom
    scatter: float | None
    widened: float  # factor on stated errors where residuals are too large for them, else 1
    undetermined: tuple[Combination, ...]  # combinations
    open: np.ndarray  # the same by singular vectors (k, p), in the units of the numbers
    at_limit: tuple[str, ...]  # names of numbers at the end of their range
    evaluations: int  # of the model
    #: cause beside noise -> (k, p), by which k independent standard errors of it move the numbers
    shifts: dict[str, np.ndarray] = attrs.field(factory=dict)

    @property
    def freedom(self) -> int:
        """Degrees of freedom: data less free numbers."""
        return self.jacobian.shape[0] - self.jacobian.shape[1]

    @property
    def parts(self) -> dict[str, np.ndarray]:
        """Cause -> half-widths at 95 % (p,) by it alone, noise first."""
        noise = {"noise": self.reach * np.sqrt(np.diag(self.covariance))}
        return noise | {cause: NORMAL * np.linalg.norm(shift, axis=0) for cause, shift in self.shifts.items()}

    def with_shifts(self, cause: str, columns: np.ndarray) -> "Estimate":
        """With another cause, whose independent standard errors move the weighted residuals by columns (n, k)."""
        sizes = np.array([number.size for number in self.free])
        u, s, v = np.linalg.svd(self.jacobian * sizes, full_matrices=False)
        inverse = np.divide(1.0, s, out=np.zeros_like(s), where=s > _ROUNDING * s[0])
        shift = -((columns.T @ u) * inverse @ v)
        shift = (shift - shift @ (self.open / sizes).T @ (self.open / sizes)) * sizes
        wider = np.hypot(self.half, NORMAL * np.linalg.norm(shift, axis=0))
        return attrs.evolve(self, half=wider, shifts={**self.shifts, cause: shift})

    def half_widths(self, slopes: np.ndarray, directly: Mapping[str, np.ndarray] | None = None) -> np.ndarray:
        """Half-widths at 95 % (m,) of numbers with derivatives (m, p) by the free ones.

        ``directly``: cause -> (m, k), by which its standard errors move them at the same free numbers.  Combinations that the data do not
        determine count as certain to the sizes of the numbers.
        """
        squares = self.reach**2 * np.einsum("ij,jk,ik->i", slopes, self.covariance, slopes)
        squares += ((slopes @ self.open.T) ** 2).sum(axis=1)
        for cause, shift in self.shifts.items():
            squares += NORMAL**2 * ((slopes @ shift.T + (directly or {}).get(cause, 0.0)) ** 2).sum(axis=1)
        return np.asarray(np.sqrt(np.maximum(squares, 0.0)))


def estimate(problem: Residuals, free: Sequence[Free], stated: bool) -> Estimate:
    """The numbers at the least sum of squares.

    stated : whether weights are those of stated errors; else the residuals determine them

    RacewayError: The model has no answer where the search begins.
    ConvergenceError: The search does not converge.
    """
    from scipy.optimize import least_squares

    sizes = np.array([number.size for number in free])
    start = np.array([number.start for number in free]) / sizes
    first = problem.residuals(start * sizes)

    def residuals(x: np.ndarray) -> np.ndarray:
        try:
            return problem.residuals(x * sizes)
        except RacewayError:  # beyond a range, or no answer there: the search takes shorter steps
            return np.full(len(first), np.inf)

    def jacobian(x: np.ndarray) -> np.ndarray:
        """Without combinations that are rounding, along which the search would wander."""
        try:
            slopes = problem.jacobian(x * sizes) * sizes
        except SceneError as why:
            raise _at_an_end(free, x * sizes, why) from None
        u, s, v = np.linalg.svd(slopes, full_matrices=False)
        return np.asarray((u * np.where(s > _ROUNDING * s[0], s, 0.0)) @ v)

    search = least_squares(residuals, start, jacobian, ftol=_TOLERANCE, xtol=_TOLERANCE, gtol=_TOLERANCE, max_nfev=_MOST)
    if search.status <= 0:
        why = f"no minimum of the sum of squares after {search.nfev} evaluations of the model: start closer with --set, or free fewer keys"
        raise _at_an_end(free, search.x * sizes, ConvergenceError(why))
    answer = judged(tuple(free), search.x * sizes, search.fun, search.jac / sizes, stated, int(search.nfev))
    if any(key.name in answer.at_limit and not np.isfinite(half) for key, half in zip(free, answer.half, strict=True)):
        raise _at_an_end(free, answer.values, ConvergenceError("the data determine nothing"))
    return answer


def _at_an_end(free: Sequence[Free], values: np.ndarray, why: RacewayError) -> RacewayError:
    """A sentence on the number that ran to the end of its range, where derivatives end; else the reason as it is."""
    for key, value in zip(free, values, strict=True):
        if key.margin(value) < _NEAR:
            return ConvergenceError(
                f"`{key.name}` ran to {f'{value:.4g} {key.unit}'.rstrip()}, the end of its valid range: the data require an unphysical value. Check units, "
                "loads and speeds of the data, and the bearing of the scene"
            )
    return why


def judged(
    free: tuple[Free, ...], values: np.ndarray, residuals: np.ndarray, jacobian: np.ndarray, stated: bool, evaluations: int,
    scores: np.ndarray | None = None,
) -> Estimate:  # fmt: skip
    """Intervals and undetermined combinations by residuals (n,) and derivatives (n, p) at the least sum of squares.

    scores : (m, p) of independent groups of residuals that are not alike, derivatives times residuals: they determine the covariance
    """
    from scipy.stats import chi2, t

    n, p = jacobian.shape
    squares, freedom = float(residuals @ residuals), n - p
    scatter = float(np.sqrt(squares / freedom)) if freedom else None
    noise, widening = 1.0 if stated else (scatter or 0.0), 1.0
    if stated and scatter is not None and scatter > 1.0 and chi2.sf(squares, freedom) < _UNLIKELY:
        noise = widening = scatter
    reach = float(t.ppf(0.5 + 0.5 * CONFIDENCE, freedom)) if freedom and noise != 1.0 else NORMAL
    sizes = np.array([number.size for number in free])
    _, s, directions = np.linalg.svd(jacobian * sizes, full_matrices=False)
    weak_directions = (s <= _ROUNDING * s[0]) | (reach * noise > s) if s[0] > 0.0 else np.ones(p, bool)
    root = directions[~weak_directions] / s[~weak_directions, None]
    bread = root.T @ root
    covariance = noise**2 * bread * np.outer(sizes, sizes)
    if scores is not None:
        groups = scores * sizes @ bread * sizes
        covariance = groups.T @ groups
    half = reach * np.sqrt(np.diag(covariance))
    if freedom == 0 and not stated:  # as many data as numbers, errors not stated: nothing determines the noise
        half[:] = np.inf
    half[(np.abs(directions[weak_directions]) > _NAMED).any(axis=0)] = np.inf
    combinations = []
    for direction, size in zip(directions[weak_directions], s[weak_directions], strict=True):
        part = 0.1 / direction[np.argmax(np.abs(direction))]  # the largest one changes by a tenth of its size
        shares = zip(free, part * direction, sizes, strict=True)
        changes = {key.name: float(share * one) for key, share, one in shares if abs(share) > 0.1 * _NAMED}
        combinations.append(Combination(changes, float(abs(part) * (size / noise if noise else 0.0))))
    at_limit = tuple(key.name for key, value in zip(free, values, strict=True) if key.margin(value) < _AT_LIMIT)
    return Estimate(
        free, values, covariance, reach, half, residuals, jacobian, scatter, widening, tuple(combinations), directions[weak_directions] * sizes, at_limit,
        evaluations,
    )  # fmt: skip
