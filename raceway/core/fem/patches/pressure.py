"""One ball against one race: resultant, tangent and pressures for a given place of the ball in the groove."""

import attrs
import numpy as np
from scipy.linalg import cho_factor, cho_solve

from raceway.core.contact.hertz import Ellipse
from raceway.core.fem.patches.compliance import ComplianceFactor
from raceway.core.fem.patches.friction import Friction, Traction, only_largest
from raceway.core.fem.patches.patch import Patch, derivatives, sphere_in_torus
from raceway.core.jit import Kernel
from raceway.errors import ConvergenceError, RacewayError

_LIMIT = 60
#: Residual of the gaps that counts as none, of the deepest overlap.
_TOLERANCE = 1e-11


@attrs.frozen(eq=False)
class PointLaw:
    """A law without memory at the points of one contact: its ``LAW``, its params (k,), the area of a point [m2]."""

    kernel: Kernel
    params: np.ndarray
    area: float

    def __call__(self, gap: np.ndarray, rate: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Forces of points (n,) [N] and their derivatives by gap and by gap rate."""
        n = len(gap)
        none = np.zeros((n, 0))
        pressure, by_gap, by_rate = np.empty(n), np.empty(n), np.empty(n)
        params = np.tile(self.params, (n, 1))  # a broadcast of a single row would be read-only, which no kernel takes
        self.kernel(np.ascontiguousarray(gap), rate, params, none, none.copy(), 0.0, pressure, by_gap, by_rate)
        return self.area * pressure, self.area * by_gap, self.area * by_rate


@attrs.frozen(eq=False)
class _LawState:
    """Points that carry something."""

    #: nodes, load : (n,) [N]
    nodes: np.ndarray
    load: np.ndarray
    gap: np.ndarray  # (n,) left open by the law: its penetration [m]
    lower: tuple[np.ndarray, bool] | None  # factor of C + 1/D
    viscous: np.ndarray  # (n,) the law's rate derivative over D [s]
    iterations: int

    def solve(self, right: np.ndarray) -> np.ndarray:
        """(C + 1/D)^-1 right."""
        return cho_solve(self.lower, right, check_finite=False) if len(self.nodes) else np.zeros_like(right)


def _by_law(gap: np.ndarray, rate: np.ndarray, law: PointLaw, start: np.ndarray, factor: ComplianceFactor) -> _LawState:
    """Pressures at gaps (rows * columns,) that change at rates of the same shape.

    start : (rows * columns,) penetrations w of a similar state, zeros when there is none; overwritten by those found
    ConvergenceError: Newton stalls.

    With D = -A dp/dw the loads change by t with (1/D + C) t = w - g - C f over the points with D > 0: symmetric and positive
    definite for every law that grows with the approach. All gaps then become w = g + C (f + t). The step is halved where the
    residual grew.
    """
    near = np.flatnonzero(gap < 0.0)
    if not len(near):
        return _LawState(near, np.zeros(0), np.zeros(0), None, np.zeros(0), 0)
    compliance = factor.block(near, near)
    g, v = gap[near], np.ascontiguousarray(rate[near])
    depth = abs(g.min())
    w = np.minimum(start[near], 0.0)
    if not (w < 0.0).any():
        w = np.where(g < -0.5 * depth, 0.02 * g, 0.0)
    before, count = np.inf, 0
    while count < _LIMIT:
        count += 1
        load, by_gap, by_rate = law(w, v)
        residual = g + compliance @ load - w
        now = float(np.abs(residual).max())
        if now <= _TOLERANCE * depth:
            break
        active = np.flatnonzero(by_gap < 0.0)
        more = np.zeros(len(near))
        if len(active):
            more[active] = -cho_solve(_factor(compliance, active, -by_gap[active]), residual[active], check_finite=False)
        step = residual + compliance @ more
        w = w + (1.0 if now < before else 0.5) * step
        before = now
    else:
        raise ConvergenceError(f"the pressures of the contact law did not converge in {_LIMIT} iterations")
    start[:] = 0.0
    start[near] = np.minimum(w, 0.0)
    active = np.flatnonzero((load > 0.0) & (by_gap < 0.0))
    stiff = -by_gap[active]
    lower = _factor(compliance, active, stiff) if len(active) else None
    return _LawState(near[active], load[active], w[active], lower, by_rate[active] / stiff, count)


def _factor(compliance: np.ndarray, active: np.ndarray, stiff: np.ndarray) -> tuple[np.ndarray, bool]:
    matrix = compliance[np.ix_(active, active)]
    matrix[np.diag_indices(len(active))] += 1.0 / stiff
    factor: tuple[np.ndarray, bool] = cho_factor(matrix, lower=True, check_finite=False)
    return factor


#: Iterations with whole exchanges, after which only the worst point is exchanged, and their largest number.
_WHOLE, _UNILATERAL_LIMIT = 25, 400
#: Penetration that counts as none, of the deepest overlap.
_ROUNDING = 1e-10


def _active_set(gap: np.ndarray, start: np.ndarray, factor: ComplianceFactor) -> tuple[np.ndarray, np.ndarray, int]:
    """Points in contact (n,), ascending, their loads (n,) [N], and the number of iterations.

    gap : (rows * columns,) without elastic displacement [m]
    start : points that were in contact in a similar state, or none
    ConvergenceError: the sets repeat themselves.

    Points that pull leave the set, points that penetrate join it, all at once; near the solution the sets of successive
    iterations are the same.  Entries of C are positive between points of a patch: only points with g < 0 can touch.
    """
    near = np.flatnonzero(gap < 0.0)
    if not len(near):
        return near, np.zeros(0), 0
    deepest = gap[near].min()
    nodes = start[gap[start] < 0.0] if len(start) else start
    if not len(nodes):
        nodes = near[gap[near] < 0.5 * deepest]  # Hertz: half the overlap's area carries
    tolerance = _ROUNDING * abs(deepest)
    for iteration in range(1, _UNILATERAL_LIMIT + 1):
        load = factor.solve(nodes, -gap[nodes])
        free = gap < 0.0
        free[nodes] = False
        outside = np.flatnonzero(free)
        depth = gap[outside] + factor.displacement(outside, nodes, load)
        pulls, joins = load < 0.0, depth < -tolerance
        if not (pulls.any() or joins.any()):
            return nodes, load, iteration
        if iteration > _WHOLE:
            pulls, joins = only_largest(pulls, -load), only_largest(joins & ~pulls.any(), -depth)
        nodes = np.sort(np.concatenate([nodes[~pulls], outside[joins]]))
    raise ConvergenceError(f"the points in contact were not determined in {_UNILATERAL_LIMIT} exchanges")


class BeyondPatch(RacewayError):
    """Points in contact at the end of a patch that could be larger: what it must reach.

    sense : of the race, -1 inner, 1 outer;  angle : contact angle of the resultant [rad];  load : of the contact [N]
    across : whether it left along the rolling direction
    """

    def __init__(self, sense: float, angle: float, load: float, across: bool) -> None:
        race = "inner" if sense < 0.0 else "outer"
        way = "the rolling direction" if across else "the groove"
        super().__init__(
            f"the contact on the {race} race, {load:.4g} N at {np.degrees(angle):.2f} deg, exceeds its patch of surface points along {way}"
        )
        self.sense, self.angle, self.load, self.across = sense, angle, load, across


@attrs.frozen(eq=False)
class ContactState:
    """A contact's answer."""

    force: np.ndarray  # (2,) on the ball, axial and radial [N]
    stiffness: np.ndarray  # (2, 2) minus its derivative by the ball's place [N/m]
    viscous: np.ndarray  # (2, 2) minus its derivative by the ball's velocity [N s/m]
    #: nodes, load : (n,) points that carry and their forces [N], number k * columns + i
    nodes: np.ndarray
    load: np.ndarray
    penetration: float = 0.0  # largest one that a law leaves [m]
    truncated: bool = False  # whether points at the groove's edge carry
    along: np.ndarray = attrs.field(factory=lambda: np.zeros((2, 2)))  # (2, 2) what friction adds to ``stiffness``
    couple: float = 0.0  # of friction on the section of the ring, derivative of its work by the section's turn [N m]
    by_turn: np.ndarray = attrs.field(factory=lambda: np.zeros(2))  # (2,) minus the derivative of the force by that turn [N]
    couple_by_place: np.ndarray = attrs.field(factory=lambda: np.zeros(2))  # (2,) [N]
    couple_by_turn: float = 0.0  # [N m]
    traction_state: Traction | None = None  # tractions along the groove; None without friction
    #: (2,) the part of ``force`` that pressures make, where there is friction [N]
    normal: np.ndarray = attrs.field(factory=lambda: np.zeros(2))


@attrs.frozen(eq=False)
class SlipState:
    """State of friction at a contact: the turn of the ring's section [rad], slips (rows * columns,) [m]."""

    turn: float
    slip: np.ndarray


#: Places of the points over which a mean is taken.
_PLACES = 8
_NONE = np.zeros(0, dtype=np.int64)


class Contact:
    """One ball-race pair with the memory that makes the next solution cheap: points in contact and their factor.

    patch : Patch;  law : what gives the pressure at a point; None for no penetration
    friction : coefficient of Coulomb friction; the patch has compliances along the groove where it is not 0
    """

    def __init__(self, patch: Patch, law: PointLaw | None, friction: float = 0.0) -> None:
        self.patch, self.law = patch, law
        self.friction = Friction(patch, friction) if friction > 0.0 else None
        self._factor = ComplianceFactor(patch)
        self._nodes = _NONE
        self._depth = np.zeros(patch.rows * patch.columns)
        self._gap = np.empty((patch.rows, patch.columns))
        self.iterations = 0

    def press(self, position: np.ndarray, rate: np.ndarray, slipping: SlipState | None = None) -> ContactState:
        """Solve for a place (2,) and a velocity (2,) of the ball's centre, seen from the groove's centre.

        Friction acts where ``slipping`` is given.

        BeyondPatch: Contact at the end of the patch, short of the groove's edge.
        """
        patch = self.patch
        axial, radial = float(position[0]), float(position[1])
        sphere_in_torus(axial, radial, patch.points, self._gap)
        gap = self._gap.reshape(-1)
        if not (gap < 0.0).any():
            return self._open(position, slipping)
        if self.law is None:
            nodes, load, count = _active_set(gap, self._nodes, self._factor)
            solve = lambda right: self._factor.solve(nodes, right)  # noqa: E731
            state, penetration = None, 0.0
        else:
            every = np.arange(len(gap))
            speed = self._derivatives(every, np.zeros(len(gap)), axial, radial)[0] @ rate
            state = _by_law(gap, speed, self.law, self._depth, self._factor)
            nodes, load, count, solve = state.nodes, state.load, state.iterations, state.solve
            penetration = float(-state.gap.min(initial=0.0))
        self.iterations += count
        self._nodes = nodes
        if not len(nodes):
            return self._open(position, slipping)
        slope, curvature = self._derivatives(nodes, load, axial, radial)
        force = slope.T @ load
        load_slope = solve(slope)
        stiffness = slope.T @ load_slope - curvature
        viscous = np.zeros((2, 2))
        if state is not None and state.viscous.any():
            viscous = -load_slope.T @ (state.viscous[:, None] * slope)
        normal = ContactState(force, stiffness, viscous, nodes, load, penetration, self._ends(nodes, force))
        return normal if slipping is None else self._friction_forces(normal, position, slipping, -load_slope)

    def mean_stiffness(self, position: np.ndarray) -> np.ndarray:
        """(2, 2) stiffness as ``press`` gives it, the mean over all places of the points under the ellipse [N/m].

        A set of points changes in steps as the ellipse slides over it, and the stiffness of the set with it, by some percent.
        Turned about the groove's centre by one distance of rows the ellipse meets the same points again: the mean over
        that distance has no ripple.
        """
        pitch = self.patch.race.angle[1] - self.patch.race.angle[0]
        memory = self._nodes, self._depth.copy()
        total = np.zeros((2, 2))
        for angle in pitch * ((np.arange(_PLACES) + 0.5) / _PLACES - 0.5):
            c, s = np.cos(angle), np.sin(angle)
            turn = np.array([[c, s], [-s, c]])
            total += turn.T @ self.press(turn @ position, np.zeros(2)).stiffness @ turn
        self._nodes, self._depth = memory
        return total / _PLACES

    def _open(self, position: np.ndarray, slipping: SlipState | None) -> ContactState:
        self._nodes = _NONE
        zero = np.zeros((2, 2))
        open_ = ContactState(np.zeros(2), zero, zero, _NONE, np.zeros(0))
        return open_ if slipping is None else self._friction_forces(open_, position, slipping, np.zeros((0, 2)))

    def along(self, position: np.ndarray, turn: float = 0.0) -> float:
        """Place of the contact along the groove [m]: all points of the ball move so far over the race."""
        race = self.patch.race
        angle = np.arctan2(race.sense * position[0], race.sense * position[1])
        return float((race.groove - self.patch.ball.radius) * angle - (race.groove * turn if race.sense < 0.0 else 0.0))

    def _friction_forces(
        self, normal: ContactState, position: np.ndarray, slipping: SlipState, load_by_place: np.ndarray
    ) -> ContactState:
        """With friction; load_by_place (n, 2): derivatives of the points' forces by the ball's place [N/m]."""
        assert self.friction is not None
        race = self.patch.race
        traction_state = self.friction.pull(normal.nodes, normal.load, self.along(position, slipping.turn), slipping.slip)
        length = float(np.hypot(*position))
        n = race.sense * position / length
        t = np.array([n[1], -n[0]])
        lever = (race.groove - self.patch.ball.radius) / length
        ahead = race.sense * lever * t  # derivative of the place along the groove by the ball's
        tau = traction_state.force
        by_place = traction_state.by_place * ahead + traction_state.by_load @ load_by_place
        along = np.outer(ahead, by_place) - tau * lever / length * (np.outer(t, n) + np.outer(n, t))
        arm = race.groove if race.sense < 0.0 else 0.0
        return attrs.evolve(
            normal, force=normal.force - tau * ahead, stiffness=normal.stiffness + along, along=along, traction_state=traction_state, normal=normal.force,
            couple=-arm * tau, by_turn=-arm * traction_state.by_place * ahead, couple_by_place=-arm * by_place,
            couple_by_turn=arm * arm * traction_state.by_place,
        )  # fmt: skip

    def _derivatives(
        self, nodes: np.ndarray, load: np.ndarray, axial: float, radial: float
    ) -> tuple[np.ndarray, np.ndarray]:
        slope, curvature = np.empty((len(nodes), 2)), np.empty(3)
        derivatives(axial, radial, self.patch.points, nodes, np.ascontiguousarray(load), slope, curvature)
        return slope, curvature[[0, 1, 1, 2]].reshape(2, 2)

    def _ends(self, nodes: np.ndarray, force: np.ndarray) -> bool:
        patch = self.patch
        row, column = nodes // patch.columns, nodes % patch.columns
        low, high = row[0] == 0, row[-1] == patch.rows - 1
        first, last = patch.race.ends
        sense = patch.race.sense
        wide = bool((column == 0).any() or (column == patch.columns - 1).any())
        if wide or (low and not first) or (high and not last):
            angle = float(np.arctan2(-sense * force[0], -sense * force[1]))
            raise BeyondPatch(sense, angle, float(np.hypot(*force)), wide)
        return bool(low or high)


#: Room on each side of a window [rad], and around an ellipse, of its semi-axes.
MARGIN, AROUND = np.deg2rad(0.7), 1.15

Window = tuple[float, float]


@attrs.frozen
class Reach:
    """Extent that patches have to cover."""

    #: inner, outer : lowest and highest angle of points in contact [rad]
    inner: Window
    outer: Window
    widest: float  # largest minor semi-axis, with room [m]
    #: mean_load, largest_load : of the balls that carry, on the inner race, and of all contacts [N]
    mean_load: float
    largest_load: float

    def grown(self, beyond: BeyondPatch, ellipse: Ellipse, radius: float, room: float) -> "Reach":
        """One that holds a contact which left this one, by a clear step at least.

        ConvergenceError: A contact as large as the ball: what runs away is not meshed.
        """
        load = max(self.largest_load, beyond.load) * (room if beyond.across else 1.0)
        a, b = ellipse.semi_axes(load)
        if not max(a, b) < radius:
            raise ConvergenceError(f"the balls leave the races: {beyond}, on an ellipse as large as the ball")
        old = self.inner if beyond.sense < 0.0 else self.outer
        half = AROUND * float(a) / radius + 3.0 * MARGIN
        window = _rounded(min(old[0], beyond.angle - half), max(old[1], beyond.angle + half))
        if not beyond.across and window == old:
            window = (old[0] - 3.0 * MARGIN, old[1] + 3.0 * MARGIN)
        widest = max(self.widest, AROUND * float(b))
        if beyond.across and widest == self.widest:
            widest *= room
        inner, outer = (window, self.outer) if beyond.sense < 0.0 else (self.inner, window)
        return Reach(inner, outer, widest, self.mean_load, load)


def _rounded(low: float, high: float) -> Window:
    """Outwards to whole degrees, so that states near each other share their compliances."""
    return float(np.deg2rad(np.floor(np.rad2deg(low) + 1e-6))), float(np.deg2rad(np.ceil(np.rad2deg(high) - 1e-6)))


def reach_of(
    inner: tuple[np.ndarray, np.ndarray],
    outer: tuple[np.ndarray, np.ndarray],
    ellipses: tuple[Ellipse, Ellipse],
    radius: float,
    free: float,
    room: float,
) -> Reach:
    """Reach of known contacts.

    inner, outer : angles (n,) [rad] and loads (n,) [N]
    radius : of the ball [m];  free : contact angle where nothing carries [rad];  room : more load than known, as a factor
    """
    windows, widest, largest = [], 0.0, 0.0
    for (angle, load), ellipse in zip((inner, outer), ellipses, strict=True):
        heaviest = max(float(load.max()), 1.0)
        a, b = ellipse.semi_axes(room * heaviest)
        carrying = load > 1e-3 * heaviest
        angles = angle[carrying] if carrying.any() else np.array([free])
        half = AROUND * float(a) / radius + MARGIN
        windows.append(_rounded(float(angles.min()) - half, float(angles.max()) + half))
        widest, largest = max(widest, AROUND * float(b)), max(largest, heaviest)
    carrying = inner[1] > 0.1 * max(float(inner[1].max()), 1.0)
    mean = float(inner[1][carrying].mean()) if carrying.any() else largest
    return Reach(windows[0], windows[1], widest, mean, largest)
