"""The application in a process of its own, and a tab of a browser that uses it as a person does."""

import ast
import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any, Self

from checks.validation.browser.chromium import Browser
from checks.validation.command_line import PATIENCE_S
from raceway.extend import screen

_READY = """
const app = document.querySelector(".app"), last = arguments[0];
return Boolean(app) && app.dataset.done === app.dataset.number && app.dataset.number !== last;
"""
_CHANGE = """
const [selector, value, events] = arguments, field = document.querySelector(selector);
const details = field.closest("details");
if (details) details.open = true;
field.value = value;
for (const name of events) field.dispatchEvent(new Event(name));
"""
_LATENCY = """
const [selector, value, mark, done] = arguments, field = document.querySelector(selector), app = document.querySelector(".app");
const before = app.dataset.number, begun = performance.now();
field.value = value;
field.dispatchEvent(new Event("input"));
field.dispatchEvent(new Event("change"));
const painted = () => requestAnimationFrame(() => {  // a message is read after the frame was painted
  const channel = new MessageChannel();
  channel.port1.onmessage = () => done(performance.now() - begun);
  channel.port2.postMessage(0);
});
const seen = new MutationObserver(() => {
  if (app.dataset.number !== before && app.dataset[mark] === app.dataset.number) { seen.disconnect(); painted(); }
});
seen.observe(app, { attributes: true });
"""

#: What a reader would miss: parts beyond the right edge, and words that lie on others.
_WHOLE = """
const box = (e) => e.getBoundingClientRect(), faults = [], shown = (e) => e.textContent.trim() && box(e).width > 0 && getComputedStyle(e).visibility !== "hidden";
const edge = document.documentElement.clientWidth + 1;
for (const e of document.querySelectorAll("body *")) {
  if (!e.closest(".scroll") && shown(e) && box(e).right > edge) faults.push("cut: " + e.textContent.trim().slice(0, 40));
}
for (const part of document.querySelectorAll(".scene")) {  // it scrolls down, not aside
  if (part.scrollWidth > part.clientWidth) faults.push("cut: " + [...part.querySelectorAll("*")].find((e) => box(e).right > box(part).right)?.textContent.trim().slice(0, 40));
}
for (const picture of document.querySelectorAll(".chart svg, .stage, .pair svg")) {
  const frame = box(picture), words = [...picture.querySelectorAll("text, .label")].filter(shown);
  words.forEach((a, k) => {
    const one = box(a);
    if (one.left < frame.left - 1 || one.right > frame.right + 1) faults.push("cut: " + a.textContent);
    for (const b of words.slice(k + 1)) {
      const other = box(b), slack = 2;
      if (one.left < other.right - slack && other.left < one.right - slack && one.top < other.bottom - 2 * slack && other.top < one.bottom - 2 * slack)
        faults.push(a.textContent + " lies on " + b.textContent);
    }
  });
}
return faults;
"""


def proportional_memory(pid: int) -> int:
    """Of a process, shared pages in proportion [byte]."""
    lines = Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
    return sum(1024 * int(line.split()[1]) for line in lines if line.startswith("Pss:"))


def descendants(pid: int) -> list[int]:
    """Processes that a process, and these, have started."""
    children = [int(w) for task in Path(f"/proc/{pid}/task").iterdir() for w in (task / "children").read_text().split()]
    return children + [below for child in children for below in descendants(child)]


class Application:
    """``raceway app`` as a process; ``address`` of its page."""

    def __init__(self, folder: Path, scene: str = "", *options: str) -> None:
        words = [sys.executable, "-m", "raceway", "app", *([scene] if scene else [])]
        words += ["--no-browser", "--json", "--out", str(folder)]
        self.begun = time.monotonic()
        self.process = subprocess.Popen(
            [*words, *options], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=os.environ
        )
        assert self.process.stdout is not None
        text = ""
        while not text.rstrip().endswith("}"):
            line = self.process.stdout.readline()
            if not line:
                assert self.process.stderr is not None
                raise RuntimeError(f"the application ended: {text}{self.process.stderr.read()}")
            text += line
        self.address: str = json.loads(text)["address"]
        self.port = int(self.address.rpartition("/index")[0].rpartition(":")[2])

    @property
    def token(self) -> str:
        """Of the address."""
        return self.address.rpartition("token=")[2]

    def elapsed(self) -> float:
        """Since the command was started [s]."""
        return time.monotonic() - self.begun

    def processes(self) -> list[int]:
        """The server, and what it has started."""
        return [self.process.pid, *descendants(self.process.pid)]

    def memory(self) -> int:
        """Resident memory of all its processes, shared pages in proportion [byte]."""
        return sum(map(proportional_memory, self.processes()))

    def stop(self) -> int:
        """Ctrl-C; the exit code."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        return self.process.wait(20.0)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        assert self.stop() in (0, 130)


class Tab:
    """A tab with the page."""

    def __init__(self, browser: Browser, address: str, width: int = 1280, height: int = 900) -> None:
        self.browser, self.driver = browser, browser.driver
        self.driver.set_script_timeout(PATIENCE_S)
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        self.driver.get("about:blank")
        self.driver.get_log("browser")  # of the page before
        self.driver.get(address)
        self.wait()

    @property
    def number(self) -> str:
        """Of changes."""
        return str(self.browser.run("return document.querySelector('.app').dataset.number"))

    def wait(self, last: str = "") -> None:
        """Until the page shows the present scenes, after the change ``last``."""
        end = time.monotonic() + PATIENCE_S
        while not self.browser.run(_READY, last):
            assert time.monotonic() < end, f"no picture within {PATIENCE_S:g} s"
            time.sleep(0.02)

    def set(self, key: str, value: object) -> None:
        """Type into a field, and wait for what the page shows of it."""
        last = self.number
        self.type(key, value)
        self.wait(last)

    def type(self, key: str, value: object) -> None:
        """Search a field, type into it and leave it."""
        self.browser.run(_CHANGE, ".search input", key, ["input"])
        self.driver.execute_async_script("arguments[0](requestAnimationFrame(() => requestAnimationFrame(arguments[0])))")
        self.browser.run(_CHANGE, f'[data-field="{key}"]', str(value), ["change"])

    def settle(self) -> None:
        """Until the server has taken all that was done, and the page shows it."""
        time.sleep(0.3)
        self.wait()

    def rest(self) -> None:
        """Until curves have all their points, which are computed once no change comes."""
        script = "return [...document.querySelectorAll('.chart g path.line')].every((e) => e.getAttribute('d').split('L').length > 25)"
        end = time.monotonic() + PATIENCE_S
        while not self.browser.run(script):
            assert time.monotonic() < end, "curves of few points"
            time.sleep(0.02)

    def panels(self) -> int:
        """Of scenes that are shown."""
        return int(self.browser.run("return document.querySelectorAll('.bodies > article').length"))

    def drag(self, key: str, value: object, mark: str = "shown") -> float:
        """Move a slider; the time until K and the curves are painted, or ("done") all numbers of the run [ms]."""
        return float(self.driver.execute_async_script(_LATENCY, f'[data-slider="{key}"]', str(value), mark))

    def press_any(self, words: str) -> bool:
        """Press a button unless it is disabled; whether it was pressed."""
        script = "const b = [...document.querySelectorAll('button')].find((b) => b.textContent.trim() === arguments[0]); if (b.disabled) return false; b.click(); return true"
        return bool(self.browser.run(script, words))

    def press(self, words: str, changes: bool = True) -> None:
        """Press the first button with these words."""
        last = self.number
        script = "[...document.querySelectorAll('button')].find((b) => b.textContent.trim() === arguments[0] && !b.disabled).click()"
        self.browser.run(script, words)
        if changes:
            self.wait(last)

    def text(self, selector: str) -> str:
        """Of an element; empty where there is none."""
        return str(self.browser.run("return document.querySelector(arguments[0])?.textContent ?? ''", selector))

    def scene(self, panel: int) -> dict[str, Any]:
        """Tables of the scene shown, as "Copy Python" hands them on."""
        script = "return [...document.querySelectorAll('button')].filter((b) => /Copy Python|Copied/.test(b.textContent))[arguments[0]].dataset.text"
        text = str(self.browser.run(script, panel))
        tables: dict[str, Any] = ast.literal_eval(text.partition("rw.run(")[2].rpartition(")\nprint")[0])
        return tables

    def values(self, panel: int) -> list[tuple[str, str]]:
        """Quantity and value of the rows of numbers."""
        script = "return [...document.querySelectorAll('[data-test=\"value-' + arguments[0] + '\"]')].map((e) => [e.dataset.name, e.textContent])"
        return [(str(name), str(value)) for name, value in self.browser.run(script, panel)]

    def memory(self) -> int:
        """Of the processes that draw the page [byte]."""
        pids = descendants(self.driver.service.process.pid)
        return sum(proportional_memory(p) for p in pids if b"--type=renderer" in Path(f"/proc/{p}/cmdline").read_bytes())

    def cut_words(self) -> list[str]:
        """Parts beyond the right edge, words that lie on others."""
        return [str(fault) for fault in self.browser.run(_WHOLE)]

    def inaccessible(self) -> list[str]:
        """Serious and critical violations that axe finds, all tables of the form open."""
        from axe_core_python.selenium import Axe

        self.browser.run("for (const d of document.querySelectorAll('details')) d.open = true")
        self.settle()
        return [
            f"{found['id']}: {found['nodes'][0]['html'][:120]}"
            for found in Axe().run(self.driver)["violations"]
            if found["impact"] in ("serious", "critical")
        ]

    def faults(self) -> list[str]:
        """Errors on the console."""
        return [entry["message"] for entry in self.driver.get_log("browser") if entry["level"] == "SEVERE"]


def expected(tables: dict[str, Any]) -> list[tuple[str, str]]:
    """Quantity and value that the page must show of a scene."""
    import raceway as rw

    rows = screen(rw.run(tables).to_dict()).rows
    return [(name, value) for name, value, _ in rows if value and name != "wall time"]


#: Keys that a person changes, and texts to type; some are refused.
CHANGES = {
    "load.axial": ["300", "1 kN", "2500", "-400", "0"], "load.radial": ["[100, 0]", "[0, 0]", ""],
    "excitation.speed_rpm": ["3000", "12000", "21000", "250 Hz"], "excitation.kind": ["unidirectional", "bidirectional"],
    "excitation.unbalance": ["1e-4", "6.39e-4", "300 g mm"], "supports.tilt": ["free", "locked", ""],
    "rotor.mass": ["1.5", "4", "-1", "heavy"], "bearing.preset": ["B7206C", "7206A-NSK", "6206", "B7206X"],
    "bearing.contact_angle_deg": ["18", "", "95"], "kinematics.gyroscopic": ["outer_race", "shared", ""],
    "kinematics.ring_growth": ["true", ""], "contact.damping": ["0.001", "50", ""],
    "contact.kind": ["penalty", "hertz"],
}  # fmt: skip


def hurry(page: Tab, sequences: int, seed: int) -> list[str]:
    """Some changes one after another without a look at the page, then a look: what is not as the run of the scene shown."""
    chance, faults = random.Random(seed), []
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
            names = page.browser.run(
                "return [...new Set([...document.querySelectorAll('.reading')].map((e) => e.textContent[0]))]"
            )
            if not set(names) <= set("AB"[: page.panels()]):
                faults.append(f"curves of {names} with {page.panels()} scenes")
            if bool(refused) == bool(shown):
                faults.append(f"panel {panel} shows {len(shown)} numbers and '{refused}'")
            elif shown and (different := set(shown) ^ set(expected(page.scene(panel)))):
                faults.append(f"panel {panel}: {sorted(different)[:4]}")
    while page.press_any("Undo"):
        page.settle()
    return faults
