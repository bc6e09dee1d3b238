"""A broken, blocked, missing or doubled plug-in is named, and never takes the others down."""

import re
import sys
from importlib.metadata import entry_points

import pytest

from checks.validation.command_line import install, law
from raceway import PluginError, SceneError, scene_from_dict
from raceway.extend import Registry, run
from tests.fake_site import LAW, FakeSite

BROKEN = {
    "import": ("import a_module_that_nobody_has", "fails to import: ModuleNotFoundError"),
    "exit": ("import sys; sys.exit(3)", "fails to import: SystemExit"),
    "import-beyond-exceptions": ("class Odd(BaseException): pass\nraise Odd('not an Exception')",
        "fails to import: Odd: not an Exception"),
    "hook-exits": ("import sys\nfrom raceway import hookimpl\n@hookimpl\ndef raceway_excitations(): sys.exit(4)",
        "`raceway_excitations` raises SystemExit: 4"),
    "name-raises": ("import attrs\nfrom raceway import hookimpl\nclass Meta(type):\n    @property\n    def name(cls): raise KeyError('no name')\n"
        + "@attrs.frozen\nclass Law(metaclass=Meta): pass\n@hookimpl\ndef raceway_contact_laws(): return [Law]",
        "raises KeyError: 'no name'"),
    "repr-raises": ("from raceway import hookimpl\nclass Odd:\n    def __repr__(self): raise KeyError('no repr')\n"
        + "@hookimpl\ndef raceway_contact_laws(): return Odd()",
        "returns an object of type Odd, which is not a list of classes"),
    "hook-unknown": ("from raceway import hookimpl\n@hookimpl\ndef raceway_contact_lows(): return []",
        "does not fit the hooks: unknown hook 'raceway_contact_lows'"),
    "hook-arguments": ("from raceway import hookimpl\n@hookimpl\ndef raceway_contact_laws(scene): return []",
        "does not fit the hooks"),
    "hook-raises": ("from raceway import hookimpl\n@hookimpl\ndef raceway_excitations(): raise RuntimeError('no licence')",
        "`raceway_excitations` raises RuntimeError: no licence"),
    "hook-returns": (LAW.format(name="single", cls="Single").replace("return [Single]", "return Single"),
        "which is not a list of classes"),
    "instance": (LAW.format(name="made", cls="Made").replace("[Made]", "[Made()]"), "is not a class"),
    "duties": ("import attrs\nfrom raceway import hookimpl\n@attrs.frozen\nclass Half:\n    name = 'half'\n"
        + "@hookimpl\ndef raceway_contact_laws(): return [Half]",
        "has no `discretisations`, has no `state_size`, has no `dissipative`, has no `build`, has no `kernel`"),
    "unnamed": (LAW.format(name="x", cls="NoName").replace('    name: ClassVar[str] = "x"', "    pass"),
        "has no class attribute `name`"),
}  # fmt: skip


def test_tests_see_built_in_plug_ins_only(tmp_path, monkeypatch):
    install(tmp_path, "foreign", law("foreign"))
    monkeypatch.syspath_prepend(tmp_path)
    assert "foreign" in {point.name for point in entry_points(group="raceway")}
    assert "foreign" not in {entry.distribution for entry in Registry().all()}
    assert all(entry.distribution.partition("-")[0] == "raceway" for entry in Registry().all())


@pytest.fixture
def site(tmp_path, monkeypatch):
    return FakeSite(tmp_path, monkeypatch)


@pytest.mark.parametrize("case", BROKEN)
def test_a_broken_plugin_is_named_and_the_others_work(site, case):
    source, reason = BROKEN[case]
    site.install(f"broken-{case}", source, entry="broken")
    site.install("good", LAW.format(name="good_law", cls="Good"))
    registry = Registry()
    told = [str(f) for f in registry.faults if "broken" in f.source]
    assert len(told) == 1 and reason in told[0] and f"broken-{case}" in told[0]
    assert registry.find("contact_law", "good_law").distribution == "good"
    assert registry.find("contact_law", "hertz").distribution == "raceway"
    with pytest.raises(PluginError, match="broken"):
        registry.find("contact_law", "no_such_law")


#: What a hook says of the law ``lazy``, the file of its class, and the reason that it cannot be used.
AT_PLACES = {
    "no-module": ("lazy_gone:Law", "", "contact law 'lazy' fails to import from `lazy_gone:Law`: ModuleNotFoundError"),
    "no-class": ("{file}:Gone", "", "fails to import from `{file}:Gone`: AttributeError"),
    "raises": ("{file}:Law", "raise OSError('no licence')", "fails to import from `{file}:Law`: OSError: no licence"),
    "another-name": ("{file}:Law", LAW.format(name="x", cls="Law"), "has the name 'x', its hook says 'lazy'"),
    "duties": ("{file}:Law", BROKEN["duties"][0].replace("Half", "Law"), "contact law `Law` has no `discretisations`"),
}
AT_PLACE = "from raceway import hookimpl\n@hookimpl\ndef raceway_contact_laws(): return {{'lazy': '{place}'}}"


@pytest.mark.parametrize("case", AT_PLACES)
def test_a_class_that_is_not_what_its_hook_says_is_told_when_it_is_named(site, case):
    (place, source, reason), file = AT_PLACES[case], f"lazy_{case.replace('-', '_')}"
    (site.folder / f"{file}.py").write_text(source)
    site.install("lazily", AT_PLACE.format(place=place.format(file=file)))
    registry = Registry()
    assert not registry.faults and "lazy" in registry.names("contact_law") and file not in sys.modules
    (entry,) = (each for each in registry.all() if each.name == "lazy")
    told = f"plug-in `lazily`: .*{re.escape(reason.format(file=file))}"
    with pytest.raises(PluginError, match=f"{told}.*RACEWAY_DISABLE"):
        entry.plugin  # noqa: B018
    with pytest.raises(PluginError, match=f"no contact law named 'lazy'.*Not loaded: {told}"):
        registry.find("contact_law", "lazy")
    assert [re.match(told, str(fault)) is None for fault in registry.faults] == [False]
    assert "hertz" in [entry.name for entry in registry.of_kind("contact_law")]


def test_a_class_at_a_place_is_imported_when_its_name_or_its_kind_is_asked_for(site):
    for name in ("named", "asked"):
        (site.folder / f"lazy_{name}.py").write_text(LAW.format(name=name, cls="Law"))
    places = {name: f"lazy_{name}:Law" for name in ("named", "asked")}
    site.install("lazily", f"from raceway import hookimpl\n@hookimpl\ndef raceway_contact_laws(): return {places}")
    registry = Registry()
    assert not {"lazy_named", "lazy_asked"} & set(sys.modules)
    assert registry.find("contact_law", "named").plugin.__module__ == "lazy_named" and "lazy_asked" not in sys.modules
    assert {"named", "asked", "hertz"} <= {entry.plugin.name for entry in registry.of_kind("contact_law")}
    assert not registry.faults


@pytest.mark.parametrize("given", [{"lazy": "no_colon"}, {"lazy": 3}, {1: "module:Law"}, {"lazy": ":Law"}], ids=str)
def test_a_mapping_that_names_no_place_is_a_fault(site, given):
    site.install("lazily", f"from raceway import hookimpl\n@hookimpl\ndef raceway_contact_laws(): return {given}")
    registry = Registry()
    (fault,) = map(str, registry.faults)
    assert "plug-in `lazily`: `raceway_contact_laws` maps " in fault and 'a name, then "module:Class"' in fault
    assert "lazy" not in registry.names("contact_law")


def test_a_distribution_that_was_half_removed_takes_nothing_down(site):
    site.install("gone", "import a_module_that_was_removed")
    (site.folder / "gone-1.0.dist-info" / "METADATA").unlink()
    site.install("good", LAW.format(name="good_law", cls="Good"))
    registry = Registry()
    (told,) = [str(f) for f in registry.faults]
    assert "plug-in `gone (gone)`: fails to import: ModuleNotFoundError" in told
    assert registry.find("contact_law", "good_law").distribution == "good"


def test_what_a_plugin_prints_while_it_is_loaded_does_not_break_json(site, capsys):
    shouting = LAW.format(name="loud", cls="Loud").replace("    return [Loud]", "    print('HOOK')\n    return [Loud]")
    site.install("loud", "print('IMPORT')\n" + shouting)
    Registry().find("contact_law", "loud")
    said = capsys.readouterr()
    assert said.out == "" and "IMPORT" in said.err and "HOOK" in said.err


def test_two_plugins_of_one_name_shadow_each_other(site):
    site.install("first", LAW.format(name="twin", cls="Twin1"))
    site.install("second", LAW.format(name="twin", cls="Twin2"))
    registry = Registry()
    with pytest.raises(PluginError, match="`Twin1` of first and `Twin2` of second.*RACEWAY_DISABLE"):
        registry.find("contact_law", "twin")
    assert ("contact_law", "twin") in registry.shadowed()


def test_names_of_places_shadow_each_other_and_one_class_in_two_forms_is_one(site):
    site.install("other", AT_PLACE.format(place="nowhere:Law").replace("lazy", "hertz"))
    same = "from raceway import hookimpl\nfrom raceway.contact_laws.line import Line\n@hookimpl\ndef raceway_contact_laws(): return [Line]"
    site.install("same", same)
    registry = Registry()
    with pytest.raises(PluginError, match="`Hertz` of raceway and `Law` of other"):
        registry.find("contact_law", "hertz")
    assert registry.shadowed() == [("contact_law", "hertz")]
    assert registry.find("contact_law", "line").distribution == "raceway"


@pytest.mark.parametrize("blocked", ["two", "entry-two", " two , other"])
def test_disable(site, monkeypatch, blocked):
    site.install("one", LAW.format(name="law_one", cls="One"))
    site.install("two", LAW.format(name="law_two", cls="Two"), entry="entry-two")
    monkeypatch.setenv("RACEWAY_DISABLE", blocked)
    names = Registry().names("contact_law")
    assert "law_one" in names and "law_two" not in names and "hertz" in names


def test_exact_set(site, monkeypatch):
    site.install("one", LAW.format(name="law_one", cls="One"))
    site.install("two", LAW.format(name="law_two", cls="Two"))
    monkeypatch.setenv("RACEWAY_PLUGINS", "two, three")
    registry = Registry()
    names = registry.names("contact_law")
    assert "law_two" in names and "law_one" not in names and "hertz" in names
    assert [str(f) for f in registry.faults] == ["plug-in `three`: named in RACEWAY_PLUGINS, but not installed"]
    monkeypatch.setenv("RACEWAY_PLUGINS", "")
    assert "law_two" not in Registry().names("contact_law")


def test_trace_writes_every_hook_call(site, monkeypatch, capfd):
    monkeypatch.setenv("RACEWAY_TRACE", "1")
    Registry().hook.raceway_chunk_done(done=1, total=2)
    told = capfd.readouterr().err
    assert "raceway_contact_laws" in told and "raceway_chunk_done" in told and "total: 2" in told


LIFE_CYCLE = """
from raceway import hookimpl
calls = []
@hookimpl
def raceway_plan_made(plan): calls.append(plan); raise ZeroDivisionError("in the plug-in")
@hookimpl
def raceway_chunk_done(done, total): calls.append((done, total))
@hookimpl
def raceway_run_finished(result): calls.append(result)
@hookimpl
def raceway_run_failed(error): calls.append(error)
"""


def test_one_off_file(tmp_path):
    path = tmp_path / "my_law.py"
    path.write_text(LAW.format(name="one_off", cls="OneOff"))
    registry = Registry(third_party=False)
    (entry,) = registry.load_file(path)
    assert (entry.kind, entry.name, entry.distribution) == ("contact_law", "one_off", "my_law.py")
    assert len(entry.version) == 12
    assert registry.load_file(path) == [entry], "loading it twice is loading it once"
    assert "one_off" not in Registry(third_party=False).names("contact_law")
    path.write_text(path.read_text() + "# another content\n")
    assert Registry(third_party=False).load_file(path)[0].version != entry.version
    changed = tmp_path / "other.py"
    changed.write_text(LAW.format(name="one_off", cls="Other"))
    registry.load_file(changed)
    with pytest.raises(PluginError, match="two plug-ins claim the name 'one_off'"):
        registry.find("contact_law", "one_off")


@pytest.mark.parametrize(("name", "source", "reason"), [
    ("missing.py", None, "No such file"), ("law.txt", "", r"must be a Python file"),
    ("syntax.py", "def broken(:", "SyntaxError"),
    ("raises.py", "\n\nraise KeyError('gone')", r"raises\.py`, line 3: KeyError: 'gone'"),
    ("empty.py", "x = 1", "has no hook: write for instance @hookimpl"),
    ("bad.py", BROKEN["duties"][0], "has no `discretisations`"), ("hook.py", BROKEN["hook-unknown"][0], "unknown hook"),
])  # fmt: skip
def test_one_off_file_that_cannot_be_used(tmp_path, name, source, reason):
    if source is not None:
        (tmp_path / name).write_text(source)
    registry = Registry(third_party=False)
    before = [e.plugin for e in registry.all()]
    with pytest.raises(PluginError, match=reason):
        registry.load_file(tmp_path / name)
    assert [e.plugin for e in registry.all()] == before and not registry.faults
    assert registry.find("contact_law", "hertz").name == "hertz"


def test_an_object_that_cannot_be_hashed_is_a_fault_of_its_own(site):
    site.install("listed", "plugins = []", entry="listed")
    (info,) = site.folder.glob("listed-*.dist-info")
    text = (info / "entry_points.txt").read_text().strip()
    (info / "entry_points.txt").write_text(f"{text}:plugins\n")
    registry = Registry()
    (fault,) = [str(f) for f in registry.faults if f.source.startswith("listed")]
    assert "cannot be registered: unhashable type: 'list'" in fault
    assert registry.find("contact_law", "hertz").name == "hertz"


def test_names_on_the_command_line():
    registry = Registry(third_party=False)
    assert registry.find_any("hertz").kind == "contact_law"
    assert registry.find_any("contact-law:penalty").name == "penalty"
    for text, reason in {
        "herz": r"no plug-in named 'herz' \(did you mean 'hertz'\?\); installed: bodies:condensed, bodies:cylindrical_rollers, bodies:elastic, bodies:rigid, contact_law:film, contact_law:hertz",
        "law:hertz": "no kind of plug-in named 'law'.*kinds: contact_law, excitation",
        "integrator:hertz": "no integrator named 'hertz'",
    }.items():
        with pytest.raises(PluginError, match=reason):
            registry.find_any(text)


def test_a_name_that_two_kinds_have_is_ambiguous(tmp_path):
    path = tmp_path / "law.py"
    path.write_text(LAW.format(name="newmark", cls="NewmarkLaw"))
    registry = Registry(third_party=False)
    registry.load_file(path)
    with pytest.raises(PluginError, match="'newmark' is ambiguous; write contact_law:newmark or integrator:newmark"):
        registry.find_any("newmark")
    assert registry.find_any("integrator:newmark").distribution == "raceway"


@pytest.mark.parametrize(("table", "message"), [
    ({"thing": ">=1.2"}, "is required by this scene and not installed. Install it: pip install 'thing>=1.2'"),
    ({"thing": ""}, "Install it: pip install thing"), ({"goood": ""}, "not installed (did you mean 'good'?)"),
    ({"good": ">=2"}, "requires >=2, installed is good 1.4. Install a fitting one: pip install --upgrade 'good>=2'"),
    ({"good_law": "<1"}, "installed is good 1.4"), ({"good": "newest"}, "is not a version specifier"),
    ({"good": 1.2}, 'must be a string such as ">=1.2"'),
    ({"broken": ""}, "is installed, but could not be loaded: fails to import"),
    ({"blocked": ""}, "the environment variable RACEWAY_DISABLE leaves it out"),
    (">=1", "must be a table: write [requires] and keys below it"),
])  # fmt: skip
def test_requires_refuses(site, monkeypatch, table, message):
    _three(site, monkeypatch)
    with pytest.raises(SceneError) as caught:
        scene_from_dict({"bearing": {"preset": "B7206C"}, "requires": table}, Registry())
    (mistake,) = caught.value.mistakes
    assert message in str(mistake) and str(mistake).startswith("`requires")


def test_requires_accepts_distribution_entry_point_and_plugin(site, monkeypatch):
    _three(site, monkeypatch)
    met = {"good": ">=1.2, <2", "Good": "==1.4", "good_law": ">=1", "good-entry": "", "hertz": "", "raceway": ">=0.1"}
    scene = {"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}, "requires": met}
    assert scene_from_dict(scene, Registry()).bearing.preset == "B7206C"


def _three(site, monkeypatch):
    site.install("good", LAW.format(name="good_law", cls="Good"), version="1.4", entry="good-entry")
    site.install("broken", "import a_module_that_nobody_has")
    site.install("blocked", LAW.format(name="blocked_law", cls="Blocked"))
    monkeypatch.setenv("RACEWAY_DISABLE", "blocked")


def test_a_hook_that_raises_ends_the_run_with_the_plugins_name(tmp_path):
    path = tmp_path / "watcher.py"
    path.write_text(LIFE_CYCLE + "\n@hookimpl\ndef raceway_meshers(): return []\n")
    registry = Registry(third_party=False)
    registry.load_file(path)
    scene = scene_from_dict({"bearing": {"preset": "B7206C"}, "load": {"axial": 1000.0}}, registry)
    with pytest.raises(PluginError, match=r"watcher\.py.*ZeroDivisionError"):
        run(scene, registry)
    (watcher,) = [p for p in registry.manager.get_plugins() if hasattr(p, "calls")]
    assert isinstance(watcher.calls[-1], PluginError), "raceway_run_failed is told"
