"""Messages and exit codes: one message for each thing that can go wrong.

0 success, 1 a numerical failure, 2 the user's mistake; 130, 143, 129 stopped by Ctrl-C, SIGTERM, SIGHUP.  Part of ``raceway.cli.main``, which alone
may print and exit.
"""

import errno
import json
import math
import os
import sys
import traceback
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import click

from raceway.cli.interrupt import Interrupts, farewell, stopped_by
from raceway.errors import MeshError, RacewayError, SceneError
from raceway.framework.options import nearest
from raceway.storage.tables import Tables


class _Stopped(BaseException):
    """An interruption that click does not see: it would answer with an empty line."""


class _Bare(click.UsageError):
    """A group without a command: its help is the answer."""

    def __init__(self, ctx: click.Context) -> None:
        super().__init__(ctx.get_help(), ctx)


class Commands(click.Group):
    """A group of commands that ends with one message and an exit code, whatever happens."""

    def main(  # type: ignore[override]  # click declares overloads; this one always exits
        self, args: Sequence[str] | None = None, prog_name: str | None = None, **extra: Any
    ) -> Any:
        words = list(sys.argv[1:] if args is None else args)
        extra["standalone_mode"] = False
        sys.exit(_exit_code(lambda: super(Commands, self).main(words, prog_name="raceway", **extra), words))

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        if not args and self.no_args_is_help and not ctx.resilient_parsing:
            raise _Bare(ctx)
        return super().parse_args(ctx, args)

    def invoke(self, ctx: click.Context) -> object:
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as stop:
            raise _Stopped from stop

    def resolve_command(self, ctx: click.Context, args: list[str]) -> tuple[str | None, click.Command | None, list[str]]:
        names = [name for name in self.list_commands(ctx) if " " not in name]
        if args and self.get_command(ctx, args[0]) is None and not args[0].startswith("-"):
            hint = f" ({elsewhere})" if (elsewhere := self.elsewhere(args[0])) else nearest(args[0], names)
            raise click.UsageError(f"no command '{args[0]}'{hint}; commands: {', '.join(names)}", ctx)
        return super().resolve_command(ctx, args)

    def elsewhere(self, word: str) -> str:
        """Where a word that is no command of this group is one, or an option."""
        return ""


def _exit_code(command: Callable[[], object], words: list[str]) -> int:
    """Run a command; report what it raises; return the exit code.

    words : the command line, which tells whether ``--json`` and ``--debug`` were asked for even when it cannot be parsed
    """
    as_json, debug = "--json" in words, "--debug" in words
    with warnings.catch_warnings():
        warnings.showwarning = _show_warning
        try:
            with Interrupts():
                code = command()
            sys.stdout.flush()
            return code if isinstance(code, int) else 0
        except (click.Abort, KeyboardInterrupt, _Stopped):
            return farewell(_say)
        except BrokenPipeError:
            _silence_stdout()
            return 1
        except BaseException as error:  # the last resort: no traceback reaches the user unless asked for
            if stopped_by() is not None:  # libraries turn an interruption into errors of their own
                return farewell(_say)
            if not isinstance(error, Exception):
                raise
            if debug:
                traceback.print_exc()
            return report(error, as_json)


def report(error: Exception, as_json: bool) -> int:
    """Say what went wrong, on standard error or as JSON on standard output; return the exit code."""
    code, items = described(error)
    if isinstance(error, _Bare):
        click.echo(error.message, err=True)
        return code
    if as_json:
        try:
            print_json({"errors": items, **(error.files if isinstance(error, RacewayError) else {})})
            return code
        except BrokenPipeError:
            raise
        except OSError as why:  # standard output is full: what is left to say goes to standard error
            _silence_stdout()
            full = {"path": None, "value": None, "message": _os_message(why)}
            items += [full] if full not in items else []
    head = click.style("error: ", fg="red", bold=True)
    if len(items) > 1:
        head += f"{len(items)} mistakes\n  "
    lines = [f"{_where(item)}{item['message']}" for item in items] + list(getattr(error, "__notes__", ()))
    if isinstance(error, click.UsageError):
        command = "raceway" if error.ctx is None else error.ctx.command_path
        lines.append(f"try `{command} --help`, which has an example")
    click.echo(head + "\n  ".join(lines), err=True)
    return code


def described(error: Exception) -> tuple[int, list[Tables]]:
    """Exit code and ``[{path, value, message}]`` of an exception."""
    if isinstance(error, SceneError):
        return error.exit_code, [{"path": m.path, "value": plain(m.value), "message": m.message} for m in error.mistakes]
    if isinstance(error, MeshError) and error.mistake is not None:
        return described(SceneError([error.mistake]))
    code, message = 2, str(error)
    if isinstance(error, RacewayError):
        code = error.exit_code
    elif isinstance(error, click.ClickException):
        message = error.format_message()
    elif isinstance(error, OSError):
        message = _os_message(error)
    elif isinstance(error, MemoryError):
        code, message = 1, "not enough memory for this scene: `raceway plan` shows its size"
    else:
        # File and line that raised, so that a plug-in's fault is not taken for the program's.
        frames = traceback.extract_tb(error.__traceback__)
        where = f" ({Path(frames[-1].filename).name}, line {frames[-1].lineno})" if frames else ""
        advice = "This is a fault of the program or of a plug-in: run again with --debug for the traceback and report it."
        code, message = 1, f"unexpected {type(error).__name__}: {error or 'no message'}{where}. {advice}"
    return code, [{"path": None, "value": None, "message": message}]


def _where(item: Tables) -> str:
    if item["path"] is None:
        return ""
    if item["value"] is None:
        return f"`{item['path']}`: "
    text = repr(item["value"])
    return f"`{item['path']}` = {text if len(text) <= 60 else text[:57] + '...'}: "


def _os_message(error: OSError) -> str:
    file = f"`{error.filename}`: " if error.filename else ""
    remedy = " Free some space, or choose another folder." if error.errno == errno.ENOSPC else ""
    return f"{file}{error.strerror or error}.{remedy}"


def plain(value: object) -> Any:
    """A value of a TOML file as JSON can carry it: dates and numbers that are not finite become text."""
    if isinstance(value, dict):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [plain(v) for v in value]
    if isinstance(value, float) and not math.isfinite(value):
        return repr(value)
    return value if isinstance(value, str | int | float | bool | None) else str(value)


def print_json(content: object) -> None:
    click.echo(json.dumps(content, indent=1, allow_nan=False))


def warn(text: str, label: str = "warning: ") -> None:
    click.echo(click.style(label, fg="yellow", bold=True) + text, err=True)


def _say(text: str) -> None:
    warn(text, label="")


def _show_warning(message: Warning | str, category: type[Warning], *_rest: object, **_named: object) -> None:
    """Python's warnings, for people: the text without file and line."""
    if not issubclass(category, DeprecationWarning | PendingDeprecationWarning):
        warn(str(message))


def _silence_stdout() -> None:
    """The reader of a pipe went away: keep the interpreter from complaining when it flushes."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
