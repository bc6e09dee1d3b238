"""Debian's chromium without a window: what a page shows, says on its console and asks the network for."""

import json
import shutil
from pathlib import Path
from typing import Any

import attrs

#: How wide the windows are in which a page must be readable [px].
WIDTHS = (1280, 400)
#: From this width on no table scrolls in its box, and no column of sentences is squeezed [px].
SCREEN = 1000
#: The least width of a figure on a screen, unless its file has less [px].
FIGURE = 480
_REMEDY = (
    "pages are tested in a real browser: apt-get install chromium chromium-driver (`make apt-line` prints the whole line)"
)
_LOOK = """
const box = (e) => e.getBoundingClientRect();
return {
  scroll: document.documentElement.scrollWidth,
  width: document.documentElement.clientWidth,
  wide: [...document.querySelectorAll("body *")].filter((e) => !e.closest(".scroll") && !e.closest("svg")
    && getComputedStyle(e).visibility !== "hidden" && box(e).right > document.documentElement.clientWidth + 1)
    .map((e) => e.tagName + " " + (e.id || e.className || e.textContent.slice(0, 40))),
  images: [...document.images].map((e) => [e.alt, e.complete ? e.naturalWidth : 0, box(e).width, box(e).height]),
  tables: [...document.querySelectorAll(".scroll")].map((e) => [e.getAttribute("aria-label"), e.scrollWidth, e.clientWidth]),
  squeezed: [...document.querySelectorAll("tbody td, tbody th")].filter((e) => e.textContent.length > 40 && box(e).width < 200)
    .map((e) => [e.textContent.slice(0, 40), box(e).width]),
  drawings: [...document.querySelectorAll("svg, canvas")].map((e) => [box(e).width, box(e).height]),
  small: [...document.querySelectorAll("body *")].filter((e) => e.children.length === 0 && e.textContent.trim()
    && box(e).width > 0 && parseFloat(getComputedStyle(e).fontSize) < 11).length,
};
"""


@attrs.frozen
class Look:
    """A page at one width: ``found`` as ``_LOOK`` says, lines of its console, addresses that it asked for."""

    found: dict[str, Any]
    console: list[str]
    asked: list[str]

    def faults(self) -> list[str]:
        """What a reader would miss."""
        found, out = self.found, [f"console: {line}" for line in self.console]
        out += [f"asked for {address}" for address in self.asked]
        if found["scroll"] > found["width"]:
            out.append(f"{found['scroll']} px wide in a window of {found['width']}: {found['wide'][:3]}")
        out += [f"figure '{name}' is not there" for name, own, *shown in found["images"] if not own or not min(shown)]
        out += ["a drawing has no size" for shown in found["drawings"] if not min(shown)]
        if found["small"]:
            out.append(f"{found['small']} texts are smaller than 11 px")
        return out + self.cramped()

    def cramped(self) -> list[str]:
        """On a screen: tables that are cut off, sentences of one word a line, figures like stamps."""
        found = self.found
        if found["width"] < SCREEN:
            return []
        out = [
            f"table '{name}' is cut off: {whole} px in a box of {seen}"
            for name, whole, seen in found["tables"]
            if whole > seen
        ]
        out += [f"'{text}' has a column of {width:.0f} px" for text, width in found["squeezed"]]
        return out + [
            f"figure '{name}' is {width:.0f} px wide, less than {FIGURE}"
            for name, natural, width, _ in found["images"]
            if width < min(natural, FIGURE)
        ]


class Browser:
    """One browser for all pages."""

    def __init__(self) -> None:
        from selenium import webdriver
        from selenium.webdriver.chrome.service import Service

        binary, driver = shutil.which("chromium"), shutil.which("chromedriver")
        if binary is None or driver is None:
            raise RuntimeError(f"{'chromium' if binary is None else 'chromedriver'} is not installed; {_REMEDY}")
        options = webdriver.ChromeOptions()
        options.binary_location = binary
        # No sandbox: as root there is none.  SwiftShader: WebGL without a graphics card.
        for word in ("headless=new", "no-sandbox", "disable-dev-shm-usage", "disable-gpu", "enable-unsafe-swiftshader"):
            options.add_argument(f"--{word}")
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        self.driver: Any = webdriver.Chrome(options=options, service=Service(driver))

    def look(self, path: Path, width: int) -> Look:
        """Open a page from its file in a window of a width."""
        size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        for log in ("browser", "performance"):
            self.driver.get_log(log)  # of the page before
        self.driver.get(path.resolve().as_uri())
        self.run("return Promise.all([...document.images].map((e) => e.decode().catch(() => null)))")
        lines = [entry["message"] for entry in self.driver.get_log("browser")]
        console = [line for line in lines if "GL Driver Message (OpenGL, Performance" not in line]  # of the machine
        events = [json.loads(entry["message"])["message"] for entry in self.driver.get_log("performance")]
        asked = [e["params"]["request"]["url"] for e in events if e["method"] == "Network.requestWillBeSent"]
        foreign = [address for address in asked if not address.startswith("data:") and address != path.resolve().as_uri()]
        return Look(self.run(_LOOK), console, foreign)

    def run(self, script: str, *given: Any) -> Any:
        """What a script returns."""
        return self.driver.execute_script(script, *given)

    def close(self) -> None:
        self.driver.quit()
