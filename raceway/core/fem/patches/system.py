"""The ring on balls whose contacts are nodal patches: the interface of ``raceway.core.ring.ring.Ring``, stepped from Python."""

from collections.abc import Callable
from functools import partial
from typing import TypeVar

import attrs
import numpy as np

from raceway.core.fem.patches.balls import AppliedLoads, Balls, Gyroscopic, LinearisedBalls
from raceway.core.fem.patches.friction import Traction
from raceway.core.fem.patches.patch import Patch
from raceway.core.fem.patches.pressure import BeyondPatch, Contact, ContactState, PointLaw
from raceway.core.record import Record
from raceway.core.ring.kernels import layout
from raceway.core.ring.kernels.layout import place
from raceway.core.ring.ring import AT_ONCE, TOLERANCE, Evaluation, Increment
from raceway.core.ring.system import SteppedRing
from raceway.core.signatures import Constants
from raceway.errors import ConvergenceError, MeshError

#: Columns before the slips: energy lost, number of velocities known, the last velocity, the one before, number of the patches.
_LOST, _VELOCITIES, _LAST, _BEFORE, _GRID, _SLIP = range(6)


@attrs.frozen(eq=False)
class SlipHistory:
    """One state's memory."""

    lost: np.ndarray  # (2 Z,) energy that friction has taken [J]
    velocities: int  # 0 to 2, how many are known
    #: last, before : (Z, 2) velocities of the balls [m/s]
    last: np.ndarray
    before: np.ndarray
    grid: int  # number of the patches on which the slips lie
    slip: np.ndarray  # (2 Z, points) [m], beyond the slip of the contact as a whole; without columns at first

    @classmethod
    def of(cls, memory: np.ndarray, balls: int) -> "SlipHistory":
        """From the rows of a memory (2 Z, 0 or more)."""
        if memory.shape[1] < _SLIP:
            none = np.zeros((balls, 2))
            return cls(np.zeros(2 * balls), 0, none, none, 0, np.zeros((2 * balls, 0)))
        last, before = (memory[:, column].reshape(2, -1).T for column in (_LAST, _BEFORE))
        return cls(memory[:, _LOST], int(memory[0, _VELOCITIES]), last, before, int(memory[0, _GRID]), memory[:, _SLIP:])

    def slips(self, reference: np.ndarray, generations: list[tuple[Patch, Patch]]) -> list[np.ndarray]:
        """Of the points of every contact on the last of the patches [m]; reference (2 Z,): of the contacts as a whole."""
        balls, now, then = len(reference) // 2, generations[-1], generations[self.grid]
        out = []
        for k, contact_slip in enumerate(reference):
            patch, before = now[k // balls], then[k // balls]
            if not self.slip.shape[1]:
                out.append(np.full(patch.rows * patch.columns, contact_slip))
            elif patch is before:
                out.append(contact_slip + self.slip[k, : patch.rows * patch.columns])
            else:
                out.append(contact_slip + _wider_slip(self.slip[k, : before.rows * before.columns], before, patch))
        return out

    def with_inertia(self, loads: AppliedLoads, mass: float, dt: float, gain: float, rate: np.ndarray) -> AppliedLoads:
        """With the force -m a of balls that move at gain * place + rate, a from the velocities before (BDF 2, at first BDF 1)."""
        if not self.velocities:
            return loads
        if self.velocities == 1:
            to_v, history = 1.0 / dt, -self.last / dt
        else:
            to_v, history = 1.5 / dt, (0.5 * self.before - 2.0 * self.last) / dt
        return attrs.evolve(loads, push=-mass * (to_v * rate + history), spring=mass * to_v * gain)

    def after(
        self, velocity: np.ndarray | None, traction_state: list[Traction | None], reference: np.ndarray, grid: int = 0
    ) -> np.ndarray:
        """(2 Z, 5 + points) the memory when the step is accepted; velocity (Z, 2) of the balls, None in a series of equilibria."""
        tractions = [traction for traction in traction_state if traction is not None]
        points = max((len(traction.slip) for traction in tractions), default=0)
        out = np.zeros((len(traction_state), _SLIP + points))
        out[:, _LOST], out[:, _GRID] = self.lost, grid
        if velocity is not None:
            out[:, _VELOCITIES] = min(self.velocities + 1, 2)
            out[:, _LAST], out[:, _BEFORE] = velocity.T.reshape(-1), self.last.T.reshape(-1)
        for k, traction in enumerate(tractions):
            out[k, _LOST] += traction.lost
            out[k, _SLIP : _SLIP + len(traction.slip)] = traction.slip - reference[k]
        return out


def _wider_slip(slip: np.ndarray, before: Patch, now: Patch) -> np.ndarray:
    """Slips on wider patches: linear between rows; points that are new have not carried and follow the ball, as the corner does."""
    old = slip.reshape(before.rows, before.columns)
    out = np.full((now.rows, now.columns), old[0, 0])
    more = (now.columns - before.columns) // 2
    for column in range(before.columns):
        ends = float(old[0, column]), float(old[-1, column])
        out[:, more + column] = np.interp(now.race.angle, before.race.angle, old[:, column], *ends)
    return out.reshape(-1)


T = TypeVar("T")
#: Largest step of a ball or the ring in an iteration, of the ball's diameter.
STEP = 5e-4
#: How often the patches may be made wider for one solution.
_WIDER = 12


@attrs.define(eq=False)
class _Row:
    """The balls' solver of one system and where it was last."""

    balls: Balls
    force: np.ndarray  # (2 Z, 2) contact forces on the balls [N]
    #: the state of the last solution, with the places (Z, 2) of groove centres and balls there [m]
    last: LinearisedBalls | None = None
    centre: np.ndarray = attrs.field(factory=lambda: np.zeros((0, 2)))
    where: np.ndarray = attrs.field(factory=lambda: np.zeros((0, 2)))

    def solve_equilibrium(
        self, centre: np.ndarray, where: np.ndarray, rate: np.ndarray, tolerance: float, loads: AppliedLoads | None = None
    ) -> tuple[np.ndarray, LinearisedBalls]:
        """Balls in equilibrium between grooves at ``centre`` (Z, 2): places (Z, 2) and state; ``where`` is the first guess.

        Near the last solution its linearisation predicts places and forces better than any guess.
        """
        force = self.force
        if self.last is not None and np.abs(centre - self.centre).max() < STEP * np.abs(self.where).max():
            step, change = self.balls.move(self.last, (centre - self.centre).reshape(-1))
            try:
                near = self.balls.solve_equilibrium(centre, self.where + step, self.force + change, rate, tolerance, loads)
                return self._keep(centre, near)
            except ConvergenceError:
                pass  # from the guess, then
        return self._keep(centre, self.balls.solve_equilibrium(centre, where, force, rate, tolerance, loads))

    def _keep(
        self, centre: np.ndarray, solution: tuple[np.ndarray, np.ndarray, LinearisedBalls]
    ) -> tuple[np.ndarray, LinearisedBalls]:
        self.centre, (self.where, self.force, self.last) = centre, solution
        return self.where, self.last


class Pool:
    """Patches of both races and solvers for any set of balls on them.

    patches : of the inner and the outer race
    laws : at the points of the inner and the outer race; None for no penetration
    wider : called with a ``BeyondPatch``, returns patches that reach further; None: contact that leaves is an error
    friction : coefficient of Coulomb friction; the patches have compliances along the groove where it is not 0
    """

    def __init__(
        self,
        patches: tuple[Patch, Patch],
        laws: tuple[PointLaw | None, PointLaw | None] = (None, None),
        wider: Callable[[BeyondPatch], tuple[Patch, Patch]] | None = None,
        friction: float = 0.0,
    ) -> None:
        self.generations, self.laws, self._wider, self.friction = [patches], laws, wider, friction
        self._rows: dict[tuple[bool, tuple[float, ...]], _Row] = {}

    @property
    def patches(self) -> tuple[Patch, Patch]:
        """Of the inner and the outer race, the widest so far."""
        return self.generations[-1]

    @property
    def diameter(self) -> float:
        """Of the balls [m]."""
        return 2.0 * self.patches[0].ball.radius

    def row(self, table: np.ndarray, with_friction: bool = False) -> _Row:
        """The solver for the balls of a system's ``table``; ``with_friction``: with friction."""
        key = with_friction, tuple(table[:, layout.CENTRIFUGAL].tolist())
        if key not in self._rows:
            z = len(table)
            both, friction = zip(self.patches, self.laws, strict=True), self.friction if with_friction else 0.0
            contacts = [Contact(patch, law, friction) for patch, law in both for _ in range(z)]
            loads = np.zeros((z, 2))
            loads[:, 1] = table[:, layout.CENTRIFUGAL]
            # (4 Z, 4 Z) W: between the poles of a ball, and between the balls of a row through both rings
            row = len(self.patches[0].race.crossing)
            out = np.zeros((2, z, 2, 2, z, 2))
            ball = np.arange(z)
            for component in (0, 1):
                for side, opposite in ((0, 1), (1, 0)):
                    out[side, ball, component, opposite, ball, component] = -self.patches[0].ball.opposite
            for race, patch in enumerate(self.patches):
                for k in range(z):
                    first = k // row * row
                    for neighbour in range(first, first + row):
                        out[race, k, :, race, neighbour, :] += patch.race.crossing[(k - neighbour) % row]
            balls = Balls(contacts, out.reshape(4 * z, 4 * z), loads, STEP * self.diameter)
            self._rows[key] = _Row(balls, np.zeros((2 * z, 2)))
        return self._rows[key]

    def widened(self, solve: Callable[[], T]) -> T:
        """The solution, on patches that are made wider while the contact leaves them.

        ConvergenceError: The contact leaves every patch, or nothing makes them wider.
        """
        for _ in range(_WIDER):
            try:
                return solve()
            except BeyondPatch as left:
                if self._wider is None:
                    raise ConvergenceError(str(left)) from left
                try:
                    self.generations.append(self._wider(left))
                except MeshError as why:  # the bodies were meshed: what cannot be is this contact
                    raise ConvergenceError(f"the balls leave the races: {left} ({why})") from why
                self._rows.clear()
        raise ConvergenceError("the contacts leave every patch: no equilibrium near the first guess")


@attrs.frozen(eq=False)
class _Grooves:
    """The inner grooves at every ball.

    centre, velocity : (Z, 2) of the groove centres [m, m/s];  jacobian : (2 Z, 5) derivatives of ``centre`` by q
    turning : (Z, 5) turn of the ring's section by q
    """

    centre: np.ndarray
    jacobian: np.ndarray
    velocity: np.ndarray
    turning: np.ndarray


_LIMIT = 60
#: Balls' residual over the largest contact force at which they are in equilibrium.
_BALLS = 1e-11


@attrs.define(eq=False, kw_only=True)
class PatchSystem(SteppedRing):
    """M q'' + C q' + K q + f(q, q') = load + force(t), f from pressures at surface points of finite elements.

    ``memory`` (2 Z, 5 + points) is empty at first.  Columns: energy that friction has taken [J]; how many velocities of
    the balls are known; the last one and the one before, axial in the inner races' rows and radial in the outer ones'
    [m/s]; number of the patches; slips of the points beyond those of ``ball`` [m].  Balls have the acceleration (3 v1 - 4 v0 + v(-1)) / (2 dt).
    """

    pool: Pool  # patches and solvers, shared by all copies of this system
    ball_mass: float = 0.0  # of one ball [kg]; 0 leaves out its inertia in steps of time

    def of_balls(self, balls: np.ndarray, table: np.ndarray) -> "PatchSystem":
        """With the rigid ring of these balls."""
        return attrs.evolve(super().of_balls(balls, table), rigid=self.rigid.of_balls(balls, table))

    @property
    def conservative(self) -> bool:
        return self.pool.friction == 0.0 and self.scalars[layout.GYROSCOPIC] == 0.0

    @property
    def gyroscopic(self) -> Gyroscopic | None:
        """Moments of the balls, where the scene has them."""
        s = self.scalars
        if s[layout.GYROSCOPIC] == 0.0:
            return None
        return Gyroscopic(
            float(s[layout.GYROSCOPIC]), float(s[layout.BALL_OVER_PITCH]), (float(s[layout.SHARE_INNER]), float(s[layout.SHARE_OUTER])), float(s[layout.DIAMETER]),
            self.pool.patches[0].race.groove, float(s[layout.TRACTION]),
        )  # fmt: skip

    @property
    def ball_columns(self) -> int:
        return 2 if self.conservative else 4

    @property
    def with_friction(self) -> bool:
        """Whether friction acts where its history is known."""
        return self.pool.friction > 0.0 and bool(self.scalars[layout.FRICTION] > 0.0)

    def evaluate(
        self, q: np.ndarray, v: np.ndarray | None = None, ball: np.ndarray | None = None,
        ball_rate: np.ndarray | None = None, t: float = 0.0, step: Increment = AT_ONCE,
    ) -> Evaluation:  # fmt: skip
        q = np.asarray(q, dtype=float)
        v = np.zeros(5) if v is None else np.asarray(v, dtype=float)
        return self.pool.widened(lambda: self._evaluate(q, v, ball, ball_rate, t, step))

    def _evaluate(
        self, q: np.ndarray, v: np.ndarray, ball: np.ndarray | None, ball_rate: np.ndarray | None, t: float, step: Increment
    ) -> Evaluation:
        history = SlipHistory.of(self.law_state if step.memory is None else step.memory, self.ball_count)
        dt, gain = step.dt, step.gain
        with_friction = self.with_friction and ball is not None  # without a history nothing sticks
        row = self.pool.row(self.table, with_friction)
        grooves = self._grooves(q, v, t)
        where = self._places(grooves.centre, ball)
        moving = bool(v.any()) or ball_rate is not None
        rate = self._rates(row, grooves.velocity, where, ball_rate, gain) if moving else np.zeros((2 * self.ball_count, 2))
        loads = AppliedLoads(grooves.turning @ q, gyroscopic=self.gyroscopic)
        if with_friction and ball is not None:
            loads = attrs.evolve(loads, slip=history.slips(ball[:, 2:4].T.reshape(-1), self.pool.generations))
        if self.ball_mass > 0.0 and dt > 0.0 and ball_rate is not None:
            loads = history.with_inertia(loads, self.ball_mass, dt, gain, ball_rate[:, :2])
        where, now = row.solve_equilibrium(grooves.centre, where, rate, _BALLS, loads)
        answer = self._answer(row.balls, grooves, where, rate, now)
        ball_velocity = None if ball_rate is None or dt <= 0.0 else gain * where + ball_rate[:, :2]
        reference = np.zeros((self.ball_count, 2)) if ball is None or ball.shape[1] < 4 else ball[:, 2:4]
        tractions = [state.traction_state for state in now.contact_states]
        after = history.after(ball_velocity, tractions, reference.T.reshape(-1), len(self.pool.generations) - 1)
        columns = where if self.conservative else np.concatenate([where, reference], axis=1)
        return attrs.evolve(answer, ball=columns, memory=after)

    def stiffness_at(self, q: np.ndarray, now: Evaluation) -> np.ndarray:
        """Stiffness of the contacts (5, 5) at an equilibrium, without the ripple of points that come and go."""

        def smooth_stiffness() -> np.ndarray:
            self._evaluate(np.asarray(q, dtype=float), np.zeros(5), now.ball, None, 0.0, AT_ONCE)
            row = self.pool.row(self.table, self.with_friction)
            assert row.last is not None
            state = row.balls.smoothed_stiffness(row.last, row.centre, row.where)
            return self._stiffness(row.balls, state, self._grooves(q, np.zeros(5), 0.0))

        return self.pool.widened(smooth_stiffness)

    def solve_equilibrium(
        self, q: np.ndarray, ball: np.ndarray | None = None, tolerance: float = TOLERANCE
    ) -> tuple[np.ndarray, np.ndarray, int]:
        """Equilibrium under ``load``: ring and balls together by Newton, from the equilibrium of rigid bodies.

        Friction is left out: the balls have rolled into place, and their slips are such that no point carries traction.

        ConvergenceError: With the last state.
        """
        if ball is not None and np.any(ball):
            try:
                return self._roll(*self.pool.widened(lambda: self._newton(q, np.asarray(ball), self.load, tolerance)))
            except ConvergenceError:
                pass  # from rigid bodies, then
        for parts in (1, 4, 16):  # of the load, the first from the equilibrium of rigid bodies
            try:
                rigid = attrs.evolve(self.surrogate, load=self.load / parts)
                (q_part, where, _), total = rigid.solve_equilibrium(q), 0
                for part in range(1, parts + 1):
                    task = partial(self._newton, q_part, where, self.load * (part / parts), tolerance)
                    q_part, where, count = self.pool.widened(task)
                    total += count
                return self._roll(q_part, where, total)
            except ConvergenceError as why:
                if parts == 16 or "nothing holds" in str(why):
                    raise
        raise AssertionError("unreachable")

    def _roll(self, q: np.ndarray, ball: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray, int]:
        if not self.conservative:
            ball = np.concatenate([ball, self.stress_free_slip(q, ball)], axis=1)
        return q, ball, count

    def stress_free_slip(self, q: np.ndarray, ball: np.ndarray, t: float = 0.0) -> np.ndarray:
        self.without(layout.FRICTION).evaluate(q, ball=ball, t=t)
        row = self.pool.row(self.table)
        turn = self._grooves(q, np.zeros(5), t).turning @ q
        assert row.last is not None
        places = [
            contact.along(position, float(turn[k % self.ball_count]))
            for k, (contact, position) in enumerate(zip(row.balls.contacts, row.last.relative, strict=True))
        ]
        return np.array(places).reshape(2, -1).T

    def friction_lost(self, record: Record) -> float:
        """Energy that friction has taken at the end of a record that began without history [J]."""
        memory = self.law_state if record.final.memory is None else record.final.memory
        return float(SlipHistory.of(memory, self.ball_count).lost.sum())

    def _newton(
        self, q: np.ndarray, ball: np.ndarray, load: np.ndarray, tolerance: float
    ) -> tuple[np.ndarray, np.ndarray, int]:
        row, none = self.pool.row(self.table), np.zeros(5)
        balls = row.balls
        still = np.zeros((2 * self.ball_count, 2))
        q = q.copy()
        grooves, gyroscopic = self._grooves(q, none, 0.0), self.gyroscopic
        jacobian, turning = grooves.jacobian, grooves.turning
        where, force = self._places(grooves.centre, ball), np.zeros((2 * self.ball_count, 2))
        now = balls.linear(grooves.centre, where, force, still, AppliedLoads(turning @ q, gyroscopic=gyroscopic))
        weight = np.array([1.0, 1.0, 1.0, 1.0 / self.arm, 1.0 / self.arm]) * self.free
        limit = STEP * self.pool.diameter
        free = self.free > 0.0
        best = np.inf
        for iteration in range(1, _LIMIT + 1):
            imbalance = jacobian.T @ balls.carried(now) + turning.T @ balls.couple(now) + self.stiffness @ q - load
            out = jacobian.T @ now.force[: self.ball_count].reshape(-1) + turning.T @ now.couple + self.stiffness @ q - load
            size = max(float(np.abs(out * weight).max()), balls.residual(now))
            scale = float(np.abs(now.force[: self.ball_count]).sum() + np.abs(load * weight).sum())
            relative = size / max(scale, 1e-300)
            if relative <= tolerance or (relative <= 1e3 * tolerance and size >= best):
                row.force, row.last, row.centre, row.where = now.force, now, grooves.centre, where
                return q, where, iteration
            best = min(best, size)
            tangent = self._stiffness(balls, now, grooves) + self.stiffness
            dq = np.zeros(5)
            matrix = self.reduced(tangent)
            matrix += 1e-12 * max(np.trace(matrix), 1.0) * np.eye(len(matrix))
            dq[free] = np.linalg.solve(matrix, -imbalance[free])
            step, change = balls.move(now, jacobian @ dq)
            reach = max(float(np.abs(jacobian @ dq).max()), float(np.abs(step).max()))
            if not np.isfinite(reach):
                break
            part = min(1.0, limit / max(reach, 1e-300))
            before = size
            for _ in range(6):
                trial_q = q + part * dq
                grooves = self._grooves(trial_q, none, 0.0)
                loads = AppliedLoads(turning @ trial_q, gyroscopic=gyroscopic)
                trial = balls.linear(grooves.centre, where + part * step, force + part * change, still, loads)
                out = jacobian.T @ trial.force[: self.ball_count].reshape(-1) + turning.T @ trial.couple
                out += self.stiffness @ trial_q - load
                if max(float(np.abs(out * weight).max()), balls.residual(trial)) < 2.0 * before:
                    break
                part *= 0.4
            q, where, force, now = trial_q, where + part * step, force + part * change, trial
        why = (
            f"no static equilibrium of the nodal contacts found after {_LIMIT} iterations, relative residual {relative:.1e}"
        )
        raise ConvergenceError(why, {"q": q, "ball": where})

    def pressures(self) -> list[ContactState]:
        """Answers of all contacts, inner races first, at the last state."""
        last = self.pool.row(self.table, self.with_friction).last
        return [] if last is None else last.contact_states

    def _answer(
        self, balls: Balls, grooves: _Grooves, where: np.ndarray, rate: np.ndarray, now: LinearisedBalls
    ) -> Evaluation:
        force = now.force + now.excess  # of pressures, friction and gyroscopic moments
        pressures = np.array([state.force if state.traction_state is None else state.normal for state in now.contact_states])
        size = np.hypot(pressures[:, 0], pressures[:, 1])
        viscous = np.zeros((4 * self.ball_count, 4 * self.ball_count))
        for k, state in enumerate(now.contact_states):
            block = state.viscous
            if self.scalars[layout.DAMPING] > 0.0 and size[k] > 0.0:
                normal = pressures[k] / size[k]
                dashpot = self.scalars[layout.DAMPING] * np.outer(normal, normal)
                pull = -float(normal @ dashpot @ rate[k])
                if size[k] + pull > 0.0:
                    force[k] += pull * normal
                    size[k] += pull
                    block = block + dashpot
            viscous[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = block
        along = balls.slip(now) @ grooves.jacobian
        inner = force[: self.ball_count]
        reach = np.concatenate([grooves.centre - where, where])
        first_touch = np.repeat([self.scalars[layout.OFFSET_INNER], self.scalars[layout.OFFSET_OUTER]], self.ball_count)
        on_ring = grooves.jacobian.T @ inner.reshape(-1) + grooves.turning.T @ now.couple
        gap, stiffness = first_touch - np.hypot(reach[:, 0], reach[:, 1]), self._stiffness(balls, now, grooves)
        return Evaluation(on_ring, stiffness, along.T @ viscous @ along, gap, size, where, self.law_state.copy())

    @staticmethod
    def _stiffness(balls: Balls, now: LinearisedBalls, grooves: _Grooves) -> np.ndarray:
        """(5, 5) against motions of the ring."""
        if now.couple_by_place is None:
            return np.asarray(grooves.jacobian.T @ balls.tangent(now) @ grooves.jacobian)
        both = np.concatenate([grooves.jacobian, grooves.turning])
        return np.asarray(both.T @ balls.tangent_with_turns(now) @ both)

    def _grooves(self, q: np.ndarray, v: np.ndarray, t: float) -> _Grooves:
        work = np.zeros((3, 2 * self.ball_count))
        place(float(t), np.ascontiguousarray(q, dtype=float), v, Constants(self.scalars, self.table), work, (0, 1, 2))
        (c, s), centre, velocity = work[0].reshape(2, -1), work[1].reshape(2, -1).T.copy(), work[2].reshape(2, -1).T.copy()
        side, lever = self.table[:, layout.SIDE], self.table[:, layout.LEVER]
        arm = self.scalars[layout.TILT_ARM]
        jacobian, turning = np.zeros((self.ball_count, 2, 5)), np.zeros((self.ball_count, 5))
        jacobian[:, 0, 0], jacobian[:, 0, 3], jacobian[:, 0, 4] = side, side * arm * s, -side * arm * c
        jacobian[:, 1, 1], jacobian[:, 1, 2] = c, s
        jacobian[:, 1, 3], jacobian[:, 1, 4] = -lever * s, lever * c
        turning[:, 3], turning[:, 4] = side * s, -side * c
        return _Grooves(centre, jacobian.reshape(-1, 5), velocity, turning)

    def _places(self, centre: np.ndarray, ball: np.ndarray | None) -> np.ndarray:
        """(Z, 2) first guess of the balls' places; rows of zeros are guessed from the groove centres."""
        out = np.zeros((self.ball_count, 2)) if ball is None else np.array(ball[:, :2], dtype=float)
        unknown = ~out.any(axis=1)
        if unknown.any():
            reach = np.hypot(centre[:, 0], centre[:, 1])
            li, lo = self.scalars[layout.OFFSET_INNER], self.scalars[layout.OFFSET_OUTER]
            over = reach - li - lo
            share = np.where(over > 0.0, (lo + self.table[:, layout.OUTER_SHARE] * over) / reach, lo / (li + lo))
            out[unknown] = (share[:, None] * centre)[unknown]
        return out

    def _rates(
        self, row: _Row, velocity: np.ndarray, where: np.ndarray, ball_rate: np.ndarray | None, gain: float
    ) -> np.ndarray:
        """(2 Z, 2) velocities of the balls seen from both grooves; balls follow the ring where no rate is given."""
        if ball_rate is not None:
            ball = gain * where + ball_rate[:, :2]
        elif row.last is not None:
            ball = (row.balls.follow(row.last) @ velocity.reshape(-1)).reshape(-1, 2)
        else:
            ball = self.table[:, [layout.OUTER_SHARE]] * velocity
        return np.concatenate([ball - velocity, ball])
