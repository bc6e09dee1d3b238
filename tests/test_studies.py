"""``raceway study``: plug-in studies are listed and run; a broken one is told in one line and takes nothing with it."""

import pytest

from checks.validation.command_line import invoke
from raceway import PluginError, hookimpl
from raceway.testing import Registry

STUDY = """
import attrs
import click
from raceway import hookimpl


@attrs.frozen
class Mine:
    name = "mine"
    help = "What I look at."

    def command(self):
        {body}


@hookimpl
def raceway_studies():
    return [Mine]
"""
SAYS = 'return click.Command("mine", params=[click.Argument(["word"])], callback=lambda word: click.echo(word))'


def test_a_study_of_ones_own_is_listed_and_run(tmp_path):
    file = tmp_path / "mine.py"
    file.write_text(STUDY.format(body=SAYS), encoding="utf-8")
    assert "mine" not in invoke("study", "--help").stdout
    shown = invoke("study", "--plugin", file, "--help").stdout
    assert "What I look at." in shown and all(name in shown for name in ("article", "rig"))
    assert invoke("study", "--plugin", file, "mine", "seen").stdout == "seen\n"


@pytest.mark.parametrize(("body", "told"), [
    ("import no_such_package", "study 'mine' of mine.py: command() raises ModuleNotFoundError"),
    ("return 3", "study 'mine' of mine.py: command() gives int"),
])  # fmt: skip
def test_a_broken_study_is_told_in_one_line_and_takes_no_other_with_it(tmp_path, body, told):
    file = tmp_path / "mine.py"
    file.write_text(STUDY.format(body=body), encoding="utf-8")
    found = invoke("study", "--plugin", file, "mine")
    assert found.exit_code == 2 and told in found.stderr and len(found.stderr.strip().splitlines()) == 1
    assert "Example:" in invoke("study", "--plugin", file, "article", "--help").stdout
    assert "What I look at." in invoke("study", "--plugin", file, "--help").stdout


class Broken:
    @hookimpl
    def raceway_studies(self):
        raise ImportError("gone")


def test_what_could_not_be_loaded_is_named_below_the_list(monkeypatch):
    registry = Registry(third_party=False)

    registry.add(Broken(), "raceway-broken")
    monkeypatch.setattr("raceway.framework.loading.registry.default_registry", lambda: registry)
    shown = " ".join(invoke("study", "--help").stdout.split())
    assert "article" in shown and "not loaded: plug-in `raceway-broken`: `raceway_studies` raises" in shown
    with pytest.raises(PluginError, match="no study named 'mine'"):
        registry.find("study", "mine")
