"""Documents made from the program itself: ``python -m checks.documents`` writes them.

docs/scene.md holds every key of a scene with unit, default, rule and meaning, read from the declarations that the
program checks scenes with (here).  README shows the scene examples/minimal.toml, the answer that ``raceway run`` prints of it,
and examples/k_over_speed.py (here).

commands  docs/command_line.md: the help of every command
versions  the table of docs/installation.md, from pyproject.toml
reading   docs/pictures/reading.svg: the files that a run enters, in their order
drawing   docs/pictures/parameters.svg: what the keys of [bearing] mean
promises  docs/pictures/stability.svg: from its report
"""

import re
import tempfile
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

import attrs

from checks.validation.command_line import invoke, raceway
from raceway.cli.schema import keys
from raceway.extend import Registry
from raceway.scene.structure import table_of_list
from raceway.scene.tables import TABLES

ROOT = Path(__file__).resolve().parents[2]
SCENE = ROOT / "docs" / "scene.md"
README = ROOT / "README.md"
COMMANDS = ROOT / "docs" / "command_line.md"
VERSIONS = ROOT / "docs" / "installation.md"
DRAWING = ROOT / "docs" / "pictures" / "parameters.svg"
STABILITY = ROOT / "docs" / "pictures" / "stability.svg"
SHOWN = ROOT / "examples" / "minimal.toml"
EXAMPLE = ROOT / "examples" / "k_over_speed.py"
_SCENE = re.compile(r"(<!-- scene -->\n```toml\n)(.*?)(```\n<!-- /scene -->)", re.DOTALL)
_EXAMPLE = re.compile(r"(<!-- example -->\n```python\n)(.*?)(```\n<!-- /example -->)", re.DOTALL)
_SCREEN = re.compile(r"(<!-- screen -->\n```\n)(.*?)(```\n<!-- /screen -->)", re.DOTALL)

_HEAD = """# The scene file

One TOML file in SI units; other units are in the key's name (`_rpm`, `_deg`). A missing key takes its default. `kind` names a plug-in,
to which the other keys of its table belong. All mistakes are reported at once, with key, value, rule and nearest valid name.

Values may be text with a unit: `axial = "1 kN"`, `ball_diameter = "9.525 mm"`, `speed_rpm = "200 Hz"`, `radial = ["100 N", 0.0]`. Units:
m, N, Pa, J, W, g, s, Hz, rad with prefixes n, u (µ), m, c, k, M, G; in, lb, oz, lbf, psi, min, deg, r, rev, rpm, K; combined as
`N s/m`, `oz in`, `N/mm^3`; in Python also quantities of pint.

| command | |
|---|---|
| `raceway dev new-scene` | writes a scene with comments |
| `raceway check SCENE` | validates |
| `raceway dev schema` | prints a JSON schema for editors |
| `--set table.key=value` | changes a key for one run; title and result folder state it |

![a bearing in section, along its axis, and pairs of rows, with the keys of their dimensions](pictures/parameters.svg)

`title` is a string; default: the file's name. `python -m checks.documents` makes this page from the program's declarations.
"""

#: Tables in the order in which people write them: with the kind of plug-in that each names.
_ORDER = (
    ("bearing", None), ("supports", None), ("rotor", None), ("load", None), ("excitation", "excitation"),
    ("bodies", "bodies"), ("mesh", "mesher"), ("contact", "contact_law"), ("lubricant", None), ("heat", None),
    ("kinematics", None), ("mounting", None), ("integrator", "integrator"), ("identifier", "identifier"),
)  # fmt: skip
_NOTES = {
    "bearing": "`preset` names a bearing of [the catalogue](catalogue.md). Without it the required keys and `contact_angle_deg` or "
    "`radial_clearance` are needed. `raceway catalogue --materials` lists materials.",
    "supports": "With rigid bodies both seats are `rigid`.",
    "excitation": "Without this table the scene is static and `identification` is null.",
    "bodies": "Deformable parts; elastic bodies [at rest](elastic.md), [in motion](elastic_dynamics.md).",
    "mesh": "Hexahedra ([meshes](mesh.md)): required by elastic bodies, ignored by rigid ones.",
    "lubricant": "The oil of friction, life, heat and of a film law without oil keys; default: the oil of the film law.",
    "kinematics": "`raceway plan` says what 'auto' stands for and why; what the other words would change is "
    "[`error.model`](physics.md#hypotheses-left-open).",
    "mounting": "Fits and temperatures, which change the preload ([sets](sets.md)).",
    "integrator": "`auto` solves for [the steady orbit](periodic.md) (`periodic`) where the force repeats every turn, and uses `newmark` for "
    "forces of changing speed or size, friction, laws with memory, orbiting balls, forces that are not compiled, where `turns`, "
    "`steps_per_turn` or `start` is set, and, with a warning, where no stable orbit is found. `raceway plan` and `plan` in "
    "result.json state choice and reason. A comparison uses one integrator at all points.",
    "quantities": "Options of [life](life.md), [friction torque](friction.md) and plug-ins.",
    "rig": "For `raceway study rig` and `raceway identify` ([the rig](rig.md)); ignored by `raceway run`.",
    "heat": "Computes the steady temperatures of `mounting` and `lubricant.temperature_c` ([a warm spindle](warm_spindle.md)). "
    "Conductances: 'auto' is a correlation, 'infinite' equal temperatures.",
    "contact": "Rigid bodies take `resultant` only.",
}


def scene_page() -> str:
    """The text of docs/scene.md; third-party plug-ins of this installation are left out."""
    registry, shown = Registry(third_party=False), dict[str, tuple[str, str]]()
    parts = [_HEAD]
    for name, kind in _ORDER:
        parts.append(f"## [{name}]\n")
        if name in _NOTES:
            parts.append(_NOTES[name] + "\n")
        if name in TABLES:
            parts += _tables(TABLES[name], name, f"[{name}]", shown)
        if kind is None:
            continue
        for entry in registry.of_kind(kind):
            sentence = (entry.plugin.__doc__ or "").strip().partition("\n\n")[0].replace("\n    ", " ")
            parts.append(f'### {name}.kind = "{entry.name}"\n\n{sentence}\n')
            parts += _tables(entry.plugin, name, f"`{entry.name}`", shown)
    parts += ["## [quantities]\n", _NOTES["quantities"] + "\n"]
    for entry in (e for e in registry.of_kind("quantity") if attrs.fields(e.plugin)):
        path = f"quantities.{entry.name}"
        parts += [f"### [{path}]\n", *_tables(entry.plugin, path, f"[{path}]", shown)]
    for name, place in registry.mapping("raceway_tables").items():
        parts += [f"## [{name}]\n", _NOTES[name] + "\n", *_tables(resolve_name(place), name, f"[{name}]", shown)]
    return "\n".join(parts)


def _tables(cls: type, path: str, title: str, shown: dict[str, tuple[str, str]]) -> list[str]:
    """Tables of a class and of those in it; a row that another table has, by ``shown``, is named with that table's title."""
    rows, same, inner = [], dict[str, list[str]](), list[tuple[str, str, type]]()
    for field in keys(cls):
        listed = table_of_list(field.type)
        if (table := field.type if attrs.has(field.type) else listed) is not None:
            name = f"[[{path}.{field.name}]]" if listed else f"[{path}.{field.name}]"
            inner.append((name, field.metadata.get("help", ""), table))
            continue
        key, unit = f"`{field.name}`", field.metadata.get("unit", "")
        name, default = f"{key} [{unit}]" if unit else key, _default(field.default)
        allowed, words = _range(field.metadata.get("rule", "")), field.metadata.get("help", "")
        other, first = shown.setdefault(f"{name} {allowed} {words}", (title, default))
        if other == title or default not in ("", first):
            rows.append(f"| {name} | {'; '.join(filter(None, (default, allowed)))} | {words} |")
        else:
            same.setdefault(other if default == first else f"{other}, whose value is the default", []).append(key)
    parts = ["\n".join(["| key | default; range | meaning |", "|---|---|---|", *rows]) + "\n"] if rows else []
    parts += [f"As {other}: {', '.join(names)}.\n" for other, names in same.items()]
    parts = parts or ["No keys.\n"]
    for name, words, table in inner:
        parts += [f"### {name}\n\n{words}\n", *_tables(table, path, name, shown)]
    return parts


#: Words of a rule and their signs, in this order.
_SIGNS = (
    (r"^a finite number$|^one of ", ""), (r"\bor a number (greater|from|at least)", r"or \1"),
    (r" and less than (?=[\d.-])", ", <\u2009"), (r"\bgreater than (?=[\d.-])", ">\u2009"),
    (r"\bat least (?=[\d.-])", "\u2265\u2009"), (r"\bfrom ([\d.e-]+) to ([\d.e+-]+)", "\\1\u2026\\2"),
)  # fmt: skip


def _range(rule: str) -> str:
    """A rule of the declarations in signs."""
    for words, sign in _SIGNS:
        rule = re.sub(words, sign, rule)
    return rule


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
        invoke("run", SHOWN, "--out", folder)  # compiles, where the caches are cold
        done = raceway("run", SHOWN.relative_to(ROOT), "--out", folder, cwd=ROOT, COLUMNS=80, NO_COLOR=1)
    done.check_returncode()
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


def shown_parts(text: str) -> list[str]:
    """The scene, the lines of Python and the part of a screen that a README shows; empty where it has none."""
    return [found[2] if (found := part.search(text)) else "" for part in (_SCENE, _EXAMPLE, _SCREEN)]
