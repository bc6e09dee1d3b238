"""Fails when a hook or a kind of plug-in lacks a test, a conformance suite, a template, or its place in docs/plugin_kinds.md."""

import re
from pathlib import Path

import pytest

from raceway.testing import SUITES, default_registry, suite_of
from tests.test_docs import FILES

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "plugin_kinds.md").read_text(encoding="utf-8")
SHOWN = "\n".join(FILES.values())
HOOKS = {call.name: call.spec.function for call in vars(default_registry().manager.hook).values()}
#: Kind of plug-in -> its name in the plural, which its hook has.
KINDS = {kind: {"bodies": "bodies", "quantity": "quantities", "study": "studies"}.get(kind, f"{kind}s") for kind in SUITES}
#: Of a run, and of packages.
OTHERS = {
    f"raceway_{name}" for name in ["plan_made", "chunk_done", "run_finished", "run_failed", "commands", "names", "tables"]
}
TESTS = "\n".join(
    path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("*.py") if path.name != Path(__file__).name
)


def test_kinds_and_registration_hooks_belong_together():
    assert {f"raceway_{kinds}" for kinds in KINDS.values()} == HOOKS.keys() - OTHERS
    assert {kind for kind, _ in default_registry().entries} == set(KINDS)


@pytest.mark.parametrize("hook", HOOKS)
def test_every_hook_is_tested_documented_and_explained(hook):
    # Registration hooks are tested with the plug-ins of pages and examples (test_docs), life-cycle hooks by name.
    registering = hook not in OTHERS
    assert hook in (PAGE if registering else TESTS), f"no test mentions {hook}"
    assert re.search(rf"^def {hook}\(", SHOWN, re.MULTILINE), f"no example shows {hook}"
    assert HOOKS[hook].__doc__, f"{hook} has no docstring"


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_has_suite_tests_page_and_template(kind):
    suite = suite_of(kind)
    assert suite.kind == kind
    assert suite.__name__ in TESTS, f"no test uses {suite.__name__}"
    heading = KINDS[kind].replace("_", " ").capitalize()
    section = re.search(rf"^## {heading}\n(.*?)(?=^## |\Z)", PAGE, re.MULTILINE | re.DOTALL)
    assert section, f"docs/plugin_kinds.md has no section '{heading}'"
    assert suite.__name__ in section.group(1) and f"raceway_{KINDS[kind]}" in section.group(1)
    assert (ROOT / "raceway" / "data" / "templates" / kind / "package_plugin.py.txt").is_file()
