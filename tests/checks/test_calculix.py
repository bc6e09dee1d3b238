"""Decks for CalculiX: what they hold; nothing is run."""

import numpy as np
import pytest

from checks import against_calculix, calculix
from checks.validation.groove import meshes


def _blocks(text):
    """Keyword lines with the data lines below them."""
    out = []
    for line in text.splitlines():
        if line.startswith("*"):
            out.append((line, []))
        else:
            out[-1][1].append(line)
    return out


def test_deck_of_the_groove_holds_every_node_and_cell_in_millimetres():
    ball, block = meshes(300.0, 1.0, growth=2.2, coarse=1.6e-3)
    blocks = _blocks(calculix.groove_deck(ball, block, 212e9, 0.29, 1e15, 5e-6))
    nodes = np.array([[float(x) for x in line.split(",")] for line in blocks[0][1]])
    assert len(nodes) == len(ball.points) + len(block.points)
    np.testing.assert_allclose(nodes[:, 1:], 1e3 * np.concatenate([ball.points, block.points]), atol=1e-11)  # 12 digits
    cells = [np.array([[int(x) for x in row.split(",")] for row in rows]) for key, rows in blocks if "TYPE=C3D8" in key]
    np.testing.assert_array_equal(cells[0][:, 1:], ball.cells + 1)
    np.testing.assert_array_equal(cells[1][:, 1:], block.cells + 1 + len(ball.points))
    keys = dict(blocks)
    assert keys["*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR"] == ["1000000"]  # 1e15 N/m3 are 1e6 N/mm3
    surface = keys["*SURFACE, NAME=RACEWAY, TYPE=ELEMENT"]
    assert len(surface) == len(block.facets("raceway")) and surface[0].endswith("S2")
    assert keys["*ELASTIC"] == ["212000, 0.29"]


def test_deck_of_a_bearing_holds_two_contacts_for_each_ball(tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text(
        '[bearing]\npreset = "B7206C"\n[mesh]\nkind = "structured"\nelement_size = 3e-3\nnodes_per_semi_axis = 1\n'
        "growth = 3.0\npatch = 0.5\n[load]\naxial = 1000.0\nradial = [500.0, 0.0]\n"
    )
    path = tmp_path / "deck.inp"
    assert against_calculix.main(["--scene", str(scene), "--deck", str(path)]) == 0
    blocks = _blocks(path.read_text())
    assert sum(key.startswith("*CONTACT PAIR") for key, _ in blocks) == 24
    assert [rows for key, rows in blocks if key == "*CLOAD"][0][0].endswith(", 1, 1000")
    assert any(key.startswith("*RIGID BODY, NSET=BORE") for key, _ in blocks)


@pytest.mark.parametrize("words", [["--load", "-5"], ["--load", "nan"], ["--nodes", "0"]])
def test_loads_and_nodes_below_zero_are_refused(words, capsys):
    with pytest.raises(SystemExit) as caught:
        against_calculix.main(words)
    assert caught.value.code == 2
    assert "must be greater than 0" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "said"), [(None, "nowhere.toml"), ('[bearing]\npreset = "B7206C"\n', "`mesh`: is required")]
)
def test_scenes_that_are_missing_or_without_a_mesh_end_with_a_message(text, said, tmp_path, capsys):
    scene = tmp_path / "nowhere.toml"
    if text is not None:
        scene.write_text(text)
    assert against_calculix.main(["--scene", str(scene), "--deck", str(tmp_path / "deck.inp")]) == 2
    assert said in capsys.readouterr().err


def test_answers_are_read():
    text = (
        "\n total force (fx,fy,fz) for set MIDDLE and time  0.1000000E+01\n\n       -2.8E+00 -2.9E+00 -7.5E+01\n"
        "\n contact stress (slave element+face,press,tang1,tang2) for all contact elements and time 0.1000000E+01\n\n"
        "      1049          2  1.481355E+03  0.000000E+00  0.000000E+00\n"
        "      1049          2  1.590171E+03  0.000000E+00  0.000000E+00\n"
    )
    force, pressure = calculix.read(text)
    np.testing.assert_array_equal(force, [-2.8, -2.9, -75.0])
    assert pressure == pytest.approx(1590.171e6)


def test_without_the_program_the_message_says_what_to_install(monkeypatch, capsys):
    monkeypatch.setattr(calculix.shutil, "which", lambda name: None)
    assert against_calculix.main([]) == 2
    assert "apt-get install calculix-ccx" in capsys.readouterr().err
