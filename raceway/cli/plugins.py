"""The commands for developers: plug-ins, caches, a first scene.  Part of ``raceway.cli.main``."""

import json
import keyword
import re
from collections import Counter
from collections.abc import Iterator
from datetime import datetime
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Any

import attrs
import click
from rich.console import Group, RenderableType
from rich.markup import escape
from rich.padding import Padding
from rich.table import Column, Table
from rich.text import Text

from raceway import __version__
from raceway.answers.table import Words, file_lines, sections
from raceway.cli.console import print_json
from raceway.cli.frame import FILE, common, faults, plugin_files, show, show_progress
from raceway.errors import PluginError, RacewayError
from raceway.framework.contracts import KINDS, plural
from raceway.framework.loading.registry import Registry, default_registry, registry_with
from raceway.framework.options import nearest
from raceway.scene.catalogue import preset as known
from raceway.scene.catalogue import preset_of
from raceway.scene.reading import options_class
from raceway.scene.tables import PLUGIN_TABLES, TABLES
from raceway.storage import array_cache
from raceway.storage.files import write_whole
from raceway.storage.tables import Tables


@click.command(short_help="List installed plug-ins and their options.")
@plugin_files
@common
def plugins(plugins: tuple[Path, ...], as_json: bool) -> int:
    """List every plug-in with its options; broken or shadowed ones are named (exit code 2).

    RACEWAY_DISABLE=NAME,... leaves plug-ins out; RACEWAY_PLUGINS=NAME,... loads exactly these.

    \b
    Example:
      raceway dev plugins --json
      raceway dev plugins --plugin my_law.py
    """
    from raceway.cli.schema import key_schema, keys

    registry, rows = registry_with(plugins), list[Tables]()
    for entry in registry.of_kind(*KINDS):
        options = [
            {"name": field.name, "default": key_schema(field).get("default")}
            | {word: field.metadata.get(word, "") for word in ("unit", "rule", "help")}
            for field in keys(entry.plugin)
        ]
        head = {word: getattr(entry, word) for word in ("kind", "name", "distribution", "version")}
        rows.append({**head, "options": options})
    errors = faults(registry)
    if as_json:
        print_json({"plugins": rows, "errors": [{"path": None, "value": None, "message": text} for text in errors]})
        return 2 if errors else 0
    parts: list[RenderableType] = []
    for kind in dict.fromkeys(row["kind"] for row in rows):
        parts.append(Text(plural(kind), style="bold"))
        for row in (r for r in rows if r["kind"] == kind):
            table = Table.grid(Column(min_width=20, no_wrap=True), Column(min_width=12), "", padding=(0, 2))
            for option in row["options"]:
                default = "" if option["default"] is None else str(option["default"])
                unit = f" [{option['unit']}]" if option["unit"] else ""
                table.add_row(escape(option["name"]), Words(default), Words(option["help"] + unit, "dim"))
            parts.append(Text.assemble("  ", (row["name"], "cyan"), f"  {row['distribution']} {row['version']}"))
            if row["options"]:
                parts.append(Padding(table, (0, 0, 0, 6)))
    show(rows, False, None, lambda: Group(*parts))
    if errors:
        raise RacewayError("\n  ".join(errors))
    return 0


@click.command(short_help="JSON schema of a scene.")
@common
def schema(as_json: bool) -> int:
    """Print the JSON schema (draft 2020-12) of a scene, for editors, with the options of every installed plug-in.

    \b
    Example:
      raceway dev schema > scene.schema.json
    """
    from raceway.cli.schema import scene_schema

    del as_json  # it is JSON either way
    print_json(scene_schema(default_registry()))
    return 0


@click.command("check-plugin", short_help="Test a plug-in against its contract.")
@click.argument("name", metavar="[KIND:]NAME")
@plugin_files
@common
def check_plugin(name: str, plugins: tuple[Path, ...], as_json: bool) -> int:
    """Run the conformance suite of a plug-in's kind: exit code 0 conforms, 1 does not, 2 unknown or ambiguous.

    \b
    Example:
      raceway dev check-plugin hertz
      raceway dev check-plugin contact_law:hunt_crossley
      raceway dev check-plugin my_law --plugin my_law.py
    """
    from raceway.testing import check_named

    with show_progress(waiting=f"checking {name}"):
        conformity = check_named(name, registry_with(plugins))
    table = Table.grid(Column(no_wrap=True), Column(no_wrap=True), "", padding=(0, 2))
    for row in conformity.rows:
        status = Text(row.status, style="green" if row.good else "bold red")
        table.add_row(escape(row.name), status, Words(f"{row.duty}: {row.message}" if row.message else row.duty, "dim"))
    good = sum(row.good for row in conformity.rows)
    verdict = "conforms" if conformity.conforms else "does not conform"
    title = f"{conformity.kind.replace('_', ' ')} '{conformity.name}' {verdict}: {good} of {len(conformity.rows)} checks"
    show(conformity.to_dict(), as_json, None, lambda: Group(Text(title, style="bold"), Padding(table, (0, 0, 0, 2))))
    return 0 if conformity.conforms else 1


_NEW_PLUGIN = f"""Write an installable package with a working plug-in of a KIND and its tests.

KIND: {", ".join(KINDS)}.

\b
Example:
  raceway dev new-plugin contact_law my_law
"""


@click.command("new-plugin", short_help="Write a package for a new plug-in.", help=_NEW_PLUGIN)
@click.argument("kind")
@click.argument("name")
@click.option("--out", type=click.Path(path_type=Path), default=Path("."), metavar="DIR", help="Parent folder [here].")
@common
def new_plugin_command(kind: str, name: str, out: Path, as_json: bool) -> int:
    folder = new_plugin(kind, name, out, default_registry())
    files = sorted(str(path) for path in folder.rglob("*") if path.is_file())
    steps = Text(f"next: pip install -e {folder} && python -m pytest {folder}", no_wrap=True, overflow="ignore")
    show({"folder": str(folder), "files": files}, as_json, None, lambda: Group(*file_lines([str(folder), *files]), steps))
    return 0


#: Compliances that are listed one by one; a study keeps thousands.
_SHOWN = 10


@click.command(short_help="List or clear the caches.")
@click.option("--clear", is_flag=True, help="Delete both; the next run compiles and condenses again.")
@common
def cache(clear: bool, as_json: bool) -> int:
    """List the caches of compiled kernels and of body compliances with size and last use, or clear them.  RACEWAY_CACHE_DIR moves them.

    \b
    Example:
      raceway dev cache --clear
    """
    from raceway.storage import kernel_cache as cache_folder

    with show_progress(waiting="looking through the caches"):
        if clear:
            cache_folder.clear()
            array_cache.clear()
        folders = [attrs.asdict(folder) for folder in cache_folder.kernel_folders()]
        arrays = [attrs.asdict(entry) for entry in array_cache.entries()]
    content = {
        "root": str(cache_folder.cache_root() / "kernels"),
        "current": cache_folder.source_key(),
        "folders": folders,
        "kernels": sum(f["kernels"] for f in folders),
        "bytes": sum(f["bytes"] for f in folders),
        "arrays_root": str(array_cache.folder()),
        "arrays": arrays,
        "arrays_bytes": sum(entry["bytes"] for entry in arrays),
        "arrays_limit_bytes": array_cache.LIMIT,
        "cleared": clear,
    }

    rows = [("Compiled kernels", "", f"in {content['root']}")]
    for folder in content["folders"]:
        extent = f"{folder['bytes'] / 2**20:.1f} MiB"
        rows.append((folder["name"], extent, f"{folder['kernels']} kernels{', current' if folder['current'] else ''}"))
    if not any(folder["current"] for folder in content["folders"]):
        rows.append((content["current"], "empty", "current: the next run compiles, which takes some 20 s of a processor"))
    total, most = content["arrays_bytes"] / 2**20, content["arrays_limit_bytes"] / 2**20
    rows.append(("Compliances of bodies", "", f"{total:.1f} of at most {most:.0f} MiB, in {content['arrays_root']}"))
    by_use = sorted(content["arrays"], key=lambda entry: -entry["used"])
    for entry in by_use[:_SHOWN]:
        last_use = datetime.fromtimestamp(entry["used"]).strftime("%Y-%m-%d %H:%M")
        remark = f"{entry['what']}; made in {entry['made_in_s']:.1f} CPU-s, used {last_use}"
        rows.append((entry["kind"], f"{entry['bytes'] / 2**20:.2f} MiB", remark))
    if len(by_use) > _SHOWN:
        rows.append(("", "", f"the {_SHOWN} last used of {len(by_use)}; all: raceway dev cache --json; by sort:"))
        for kind, count in sorted(Counter(entry["kind"] for entry in by_use).items()):
            extent = sum(entry["bytes"] for entry in by_use if entry["kind"] == kind) / 2**20
            rows.append((kind, f"{extent:.2f} MiB", f"{count} in all"))
    if not by_use:
        rows.append(("none", "empty", "a condensed bearing makes them in seconds"))
    show(content, as_json, None, lambda: sections(rows))
    return 0


#: Keys that a beginner decides on: value, and whether it stands there as a comment that can be taken in.
_KEYS: dict[str, dict[str, tuple[Any, bool]]] = {
    "bearing": {"arrangement": ("DB", True), "preload": ("200 N", True), "row_distance": ("16 mm", True)},
    "supports": {"tilt": ("locked", False)},
    "rotor": {"mass": (2.0, False)},
    "load": {"axial": (1000.0, False), "radial": ([0.0, 0.0], False)},
    "excitation": {"speed_rpm": (12000.0, False), "unbalance": ("320 g mm", False), "load_share": (1.0, False)},
    "contact": {"damping": (0.001, False), "friction": (0.05, True)},
    "integrator": {"turns": (12, True)},
}

#: The same of a bearing that brings its bodies, contacts and supports: cylindrical rollers carry no axial load.
_ROLLERS = {
    "bearing": {},
    "load": {"radial": ([2000.0, 0.0], False)},
    **{table: _KEYS[table] for table in ("rotor", "excitation", "integrator")},
}

#: Plug-ins by table, and what is said of them.
_KINDS = {
    "excitation": (
        "bidirectional",
        "rotating force; 'unidirectional': along one line.  Without this table the scene is static",
    ),
    "contact": ("hertz", "contact law; raceway dev plugins lists others"),
    "integrator": ("auto", "the steady orbit where one exists; 'newmark' and others integrate over time"),
}

_HEAD = """# A scene of Raceway: SI units, or text with a unit such as "1 kN".  Lines that begin with # are comments;
# every key with unit and default: docs/scene.md.  Validate: raceway check FILE
"""


@click.command("new-scene", short_help="Write a scene to start from.")
@click.argument("preset", default="B7206C")
@click.option("--out", type=FILE, metavar="FILE", help="File [PRESET.toml here].")
@common
def new_scene(preset: str, out: Path | None, as_json: bool) -> int:
    """Write a scene with comments: a bearing of the catalogue under load and unbalance.

    PRESET names the bearing [B7206C].

    \b
    Example:
      raceway dev new-scene
      raceway dev new-scene 7206A-NSK --out spindle.toml
      raceway dev new-scene NU206
    """
    if Path(preset).suffix == ".toml":
        raise RacewayError(f"`{preset}` is a file name; a bearing is expected: raceway dev new-scene B7206C --out {preset}")
    known(preset)
    file = Path(f"{re.sub(r'[^A-Za-z0-9-]+', '-', preset)}.toml") if out is None else out
    if file.exists():
        raise RacewayError(f"`{file}` exists: choose another file with --out, or remove it")
    write_whole(scene_text(preset, default_registry()).encode(), file)
    words = f"written: {file}\nnext:    raceway check {file}\n         raceway run {file}"
    show({"file": str(file)}, as_json, None, lambda: Text(words, no_wrap=True, overflow="ignore"))
    return 0


def scene_text(preset: str, registry: Registry) -> str:
    """The scene; what its comments say of a key is the key's own declaration."""
    entry = preset_of(preset)
    assert entry is not None
    lines = [_HEAD, f'title = "{entry.title}"', "", "[bearing]"]
    lines.append(f'preset = "{preset}"  # other keys of this table override it')
    for table, keys in (_ROLLERS if entry.other_tables else _KEYS).items():
        lines += [] if table == "bearing" else ["", f"[{table}]"]
        lines += list(_lines(table, keys, registry))
    return "\n".join(lines) + "\n"


def _lines(table: str, keys: dict[str, tuple[Any, bool]], registry: Registry) -> Iterator[str]:
    classes = [TABLES[table]] if table in TABLES else []
    if table in _KINDS:
        kind, words = _KINDS[table]
        classes.append(options_class(PLUGIN_TABLES[table][0], kind, registry))
        yield f'kind = "{kind}"  # {words}'
    fields = {field.name: field for cls in classes for field in attrs.fields(cls)}
    for key, (value, as_comment) in keys.items():
        about = fields[key].metadata
        unit = f"{about['unit']}: " if about["unit"] else ""
        yield f"{'# ' if as_comment else ''}{key} = {json.dumps(value)}  # {unit}{about['help']}"


_NAME = re.compile(r"[a-z][a-z0-9_]{1,39}")


def new_plugin(kind: str, name: str, folder: str | Path = ".", registry: Registry | None = None) -> Path:
    """Write a package ``folder/raceway-NAME`` with one plug-in, which passes its own tests at once.

    The templates are package data, ``data/templates/KIND``; a file package_x.py.txt becomes x.py in the package's folder, tests_x.py.txt
    a file in tests, the rest stands at the top.

    kind : of ``raceway.framework.contracts.KINDS``
    name : the word that a scene will write as ``kind``
    folder : where the package's own folder is made

    PluginError: An unknown kind, a name that cannot be used, or a folder that exists; nothing is written then.
    """
    kind = kind.replace("-", "_")
    if kind not in KINDS:
        raise PluginError(f"no kind of plug-in named '{kind}'{nearest(kind, KINDS)}; kinds: {', '.join(KINDS)}")
    if not _NAME.fullmatch(name) or name.endswith("_") or "__" in name:
        fitting = re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_0123456789")[:40]
        hint = f"; for instance '{fitting}'" if _NAME.fullmatch(fitting) else ""
        rule = "2 to 40 lower-case letters, digits and single underscores, a letter first"
        raise PluginError(f"'{name}' cannot be a plug-in's name: {rule}{hint}")
    if keyword.iskeyword(name) or keyword.issoftkeyword(name):
        raise PluginError(f"'{name}' cannot be a plug-in's name: it is a word of Python")
    for entry in (registry or default_registry()).entries.get((kind, name), []):
        reason = f"there is a {kind.replace('_', ' ')} '{name}' already, of {entry.distribution}: choose another name"
        raise PluginError(reason)
    words = {
        "kind": kind,
        "name": name,
        "module": f"raceway_{name}",
        "distribution": f"raceway-{name.strip('_').replace('_', '-')}",
        "cls": "".join(part.capitalize() for part in name.split("_")),
        "title": f"{'An' if kind[0] in 'aeiou' else 'A'} {kind.replace('_', ' ')} '{name}'",
        "hook": KINDS[kind][0],
        "version": ".".join(__version__.split(".")[:2]),
    }
    target = Path(folder) / words["distribution"]
    if target.exists():
        raise PluginError(f"`{target}` exists already and is not overwritten: choose another name or --out DIR")
    contents = {}
    for part in ("common", kind):
        for source in sorted(files("raceway").joinpath("data", "templates", part).iterdir(), key=lambda f: f.name):
            file = source.name.removesuffix(".txt")
            if file.startswith("package_"):
                file = f"{words['module']}/{file.removeprefix('package_')}"
            elif file.startswith("tests_"):
                file = f"tests/{file.removeprefix('tests_')}"
            contents[file] = Template(source.read_text(encoding="utf-8")).substitute(words)
    try:
        for path, text in contents.items():
            (target / path).parent.mkdir(parents=True, exist_ok=True)
            (target / path).write_text(text, encoding="utf-8")
    except OSError as why:
        raise PluginError(f"`{target}` cannot be written: {why.strerror or why}") from why
    return target
