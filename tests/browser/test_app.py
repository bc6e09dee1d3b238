"""``raceway app`` in headless chromium, used as a person does."""

from __future__ import annotations

import random

import pytest

from validation.browser.application import Application, Tab, expected
from validation.browser.chromium import Browser
from validation.command_line import EXAMPLES

pytestmark = pytest.mark.needs("browser")
SCENE = str(EXAMPLES / "b7206.toml")


@pytest.fixture(scope="module")
def browser():
    chromium = Browser()
    yield chromium
    chromium.close()


@pytest.fixture(scope="module")
def application(tmp_path_factory):
    served = Application(tmp_path_factory.mktemp("app"), SCENE)
    served.folder = tmp_path_factory.getbasetemp()
    yield served
    assert served.stop() in (0, 130)


@pytest.fixture
def tab(browser, application):
    page = Tab(browser, application.address)
    yield page
    assert page.faults() == []


def shown_is_run(page: Tab, panels=(0,)) -> None:
    """Each number of the page is that of the run of the scene shown."""
    for panel in panels:
        shown = [(name, value) for name, value in page.values(panel) if value]
        assert shown == expected(page.scene(panel))


def test_numbers_are_those_of_the_run_after_fields_and_sliders(tab):
    shown_is_run(tab)
    tab.set("load.axial", "1.3 kN")
    assert tab.scene(0)["load"]["axial"] == pytest.approx(1300.0)
    shown_is_run(tab)
    tab.drag("excitation.speed_rpm", 9000)
    tab.wait()
    assert tab.scene(0)["excitation"]["speed_rpm"] == pytest.approx(9000.0)
    shown_is_run(tab)
    tab.set("supports.tilt", "free")
    shown_is_run(tab)
    charts = tab.browser.run("return [...document.querySelectorAll('.chart svg')].map((e) => e.getAttribute('aria-label'))")
    assert any(label.startswith("stiffness over speed") and "equivalent stiffness" in label for label in charts)
    tab.press("Undo")
    assert tab.scene(0)["supports"]["tilt"] == "locked"
    shown_is_run(tab)


def test_a_refused_scene_has_no_numbers_and_states_the_rule_at_its_field(tab):
    tab.set("rotor.mass", "-1")
    assert "must be at least 0" in tab.text('[data-fault="rotor.mass"]')
    assert tab.values(0) == [] and tab.browser.run("return document.querySelectorAll('.chart').length") == 0
    tab.press("Undo")
    shown_is_run(tab)


def test_two_excitation_models_stand_side_by_side(tab):
    tab.press("Compare two scenes")
    kinds = [tab.scene(k)["excitation"]["kind"] for k in (0, 1)]
    assert kinds == ["bidirectional", "unidirectional"]
    shown_is_run(tab, (0, 1))
    tab.set("load.axial", "1500")
    assert [tab.scene(k)["load"]["axial"] for k in (0, 1)] == [1500, 1500]
    shown_is_run(tab, (0, 1))
    tab.press("Compare two scenes")
    assert "B" not in tab.text('[data-test="numbers"] thead')


def test_random_changes_leave_no_stale_number(tab):
    """Sequences of a person in a hurry; the night's are 200."""
    hurry(tab, sequences=6, seed=1)


@pytest.mark.night
def test_two_hundred_random_sequences_leave_no_stale_number(tab):
    hurry(tab, sequences=200, seed=2)


#: Keys that a person changes, and texts to type; some are refused.
CHANGES = {
    "load.axial": ["300", "1 kN", "2500", "-400", "0"],
    "load.radial": ["[100, 0]", "[0, 0]", ""],
    "excitation.speed_rpm": ["3000", "12000", "21000", "250 Hz"],
    "excitation.kind": ["unidirectional", "bidirectional"],
    "excitation.unbalance": ["1e-4", "6.39e-4", "300 g mm"],
    "supports.tilt": ["free", "locked", ""],
    "rotor.mass": ["1.5", "4", "-1", "heavy"],
    "bearing.preset": ["B7206C", "7206A-NSK", "6206", "B7206X"],
    "bearing.contact_angle_deg": ["18", "", "95"],
    "kinematics.gyroscopic": ["outer_race", "shared", ""],
    "kinematics.ring_growth": ["true", ""],
    "contact.damping": ["0.001", "50", ""],
    "contact.kind": ["penalty", "hertz"],
}


def hurry(page: Tab, sequences: int, seed: int) -> None:
    """Some changes one after another without a look at the page, then a look."""
    chance = random.Random(seed)
    for _ in range(sequences):
        for _ in range(chance.randint(1, 5)):
            action = chance.random()
            if action < 0.1:
                page.press_any(["Undo", "Redo"][chance.randrange(2)])
            elif action < 0.18:
                page.press_any("Compare two scenes")
            else:
                key = chance.choice(list(CHANGES))
                page.type(key, chance.choice(CHANGES[key]))
        page.settle()
        for panel in range(page.panels()):
            shown = [(name, value) for name, value in page.values(panel) if value]
            refused = page.text(f'[data-test="mistakes-{panel}"]')
            assert bool(refused) == (not shown)
            if shown:
                assert shown == expected(page.scene(panel))
    while page.press_any("Undo"):
        page.settle()
