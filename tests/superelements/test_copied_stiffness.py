"""Forces of equal parts by the matrix of one, against the kernels that know no matrix."""

from __future__ import annotations

import numpy as np
import pytest

from raceway.core.elastic.body_forces import BodyForces
from raceway.core.elastic.copied_stiffness import CopiedStiffness
from raceway.core.hexahedron.block_rows import BlockRows
from raceway.core.threads import ThreadPool
from tests.superelements.bearings import built

FORMULATIONS = ("one_point", "full", "incompatible")
#: Sums of some hundred products.
ROUNDING = 1e-13


def assembly_of(formulation):
    return built(bodies={"formulation": formulation}).bearing.bearing.system.assembly


def moved_by_chance(assembly, seed=0):
    return np.random.default_rng(seed).standard_normal(3 * assembly.nodes)


def element_by_element(assembly, u):
    return np.concatenate(
        [body.operator.internal_force(u[assembly.part(k)]).ravel() for k, body in enumerate(assembly.bodies)]
    )


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_forces_of_all_bodies_are_those_of_their_elements(formulation):
    assembly = assembly_of(formulation)
    u = moved_by_chance(assembly)
    wanted = element_by_element(assembly, u)
    found = np.zeros_like(u)
    for group in assembly.groups:
        assert len(group.copies.turns) == 3
        part = CopiedStiffness(group.copies, assembly.bodies[group.members[0]].operator).apply(u)
        assert not (found.any() and (found * part).any()), "a node is written twice"
        found += part
    assert np.abs(found - wanted).max() < ROUNDING * np.abs(wanted).max()


@pytest.mark.parametrize("threads", [1, 2])
def test_bodies_in_groups_and_others_stand_side_by_side(threads):
    """One ring and all balls by matrices, the other ring by its elements: to the last bit the same for all threads."""
    assembly = assembly_of("incompatible")
    u = moved_by_chance(assembly)
    forces = BodyForces([body.operator for body in assembly.bodies], assembly.starts, assembly.groups[1:])
    seen = np.zeros(len(u), dtype=int)

    def also(force, begin, end):
        seen[begin:end] += 1

    def found(pool):
        forces.compute(u, pool, [])
        return forces.sum(pool, also).copy()

    with ThreadPool(1) as one, ThreadPool(threads) as several:
        alone = found(one)
        assert (found(several) == alone).all()
    assert (seen == 2).all()
    wanted = element_by_element(assembly, u)
    assert np.abs(alone - wanted).max() < ROUNDING * np.abs(wanted).max()


def test_forces_of_one_body_at_many_displacements():
    assembly = assembly_of("incompatible")
    rows = assembly.part(2)
    columns = np.random.default_rng(2).standard_normal((rows.stop - rows.start, 3))
    wanted = np.stack([assembly.bodies[2].operator.internal_force(u).ravel() for u in columns.T], axis=1)
    assert np.abs(assembly.mesh_force(2, columns) - wanted).max() < ROUNDING * np.abs(wanted).max()
    u = moved_by_chance(assembly)
    ring = assembly.bodies[1].operator.internal_force(u[assembly.part(1)]).ravel()
    assert np.abs(assembly.body_force(1, u) - ring).max() < ROUNDING * np.abs(ring).max()


def test_rows_are_those_of_the_sparse_matrix():
    body = assembly_of("incompatible").bodies[0].operator
    rows = BlockRows.assemble(body.cells, len(body.points), body.element_stiffness)
    moved = np.random.default_rng(1).standard_normal((len(body.points), 3, 2))
    some = np.array([3, 0, 17])
    wanted = (body.stiffness() @ moved.reshape(-1, 2)).reshape(-1, 3, 2)[some]
    assert np.abs(rows.times(some, moved) - wanted).max() < ROUNDING * np.abs(wanted).max()
