"""The conformance suite of studies."""

from __future__ import annotations

from typing import TYPE_CHECKING

from raceway.testing.suite import Suite, duty, require

if TYPE_CHECKING:
    from raceway.framework.contracts import Study


class StudySuite(Suite):
    """Duties of ``raceway.framework.contracts.Study``."""

    kind = "study"

    @duty("help is one line for the list of studies")
    def test_help(self, study: Study) -> None:
        require(isinstance(study.help, str) and study.help.strip(), "help is no text")
        require(len(study.help.splitlines()) == 1, "help has several lines")

    @duty("command() gives a click command of the study's name that takes --json and explains itself")
    def test_command(self, study: Study) -> None:
        import click
        from click.testing import CliRunner

        command = study.command()
        require(isinstance(command, click.Command), f"command() gives {type(command).__name__}, not a click.Command")
        require(command.name == study.name, f"the command is called '{command.name}', the study '{study.name}'")
        require(any("--json" in one.opts for one in command.params), "the command has no --json")
        shown = CliRunner().invoke(command, ["--help"], standalone_mode=True)
        require(shown.exit_code == 0 and command.help, "--help fails or says nothing")
