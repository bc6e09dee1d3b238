"""Coefficients for rotor programs: their numbers, and the files, read by a small reader of ROSS's layout.

ROSS itself reads them in packages/raceway-rotor/tests/evidence/test_ross.py: it is not in the extra ``all``.
"""

import json
import tomllib

import numpy as np
import pytest
from raceway_rotor.coefficients import Coefficients, coefficients, without_noise
from raceway_rotor.export import ross_table
from raceway_rotor.ross_file import NAMES, ross_spline, through_points

from checks.validation.scenes import built_in
from checks.validation.stores import MASS, SPEEDS, as_list, damping, made, scene, stiffness
from raceway import RacewayError, SceneError
from raceway.extend import select
from raceway.points.axes import grid
from raceway.points.sweep import fill_store, prepare
from raceway.testing import b7206c

SPEED, SPIN, DIRECTION = "excitation.speed_rpm", "kinematics.spin_speed_rpm", "excitation.direction_deg"
RADIANS = np.pi / 30.0


def table(data, at=None, source=None):
    return coefficients(select(data, at or {}), source)


def read(path):
    """The keyword arguments that ``ross.BearingElement.load`` takes out of a file: its first table."""
    text = path.read_text(encoding="utf-8")
    content = json.loads(text) if path.suffix == ".json" else tomllib.loads(text)
    ((name, section),) = content.items()
    assert name.startswith("BearingElement_")
    return section


@pytest.mark.parametrize("shape", [lambda data: data, as_list], ids=["grid", "list"])
def test_a_rotating_force_gives_an_isotropic_bearing(shape):
    found = table(shape(made({SPEED: SPEEDS, "load.axial": [400.0, 1000.0]})), {"load.axial": 1000.0})
    columns = found.columns()
    # Selected, not computed: equal to the last bit.
    np.testing.assert_array_equal(found.speed, SPEEDS * RADIANS)
    for name in ("kyy", "kzz"):
        np.testing.assert_array_equal(columns[name], stiffness(SPEEDS, 1000.0))
    for name in ("cyy", "czz"):
        np.testing.assert_array_equal(columns[name], damping(SPEEDS))
    assert not any(columns[name].any() for name in ("kyz", "kzy", "cyz", "czy"))
    np.testing.assert_array_equal(columns["kxx"], np.full(len(SPEEDS), 6e7))
    notes = " ".join(found.notes)
    assert f"{MASS:.4g} kg, is removed" in notes
    assert "isotropic" in notes


@pytest.mark.parametrize("ending", [".toml", ".json"])
@pytest.mark.parametrize("generation, axis", [(2, "frequency"), (3, "speed")])
def test_the_file_holds_every_number_under_the_names_of_ross(tmp_path, ending, generation, axis):
    found = table(made({SPEED: SPEEDS}))
    path = ross_table(found, generation, "made-up", 4, ("where from",)).write(tmp_path / f"bearing{ending}")
    section = read(path)
    assert (section["n"], section["tag"]) == (4, "made-up")
    columns = found.columns()
    for ours, ross in NAMES.items():
        # Written with the shortest decimal that gives the same bits.
        np.testing.assert_array_equal(section[ross], columns[ours])
    np.testing.assert_array_equal(section[axis], found.speed)
    assert len({"frequency", "speed"} & set(section)) == 1
    text = path.read_text(encoding="utf-8")
    for words in ("where from", "ROSS is linear", "translations only", "X, Y, Z are y, z, x"):
        assert words in text


def whole(at):
    """A full symmetric tangent that differs from point to point."""
    base = np.array(
        [
            [6e7, 2e6, 0, 0, 4e5], [2e6, 2e8, 1e7, 3e5, 1e6], [0, 1e7, 3e8, -1e6, 2e5], [0, 3e5, -1e6, 2e4, 0],
            [4e5, 1e6, 2e5, 0, 3e4],
        ]
    )  # fmt: skip
    return base * (1.0 + at[SPEED][..., None, None] / 1e5)


@pytest.mark.parametrize("tilt, spring", [("locked", None), ("free", 0.0), (5000.0, 5000.0)])
@pytest.mark.parametrize("axial", ["force", "displacement"])
def test_the_tangent_condenses_what_the_scene_leaves_free(tilt, spring, axial):
    tables = scene() | {"supports": {"tilt": tilt, "axial": axial}}
    found = table(made({SPEED: SPEEDS}, tables, stiffness=whole), source="tangent")
    matrix = whole({SPEED: SPEEDS})
    if spring is not None:
        matrix[:, 3, 3] += spring
        matrix[:, 4, 4] += spring
    held = [1, 2] + ([] if axial == "displacement" else [0]) + ([] if spring is None else [3, 4])
    # The stiffness seen at y, z is the inverse of the compliance there, all that is held struck out.
    compliance = np.linalg.inv(matrix[:, held][:, :, held])[:, :2, :2]
    # Two ways to the same numbers through matrices of condition up to 1e5.
    np.testing.assert_allclose(found.stiffness, np.linalg.inv(compliance), rtol=1e-10)
    assert not found.damping.any()
    assert "left out: the coupling of axial and radial motions" in " ".join(found.notes)
    inner = np.linalg.inv(np.linalg.inv(matrix[:, (kept := sorted({0, 1, 2, *held}))][:, :, kept])[:, :3, :3])
    below = 1.0 - np.diagonal(found.stiffness / inner[:, 1:, 1:], axis1=1, axis2=2).min()
    assert (f"up to {below:.1%} below" in " ".join(found.notes)) == (axial == "force" and below >= 1e-3)


def test_directions_give_both_columns_and_the_cross_terms():
    """Receptances from a known symmetric matrix; the exporter gives the matrix back."""
    w = SPEEDS * RADIANS
    k = np.array([[2e8, 3e7], [3e7, 1.5e8]])
    c = np.array([[4.0, 1.0], [1.0, 3.0]])
    h = np.linalg.inv(k - MASS * w[:, None, None] ** 2 * np.eye(2) + 1j * w[:, None, None] * c)

    def along(at):
        n = np.stack([np.cos(np.radians(at[DIRECTION])), np.sin(np.radians(at[DIRECTION]))], axis=-1)
        return n, np.einsum("abi,aij,abj->ab", n, h, n)

    def amplitude(sign):
        def find(at):
            n, _ = along(at)
            r = np.einsum("aij,abj->abi", h, n) * 3.195e-4 * (at[SPEED][..., None] * RADIANS) ** 2
            return 0.5 * np.abs(r[..., 0] + sign * 1j * r[..., 1])

        return find

    changes = {
        "z_real": lambda at: (1.0 / along(at)[1]).real, "z_imag": lambda at: (1.0 / along(at)[1]).imag,
        "forward_amplitude": amplitude(1), "backward_amplitude": amplitude(-1),
    }  # fmt: skip
    tables = scene(excitation={"kind": "unidirectional"})
    found = table(made({SPEED: SPEEDS, DIRECTION: [0, 45, 90]}, tables, **changes))
    assert found.source == "directions"
    # Two inversions of well-conditioned 2x2 matrices; w C is 1e-5 of K, which costs the damping five digits.
    np.testing.assert_allclose(found.stiffness, np.broadcast_to(k, found.stiffness.shape), rtol=1e-12)
    np.testing.assert_allclose(found.damping, np.broadcast_to(c, found.damping.shape), rtol=1e-8)
    with pytest.raises(RacewayError, match="two directions do not determine these cross terms"):
        table(made({SPEED: SPEEDS, DIRECTION: [0, 90]}, tables, **changes))


def noisy(at):
    """Noise of either sign in Im Z below 10 000 r/min, a damping above [N/m]."""
    w = at[SPEED] * RADIANS
    noise = 10.0 * (-1.0) ** np.arange(w.size).reshape(w.shape)
    return np.where(at[SPEED] < 1e4, noise, w * damping(at[SPEED]))


def test_damping_that_is_not_resolved_is_zero_or_what_is_given():
    data = made({SPEED: SPEEDS}, z_imag=noisy, error_total=lambda at: 5e-7 + 0 * at[SPEED],
                equivalent_damping=lambda at: noisy(at) / (at[SPEED] * RADIANS))  # fmt: skip
    found, raw = table(data), noisy({SPEED: SPEEDS}) / (SPEEDS * RADIANS)
    hidden = SPEEDS < 1e4  # 5e-7 of 2e8 N/m are 100 N/m
    assert raw.min() < 0.0 and hidden.sum() == 3
    np.testing.assert_array_equal(found.damping[:, 0, 0], np.where(hidden, 0.0, raw))
    np.testing.assert_array_equal(found.damping[:, 1, 1], found.damping[:, 0, 0])
    assert "damping is not resolved at 3 of 9 points, smaller than its error: 0 stands there" in found.notes
    given = coefficients(select(data, {}), unresolved=25.0)
    np.testing.assert_array_equal(given.damping, np.where(hidden, 25.0, raw)[:, None, None] * np.eye(2))
    assert any("cyy = czz = 25 N s/m stands there, as given" in note for note in given.notes)
    still = coefficients(select(data, {}), "tangent", 25.0)
    np.testing.assert_array_equal(still.damping, np.broadcast_to(25.0 * np.eye(2), still.damping.shape))
    # Cross terms alone would make the matrix indefinite.
    assert not without_noise(np.full((1, 2, 2), 5.0), np.array([[[False, True], [True, True]]]), 0.0)[0].any()
    for wrong in (-1.0, np.nan, np.inf):
        with pytest.raises(SceneError, match="must be a finite damping"):
            coefficients(select(data, {}), unresolved=wrong)


def test_damping_of_a_band_says_which_end_it_is():
    tables = scene()
    tables["contact"] = {**tables.get("contact", {}), "damping": "band"}
    (told,) = [note for note in table(made({SPEED: SPEEDS}, tables)).notes if "band" in note]
    assert "the low end, c = tau k with tau = 2.5e-06 s" in told and "contact.time_constant=2.5e-06,2.5e-05" in told
    assert not [note for note in table(made({SPEED: SPEEDS})).notes if "band" in note]


@pytest.mark.parametrize("error, hidden", [(1e-7, "nothing"), (1e-6, "cross terms"), (1e-5, "all")])
def test_damping_along_directions_is_held_against_the_errors_of_their_receptances(error, hidden):
    w = 1e3
    k, c = np.array([[2e8, 1e7], [1e7, 2e8]]), np.array([[1.0, 0.1], [0.1, 1.0]])
    h = np.linalg.inv(k - MASS * w**2 * np.eye(2) + 1j * w * c)
    along = {angle: n @ h @ n for angle, n in ((0, [1, 0]), (45, [0.5**0.5, 0.5**0.5]), (90, [0, 1]))}
    of = np.vectorize(lambda angle: 1.0 / along[angle])
    data = made({SPEED: np.linspace(0.99, 1.01, 5) * w / RADIANS, DIRECTION: [0, 45, 90]}, scene(excitation={"kind": "unidirectional"}),
                z_real=lambda at: of(at[DIRECTION]).real, z_imag=lambda at: of(at[DIRECTION]).imag,
                frequency=lambda at: w / (2.0 * np.pi) + 0.0 * at[SPEED], error_total=lambda at: error + 0.0 * at[SPEED])  # fmt: skip
    found = table(data).damping
    # w C is 1000 and 100 N/m; 2e8 N/m times the error, and up to twice that for the difference that cross terms are.
    expected = {"nothing": c, "cross terms": np.eye(2), "all": np.zeros((2, 2))}[hidden]
    np.testing.assert_allclose(found, np.broadcast_to(expected, found.shape), rtol=1e-8)


@pytest.mark.parametrize("tilt", ["locked", "free"])
def test_forces_along_three_directions_find_the_tangent_of_a_loaded_bearing(tmp_path, tilt):
    """A real bearing with a load across its axis: two ways to one matrix with different diagonal and cross terms."""
    force = {"kind": "unidirectional", "speed_rpm": 1000.0, "amplitude": "constant", "force": 1.0}
    tables = {"load": {"axial": 1000.0, "radial": [200.0, 150.0]}, "supports": {"tilt": tilt}, "excitation": force}
    scene = b7206c(title="loaded", integrator={"kind": "quasi_static"}, **tables)
    plan = prepare(scene, grid(["excitation.speed_rpm=1000:9000:5", f"{DIRECTION}=0,45,90"]), tmp_path / "sweep")
    with fill_store(plan, built_in("executor", "serial")()) as store:
        data = store.to_xarray()
    secant, tangent = table(data), table(data, {DIRECTION: 0}, "tangent")
    assert (secant.source, tangent.source) == ("directions", "tangent")
    cross = tangent.stiffness[:, 0, 1] / tangent.stiffness[:, 0, 0]
    assert np.abs(cross).min() > (3e-2 if tilt == "free" else 9e-4)  # there is something to find
    # 1 N of 1000 N: the secant's cubic part is (dF / F)^2, and the cross terms are a difference of nearly equal numbers.
    np.testing.assert_allclose(secant.stiffness, tangent.stiffness, rtol=1e-5)


def test_a_table_over_speed_and_frequency_is_for_ross_3():
    spins = np.linspace(0.0, 20000.0, 6)
    found = table(made({SPEED: SPEEDS, SPIN: spins}))
    np.testing.assert_array_equal(found.speed, spins * RADIANS)
    np.testing.assert_array_equal(found.frequency, SPEEDS * RADIANS)
    content = ross_table(found, 3, "t", 0, ()).content
    assert np.shape(content["kxx"]) == (len(spins), len(SPEEDS))
    np.testing.assert_array_equal(np.array(content["kxx"])[2], stiffness(SPEEDS, 1000.0))
    with pytest.raises(RacewayError, match="ROSS 2 takes one axis"):
        ross_table(found, 2, "t", 0, ())


def test_a_fixed_spin_speed_makes_it_a_table_over_frequency():
    found = table(made({SPEED: SPEEDS}, scene() | {"kinematics": {"spin_speed_rpm": 12000.0}}))
    assert found.speed is None
    assert set(ross_table(found, 3, "t", 0, ()).content) & {"speed", "frequency"} == {"frequency"}


def test_what_ross_2_smooths_is_said_and_can_be_undone():
    found = table(made({SPEED: SPEEDS}))
    told = " ".join(ross_table(found, 2, "t", 0, ()).notes)
    assert "ROSS 2 does not pass through the points" in told
    changed = np.max(np.abs(ross_spline(found.speed, found.damping[:, 0, 0]) - found.damping[:, 0, 0]))
    assert f"cyy {changed / np.max(found.damping):.1%}" in told
    assert changed > 0.1  # below the bound of 1 N s/m a point: all that varies is lost

    class Element:  # as ROSS 2 leaves it
        frequency = found.speed

        def __init__(self):
            self.kxx, self.kxx_interpolated = found.stiffness[:, 0, 0].tolist(), None

    exact = through_points(Element()).kxx_interpolated
    np.testing.assert_array_equal(exact(found.speed), found.stiffness[:, 0, 0])
    ends = found.speed[[0, -1]]
    slopes = (exact(ends + [1.0, 0.0]) - exact(ends - [0.0, 1.0])).ravel()
    # Straight beyond the ends, with the slope of the end: a difference over 1 rad/s bends by its curvature.
    outside = exact(ends + [-100.0, 100.0]) - exact(ends)
    np.testing.assert_allclose(outside, [-100.0 * slopes[0], 100.0 * slopes[1]], rtol=1e-2)


@pytest.mark.parametrize(
    "axes, tables, changes, source, words",
    [
        ({SPEED: SPEEDS, "load.axial": [1.0, 2.0]}, None, {}, None, "choose one with --at load.axial=1"),
        ({SPEED: SPEEDS[:4]}, None, {}, None, "has 4 points (2000, 5500, 9000, 12500); rotor programs put cubics"),
        ({"load.axial": [1.0, 2.0, 3.0]}, None, {}, None, "choose one with --at load.axial=1"),
        ({SPEED: SPEEDS[:1]}, None, {}, None, "does not vary here (`excitation.speed_rpm` has the one value 2000)"),
        ({SPEED: SPEEDS}, scene(excitation={"kind": "unidirectional"}), {}, None, "one direction does not show"),
        ({SPEED: SPEEDS}, None, {"backward_amplitude": lambda at: 3e-8 + 0 * at[SPEED]}, None, "not isotropic: the orbit's counter-rotating part reaches 3.0%"),
        ({SPEED: SPEEDS, DIRECTION: [0, 30, 90]}, scene(excitation={"kind": "unidirectional"}), {}, None, "both columns take 0 and 90"),
        ({SPEED: SPEEDS}, None, {}, "directions", "there is one direction only"),
        ({SPEED: SPEEDS}, None, {}, "load.axial", "must be one of 'rotating', 'directions', 'tangent'"),
        ({SPEED: SPEEDS, "excitation.kind": ["a", "b"]}, None, {}, None, "choose one with --at excitation.kind=a"),
    ],
)  # fmt: skip
def test_what_makes_no_table_is_refused_with_the_way_out(axes, tables, changes, source, words):
    with pytest.raises(RacewayError) as told:
        table(made(axes, tables, **changes), source=source)
    assert words in str(told.value)


def test_gaps_are_refused():
    data = made({SPEED: SPEEDS})
    data["status"][2] = "failed"
    with pytest.raises(RacewayError, match="points without result: 1 failed"):
        table(data)


def test_a_static_sweep_has_its_tangent():
    tables = scene()
    del tables["excitation"]
    data = made({SPIN: SPEEDS}, tables).drop_vars(["z_real", "z_imag"])
    assert table(data).source == "tangent"
    with pytest.raises(RacewayError, match="static and has a tangent only"):
        table(data, source="rotating")


def test_another_ending_is_refused(tmp_path):
    with pytest.raises(RacewayError, match="ROSS reads .toml and .json"):
        ross_table(table(made({SPEED: SPEEDS})), 3, "t", 0, ()).write(tmp_path / "bearing.xls")
    assert issubclass(SceneError, RacewayError)


SPINS = np.linspace(100.0, 900.0, 5)
#: ROSS' axes (X, Y) are (y, z) of the bearing: row, then column.
PLACES = {"xx": (0, 0), "xy": (0, 1), "yx": (1, 0), "yy": (1, 1)}


def test_no_two_entries_are_swapped():
    stiffness = 1e8 * np.array([[1.0, 2.0], [3.0, 4.0]]) + np.zeros((5, 1, 1))
    damping = np.array([[10.0, 20.0], [30.0, 40.0]]) + SPINS[:, None, None]
    still = np.zeros((5, 5, 5))
    table = Coefficients(SPINS, None, stiffness, damping, np.full(5, 7e7), "tangent", "made up", (), still, still, "locked")
    for generation in (2, 3):
        content = ross_table(table, generation, "made_up", 1, ()).content
        for name, (row, column) in PLACES.items():
            np.testing.assert_array_equal(content[f"k{name}"], stiffness[:, row, column])
            np.testing.assert_array_equal(content[f"c{name}"], damping[:, row, column])
        np.testing.assert_array_equal(content["kzz"], 7e7)
