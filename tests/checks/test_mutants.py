"""The table of deliberate faults fits the sources; ``make mutants`` tries all of them, here only one is."""

import ast
from functools import lru_cache
from pathlib import Path

import pytest

from checks.mutants import trial
from checks.mutants.__main__ import main
from checks.mutants.faults import ROOT, TABLE, Fault, chosen, read_faults
from checks.mutants.kernels import touched

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
def test_a_fault_touches_what_imports_its_file_and_nothing_else():
    found = {str(path.relative_to(ROOT)) for path in touched("raceway/core/fem/hexahedron/stiffness.py")}
    assert {
        "raceway/core/fem/hexahedron/stiffness.py",
        "raceway/core/fem/hexahedron/operator.py",
        "raceway/core/fem/elastic/assembly.py",
        "tests/core/hexahedron/test_elements.py",
    } <= found
    assert not {"raceway/core/time/compiled.py", "raceway/contact_laws/penalty.py"} & found


def test_the_copy_has_what_configures_pytest():
    """Without the root's conftest.py tests lack fixtures, and those of what is not installed fail on every fault."""
    assert {"pyproject.toml", *(path.name for path in ROOT.glob("*.py"))} <= set(trial.COPIED)


def test_a_caught_fault_is_told_from_one_that_survives(monkeypatch, tmp_path):
    """In sources of one function whose test sees its sign and not its size."""
    for name in trial.COPIED:
        (tmp_path / name).touch() if "." in name or name == "Makefile" else (tmp_path / name).mkdir()
    (tmp_path / "raceway/__init__.py").touch()
    path = tmp_path / "raceway/some.py"
    path.write_text("def f(x):\n    return 2 * x\n")
    (tmp_path / "tests/test_some.py").write_text("from raceway.some import f\n\ndef test_sign():\n    assert f(1) > 0\n")
    monkeypatch.setattr(trial, "ROOT", tmp_path)
    tests = ("tests/test_some.py::test_sign",)
    sign, size = (Fault("raceway/some.py", "2 * x", text, tests, "") for text in ("-2 * x", "3 * x"))
    with trial.copied() as copy:
        assert copy.unharmed([sign, size]) == ""
        before = path.stat().st_mtime_ns
        verdicts = [copy.trial(fault) for fault in (sign, size)]
        there = copy.place / "raceway/some.py"
        assert (there.read_text(), there.stat().st_mtime_ns) == (path.read_text(), before)
    assert [(one.caught, one.how) for one in verdicts] == [(True, tests[0]), (False, "survived")]
