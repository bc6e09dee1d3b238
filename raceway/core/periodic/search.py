"""The periodic motions of a system: directly, and along branches on which the force grows, the speed or the load changes."""

from __future__ import annotations

import attrs
import numpy as np

from raceway.core.periodic.detour import from_elsewhere, from_undamped
from raceway.core.periodic.direct import MOST, directly, full_steps, grown, highest_order, mesh_of
from raceway.core.periodic.first_guess import standing
from raceway.core.periodic.floquet import Floquet, floquet
from raceway.core.periodic.from_rest import Trail, at_whole_force, trail
from raceway.core.periodic.neighbour import Neighbour, Recorded, neighbour_of
from raceway.core.periodic.problem import Problem
from raceway.core.periodic.rates import stiff
from raceway.core.periodic.refinement import Refined, refine
from raceway.core.periodic.sampling import displacements
from raceway.core.ring.kernels.layout import CAGE
from raceway.errors import ConvergenceError

#: Distance of a motion from its neighbour, over its size, up to which it is that one's continuation.
_STAYS = 0.2
#: Distance of two motions over their size below which they are one.
_SAME = 1e-3
#: Angles at which motions are compared: no harmonic of a turn hides between them.
_COMPARED = 2.0 * np.pi * np.arange(17) / 17


@attrs.frozen(eq=False)
class Found:
    """A periodic motion.

    Attributes
    ----------
    refined : the motion with its error
    highest : order of the highest natural frequency at the equilibrium
    how : "directly", "from rest" (the force grows), "from a higher speed", "from a lower speed", "from a heavier axial load", "from no
        damping" or "by Fourier collocation"
    fate : its multipliers
    fold : share of the force at which the branch from rest turns back for good; None where it leads to the whole force
    others : further motions under the same force that were met in the search
    """

    refined: Refined
    highest: float
    how: str
    fate: Floquet
    fold: float | None = None
    others: tuple[Found, ...] = ()
    _lent: list[Neighbour] = attrs.field(factory=list, init=False, repr=False)

    def neighbour(self, q: np.ndarray, tangent: np.ndarray) -> Neighbour:
        """What the motion lends to others, about the problem's equilibrium q (5,) with its tangent (5, 5); made once."""
        if not self._lent:
            self._lent.append(neighbour_of(self.refined.solved, q, tangent))
        return self._lent[0]

    @property
    def all(self) -> tuple[Found, ...]:
        """This one first."""
        return (self, *self.others)


def find(
    problem: Problem,
    q: np.ndarray,
    tangent: np.ndarray,
    tolerance: float,
    near: Neighbour | Recorded | None = None,
    stay: bool = False,
) -> Found:
    """The periodic motion of a ring about the equilibrium q (5,), to a relative tolerance, and others beside it.

    Parameters
    ----------
    near : a motion to start from
    stay : on that one where several may exist, instead of searching for all; and where branches are not followed and nothing
        is found directly, give up instead of letting the force grow on a mesh of thousands of intervals

    Notes
    -----
    Newton's iteration from the linear response, with full steps only: one that has to be shortened may end on a resonant
    branch far away.  Where it fails, is unstable, or ends far from the linear response, there may be several motions: the
    branch that leads from the resting ring is followed round its folds, and every place where it meets the whole force is a
    motion.  The first one along the branch that is not unstable is taken; where all are, motions that the undamped ring's branch
    leads to are tried, and else the one is taken that is left slowest.  Where the branch never reaches the whole force and all
    found so far are unstable, motions at other speeds and loads are followed to this one.

    Raises
    ------
    ConvergenceError
        No periodic motion found, with what was tried.
    """
    highest = highest_order(problem, tangent)
    if near is not None and (stay or near.near_linear):
        followed = _followed(problem, q, tangent, tolerance, highest, near)
        # Far from the linear response there may be other motions: then the search without a neighbour decides.
        if followed is not None and (stay or not may_have_others(followed, q, tangent)):
            return followed
    direct = None
    try:
        direct = found_by(directly(problem, q, tangent, tolerance), highest, "directly")
    except ConvergenceError:
        pass
    else:
        if not may_have_others(direct, q, tangent):
            return direct
    if not can_follow(problem, q, tangent):
        # Each point would take seconds.
        if direct is None and stay:
            raise ConvergenceError("no motion of the period of the force was found directly", {"q": q.copy()})
        return direct or found_by(_grown_only(problem, q, tangent, tolerance, highest), highest, "from rest")
    return _chosen(problem, q, tangent, tolerance, direct)


def _followed(
    problem: Problem, q: np.ndarray, tangent: np.ndarray, tolerance: float, highest: float, near: Neighbour | Recorded
) -> Found | None:
    """The motion that continues a neighbour, if it is close to it and not unstable."""
    first = near.first_guess(problem, q, tangent, mesh_of(problem, highest))
    if first is None:
        return None
    try:
        solved = full_steps(problem, first, 1e-2 * tolerance)
        if np.abs((solved.path.q - first.q) / problem.weight).max() > _STAYS * solved.size:
            return None
        found = found_by(refine(solved, tolerance), highest, "directly")
    except ConvergenceError:
        return None
    return None if found.fate.verdict == "unstable" else found


def may_have_others(found: Found, q: np.ndarray, tangent: np.ndarray) -> bool:
    """Whether a motion is unstable or so far from its linear response about q (5,) that other ones may exist beside it."""
    return found.fate.verdict == "unstable" or not found.neighbour(q, tangent).near_linear


def can_follow(problem: Problem, q: np.ndarray, tangent: np.ndarray) -> bool:
    """Whether branches are followed: meshes for the natural frequencies are small, and dashpots in the contacts weak."""
    nodes = mesh_of(problem, highest_order(problem, tangent))
    return len(nodes) <= MOST and not stiff(problem, standing(problem, q, nodes))


def found_by(refined: Refined, highest: float, how: str, fold: float | None = None) -> Found:
    """A motion with its multipliers."""
    return Found(refined, highest, how, floquet(refined.solved, highest), fold)


def _grown_only(problem: Problem, q: np.ndarray, tangent: np.ndarray, tolerance: float, highest: float) -> Refined:
    try:
        return grown(problem, q, tangent, tolerance)
    except ConvergenceError as why:
        raise ConvergenceError(
            "no motion of the period of the force was found from rest, and it is not looked for along branches: natural "
            f"frequencies go up to {highest:.3g} times the force's, or dashpots are strong. A transient integrator with "
            "start = 'ramp' shows what the ring does.",
            {"q": q.copy()},
        ) from why


def _chosen(problem: Problem, q: np.ndarray, tangent: np.ndarray, tolerance: float, direct: Found | None) -> Found:
    """The motion that is taken, of all that the branch from rest and Newton's iteration lead to."""
    highest = highest_order(problem, tangent)
    lost, branch = None, Trail()
    try:
        branch = trail(problem, q, tangent, mesh_of(problem, highest))
    except ConvergenceError as why:
        lost = why
    found: list[Found] = []
    for refined in at_whole_force(problem, branch.crossings, tolerance):
        if not any(_alike(refined, one.refined) for one in found):
            found.append(found_by(refined, highest, "from rest"))
    fold = None if branch.reaches else branch.largest
    if direct is not None:
        # Where both ways lead to one motion, the shorter one is told.
        same = [k for k, one in enumerate(found) if _alike(direct.refined, one.refined)]
        if same:
            found[same[0]] = direct
        else:
            found.append(attrs.evolve(direct, fold=fold))
    if not found:
        try:
            found = [found_by(grown(problem, q, tangent, tolerance), highest, "from rest")]
        except ConvergenceError:
            if lost is not None:
                raise lost from None
    if all(one.fate.verdict == "unstable" for one in found):
        for refined in from_undamped(problem, q, tangent, mesh_of(problem, highest), tolerance):
            if not any(_alike(refined, known.refined) for known in found):
                found.append(found_by(refined, highest, "from no damping", fold))
    if fold is not None and problem.system.scalars[CAGE] == 0.0 and all(one.fate.verdict == "unstable" for one in found):
        reached = from_elsewhere(problem, q, tangent, tolerance, not found)
        if reached is not None and not any(_alike(reached[0], known.refined) for known in found):
            found.append(found_by(reached[0], highest, reached[1], fold))
    if not found:
        back = "where its branch turns back (an internal resonance)"
        end = back if branch.folds else "beyond which it could not be followed"
        raise ConvergenceError(
            f"no motion of the period of the force was found: the one that grows out of rest ends at {100 * (fold or 0.0):.3g} % "
            f"of the force, {end}, and none leads here from other speeds or a heavier load. A transient integrator with start = 'ramp' shows "
            "what the ring does instead.",
            {"q": q.copy()},
        )
    first, *others = taken(found)
    return attrs.evolve(first, others=tuple(others))


def taken(found: list[Found]) -> list[Found]:
    """The same motions, that one first which is taken: the first that is not unstable, else the one that is left slowest."""
    slowest = min(found, key=lambda one: one.fate.largest)
    first = next((one for one in found if one.fate.verdict != "unstable"), slowest)
    return [first, *(one for one in found if one is not first)]


def _alike(one: Refined, two: Refined) -> bool:
    """Whether two motions of one problem are the same."""
    pair = [displacements(found.solved, _COMPARED) / found.solved.problem.weight for found in (one, two)]
    return bool(np.abs(pair[0] - pair[1]).max() <= _SAME * max(one.solved.size, two.solved.size))
