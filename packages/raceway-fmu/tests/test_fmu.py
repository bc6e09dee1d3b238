"""``raceway export --fmu``: FMUs under fmpy, against the functions and kernels that they stand for."""

import ctypes
import json
import shutil
import subprocess
import zipfile
from pathlib import Path

import numpy as np
import pytest
from fmpy.build import build_platform_binary
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu
from raceway_fmu import unit
from raceway_fmu.map import Interval, fit

import raceway as rw
from checks.validation.fmu import FORCES, MAP, RANGES, Instance, exported, force_difference, jeffcott, map_difference
from raceway import SceneError
from raceway.extend import as_scene

#: `checks fmu` has the map over the speed, too.
TWO = {key: RANGES[key] for key in ("load.axial", "excitation.force")}
TURNING = MAP | {"contact": {}, "excitation": MAP["excitation"] | {"force": 400.0}}


@pytest.fixture(scope="module", autouse=True)
def compiled_in_haste():
    """A third of the compiler's time; tests/test_commands.py exports with the flags that users get."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(unit, "_FLAGS", ("-std=c99", "-O0", "-fPIC", "-shared"))
        yield


@pytest.fixture(scope="module")
def maps(tmp_path_factory: pytest.TempPathFactory) -> dict[int, Path]:
    return exported(tmp_path_factory.mktemp("map"), MAP, ranges=TWO, tolerance=1e-4)


@pytest.fixture(scope="module")
def forces(tmp_path_factory: pytest.TempPathFactory) -> dict[int, Path]:
    return exported(tmp_path_factory.mktemp("force"), TURNING, kind="force")


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("exchange", [False, True])
def test_map_is_the_function_within_its_stated_error(maps: dict[int, Path], version: int, exchange: bool) -> None:
    assert validate_fmu(maps[version]) == []
    instance = Instance(maps[version], exchange)
    assert instance.outputs == ["equivalent_stiffness", "equivalent_damping"]
    assert all(instance.value(f"relative_error.{name}") <= 1e-4 for name in instance.outputs)
    assert map_difference(instance, 500 if version == 2 and not exchange else 100, TWO) <= 1.0
    assert instance.in_range and not instance.messages


def test_map_is_the_run(maps: dict[int, Path]) -> None:
    instance = Instance(maps[2])
    for axial, force in [(450.0, 280.0), (1900.0, 60.0)]:
        changes = [f"load.axial={axial}", f"excitation.force={force}"]
        result, (stiffness, damping) = rw.run(rw.evolve(MAP, *changes)), instance(axial, force)
        errors = [instance.value(f"relative_error.{name}") for name in instance.outputs]
        assert stiffness == pytest.approx(result.K, rel=errors[0]) and damping == pytest.approx(result.C, rel=errors[1])


@pytest.mark.slow
def test_stated_error_of_loads_at_which_balls_lift_off(tmp_path: Path) -> None:
    """Derivatives jump there: more terms, a larger error, which is stated."""
    scene, ranges = rw.evolve(MAP, "excitation.force=800"), {"load.axial": (400.0, 2000.0)}
    instance = Instance(exported(tmp_path, scene, ranges=ranges, outputs=["K"])[2])
    axial = np.random.default_rng(2).uniform(400.0, 2000.0, size=200)
    expected = rw.function(scene, ranges, ["K"]).arrays(axial)
    values = np.array([instance(load)[0] for load in axial])
    assert np.abs(values / expected - 1.0).max() <= instance.value("relative_error.equivalent_stiffness") <= 1e-4


def test_stated_error_holds_at_a_corner() -> None:
    """Of a function that is steepest there: 1024 points inside see a part of its error."""

    def steep(columns: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        values = np.prod([1.0 / (1.02 - column) for column in columns], axis=0)[None]
        return values, np.ones_like(values)

    made, corner = fit(steep, [Interval(0.0, 1.0)] * 2, 1e-12, 400), [np.array([1.0])] * 2
    assert made.difference[0] >= np.abs(made(corner) - steep(corner)[0])[0, 0] > 0.0


def test_map_says_that_its_tolerance_is_not_reached() -> None:
    fmu = rw.export_fmu(FORCES["centrifugal"], ranges={"load.axial": (400.0, 2000.0)}, outputs=["kyy"], tolerance=1e-14)
    assert "(kyy), above the tolerance 1e-14. Narrow its ranges with --range." in fmu.unit.words


@pytest.mark.parametrize(("damping", "relative"), [(1e-3, True), pytest.param(0.0, False, marks=pytest.mark.slow)])
def test_error_of_little_damping_is_relative_to_it_or_absolute(tmp_path: Path, damping: float, relative: bool) -> None:
    scene, ranges = MAP | {"contact": {"damping": damping}}, {"load.axial": (400.0, 2000.0)}
    instance = Instance(exported(tmp_path, scene, ranges=ranges)[2])
    axial = np.linspace(400.0, 2000.0, 101)
    expected = rw.function(scene, ranges, ["C"]).arrays(axial)
    difference = np.abs([instance(load)[1] for load in axial] - expected)
    if relative:
        assert (difference / expected).max() <= instance.value("relative_error.equivalent_damping") < 1e-2
    else:
        assert difference.max() <= instance.value("error.equivalent_damping") < 1e-4
        assert "relative_error.equivalent_damping" not in instance.references


@pytest.mark.parametrize("version", [2, 3])
def test_beyond_the_range_ends_stand_and_are_flagged(maps: dict[int, Path], version: int) -> None:
    instance = Instance(maps[version])
    inside = instance(400.0, 100.0)
    assert np.array_equal(instance(100.0, 100.0), inside) and not instance.in_range
    assert len(instance.messages) == 1 and "load.axial 400 to 2000 N" in instance.messages[0]
    instance(500.0, 100.0)
    assert instance.in_range


@pytest.mark.parametrize("bad", [np.nan, np.inf])
@pytest.mark.parametrize("version", [2, 3])
def test_no_number_is_discarded(maps: dict[int, Path], forces: dict[int, Path], version: int, bad: float) -> None:
    for instance, point in ((Instance(maps[version]), (700.0, 100.0)), (Instance(forces[version]), (3e-5, *[0.0] * 6))):
        before = instance(*point)
        with pytest.raises(FMICallException, match="(?i)discard"):
            instance(bad, *point[1:])
        assert np.array_equal(instance(*point), before) and np.isfinite(before).all()
        assert instance.messages == ["an input is not a finite number: it keeps its value"]


#: A hypothesis of moments, one with growth, another law, a pair; others by night.
QUICK = ("shared", "traction")


@pytest.mark.parametrize("name", [pytest.param(name, marks=[pytest.mark.slow] * (name not in QUICK)) for name in FORCES])
def test_force_is_that_of_the_kernels(tmp_path: Path, name: str) -> None:
    """Both stop at a step of a ball whose square is rounding of its approach; stiffness keeps the step itself."""
    paths = exported(tmp_path, FORCES[name], kind="force")
    for version, path in paths.items():
        assert validate_fmu(path) == []
        instance = Instance(path, exchange=version == 3)
        differences = force_difference(instance, FORCES[name], 15 if version == 2 else 3)  # the same sources
        assert differences["force"] < 1e-11 and differences["load"] < 1e-11
        assert differences["stiffness"] < 1e-7 < instance.value("relative_error.stiffness")


@pytest.mark.parametrize("version", [2, 3])
def test_force_from_its_memory_is_that_without(forces: dict[int, Path], version: int) -> None:
    near, fresh = Instance(forces[version]), Instance(forces[version])
    point = [30e-6, 1e-6, -2e-6, 1e-5, 2e-5, 1200.0, 0.1]
    for part in np.linspace(0.9, 1.0, 11):
        out = near(*(part * np.array(point)))
    first = fresh(*point)
    assert out[:31] == pytest.approx(first[:31], rel=1e-10, abs=1e-10) and out[31:] == pytest.approx(first[31:], rel=1e-6)
    state = near.fmu.getFMUState() if version == 3 else near.fmu.getFMUstate()
    near(*(0.5 * np.array(point)))
    (near.fmu.setFMUState if version == 3 else near.fmu.setFMUstate)(state)
    assert np.array_equal(near.get(near._out), out)
    assert near(*point[:6], point[6] + np.pi / 6.0)[:5] == pytest.approx(out[:5], rel=1e-9), "the next ball takes the place"


@pytest.mark.parametrize("version", [2, 3])
def test_directional_derivatives(maps: dict[int, Path], forces: dict[int, Path], version: int) -> None:
    for path, point, steps in (
        (maps[version], (700.0, 100.0), (1e-2, 1e-2)),
        (forces[version], (30e-6, 1e-6, 0.0, 1e-5, 0.0, 1000.0, 0.1), (1e-9, 1e-9, 1e-9, 1e-7, 1e-7, 1e-1, 1e-4)),
    ):
        instance = Instance(path)
        instance(*point)
        for k, step in enumerate(steps):
            ends = [instance(*(np.array(point) + sign * step * np.eye(len(point))[k])) for sign in (-1.0, 1.0)]
            instance(*point)
            unknown, known = instance._out[:6], [instance._in[k]]
            found = [instance.fmu.getDirectionalDerivative([u], known, [1.0])[0] for u in unknown]
            expected = (ends[1] - ends[0])[:6] / (2.0 * step)
            assert found == pytest.approx(expected, rel=1e-4, abs=1e-4 * np.abs(expected).max())


@pytest.mark.parametrize("version", [2, 3])
def test_rotor_on_the_force_follows_the_orbit(forces: dict[int, Path], version: int) -> None:
    """Steps of a 720th of a turn: the method's own error is 2e-7."""
    assert jeffcott(Instance(forces[version]), TURNING, steps=720) < 1e-6


@pytest.mark.parametrize("version", [2, 3])
def test_plain_function_for_other_programs(maps: dict[int, Path], forces: dict[int, Path], version: int) -> None:
    for path, point, none in ((maps[version], (700.0, 100.0), 0), (forces[version], (3e-5, *[0.0] * 6), -1)):
        instance = Instance(path)
        outputs = getattr(instance.fmu.dll, f"{instance.description.coSimulation.modelIdentifier}_outputs")
        given, taken = (np.ascontiguousarray(point), np.zeros(len(instance.outputs)))
        pointers = [array.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for array in (given, taken)]
        assert outputs(*pointers) == 1 and taken == pytest.approx(instance(*point), rel=1e-12)
        given[0] = np.nan
        assert outputs(*pointers) == none


def test_heavy_loads_are_flagged(forces: dict[int, Path]) -> None:
    instance = Instance(forces[2])
    assert instance(30e-6, *[0.0] * 4, 1000.0, 0.0)[5] > 0.0 and instance.in_range
    assert instance(500e-6, *[0.0] * 4, 1000.0, 0.0)[5] > 6000.0 and not instance.in_range
    assert instance(30e-6, *[0.0] * 4, 1e4, 0.0)[5] > 0.0 and not instance.in_range
    races = rw.build_model(as_scene(TURNING)).bearing.basis
    for x in np.linspace(140e-6, 260e-6, 9):  # up to the static pressure of ISO 76 for ball bearings, of each race
        loads = instance(x, *[0.0] * 4, 1000.0, 0.0)[7:31].reshape(2, 12).max(axis=1)
        pressures = [np.max(race.peak_pressure(load)) for race, load in zip((races.inner, races.outer), loads, strict=True)]
        assert instance.in_range == (max(pressures) <= 4.2e9), (x, pressures)


@pytest.mark.parametrize("version", [2, pytest.param(3, marks=pytest.mark.slow)])
def test_sources_alone_where_no_compiler_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, version: int) -> None:
    scene = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}
    with monkeypatch.context() as patch:
        patch.setenv("PATH", "")
        fmu = rw.export_fmu(scene, ranges={"load.axial": (400.0, 2000.0)}, outputs=["kyy"])
        paths = fmu.save(tmp_path)
    assert any("no C compiler" in note for note in fmu.notes)
    path = next(path for path in paths if path.name.endswith(f"_fmi{version}.fmu"))
    assert not any(name.startswith("binaries") for name in zipfile.ZipFile(path).namelist())
    folder = tmp_path / "unpacked"
    zipfile.ZipFile(path).extractall(folder)
    build_platform_binary(folder)
    packed = shutil.make_archive(str(tmp_path / "built"), "zip", folder)
    assert Instance(Path(packed))(1000.0)[0] == pytest.approx(rw.run(scene).stiffness[1, 1], rel=1e-6)


def test_sources_compile_without_a_warning_and_are_short(
    tmp_path: Path, maps: dict[int, Path], forces: dict[int, Path]
) -> None:
    compilers = [name for name in ("gcc", "clang") if shutil.which(name)]
    assert compilers
    for path in (*maps.values(), *forces.values()):
        folder = tmp_path / path.stem
        zipfile.ZipFile(path).extractall(folder)
        sources = list((folder / "sources").glob("*.[ch]"))
        assert sum(len(source.read_text().splitlines()) for source in sources) <= 600
        for compiler in compilers:
            flags = ("-std=c99", "-O1", "-Wall", "-Wextra", "-Werror", "-c", "-o", "bearing.o")
            subprocess.run([compiler, *flags, f"fmi{path.stem[-1]}.c"], cwd=folder / "sources", check=True)


def test_a_title_is_no_code(tmp_path: Path) -> None:
    scene = FORCES["centrifugal"] | {"title": '7*/ #error "x" <b>&\\'}
    path = exported(tmp_path, scene, kind="force")[2]
    assert validate_fmu(path) == [] and path.name.startswith("_7") and Instance(path)(*[0.0] * 7).size == 56


def test_same_bearing_gives_the_same_bytes(tmp_path: Path) -> None:
    scene, options = FORCES["centrifugal"], {"ranges": {"load.axial": (400.0, 2000.0)}, "outputs": ["kyy"]}
    first, again = (exported(tmp_path / word, scene, **options) for word in ("first", "again"))
    assert all(again[version].read_bytes() == path.read_bytes() for version, path in first.items())


LAW = '''
import attrs
import numpy as np
from raceway import LAW, hookimpl, jit

@jit(LAW)
def blend(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate):
    for i in range(gap.size):
        d = max(-gap[i], 0.0)
        k, s = params[i, 0], 1e5 * d
        force[i] = k * d ** 1.5 * (1.0 + s / (1.0 + s))
        d_gap[i] = -k * (1.5 * d ** 0.5 * (1.0 + s / (1.0 + s)) + d ** 1.5 * 1e5 / (1.0 + s) ** 2)
        d_rate[i] = 0.0

@attrs.frozen
class Blend:
    """Hertz' law, stiffer when deep."""
    name = "blend"
    discretisations = frozenset({"resultant"})
    state_size = 0
    dissipative = False
    def build(self, pairs):
        return pairs.hertz_factor[:, np.newaxis]
    def kernel(self):
        return blend

@hookimpl
def raceway_contact_laws():
    return [Blend]
'''


def test_foreign_law_is_a_table(tmp_path: Path) -> None:
    (tmp_path / "blend.py").write_text(LAW)
    scene = as_scene(FORCES["centrifugal"] | {"contact": {"kind": "blend"}}, plugins=[tmp_path / "blend.py"])
    instance = Instance(exported(tmp_path, scene, kind="force")[2])
    assert instance.value("relative_error.force") < 1e-8
    model = rw.build_model(scene)
    q = np.array([35e-6, 2e-6, -3e-6, 0.0, 1e-5])
    core = model.system.evaluate(q)
    out = instance(*q, 12000.0 * np.pi / 30.0, 0.0)
    assert out[7:31] == pytest.approx(core.contact_force, rel=1e-7)
    assert -out[:3] == pytest.approx(core.force[:3], rel=1e-7)


@pytest.mark.parametrize(("changes", "key"), [
    ({"contact": {"friction": 0.03}}, "contact.friction"),
    ({"contact": {"kind": "film"}, "lubricant": {"oil": "VG 32", "temperature_c": 60.0}}, "contact.kind"),
    ({"bodies": {"kind": "condensed"}}, "bodies.kind"),
    ({"bearing": FORCES["DB"]["bearing"] | {"preload_kind": "spring"}}, "bearing.preload_kind"),
])  # fmt: skip
def test_force_refuses_what_is_no_function_of_the_displacement(changes: dict[str, dict[str, object]], key: str) -> None:
    with pytest.raises(SceneError, match="--kind map") as refusal:
        rw.export_fmu(FORCES["centrifugal"] | changes, kind="force")
    assert refusal.value.mistakes[0].path == key


def test_refusals_of_a_map() -> None:
    scene = FORCES["centrifugal"]
    with pytest.raises(SceneError, match="no continuous key"):
        rw.export_fmu(scene, ranges={"load.axail": (1.0, 2.0)})
    with pytest.raises(SceneError, match="is an array"):
        rw.export_fmu(scene, ranges={"load.axial": (400.0, 800.0)}, outputs=["ball_load"])
    with pytest.raises(rw.RacewayError, match="no answer at load.axial = 0"):
        rw.export_fmu(scene, ranges={"load.axial": (0.0, 800.0)}, outputs=["kyy"])
    with pytest.raises(rw.RacewayError, match="several motions exist there, .* Narrow its ranges"):
        rw.export_fmu(MAP, ranges={"load.axial": (220.0, 300.0), "excitation.force": (500.0, 600.0)})
    with pytest.raises(SceneError, match="range low:high"):
        rw.export_fmu(scene, ranges=["load.axial"])
    with pytest.raises(SceneError, match="of its own"):
        rw.export_fmu(scene, kind="force", outputs=["K"])
    with pytest.raises(SceneError, match="--range kinematics.spin_speed_rpm=0:X only"):
        rw.export_fmu(scene, kind="force", ranges={"kinematics.spin_speed_rpm": (5000.0, 9000.0)})
    with pytest.raises(SceneError, match="second range of this key"):
        rw.export_fmu(scene, ranges=["load.axial=400:800", "load.axial=400:900"])
    for tolerance in (0.0, -1.0):
        with pytest.raises(SceneError, match="must lie between 0 and 1"):
            rw.export_fmu(scene, tolerance=tolerance)
    with pytest.raises(
        rw.RacewayError, match="1024 points would take about .* because rollers move: a map needs at least these"
    ):
        rw.export_fmu("examples/cylindrical_rollers.toml")


def test_stiffness_of_a_static_scene_over_default_ranges(tmp_path: Path) -> None:
    fmu = rw.export_fmu(FORCES["centrifugal"])
    assert [variable.name for variable in fmu.unit.inputs] == ["load.axial", "kinematics.spin_speed_rpm"]
    names = [variable.name for variable in fmu.unit.outputs]
    assert "stiffness.y.tilt_z" in names and "stiffness.x.y" not in names, "zeros are left out"
    fmu.save(tmp_path)
    assert json.loads((tmp_path / "fmu.json").read_text())["variables"][0]["low"] == 500.0
    assert "about the scene's own numbers" in str(fmu.notes)
