"""A tiny bearing whose rings are equal sectors, also without superelements; elimination of a dense matrix, written to be read."""

from functools import cache

import attrs
import numpy as np

from raceway.core.fem.elastic.bearing import ElasticBearing, ElasticSystem
from raceway.testing import model_of
from tests.core.test_elastic_scene import TINY

STEEL = 212e9, 0.29, 7810.0


def built(**tables):
    """A model of three balls, eight cells around the rings for each: none that a contact may touch lies on a cut plane."""
    tables = {"mesh": {"azimuth_cells": 24}, "load": {"radial": [200.0, 100.0]}} | tables
    return model_of(TINY | {name: TINY.get(name, {}) | table for name, table in tables.items()})


tiny = cache(built)


def with_node_moved(model, bodies, part):
    """The system of a model's meshes, one node of some of them moved by a part of its place."""
    bearing = model.bearing.bearing
    meshes = {body.name: mesh for body, mesh in zip(bearing.system.assembly.bodies, bearing._meshes, strict=True)}
    for body in bodies:
        name = bearing.system.assembly.bodies[body].name
        points = meshes[name].points.copy()
        points[7] *= 1.0 + part
        meshes[name] = attrs.evolve(meshes[name], points=points)
    return ElasticBearing(meshes, bearing.setup).system


def unreduced(system):
    """The same bodies and contacts without superelements."""
    found = ElasticSystem(system.assembly, system.contact, system.solver.assembly.bodies[0].operator.moduli[1], system.load)
    found.excitation = system.excitation
    return found


def start_of(model):
    """(size,) undeformed bodies where rigid ones are in balance."""
    ring = model.system
    return ring._undeformed(ring.surrogate, np.zeros(5))


def assembled(operator, mass: float = 0.0) -> np.ndarray:
    """(3 n, 3 n) K + mass * M of a mesh."""
    return operator.stiffness().toarray() + mass * np.diag(np.repeat(operator.lumped_mass(), 3))


def schur(matrix: np.ndarray, kept: np.ndarray, inner: np.ndarray) -> np.ndarray:
    """A_kk - A_ki A_ii^-1 A_ik: what forces on the kept unknowns find with none on the inner ones."""
    return matrix[np.ix_(kept, kept)] - matrix[np.ix_(kept, inner)] @ np.linalg.solve(
        matrix[np.ix_(inner, inner)], matrix[np.ix_(inner, kept)]
    )


def unknowns(nodes: np.ndarray) -> np.ndarray:
    return (3 * np.asarray(nodes)[:, None] + np.arange(3)).ravel()
