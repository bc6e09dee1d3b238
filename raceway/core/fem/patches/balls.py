"""All balls between both races: places and contact forces that are in equilibrium, and what the ring feels of them.

Contacts are numbered as in ``raceway.core.ring.kernels``: inner races first.  A contact sees the ball at

    D_inner = p - e,    D_outer = p,    each plus  W F,

p the ball's centre and e the inner groove centre, both seen from the outer groove centre, F (2 Z, 2) the forces of all
contacts on the balls, and W the compliance between contacts: of a ball from pole to pole, of a ring from ball to ball.  W
acts on resultants: far from a contact the field of its pressure is that of its resultant.  With K the contacts' own
stiffness, S = (1 + K W)^-1 K is what they show together; the balls' balance F_inner + F_outer + F_c = 0 then is a system
in p alone.

Friction also feels the turn of the inner ring's section at every ball: B = (1 + K W)^-1 b, b the contacts' derivatives, and
a couple acts on that section; so do gyroscopic moments, which tie both contacts of a ball together in K.  The balls' inertia is
a force that falls with their place, ``AppliedLoads``.
"""

from collections.abc import Sequence

import attrs
import numpy as np

from raceway.core.fem.patches.pressure import Contact, ContactState, SlipState
from raceway.core.ring.kernels.rolling import TractionForce, gyroscopic_moment
from raceway.core.ring.kernels.tensors import Pair
from raceway.errors import ConvergenceError


@attrs.frozen(eq=False)
class _Turned:
    """Tangential resultants of a ball's gyroscopic moment."""

    force: np.ndarray  # (4,) on the ball, inner and outer contact, each axial and radial [N]
    stiffness: np.ndarray  # (4, 4) minus its derivative by both places of the ball, D_inner and D_outer [N/m]
    couple: float  # on the section of the inner ring [N m]
    couple_by_place: np.ndarray  # (4,) [N]


@attrs.frozen
class Gyroscopic:
    """Moments of the balls.

    ``raceway.core.ring.kernels.rolling`` (``with_gyroscopic``) has the equations: T = share M / D at both contacts along the grooves, M a
    function of both contact angles; the inner race takes no more than its normal force, the outer one the rest, or both what
    ``traction_within`` leaves.
    """

    scale: float  # J times the speeds of ring and cage [N m]
    ratio: float  # D / d_m
    shares: tuple[float, float]  # of inner and outer race, 2 in all
    #: diameter, groove : of the ball, and the inner groove's radius [m]
    diameter: float
    groove: float
    traction: float = 0.0  # largest coefficient of both contacts; 0: none

    def of(self, inner: np.ndarray, outer: np.ndarray, states: Sequence[ContactState]) -> _Turned:
        """At places D (2,) of the ball in both grooves; states : the inner and the outer contact."""
        si, so = float(np.hypot(*inner)), float(np.hypot(*outer))
        ni, no = -inner / si, outer / so
        ti, to = np.array([ni[1], -ni[0]]), np.array([no[1], -no[0]])
        angle = np.zeros((2, 4))  # derivatives of both angles by both places
        angle[0, :2], angle[1, 2:] = -ti / si, to / so
        moment, *slope = gyroscopic_moment(Pair(*ni), Pair(*no), self.ratio, self.scale)
        grows = np.array(slope) @ angle
        pull = [share * moment / self.diameter for share in self.shares]
        by_place = [share / self.diameter * grows for share in self.shares]
        size, grow = np.zeros(2), np.zeros((2, 4))  # normal forces, and their derivatives by both places
        for race, one in enumerate(states):
            normal = one.force if one.traction_state is None else one.normal
            size[race] = np.hypot(*normal)
            if size[race] > 0.0:
                grow[race, 2 * race : 2 * race + 2] = -(normal / size[race]) @ (one.stiffness - one.along)
        if self.traction > 0.0:
            at_i = traction_within(pull[0], size[0], self.traction)
            fades = at_i.by_asked * by_place[0] + at_i.by_normal * grow[0]
            at_o = traction_within(2.0 * moment / self.diameter - at_i.force, size[1], self.traction)
            pull = [at_i.force, at_o.force]
            by_place = [fades, at_o.by_asked * (2.0 / self.diameter * grows - fades) + at_o.by_normal * grow[1]]
        elif abs(pull[0]) > size[0]:
            sign = float(np.sign(moment))
            fades = sign * grow[0]
            pull = [sign * size[0], 2.0 * moment / self.diameter - sign * size[0]]
            by_place = [fades, 2.0 / self.diameter * grows - fades]
        stiffness = np.zeros((4, 4))
        stiffness[:2] = np.outer(ti, by_place[0]) - pull[0] * np.outer(ni, angle[0])
        stiffness[2:] = -np.outer(to, by_place[1]) + pull[1] * np.outer(no, angle[1])
        force = np.concatenate([-pull[0] * ti, pull[1] * to])
        return _Turned(force, stiffness, self.groove * pull[0], self.groove * by_place[0])


def traction_within(demand: float, normal: float, limit: float) -> TractionForce:
    """As ``raceway.core.ring.kernels.rolling`` has it in lanes."""
    most = limit * normal
    size = float(np.hypot(demand, most)) or np.inf
    return TractionForce(most * demand / size, (most / size) ** 3, limit * (demand / size) ** 3)


_LIMIT = 60
#: Share of the regularisation that gives an unloaded ball a stiffness, of the largest one.
_IDLE = 1e-12


@attrs.frozen(eq=False)
class AppliedLoads:
    """Loads on balls and contacts beside those of their places."""

    turn: np.ndarray  # (Z,) of the inner ring's section at every ball [rad]
    #: of the points of all contacts, each (rows * columns,) [m]; empty: no friction
    slip: list[np.ndarray] = attrs.field(factory=list)
    #: push, spring : (Z, 2) [N] and [N/m]: force push - spring * place on the balls, their inertia
    push: np.ndarray | float = 0.0
    spring: float = 0.0
    gyroscopic: Gyroscopic | None = None  # moments of the balls; None: none

    def of(self, contact: int) -> SlipState | None:
        """The part of one contact."""
        return SlipState(float(self.turn[contact % len(self.turn)]), self.slip[contact]) if self.slip else None


@attrs.frozen(eq=False)
class LinearisedBalls:
    """The balls linearised at one state."""

    contact_states: list[ContactState]  # (2 Z) answers of the contacts
    force: np.ndarray  # (2 Z, 2) forces on the balls that are carried on [N]
    excess: np.ndarray  # (2 Z, 2) what the contacts give beyond them
    carried: np.ndarray
    contact_stiffness: np.ndarray  # (4 Z, 4 Z) S [N/m]
    ball_stiffness: np.ndarray  # (2 Z, 2 Z) the balls' own stiffness H = P^T S P
    balance: np.ndarray  # (2 Z,) forces on the balls, contact forces at W F included to first order [N]
    #: (4 Z, Z) B, minus derivatives of contact forces by the turns of the inner ring's section [N]
    by_section_turn: np.ndarray
    couple: np.ndarray  # (Z,) on that section [N m]
    couple_by_place: np.ndarray | None  # (Z, 4 Z) its derivative by D [N]; None where there are no couples
    crossed: np.ndarray | float  # (4 Z, 4 Z) what gyroscopic moments add to K [N/m]; 0 without
    relative: np.ndarray  # (2 Z, 2) D, the balls seen from the grooves [m]


class Balls:
    """Balls of all rows with their contacts.

    contacts : 2 Z contacts, inner races first
    coupling : (4 Z, 4 Z) W [m/N], symmetric
    loads : (Z, 2) forces on the balls themselves, axial and radial [N]: centrifugal
    step : largest step of a ball in an iteration [m]
    """

    def __init__(self, contacts: list[Contact], coupling: np.ndarray, loads: np.ndarray, step: float) -> None:
        self.contacts, self.coupling, self.loads, self.step = contacts, coupling, loads, step
        self.count = len(contacts) // 2
        n = 2 * self.count
        self._both = np.concatenate([np.eye(n), np.eye(n)])  # P: both contacts follow the ball
        self._inner = np.concatenate([np.eye(n), np.zeros((n, n))])  # E: the inner one follows the ring
        self._ones = np.eye(2 * n)
        self.evaluations = 0

    def linear(
        self,
        centre: np.ndarray,
        position: np.ndarray,
        force: np.ndarray,
        rate: np.ndarray,
        applied: AppliedLoads | None = None,
    ) -> LinearisedBalls:
        """Press all contacts.

        centre, position : (Z, 2) e and p [m];  force : (2 Z, 2) F [N];  rate : (2 Z, 2) velocities of D [m/s]
        """
        applied = applied or AppliedLoads(np.zeros(self.count))
        displacement = (self.coupling @ force.reshape(-1)).reshape(-1, 2)
        relative = np.concatenate([position - centre, position]) + displacement
        contact_states = [
            contact.press(d, r, applied.of(k))
            for k, (contact, d, r) in enumerate(zip(self.contacts, relative, rate, strict=True))
        ]
        self.evaluations += 1
        answer = np.array([state.force for state in contact_states])
        z = self.count
        couple, by_place = np.array([state.couple for state in contact_states[:z]]), None
        cross_coupling: np.ndarray | float = 0.0
        if bool(applied.slip) or applied.gyroscopic is not None:
            by_place = np.zeros((z, 4 * z))
            for k, state in enumerate(contact_states[:z]):
                by_place[k, 2 * k : 2 * k + 2] = state.couple_by_place
        if applied.gyroscopic is not None and by_place is not None:
            cross_coupling = np.zeros_like(self.coupling)
            for k in range(z):
                more = applied.gyroscopic.of(relative[k], relative[z + k], contact_states[k::z])
                at = np.r_[2 * k : 2 * k + 2, 2 * (z + k) : 2 * (z + k) + 2]
                answer[[k, z + k]] += more.force.reshape(2, 2)
                cross_coupling[np.ix_(at, at)] = more.stiffness
                couple[k] += more.couple
                by_place[k, at] += more.couple_by_place
        excess = (answer - force).reshape(-1)
        contact_stiffness, ball_stiffness, ring_stiffness, by_section_turn = self._together(
            [state.stiffness for state in contact_states], excess, contact_states, cross_coupling, applied.spring
        )
        acting = self.loads + applied.push - applied.spring * position
        balance = self._both.T @ (force.reshape(-1) + ring_stiffness) + acting.reshape(-1)
        stiffnesses = ring_stiffness, contact_stiffness, ball_stiffness
        couples = couple, by_place, cross_coupling
        excess = excess.reshape(-1, 2)
        return LinearisedBalls(contact_states, force, excess, *stiffnesses, balance, by_section_turn, *couples, relative)

    def smoothed_stiffness(self, now: LinearisedBalls, centre: np.ndarray, position: np.ndarray) -> LinearisedBalls:
        """The same state with the mean stiffness of every contact, see ``Contact.mean_stiffness``."""
        displacement = (self.coupling @ now.force.reshape(-1)).reshape(-1, 2)
        relative = np.concatenate([position - centre, position]) + displacement
        stiffness = [
            contact.mean_stiffness(d) + state.along
            for contact, d, state in zip(self.contacts, relative, now.contact_states, strict=True)
        ]
        contact_stiffness, ball_stiffness, ring_stiffness, by_section_turn = self._together(
            stiffness, now.excess.reshape(-1), now.contact_states, now.crossed
        )
        return attrs.evolve(
            now,
            contact_stiffness=contact_stiffness,
            ball_stiffness=ball_stiffness,
            carried=ring_stiffness,
            by_section_turn=by_section_turn,
        )

    def _together(
        self,
        stiffness: list[np.ndarray],
        excess: np.ndarray,
        contact_states: list[ContactState],
        cross_coupling: np.ndarray | float,
        spring: float = 0.0,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """S, H, (1 + K W)^-1 rest and B, for the stiffness (2, 2) of every contact."""
        stiff, by_section_turn = np.zeros_like(self.coupling), np.zeros((len(excess), self.count))
        for k, block in enumerate(stiffness):
            stiff[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = block
        stiff += cross_coupling
        for k, state in enumerate(contact_states[: self.count]):
            by_section_turn[2 * k : 2 * k + 2, k] = state.by_turn
        both = np.linalg.solve(self._ones + stiff @ self.coupling, np.column_stack([stiff, by_section_turn, excess]))
        contact_stiffness = both[:, : len(excess)]
        if isinstance(cross_coupling, float) and all(state.traction_state is None for state in contact_states):
            contact_stiffness = 0.5 * (contact_stiffness + contact_stiffness.T)
        ball_stiffness = self._both.T @ contact_stiffness @ self._both
        ball_stiffness += (spring + _IDLE * max(np.abs(ball_stiffness).max(), 1.0)) * np.eye(len(ball_stiffness))
        return contact_stiffness, ball_stiffness, both[:, -1], both[:, len(excess) : -1]

    def follow(self, now: LinearisedBalls) -> np.ndarray:
        """(2 Z, 2 Z) motion of the balls that follows a motion of the inner groove centres."""
        return np.linalg.solve(now.ball_stiffness, self._both.T @ now.contact_stiffness @ self._inner)

    def tangent(self, now: LinearisedBalls) -> np.ndarray:
        """(2 Z, 2 Z) stiffness against motions of the inner groove centres."""
        ball_coupling = self._both.T @ now.contact_stiffness @ self._inner
        relief = self._inner.T @ now.contact_stiffness @ self._both @ np.linalg.solve(now.ball_stiffness, ball_coupling)
        return np.asarray(self._inner.T @ now.contact_stiffness @ self._inner - relief)

    def tangent_with_turns(self, now: LinearisedBalls) -> np.ndarray:
        """(3 Z, 3 Z) the same against those motions and, behind them, turns of the inner ring's section."""
        n, by_place = 2 * self.count, now.couple_by_place
        assert by_place is not None
        by_turn = np.array([state.couple_by_turn for state in now.contact_states[: self.count]])
        # D moves by P p' - E e' + W F';  F' = -S (P p' - E e') - B t'.
        by_relative = by_place @ (self._ones - self.coupling @ now.contact_stiffness)
        motion_forces = np.concatenate([now.contact_stiffness @ self._inner, -now.by_section_turn], axis=1)
        balls = np.linalg.solve(now.ball_stiffness, self._both.T @ motion_forces)
        force = motion_forces - now.contact_stiffness @ self._both @ balls
        couple = by_relative @ self._both @ balls
        couple[:, :n] -= by_relative @ self._inner
        couple[:, n:] += np.diag(by_turn) - by_place @ self.coupling @ now.by_section_turn
        return np.concatenate([self._inner.T @ force, couple])

    def couple(self, now: LinearisedBalls) -> np.ndarray:
        """(Z,) couples on the ring's section that equilibrium of the balls will bring, to first order."""
        if now.couple_by_place is None:
            return now.couple
        step, change = self.move(now, np.zeros(2 * self.count))
        displacement = self._both @ step.reshape(-1) + self.coupling @ change.reshape(-1)
        return now.couple + now.couple_by_place @ displacement

    def slip(self, now: LinearisedBalls) -> np.ndarray:
        """(4 Z, 2 Z) change of D that a motion of the inner groove centres brings, the balls following."""
        return self._both @ self.follow(now) - self._inner

    def carried(self, now: LinearisedBalls) -> np.ndarray:
        """(2 Z,) forces of the inner races on the balls that equilibrium of the balls will bring, to first order."""
        relief = self._inner.T @ now.contact_stiffness @ self._both @ np.linalg.solve(now.ball_stiffness, now.balance)
        return (now.force.reshape(-1) + now.carried)[: 2 * self.count] - relief

    def move(self, now: LinearisedBalls, displacement: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Steps of places (Z, 2) and forces (2 Z, 2) when the inner groove centres move by (2 Z,), by Newton."""
        drive = self._both.T @ now.contact_stiffness @ self._inner @ displacement
        step = np.linalg.solve(now.ball_stiffness, now.balance + drive)
        force = now.carried - now.contact_stiffness @ (self._both @ step - self._inner @ displacement)
        return step.reshape(-1, 2), force.reshape(-1, 2)

    def residual(self, now: LinearisedBalls) -> float:
        """Largest force out of balance of any ball or contact [N]."""
        return float(max(np.abs(now.balance).max(), np.abs(now.excess).max()))

    def solve_equilibrium(
        self,
        centre: np.ndarray,
        position: np.ndarray,
        force: np.ndarray,
        rate: np.ndarray,
        tolerance: float,
        applied: AppliedLoads | None = None,
    ) -> tuple[np.ndarray, np.ndarray, LinearisedBalls]:
        """Places, forces and state of the balls in equilibrium while the ring stands; else ConvergenceError."""
        still = np.zeros(2 * self.count)
        now = self.linear(centre, position, force, rate, applied)
        for _ in range(_LIMIT):
            size = self.residual(now)
            scale = max(np.abs(now.force).max(), np.abs(self.loads).max(), 1.0)
            if size <= tolerance * scale:
                return position, force, now
            step, change = self.move(now, still)
            part = min(1.0, self.step / max(np.abs(step).max(), 1e-300))
            for _ in range(8):
                trial = self.linear(centre, position + part * step, force + part * change, rate, applied)
                if self.residual(trial) < (1.0 - 0.1 * part) * size or part < 0.02:
                    break
                part *= 0.4
            position, force, now = position + part * step, force + part * change, trial
            if self.residual(now) >= size and size <= 1e3 * tolerance * scale:
                return position, force, now
        why = "the balls have no equilibrium between the races"
        raise ConvergenceError(why, {"place": position, "residual": self.residual(now)})
