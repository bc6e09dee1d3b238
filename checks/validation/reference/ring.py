"""Rigid-ring bearing from physics.md sections 1 to 3: force and tangent of the inner ring, in plain numpy."""

from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import root

from checks.validation.reference.hertz import factor


@dataclass
class Ring:
    """A single-row bearing.

    ball_diameter, pitch_diameter [m], ball_count, contact_angle [rad], conformity_inner, conformity_outer
    young [Pa], poisson, density [kg/m3] : of rings and balls alike
    spin_speed : [rad/s], 0 for weightless balls
    damping : [N s/m] normal, each contact
    first_azimuth : [rad]
    """

    ball_diameter: float
    pitch_diameter: float
    ball_count: int
    contact_angle: float
    conformity_inner: float
    conformity_outer: float
    young: float = 212e9
    poisson: float = 0.29
    density: float = 7810.0
    spin_speed: float = 0.0
    damping: float = 0.0
    #: Polar inertia times speed of what spins with the inner ring [N m s].
    spin: float = 0.0
    first_azimuth: float = 0.0
    ball: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        d, dm, alpha = self.ball_diameter, self.pitch_diameter, self.contact_angle
        fi, fo = self.conformity_inner, self.conformity_outer
        self.distance = (fi + fo - 1.0) * d
        self.li, self.lo = (fi - 0.5) * d, (fo - 0.5) * d
        self.arm = dm / 2 + self.li * np.cos(alpha)
        g = d * np.cos(alpha) / dm
        modulus = self.young / (2.0 * (1.0 - self.poisson**2))
        # Principal relative curvatures: along the groove 2/D - 1/(f D), across (rolling direction) 2/D +- 2g/(D(1 -+ g)).
        self.ki = factor((2 - 1 / fi) / d / 2, (2 + 2 * g / (1 - g)) / d / 2, modulus)
        self.ko = factor((2 - 1 / fo) / d / 2, (2 - 2 * g / (1 + g)) / d / 2, modulus)
        psi = self.first_azimuth + 2 * np.pi * np.arange(self.ball_count) / self.ball_count
        c, s, zero = np.cos(psi), np.sin(psi), np.zeros(self.ball_count)
        # (Z, 2, 5): axial and radial motion of the inner groove centre by x, y, z, tilt_y, tilt_z.
        self.J = np.array([[zero + 1, zero, zero, self.arm * s, -self.arm * c], [zero, c, s, zero, zero]]).transpose(2, 0, 1)
        self.rest = self.distance * np.array([np.sin(alpha), np.cos(alpha)])
        cage = 0.5 * self.spin_speed * (1 - g)
        self.centrifugal = self.density * np.pi * d**3 / 6 * dm / 2 * cage**2
        self.series = (self.ki ** (-2 / 3) + self.ko ** (-2 / 3)) ** -1.5
        self.ball = self.seats(np.zeros(5))

    def centres(self, q: np.ndarray) -> np.ndarray:
        """(Z, 2) from the outer to the inner groove centre."""
        return self.rest + self.J @ q

    def seats(self, q: np.ndarray) -> np.ndarray:
        """(Z, 2) a first guess of the ball centres: on the line of the groove centres, in touch."""
        e = self.centres(q)
        s = np.linalg.norm(e, axis=1)
        share = self.lo + 0.5 * np.maximum(s - self.li - self.lo, 0.0) + 1e-7
        return e / s[:, None] * share[:, None]

    def __call__(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Force (5,), tangent (5, 5) and inner ball loads (Z,) at displacement q (5,)."""
        e = self.centres(q)
        if self.centrifugal == 0.0:
            load, pull, tangent = self._series(e)
        else:
            load, pull, tangent = self._inertial(e)
        across = self.J.reshape(-1, 5)
        return across.T @ pull.ravel(), across.T @ (tangent @ self.J).reshape(-1, 5), load

    @property
    def gyroscopic(self) -> np.ndarray:
        """(5, 5): the axis points along (1, tilt_z, -tilt_y), and so does the spin; its rate is a moment [N m s]."""
        found = np.zeros((5, 5))
        found[3, 4], found[4, 3] = self.spin, -self.spin
        return found

    def damping_matrix(self, q: np.ndarray) -> np.ndarray:
        """(5, 5) of the contacts' dashpots, to first order in the damping (exact in the limit that it does not bend paths).
        Each race takes the share of the approach rate that its stiffness leaves it: c (s_i^2 + s_o^2) along the line."""
        e = self.centres(q)
        s = np.hypot(*e.T)
        along = np.einsum("za,zai->zi", e / s[:, None], self.J)
        soft = np.array([self.ki, self.ko]) ** (-2 / 3)
        share = soft / soft.sum()
        c = self.damping * (share**2).sum() * (s > self.distance)
        return (along.T * c) @ along

    def _series(self, e: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        s = np.hypot(*e.T)
        n = e / s[:, None]
        delta = np.maximum(s - self.distance, 0.0)
        load = self.series * delta**1.5
        slope = 1.5 * self.series * np.sqrt(delta)
        nn = n[:, :, None] * n[:, None, :]
        tangent = slope[:, None, None] * nn + (load / s)[:, None, None] * (np.eye(2) - nn)
        return load, load[:, None] * n, tangent

    def _inertial(self, e: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """All balls at once by damped Newton on the gradient, from the last answer; ``one_ball`` checks it."""
        p = self.ball.copy()
        for _ in range(100):
            g, inner, outer = self._gradient(e, p)
            size = np.linalg.norm(g, axis=1)
            if (size <= 1e-11 * (self.centrifugal + 1.0)).all():
                break
            hessian = inner + outer
            open_ = np.abs(np.linalg.det(hessian)) < 1e-6
            hessian[open_] += 1e6 * np.eye(2)
            step = -np.linalg.solve(hessian, g[:, :, None])[:, :, 0]
            factor_ = np.ones(len(p))
            for _ in range(30):
                new = np.linalg.norm(self._gradient(e, p + factor_[:, None] * step)[0], axis=1)
                worse = new > size * (1 - 1e-4 * factor_) + 1e-12
                if not worse.any():
                    break
                factor_[worse] *= 0.5
            p = p + factor_[:, None] * step
        for k in np.flatnonzero(np.linalg.norm(self._gradient(e, p)[0], axis=1) > 1e-9 * (self.centrifugal + 1.0)):
            p[k] = self.one_ball(e[k])  # where a contact opens the damped Newton can stall
        self.ball = p
        _, inner, outer = self._gradient(e, p)
        hessian = inner + outer
        tangent = inner - inner @ np.linalg.solve(hessian, inner)
        x = e - p
        s = np.linalg.norm(x, axis=1)
        load = self.ki * np.maximum(s - self.li, 0.0) ** 1.5
        return load, load[:, None] * x / s[:, None], tangent

    def _gradient(self, e: np.ndarray, p: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of the balls' potential: gradient (Z, 2) and the Hessians (Z, 2, 2) of inner and outer contact."""
        parts = []
        for x, rest, k in ((e - p, self.li, self.ki), (p, self.lo, self.ko)):
            s = np.linalg.norm(x, axis=1)
            n = x / s[:, None]
            delta = np.maximum(s - rest, 0.0)
            load = k * delta**1.5
            nn = n[:, :, None] * n[:, None, :]
            hessian = (1.5 * k * np.sqrt(delta))[:, None, None] * nn + (load / s)[:, None, None] * (np.eye(2) - nn)
            parts.append((load[:, None] * n, hessian))
        (pull_i, hi), (pull_o, ho) = parts
        return pull_o - pull_i - np.array([0.0, self.centrifugal]), hi, ho

    def one_ball(self, e: np.ndarray) -> np.ndarray:
        """(2,) ball centre between groove centres that are e (2,) apart, by scipy's hybrid Powell method."""

        def balance(p: np.ndarray) -> np.ndarray:
            return self._gradient(e[None], self.lo * p[None])[0][0]

        seat = self.lo + (self.centrifugal / self.ko) ** (2 / 3)
        starts = [e * self.lo / np.linalg.norm(e) * 1.02, np.array([0.0, seat]), e * 0.5 + np.array([0.0, 0.01 * self.lo])]
        found = [root(balance, start / self.lo, method="hybr", options={"xtol": 1e-14}) for start in starts]
        best = min(found, key=lambda answer: np.abs(answer.fun).max())
        return best.x * self.lo
