"""The oil of a scene: one for films and all else, wherever it is given; its viscosity in columns."""

import numpy as np
import pytest

import raceway as rw
from raceway.extend import resolve
from raceway.planning.columns import column_problem
from raceway.scene.lubricant import Oil

TABLES = {"bearing": {"preset": "B7206C"}, "load": {"axial": 400.0}, "kinematics": {"spin_speed_rpm": 9000.0}}
OIL = {"oil": "VG 32", "temperature_c": 55.0}


def scene(**tables):
    return rw.Scene.from_dict({**TABLES, **tables})


def test_a_film_takes_the_oil_of_the_lubricant():
    alone = scene(contact={"kind": "film", **OIL, "roughness": 1e-7})
    shared = scene(contact={"kind": "film", "roughness": 1e-7}, lubricant=OIL)
    assert resolve(alone).contact.law == resolve(shared).contact.law
    assert resolve(alone).lubricant == resolve(shared).lubricant == shared.lubricant
    assert rw.Scene.from_dict(shared.to_dict()) == shared and "oil" not in shared.to_dict()["contact"]
    dry = scene(contact={"kind": "hertz"}, lubricant=OIL)
    assert resolve(dry).lubricant == shared.lubricant and resolve(scene()).lubricant is None
    assert dry.to_dict()["lubricant"]["oil"] == "VG 32" and "lubricant" not in scene().to_dict()


@pytest.mark.parametrize(("tables", "words"), [
    ({"contact": {"kind": "film", **OIL}, "lubricant": OIL}, "delete [lubricant], or contact.oil, contact.temperature_c"),
    ({"contact": {"kind": "film"}}, "`contact`: no viscosity is given"),
    ({"lubricant": {"density": 900.0}}, "`lubricant`: no viscosity is given"),
    ({"lubricant": {"oil": "VG 33", "temperature_c": 40.0}}, "did you mean 'VG 32'?"),
])  # fmt: skip
def test_mistakes_name_the_keys(tables, words):
    with pytest.raises(rw.SceneError) as caught:
        scene(**tables)
    assert words in str(caught.value)


def test_viscosities_are_columns_where_their_keys_are():
    warm = np.array([20.0, 55.0, 90.0])
    problem = column_problem(resolve(scene(lubricant=OIL)), {"lubricant.temperature_c": warm})
    for oil in (problem.lubricant, problem.lubricant.at(warm)):
        each = [Oil("VG 32", temperature_c=t) for t in warm.tolist()]
        for name in ("dynamic_viscosity", "kinematic_viscosity", "alpha", "beta"):
            assert getattr(oil, name) == pytest.approx([getattr(one, name) for one in each], rel=1e-14)
    film = column_problem(resolve(scene(contact={"kind": "film"}, lubricant=OIL)), {"lubricant.temperature_c": warm})
    assert film.contact.law.dynamic_viscosity == pytest.approx(film.lubricant.dynamic_viscosity, rel=1e-14)
    film = column_problem(resolve(scene(contact={"kind": "film", **OIL})), {"contact.temperature_c": warm})
    assert film.lubricant.dynamic_viscosity == pytest.approx(problem.lubricant.dynamic_viscosity, rel=1e-14)
    # Of a viscosity alone beta is that of the mineral oil that has it at the temperature, within and beyond the grades.
    assert Oil(viscosity=0.03).beta == Oil(viscosity=0.03, temperature_c=40.0).beta
    for eta in (1e-4, 0.03, 3.0):
        several = Oil(viscosity=eta).at(warm).beta
        assert several == pytest.approx([Oil(viscosity=eta, temperature_c=t).beta for t in warm.tolist()], rel=1e-14)
