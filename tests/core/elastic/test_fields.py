"""Fields of elastic bodies as files: stresses against forces, files that ParaView reads."""

import numpy as np
import pytest
from raceway_view.stress import StressFields, contacts_left_out, field_files

from raceway import scene_from_dict
from raceway.extend import write_whole
from raceway.testing import run
from tests.core.elastic.test_resultant_scene import TINY


@pytest.fixture(scope="module")
def result():
    return run(scene_from_dict(TINY | {"bodies": TINY["bodies"] | {"formulation": "one_point"}}))


def test_a_balls_mean_stress_is_that_of_the_forces_on_it(result):
    fields, assembly = StressFields.of(result), result.model.bearing.bearing.system.assembly
    most = int(np.argmax(result.equilibrium.contact_force[: result.model.system.ball_count]))
    operator, begin, end = assembly.bodies[2 + most].operator, *assembly.starts[2 + most : 4 + most]
    force = operator.internal_force(fields.displacement[begin:end]).reshape(-1, 3)
    # Integral of stress = sum of f x (virial); exact for one point an element: its hourglass forces do no work on linear fields.
    wanted = force.T @ operator.points
    volume = operator.element_masses.sum(axis=1) / operator.density
    xx, yy, zz, xy, yz, zx = volume @ fields.stress[fields.body == 2 + most]
    found = np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])
    assert found == pytest.approx(wanted, abs=1e-8 * np.abs(wanted).max())
    assert np.abs(wanted).max() > 0.5 * result.equilibrium.contact_force.max() * 0.5 * 9.525e-3


def test_von_mises_and_shear_of_uniaxial_and_pure_shear_stress():
    """And of principal stresses 3, 1, 0, whichever way the axes point."""
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    turned = (turn * [3.0, 1.0, 0.0]) @ turn.T
    turned = turned[[0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]]
    stress = np.array([[3.0, 0.0, 0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 2.0, 0.0, 0.0], turned])
    none = np.zeros((0, 3))
    fields = StressFields(none, none, none, none, stress)
    assert fields.von_mises == pytest.approx([3.0, 2.0 * np.sqrt(3.0), np.sqrt(7.0)], rel=1e-14)
    assert fields.largest_shear == pytest.approx([1.5, 2.0, 1.5], rel=1e-14)


def test_stresses_beside_contact_resultants_are_named_structure_only_with_hertz_pressure(result):
    """A pressure of gigapascals has a von Mises stress of half of it; the footprints of this mesh leave a few per cent."""
    largest = result.to_dict()["equilibrium"]["largest_pressure_pa"]
    assert StressFields.of(result).von_mises.max() < 0.2 * largest
    assert "structure only" in contacts_left_out(result) and f"{1e-6 * largest:.4g} MPa" in contacts_left_out(result)


@pytest.mark.needs("pyvista")
def test_the_files_hold_the_fields(result, tmp_path):
    import pyvista

    fields = StressFields.of(result)
    files = field_files(result)
    assert list(files) == ["fields.vtu", "stress.png"] and files["stress.png"].startswith(b"\x89PNG")
    grid = pyvista.read(write_whole(files["fields.vtu"], tmp_path / "fields.vtu"))
    assert grid.n_cells == len(fields.cells) and set(np.unique(grid.cell_data["body"])) == set(range(5))
    assert np.array_equal(grid.cell_data["von Mises stress [Pa]"], fields.von_mises)
    assert np.array_equal(grid.point_data["displacement [m]"], fields.displacement)
