"""The table of deliberate faults fits the sources; ``make mutants`` tries all of them, here only one is."""

import ast
import shutil
from functools import lru_cache
from pathlib import Path

import pytest

from checks.mutants import kernels, trial
from checks.mutants.__main__ import main
from checks.mutants.faults import ROOT, TABLE, Fault, chosen, read_faults
from raceway.storage.kernel_cache import current_folder

FAULTS, STRANGERS = read_faults(), read_faults(TABLE.with_name("stranger.toml"))
ARITHMETIC = (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.Pow, ast.MatMult)
#: Faults of one file are neighbours.
parsed = lru_cache(maxsize=2)(ast.parse)
#: A file computes when it has more arithmetic than indices need.
LEAST_OPERATIONS = 12


def computes(path: Path) -> bool:
    nodes = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
    return sum(isinstance(n, ast.BinOp) and isinstance(n.op, ARITHMETIC) for n in nodes) >= LEAST_OPERATIONS


def statement(source: str, line: int) -> str:
    """Text of the first statement of a file that ends at a line or behind it."""
    node = next(node for node in parsed(source).body if node.end_lineno >= line)
    first = min(part.lineno for part in (node, *getattr(node, "decorator_list", ())))
    return "\n".join(source.split("\n")[first - 1 : node.end_lineno])


def meaning(text: str) -> str:
    """Of a statement, without comments and layout."""
    return ast.dump(ast.parse(text))


@pytest.mark.parametrize(
    "fault", sorted([*FAULTS, *STRANGERS], key=lambda fault: fault.file), ids=lambda fault: f"{fault.file}: {fault.does}"
)
def test_a_fault_can_be_put_in_and_has_its_tests(fault):
    path = ROOT / fault.file
    source = path.read_text(encoding="utf-8")
    harmed = fault.put(source)  # refuses what no longer occurs once
    assert harmed != source
    if path.suffix == ".py":
        there = statement(source, source.count("\n", 0, source.index(fault.was)) + 1)
        there = there if fault.was in there else source
        assert meaning(there.replace(fault.was, fault.becomes)) != meaning(there)
    assert fault.tests and fault.does and not fault.misplaced()


def test_every_numerical_file_of_the_core_has_a_fault():
    there = {ROOT / fault.file for fault in FAULTS}
    missing = [
        str(path.relative_to(ROOT))
        for path in sorted((ROOT / "raceway" / "core").rglob("*.py"))
        if path not in there and computes(path)
    ]
    assert not missing, "put a fault of one line into checks/mutants/faults.toml for: " + ", ".join(missing)


def test_there_are_enough_and_no_two_are_the_same():
    assert len(FAULTS) >= 60
    assert len({(fault.file, fault.was, fault.becomes) for fault in FAULTS}) == len(FAULTS)
    assert len({(fault.file, fault.does) for fault in FAULTS}) == len(FAULTS)


def test_a_text_that_does_not_occur_once_is_refused():
    fault = Fault("some.py", "a + b", "a - b", ("tests/core/test_contact.py",), "a sign")
    assert fault.put("c = a + b\n") == "c = a - b\n"
    for source in ("c = b + a\n", "c = a + b\nd = a + b\n"):
        with pytest.raises(ValueError, match="must be once"):
            fault.put(source)


def test_words_choose_among_the_faults(capsys):
    words = ["gyroscopic moment has", "ring/ring.py"]
    assert {fault.file for fault in chosen(words)} == {"raceway/bodies/basis.py", "raceway/core/ring/ring.py"}
    assert main(["--list", "ring/ring.py"]) == 0
    assert "raceway/core/ring/ring.py: " in capsys.readouterr().out


@pytest.mark.slow
def test_a_fault_touches_what_is_made_of_its_statement_and_nothing_else():
    """Through imports, classes and kernels; not other functions of its file."""
    file = "raceway/core/fem/hexahedron/stiffness.py"
    found = kernels.touched(Fault(file, "weight * (bulk + twice * zz)", "", (), ""))
    hexahedron, elastic = "raceway.core.fem.hexahedron", "raceway.core.fem.elastic"
    assert {
        f"{hexahedron}.stiffness.range_point_force", f"{hexahedron}.operator.HexOperator",
        f"{elastic}.assembly.BodyForces",
    } <= found  # fmt: skip
    assert (
        not {f"{hexahedron}.stiffness.range_force", f"{elastic}.assembly.add_rows", "raceway.core.time.compiled.jit"} & found
    )


def test_the_copy_has_what_configures_pytest():
    """Without the root's conftest.py tests lack fixtures, and those of what is not installed fail on every fault."""
    assert {"pyproject.toml", *(path.name for path in ROOT.glob("*.py"))} <= set(trial.COPIED)


def test_kernels_that_a_fault_leaves_as_they_are_serve_at_another_place(monkeypatch, tmp_path):
    """Of two kernels in a copy's cache one is compiled from the faulty file."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("RACEWAY_CACHE_DIR", str(tmp_path / "cache"))
    place = Path("raceway/core/contact")
    there = tmp_path / "before" / kernels.folder_of(Path("/other") / place)
    there.mkdir(parents=True)
    for name in ("hertz.f-1.py311.nbi", "other.g-1.py311.nbi"):
        (there / name).write_text(name)
    monkeypatch.setattr(kernels, "touched", lambda fault: {"raceway.core.contact.hertz.f"})
    places, fault = {Path("/other"): tmp_path / "before"}, Fault("raceway/core/contact/hertz.py", "", "", (), "")
    assert [Path(path).name for _, path in kernels.kept(places, fault)] == ["other.g-1.py311.nbi"]
    assert len(found := kernels.kept(places)) == 2
    kernels.carry_over(found)
    assert (
        current_folder() / kernels.folder_of(tmp_path / place) / "hertz.f-1.py311.nbi"
    ).read_text() == "hertz.f-1.py311.nbi"


def test_a_caught_fault_is_told_from_one_that_survives(monkeypatch, tmp_path):
    """In sources of one function whose test sees its sign and not its size."""
    for name in trial.COPIED:
        (tmp_path / name).touch() if "." in name or name == "Makefile" else (tmp_path / name).mkdir()
    (tmp_path / "raceway/__init__.py").touch()
    shutil.copytree(ROOT / "checks/mutants", tmp_path / "checks/mutants")
    (tmp_path / "checks/__init__.py").touch()
    path = tmp_path / "raceway/some.py"
    path.write_text("def f(x):\n    return 2 * x\n")
    (tmp_path / "tests/test_some.py").write_text("from raceway.some import f\n\ndef test_sign():\n    assert f(1) > 0\n")
    for name, value in {"ROOT": tmp_path, "LIBRARIES": (), "kept": lambda *_: []}.items():
        monkeypatch.setattr(trial, name, value)
    tests = ("tests/test_some.py::test_sign",)
    forever = "__import__('time').sleep(99)"
    effects = {"-2 * x": (True, tests[0]), "3 * x ": (False, "survived"), forever: (True, "beyond the limit of time")}
    (tmp_path / "copies").mkdir()
    with trial.copied(tmp_path / "copies") as copy:
        assert copy.unharmed(tests) == ""
        before = path.stat().st_mtime_ns
        for becomes, verdict in effects.items():
            monkeypatch.setattr(trial, "LIMIT_S", 1 if becomes == forever else 600)
            one = copy.trial(Fault("raceway/some.py", "2 * x", becomes, tests, ""))
            assert (one.caught, one.how) == verdict
        there = copy.place / "raceway/some.py"
        assert (there.read_text(), there.stat().st_mtime_ns) == (path.read_text(), before)
