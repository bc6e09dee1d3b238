"""Disturbances over a span, from samples, against what is known of them in other ways."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import mathieu_a

from raceway.core.periodic.monodromy import span_transfer

_SPAN = np.pi


def _transfer(A0: np.ndarray, A1: np.ndarray, mass: np.ndarray, dofs: np.ndarray) -> np.ndarray:
    out = np.empty((2 * len(dofs), 2 * len(dofs)))
    assert span_transfer(A0, A1, mass, dofs, _SPAN, out)
    return out


@pytest.mark.parametrize(("order", "q"), [(1, 0.5), (2, 0.8), (5, 6.0)])
def test_multipliers_at_the_edges_of_mathieus_tongues(order: int, q: float) -> None:
    """v'' + (a - 2 q cos 2 t) v = 0 has the double multiplier (-1)^m over pi where a is a characteristic value a_m(q)."""
    angles = _SPAN * np.arange(8) / 8
    A0, A1 = np.zeros((8, 5, 5)), np.zeros((8, 5, 5))
    A0[:, 1, 1] = mathieu_a(order, q) - 2.0 * q * np.cos(2.0 * angles)
    over = _transfer(A0, A1, np.ones(5), np.array([1]))
    assert np.trace(over) == pytest.approx(2.0 * (-1.0) ** order, abs=1e-5)
    assert np.linalg.det(over) == pytest.approx(1.0, abs=1e-12)


def test_transfer_with_gyroscopic_terms_and_damping() -> None:
    """Stiff and soft unknowns whose stiffness changes by a third of its mean, against a general integrator."""
    rng, n = np.random.default_rng(3), 16
    angles, mass, dofs = _SPAN * np.arange(n) / n, np.array([1.0, 2.0, 2.0, 0.3, 0.3]), np.arange(5)
    parts = [rng.normal(size=(5, 5)) for _ in range(3)]
    mean = 40.0 * np.diag([1.0, 3.0, 3.0, 9.0, 9.0]) @ np.diag(mass) + sum(part + part.T for part in parts)
    waves = [0.1 * (np.diag(np.diag(mean)) + part + part.T) for part in parts]
    viscous = 0.2 * np.eye(5) + parts[0] - parts[0].T

    def stiffness(t: float) -> np.ndarray:
        return mean + sum(wave * np.cos(2.0 * (k + 1) * t + k) for k, wave in enumerate(waves))

    def slope(t: float, y: np.ndarray) -> np.ndarray:
        v, rate = y.reshape(2, 5, 10)
        return np.concatenate([rate, -(stiffness(t) @ v + viscous @ rate) / mass[:, None]]).ravel()

    A0, A1 = np.array([stiffness(t) for t in angles]), np.array([viscous] * n)
    over = _transfer(A0, A1, mass, dofs)
    exact = (
        solve_ivp(slope, (0.0, _SPAN), np.eye(10).ravel(), rtol=1e-11, atol=1e-12, method="DOP853").y[:, -1].reshape(10, 10)
    )
    largest, expected = (np.abs(np.linalg.eigvals(each)).max() for each in (over, exact))
    assert largest == pytest.approx(expected, rel=1e-6)
