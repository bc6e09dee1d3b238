"""Every page that the program writes, made as cheaply as it comes: name -> a function that writes it into a folder."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from checks.validation.command_line import ARTICLE, EXAMPLES, invoke
from raceway.testing import Registry


def _command(file: str, *words: Any) -> Callable[[Path], Path]:
    def write(folder: Path) -> Path:
        found = invoke(*words, "--out", folder)
        assert found.exit_code == 0, found.output
        return folder / file

    return write


def _article(folder: Path) -> Path:
    """The page of the article's study around invented curves, which costs no run; its figures are all there."""
    from raceway_article.figures import drawings
    from raceway_article.page import page

    from checks.validation.article_study import curves, study

    found = study(curves(lambda setting, load, w: 1e8 * (1.0 + 0.3 * w**2) * (load / 1000.0) ** 0.3, ("rigid", "condensed")))
    drawn, load = drawings(found.curves, found.scan), found.curves.design.scene_load
    return page(found.to_dict(), load, found.scan, drawn, found.command).write(folder / "article.html")


def _article_elastic(folder: Path) -> Path:
    """The page of elastic bodies around invented rows."""
    from raceway_article.elastic_page import drawings, page

    from checks.validation.article_study import elastic_study

    content = elastic_study().to_dict()
    command = "raceway study article --bodies elastic"
    return page(content, drawings(content), None, command).write(folder / "article-elastic.html")


_POINT = ("rig.speeds_rpm=[13000.0]", "rig.axial_loads=[2000.0]", "rig.signals.duration=0.25")
PAGES: dict[str, Callable[[Path], Path]] = {
    "view": _command("view.html", "view", ARTICLE, "--html"),
    "study article": _article,
    "article of elastic bodies": _article_elastic,
    "study rig": _command(
        "rig.html", "study", "rig", EXAMPLES / "test_rig.toml", *(w for p in _POINT for w in ("--set", p))
    ),
}
assert {name for name in PAGES if name.startswith("study")} == {
    f"study {name}" for name in Registry(third_party=False).names("study")
}, "a study has no page here"
