"""``raceway dev new-scene``: a scene with comments to start from.  Part of ``raceway.cli.main``."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import attrs
import click

from raceway.cli.frame import FILE, common, show
from raceway.errors import RacewayError
from raceway.framework.registry import Registry, default_registry
from raceway.scene.reading import options_class
from raceway.scene.tables import PLUGIN_TABLES, TABLES
from raceway.storage.files import write_whole

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
    from rich.text import Text

    from raceway.scene.catalogue import preset as known

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
    from raceway.scene.catalogue import preset_of

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
