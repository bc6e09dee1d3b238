"""Every command at 80 columns, on a terminal, with -v: lines, numbers, units, progress, what is told of the computing."""

from __future__ import annotations

import io
import re
from collections import Counter

import pytest
from rich.console import Console

from raceway.commands.progress import ProgressBar
from tests.test_article_command import SMALL
from tests.test_cli import RUNNABLE
from tests.test_mesh_command import COARSE
from validation.command_line import ARTICLE, EXAMPLES, MINIMAL, invoke

COLUMNS = 80
#: Other ways to write what screens write as N/µm, µm and r/min, and rad/s.
OLD_UNITS = re.compile(r"N/um|\bum\b|rad/s|\brpm\b")
STATIC = '[bearing]\npreset = "B7206C"\n[load]\naxial = 1000.0\n'
FIVE = (
    *("--vary", "excitation.kind=unidirectional,bidirectional", "--vary", "excitation.speed_rpm=12000,15000"),
    *("--vary", "load.axial=400,1000", "--vary", "supports.tilt=locked,30000", "--vary", "contact.damping=0,1e-5"),
)
FAST = ("--set", "identifier.kind=tangent")
SPEEDS = ("--grid", "kinematics.spin_speed_rpm=2000:18000:5", "--grid", "load.axial=400,1000")
RIG = ("--set", "rig.speeds_rpm=[13000.0]", "--set", "rig.axial_loads=[2000.0]", "--set", "rig.signals.duration=0.25")
MAP = (
    "--vary",
    "load.axial=400,2000",
    "--vary",
    "excitation.speed_rpm=10980,15000",
    "--vary",
    "bearing.contact_angle_deg=15",
)

#: Words by command; OUT is a folder of the test, STATIC a scene without excitation, STORE and SIGNALS what other commands left.
COMMANDS = {
    "run": ("run", ARTICLE, "--pictures", "--out", "OUT"),
    "run, explained": ("run", MINIMAL, "--set", "supports.tilt=free", "--explain", "--out", "OUT"),
    "run, pair": ("run", EXAMPLES / "duplex_db.toml", "--out", "OUT"),
    "run, static": ("run", "STATIC", "--set", "supports.tilt=free", "--out", "OUT"),
    "plan": ("plan", ARTICLE),
    "plan, elastic": ("plan", EXAMPLES / "b7206_elastic.toml"),
    "check": ("check", ARTICLE),
    "compare": ("compare", ARTICLE, *FAST, *FIVE, "--out", "OUT"),
    "compare, explained": ("compare", ARTICLE, *FAST, *FIVE, "--explain", "--no-pictures", "--out", "OUT"),
    "verify": ("verify", "--only", "harris-table-6.1"),
    "verify, all": ("verify", "--only", "harris-table-6.1", "--all"),
    "precision": ("precision", MINIMAL, "--vary", "integrator.steps_per_turn=45,90", "--repeats", "1", "--out", "OUT"),
    "stability": ("stability", "--only", "chatter", "--processes", "0", "--out", "OUT"),
    "sweep": ("sweep", "STATIC", *SPEEDS, "--out", "STORE"),
    "plot": ("plot", "STORE", "--value", "stiffness:y,y"),
    "export": ("export", "STORE", "--ross", "OUT/bearing.toml", "--at", "load.axial=1000"),
    "study rig": ("study", "rig", EXAMPLES / "test_rig.toml", *RIG, "--no-pictures", "--out", "RIG"),
    "identify": ("identify", "SIGNALS", "--scene", EXAMPLES / "test_rig.toml", "--set", "load.axial=2000", "--out", "OUT"),
    "fit": ("fit", "SIGNALS", "--scene", EXAMPLES / "test_rig.toml", "--set", "load.axial=2000", "--free", "load.axial", "--out", "OUT"),
    "study limits": ("study", "limits", EXAMPLES / "set_tbt.toml"),
    "study map": ("study", "map", *MAP, "--processes", "0", "--no-pictures", "--out", "OUT"),
    "study article": ("study", "article", *SMALL, "--no-pictures", "--out", "OUT"),
    "infer": ("infer", "gmn"),
    "infer, one": ("infer", "--bore", "70 mm", "--outer-diameter", "110 mm", "--rating", "15:47 kN:43 kN"),
    "catalogue": ("catalogue", "7014C"),
    "catalogue, list": ("catalogue", "79*"),
    "catalogue, materials": ("catalogue", "--materials"),
    "law": ("law", "penalty", "--set", "contact.damping=300"),
    "sensitivities": ("sensitivities", MINIMAL, "--by", "load.axial", "--by", "bearing.contact_angle_deg", "--out", "OUT"),
    "band": ("band", MINIMAL, "--tolerance", "load.axial=±10 %", "--count", "4", "--processes", "0", "--out", "OUT"),
    "follow": ("follow", MINIMAL, "--over", "excitation.speed_rpm=9000:9500", "--points", "5", "--out", "OUT"),
    "view": ("view", MINIMAL, "--out", "OUT"),
    "mesh": ("mesh", MINIMAL, *COARSE, "--out", "OUT"),
    "plugins": ("plugins",),
    "check-plugin": ("check-plugin", "hertz"),
    "new-plugin": ("new-plugin", "contact_law", "my_law", "--out", "OUT"),
    "new-scene": ("new-scene", "--out", "OUT/own.toml"),
    "schema": ("schema",),
    "cache": ("cache",),
}  # fmt: skip
#: Commands that are done before anybody waits, whatever they are given.
QUICK = {"plan", "check", "plugins", "new-plugin", "new-scene", "schema", "catalogue"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    found = tmp_path_factory.mktemp("screens")
    (found / "static.toml").write_text(STATIC)
    return found


@pytest.fixture(scope="module")
def seen(folder):
    """Each command once: what it hands to the screen, its text, what it draws meanwhile and what -v tells."""
    return {}


def look(name, seen, folder):
    if name in seen:
        return seen[name]
    for other in {"plot": ["sweep"], "export": ["sweep"], "identify": ["study rig"], "fit": ["study rig"]}.get(name, []):
        look(other, seen, folder)
    signals = next(iter(sorted((folder / "rig").glob("signals-*.csv"))), "none")
    out = folder / re.sub(r"\W+", "-", name)
    out.mkdir(exist_ok=True)
    places = {
        "OUT": out,
        "STATIC": folder / "static.toml",
        "STORE": folder / "store",
        "RIG": folder / "rig",
        "SIGNALS": signals,
    }
    words = [str(places.get(word, word)).replace("OUT/", f"{out}/") for word in COMMANDS[name]]
    shown, drawn = [], Console(file=io.StringIO(), force_terminal=True, width=COLUMNS)
    print_, begin, init = Console.print, ProgressBar.__enter__, ProgressBar.__init__

    def spy(self, *objects, **options):
        if options.get("crop") is False:
            shown.extend(objects)
        print_(self, *objects, **options)

    def on_a_terminal(self, what, console=None, patience=0.0, remaining=False):
        init(self, what, drawn, 0.0, remaining)

    def drawn_at_once(self):
        found = begin(self)
        if self._timer.ident is not None:
            self._timer.join()
        return found

    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("COLUMNS", str(COLUMNS))
        patch.setattr(Console, "print", spy)
        patch.setattr(ProgressBar, "__init__", on_a_terminal)
        patch.setattr(ProgressBar, "__enter__", drawn_at_once)
        found = invoke(*words, "-v")
    assert found.exit_code == 0, found.output
    seen[name] = shown, found, drawn.file.getvalue()
    return seen[name]


def at(width, renderables):
    """Lines of a screen of so many columns, without the names of files, which stay whole to be copied."""
    console = Console(file=io.StringIO(), width=width, highlight=False)
    for one in renderables:
        console.print(one, crop=False)
    lines = [line.rstrip() for line in console.file.getvalue().splitlines()]
    return [line for line in lines if not line.startswith(("written: ", "next: "))]


def numbers(lines):
    """Words with a digit in them, and how often."""
    return Counter(word for line in lines for word in line.split() if any(sign.isdigit() for sign in word))


def test_every_command_is_looked_at():
    assert {name.partition(",")[0] for name in COMMANDS} == set(RUNNABLE)


def marked(names):
    """Parameters; ``view`` draws with pyvista, the article's study takes a quarter of a minute."""
    marks = {"view": pytest.mark.needs("pyvista"), "study article": pytest.mark.slow}
    return [pytest.param(one, marks=marks.get(one, ())) for one in names]


@pytest.mark.parametrize("name", marked(COMMANDS))
def test_a_screen_fits_80_columns_and_breaks_no_number(name, seen, folder):
    shown, found, _ = look(name, seen, folder)
    narrow, wide = at(COLUMNS, shown), at(1000, shown)
    assert shown or name in ("check", "schema")
    long = [line for line in narrow if len(line) > COLUMNS and str(folder) not in line]
    assert not long
    assert not numbers(wide) - numbers(narrow)
    # A number stays beside its unit.
    assert not [line for line in narrow if re.match(r"\s*(N/µm|N s/m|µm|r/min|MPa|deg)\b(?! {2})", line)]
    if name not in ("schema", "plugins"):  # keys and options in their own spelling
        # ROSS's own files are in rad/s, which a note tells.
        told = [line for line in at(1000, shown) if not (name == "export" and line.startswith("note: "))]
        assert not OLD_UNITS.findall("\n".join(told).replace("_rpm", ""))
    if shown:
        assert all(line in found.stdout.replace("\u00a0", " ") for line in narrow if line.strip())


@pytest.mark.parametrize("name", marked(name for name in COMMANDS if name.partition(",")[0] not in QUICK))
def test_a_command_that_may_last_shows_progress_and_tells_what_it_does(name, seen, folder):
    _, found, drawn = look(name, seen, folder)
    assert "━" in drawn or "╸" in drawn, drawn  # a bar
    told = [line for line in found.stderr.splitlines() if re.match(r" +\d+\.\d\d s  \S", line)]
    assert told, found.stderr
    assert max(map(len, found.stderr.splitlines())) <= COLUMNS
