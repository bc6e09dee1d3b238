"""Documents made from the program itself: ``python -m benchmarks.documents`` writes them.

docs/scene.md holds every key of a scene with unit, default, rule and meaning, read from the declarations that the
program checks scenes with (here).  README shows the scene examples/minimal.toml, the answer that ``raceway run`` prints of it,
and examples/k_over_speed.py (here).

commands  docs/command_line.md: the help of every command
versions  the table of docs/versions.md, from pyproject.toml
drawing   docs/pictures/parameters.svg: what the keys of [bearing] mean
promises  docs/pictures/stability.svg: from its report
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import attrs

from raceway.framework.registry import Registry
from raceway.scene.schema import keys
from raceway.scene.structure import table_of_list
from raceway.scene.tables import STUDY_TABLES, TABLES

ROOT = Path(__file__).resolve().parents[2]
SCENE = ROOT / "docs" / "scene.md"
README = ROOT / "README.md"
COMMANDS = ROOT / "docs" / "command_line.md"
VERSIONS = ROOT / "docs" / "versions.md"
DRAWING = ROOT / "docs" / "pictures" / "parameters.svg"
STABILITY = ROOT / "docs" / "pictures" / "stability.svg"
SHOWN = ROOT / "examples" / "minimal.toml"
EXAMPLE = ROOT / "examples" / "k_over_speed.py"
_SCENE = re.compile(r"(<!-- scene -->\n```toml\n)(.*?)(```\n<!-- /scene -->)", re.DOTALL)
_EXAMPLE = re.compile(r"(<!-- example -->\n```python\n)(.*?)(```\n<!-- /example -->)", re.DOTALL)
_SCREEN = re.compile(r"(<!-- screen -->\n```\n)(.*?)(```\n<!-- /screen -->)", re.DOTALL)

_HEAD = """# The scene file

One TOML file. SI units; a key that is not SI base says so in its name (`_rpm`, `_deg`). A missing table or key takes its
default; a key without default is required. A table with `kind` names a plug-in, and its other keys are that plug-in's own.
Every mistake is reported at once, each with its path, the value, the rule and the nearest valid name.

A number of a key that has a unit may be text with another unit of the same dimension: `axial = "1 kN"`,
`ball_diameter = "9.525 mm"`, `speed_rpm = "200 Hz"`, `radial = ["100 N", 0.0]`. It becomes a number in the key's unit while the
scene is read. Known are m, N, Pa, g, s, Hz and rad with the prefixes n, u (µ), m, c, k, M and G, and in, min, deg, r, rev, rpm and K;
products, quotients and powers are written as `N s/m`, `kg m2` or `N/mm^3`. In Python, quantities of pint are taken, too.

`raceway check SCENE` validates, `raceway dev schema` prints the same declarations as a JSON schema for editors, `--set
table.key=value` changes one key for one run. Made by `python -m benchmarks.documents` from the declarations in
`raceway/scene/bearing.py`, `raceway/scene/tables.py` and in the plug-ins; do not edit by hand.

`raceway dev new-scene` writes a scene with comments to start from.

![a bearing in section, along its axis, and pairs of rows, with the keys that say their measures](pictures/parameters.svg)

`title` is a string; by default the name of the file. What `--set` changes stands in its second line, by key, on screens,
pictures and pages, and in the name of the folder of the results, so that no run overwrites another's.
"""

#: Tables in the order in which people write them: with the kind of plug-in that each names.
_ORDER = (
    ("bearing", None),
    ("supports", None),
    ("rotor", None),
    ("load", None),
    ("excitation", "excitation"),
    ("bodies", "bodies"),
    ("mesh", "mesher"),
    ("contact", "contact_law"),
    ("lubricant", None),
    ("heat", None),
    ("kinematics", None),
    ("mounting", None),
    ("integrator", "integrator"),
    ("identifier", "identifier"),
)
_NOTES = {
    "bearing": "`preset` fills in a bearing of [the catalogue](catalogue.md); any other key overrides the preset's value. `balls.material` and "
    "`rings.material` take a material by name (`raceway catalogue --materials`). Without a preset "
    "the required keys and one of `contact_angle_deg`, `radial_clearance` have to be given.",
    "supports": "`outer_seat` and `inner_seat` are `rigid` for rigid bodies.",
    "excitation": "Without this table the scene is static and `identification` is null.",
    "bodies": "What deforms; `formulation` and `hourglass` belong to `elastic` bodies ([how they move](elastic_dynamics.md)).",
    "mesh": "How bodies become hexahedra. A run with rigid bodies has no mesh, elastic bodies need one; meshing by itself needs no other table than "
    "[bearing] and this one.",
    "lubricant": "The oil, given once for all that needs one: friction, life, heat, and the film law where `[contact]` has no oil keys. Left out, it is "
    "the oil of the film law.",
    "kinematics": "`gyroscopic` and `ring_growth` are hypotheses, and no default fits all bearings. What the others would change in K and kyy "
    "is in [`error.model`](physics.md#hypotheses-left-at-their-defaults) and beside K on the screen, as long as the scene does not state them: "
    'a key that is written, `gyroscopic = "none"` too, is a decision.',
    "mounting": "How rings are fitted and how warm they run, as given numbers: what that does to the grooves is added to the preload "
    "([sets](sets.md)).",
    "integrator": '`kind = "auto"` solves for [the steady orbit](periodic.md) (`periodic`) where the force repeats every turn and contacts have no '
    "memory, which is exact and costs least. `newmark` integrates over time where the force changes its speed or grows, with friction, laws with a "
    "memory, balls that orbit, or forces that are not compiled; also where `turns`, `steps_per_turn` or `start` is given, which a transient has. "
    "Where no steady orbit is found, or it is unstable, `newmark` is taken instead and a warning says so. `raceway plan` and the table `plan` of "
    "result.json say which and why. A comparison whose points would differ takes `newmark` at all of them.",
    "quantities": "Options of plug-ins that state numbers of a result, a table each: [life](life.md), [friction torque](friction.md).",
    "rig": "Read by `raceway study rig` and `raceway identify` ([the rig](rig.md)); a run takes no notice of it.",
    "heat": "Steady temperatures are computed ([a warm spindle](warm_spindle.md)): `mounting`'s temperatures and `lubricant.temperature_c` follow. Left out, they "
    "are given numbers.",
    "contact": "`discretisation` is `resultant` for rigid bodies, `nodal` for elastic ones; condensed bodies take both.",
}


def scene_page() -> str:
    """The text of docs/scene.md; third-party plug-ins of this installation are left out."""
    registry = Registry(third_party=False)
    parts = [_HEAD]
    for name, kind in _ORDER:
        parts.append(f"## [{name}]\n")
        if name in _NOTES:
            parts.append(_NOTES[name] + "\n")
        if name in TABLES:
            parts += _tables(TABLES[name], name)
        if kind is None:
            continue
        for entry in (e for e in registry.all() if e.kind == kind):
            sentence = (entry.plugin.__doc__ or "").strip().partition("\n\n")[0].replace("\n    ", " ")
            parts.append(f'### {name}.kind = "{entry.name}"\n\n{sentence}\n')
            parts += _tables(entry.plugin, name)
    parts += ["## [quantities]\n", _NOTES["quantities"] + "\n"]
    for entry in (e for e in registry.all() if e.kind == "quantity" and attrs.fields(e.plugin)):
        parts += [f"### [quantities.{entry.name}]\n", *_tables(entry.plugin, f"quantities.{entry.name}")]
    for name, cls in STUDY_TABLES.items():
        parts += [f"## [{name}]\n", _NOTES[name] + "\n", *_tables(cls, name)]
    return "\n".join(parts)


def _tables(cls: type, path: str) -> list[str]:
    rows, inner = [], []
    for field in keys(cls):
        if attrs.has(field.type):
            inner += [f"### [{path}.{field.name}]\n\n{field.metadata.get('help', '')}\n", *_tables(field.type, path)]
            continue
        if (listed := table_of_list(field.type)) is not None:
            inner += [f"### [[{path}.{field.name}]]\n\n{field.metadata.get('help', '')}\n", *_tables(listed, path)]
            continue
        cells = f"`{field.name}`", field.metadata.get("unit", ""), _default(field.default), field.metadata.get("rule", "")
        rows.append("| " + " | ".join((*cells, field.metadata.get("help", ""))) + " |")
    if not rows:
        return ["No keys of its own.\n", *inner]
    return ["\n".join(["| key | unit | default | rule | meaning |", "|---|---|---|---|---|", *rows]) + "\n", *inner]


def _default(value: Any) -> str:
    if value is attrs.NOTHING:
        return "required"
    if value is None:
        return ""
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    if isinstance(value, tuple):
        return f"`{list(value)}`"
    return f'`"{value}"`' if isinstance(value, str) else f"`{value:g}`"


def screen() -> str:
    """What ``raceway run examples/minimal.toml`` prints with warm caches, without the name of the folder."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "raceway", "run", str(SHOWN.relative_to(ROOT)), "--out", folder]
        environment = {**os.environ, "COLUMNS": "80", "NO_COLOR": "1"}
        for _ in range(2):
            done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT, env=environment)
    lines = [line.rstrip() for line in done.stdout.splitlines() if not line.startswith("written:")]
    return "\n".join(lines) + "\n"


def answer(shown: str) -> str:
    """What a reader of two minutes wants of a screen: title to damping, the error, the wall time; ... for the rest."""
    head, _, tail = shown.partition("Equilibrium under")
    return f"{head}...\n{tail[tail.index('Error and cost') :]}"


def with_screen(text: str, shown: str) -> str:
    """The README with its example, its scene and the answer on the screen of that scene replaced."""
    scene, example = SHOWN.read_text(encoding="utf-8"), EXAMPLE.read_text(encoding="utf-8")
    text = _EXAMPLE.sub(lambda match: match[1] + example + match[3], text)
    text = _SCENE.sub(lambda match: match[1] + scene + match[3], text)
    return _SCREEN.sub(lambda match: match[1] + answer(shown) + match[3], text)


def shown_scene(text: str) -> str:
    """The scene that a README shows."""
    found = _SCENE.search(text)
    return found[2] if found else ""


def shown_example(text: str) -> str:
    """The lines of Python that a README shows."""
    found = _EXAMPLE.search(text)
    return found[2] if found else ""


def shown_screen(text: str) -> str:
    """The part of a screen that a README shows."""
    found = _SCREEN.search(text)
    return found[2] if found else ""
