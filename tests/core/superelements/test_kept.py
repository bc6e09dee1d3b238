"""Superelements kept on disk: read again under other loads, never for another mesh; and nodes that contacts come to later."""

import attrs
import numpy as np
import pytest

from raceway import MeshError
from raceway.core.fem.elastic.bearing import ElasticBearing
from raceway.core.fem.elastic.interface import touchable
from raceway.core.fem.elastic.superelement import Part
from raceway.storage import array_cache
from tests.core.superelements.bearings import built, start_of, with_node_moved

TIGHT = 1e-9


@pytest.fixture(autouse=True)
def small_parts_too(tmp_path, monkeypatch):
    """An empty cache, in which small parts are kept as well."""
    monkeypatch.setenv("RACEWAY_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr("raceway.core.fem.elastic.interface.LEAST_CELLS", 0)


def entries():
    return sorted(entry.what for entry in array_cache.entries() if entry.kind == "superelement")


def settled(model):
    return model.bearing.bearing.system.solve_equilibrium(start_of(model), TIGHT).y


def test_what_was_kept_gives_the_same_digits_without_a_factorisation_and_serves_other_loads(monkeypatch):
    mesh = {"azimuth_cells": 24, "ball_load": 300.0}  # of its own: it follows no load of the scene
    light = {"mesh": mesh, "load": {"axial": 150.0, "radial": [50.0, 0.0]}}
    first = settled(built(**light))
    assert [what.split(",")[0] for what in entries()] == ["ball", "inner ring", "outer ring"]
    monkeypatch.setattr(Part, "of", lambda *given: pytest.fail("factored again"))
    assert (settled(built(**light)) == first).all()
    settled(built(mesh=mesh, load={"axial": 200.0, "radial": [100.0, 160.0]}))


@pytest.mark.slow
@pytest.mark.parametrize("change", [
    {"bodies": {"formulation": "full"}}, {"mesh": {"azimuth_cells": 30}}, {"bearing": {"rings": {"young": 205e9}}},
    {"supports": {"outer_seat": 1e13}},
], ids=["formulation", "mesh", "material", "seat"])  # fmt: skip
def test_other_bodies_are_other_entries(change):
    """Each against a cache of its own: a wrong answer would be read without a word."""
    settled(built())
    count = len(entries())
    found = settled(built(**change))
    assert len(entries()) > count
    array_cache.clear()
    assert (settled(built(**change)) == found).all()
    count = len(entries())
    with_node_moved(built(**change), (3,), 1e-10).condensed.interface(0.0)
    assert len(entries()) > count


def test_making_is_told_with_its_end():
    told = []
    built().bearing.solve_equilibrium(None, lambda *what: told.append(what))
    last = {what: done == total for what, done, total in told if what.startswith("factoring")}
    assert any("a sector of the inner ring" in what for what in last) and all(last.values())
    assert any(what.startswith("equilibrium, residual") for what, *_ in told)


@pytest.mark.slow
def test_a_contact_that_comes_to_other_nodes_widens_the_superelements():
    """Bodies reduced to the nodes of one contact alone: the others are added when they press."""
    whole = settled(built())
    model = built()
    system = model.bearing.bearing.system
    solver = system.condensed
    solver._wanted = solver._wanted & (np.arange(system.assembly.nodes) % 2 == 0)
    found = system.solve_equilibrium(start_of(model), TIGHT).y
    assert np.abs(found - whole).max() < 1e-8 * np.abs(whole).max()
    assert (solver._wanted >= touchable(system.contact, system.assembly.nodes)).all()


def test_a_contact_on_nodes_that_are_held_is_said():
    system = built().bearing.bearing.system
    assembly = system.assembly
    in_groove = np.repeat(system.condensed._wanted, 3)
    in_groove[: assembly.part(1).start] = in_groove[assembly.part(1).stop :] = False
    assembly.free = assembly.free[~in_groove[assembly.free]]
    with pytest.raises(MeshError, match="outer_ring: no node of its groove below a contact is free: its seat reaches"):
        system.condensed.increment(1.0, 0.0, 0.0, np.zeros(system.size), np.zeros(3 * system.assembly.nodes), None, 0.0)


@pytest.mark.parametrize("ring", ["inner", "outer"])
def test_a_seat_that_takes_in_the_groove_is_refused_before_anything_is_factored(ring, monkeypatch):
    bearing = built().bearing.bearing
    meshes = {body.name: mesh for body, mesh in zip(bearing.system.assembly.bodies, bearing._meshes, strict=True)}
    mesh = meshes[f"{ring}_ring"]
    seat = np.union1d(mesh.nodes("seat"), mesh.facet_nodes("raceway").ravel())
    meshes[f"{ring}_ring"] = attrs.evolve(mesh, node_sets={**mesh.node_sets, "seat": seat})
    monkeypatch.setattr(Part, "of", lambda *given: pytest.fail("factored"))
    with pytest.raises(MeshError, match=rf"`supports.{ring}_seat`.*none is free.*\[mesh.sets.{ring}_ring\] seat = ") as why:
        ElasticBearing(meshes, bearing.setup)
    assert why.value.mistake.value == "rigid"
