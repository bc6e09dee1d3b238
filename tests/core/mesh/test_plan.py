"""What `raceway plan` tells and refuses of meshes; sizes of bodies against the bearing's own."""

import json
from typing import ClassVar

import attrs
import pytest

from checks.validation import solids
from checks.validation.command_line import EXAMPLES, invoke
from checks.validation.scenes import built_in
from raceway import MeshError, PluginError, SceneError, load_scene, make_plan, scene_from_dict
from raceway.extend import mesh_bodies, resolve
from raceway.plugins.bodies.mesh import predicted_mesh

Abaqus = built_in("format", "abaqus")
Structured = built_in("mesher", "structured")

BEARING = load_scene(EXAMPLES / "minimal.toml").bearing


def scene(bodies="elastic", **mesh):
    return scene_from_dict(
        {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}, "bodies": {"kind": bodies}, "mesh": mesh}
    )


def test_the_prediction_is_the_mesh():
    chosen = scene(element_size=1.5e-3, nodes_per_semi_axis=2)
    found = predicted_mesh(resolve(chosen))
    meshes = mesh_bodies(resolve(chosen))
    assert {body["name"]: body["cells"] for body in found["bodies"]} == {n: len(m.cells) for n, m in meshes.items()}
    assert found["cells"] == sum(len(mesh.cells) for mesh in meshes.values())
    kept = sum(mesh.memory_bytes for mesh in meshes.values())
    # 92 to 104 bytes a cell are measured and 110 taken; a small mesh has more nodes and sets for its cells.
    assert sum(body["bytes"] for body in found["bodies"]) == pytest.approx(kept, rel=0.25)
    assert found["bytes"] > kept


@pytest.mark.parametrize(("mesh", "path", "words"), [
    ({"element_size": 5e-3}, "mesh.element_size", "is larger than the wall of the inner ring"),
    ({"element_size": 1e-5}, "mesh.element_size", "GiB, above 4 GiB"),
    ({"kind": "gmsh", "ball": "gone.step"}, "mesh", "does not exist"),
    ({"bodies": "rigid"}, "mesh", "rigid bodies have no mesh"),
])  # fmt: skip
def test_the_plan_refuses_meshes_beside_everything_else(mesh, path, words):
    chosen = attrs.evolve(scene(**mesh), kinematics=attrs.evolve(scene().kinematics, orbiting=True))
    with pytest.raises(SceneError) as told:
        make_plan(chosen)
    found = {mistake.path: mistake.message for mistake in told.value.mistakes}
    assert words in found[path]
    assert "kinematics.orbiting" in found
    assert "bodies.kind" not in found and ("bodies" in mesh or not any("rigid" in message for message in found.values()))


def test_the_plan_shows_the_mesh(monkeypatch):
    monkeypatch.setattr("raceway.plugins.bodies.elastic.allowed_bytes", lambda: float("inf"))
    found = json.loads(invoke("plan", EXAMPLES / "b7206_article_mesh.toml", "--json").stdout)
    assert found["mesh"]["cells"] == sum(body["cells"] for body in found["mesh"]["bodies"]) > 1_000_000
    shown = invoke("plan", EXAMPLES / "b7206_article_mesh.toml").stdout
    assert str(found["mesh"]["cells"]) in shown and "balls (12)" in shown and "MiB each" in shown


def test_a_mesh_without_a_kind_is_structured():
    assert isinstance(scene(element_size=1e-3).mesh, Structured)


@pytest.fixture(scope="module")
def millimetres(tmp_path_factory):
    """A coarse structured bearing as files in millimetres."""
    folder = tmp_path_factory.mktemp("millimetres")
    meshes = Structured(element_size=2.4e-3, nodes_per_semi_axis=1, growth=2.0).mesh(BEARING)
    for name in ("inner_ring", "outer_ring"):
        Abaqus().write(folder / f"{name}.inp", attrs.evolve(meshes[name], points=1e3 * meshes[name].points))
    return folder


@pytest.mark.parametrize("body", ["inner_ring", "outer_ring"])
def test_a_forgotten_scale_is_refused_with_the_remedy(millimetres, body):
    mesh = {"kind": "file", body: str(millimetres / f"{body}.inp")}
    with pytest.raises(MeshError, match=rf"`mesh.scale` = 1.0: the mesh of '{body}' .* write mesh.scale = 0.001 "):
        mesh_bodies(resolve(scene(**mesh)))
    with pytest.raises(MeshError, match=r"write mesh.scale = 0.001 "):
        mesh_bodies(resolve(scene(**mesh, scale=1e-6)))
    assert list(mesh_bodies(resolve(scene(**mesh, scale=1e-3)))) == [body]
    with pytest.raises(MeshError, match=r"write mesh.scale = 0.001"):  # inches in place of millimetres: no power of ten
        mesh_bodies(resolve(scene(**mesh, scale=25.4e-3)))


def test_a_body_of_another_bearing_is_warned_of(millimetres):
    mesh = {"kind": "file", "outer_ring": str(millimetres / "outer_ring.inp"), "scale": 1.1e-3}
    with pytest.warns(UserWarning, match=r"'outer_ring' measures 0.0682 m where `outer_diameter` of the bearing is 0.062 m"):
        mesh_bodies(resolve(scene(**mesh)))


def test_balls_of_another_size_are_warned_of_once(tmp_path):
    ball = Structured(element_size=2.4e-3, nodes_per_semi_axis=1, growth=2.0).mesh(BEARING)["ball_00"]
    centred = ball.points - 0.5 * (ball.points.max(axis=0) + ball.points.min(axis=0))
    Abaqus().write(tmp_path / "ball.inp", attrs.evolve(ball, points=0.8 * centred))
    with pytest.warns(UserWarning, match="`ball_diameter` of the bearing") as found:
        mesh_bodies(resolve(scene(kind="file", ball=str(tmp_path / "ball.inp"))))
    assert len(found) == 1


@pytest.mark.needs("gmsh")
@pytest.mark.parametrize(
    ("solid", "method", "size", "low", "high"),
    # Transfinite volumes are counted exactly; tetrahedra fill a solid as they please, fewer than three a cube of the size.
    [
        ("box", "transfinite", 1e-3, 1.0, 1.0),
        pytest.param("box", "subdivision", 0.5e-3, 1.0, 1.4, marks=pytest.mark.slow),
        ("ball", "subdivision", 3e-4, 1.0, 1.4),
    ],
)
def test_gmsh_is_predicted(tmp_path, solid, method, size, low, high):
    path = solids.write(tmp_path / f"{solid}.brep", solid)
    mesher = built_in("mesher", "gmsh")(ball=path, method=method, element_size=size, scale=1e-3)
    predicted, meshes = mesher.predict(BEARING), mesher.mesh(BEARING)
    cells = len(meshes["ball_00"].cells)
    assert low <= predicted.bodies["ball_00"] / cells <= high
    assert len(predicted.bodies) == BEARING.ball_count == len(meshes)
    assert predicted.memory_bytes > sum(mesh.memory_bytes for mesh in meshes.values())


@attrs.frozen
class Guessing:
    """A mesher of a third party that predicts, rightly or not, or fails."""

    name: ClassVar[str] = "guessing"
    answer: object

    def predict(self, bearing):
        if isinstance(self.answer, Exception):
            raise self.answer
        return self.answer

    mesh = predict


def test_other_meshers_predictions_are_judged():
    chosen = scene()
    assert predicted_mesh(resolve(attrs.evolve(chosen, mesh=Guessing({"ball_0": 7}))))["cells"] == 7
    with pytest.raises(MeshError, match="`mesh.kind` = 'guessing': would give about 1e\\+09 elements"):
        predicted_mesh(resolve(attrs.evolve(chosen, mesh=Guessing({"ball_0": 10**9}))))
    with pytest.raises(PluginError, match="predict\\(\\) returned float; it must be body -> number of cells"):
        predicted_mesh(resolve(attrs.evolve(chosen, mesh=Guessing(7.0))))


@pytest.mark.parametrize(("duty", "call"), [
    ("mesh", lambda scene: mesh_bodies(resolve(scene))), ("predict", lambda scene: predicted_mesh(resolve(scene))),
    ("predict", make_plan),
])  # fmt: skip
def test_what_a_mesher_raises_is_put_to_its_name(duty, call):
    with pytest.raises(PluginError, match=rf"^mesher 'guessing': {duty}\(\) raises KeyError: 'teeth'"):
        call(attrs.evolve(scene(), mesh=Guessing(KeyError("teeth"))))
    with pytest.raises(MemoryError):  # no fault of a mesher: the command line says what to do about it
        mesh_bodies(resolve(attrs.evolve(scene(), mesh=Guessing(MemoryError()))))
