"""Pages of the program in a real browser: what `raceway view` and the studies write, at two widths, from a file."""

from __future__ import annotations

import resource
import tempfile
from pathlib import Path

from click.testing import CliRunner

from checks.robustness import Row, below
from checks.validation.browser.chromium import WIDTHS, Browser
from checks.validation.browser.pages import PAGES as CHEAP
from raceway.cli.main import main

PICTURES = Path(__file__).resolve().parents[2] / "docs" / "pictures" / "view"
#: Words of the command, its page.
PAGES = {"view": (("view", "examples/b7206.toml", "--html"), "view.html"), "map": (("study", "map"), "map.html")}
#: Pages as the tests make them: the article's around invented curves, the rig's of one speed and load; what is looked at.
SMALL = {"study article": "article, invented curves", "study rig": "rig, one point"}
#: Pictures of ``raceway view`` that its document shows.
SHOWN = ("bearing-peak.png", "contacts.png")


def rows() -> list[Row]:
    out: list[Row] = []
    browser = Browser()
    try:
        for name, (words, file) in PAGES.items():
            with tempfile.TemporaryDirectory() as place:
                out += _page(name, words, Path(place) / name, file, browser)
        for command, name in SMALL.items():
            with tempfile.TemporaryDirectory() as place:
                out += _look(name, f"raceway {command}", CHEAP[command](Path(place)), browser)
    finally:
        browser.close()
    return out


def _page(name: str, words: tuple[str, ...], folder: Path, file: str, browser: Browser) -> list[Row]:
    command = f"raceway {' '.join(words)}"
    before = _cpu()
    done = CliRunner().invoke(main, [*words, "--out", str(folder)])
    seconds = _cpu() - before
    out = [Row(f"{name}: exit code", float(done.exit_code), "0", done.exit_code == 0, command)]
    out.append(Row(f"{name}: processor time of the command, s", round(seconds, 1), "reported", True, command))
    out += _look(name, command, folder / file, browser)
    if name == "view":
        PICTURES.mkdir(parents=True, exist_ok=True)
        for shown in SHOWN:
            (PICTURES / shown).write_bytes((folder / shown).read_bytes())
    return out


def _look(name: str, command: str, path: Path, browser: Browser) -> list[Row]:
    """What the browser makes of a page at every width."""
    out = [below(f"{name}: size of {path.name}, MB", path.stat().st_size / 1e6, 5.0, command)]
    for width in WIDTHS:
        look = browser.look(path, width)
        faults = look.faults()
        figures = len(look.found["images"]) + len(look.found["drawings"])
        out += [
            below(f"{name} at {width} px: requests to anything but the file", len(look.asked), 0, command),
            below(f"{name} at {width} px: lines on the console", len(look.console), 0, command),
            Row(f"{name} at {width} px: figures with a size", f"{figures - _missing(faults)} of {figures}", "all", not faults, command, "; ".join(faults)),
            below(f"{name} at {width} px: tables cut off, columns squeezed, figures like stamps, of {len(look.found['tables']) + figures}", len(look.cramped()), 0, command),
            below(f"{name} at {width} px: width of the content over the window's", look.found["scroll"] / look.found["width"], 1.0, command),
        ]  # fmt: skip
    return out


def _missing(faults: list[str]) -> int:
    return sum("is not there" in text or "has no size" in text for text in faults)


def _cpu() -> float:
    """Processor time of this process and of those that have ended [s]."""
    return sum(u.ru_utime + u.ru_stime for u in map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)))
