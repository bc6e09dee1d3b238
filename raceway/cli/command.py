"""A command from a public function: arguments, options and help come from its signature and its docstring.

A front takes plain values and returns an ``Answer``, which is saved, shown and drawn the same way for all.  Names of arguments have one meaning:
``scene`` is a file that --set changes, ``kept`` the folder of --out for finished rows, ``progress`` a bar, ``plugins`` files,
``pictures`` the folder of what is drawn while it is computed, ``plan`` whether the answer is a ``Workload``, of which nothing is written.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import attrs
import click

from raceway.cli.frame import (
    FILE,
    OF_KEYS,
    RESULTS,
    attempt,
    changed_tables,
    common,
    has_matplotlib,
    keep_state,
    keeping,
    load,
    out_option,
    plugin_files,
    scene_keys,
    set_keys,
    show,
    show_progress,
    tell_faults,
)
from raceway.cli.interrupt import answered
from raceway.errors import BeyondPlanError, ConvergenceError, RacewayError, SceneError
from raceway.framework.loading import named

if TYPE_CHECKING:
    from raceway.answers.answer import Answer
    from raceway.framework.loading.registry import Registry

Value = Any
#: Types of options by annotation; of others, texts.
_TYPES: dict[str, click.ParamType | type] = {"int": int, "float": float, "str": str, "str | Path": FILE}
#: Arguments that no option stands for.
_SHARED = ("scene", "changes", "plugins", "progress", "kept", "out", "registry", "pictures")


class Option(NamedTuple):
    """What a command line says otherwise than the signature.

    Attributes
    ----------
    flag : without the dashes
    metavar : of the value;  help, default : instead of the docstring's and the signature's
    choices : values that are taken;  positional : an argument

    Examples
    --------
    >>> from raceway import Option
    >>> Option(metavar="RPM", help="Speed of the shaft.").flag
    ''
    """

    flag: str = ""
    metavar: str | None = None
    help: str = ""
    choices: tuple[str, ...] = ()
    default: object = None
    positional: bool = False

    @classmethod
    def metavars(cls, **words: str) -> dict[str, Option]:
        """Of arguments of which the command line says no more than what stands for their value."""
        return {name: cls(metavar=word) for name, word in words.items()}


class Command(NamedTuple):
    """A line of the table of commands.

    Attributes
    ----------
    front : a function, or "module:function", which is imported when the command is asked for
    summary : for the list of commands;  example : command lines
    options : name of an argument -> what the command line says otherwise;  None: the command line does not have it
    folder : what follows the scene's title in the name of the default folder; None: nothing is written without --out
    named_by : argument with the file whose name stands for the title
    unchecked : the scene is not read before the front has changed it
    pictures : whether they are drawn unless something else is said; None: there are none
    remaining : the bar shows the time left: parts take about the same time each;  aliases : other names

    Examples
    --------
    >>> import raceway as rw
    >>> band = rw.Command("band", "raceway.points.band:uncertainty", "Its range.", "raceway band SCENE", folder="-band")
    >>> [option.opts for option in band.click().params][2:5]
    [['--tolerances'], ['--keys'], ['--samples']]
    """

    name: str
    front: str | Callable[..., Value]
    summary: str
    example: str
    options: Mapping[str, Option | None] = {}
    folder: str | None = ""
    named_by: str = ""
    unchecked: bool = False
    pictures: bool | None = True
    remaining: bool = False
    aliases: tuple[str, ...] = ()

    def click(self) -> click.Command:
        """The command, with the module of its front imported."""
        front = named(self.front) if isinstance(self.front, str) else self.front
        # Argument -> its words; several arguments of one line are parted by ``;  ``.
        # What stands before the parameters, and these, in numpydoc's form.
        before, _, after = (inspect.getdoc(front) or "").partition("\nParameters\n----------\n")
        lines = re.sub(r"\n\s+", " ", re.split(r"\n\n\w+\n-+\n", after)[0])
        entries = [entry for line in lines.splitlines() for entry in re.split(r";  (?=[\w, *]+ : )", line)]
        pairs = (entry.partition(" : ") for entry in entries)
        words = {name.strip(): words.strip() for names, _, words in pairs for name in names.split(",")}
        signature = inspect.signature(front)
        hidden = {*_SHARED, *(name for name, about in self.options.items() if about is None)}
        params = [parameter for name, parameter in signature.parameters.items() if name not in hidden]

        def call(**values: Value) -> int:
            return _perform(self, front, values)

        summary = before.split("\n\nReturns\n", 1)[0].replace("``", "").strip()
        help_text = f"{summary}\n\n\b\nExample:\n" + "\n".join(f"  {line}" for line in self.example.splitlines())
        command: Callable[..., Value] = common(call)
        if "plugins" in signature.parameters:
            command = plugin_files(command)
        if self.pictures is not None:
            names, usual = ("--pictures/--no-pictures", " (default)") if self.pictures else ("--pictures", "")
            command = click.option(names, is_flag=True, default=self.pictures, help=f"Draw pictures as PNG{usual}.")(command)
            form = click.Choice(["svg", "pdf"])
            text = "Write them in this format, too: for a paper."
            command = click.option("--picture-format", type=form, help=text)(command)
        if self.pictures is not None or self.folder is not None:
            title = self.named_by.upper() or "TITLE"
            default = f"{RESULTS}/{title}{self.folder}" if "scene" in signature.parameters else f"{RESULTS}/{self.name}"
            command = out_option("nothing is written" if self.folder is None else default)(command)
        for parameter in reversed(params):
            text = str(parameter.annotation).removesuffix(" | None")
            kind = str(inspect.unwrap(front).__globals__.get(text, text))  # what an alias of the front's module stands for
            command = self._option(parameter, kind, words.get(parameter.name, ""))(command)
        if "scene" in signature.parameters:
            is_required = signature.parameters["scene"].default is inspect.Parameter.empty
            scene_input = click.argument("scene", type=FILE, required=is_required)
            if "scene" in self.options:
                scene_input = click.option("--scene", type=FILE, metavar="SCENE", help=_option_help(words["scene"]))
            command = set_keys(scene_input(command))
        for parameter in reversed(params):
            if self._about(parameter).positional:
                empty, file = parameter.default is inspect.Parameter.empty, "Path" in str(parameter.annotation)
                facts: dict[str, Any] = {"required": empty, "metavar": self._about(parameter).metavar}
                facts |= {} if empty else {"default": parameter.default}
                command = click.argument(parameter.name, type=FILE if file else None, **facts)(command)
        return click.command(self.name, short_help=self.summary, help=help_text)(command)

    def _about(self, parameter: inspect.Parameter) -> Option:
        return self.options.get(parameter.name) or Option()

    def _option(self, parameter: inspect.Parameter, kind: str, words: str) -> Callable[[Value], Value]:
        about = self._about(parameter)
        default = parameter.default if about.default is None else about.default
        if about.positional:
            return lambda command: command
        flags = (f"--{about.flag or parameter.name.replace('_', '-')}", parameter.name)
        text = about.help or _option_help(words)
        if kind == "bool":
            name = flags[0].removeprefix("--")
            switch = f"--{name}/--no-{name}" if default is True else flags[0]
            return click.option(switch, parameter.name, default=default, is_flag=True, help=text)
        if "Iterable[" in kind:
            needed = parameter.default is inspect.Parameter.empty
            several = f"{text.removesuffix('.')}; repeat for more."
            of = _TYPES.get(kind.partition("Iterable[")[2].partition("]")[0], str)
            keys = scene_keys if parameter.name in OF_KEYS else None
            parts: dict[str, Any] = {"type": of, "multiple": True, "required": needed, "shell_complete": keys}
            return click.option(*flags, metavar=about.metavar, help=several, **parts)
        empty = default is inspect.Parameter.empty
        # None too is a value to click, also of what is required.
        start: dict[str, Any] = {} if empty else {"default": default}
        value = click.Choice(about.choices) if about.choices else _TYPES.get(kind, str)
        shown = not empty and default is not None
        return click.option(
            *flags, type=value, metavar=about.metavar, required=empty, show_default=shown, help=text, **start
        )


def _perform(about: Command, front: Callable[..., Value], values: dict[str, Value]) -> int:
    """Read the scene, call the front, write and show its answer."""
    from raceway.answers.answer import Interrupted
    from raceway.framework.loading.registry import registry_with
    from raceway.scene.scene import Scene
    from raceway.storage.files import slug, writable

    arguments = {name: value for name, value in values.items() if value != ()}
    as_json, pictures, form = (arguments.pop(name, None) for name in ("as_json", "pictures", "picture_format"))
    out, plugins, changes = arguments.pop("out", None), arguments.pop("plugins", ()), arguments.pop("changes", ())
    registry, signature, title = registry_with(plugins), inspect.signature(front), ""
    parameters = signature.parameters
    changed_by_front = "changes" in parameters and parameters["scene"].default is None
    if arguments.get("scene") is not None and not changed_by_front:
        arguments["scene"], title = _scene(about, arguments["scene"], changes, registry)
    elif changed_by_front:
        title = str(changed_tables(scene, changes, registry)[0]["title"]) if (scene := arguments.get("scene")) else ""
        arguments["changes"] = changes
    elif changes:
        raise SceneError.at("--set", changes[0], "changes a scene, but no scene is given: name one, or omit the option")
    if about.named_by:
        title = Path(arguments[about.named_by]).stem + "".join(title.partition("\n")[1:])
    folder = out
    if out is None and about.folder is not None:
        folder = RESULTS / (f"{slug(title)}{about.folder}" if title else about.name)
    state_folder = folder if "kept" in parameters else None
    folder = None if arguments.get("plan") else folder
    pictures = folder is not None and bool(pictures or form) and has_matplotlib(by_default=bool(about.pictures))
    if folder is not None:
        writable(folder)
    tell_faults(registry)
    further = {"plugins": plugins, "kept": state_folder, "registry": registry, "pictures": folder if pictures else None}
    arguments |= {name: value for name, value in further.items() if name in parameters}
    interruption = None
    with keeping(state_folder):
        with show_progress(about.remaining) as progress:
            if "progress" in parameters:
                arguments["progress"] = progress
            try:
                bound = signature.bind_partial()
                bound.arguments.update(arguments)
                answer: Answer = front(*bound.args, **bound.kwargs)
            except (ConvergenceError, BeyondPlanError) as error:
                if folder is not None and isinstance(scene := arguments.get("scene"), Scene):
                    keep_state(error, scene, folder)
                raise
            except SceneError as error:
                raise _by_flags(about, error) or error from None
            except Interrupted as stop:
                if stop.partial is None:
                    raise
                answer, interruption = stop.partial, stop  # what is finished is written and shown first
                answered()
        files: list[str] = []
        drawn = pictures and interruption is None and (form or True)
        fault = None if folder is None else attempt(lambda: answer.save(folder, drawn), files)
        fault = fault or _by_flags(about, answer.failure())
        show(answer.to_dict() if as_json else {}, as_json, fault, lambda: answer.screen(files))
        if interruption is not None:
            raise interruption
    return 0 if answer.passed else 1


def _scene(about: Command, path: Path, changes: tuple[str, ...], registry: Registry) -> tuple[Value, str]:
    """The scene, or its tables where the front changes them before they make one; its title."""
    if not about.unchecked:
        scene = load(path, changes, registry)
        return scene, scene.title
    tables, mistakes = changed_tables(path, changes, registry)
    if mistakes:
        raise SceneError(mistakes)
    return tables, str(tables["title"])


def _by_flags(about: Command, error: RacewayError | None) -> RacewayError | None:
    """Mistakes in arguments of the front under the names that the command line has for them."""
    if not isinstance(error, SceneError):
        return error
    flags = {k: f"--{o.flag or k.replace('_', '-')}" for k, o in about.options.items() if o and not o.positional}
    return SceneError([attrs.evolve(m, path=flags.get(str(m.path), m.path)) for m in error.mistakes])


def _option_help(words: str) -> str:
    """A sentence for an option: "n; None: the usual" becomes "N [the usual]."."""
    text = re.sub(r"; (?:None|none): (.+)$", r" [\1]", words.replace("``", ""))
    return f"{text[:1].upper()}{text[1:]}." if text else ""
