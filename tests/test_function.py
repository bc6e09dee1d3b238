"""The bearing as a function of columns: the same numbers as runs of their own, in the shape of the inputs."""

import pickle
from pathlib import Path

import numpy as np
import pytest

import raceway as rw
from checks.validation.columns import case, compare
from raceway import SceneError
from raceway.extend import Tables, registry_with

STATIC = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1.0}, "supports": {"tilt": "free"}}
TURNING = {
    "bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}, "supports": {"tilt": "free"}, "rotor": {"mass": 1.0},
    "excitation": {"kind": "bidirectional", "speed_rpm": 9000.0, "unbalance": 1e-5},
    "integrator": {"kind": "periodic", "tolerance": 1e-11},
}  # fmt: skip


@pytest.mark.parametrize("first", [0, 10, *(pytest.param(k, marks=pytest.mark.slow) for k in range(20, 100, 10))])
def test_points_are_what_runs_give(first: int) -> None:
    """1e-9 of every number; equilibria are solved for to a residual of 1e-12, which soft tilts turn into 1e-8 of a displacement."""
    compared = compare(range(first, first + 10))
    assert compared.worst < 1e-9
    assert compared.moved < 1e-8
    assert compared.status["COMPUTED"] >= 30


def test_one_number_of_many_blocks_is_refused_alone() -> None:
    angles = np.linspace(14.0, 16.0, 20001)
    angles[15000] = -5.0
    answer = rw.function({**STATIC, "load": {"axial": 500.0}}, ["bearing.contact_angle_deg"], ["stiffness"])(angles)
    assert np.flatnonzero(answer["status"] == rw.PointStatus.REFUSED).tolist() == [15000]


#: A law that is twice as stiff where a ball has more than 200 N of the axial load, asked in a way that no missing load would make fail.
_BY_LOAD = """
import numpy as np
from raceway import hookimpl
from cubic_law import Cubic

class ByLoad(Cubic):
    name = "by_load"

    def build(self, pairs):
        load = np.asarray(pairs.reference_load, dtype=float)
        return np.where(load > 200.0, 2.0, 1.0)[:, None] * super().build(pairs)

@hookimpl
def raceway_contact_laws():
    return [ByLoad]
"""


def test_a_law_may_read_the_load_of_each_point(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Parameters of one point stand for all only where the law never asks for the load."""
    monkeypatch.syspath_prepend(str(Path(__file__).parent))
    law, loads = tmp_path / "by_load.py", [200.0, 2000.0]
    law.write_text(_BY_LOAD, encoding="utf-8")
    scene = rw.scene_from_dict({**STATIC, "contact": {"kind": "by_load"}}, registry_with((law,)))
    columns = rw.function(scene, ["load.axial"], ["stiffness"])(loads)["stiffness"]
    for axial, stiffness in zip(loads, columns, strict=True):
        alone = rw.run(scene.with_(**{"load.axial": axial}))
        np.testing.assert_allclose(stiffness, alone.equilibrium.stiffness, rtol=1e-9, atol=1e-3)


def test_sets_and_gyroscopic_moments_are_among_the_cases() -> None:
    cases = [case(seed) for seed in range(24)]
    assert {"DB", "DF", "DT", "single"} <= {c.scene.bearing.arrangement for c in cases}
    assert any(c.scene.kinematics.gyroscopic != "none" for c in cases)
    assert {"rigid", "condensed"} == {c.scene.bodies.name for c in cases}
    assert {c.scene.contact.kind for c in cases} == {"hertz", "penalty", "film", "stiffening", "oil_layer"}
    assert {"unidirectional", "bidirectional"} <= {c.scene.excitation.name for c in cases if c.scene.excitation}


def test_the_stated_error_of_an_orbit_bounds_the_true_one() -> None:
    """The change by the last doubling is the error of the samples before."""
    scene = TURNING | {"excitation": {"kind": "unidirectional", "speed_rpm": 9000.0, "unbalance": 3e-4}}
    outputs = ["z_real", "z_imag", "error_total"]
    loads = np.linspace(500.0, 1500.0, 5)
    rough = rw.function(scene, ["load.axial"], outputs, tolerance=1e-3)(loads)
    exact = rw.function(scene, ["load.axial"], outputs, tolerance=1e-12)(loads)
    z, z_exact = (answer["z_real"] + 1j * answer["z_imag"] for answer in (rough, exact))
    true = np.abs(z / z_exact - 1.0)
    assert (true <= 3.0 * rough["error_total"] + 1e-12).all()
    assert (rough["error_total"] > exact["error_total"]).all()


def test_inputs_broadcast_and_arrays_keep_their_further_axes() -> None:
    f = rw.function(STATIC, ["load.axial", "load.radial[0]"], ["kyy", "stiffness", "contact_angle"])
    answer = f([[400.0], [900.0]], [0.0, 10.0, 20.0])
    assert answer["kyy"].shape == (2, 3)
    assert answer["stiffness"].shape == (2, 3, 5, 5)
    assert answer["contact_angle"].shape == (2, 3, 2, 12)
    assert np.array_equal(answer["kyy"], answer["stiffness"][..., 1, 1])
    assert (answer["status"] == rw.PointStatus.COMPUTED).all()
    by_name = f(**{"load.radial[0]": [0.0, 10.0, 20.0], "load.axial": [[400.0], [900.0]]})
    assert np.array_equal(by_name["kyy"], answer["kyy"])


def test_a_point_does_not_depend_on_its_neighbours() -> None:
    f = rw.function(STATIC, ["load.axial"], ["stiffness"])
    loads = np.linspace(300.0, 2000.0, 40)
    together = f(loads)["stiffness"]
    assert np.array_equal(together[17], f(loads[17])["stiffness"])
    assert np.array_equal(together[::-1], f(loads[::-1])["stiffness"])


FILM = STATIC | {"load": {"axial": 1000.0}, "kinematics": {"spin_speed_rpm": 9000.0}}
FILM["contact"] = {"kind": "film", "oil": "VG 32", "temperature_c": 60.0}


def test_a_film_fits_the_loads_of_each_point() -> None:
    """Also of points that need more rounds than their neighbours; a warmer oil is thinner, and the inner ring nearer."""
    temperatures = np.linspace(20.0, 100.0, 30)
    f = rw.function(FILM, ["load.axial", "contact.temperature_c"], ["x", "kyy"])
    together = f([[100.0], [2000.0]], temperatures)
    assert (together["status"] == rw.PointStatus.COMPUTED).all()
    assert (np.diff(together["x"]) > 0.0).all()
    for k in (0, 17):
        alone = f([100.0, 2000.0], temperatures[k])
        np.testing.assert_allclose(together["kyy"][:, k], alone["kyy"], rtol=1e-12)
    run = rw.run({**FILM, "load": {"axial": 100.0}, "contact": {**FILM["contact"], "temperature_c": temperatures[17]}})
    assert together["kyy"][0, 17] == pytest.approx(run.stiffness[1, 1], rel=1e-10)


def test_derivatives_by_the_options_of_a_film() -> None:
    """A flooded contact is the end of its range: differences are one-sided there, and met by those of other steps."""
    f = rw.function(FILM, ["contact.starvation", "contact.temperature_c"], ["x"])
    slopes = f.jacobian(1.0, 60.0)["x"]
    less, flooded = f([0.999, 1.0], 60.0)["x"]
    assert slopes["contact.starvation"] == pytest.approx((flooded - less) / 1e-3, rel=1e-3)
    cold, warm = f(1.0, [59.9, 60.1])["x"]
    assert slopes["contact.temperature_c"] == pytest.approx((warm - cold) / 0.2, rel=1e-5)


def test_options_of_a_law_that_contradict_each_other_are_refused_alone() -> None:
    oil = {"kind": "film", "viscosity_40": 32e-6, "viscosity_100": 5.3e-6, "temperature_c": 60.0}
    f = rw.function({**FILM, "contact": oil}, ["contact.viscosity_40", "contact.viscosity_100"], ["x"])
    answer = f([4e-6, 4e-6, 32e-6, 32e-6], [2e-6, 5e-6, np.nan, 6e-6])
    assert [rw.PointStatus(status).name for status in answer["status"]] == ["COMPUTED", "REFUSED", "REFUSED", "COMPUTED"]
    assert "must be below `viscosity_40`" in answer["reason"][1]


def test_threads_change_nothing() -> None:
    loads = np.linspace(300.0, 2000.0, 20_000)
    alone, shared = (rw.function(STATIC, ["load.axial"], ["kyy"], threads=count)(loads) for count in (1, 2))
    assert np.array_equal(alone["kyy"], shared["kyy"])


def test_the_jacobian_is_the_compliance() -> None:
    f = rw.function(STATIC, ["load.axial", "load.radial[0]"], ["displacement", "stiffness"])
    point = (800.0, 40.0)
    slopes, stiffness = f.jacobian(*point)["displacement"], f(*point)["stiffness"]
    compliance = np.linalg.inv(stiffness)
    np.testing.assert_allclose(slopes["load.axial"], compliance[:, 0], rtol=0, atol=1e-8 * abs(compliance[:, 0]).max())
    np.testing.assert_allclose(slopes["load.radial[0]"], compliance[:, 1], rtol=0, atol=1e-8 * abs(compliance[:, 1]).max())


@pytest.mark.filterwarnings("error")
def test_points_without_a_number_have_no_derivative_and_change_no_other() -> None:
    f = rw.function(STATIC, ["load.axial"], ["x"])
    slopes, alone = (
        f.jacobian(loads)["x"]["load.axial"] for loads in ([np.inf, 400.0, np.nan, -np.inf, 900.0], [400.0, 900.0])
    )
    assert np.isnan(slopes[[0, 2, 3]]).all()
    np.testing.assert_allclose(slopes[[1, 4]], alone, rtol=1e-10)  # rounding of a sum over a step of 1e-3
    assert np.isnan(f.jacobian(np.inf)["x"]["load.axial"])


def test_derivatives_at_the_end_of_a_range_are_one_sided() -> None:
    """An interference is not negative; the tangent of the secants is met to their curvature, 1e-4 of it over 10 nm."""
    f = rw.function(STATIC, ["load.axial", "mounting.shaft_interference", "load.radial[1]"], ["kyy", "x"])
    slopes = f.jacobian(800.0, 0.0, 0.0)
    ends = f(800.0, [0.0, 1e-8], 0.0)
    secant = float(np.diff(ends["kyy"])[0]) / 1e-8
    assert slopes["kyy"]["mounting.shaft_interference"] == pytest.approx(secant, rel=1e-3)
    assert abs(slopes["x"]["load.radial[1]"]) < 1e-6 * slopes["x"]["load.axial"]  # by symmetry


def test_the_difference_of_two_meshes_is_no_derivative() -> None:
    condensed = rw.function({**FILM, "bodies": {"kind": "condensed"}}, ["bearing.contact_angle_deg"], ["kxx"])
    with pytest.raises(SceneError, match="changes the meshes"):
        condensed.jacobian(15.0)


def test_a_preload_that_nothing_braces_is_refused_alone() -> None:
    f = rw.function(STATIC, ["load.axial", "bearing.preload"], ["kyy"])
    answer = f(800.0, [0.0, 100.0])
    assert answer["status"].tolist() == [rw.PointStatus.COMPUTED, rw.PointStatus.REFUSED]
    alone = rw.run({**STATIC, "load": {"axial": 800.0}}).stiffness[1, 1]
    assert answer["kyy"][0] == pytest.approx(alone, rel=1e-11)  # another first guess: the residual of the equilibrium


def test_it_is_pickled_with_its_scene() -> None:
    f = rw.function(TURNING, ["load.axial"], ["K"])
    again = pickle.loads(pickle.dumps(f))
    assert np.array_equal(f([800.0])["equivalent_stiffness"], again([800.0])["equivalent_stiffness"])


def test_data_arrays_keep_their_dimensions() -> None:
    xarray = pytest.importorskip("xarray")
    f = rw.function(TURNING, ["load.axial", "excitation.speed_rpm"], ["K", "stiffness"])
    loads = xarray.DataArray([600.0, 900.0], dims="load", coords={"load": [600.0, 900.0]})
    speeds = xarray.DataArray([3000.0, 6000.0, 9000.0], dims="speed")
    answer = f(loads, speeds)
    assert answer["equivalent_stiffness"].dims == ("load", "speed")
    assert answer["equivalent_stiffness"].attrs["units"] == "N/m"
    assert answer["stiffness"].dims == ("load", "speed", "dof", "dof2")
    assert list(answer["load"].values) == [600.0, 900.0]
    assert answer["status"].attrs["flag_meanings"].split()[0] == "computed"


def test_other_libraries_call_it() -> None:
    xarray, optimize = pytest.importorskip("xarray"), pytest.importorskip("scipy.optimize")
    f = rw.function(STATIC, ["load.axial"], ["kyy"])
    load = optimize.brentq(lambda axial: float(f.arrays(axial)) - 180e6, 100.0, 3000.0)
    assert rw.run({**STATIC, "load": {"axial": load}}).stiffness[1, 1] == pytest.approx(180e6, rel=1e-9)
    pytest.importorskip("dask")
    loads = xarray.DataArray(np.linspace(300.0, 900.0, 12), dims="load").chunk(load=5)
    lazy = xarray.apply_ufunc(f.arrays, loads, dask="parallelized", output_dtypes=[float])
    assert np.array_equal(lazy.values, f.arrays(loads.values))
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"load.axial": [400.0, 800.0]})
    assert list(f(**frame)["kyy"]) == list(f([400.0, 800.0])["kyy"])


def test_rows_that_are_refused_have_a_reason() -> None:
    f = rw.function({**STATIC, "bearing": {"preset": "B7206C"}}, ["load.axial", "bearing.conformity_inner"], ["kyy"])
    answer = f([400.0, np.nan, 400.0, 0.0], [0.52, 0.52, 0.4, 0.52])
    names = [rw.PointStatus(status).name for status in answer["status"]]
    assert names == ["COMPUTED", "REFUSED", "REFUSED", "FAILED"]
    assert np.isnan(answer["kyy"][1:]).all()
    assert np.isfinite(answer["kyy"][0])
    assert "no number" in answer["reason"][1]
    assert "greater than 0.5" in answer["reason"][2]
    assert "load" in answer["reason"][3]
    assert answer["reason"][0] == ""


def test_what_the_loop_cannot_do_is_run() -> None:
    f = rw.function({**STATIC, "contact": {"friction": 0.1}, "kinematics": {"spin_speed_rpm": 3e3}}, ["load.axial"], ["kyy"])
    assert "rub" in f.why_slow
    answer = f([400.0, 900.0])
    assert (answer["status"] == rw.PointStatus.RUN).all()
    assert answer["kyy"][1] == rw.run(f.scene_at({"load.axial": 900.0})).stiffness[1, 1]
    with pytest.raises(rw.RacewayError, match=r"would take about .*, one run after another, because contacts rub"):
        f(np.full(1_000_000, 400.0))


def test_what_a_run_lacks_is_no_number() -> None:
    scene = {**TURNING, "integrator": {"kind": "quasi_static", "turns": 1}}
    answer = rw.function(scene, ["load.axial"], ["kyy", "largest_multiplier"])([900.0])
    assert answer["status"] == rw.PointStatus.RUN and answer["kyy"] > 0.0
    assert np.isnan(answer["largest_multiplier"]) and "has no largest_multiplier" in answer["reason"][0]


def test_an_orbit_along_which_the_stiffness_changes_much_is_left_to_a_run() -> None:
    """Forces of 200 N and of 1.2 kN on 300 N of preload: the loop finds both orbits; beside the second there may be others."""
    scene = TURNING | {"load": {"axial": 300.0}, "supports": {"tilt": "locked"}}
    f = rw.function(scene, ["excitation.unbalance"], ["K"], tolerance=1e-6)
    answer = f.looped({"excitation.unbalance": np.array([200.0, 1200.0]) / (9000.0 * np.pi / 30.0) ** 2})
    assert answer["status"].tolist() == [rw.PointStatus.COMPUTED, rw.PointStatus.FAILED]


def test_tilts_follow_on_a_shaft_that_resists_about_both_axes() -> None:
    """Static condensation of the five by five stiffness, where a load beside the axes couples all."""
    scene = {**STATIC, "load": {"axial": 1.0, "radial": [300.0, 100.0]}, "supports": {"tilt": 2e4}}
    answer = rw.function(scene, ["load.axial"], ["kyy_tilts_follow", "stiffness"])(900.0)
    k = answer["stiffness"] + np.diag([0.0, 0.0, 0.0, 2e4, 2e4])
    assert answer["kyy_tilts_follow"] == pytest.approx(k[1, 1] - k[1, 3:] @ np.linalg.solve(k[3:, 3:], k[3:, 1]), rel=1e-12)


@pytest.mark.parametrize(("tables", "key", "words"), [
    ({}, "bearing.conformity_inner", "changes the finite elements"),
    ({"contact": {"discretisation": "nodal"}}, "load.axial", "surface points"),
    ({"supports": {"inner_seat": 1e12}}, "load.axial", "interact through elastic rings"),
])  # fmt: skip
def test_condensed_bodies_that_points_do_not_share(tables: Tables, key: str, words: str) -> None:
    f = rw.function({**STATIC, "bodies": {"kind": "condensed"}, **tables}, [key], ["kyy"])
    assert words in f.why_slow


@pytest.mark.parametrize(("inputs", "outputs", "words"), [
    (["load.axail"], ["kyy"], r"did you mean 'load\.axial'"), (["bearing.ball_count"], ["kyy"], "whole numbers only"),
    (["supports.tilt"], ["kyy"], "takes a word or a switch"), (["integrator.turns"], ["kyy"], "setting of a method"),
    (["load.axial", "load.axial"], ["kyy"], "is an input twice"), ([], ["kyy"], "are empty"),
    (["load.axial"], ["kyyy"], "did you mean 'kyy'"), (["load.axial"], ["K"], "is of a motion"),
    (None, ["kyy"], "`inputs`: must be text"), (5, ["kyy"], "`inputs` = 5: must be text"),
    (["load.axial"], [["kyy"]], "`outputs` = .*must be text"),
])  # fmt: skip
def test_functions_that_are_refused(inputs: list[str], outputs: list[str], words: str) -> None:
    with pytest.raises(rw.SceneError, match=words):
        rw.function(STATIC, inputs, outputs)


class Closed:
    """What has no numbers, and raises where it is asked for them."""

    def __array__(self, *_: object, **__: object) -> np.ndarray:
        raise OSError("closed")

    def __getattr__(self, name: str) -> object:
        raise OSError("closed")


def test_calls_that_are_refused() -> None:
    f = rw.function(STATIC, ["load.axial", "load.radial[0]"], ["kyy"])
    for columns, words in (
        (([400.0, 500.0], [1.0, 2.0, 3.0]), "do not broadcast"),
        (([], []), "are empty"),
        (([400.0],), "is missing"),
        (([400.0], [0.0], [1.0]), "more columns"),
        *(((wrong, [0.0]), "must be numbers") for wrong in (["many"], 10**400, [1j], Closed())),
    ):
        for call in (f, f.arrays, f.jacobian):
            with pytest.raises(rw.SceneError, match=words):
                call(*columns)
    with pytest.raises(rw.SceneError, match="is no input"):
        f([400.0], [0.0], **{"load.axail": 1.0})
    with pytest.raises(rw.RacewayError, match=r"need \S+ bytes"):
        f(np.broadcast_to(400.0, 10**11), 0.0)


def test_rings_of_points_grow_by_their_own_sections() -> None:
    scene = rw.Scene.from_dict({**STATIC, "kinematics": {"spin_speed_rpm": 2e4, "gyroscopic": "none", "ring_growth": True}})
    answer = rw.function(scene, ["bearing.pitch_diameter"], ["kyy"])([45.9e-3, 46.1e-3])
    runs = [rw.run(scene.with_(bearing={"pitch_diameter": size})).stiffness[1, 1] for size in (45.9e-3, 46.1e-3)]
    assert (answer["status"] == rw.PointStatus.COMPUTED).all()
    assert answer["kyy"] == pytest.approx(runs, rel=1e-9)


def test_points_that_share_no_loop_are_run() -> None:
    """Pressures of a law that has its own."""
    own = rw.function({**STATIC, "contact": {"kind": "penalty"}}, ["load.axial"], ["p0"])
    assert (
        own([900.0])["p0"][0] == rw.run({**STATIC, "contact": {"kind": "penalty"}, "load": {"axial": 900.0}}).extremes["p0"]
    )
