"""Fails when a hook or a kind of plug-in lacks a test, a conformance suite, a template, or its place in docs/plugin_kinds.md."""

import re
from pathlib import Path

import pytest

from raceway.framework import hookspecs
from raceway.framework.contracts import KINDS, plural
from raceway.testing import SUITES, suite_of
from tests.test_docs import FILES

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "plugin_kinds.md").read_text(encoding="utf-8")
SHOWN = "\n".join(FILES.values())
HOOKS = [name for name in vars(hookspecs) if name.startswith("raceway_")]
TESTS = "\n".join(
    path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("*.py") if path.name != Path(__file__).name
)


def test_kinds_and_registration_hooks_belong_together():
    registering = {hook for hook, _ in KINDS.values()}
    assert registering <= set(HOOKS)
    assert len(registering) == len(KINDS)


@pytest.mark.parametrize("hook", HOOKS)
def test_every_hook_is_tested_documented_and_explained(hook):
    # Registration hooks are tested with the plug-ins of pages and examples (test_docs), life-cycle hooks by name.
    registering = hook in {h for h, _ in KINDS.values()}
    assert hook in (PAGE if registering else TESTS), f"no test mentions {hook}"
    assert re.search(rf"^def {hook}\(", SHOWN, re.MULTILINE), f"no example shows {hook}"
    assert getattr(hookspecs, hook).__doc__, f"{hook} has no docstring"


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_has_suite_tests_page_and_template(kind):
    assert kind in SUITES, f"raceway.testing has no suite for {kind}"
    suite = suite_of(kind)
    assert suite.kind == kind
    assert suite.__name__ in TESTS, f"no test uses {suite.__name__}"
    heading = plural(kind).capitalize()
    section = re.search(rf"^## {heading}\n(.*?)(?=^## |\Z)", PAGE, re.MULTILINE | re.DOTALL)
    assert section, f"docs/plugin_kinds.md has no section '{heading}'"
    assert suite.__name__ in section.group(1) and KINDS[kind][0] in section.group(1)
    assert (ROOT / "raceway" / "data" / "templates" / kind / "package_plugin.py.txt").is_file()
