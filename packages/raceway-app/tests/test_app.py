"""``raceway app`` in headless chromium, used as a person does."""

import json
import re
import time
from importlib.resources import files
from pathlib import Path

import pytest

import raceway as rw
from checks.validation.browser.application import Application, Tab, expected
from checks.validation.browser.chromium import Browser
from checks.validation.command_line import EXAMPLES, PATIENCE_S

pytestmark = pytest.mark.needs("browser")
SCENE = str(EXAMPLES / "b7206.toml")
#: Title of the scene that the tests share.
SCRIPT = (
    "<img src=x onerror='window.hacked=1'><script>window.hacked=1</script>{{constructor.constructor('window.hacked=1')()}}"
)


@pytest.fixture(scope="module")
def browser():
    chromium = Browser()
    yield chromium
    chromium.close()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("app")


@pytest.fixture(scope="module")
def application(folder):
    path = folder / "scene.toml"
    path.write_text(re.sub("(?m)^title = .*", f"title = {json.dumps(SCRIPT)}", Path(SCENE).read_text()))
    with Application(folder / "files", str(path)) as served:
        yield served


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


@pytest.mark.slow
def test_a_second_scene_that_is_taken_away_at_once_leaves_nothing(tab):
    for count in (2, 1) * 3:
        tab.press_any("Compare two scenes")
        while tab.panels() != count:  # the picture of the second is computed still
            time.sleep(0.005)
    tab.settle()
    time.sleep(0.5)
    readings = tab.browser.run("return [...document.querySelectorAll('.reading')].map((e) => e.textContent)")
    assert readings and all(text.startswith("A") for text in readings)


@pytest.mark.slow
def test_a_reload_and_a_second_tab_show_the_same(tab, browser, application):
    tab.set("load.axial", "1700")
    first = tab.values(0)
    browser.driver.refresh()
    tab.wait()
    assert tab.values(0) == first
    window = browser.driver.current_window_handle
    browser.driver.switch_to.new_window("tab")
    second = Tab(browser, application.address)
    assert second.values(0) == first
    second.set("load.axial", "900")
    other = second.values(0)
    browser.driver.close()
    browser.driver.switch_to.window(window)
    tab.settle()
    assert tab.values(0) == other != first
    shown_is_run(tab)


def test_a_script_in_a_title_is_text(tab):
    tab.set("rotor.mass", "<script>window.hacked=1</script>")
    assert "<script>" in tab.text('[data-fault="rotor.mass"]')
    tab.press("Undo")
    assert SCRIPT in tab.text('[data-test="title"]')
    assert tab.browser.run("return window.hacked ?? null") is None


@pytest.mark.slow
def test_a_server_that_has_stopped_is_seen(browser, tmp_path):
    with Application(tmp_path, SCENE) as served:
        Tab(browser, served.address)
        assert served.stop() in (0, 130)
        end = time.monotonic() + PATIENCE_S
        while "onnect" not in (words := browser.run("return document.body.innerText")):
            assert time.monotonic() < end
            time.sleep(0.1)
        assert "equivalent stiffness" not in words  # no numbers of a scene that nobody computes


@pytest.mark.slow
def test_keys_undo_and_redo(tab):
    from selenium.webdriver import ActionChains, Keys

    before = tab.scene(0)["load"]["axial"]
    tab.set("load.axial", "1111")
    tab.browser.run("document.activeElement.blur()")
    for key, axial in (("z", before), ("y", 1111)):
        last = tab.number
        ActionChains(tab.driver).key_down(Keys.CONTROL).send_keys(key).key_up(Keys.CONTROL).perform()
        tab.wait(last)
        assert tab.scene(0)["load"]["axial"] == axial


@pytest.mark.slow
def test_a_slider_is_moved_by_the_keyboard(tab):
    from selenium.webdriver import Keys

    field, last = tab.driver.find_element("css selector", '[data-slider="load.axial"]'), tab.number
    before = float(tab.scene(0)["load"]["axial"])
    field.send_keys(Keys.ARROW_RIGHT)
    tab.wait(last)
    tab.settle()
    assert before < tab.scene(0)["load"]["axial"] < 1.1 * before
    shown_is_run(tab)


#: Intervals by cause of two scenes, whether they are of one bearing, and the interval of their ratio.
APART = [
    ({"numerical": (-3, 3)}, {"numerical": (-4, 4)}, True, (-5, 5)),  # errors that do not know of each other
    ({"geometry": (-1, 2)}, {"geometry": (-2, 5)}, True, (-1, 3)),  # one cause, which moves both
    ({"data": (0, 2)}, {"data": (0, 5)}, True, (0, 3)),
    ({"data": (0, 2)}, {"data": (0, 5)}, False, (-2, 5)),  # the first may be larger, or the second
    ({"hypotheses": (0, 1), "contact": (0, 3), "numerical": (-3, 3)}, {"hypotheses": (0, 0), "contact": (0, 0), "numerical": (0, 0)},
     True, (-5, 3)),
]  # fmt: skip


@pytest.mark.parametrize(("first", "second", "same", "wanted"), APART)
def test_the_interval_of_a_ratio_is_that_of_what_both_do_not_share(browser, first, second, same, wanted):
    script = (files("raceway_app") / "data/app.js").read_text(encoding="utf-8")
    (function,) = re.findall(r"^  function apart\(.*?^  \}\n", script, re.DOTALL | re.MULTILINE)
    parts = [{"K": {"parts": {cause: {"low": a, "high": b} for cause, (a, b) in one.items()}}} for one in (first, second)]
    code = f"const INTERVALS = {{}}; {function} return apart(arguments[0].map((intervals) => ({{ intervals }})), 'K', arguments[1])"
    assert browser.run(code, parts, same) == pytest.approx(wanted)


def test_search_finds_keys_by_what_they_are(tab):
    tab.browser.run(
        "const s = document.querySelector('.search input'); s.value = 'clearance'; s.dispatchEvent(new Event('input'))"
    )
    tab.settle()
    paths = tab.browser.run("return [...document.querySelectorAll('[data-field]')].map((e) => e.dataset.field)")
    assert "bearing.radial_clearance" in paths and len(paths) < 12


def test_axes_of_the_curves_can_be_set(tab):
    last = tab.number
    script = "const f = document.querySelector('.charts input[type=number]'); f.value = 2000; f.dispatchEvent(new Event('change'))"
    tab.browser.run(script)
    tab.wait(last)
    assert tab.browser.run("return document.querySelector('.charts input[type=number]').value") == "2000"


@pytest.mark.slow
def test_files_are_written_into_the_folder(tab, folder):
    tab.rest()
    for words, name in (("Save scene", ".toml"), ("Curves as CSV", "curves.csv"), ("PNG", ".png"), ("ROSS", "bearing.toml")):
        tab.press(words, changes=False)
        end = time.monotonic() + PATIENCE_S
        while not ((note := tab.text('[data-test="note"]')).startswith("written: ") and note.endswith(name)):
            assert time.monotonic() < end, note
            time.sleep(0.05)
    assert {path.suffix for path in folder.rglob("*.*")} == {".toml", ".csv", ".png"}
    rows = (folder / "curves.csv").read_text().splitlines()
    assert rows[0] == "scene,axis,x,quantity,unit,value" and len(rows) > 300


@pytest.mark.slow
def test_long_work_is_stopped(browser, tmp_path):
    with Application(tmp_path, SCENE) as served:
        tab = Tab(browser, served.address)
        last = tab.number
        tab.type("integrator.kind", "newmark")
        tab.wait(last)
        last = tab.number
        tab.type("integrator.turns", "8000")
        end = time.monotonic() + PATIENCE_S
        while "planned" not in (words := tab.text('[data-test="busy"]')) and "%" not in words:
            assert time.monotonic() < end, words
            time.sleep(0.05)
        tab.press("Stop", changes=False)
        tab.wait(last)
        assert "stopped" in tab.text('[data-test="mistakes-0"]') and tab.values(0) == []
        tab.press("Undo")
        shown_is_run(tab)


@pytest.mark.slow
@pytest.mark.parametrize("width", [1280, 1024, 400])
def test_the_page_is_whole_and_fit_for_screen_readers(browser, application, width):
    tab = Tab(browser, application.address, width)
    tab.press("Compare two scenes")
    tab.settle()
    assert tab.cut_words() == []
    assert tab.inaccessible() == []
    tab.press("Compare two scenes")


@pytest.mark.slow
def test_two_models_stand_side_by_side_above_the_fold_with_their_difference(tab):
    tab.press("Compare two scenes")
    tab.settle()
    box = "const b = document.querySelector(arguments[0]).getBoundingClientRect(); return [b.left, b.top, b.right, b.bottom]"
    first, second = (tab.browser.run(box, f'[data-test="answer-{name}"]') for name in "AB")
    assert first[1] == second[1] and first[2] <= second[0] and first[3] < 900
    values = [rw.run(tab.scene(k)).equivalent_stiffness for k in (0, 1)]
    change = re.search(r"K ([+-][\d.e-]+) %", tab.text('[data-test="verdict"]'))
    assert float(change[1]) == pytest.approx(100 * (values[1] / values[0] - 1), rel=5e-3)
    shown = re.search(r"B - A ([+-][\d.e-]+) %", tab.text('[data-test="chart-speed-stiffness"] figcaption'))
    assert float(shown[1]) == pytest.approx(float(change[1]), rel=5e-3)  # the compiled loop's points, and runs
    # What both share is told to be left out; the rest is far smaller than the interval of either stiffness.
    words = tab.text('[data-test="verdict"]').partition("; difference within ")[2]
    ends = [abs(float(end)) / 100 for end in re.findall(r"[\d.]+(?:e-?\d+)?(?= to| %)", words)]
    own = rw.run(tab.scene(0)).to_dict()["uncertainty"]["equivalent_stiffness"]["relative"]
    assert ends and max(ends) < 0.01 * own[1] and "of common ones (geometry, hypotheses) not estimated" in words, words
    tab.press("Compare two scenes")


@pytest.mark.slow
def test_the_curves_that_a_reader_has_chosen_are_shown_again(tab, browser):
    last = tab.browser.run("return [...document.querySelectorAll('.chart')].map((e) => e.dataset.test)")
    tab.browser.run("document.querySelector('[data-curve=\"speed.pressure p0\"]').click()")
    browser.driver.refresh()
    tab.wait()
    shown = tab.browser.run("return [...document.querySelectorAll('.chart')].map((e) => e.dataset.test)")
    assert set(shown) == {*last, "chart-speed-pressure p0"}
    tab.browser.run("document.querySelector('[data-curve=\"speed.pressure p0\"]').click()")


@pytest.mark.slow
def test_a_bearing_is_chosen_by_its_designation(tab):
    script = "const f = document.getElementById('designation'); f.value = arguments[0]; f.dispatchEvent(new Event('change'))"
    assert "7014C" in tab.browser.run("return [...document.getElementById('designations').options].map((o) => o.value)")
    for name in ("7014 CD/P4A", "B7206C"):
        last = tab.number
        tab.browser.run(script, name)
        tab.wait(last)
        assert tab.scene(0)["bearing"]["preset"] == name
        shown_is_run(tab)


@pytest.mark.slow
def test_speeds_without_a_steady_orbit_are_named_and_can_be_run(tab):
    tab.press("Compare two scenes")
    tab.settle()
    note = tab.text(".charts")
    first, last = re.search(r"B: speed \d+ to \d+ r/min: no steady orbit.*?(Run (\d+) r/min to see why)", note), tab.number
    assert first, note
    script = "[...document.querySelectorAll('.charts button')].find((b) => b.textContent === arguments[0]).click()"
    unchanged = tab.scene(0)
    tab.browser.run(script, first[1])
    tab.wait(last)
    tab.settle()
    assert tab.scene(1)["excitation"]["speed_rpm"] == pytest.approx(float(first[2]), rel=1e-4)
    assert tab.scene(0) == unchanged
    if tab.values(1):  # the run finds a motion that the loop does not
        shown_is_run(tab, (1,))
    else:
        assert re.search("orbit|balls|contact", tab.text('[data-test="mistakes-1"]'))
    tab.press("Undo")
    tab.press("Compare two scenes")
