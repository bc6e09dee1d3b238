"""Compliances between groove centres, from displacements along the normals of contacts.

Notes
-----
A groove whose section turns about its centre is the same groove, and the force of a contact goes through that centre: a contact
at the angle b feels n(b).M n(a) of a unit force at the angle a, n = (sin, cos).  Displacements of a surface point hold
that turn and are not what the contact feels.
"""

from __future__ import annotations

import numpy as np


def groove_compliance(angles: np.ndarray, response: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """M by least squares over all pairs of angles.

    Parameters
    ----------
    angles : (n,) contact angles [rad];  weight : (n,) of each
    response : (n, n, k) displacement along the normal at one angle by a unit force along that at another [m/N]

    Returns
    -------
    compliance : (k, 3) axial by axial, axial by radial and radial by radial force [m/N]
    """
    pairs = np.outer(weight, weight)
    columns = _columns(angles[:, None], angles) * pairs
    values = (response * pairs[:, :, None]).reshape(-1, response.shape[2])
    return np.asarray(np.linalg.lstsq(columns.reshape(3, -1).T, values, rcond=None)[0].T)


def own_compliance(angles: np.ndarray, response: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """M (3,) of a contact on itself, from response (n,) at the angle of the force itself; else as ``groove_compliance``."""
    columns = _columns(angles, angles) * weight
    return np.asarray(np.linalg.lstsq(columns.T, response * weight, rcond=None)[0])


def along_normal(angles: np.ndarray, compliance: np.ndarray) -> np.ndarray:
    """(n,) n.M n at contact angles [m/N], from M (3,)."""
    return np.asarray(compliance @ _columns(angles, angles))


def _columns(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """(3, ...) what the three numbers of M are multiplied by in n.M n'."""
    return np.stack([np.sin(one) * np.sin(other), np.sin(one + other), np.cos(one) * np.cos(other)])
