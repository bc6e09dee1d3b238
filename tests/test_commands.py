"""Every command, by a table of quick scenes: help, screen, JSON, files, interruption, full disk, wrong options, plug-ins."""

import errno
import io
import json
import os
import re
import time
from collections import Counter
from importlib.util import find_spec
from pathlib import Path

import click
import matplotlib
import pytest
from rich.console import Console

import raceway as rw
from checks.recorded import differences
from checks.validation.command_line import ARTICLE, COARSE, EXAMPLES, LAW, MINIMAL, SMALL_ARTICLE, invoke, raceway
from raceway.answers.progress import ProgressBar
from raceway.cli.main import main
from raceway.testing import SUITES

HERE = click.Context(main)
LISTED = {name: main.get_command(HERE, name) for name in main.list_commands(HERE)}
#: What a person can run: the sub-commands of a group, not the group.
RUNNABLE = {
    f"{name} {sub}".strip(): command
    for name, one in LISTED.items()
    for sub, command in (
        [(sub, one.get_command(HERE, sub)) for sub in one.list_commands(HERE)]
        if isinstance(one, click.Group)
        else [("", one)]
    )
}

COLUMNS = 80
#: Other ways to write what screens write as N/µm, µm and r/min, and rad/s.
OLD_UNITS = re.compile(r"N/um|\bum\b|rad/s|\brpm\b")
STATIC = '[bearing]\npreset = "B7206C"\n[load]\naxial = 1000.0\n'
FIVE = (
    *("--vary", "excitation.kind=bidirectional", "--vary", "excitation.speed_rpm=12000,15000"),
    *("--vary", "load.axial=400,1000", "--vary", "supports.tilt=locked,30000", "--vary", "contact.damping=1e-5"),
)
FAST = ("--set", "identifier.kind=tangent")
SPEEDS = ("--grid", "kinematics.spin_speed_rpm=2000:18000:5", "--grid", "load.axial=400,1000")
RIG = ("--set", "rig.speeds_rpm=[13000.0]", "--set", "rig.axial_loads=[2000.0]", "--set", "rig.signals.duration=0.25")

#: Words by command; OUT is its folder, STATIC a scene without excitation, DATA a table to fit, STORE and SIGNALS what other
#: commands left.
COMMANDS = {
    "run": ("run", ARTICLE, "--pictures", "--out", "OUT"),
    "run, free tilts": ("run", MINIMAL, "--set", "supports.tilt=free", "--out", "OUT"),
    "run, pair": ("run", EXAMPLES / "duplex_db.toml", "--out", "OUT"),
    "run, static": ("run", "STATIC", "--set", "supports.tilt=free", "--out", "OUT"),
    "plan": ("plan", ARTICLE),
    "plan, elastic": ("plan", EXAMPLES / "b7206_elastic.toml"),
    "compare": ("compare", ARTICLE, *FAST, *FIVE, "--out", "OUT"),
    "verify": ("verify", "--only", "harris-table-6.1"),
    "verify, all": ("verify", "--only", "harris-table-6.1", "--all"),
    "precision": (
        *("precision", MINIMAL, "--vary", "integrator.steps_per_turn=45,90", "--reference", "integrator.steps_per_turn=720"),
        *("--repeats", "1", "--out", "OUT"),
    ),
    "stability": ("stability", "--only", "rubber on ceramic, elements", "--processes", "0", "--out", "OUT"),
    "sweep": ("sweep", "STATIC", *SPEEDS, "--out", "OUT"),
    "sweep, motion": ("sweep", ARTICLE, "--grid", "excitation.speed_rpm=11000:14000:3", "--csv", "--out", "OUT"),
    "sweep, picture": ("sweep", "STORE", "--plot", "stiffness:y,y"),
    "export": ("export", "STORE", "--ross", "OUT/bearing.toml", "--at", "load.axial=1000"),
    "export, files": (
        "export", "STORE", "--nastran", "OUT/own.bdf", "--ansys", "OUT/own.inp", "--table", "OUT/own.csv", "--at", "load.axial=400",
    ),
    "export --fmu": ("export", "--fmu", "STATIC", "--range", "load.axial=400:2000", "--output", "kyy", "--out", "OUT"),
    "export --fmu, force": ("export", "--fmu", "STATIC", "--kind", "force", "--out", "OUT"),
    "study rig": ("study", "rig", EXAMPLES / "test_rig.toml", *RIG, "--no-pictures", "--out", "OUT"),
    "fit, identify": ("identify", "SIGNALS", "--scene", EXAMPLES / "test_rig.toml", "--set", "load.axial=2000", "--out", "OUT"),
    "fit": ("fit", "DATA", "--scene", "STATIC", "--free", "bearing.contact_angle_deg", "--out", "OUT"),
    "fit, signals": (
        *("fit", "SIGNALS", "--scene", EXAMPLES / "test_rig.toml", "--set", "load.axial=2000"),
        *("--free", "load.axial", "--out", "OUT"),
    ),
    "study article": ("study", "article", *SMALL_ARTICLE, "--out", "OUT"),
    "catalogue --infer, table": ("catalogue", "--infer", "nmb_deep_groove"),
    "catalogue --infer": ("catalogue", "--infer", "--bore", "70 mm", "--outer-diameter", "110 mm", "--rating", "15:47 kN:43 kN"),
    "catalogue": ("catalogue", "7014C"),
    "catalogue, list": ("catalogue", "79*"),
    "catalogue, materials": ("catalogue", "--materials"),
    "dev law": ("dev", "law", "penalty", "--set", "contact.damping=300"),
    "band": ("band", MINIMAL, "--tolerance", "load.axial=±10 %", "--samples", "2", "--processes", "0", "--no-pictures", "--out", "OUT"),
    "band, derivatives": ("sensitivities", MINIMAL, "--by", "load.axial", "--by", "bearing.contact_angle_deg", "--out", "OUT"),
    "follow": ("follow", MINIMAL, "--over", "excitation.speed_rpm=9000:9500", "--points", "5", "--out", "OUT"),
    "view": ("view", "STATIC", "--out", "OUT"),
    "view --mesh": ("view", "--mesh", MINIMAL, *COARSE, "--out", "OUT"),
    "dev plugins": ("dev", "plugins",),
    "dev check-plugin": ("dev", "check-plugin", "tangent"),
    "dev new-plugin": ("dev", "new-plugin", "contact_law", "my_law", "--out", "OUT"),
    "dev new-scene": ("dev", "new-scene", "--out", "OUT/own.toml"),
    "dev schema": ("dev", "schema",),
    "dev cache": ("dev", "cache",),
}  # fmt: skip
#: Commands that are done before anybody waits, whatever they are given.
QUICK = {"plan", "dev plugins", "dev new-plugin", "dev new-scene", "dev schema", "catalogue"}


#: Commands with a scene of their own, those that write more than their answer, and what a quicker one does, too: no run of theirs is repeated in quick tests.
SLOW = {"study article", "fit, signals", "catalogue --infer, table"}
#: Commands about this installation, and those whose answer is run time.
UNRECORDED = {"dev cache", "dev plugins", "dev schema", "precision", *SLOW}
#: Studies that go on where they were stopped.
GOES_ON = ("compare", "stability", "band", "study rig", "study article", "sweep", "precision")


def marked(names):
    """Parameters; ``view`` draws with pyvista."""
    marks = {"view": pytest.mark.needs("pyvista"), **dict.fromkeys(SLOW, pytest.mark.slow)}
    return [pytest.param(one, marks=marks.get(one, ())) for one in names]


def plain(*left_out, slow=()):
    """Commands once each, without their other scenes."""
    named = [name for name in COMMANDS if "," not in name and name not in left_out]
    return [
        pytest.param(name, marks=pytest.mark.slow) if name in slow else one
        for name, one in zip(named, marked(named), strict=True)
    ]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    found = tmp_path_factory.mktemp("commands")
    (found / "static.toml").write_text(STATIC)
    (found / "data.csv").write_text("axial [N],kxx [N/um]\n400,39.4\n1000,67.4\n2000,98.0\n")
    (found / "file").write_text("")
    return found


@pytest.fixture(scope="module")
def seen(folder):
    """Each command once: what it hands to the screen, its text, what it draws meanwhile and what -v tells."""
    return {}


def place(name, folder):
    return folder / name.replace(",", "").replace(" ", "-")


def words(name, seen, folder, out=None):
    """A line of the table with its places; what it reads of other commands is made first."""
    others = {
        "sweep, picture": "sweep", "export": "sweep", "export, files": "sweep", "fit, identify": "study rig",
        "fit, signals": "study rig",
    }  # fmt: skip
    if name in others:
        look(others[name], seen, folder)
    out = out or place(name, folder)
    places = {
        "OUT": out, "STATIC": folder / "static.toml", "DATA": folder / "data.csv", "STORE": folder / "sweep",
        "SIGNALS": next(iter(sorted((folder / "study-rig").glob("signals-*.csv"))), "none"),
    }  # fmt: skip
    return [str(places.get(word, word)).replace("OUT/", f"{out}/") for word in COMMANDS[name]]


def look(name, seen, folder):
    if name in seen:
        return seen[name]
    given = words(name, seen, folder)
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
        before = str(matplotlib.rcParams.copy())
        found = invoke(*given, "-v")
    assert found.exit_code == 0, found.output
    assert str(matplotlib.rcParams.copy()) == before
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


def whole_files(folder):
    """Names of the files of a folder, each of them complete."""
    found = [path for path in sorted(folder.rglob("*")) if path.is_file()] if folder.is_dir() else []
    for path in found:
        content = path.read_bytes()
        if path.suffix == ".png":
            assert content.startswith(b"\x89PNG") and content.endswith(b"IEND\xaeB`\x82"), path
        if path.suffix == ".json":
            assert json.loads(content)
    return [path.name for path in found if path.name != ".lock"]


def files_of(name, folder):
    """Content of the text files that a command writes."""
    out, texts = place(name, folder), {".csv", ".txt", ".toml", ".bdf", ".inp", ".geo"}
    files = [path for path in sorted(out.rglob("*")) if path.suffix in {".json", *texts}] if out.is_dir() else []
    content = {str(path.relative_to(out)): path.read_text(encoding="utf-8").replace(str(folder), "FOLDER") for path in files}
    return {key: json.loads(text) if key.endswith(".json") else text.splitlines() for key, text in content.items()}


def test_every_command_is_looked_at():
    served = {"app"}  # until Ctrl-C: packages/raceway-app/tests/test_app.py
    assert {name.partition(",")[0] for name in COMMANDS} | served == set(RUNNABLE)


@pytest.mark.parametrize("alias", ["check", "identify", "sensitivities"])
def test_help_of_an_alias_shows_it(alias):
    assert f"raceway {alias} " in invoke(alias, "--help").stdout.split("Example:")[1]


def test_help_of_new_plugin_lists_the_kinds():
    words = invoke("dev", "new-plugin", "--help").stdout.split()
    assert {kind for kind in SUITES if {kind, f"{kind},", f"{kind}."} & set(words)} == set(SUITES)


@pytest.mark.parametrize("command", [*RUNNABLE, "study", ""])
def test_help(command, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    found = invoke(*command.split(), "--help")
    assert found.exit_code == 0 and max(map(len, found.stdout.splitlines())) <= 80
    if command in RUNNABLE:
        assert f"raceway {command}" in found.stdout.split("Example:")[1]
        assert all(option in found.stdout for option in ("--json", "--debug", "--verbose"))
        assert command.endswith(str(RUNNABLE[command].name))
    else:
        bare = invoke(*command.split())
        assert bare.exit_code == 2 and bare.stdout == "" and bare.stderr == found.stdout


def test_the_list_of_commands_says_what_each_says_itself():
    text = invoke("--help").stdout
    lines = text.split("Answers:\n")[1].splitlines()
    listed = dict(re.split(r" {2,}", line.strip(), maxsplit=1) for line in lines if re.match(r"  \w", line))
    assert list(listed) == list(LISTED) and "Exit codes" in text
    assert all(one.short_help.startswith(listed[name]) for name, one in LISTED.items())
    assert rw.__version__ in invoke("--version").stdout


@pytest.mark.parametrize("name", marked(COMMANDS))
def test_a_screen_fits_80_columns_and_breaks_no_number(name, seen, folder):
    shown, found, _ = look(name, seen, folder)
    narrow, wide = at(COLUMNS, shown), at(1000, shown)
    assert shown or name == "dev schema"
    long = [line for line in narrow if len(line) > COLUMNS and str(folder) not in line]
    assert not long
    # A path may break, however long the folder's name is here.
    assert not [word for word in numbers(wide) - numbers(narrow) if str(folder) not in word]
    # A number stays beside its unit.
    assert not [line for line in narrow if re.match(r"\s*(N/µm|N s/m|µm|r/min|MPa|deg)\b(?! {2})", line)]
    if name not in ("dev schema", "dev plugins"):  # keys and options in their own spelling
        # ROSS's own files are in rad/s, which a note tells, and the variables of an FMU.
        told = [
            line
            for line in at(1000, shown)
            if not (name.startswith("export") and line.startswith(("note: ", "input", "output")))
        ]
        assert not OLD_UNITS.findall("\n".join(told).replace("_rpm", ""))
    if shown:
        assert all(line in found.stdout.replace("\u00a0", " ") for line in narrow if line.strip())
    assert name != "view" or {"bearing.png", "contacts.png", "ball-loads.png"} <= {*whole_files(place(name, folder))}
    assert whole_files(place(name, folder)) or "--out" not in COMMANDS[name]
    assert name != "dev plugins" or {"newmark", "hertz"} <= set(found.stdout.split())
    assert name in UNRECORDED or not differences(f"command {name}", {"printed": wide, **files_of(name, folder)})


@pytest.mark.parametrize("name", plain(*QUICK))
def test_a_command_that_may_last_shows_progress_and_tells_what_it_does(name, seen, folder):
    _, found, drawn = look(name, seen, folder)
    assert "━" in drawn or "╸" in drawn, drawn  # a bar
    told = [line for line in found.stderr.splitlines() if re.match(r" +\d+\.\d\d s  \S", line)]
    assert told, found.stderr
    assert max(map(len, found.stderr.splitlines())) <= COLUMNS


def full(*_given, **_named):
    """What writing does on a full disk."""
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@pytest.mark.parametrize(
    "name", plain("view --mesh", "view", slow=("study rig", "stability", "dev check-plugin"))
)  # meshes and views are files alone, written by other libraries
def test_json_is_all_there_is_and_a_full_disk_costs_the_file_alone(name, seen, folder, tmp_path, monkeypatch):
    given, out = words(name, seen, folder, tmp_path / "out"), place(name, folder)
    if writes := "--out" in given and name != "dev new-scene":
        if name != "dev new-plugin":
            look(name, seen, folder)  # while there is room
        for method in ("write_bytes", "write_text"):
            monkeypatch.setattr(Path, method, full)
    found = invoke(*given, "--json")
    content = json.loads(found.stdout)
    assert found.stderr == "" or name == "export"
    assert not writes or found.exit_code == 2 and os.strerror(errno.ENOSPC) in content["errors"][0]["message"]
    assert found.exit_code == (2 if writes else 0)
    assert not {*whole_files(tmp_path)} - {"points.sqlite", "own.toml", "bearing.toml"}
    if writes and name != "dev new-plugin":
        kept = [set(json.loads(path.read_bytes())) for path in out.glob("*.json")]
        # "run, static" writes there, too: nothing slides at rest.
        assert set(content) - {"errors", "files", "sliding"} in [each - {"sliding"} for each in kept] or name == "sweep"


OUTPUTS = {"--out": "a.toml", "--ross": "a.toml", "--table": "a.csv", "--picture": "a.png"}


def options(name):
    return {option: one for one in RUNNABLE[name].params if isinstance(one, click.Option) for option in one.opts[:1]}


@pytest.mark.parametrize("name", plain())
def test_a_place_that_cannot_be_written_is_refused_before_anything_is_computed(name, seen, folder, monkeypatch):
    given = words(name, seen, folder)
    monkeypatch.setattr(ProgressBar, "__call__", lambda *_: pytest.fail("computed"))
    for option in options(name).keys() & OUTPUTS.keys():
        file = folder / "file" / "deeper" / OUTPUTS[option]
        found = invoke(*given, option, file)
        assert found.exit_code == 2 and str(folder / "file") in found.stderr, (option, found.output)
        assert found.stdout == "" or option == "--picture"  # the answer is there all the same
        assert found.stderr.count("error: ") == 1


@pytest.mark.parametrize("name", plain(*QUICK, slow=("study rig", "band", "dev check-plugin")))
def test_ctrl_c_ends_a_command_with_130_one_line_and_whole_files(name, seen, folder, tmp_path, monkeypatch):
    def stop(*_given):
        raise KeyboardInterrupt

    def told(text, **_options):
        assert ProgressBar._current is None, "the bar ends before anything is said"
        click.echo(text, err=True)

    monkeypatch.setattr("raceway.cli.frame.warn", told)
    for moment in ("__enter__", "__call__"):  # before anything is computed, and at the first step
        given = words(name, seen, folder, tmp_path / moment)
        with monkeypatch.context() as patch:
            patch.setattr(ProgressBar, moment, stop)
            found = invoke(*given)
        if moment == "__call__" and found.exit_code == 0:  # it shows no steps
            continue
        assert found.exit_code == 130
        *before, last = found.stderr.splitlines()
        assert last == "stopped by Ctrl-C; no file is left half-written"
        left = {*whole_files(tmp_path / moment)}
        assert moment == "__call__" or found.stdout == "" and left <= {"points.sqlite" if name in GOES_ON else None}
        if moment == "__call__" and name in GOES_ON and name != "precision":  # whose reference comes first
            assert "points.sqlite" in left and "continues" in " ".join(before)


#: Free text, and what has a form of its own beside a scene.
TEXTS = {"--tag", "--maker", "--scheduler"}
PATHS = {
    "--plugin": "missing.py", "--scene": "missing.toml", "--list": "missing.csv", "--design": "missing.toml",
    "--slow-roll": "missing.csv",
}  # fmt: skip


@pytest.mark.parametrize("name", plain())
def test_a_value_of_a_wrong_type_is_refused_by_every_option(name, seen, folder, monkeypatch):
    given = words(name, seen, folder)
    look("sweep", seen, folder)  # which a sweep that goes on has nothing to add to
    if name != "fit":  # columns are looked for in what was read
        monkeypatch.setattr(ProgressBar, "__call__", lambda *_: pytest.fail("computed"))
    for option, one in options(name).items():
        if option in OUTPUTS or option in TEXTS or option in ("--nastran", "--ansys"):
            continue
        wrong = [f"{option}=3"] if one.is_flag else [option, PATHS.get(option, "no such")]
        found = invoke(*given, *wrong)
        assert found.exit_code == 2 and found.stdout == "" and found.stderr.count("error: ") == 1, (option, found.output)
        assert json.loads(invoke(*given, *wrong, "--json").stdout)["errors"][0].keys() == {"path", "value", "message"}


@pytest.mark.parametrize(
    ("name", "two"),
    [("band", "--processes 2"), pytest.param("sweep", "--executor processes --workers 2", marks=pytest.mark.slow)],
)
def test_a_plugin_in_a_file_works_in_two_processes(name, two, seen, folder, tmp_path):
    cubic = Path(__file__).with_name("cubic_law.py")
    given = words(name, seen, folder, tmp_path / "out")
    found = invoke(*given, *two.split(), "--plugin", cubic, "--set", "contact.kind=cubic", "--json")
    assert found.exit_code == 0, found.output
    content = json.loads(found.stdout)
    content.pop("files", None)
    assert "failed" not in json.dumps(content.get("rows", []))
    assert content in [json.loads(path.read_bytes()) for path in (tmp_path / "out").glob("*.json")] or name == "sweep"


#: Signs of one mistake: path, value, rule; what is told on a line of its own stays so.
SLIPS = {
    "no scene": (["run"], "Missing argument 'SCENE'", "  try `raceway run --help`, which has an example"),
    "unknown command": (["rnu"], "did you mean 'run'?", ""),
    "option for a command": (["plot", "STORE"], "no command 'plot' (it is `raceway sweep --plot`)", ""),
    "command of a group": (["plugins"], "no command 'plugins' (it is `raceway dev plugins`)", ""),
    "unknown study": (["study", "artcle"], "did you mean 'article'", ""),
    "unknown option": (["run", ARTICLE, "--jsn"], "--json", ""),
    "no axis": (["compare", ARTICLE], "--vary", ""),
    "unknown case": (["verify", "--only", "nobody"], "no such case", ""),
    "unknown bearing": (["dev", "new-scene", "b7206q"], "the nearest: B7206E, B7206C, ", ""),
    "file for a bearing": (["dev", "new-scene", "mine.toml"], "raceway dev new-scene B7206C --out mine.toml", ""),
    "file that is there": (["dev", "new-scene", "--out", MINIMAL], "exists", ""),
    "unknown report": (["run", MINIMAL, "--report", "picturs"], "(did you mean 'pictures'?); installed: pictures", ""),
    "unknown format": (["view", "--mesh", MINIMAL, "--format", "vtk"], "installed: abaqus, msh, pictures, vtu", ""),
    "format that only reads": (["view", "--mesh", MINIMAL, "--format", "msh"], "'msh' only reads; files are written as abaqus, vtu", ""),
    "unknown executor": (["sweep", MINIMAL, "--grid", "load.axial=1,2", "--executor", "moon"], "dask, processes, serial", ""),
    "unknown mesher": (["check", MINIMAL, "--set", "mesh.kind=moon"], "installed: file, gmsh, structured", ""),
    "size of no mesh": (["view", "--mesh", MINIMAL, *COARSE, "--set", "mesh.element_size=1.0"], "element_size", ""),
    "coefficients without a load": (["export", "STORE", "--ross", "b.toml"], "choose one with --at load.axial=400", ""),
    "ending of no table": (["export", "STORE", "--ross", "b.xls", "--at", "load.axial=400"], "ROSS reads .toml and .json", ""),
    "no such load": (["export", "STORE", "--ross", "b.toml", "--at", "load.axial=7"], "is not in the sweep, which has 400, 1000", ""),
    "no store": (["export", "nowhere", "--ross", "b.toml"], "`nowhere` is no store of a sweep", ""),
    "no quantity": (["sweep", "STORE", "--plot", "nothing"], "is not a quantity of this sweep", ""),
    "no value": (["sweep", "STORE", "--at", "load.axial"], "must have the form KEY=VALUE", ""),
    "ending of no picture": (["sweep", "STORE", "--picture", "a.jpg"], "pictures are written as .png, .svg or .pdf", ""),
}  # fmt: skip


@pytest.mark.parametrize("case", SLIPS)
def test_a_slip_on_the_command_line(case, seen, folder, tmp_path, monkeypatch):
    given, rule, remedy = SLIPS[case]
    look("sweep", seen, folder)
    given = [place("sweep", folder) if word == "STORE" else word for word in given]
    monkeypatch.chdir(tmp_path)
    found = invoke(*given)
    assert found.exit_code == 2 and rule in " ".join(found.stderr.split()) and remedy in [*found.stderr.splitlines(), ""]
    (one,) = json.loads(invoke(*given, "--json").stdout)["errors"]
    assert rule in one["message"] or rule in str(one["path"])
    assert not whole_files(tmp_path)


@pytest.mark.parametrize("case", ["run", "sweep + --plot=p0"])
def test_a_missing_package_is_named_with_its_extra_before_anything_is_computed(case, seen, folder, tmp_path, monkeypatch):
    name, *more = case.partition(",")[0].split(" + ")
    given = [*words(name, seen, folder, tmp_path / "out"), *more]
    monkeypatch.setattr("raceway.cli.frame.find_spec", lambda name: None if name == "matplotlib" else find_spec(name))
    monkeypatch.setattr(ProgressBar, "__call__", lambda *_: pytest.fail("computed"))
    found = invoke(*given)
    assert found.exit_code == 2 and "matplotlib" in found.stderr and "pip install '.[pictures]' in" in found.stderr
    assert not (tmp_path / "out").exists()


def test_pictures_of_a_command_leave_pyplot_alone():
    """Figures of their own; only ``plot()``, in a notebook, hands out those of pyplot."""
    sources = Path(rw.__file__).parent.rglob("*.py")
    having = {path.name for path in sources if "import pyplot" in path.read_text(encoding="utf-8")}
    assert having == {"formats.py", "picture.py"}


def test_verbose_leaves_standard_output_to_json_which_is_the_file(tmp_path):
    found = invoke("run", MINIMAL, "--set", "integrator.kind=newmark", "--out", tmp_path, "--json", "-v")
    content = json.loads(found.stdout)
    assert content == json.loads((tmp_path / "result.json").read_text())
    assert {"equilibrium", "identification", "error", "cost", "stability", "environment", "plan", "scene"} <= set(content)
    parts = {"compiling": "compile_s", "building": "build_s", "solving": "solve_s", "error": "error_s"}
    times = ", ".join(f"{word} {content['cost'][name]:.2f} s" for word, name in parts.items() if content["cost"][name])
    told = " ".join(found.stderr.split())
    for words in (
        "plan: 27 degrees of freedom",
        "newmark, 4320 steps",
        f"run finished in {content['cost']['wall_s']:.2f} s: {times}",
    ):
        assert words in told
    from raceway.extend import default_registry

    assert not default_registry().manager.has_plugin("raceway -v")


def test_a_run_that_fails_on_a_full_disk_fails_as_a_run(tmp_path, monkeypatch):
    monkeypatch.setattr(Path, "write_bytes", full)
    found = invoke("run", MINIMAL, "--set", "load.axial=0", "--out", tmp_path, "-v")
    assert found.exit_code == 1, "the failure of the numbers is what counts"
    for told in ("run failed: ", "no load acts", "the last good state is lost", os.strerror(errno.ENOSPC)):
        assert told in found.stderr


def test_a_screen_is_there_although_its_file_is_not(tmp_path, monkeypatch):
    monkeypatch.setattr(Path, "write_bytes", full)
    found = invoke("run", MINIMAL, *FAST, "--out", tmp_path)
    assert found.exit_code == 2 and not list(tmp_path.iterdir())
    assert "equivalent stiffness K" in found.stdout and os.strerror(errno.ENOSPC) in found.stderr
    monkeypatch.setattr("os.access", lambda *given: False)
    found = invoke("run", MINIMAL, "--out", tmp_path)
    assert found.exit_code == 2 and "no permission" in found.stderr


def test_an_interruption_while_a_file_is_written_leaves_nothing(tmp_path, monkeypatch):
    def stop(self, _content):
        self.touch()
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "write_bytes", stop)
    assert invoke("run", MINIMAL, *FAST, "--out", tmp_path).exit_code == 130
    assert list(tmp_path.iterdir()) == []


def test_json_of_the_commands_that_compute_nothing(tmp_path):
    assert {"kept", "left_out", "dofs", "time_step_s", "predicted_wall_s"} <= set(
        json.loads(invoke("plan", ARTICLE, "--json").stdout)
    )
    assert json.loads(invoke("check", ARTICLE, "--json").stdout)["errors"] == []
    assert json.loads(invoke("dev", "schema").stdout)["$schema"].endswith("2020-12/schema")
    (tmp_path / "listed.py").write_text(LAW.format(name="listed_law", kernel="        return None"))
    content = json.loads(invoke("dev", "plugins", "--plugin", tmp_path / "listed.py", "--json").stdout)
    listed = {one["name"]: one for one in content["plugins"]}
    assert content["errors"] == [] and listed["listed_law"]["distribution"] == "listed.py"
    newmark = listed["newmark"]
    assert (newmark["kind"], newmark["distribution"]) == ("integrator", "raceway")
    gamma = next(option for option in newmark["options"] if option["name"] == "gamma")
    assert gamma["default"] == 0.5 and set(gamma) == {"name", "unit", "default", "rule", "help"}


def test_cache_is_seen_and_cleared(tmp_path, monkeypatch):
    monkeypatch.setenv("RACEWAY_CACHE_DIR", str(tmp_path))
    empty = json.loads(invoke("dev", "cache", "--json").stdout)
    assert empty["folders"] == []
    for name, size in ((empty["current"], 100), ("older", 7)):
        folder = tmp_path / "kernels" / name / "core"
        folder.mkdir(parents=True)
        (folder / "kernel.1.nbc").write_bytes(b"x" * size)
        (folder / "kernel.nbi").write_bytes(b"x")
    found = json.loads(invoke("dev", "cache", "--json").stdout)
    assert [(f["current"], f["kernels"], f["bytes"]) for f in found["folders"]] == [(True, 1, 101), (False, 1, 8)]
    assert "current" in invoke("dev", "cache").stdout
    assert json.loads(invoke("dev", "cache", "--clear", "--json").stdout)["folders"] == []
    assert not (tmp_path / "kernels").exists() and "the next run compiles" in invoke("dev", "cache").stdout


@pytest.mark.slow
def test_a_home_and_a_cache_that_cannot_be_written(tmp_path):
    """The table is there all the same; `tangent` compiles the fewest kernels."""
    blocked = tmp_path / "file"
    blocked.write_text("")
    found = raceway(
        *("run", MINIMAL, *FAST, "--set", "kinematics.ball_inertia=false", "--out", tmp_path / "out"),
        HOME=blocked / "home", XDG_CACHE_HOME=blocked / "cache", RACEWAY_CACHE_DIR="",
    )  # fmt: skip
    assert found.returncode == 0, found.stderr
    assert "equivalent stiffness K" in found.stdout
    assert found.stderr.count("warning: compiled kernels cannot be cached") == 1
    assert "not cached, the cache cannot be written" in " ".join(found.stdout.split())
    assert "RACEWAY_CACHE_DIR" in found.stderr and "Traceback" not in found.stderr


def test_an_installation_that_is_read_only_is_not_written_to(seen, folder):
    """Compiled kernels go to the user's cache folder alone, never beside the sources as numba does by itself."""
    look("run", seen, folder)
    assert not [path for path in Path(rw.__file__).parent.rglob("*") if path.suffix in (".nbi", ".nbc")]


def drawn(draw, **options):
    """What a bar draws on a terminal of 80 columns, or in a file."""
    console = Console(file=io.StringIO(), width=80, **options)
    draw(console)
    return console.file.getvalue()


def test_progress_is_drawn_on_a_terminal_after_a_second_and_never_elsewhere(monkeypatch):
    def slow(console, patience=0.01):
        with ProgressBar("compiling kernels", console, patience) as bar:
            time.sleep(0.15)
            bar("newmark, 4320 steps", 2000, 4320)
            time.sleep(0.15)

    text = drawn(slow, force_terminal=True)
    assert "compiling kernels" in text and "newmark, 4320 steps" in text

    def unknown(console):
        with ProgressBar("starting", console, 0.01, remaining=True) as bar:
            bar("searching", 0, 0)  # of nobody knows how many
            time.sleep(0.15)

    assert "0/?" in drawn(unknown, force_terminal=True)
    assert drawn(slow) == "" == drawn(lambda console: slow(console, 1.0), force_terminal=True).replace("\x1b[?25h", "")
    monkeypatch.setenv("FORCE_COLOR", "1")
    assert not ProgressBar("compiling kernels").console.is_terminal


def test_a_bar_inside_a_bar_says_what_it_does_in_the_outer_one():
    def nested(console):
        with ProgressBar("outside", console, 0.01) as bar:
            time.sleep(0.1)
            with ProgressBar("inside", patience=0.01) as inner:
                inner("inside, a half", 1, 2)
                time.sleep(0.15)
            bar("outside again", 1, 1)
            time.sleep(0.15)

    text = drawn(nested, force_terminal=True)
    assert text.index("outside") < text.index("inside, a half") < text.index("outside again")


def test_examples_are_short():
    assert len([line for line in Path(MINIMAL).read_text().splitlines() if line.strip()]) <= 10
