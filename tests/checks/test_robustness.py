"""Checks of robustness whose rows hold: hundreds of damaged stores, interrupted commands, bearings."""

from importlib import import_module

import pytest


@pytest.mark.release
@pytest.mark.parametrize("name", ["damage", "signals", "uncertainty"])
def test_all_rows_hold(name):
    assert [row for row in import_module(f"checks.robustness.{name}").rows() if not row.ok] == []
