"""The example with ROSS, where ROSS is missing; with it, it runs in benchmarks/evidence/ross.py."""

from __future__ import annotations

import importlib.util
import sys

from validation.command_line import EXAMPLES


def test_the_example_says_what_is_missing(monkeypatch, capsys):
    spec = importlib.util.spec_from_file_location("ross_rotor", EXAMPLES / "ross_rotor.py")
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    monkeypatch.setitem(sys.modules, "ross", None)  # an import of it fails
    assert example.main([]) == 2
    told = " ".join(capsys.readouterr().err.split())
    assert "ROSS is not installed: pip install '.[ross]'" in told
