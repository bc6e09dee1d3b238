"""Every code name in docs/glossary.md exists: as a key of a scene, a key of a result, or a name to import."""

from importlib import import_module
from pathlib import Path

import attrs
import pytest

from checks.validation.command_line import ARTICLE
from raceway import load_scene
from raceway.cli.schema import keys
from raceway.extend import Registry, run
from raceway.scene.tables import PLUGIN_TABLES, TABLES

DOCS = Path(__file__).parents[1] / "docs"
ROWS = [
    [cell.strip() for cell in line.strip("|").split(" | ")]
    for line in (DOCS / "glossary.md").read_text(encoding="utf-8").splitlines()
    if line.startswith("| ") and not line.startswith("| term")
]


def options(cls, path):
    """(key, words that the rule of the key names)."""
    for field in keys(cls):
        if attrs.has(field.type):
            yield from options(field.type, f"{path}.{field.name}")
        else:
            yield f"{path}.{field.name}", str(field.metadata.get("rule", ""))


@pytest.fixture(scope="module")
def scene_keys():
    registry = Registry(third_party=False)
    found = {key: rule for name, table in TABLES.items() for key, rule in options(table, name)}
    for table, (kind, _) in PLUGIN_TABLES.items():
        names = registry.names(kind)
        found |= {key: rule for name in names for key, rule in options(registry.find(kind, name).plugin, table)}
        found[f"{table}.kind"] = ", ".join(map(repr, names))
    return found


@pytest.fixture(scope="module")
def result_keys():
    def inside(value, path):
        yield path
        if isinstance(value, dict):
            for key, part in value.items():
                yield from inside(part, f"{path}.{key}" if path else key)
        elif isinstance(value, list) and value:
            yield from inside(value[0], f"{path}[]")

    return set(inside(run(load_scene(ARTICLE, ["integrator.turns=2"])).to_dict(), ""))


def can_be_imported(name):
    try:
        import_module(name)
    except ModuleNotFoundError:
        module, _, last = name.rpartition(".")
        if not module:
            return False
        try:
            place = import_module(module)
        except ModuleNotFoundError:
            module, _, cls = module.rpartition(".")
            place = getattr(import_module(module), cls)
        return hasattr(place, last) or last in {field.name for field in getattr(place, "__attrs_attrs__", ())}
    return True


def test_rows_have_four_cells_and_terms_stand_once():
    assert len(ROWS) > 60 and {len(row) for row in ROWS} == {4}
    terms = [row[0] for row in ROWS]
    assert len(terms) == len(set(terms))
    assert all(row[3].endswith(".") for row in ROWS)


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row[0])
def test_the_codes_name_exists(row, scene_keys, result_keys):
    name, _, value = row[2].strip("`").partition(" = ")
    if value:
        assert repr(value.strip('"')) in scene_keys[name]
    else:
        assert name in scene_keys or name in result_keys or (name.startswith("raceway.") and can_be_imported(name))
