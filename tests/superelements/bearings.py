"""A tiny bearing whose rings are equal sectors, solved by superelements and, unreduced, by conjugate gradients."""

from __future__ import annotations

import copy

import attrs
import numpy as np

from raceway import build_model, make_plan, scene_from_dict
from raceway.core.elastic.bearing import ElasticBearing
from raceway.core.elastic.system import ElasticSystem
from tests.test_elastic_scene import TINY


def built(**tables):
    """A model of three balls, eight cells around the rings for each: none that a contact may touch lies on a cut plane."""
    merged = copy.deepcopy(TINY)
    tables = {"mesh": {"azimuth_cells": 24}, "load": {"radial": [200.0, 100.0]}} | tables
    for name, table in tables.items():
        merged[name] = {**merged.get(name, {}), **table}
    found = scene_from_dict(merged)
    return build_model(found, make_plan(found))


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
