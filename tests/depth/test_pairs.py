"""Pairs of rows: DB and DF braced by a preload, DT sharing a load; against single rows and a maker's tables."""

import numpy as np
import pytest

from raceway import SceneError, scene_from_dict
from raceway.extend import System

DISTANCE = 16e-3


def pair(built, arrangement, preload=290.0, **tables):
    given = {"preload": preload} if arrangement in ("DB", "DF") else {}
    bearing = {
        "preset": "7206C-NSK", "arrangement": arrangement, "row_distance": DISTANCE, **given, **tables.pop("bearing", {}),
    }  # fmt: skip
    return built(bearing=bearing, **{"load": {"axial": 0.0}, **tables})


def settled(model) -> tuple[np.ndarray, np.ndarray, System]:
    q, ball, _ = model.system.solve_equilibrium(model.guess)
    return q, model.system.evaluate(q, ball=ball).stiffness, model.system


def single_row(built, preload):
    return settled(built(bearing={"preset": "7206C-NSK"}, load={"axial": preload}))


@pytest.mark.parametrize("arrangement", ["DB", "DF"])
@pytest.mark.parametrize("preload", [60.0, 290.0, 1500.0])
def test_unloaded_pair_has_twice_the_tangent_of_one_row(built, arrangement, preload):
    """1e-8: both are solved to 1e-11 of the forces, at the same state by symmetry."""
    _, one, _ = single_row(built, preload)
    q, two, _ = settled(pair(built, arrangement, preload))
    assert abs(q[0]) < 1e-13
    np.testing.assert_allclose(np.diag(two)[:3], 2.0 * np.diag(one)[:3], rtol=1e-8)


@pytest.mark.parametrize("arrangement", ["DB", "DF"])
def test_tilt_stiffness_by_hand(built, arrangement):
    """Each row's 5x5 tangent moved by its lever, mirrored for the second row.

    A row at X whose tangent about its own centre has k_r, k_t and the coupling c = k[y, tilt_z] (k[z, tilt_y] = -c) sees
    y + X tilt_z, so about the middle k_tt = k_t + 2 X c + X^2 k_r.  The mirror image at -X has the coupling -c and
    adds the same.
    """
    _, one, _ = single_row(built, 290.0)
    _, two, _ = settled(pair(built, arrangement))
    place = -0.5 * DISTANCE if arrangement == "DB" else 0.5 * DISTANCE
    expected = 2.0 * (one[4, 4] + 2.0 * place * one[1, 4] + place**2 * one[1, 1])
    assert two[4, 4] == pytest.approx(expected, rel=1e-8)
    assert two[3, 3] == pytest.approx(expected, rel=1e-8)
    # Nothing couples a symmetric pair's tilts with its translations.
    assert abs(two[1, 4]) < 1e-9 * np.sqrt(two[1, 1] * two[4, 4])


def test_back_to_back_resists_tilts_more_than_face_to_face(built):
    """The pressure lines of DB meet the axis far apart; the difference is 8 X |c|, and grows with the distance."""
    back, face = (settled(pair(built, kind))[1][4, 4] for kind in ("DB", "DF"))
    _, one, _ = single_row(built, 290.0)
    assert back > 1.3 * face
    assert back - face == pytest.approx(8.0 * 0.5 * DISTANCE * abs(one[1, 4]), rel=1e-8)


def test_tandem_shares_the_load_equally(built):
    """Two rows under twice the load are one row under the load."""
    x, one, system = single_row(built, 500.0)
    q, two, both = settled(pair(built, "DT", load={"axial": 1000.0}))
    assert q[0] == pytest.approx(x[0], rel=1e-9)
    np.testing.assert_allclose(np.diag(two)[:3], 2.0 * np.diag(one)[:3], rtol=1e-8)
    load = both.evaluate(q).contact_force[: both.ball_count]
    np.testing.assert_allclose(load, system.evaluate(x).contact_force[0], rtol=1e-8)


@pytest.mark.parametrize("tilt", ["locked", "free"])
@pytest.mark.parametrize("arrangement", ["DB", "DF", "DT"])
def test_force_is_the_gradient_of_one_potential(built, arrangement, tilt):
    """The tangent is symmetric, and is what differences of the force give."""
    axial = 1000.0 if arrangement == "DT" else 100.0
    model = pair(built, arrangement, load={"axial": axial, "radial": [150.0, -80.0]}, supports={"tilt": tilt})
    q, k, system = settled(model)
    scale = np.array([1.0, 1.0, 1.0, 1.0 / system.arm, 1.0 / system.arm])
    for j in range(5):
        e = np.zeros(5)
        e[j] = 1e-9 * scale[j]
        slope = (system.evaluate(q + e).force - system.evaluate(q - e).force) / (2.0 * e[j])
        np.testing.assert_allclose(slope * scale * scale[j], k[:, j] * scale * scale[j], atol=2e-6 * k[1, 1])
    scaled = k * scale[:, None] * scale
    assert np.abs(scaled - scaled.T).max() < 1e-9 * np.abs(scaled).max()


@pytest.mark.parametrize(("bearing", "words"), [
    ({"preload": 100.0}, "needs rows that brace each other"), ({"arrangement": "DB", "preload": -1.0}, "at least 0"),
    ({"arrangement": "DB", "row_distance": 0.0}, "greater than 0"),
])  # fmt: skip
def test_bad_pairs_are_refused(tables, bearing, words):
    with pytest.raises(SceneError, match=words):
        scene_from_dict(tables(bearing=bearing))


def test_a_pair_needs_a_distance(tables):
    plain = {k: v for k, v in scene_from_dict(tables()).to_dict()["bearing"].items() if k not in ("width", "preset")}
    with pytest.raises(SceneError, match="needs `row_distance`"):
        scene_from_dict({"bearing": {**plain, "arrangement": "DT"}, "load": {"axial": 100.0}})
