"""raceway view and mesh: what the surfaces measure, what is drawn of a state, numbers and files of meshes, refusals."""

import base64
import json
import re
from pathlib import Path

import attrs
import numpy as np
import pytest
from raceway_view.bodies import BearingSolids, contact_patch
from raceway_view.bodies import ball as solid_ball
from raceway_view.page import ball_cells, state_data
from raceway_view.pictures import LETTERS, ball_labels, contacts
from raceway_view.view import at_peak, at_rest

import raceway as rw
from checks.validation.command_line import COARSE, MINIMAL, invoke, python
from checks.validation.figures import assert_readable
from checks.validation.scenes import built_in
from raceway import scene_from_dict
from raceway.extend import picture, ring_shape
from raceway.testing import b7206c, run


def volume(surface):
    """Gauss's theorem over the triangles, with the surface's own normals."""
    corner = surface.points[surface.triangles]
    area = 0.5 * np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1)
    out = surface.normals[surface.triangles].mean(axis=1)
    return float((area * (corner.mean(axis=1) * out).sum(axis=1)).sum() / 3.0)


@pytest.fixture(scope="module")
def result():
    return run(scene_from_dict(b7206c(load={"axial": 300.0, "radial": [900.0, 0.0]})))


@pytest.fixture(scope="module")
def moving():
    excitation = {"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 3.2e-4}
    tables = b7206c(load={"axial": 1000.0}, excitation=excitation, integrator={"kind": "quasi_static", "turns": 1})
    return run(scene_from_dict(tables))


def test_rings_and_balls_have_their_volume(result):
    bearing = BearingSolids.of(result)
    for part in bearing.rings(cut=None):
        exact = 1e9 * ring_shape(bearing.shape, part.name.startswith("inner")).volume
        # 120 chords a turn: (2 pi / 120)^2 / 6 = 0.05 % of an area; normals of chords add as much.
        assert volume(part.surface) == pytest.approx(exact, rel=2e-3)
    # 24 x 36 facets of a ball: 1 - cos of half a facet, about 1 %.
    assert volume(solid_ball(9.525)) == pytest.approx(np.pi / 6.0 * 9.525**3, rel=2e-2)


def test_a_contact_ellipse_has_its_axes_and_peak():
    patch = contact_patch(np.zeros(3), np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0]), 10.0, (1.0, 0.1), 2000.0)
    reach = np.abs(patch.points).max(axis=0)
    # Laid on a ball of 5 mm: 1 mm across its tangent plane becomes 5 sin(atan(1/5)) = 0.98 mm, drawn 0.4 % above it.
    assert reach[0] == pytest.approx(0.98 * 1.004, rel=1e-3) and reach[2] == pytest.approx(0.1, rel=6e-3)
    # Hertz's pressure: at a share of the semi-axes the root of 1 less its square.
    assert np.unique(patch.values) == pytest.approx(2000.0 * np.sqrt(1.0 - np.linspace(1.0, 0.0, 6) ** 2))


def test_loads_decide_colours_and_arrows_and_open_contacts_have_neither(result):
    bearing, state = BearingSolids.of(result), at_rest(result)
    z = 12
    loads = [part.load for part in bearing.balls(state)]
    assert loads == pytest.approx(list(result.equilibrium.contact_force[:z]))
    open_balls = int((state.load[:z] == 0.0).sum())
    assert open_balls > 0  # three times as much radially as axially
    assert len(bearing.arrows(state, max(loads))) == z - open_balls
    assert len(bearing.patches(state)) == 2 * (z - open_balls)
    reach = [
        np.ptp(part.surface.points @ [0.0, 1.0, 0.0]) for part in bearing.arrows(state, max(loads)) if part.name == "load 0"
    ]
    # Ball 0 carries most: its arrow is 1.1 diameters long, but for what its contact angle takes.
    assert 0.9 * 9.525 < reach[0] <= 1.1 * 9.525 * 1.001


def test_contacts_lie_where_ring_and_ball_meet(result):
    bearing, state = BearingSolids.of(result), at_rest(result)
    towards, centres = bearing.towards(state), bearing.centres(state)
    for inner, ball in ((True, 0), (False, 12)):
        shape = ring_shape(bearing.shape, inner)
        x, y, _ = centres[0] + 0.5 * bearing.diameter * towards[ball]
        away = np.hypot(x - 1e3 * shape.centre_x, y - 1e3 * shape.centre_r)
        # The rings are drawn unloaded: off by no more than the approach and the groove's clearance for a turned angle.
        assert away == pytest.approx(1e3 * shape.groove, abs=0.06)


def test_a_drawn_ring_moves_and_tilts_as_it_is_said():
    """Turned about y by the right hand, what stands on +z goes along +x; about z what stands on -y."""
    result = run(scene_from_dict(b7206c(load={"axial": 1000.0, "moment": [2.0, 3.0]}, supports={"tilt": "free"})))
    state, places = at_rest(result), np.array([[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [0.0, 0.0, 0.0]])
    q = result.equilibrium.displacement
    assert state.load[3] > state.load[9] and state.load[6] > state.load[0]  # balls on +z and -y are pressed more
    drawn = attrs.evolve(state, motion=q)
    moved = BearingSolids.of(result).moved(places, drawn) - places
    assert moved[:, 0] == pytest.approx(q[0] + np.array([q[3], q[4], 0.0])) and moved[2] == pytest.approx(q[:3])


def test_the_peak_is_the_record_s_largest_load(moving):
    state, angle = at_peak(moving)
    assert 0.0 <= angle < 360.0
    assert state.load[:12].max() == pytest.approx(moving.simulation.record.contact_force[:, :12].max(), rel=1e-9)


def flat(points):
    """Seen along the axis, 15 pixels a millimetre."""
    return 15.0 * points[:, 1:] + 800.0


@pytest.mark.needs("pyvista")
def test_a_motion_is_drawn_when_a_ball_carries_most_too_and_has_an_orbit(result, moving, monkeypatch):
    for draws in ("overview", "figure_png"):
        monkeypatch.setattr(f"raceway_view.view.{draws}", lambda *_: b"drawn")
    still = {"bearing.png", "contacts.png", "ball-loads.png"}
    assert {*rw.view(result).pictures} == still
    assert {*rw.view(moving).pictures} == still | {"bearing-peak.png", "orbit.png"}


@pytest.mark.parametrize(("ball_count", "every"), [(12, 1), (25, 2)])
def test_labels_lie_on_no_arrow_and_on_no_other_label(ball_count, every):
    """On 12 balls all; on 25 small ones every second."""
    tables = b7206c(load={"axial": 300.0, "radial": [100.0, 0.0]})
    tables["bearing"] |= {"ball_count": ball_count, "ball_diameter": 9.525e-3 if ball_count == 12 else 4.5e-3}
    bearing = BearingSolids.of(found := run(scene_from_dict(tables)))
    state = at_rest(found)
    top = float(state.load.max())
    labels = ball_labels(bearing, state, top, flat)
    assert [int(text.split(":")[0]) for text, _ in labels] == list(range(0, ball_count, every))
    boxes = [np.array([corner, np.add(corner, (12.0 * len(text), LETTERS))]) for text, corner in labels]
    overlap = [(a[0] < b[1]).all() and (b[0] < a[1]).all() for k, a in enumerate(boxes) for b in boxes[:k]]
    assert not any(overlap)
    share = np.linspace(0.0, 1.0, 50)[:, None, None]
    tails, heads = (flat(points) for points in bearing.arrow_ends(state, top))
    arrows = ((1.0 - share) * tails + share * heads).reshape(-1, 2)
    assert not any(((low < arrows) & (arrows < high)).all(axis=1).any() for low, high in boxes)


def test_contact_ellipses_are_drawn_as_many_times_as_large_as_is_said(result):
    bearing, state = BearingSolids.of(result), at_rest(result)
    factor = bearing.widening(state)
    assert factor > 2, "specks in truth"
    ball = int(np.argmax(state.load[:12]))
    patch = next(part for part in bearing.patches(state) if part.name == f"inner contact {ball}")
    from_middle = (patch.surface.points - bearing.centres(state)[ball]) / (1.004 * 0.5 * bearing.diameter)
    widest = np.tan(np.arccos(from_middle @ bearing.towards(state)[ball])).max() * 0.5 * bearing.diameter
    assert widest == pytest.approx(factor * 1e3 * state.half[ball, 0], rel=1e-6)


def test_the_edge_of_a_drawn_contact_is_its_ellipse(result):
    state = at_rest(result)
    ball = int(np.argmax(state.load[:12]))
    panel = contacts(BearingSolids.of(result), state, "made up").axes[1]
    at = np.asarray(panel.collections[0].get_coordinates()) / (1e3 * state.half[ball])
    assert np.hypot(*at[:, -1].T) == pytest.approx(np.ones(at.shape[0]), rel=1e-12)


def test_the_section_points_to_the_contacts_and_both_ellipses_have_one_scale_of_pressure(result):
    bearing, state = BearingSolids.of(result), at_rest(result)
    ball = int(np.argmax(state.load[:12]))
    section, *panels = contacts(bearing, state, "made up").axes
    arrows = [text for text in section.texts if not text.get_text()]
    radial = [0.0, np.cos(state.azimuth[ball]), np.sin(state.azimuth[ball])]
    for arrow, towards in zip(arrows, bearing.towards(state)[[ball, 12 + ball]], strict=True):
        drawn = np.subtract(arrow.xy, arrow.xyann) / (0.5 * bearing.diameter)
        assert drawn == pytest.approx([towards[0], towards @ radial])
    words = " ".join(text.get_text() for text in section.texts)
    for panel, i in zip(panels, (ball, 12 + ball), strict=False):
        assert f"{state.load[i]:.4g} N" in words and f"{np.degrees(state.angle[i]):.2f}°" in words
        ends = [0.0, 1e-6 * max(state.peak[ball], state.peak[12 + ball])]
        assert panel.collections[0].get_clim() == pytest.approx(ends)
        assert (
            f"{1e-6 * state.peak[i]:.4g} MPa, {2e3 * state.half[i, 0]:.3g} x {2e3 * state.half[i, 1]:.3g} mm"
            in panel.get_title()
        )


def test_the_page_has_the_numbers_of_the_result_and_colours_by_its_bars(result):
    import matplotlib

    bearing, state, balls = BearingSolids.of(result), at_rest(result), result.to_dict()["equilibrium"]["balls"]
    for race in ("inner", "outer"):
        for k, (cells, ball) in enumerate(zip(ball_cells(state, race == "inner"), balls, strict=True)):
            columns = (("load_{}_n", 1.0), ("contact_angle_{}_deg", 1.0), ("peak_pressure_{}_pa", 1e-6),
                       ("semi_major_{}_m", 1e3), ("semi_minor_{}_m", 1e3))  # fmt: skip
            numbers = [factor * (ball[name.format(race)] or 0.0) for name, factor in columns]
            assert cells[0] == k and float(cells[1]) == pytest.approx(ball["azimuth_deg"])
            assert [float(cell or 0.0) for cell in cells[2:]] == pytest.approx(numbers, rel=5.1e-4)  # four digits
    data = state_data(bearing, state)
    top, peak = (max(ball[name] for ball in balls for name in names) for names in (
        ["load_inner_n"], ["peak_pressure_inner_pa", "peak_pressure_outer_pa"]))  # fmt: skip
    ends = [float(re.findall(r"<span>(.*?)</span>", bar)[-1]) for bar in data["bars"]]
    assert ends == pytest.approx([top, 1e-6 * peak], rel=5.1e-4)
    loads, pressures = (matplotlib.colormaps[name] for name in ("viridis", "inferno"))
    for part, ball in zip(data["parts"], balls, strict=False):
        assert part["colour"] == pytest.approx(loads(ball["load_inner_n"] / top)[:3], abs=1e-4)
    tones = np.frombuffer(base64.b64decode(data["shapes"]["patches 0"]["tones"]), np.uint8).reshape(-1, 4)
    values = np.concatenate([part.surface.values for part in bearing.patches(state)]) / (1e-6 * peak)
    assert np.abs(tones[:, :3] - 255.0 * pressures(values)[:, :3]).max() <= 0.51 and values.max() == pytest.approx(1.0)


def test_a_pair_has_four_rings_and_loads_that_point_apart():
    bearing = {"arrangement": "DB", "preload": 300.0}
    found = run(scene_from_dict(b7206c(bearing=bearing, load={"axial": 0.0, "radial": [100.0, 0.0]})))
    drawn = BearingSolids.of(found)
    assert len(drawn.rings(cut=None)) == 4
    towards = drawn.towards(at_rest(found))[24:]
    assert (towards[:12, 0] > 0.2).all() and (towards[12:, 0] < -0.2).all()
    labels = [text.get_text() for text in picture(found, "ball_loads").legends[0].get_texts()]
    assert labels == ["static, row 1", "static, row 2"]


def test_rings_without_dimensions_are_drawn_and_told(result):
    tables = b7206c()
    b = result.model.scene.bearing
    names = ("ball_diameter", "pitch_diameter", "ball_count", "conformity_inner", "conformity_outer", "contact_angle_deg")
    tables["bearing"] = {name: getattr(b, name) for name in names}
    drawn = BearingSolids.of(run(scene_from_dict(tables)))
    assert drawn.assumed == ("bore", "outer_diameter", "width")
    assert len(drawn.rings()) == 4


DRAWING = """
from raceway.cli.main import main
for words in {commands!r}:
    try:
        main(words)
    except SystemExit as end:
        assert end.code == 0, end.code
"""


@pytest.mark.slow
@pytest.mark.needs("pyvista")
def test_pictures_are_drawn_without_a_display_and_in_silence(tmp_path):
    """Of the view of a motion, and of a mesh; ``test_commands`` looks at those at rest."""
    view, mesh = (["--out", str(tmp_path / name), "--json"] for name in ("view", "mesh"))
    commands = [
        ["view", str(MINIMAL), "--set", "load.radial=[600,0]", *view],
        ["view", "--mesh", MINIMAL, *COARSE, "--picture", *mesh],
    ]
    found = python("-c", DRAWING.format(commands=commands), DISPLAY="", PYTHONWARNINGS="always")
    assert found.returncode == 0 and found.stderr == "", found.stderr
    content, _ = json.JSONDecoder().raw_decode(found.stdout)
    names = "bearing bearing-peak contacts ball-loads orbit"
    assert [Path(path).name for path in content["files"]] == [f"{name}.png" for name in names.split()]
    for path in [*tmp_path.glob("*/*.png")]:
        assert path.stat().st_size > 20_000, "empty pictures are smaller"
    assert (tmp_path / "mesh" / "mesh.png").is_file()
    assert content["largest_ball_load_n"] > 300.0 and 1e9 < content["largest_pressure_pa"] < 4e9


def test_mesh_counts_and_files(tmp_path):
    found = invoke("view", "--mesh", MINIMAL, *COARSE, "--out", tmp_path, "--json")
    assert found.exit_code == 0, found.output
    content = json.loads(found.stdout)
    assert content["elements"] == sum(body["elements"] for body in content["bodies"].values()) > 1000
    assert content["scaled_jacobian"]["min"] > 0.2
    assert len(content["bodies"]) == 14
    assert [Path(name).name for name in content["files"]] == ["inner_ring.vtu", "outer_ring.vtu", "balls.vtu"]
    assert sorted(map(str, tmp_path.iterdir())) == sorted(content["files"])
    balls = built_in("format", "vtu")().read(tmp_path / "balls.vtu")
    sizes = {name: body["elements"] for name, body in content["bodies"].items() if name.startswith("ball")}
    assert len(balls.cells) == sum(sizes.values()) and set(sizes) <= set(balls.node_sets)


def test_the_axial_load_sets_the_patch(tmp_path):
    widths = []
    for axial in (50.0, 5000.0):
        found = invoke("view", "--mesh", MINIMAL, *COARSE, "--set", f"load.axial={axial}", "--out", tmp_path, "--json")
        widths.append(json.loads(found.stdout)["patch_size_m"]["short"]["min"])
    # Semi-axes go with the cube root of a ball's load; 100 times the axial load, on a contact angle that grows, is 3 to 4.7.
    assert 3.0 < widths[1] / widths[0] < 4.7


MESHER = '''
import attrs
import numpy as np
from types import SimpleNamespace
from raceway import hookimpl

@attrs.frozen
class Wrong:
    """A mesher of a test."""

    name = "wrong"

    def mesh(self, bearing):
        corner = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
        points = 0.01 * np.array(corner, dtype=float)
        return {answer}

@hookimpl
def raceway_meshers():
    return [Wrong]
'''


FLIPPED = '{"ball_0": SimpleNamespace(points=points, cells=np.array([[4, 5, 6, 7, 0, 1, 2, 3]]))}'


@pytest.mark.parametrize(("answer", "words"), [
    ("None", "mesher 'wrong': mesh() returned NoneType; it must be meshes by name"),
    (FLIPPED, "`ball_0`: 1 of 1 cells are inverted or degenerate"),
    ('{"ball_0": points}', "mesher 'wrong': body 'ball_0' is no mesh"),
    ('{"inner_ring": SimpleNamespace(points=1e3 * points, cells=np.arange(8)[None])}', "must return metres"),
])  # fmt: skip
def test_what_a_plug_in_mesher_must_not_return(tmp_path, answer, words):
    (tmp_path / "wrong.py").write_text(MESHER.replace("{answer}", answer))
    given = ("--plugin", tmp_path / "wrong.py", "--set", "mesh.kind=wrong", "--out", tmp_path / "out")
    found = invoke("view", "--mesh", MINIMAL, *given)
    assert found.exit_code == 2
    assert words in " ".join(found.output.split())


def test_the_picture_of_contacts_is_readable():
    found = run(scene_from_dict(b7206c(load={"axial": 300.0, "radial": [900.0, 0.0]})))
    assert_readable([contacts(BearingSolids.of(found), at_rest(found), "made up")])
