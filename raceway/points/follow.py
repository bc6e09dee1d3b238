"""K as a curve over a key of a scene, ``raceway.follow``: the branch of steady orbits, the branches of twice the period that leave it,
and the motions that a ring settles on where it is unstable."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Annotated

import attrs
import numpy as np

from raceway.answers.answer import Interrupted
from raceway.answers.progress import ShowProgress, telling
from raceway.core.periodic.branch import Branch, Point, apart
from raceway.core.periodic.branch import doubled as doubled_branch
from raceway.core.periodic.collocation import solve
from raceway.core.periodic.search import MOST, directly, highest_order
from raceway.core.periodic.special_points import DOUBLING, located, special_points
from raceway.core.periodic.steady import find
from raceway.errors import ConvergenceError
from raceway.framework.doors import PATH, PATHS, door
from raceway.framework.loading.registry import registry_with
from raceway.framework.options import at_least, positive
from raceway.points.attractor import attractor_beside
from raceway.points.branch import OPENS, PEAK, Followed, Label, Orbit, growth_of_swing, open_contacts, orbit_of, resonance
from raceway.points.parameter import Parameter, parameter_of
from raceway.points.workload import Workload, run_times
from raceway.scene.keys import key_of
from raceway.scene.scene import Change, SceneSource, plain_tables

#: Error of orbits over their size that meshes are kept fit for, and that at which a branch is left.
ERROR, _LOST = 1e-6, 1e-3
#: Error of the first orbit over its size.
_TOLERANCE = 1e-8
#: First step, in tenths of the range and sizes of the first orbit.
_FIRST = 0.02
#: Length from the prediction to a point over the step, from which it may be another branch's.
_STRAYED = 0.2
#: Most change of the key in a step, in tenths of the range.
_MOST = 0.5
#: Distance from the last value over the range, from which it is reached with the key held.
_BESIDE = 1e-4
OnProgress = Callable[[str, int, int], None]


@door
def follow(
    scene: SceneSource,
    over: str,
    *changes: Change,
    points: Annotated[int, at_least(1)] = 1000,
    aim: Annotated[float, positive()] = 1e-3,
    doubled: bool = False,
    turns: Annotated[int, at_least(0)] = 0,
    out: Annotated[str | Path | None, PATH] = None,
    plugins: Annotated[Iterable[str | Path], PATHS] = (),
    progress: ShowProgress = None,
) -> Followed:
    """Follow the steady orbit of a scene over a continuous key, through folds, with its stability.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables; its integrator and identifier are ignored
    over : ``"table.key=first:last"``, values as numbers or with units
    changes : of the scene, as ``raceway.evolve`` takes them
    points : orbits at most
    aim : deviation of an orbit from its prediction along the tangent, over its size, that steps are chosen for
    doubled : follow the branches of twice the period that leave it at period doublings, too
    turns : of a time integration from beside the most unstable orbit of each unstable stretch; 0: none
    out : folder for follow.json, follow.csv and follow.png; None: nothing is written
    plugins : files of one-off plug-ins that the scene uses
    progress : True for a bar on a terminal, or called as ``progress(what, done, total)``

    Returns
    -------
    Followed
        ``rows`` with K [N/m], C [N s/m], amplitude [m] and verdict; ``labels``: folds, period doublings, Neimark-Sacker points,
        branch points and peaks; ``unstable`` stretches, ``attractors``: motions that a ring reaches there; ``doubled`` branches;
        ``end``: why the branch ends before the last value, "" where it does not

    Raises
    ------
    SceneError
        A key that is not continuous, or a range whose ends or middle are no scenes.
    ConvergenceError
        No orbit at the first value.
    Interrupted
        On Ctrl-C: a KeyboardInterrupt with the curve up to there as ``partial``; it is written to ``out``, too, without a picture.

    Notes
    -----
    The derivatives by the state are exact; that by the key is a central difference quotient of the balance of forces.

    Examples
    --------
    >>> import raceway as rw
    >>> scene = {
    ...     "bearing": {"preset": "B7206C"},
    ...     "load": {"axial": 1000.0},
    ...     "excitation": {"kind": "bidirectional", "speed_rpm": 6000, "amplitude": "constant", "force": 50.0},
    ...     "rotor": {"mass": 2.0, "damping": 1000.0},
    ... }
    >>> curve = rw.follow(scene, "excitation.speed_rpm=5000:15000")
    >>> [label.kind for label in curve.labels], curve.rows[-1].verdict
    ([], 'stable')
    """
    registry = registry_with(plugins)
    tables = plain_tables(scene, *changes, registry=registry)
    parameter = parameter_of(tables, over, registry)
    try:
        with telling(progress) as on_progress:
            curve = _follow_branch(parameter, points, aim, doubled, turns, on_progress)
    except Interrupted as stop:
        if out is not None and stop.partial is not None:
            stop.partial.save(out)
        raise
    if out is not None:
        curve.save(out, pictures=True)
    return curve


def curve(
    scene: SceneSource, over: str, *changes: Change, points: int = 1000, aim: float = 1e-3, doubled: bool = False,
    turns: int = 0, plan: bool = False, plugins: Iterable[str | Path] = (), progress: ShowProgress = None,
) -> Followed | Workload:  # fmt: skip
    """Follow the steady orbit of a scene over a continuous key, through folds, with its stability.

    Parameters
    ----------
    points : orbits at most
    aim : deviation of an orbit from its prediction along the tangent, over its size, that steps are chosen for
    doubled : follow the branches of twice the period that leave it at period doublings, too
    turns : of a time integration from beside the most unstable orbit of each unstable stretch; 0: none
    plan : print how many orbits and how long at most, and stop
    """
    if not plan:
        return follow(
            scene, over, *changes, points=points, aim=aim, doubled=doubled, turns=turns, plugins=plugins, progress=progress
        )
    registry = registry_with(plugins)
    parameter = parameter_of(plain_tables(scene, *changes, registry=registry), over, registry)
    seconds, _ = run_times(points, lambda _: parameter.base, planned=1)
    remarks = ["Smooth branches take 30 to 200 orbits."] + ["Integrations over time (--turns) are added."] * bool(turns)
    return Workload(
        parameter.base.title, points, seconds, looped=points, noun="orbits", at_most=True, remarks=tuple(remarks)
    )


def _follow_branch(
    parameter: Parameter, points: int, aim: float, doubled: bool, turns: int, on_progress: OnProgress | None = None
) -> Followed:
    """The branch from the orbit at the first value of the key to the last one, as ``follow``."""
    model, equilibrium = parameter.static_state(parameter.first)
    q, tangent, mass = equilibrium.displacement, equilibrium.stiffness_rows_held, model.mass_used
    try:
        end = parameter.static_state(parameter.last)[1]
    except ConvergenceError as why:
        raise ConvergenceError(f"at `{parameter.key}` = {parameter.last:g}: {why}", why.state) from why
    symmetry = parameter.symmetry(q)
    problem = parameter.problem_at(parameter.first, symmetry)
    if on_progress is not None:
        problem = attrs.evolve(problem, watch=lambda: on_progress("the first orbit", 0, 0))
    try:  # that from the linear response if full steps lead to one, else the one that the search takes
        first = directly(problem, q, tangent, _TOLERANCE).solved
    except ConvergenceError:
        first = find(problem, q, tangent, _TOLERANCE).refined.solved
    unit = abs(parameter.last - parameter.first) / 10.0
    last = parameter.problem_at(parameter.last, symmetry)
    squares = [(highest_order(at, k) * at.speed) ** 2 for at, k in ((problem, tangent), (last, end.stiffness_rows_held))]

    def fastest(p: float) -> float:
        """Highest natural frequency [rad/s]: its square is linear in a stiffness."""
        part = (p - parameter.first) / (parameter.last - parameter.first)
        return float(np.sqrt(max(squares[0] + part * (squares[1] - squares[0]), min(squares))))

    branch = Branch(lambda p: parameter.problem_at(p, symmetry), unit, first.size, ERROR, MOST, None, fastest, aim)
    span, ends = float(np.degrees(symmetry.span)), (parameter.first, parameter.last)
    curve = Followed(parameter.key, *ends, span, model.scene.title, unit=key_of(parameter.base, parameter.key).unit)
    sense = 1.0 if parameter.last > parameter.first else -1.0
    try:
        start = branch.start(first, parameter.first, sense)
        _Continuation(branch, curve, parameter, mass, points, on_progress).go(start)
        if doubled:
            _follow_doubled(branch, curve, parameter, mass, points, on_progress)
        for each in (curve, *curve.doubled) if turns else ():
            at = ((p.solved, p.transfer, float(p.parameter)) for p in each.worst)
            each.attractors += [attractor_beside(*point, turns, on_progress) for point in at]
    except KeyboardInterrupt as stop:
        curve.doubled = [twice for twice in curve.doubled if twice.rows]
        for part in (curve, *curve.doubled):
            part.labels.sort(key=lambda label: label.row.arc)
        here = curve.rows[-1].parameter if curve.rows else curve.first
        if curve.end or here == curve.last:
            curve.notes.append("stopped before the branches of twice the period and the time integrations were finished")
        else:
            curve.end = f"stopped at {here:.6g} after {len(curve.rows)} orbits; --over {curve.key}={here:.6g}:{curve.last:g} goes on from there"
        raise Interrupted(curve if curve.rows else None) from stop
    return curve


def _follow_doubled(
    branch: Branch, curve: Followed, parameter: Parameter, mass: float, points: int, on_progress: OnProgress | None
) -> None:
    """The branches of twice the period; one that ends at another period doubling is that one's, too."""
    ends: list[float] = []
    for label in curve.labels:
        point = label.point
        if label.kind != DOUBLING or point is None or any(abs(point.parameter - p) < 1e-6 * branch.unit for p in ends):
            continue
        ends.append(point.parameter)
        twice = Followed(curve.key, curve.first, curve.last, 2.0 * curve.span_deg, curve.title)
        curve.doubled.append(twice)
        longer, first = doubled_branch(branch, point)
        halves: list[np.ndarray] = []

        def together(point: Point, halves: list[np.ndarray] = halves) -> bool:
            """Whether the two halves of the orbit have come together again, which they do at another period doubling."""
            halves.append(apart(point))
            return float(halves[-1] @ halves[0]) <= 0.0

        if _Continuation(longer, twice, parameter, mass, points, on_progress, together).go(first):
            doublings = [label.row.parameter for label in curve.labels if label.kind == DOUBLING]
            ends.append(min(doublings, key=lambda p: abs(p - twice.rows[-1].parameter)))


@attrs.define(eq=False)
class _Continuation:
    """Follows one branch and writes down what it meets: points, special points, peaks, contacts that open, how it ends."""

    branch: Branch
    curve: Followed
    parameter: Parameter
    mass: float  # m of K [kg]
    points: int  # orbits at most
    on_progress: OnProgress | None
    closed: Callable[[Point], bool] | None = None  # whether the branch ends at a point, asked for each in its order
    arc: float = 0.0

    def go(self, start: Point) -> bool:
        """Points one by one, until the range or the number of points is left or the branch ends; whether it closed."""
        cycle = self._go(start, _FIRST)
        self.curve.labels.sort(key=lambda label: label.row.arc)
        return cycle

    def _go(self, here: Point, size: float) -> bool:
        curve, least = self.curve, 1e-6 * size
        self._record(here, orbit_of(here, self.arc, self.mass))
        while len(curve.rows) < self.points:
            if self.on_progress is not None:
                self.on_progress("orbits", len(curve.rows), self.points)
            try:
                ahead = self.branch.step(here, size)
                if ahead.strayed > _STRAYED * size:
                    raise ConvergenceError("the branch bends too much for the step")
                ahead, size, end = self._within(here, ahead, size)
                orbit = orbit_of(ahead, self.arc + size, self.mass)
            except ConvergenceError as why:
                size *= 0.5
                if size < least:
                    if not self._at_the_last(here):
                        curve.end = f"the branch ends at {here.parameter:.6g}: {why}{resonance(here.solved)}"
                    return False
                continue
            if self.closed is not None and self.closed(ahead):
                return True
            self._label(here, ahead, size)
            self.arc += size
            self._record(ahead, orbit)
            if ahead.error > _LOST:
                curve.end = (
                    f"left at {ahead.parameter:.6g}: no mesh follows the orbit closer than {ahead.error:.1e} of its size"
                )
                if orbit.lost:
                    curve.end += f" where up to {orbit.lost} balls lose their inner race at once"
                curve.end += resonance(ahead.solved)
                return False
            if end is not None:
                curve.end = "" if end == self.parameter.last else f"the branch comes back to {end:.6g}"
                return False
            size = min(size * self.branch.growth(ahead), _MOST / max(abs(ahead.tangent[-1]), 1e-300))
            here = ahead
        curve.end = f"left after {self.points} orbits at {here.parameter:.6g} (--points)"
        return False

    def _at_the_last(self, here: Point) -> bool:
        """Beside the last value, beyond which there may be no scene, as no damping below 0: with the key held."""
        last, first = self.parameter.last, self.parameter.first
        gap = last - here.parameter
        if abs(gap) > _BESIDE * abs(last - first):
            return False
        try:
            problem = self.parameter.problem_at(last, here.solved.problem.symmetry)
            point = self.branch.start(solve(problem, here.solved.path, 1e-2 * ERROR), last, float(np.sign(gap)))
        except ConvergenceError:
            return False
        self.arc += abs(gap) / self.branch.unit
        self._record(point, orbit_of(point, self.arc, self.mass))
        return True

    def _within(self, before: Point, ahead: Point, size: float) -> tuple[Point, float, float | None]:
        """The point ahead, or that at the end of the range before it; the step's length, and that end."""
        ends = (self.parameter.last, self.parameter.first)
        limits = [end for end in ends if (ahead.parameter - end) * (before.parameter - end) < 0.0]
        if not limits:
            return ahead, size, None
        end = limits[0]
        return *located(self.branch, before, ahead, size, lambda point: float(point.parameter - end)), end

    def _record(self, point: Point, orbit: Orbit) -> None:
        """An orbit of the curve; of each unstable stretch the most unstable point."""
        before = self.curve.rows[-1] if self.curve.rows else None
        self.curve.rows.append(orbit)
        if orbit.verdict == "unstable":
            worst = self.curve.worst
            if before is None or before.verdict != "unstable":
                worst.append(point)
            elif orbit.multiplier > worst[-1].floquet.largest:
                worst[-1] = point

    def _label(self, before: Point, ahead: Point, size: float) -> None:
        """Special points, peaks and the loss of contacts between two neighbours."""
        curve, branch = self.curve, self.branch

        def label(kind: str, value: Callable[[Point], float]) -> None:
            point, length = located(branch, before, ahead, size, value)
            curve.labels.append(Label(kind, orbit_of(point, self.arc + length, self.mass)))

        try:
            for special in special_points(branch, before, ahead, size):
                orbit = orbit_of(special.point, self.arc + special.length, self.mass)
                curve.labels.append(Label(special.kind, orbit, special.angle, special.point))
            if growth_of_swing(branch, before) > 0.0 >= growth_of_swing(branch, ahead):
                label(PEAK, lambda point: growth_of_swing(branch, point))
            if (open_contacts(before.solved)[0] < 0.0) != (open_contacts(ahead.solved)[0] < 0.0):
                label(OPENS, lambda point: open_contacts(point.solved)[0])
        except (ConvergenceError, ValueError) as why:
            span = f"between {before.parameter:.6g} and {ahead.parameter:.6g}"
            words = f"{span} a fold, peak or change of stability or contact is not located, use a smaller --aim ({why})"
            curve.notes.append(words)
