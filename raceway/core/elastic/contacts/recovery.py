"""Peak pressures, approach, and penetration of the penalty at contacts at points."""

from __future__ import annotations

import numpy as np

from raceway.core.elastic.contacts.nodal import NodalContact


def peak_at_points(contact: NodalContact) -> np.ndarray:
    """(pairs,) largest pressure at a quadrature point [Pa], at the last gaps."""
    return np.maximum.reduceat(contact.pressure, _starts(contact))


def peak_at_nodes(contact: NodalContact) -> np.ndarray:
    """(pairs,) largest nodal pressure [Pa]: force of the points around a node over their area, as facets share them."""
    out = np.empty(len(contact.pairs))
    for index, (pair, begin) in enumerate(zip(contact.pairs, _starts(contact), strict=True)):
        part = slice(begin, begin + contact.counts[index])
        _, place = np.unique(pair.points.nodes, return_inverse=True)
        share = contact.area[part, None] * pair.points.weights
        area = np.bincount(place.ravel(), share.ravel())
        force = np.bincount(place.ravel(), (contact.pressure[part, None] * share).ravel())
        out[index] = (force / area).max()
    return out


def points_in_contact(contact: NodalContact) -> np.ndarray:
    """(pairs,) number of points under pressure."""
    return np.add.reduceat((contact.pressure > 0.0).astype(int), _starts(contact))


def deepest_penetration(contact: NodalContact) -> np.ndarray:
    """(pairs,) largest overlap of the deformed surfaces [m]: what the penalty takes of the approach."""
    return np.maximum(-contact.deepest(), 0.0)


def _starts(contact: NodalContact) -> np.ndarray:
    return np.r_[0, np.cumsum(contact.counts)[:-1]]
