"""Small manners of the command line: Ctrl-C at the start and in a study, names in RACEWAY_DISABLE, one-off plug-ins listed."""

from __future__ import annotations

import json

import pytest

from validation.command_line import LAW, MINIMAL, invoke, python, raceway

#: A signal while the commands are imported.
LOADING = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell may start a program in the background without
class Interrupted:
    def __getattr__(self, attribute):
        if attribute == "main":
            signal.raise_signal(signal.{name})
sys.modules["raceway.cli"] = Interrupted()
from raceway.__main__ import main
main()
"""


@pytest.mark.parametrize(("name", "code", "words"), [("SIGINT", 130, "Ctrl-C"), ("SIGTERM", 143, "SIGTERM")])
def test_a_signal_before_the_commands_are_loaded(name, code, words):
    found = python("-c", LOADING.format(name=name))
    assert found.returncode == code
    assert found.stderr == f"stopped by {words}; no file is left half-written\n"


@pytest.mark.parametrize("as_json", [False, True])
def test_ctrl_c_in_a_comparison_keeps_the_finished_rows(tmp_path, monkeypatch, as_json):
    from raceway.studies.compare import study as compare

    run, done = compare.run, []

    def stop(*given):
        if done:
            raise KeyboardInterrupt
        done.append(1)
        return run(*given)

    monkeypatch.setattr(compare, "run", stop)
    words = [
        "compare",
        MINIMAL,
        "--vary",
        "excitation.speed_rpm=12000,13000",
        "--set",
        "integrator.turns=1",
        "--out",
        tmp_path,
    ]
    found = invoke(*words, *(["--json"] if as_json else []))
    assert found.exit_code == 130
    content = json.loads((tmp_path / "compare.json").read_text())
    assert len(content["rows"]) == 1
    assert "12000" in found.stdout
    assert "stopped by Ctrl-C" in found.stderr


def test_ctrl_c_before_the_first_row_writes_nothing(tmp_path, monkeypatch):
    def stop(*_given):
        raise KeyboardInterrupt

    monkeypatch.setattr("raceway.studies.compare.study.run", stop)
    found = invoke("compare", MINIMAL, "--vary", "load.axial=400,500", "--out", tmp_path)
    assert found.exit_code == 130
    assert not list(tmp_path.iterdir())


def test_an_unknown_name_in_raceway_disable_is_told():
    found = raceway("check", MINIMAL, RACEWAY_DISABLE="no_such_thing")
    assert found.returncode == 0
    assert "RACEWAY_DISABLE names 'no_such_thing', which nothing is called" in found.stderr


def test_plugins_lists_one_off_files(tmp_path):
    (tmp_path / "listed.py").write_text(LAW.format(name="listed_law", kernel="        return None"))
    found = raceway("plugins", "--plugin", tmp_path / "listed.py", "--json")
    rows = json.loads(found.stdout)["plugins"]
    assert [row["distribution"] for row in rows if row["name"] == "listed_law"] == ["listed.py"]
