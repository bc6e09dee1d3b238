"""Pages of the study in headless chromium, around invented curves and rows, which cost no run; all figures are there."""

from pathlib import Path

import pytest
from article_study import curves, elastic_study, study
from raceway_article import elastic_page
from raceway_article.figures import drawings
from raceway_article.page import page

from checks.validation.browser.chromium import WIDTHS, Browser


def of_rigid_and_condensed_bodies(folder: Path) -> Path:
    found = study(curves(lambda setting, load, w: 1e8 * (1.0 + 0.3 * w**2) * (load / 1000.0) ** 0.3, ("rigid", "condensed")))
    drawn, load = drawings(found.curves, found.scan), found.curves.design.scene_load
    return page(found.to_dict(), load, found.scan, drawn, found.command).write(folder / "article.html")


def of_elastic_bodies(folder: Path) -> Path:
    content = elastic_study().to_dict()
    command = "raceway study article --bodies elastic"
    drawn = elastic_page.drawings(content)
    return elastic_page.page(content, drawn, None, command).write(folder / "article-elastic.html")


@pytest.mark.slow
@pytest.mark.needs("browser")
@pytest.mark.parametrize("write", [of_rigid_and_condensed_bodies, of_elastic_bodies])
def test_a_page_is_whole_at_both_widths_and_asks_for_nothing(write, tmp_path):
    path, browser = write(tmp_path), Browser()
    assert path.stat().st_size < 5e6  # the limit of the pages
    for width in WIDTHS:
        look = browser.look(path, width)
        assert look.faults() == [], f"{width} px"
        assert look.found["images"] or look.found["drawings"]
    browser.close()
