"""The built site, as a reader without a network uses it: notebooks and scripts to download, search, copy buttons; ``make docs``."""

from __future__ import annotations

import re
from pathlib import Path

import nbclient
import nbformat
import pytest

from checks.validation.browser.chromium import Browser

SITE = Path(__file__).parent / "_build" / "html"
TUTORIALS, GALLERY = (sorted((SITE / folder).glob("*.html")) for folder in ("tutorials", "gallery"))


def downloads(page: Path, suffix: str) -> list[Path]:
    """The files with a suffix that a page offers."""
    links = re.findall(
        rf'<a class="[^"]*download[^"]*" download="" href="([^"]+\.{suffix})"', page.read_text(encoding="utf-8")
    )
    return [(page.parent / link).resolve() for link in links]


# The build has run all scripts of the gallery; sphinx-gallery makes their notebooks alike.
@pytest.mark.parametrize("page", [*TUTORIALS, *GALLERY[:2]], ids=lambda page: f"{page.parent.name}/{page.stem}")
def test_the_notebook_of_a_page_runs(page, tmp_path):
    (file,) = downloads(page, "ipynb")
    assert file.stem == page.stem
    notebook = nbformat.read(file, as_version=4)
    assert not [cell for cell in notebook.cells if re.search(r"\.md\b|nb-download", cell.source)]
    nbclient.NotebookClient(notebook, timeout=180, resources={"metadata": {"path": tmp_path}}).execute()


def test_the_gallery_shows_each_example_with_code_picture_and_number():
    assert len(GALLERY) == 12
    for page in GALLERY:
        (script,) = downloads(page, "py")
        text = script.read_text(encoding="utf-8")
        assert sum(bool(line) for line in text.split('"""', 2)[2].splitlines()) <= 40, script.name
        shown = page.read_text(encoding="utf-8")
        assert "sphx-glr-single-img" in shown and re.search(r"sphx-glr-script-out.*?<pre>.*?\d", shown, re.DOTALL), page.name


@pytest.fixture(scope="module")
def browser():
    chromium = Browser()
    yield chromium
    chromium.close()


@pytest.mark.needs("browser")
def test_the_search_answers_from_files(browser):
    browser.driver.get(f"{(SITE / 'search.html').as_uri()}?q=preload")
    from selenium.webdriver.support.ui import WebDriverWait

    titles = WebDriverWait(browser.driver, 20).until(
        lambda driver: driver.execute_script(
            "return document.querySelector('#search-results .search-summary')?.textContent.includes('found') &&"
            " [...document.querySelectorAll('#search-results li a')].map((e) => e.href)"
        )
    )
    assert not browser.driver.get_log("browser")
    assert any("sets.html" in title for title in titles) and all(title.startswith("file:") for title in titles)


@pytest.mark.needs("browser")
@pytest.mark.parametrize(
    "page", ["index.html", "installation.html", "gallery.html", "tutorials/rotor.html", "gallery/spindle_pair.html"]
)
def test_a_page_fits_both_widths_and_asks_for_files_alone(browser, page):
    for width in (1280, 600):
        look = browser.look(SITE / page, width)
        assert look.found["scroll"] <= look.found["width"], width
        assert not look.console and not [address for address in look.asked if not address.startswith("file:")]
        buttons = browser.run("return document.querySelectorAll('.highlight button.copybtn').length")
        assert buttons or page == "gallery.html"
        source = browser.run("return document.querySelector('.view-this-page a').href")
        assert Path(source.removeprefix("file://")).is_file()
