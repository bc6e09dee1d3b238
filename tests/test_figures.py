"""Every figure of the project shows what it draws: no point lies outside its axes, whatever the numbers are."""

import struct
from collections.abc import Callable
from pathlib import Path

import attrs
import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

import raceway
from checks.validation.command_line import MINIMAL, invoke
from checks.validation.figures import assert_readable, makers, outside
from checks.validation.stores import SPEEDS, as_list, made
from raceway import Followed, load_scene, scene_from_dict
from raceway.answers import picture as writer
from raceway.extend import Attractor, picture, select
from raceway.points.branch import Label, Orbit
from raceway.points.plot import draw, layout
from raceway.testing import b7206c, run
from tests import test_compare

LOADS = np.linspace(200.0, 2000.0, 5)


def of_a_run() -> list[Figure]:
    excitation = {"kind": "unidirectional", "speed_rpm": 12000.0, "amplitude": "constant", "force": 300.0}
    tables = b7206c(
        load={"axial": 100.0}, excitation=excitation, integrator={"turns": 2, "steps_per_turn": 60, "start": "ramp"}
    )
    moving, still = run(scene_from_dict(tables)), run(scene_from_dict(b7206c(load={"axial": 300.0, "radial": [900.0, 0.0]})))
    names = ("orbit", "spectrum", "ball_loads")
    return [*(picture(moving, name) for name in names), picture(still, "ball_loads"), of_equal_rows()]


def of_equal_rows() -> Figure:
    """Ball loads of a pair under an axial preload alone: those of both rows are the same."""
    turning = {"kind": "bidirectional", "speed_rpm": 9000.0, "amplitude": "constant", "force": 20.0}
    pair = {"preset": "B7206C", "arrangement": "DB", "preload": 300.0}
    return picture(raceway.run({"bearing": pair, "excitation": turning}), "ball_loads")


def of_a_sweep() -> list[Figure]:
    data = made({"load.axial": LOADS, "excitation.speed_rpm": SPEEDS})
    found = [layout(select(data, {}), kind=kind) for kind in ("curves", "map", "surface")]
    found += [layout(select(as_list(data).isel(point=slice(0, 30)), {}), kind=kind) for kind in ("curves", "map")]
    three = {"load.axial": LOADS[:3], "supports.tilt": ["free", "locked"], "excitation.speed_rpm": SPEEDS}
    found.append(layout(select(made(three), {})))
    return [draw(p) for p in found]


def of_a_comparison() -> list[Figure]:
    whole = test_compare.with_error(test_compare._synthetic(test_compare._k), 1.2, **test_compare.ONE)
    far = [attrs.evolve(row, result={**row.result, "identification": {**row.result["identification"], "equivalent_stiffness": 9e9}})
           if row.doubt else row for row in whole.rows]  # fmt: skip
    dots = [row for row in whole.rows if row.point["excitation.speed_rpm"] == 10000]
    axes = tuple(axis for axis in whole.axes if axis.key != "excitation.speed_rpm")
    return [attrs.evolve(whole, rows=tuple(far)).draw(), attrs.evolve(whole, axes=axes, rows=tuple(dots)).draw()]


def of_sensitivities() -> list[Figure]:
    answer = raceway.sensitivities(b7206c(load={"axial": 300.0, "radial": [100.0, 0.0]}))
    first = answer.rows[0]
    odd = attrs.evolve(first, influence={name: share * 1e4 for name, share in first.influence.items()})
    return [answer.draw(), attrs.evolve(answer, rows=(odd,)).draw()]


def of_a_band() -> list[Figure]:
    found = raceway.band(
        b7206c(load={"axial": 300.0}), {"load.axial": "±10 %", "bearing.contact_angle_deg": "±1 deg"}, count=4
    )
    found = attrs.evolve(found, nominal=dict(list(found.nominal.items())[:4]))
    lost = attrs.evolve(found, total={}, first={})
    odd = {
        name: dict.fromkeys(found.nominal, indices) for name, indices in {"total": [1.3, -0.2], "first": [1.1, -0.1]}.items()
    }
    return [one.draw() for one in (lost, attrs.evolve(found, **odd))]


def of_a_branch() -> list[Figure]:
    """Through two folds, one of them unstable; every kind of label."""
    orbit = Orbit(0.0, 0.0, 100.0, 1e8 + 1e6j, 0.0, 1e-6, 1e-6, 1.0, 0, 0, 0.0, "stable", "")
    speeds = enumerate((1.0, 2.0, 3.0, 4.0, 3.8, 3.6, 4.2, 5.0))
    rows = [
        attrs.evolve(orbit, parameter=p, swing=1e-6 * k, z=1e8 / (1 + k), verdict="unstable" if 3 < k < 6 else "stable")
        for k, p in speeds
    ]
    kinds = ("fold", "branch point", "period doubling", "Neimark-Sacker", "contact opens", "peak")
    labels = [Label(kind, row) for kind, row in zip(kinds, rows, strict=False)]
    section = Attractor(3.8, "quasi-periodic", 50, section=np.array([[np.cos(k), np.sin(k)] for k in range(50)]))
    twice = Followed(
        "load.axial", 1.0, 5.0, 180.0, "made up", [attrs.evolve(row, swing=row.swing + 1e-6) for row in rows], labels[:2]
    )
    branch = Followed("load.axial", 1.0, 5.0, 90.0, "made up", rows, labels, attractors=[section] * 2, doubled=[twice])
    return [branch.draw()]


#: File that makes figures -> how they come about here.
DRAWN: dict[str, Callable[[], list[Figure]]] = {
    "plugins/formats": of_a_run, "points/plot": of_a_sweep, "points/compare": of_a_comparison, "points/branch": of_a_branch,
    "points/sensitivities": of_sensitivities, "points/band": of_a_band,
}  # fmt: skip


@pytest.mark.parametrize("draw", [pytest.param(draw, id=draw.__name__) for draw in DRAWN.values()])
def test_every_drawn_point_lies_inside_its_axes_and_is_read_at_600_pixels(draw):
    assert_readable(draw())


def test_equal_rows_are_both_seen():
    (axes,) = of_equal_rows().axes
    below, above = axes.lines
    assert below.get_ydata() == pytest.approx(above.get_ydata(), rel=1e-9) and below.zorder <= above.zorder
    assert below.get_markersize() > 2.0 * above.get_markersize() and below.get_linewidth() > 2.0 * above.get_linewidth()
    assert abs(grey(below.get_color()) - grey(above.get_color())) > 0.15 and below.get_marker() != above.get_marker()
    wide, narrow = (lines.get_linewidth()[0] for lines in axes.collections)
    assert wide > narrow + 3.0


def grey(colour) -> float:
    """Luminance of a colour, 0 to 1 (ITU-R BT.709)."""
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in to_rgb(colour)]
    return float(np.dot([0.2126, 0.7152, 0.0722], linear)) ** (1.0 / 2.2)


#: What protanopes and deuteranopes see of linear red, green and blue: Vienot, Brettel, Mollon, Color Res. Appl. 24 (1999) 243.
BLIND = {
    "protan": [[0.11238, 0.88762, 0.0], [0.11238, 0.88762, 0.0], [0.00401, -0.00401, 1.0]],
    "deutan": [[0.29275, 0.70725, 0.0], [0.29275, 0.70725, 0.0], [-0.02234, 0.02234, 1.0]],
}


def test_neighbouring_curves_differ_in_grey_and_for_the_colour_blind():
    colours = [np.array(to_rgb(colour)) for colour in writer.COLOURS]
    for one, other in zip(colours, colours[1:], strict=False):
        assert abs(grey(one) - grey(other)) > 0.1
        for seen in BLIND.values():
            a, b = (np.clip(np.array(seen) @ colour**2.2, 0.0, 1.0) ** (1.0 / 2.2) for colour in (one, other))
            assert np.linalg.norm(a - b) > 0.2
    looks = [writer.Line(np.arange(3.0), np.arange(3.0), place=k).look for k in range(8)]
    assert len({look["marker"] for look in looks}) == 8 and len({str(look["linestyle"]) for look in looks[:5]}) == 5


@pytest.mark.slow
def test_pictures_are_written_for_a_page_and_for_a_paper(tmp_path, all_pixels):
    for form in ("pdf", "svg"):
        found = invoke("run", MINIMAL, "--picture-format", form, "--out", tmp_path)
        assert found.exit_code == 0, found.stderr
    files, result = {path.name: path.read_bytes() for path in tmp_path.iterdir()}, run(load_scene(MINIMAL))
    for name in ("orbit", "spectrum", "ball-loads"):
        dots = struct.unpack(">II", files[f"{name}.png"][16:24])
        inches = picture(result, name.replace("-", "_")).get_size_inches()
        assert dots == tuple(round(300 * inch) for inch in inches)
        assert b"CIDFontType2" in files[f"{name}.pdf"] and b"/Type3" not in files[f"{name}.pdf"]
        assert b"<svg" in files[f"{name}.svg"]


def test_names_at_the_ends_of_curves_stand_apart_beside_their_axes():
    """Of four curves that end at the top, where names find no room above."""
    axes = Figure().subplots()
    axes.plot([0.0, 1.0], [0.0, 1.0])
    axes.set_ylim(0.0, 1.0)
    writer.name_ends(axes, [(0.97 + 0.01 * k, f"curve {k}", "k") for k in range(4)], 0.13)
    heights = [text.xy[1] for text in axes.texts]
    assert np.diff(heights).min() >= 0.13 - 1e-12 and max(heights) <= 1.0


def test_no_module_makes_figures_that_are_not_looked_at_here():
    assert makers(Path(raceway.__file__).parent) == {*DRAWN, "answers/picture"}  # the last makes the figures


@pytest.mark.parametrize("what", ["line", "scatter", "lines", "patch", "log", "across"])
def test_what_lies_outside_is_seen(what):
    axes = Figure().subplots()
    axes.plot([0.0, 1.0], [1.0, 2.0])
    axes.set(xlim=(0.0, 1.0), ylim=(0.5, 2.5))
    assert outside(axes.figure) == []
    draw = {
        "line": lambda: axes.plot([0.5], [120.0], "o"),
        "scatter": lambda: axes.scatter([0.5, 0.6], [2.0, 2.6]),
        "lines": lambda: axes.vlines([0.5], 1.0, 3.0),
        "patch": lambda: axes.fill([0.0, 1.0, 2.0], [1.0, 2.0, 1.0]),
        "log": lambda: (axes.set_yscale("log"), axes.plot([0.5], [0.1])),
        "across": lambda: axes.axhline(3.0),  # its ends along x are parts of the axes, its place along y is data
    }
    draw[what]()
    axes.set(xlim=(0.0, 1.0), ylim=(0.5, 2.5))
    assert len(outside(axes.figure)) == 1
