"""Pages that the program writes, those of the article beside its tests, opened from its file in headless chromium, as wide as a screen and as a telephone."""

import json
import shutil
from pathlib import Path

import pytest

import raceway as rw
from checks.validation.browser.chromium import WIDTHS, Browser
from checks.validation.browser.pages import PAGES
from checks.validation.command_line import MINIMAL
from raceway.extend import Page, new_figure

#: The page of `view` has pictures; those of studies take longest to write.
MARKS = {"view": [pytest.mark.slow, pytest.mark.needs("pyvista")], "study rig": [pytest.mark.slow]}


@pytest.fixture(scope="module")
def browser():
    one = Browser()
    yield one
    one.close()


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """``page(name)``: the file, written once."""
    written: dict[str, Path] = {}

    def write(name: str) -> Path:
        if name not in written:
            written[name] = PAGES[name](tmp_path_factory.mktemp(name.replace(" ", "-")))
        return written[name]

    return write


@pytest.mark.needs("browser")
@pytest.mark.parametrize("name", [pytest.param(name, marks=MARKS.get(name, ())) for name in PAGES])
def test_a_page_is_whole_at_both_widths_and_asks_for_nothing(browser, page, name):
    path = page(name)
    assert path.stat().st_size < 5e6  # the limit of the pages
    for width in WIDTHS:
        look = browser.look(path, width)
        assert look.faults() == [], f"{width} px"
        assert look.found["images"] or look.found["drawings"]


@pytest.mark.needs("browser")
def test_tables_of_a_notebook_are_whole_at_both_widths(browser, tmp_path):
    plan, check = rw.plan(MINIMAL), rw.check({"bearing": {"preset": "B7206X"}})
    shown = [rw.run(MINIMAL), rw.compare(MINIMAL, {"load.axial": [400, 1000]}), rw.Scene.from_toml(MINIMAL), plan, check]
    path = tmp_path / "notebook.html"
    path.write_text(f"<!doctype html><meta charset='utf-8'>{''.join(one._repr_html_() for one in shown)}", encoding="utf-8")
    for width in WIDTHS:
        assert browser.look(path, width).faults() == [], f"{width} px"


@pytest.mark.slow
@pytest.mark.needs("browser", "pyvista")
def test_the_bearing_can_be_seen_turned_and_asked(browser, page):
    browser.look(page("view"), 1280)
    # Pixels that differ from the background, in the drawing's middle.
    seen = """
    const from = document.getElementById("scene"), flat = document.createElement("canvas");
    flat.width = flat.height = 200;
    const context = flat.getContext("2d");
    context.drawImage(from, 0, 0, 200, 200);
    const pixels = context.getImageData(0, 0, 200, 200).data, tones = new Set();
    let other = 0;
    for (let k = 0; k < pixels.length; k += 4) {
      if (pixels[k] + pixels[k + 1] + pixels[k + 2] < 700) other++;
      tones.add((pixels[k] >> 4) * 256 + (pixels[k + 1] >> 4) * 16 + (pixels[k + 2] >> 4));
    }
    return [other, tones.size, from.toDataURL().length];
    """
    other, tones, size = browser.run(seen)
    assert 4000 < other < 36000 and tones > 40  # of 40 000: neither an empty picture nor one that is full
    numbers = """
    const canvas = document.getElementById("scene"), box = canvas.getBoundingClientRect(), labels = [...document.querySelectorAll(".label")];
    const event = (kind, x, y) => canvas.dispatchEvent(new PointerEvent(kind, {clientX: x, clientY: y, pointerId: 1, bubbles: true}));
    const words = new Set();
    for (let x = box.left; x < box.right; x += 8) for (let y = box.top; y < box.bottom; y += 8) {
      event("pointermove", x, y);
      words.add(document.getElementById("told").textContent);
    }
    return [labels.map((e) => e.textContent), [...words]];
    """
    labels, words = browser.run(numbers)
    assert len(labels) == 12 and all(" N" in text for text in labels)
    balls = [text for text in words if text.startswith("Ball ")]
    assert len(balls) == 12 and all("MPa" in text and "mm" in text for text in balls)
    drag = "document.getElementById('outer').click(); return new Promise((r) => requestAnimationFrame(() => requestAnimationFrame(r)))"
    browser.run(drag)
    assert browser.run(seen)[0] < other  # without the outer ring less is covered


@pytest.mark.slow
@pytest.mark.needs("browser", "pyvista")
def test_without_webgl_the_page_says_where_to_look(browser, page, tmp_path):
    text = page("view").read_text(encoding="utf-8")
    path = tmp_path / "view.html"
    path.write_text(
        text.replace("<style>", "<script>HTMLCanvasElement.prototype.getContext = () => null;</script><style>", 1)
    )
    look = browser.look(path, 400)
    assert look.faults() == []
    assert "pictures below" in browser.run("return document.getElementById('told').textContent")


@pytest.mark.needs("browser")
def test_faults_are_found(browser, tmp_path):
    path = tmp_path / "bad.html"
    body = '<img alt="gone" src="gone.png"><div style="width: 900px">wide</div><svg width="0" height="5"></svg>'
    path.write_text(
        f"<!doctype html><body>{body}<script>console.error('oops'); fetch('http://127.0.0.1:9/x');</script></body>"
    )
    faults = " ".join(browser.look(path, 400).faults())
    for word in (
        "oops",
        "asked for http://127.0.0.1:9/x",
        "gone.png",
        "px wide in a window of 400",
        "'gone' is not there",
        "no size",
    ):
        assert word in faults


#: Heads that do not wrap, and figures as narrow as three fit beside each other.
CRAMPED = "th.number { white-space: nowrap } .figures { grid-template-columns: repeat(3, 1fr) !important } th.words { min-width: 0 !important }"


@pytest.mark.needs("browser")
def test_tables_that_are_cut_off_and_figures_like_stamps_are_found(browser, tmp_path):
    points = [f"{speed} r/min, {load} N" for speed in (9000, 13000, 16000) for load in (400, 1000, 2000)]
    cause = "run-out: of a surface with scratches, which the sensor takes for motion of the shaft at all orders"
    made = Page("Wide")
    made.table(["cause", *points], [[cause, *(f"{0.123 * k:.3f}" for k in range(len(points)))]], caption="many columns")
    made.figures([(new_figure(7.0, 4.0), f"figure {k}", "") for k in range(3)])
    path = made.write(tmp_path / "wide.html")
    assert browser.look(path, 1280).faults() == browser.look(path, 400).faults() == []
    path.write_text(path.read_text().replace("</style>", f"{CRAMPED}</style>"))
    faults = " ".join(browser.look(path, 1280).faults())
    for words in ("table 'many columns' is cut off", "'run-out: of a surface", "figure 'figure 2' is"):
        assert words in faults
    assert browser.look(path, 400).faults() == [], "tables of a telephone scroll"


def test_a_browser_that_is_missing_is_named(monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda _: None)
    with pytest.raises(RuntimeError, match="apt-get install chromium chromium-driver"):
        Browser()


@pytest.mark.slow
@pytest.mark.needs("pyvista")
def test_the_data_of_the_page_are_json(page):
    text = page("view").read_text(encoding="utf-8")
    data = json.loads(text.split('type="application/json">')[1].split("</script>")[0])
    assert len(data["balls"]) == 12 and set(data["fixed_shapes"]) >= {"ball", "ring 0"}
