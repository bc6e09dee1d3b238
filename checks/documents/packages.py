"""What packages declare: raceway/data/packages.json, by which one that is missing is named, and the typed stub of ``raceway``."""

import json
import tomllib
from importlib.metadata import entry_points
from pathlib import Path

import raceway
from raceway.extend import default_registry

FOLDER = Path(raceway.__file__).parent
PACKAGES, STUB = FOLDER / "data" / "packages.json", FOLDER / "__init__.pyi"
_HEAD = '"""Every public name, of ``raceway`` (names.pyi) and of its packages: made by ``python -m checks.documents``."""'


def declared() -> dict[Path, str]:
    """Files -> their texts."""
    packages, names = {}, dict[str, str]()
    for point in sorted(entry_points(group="raceway"), key=lambda point: point.name):
        if (distribution := getattr(point.dist, "name", "")) != f"raceway-{point.name}":
            continue
        plugin = point.load()
        own, commands = (getattr(plugin, f"raceway_{hook}", dict)() for hook in ("names", "commands"))
        listed = {about.name: f"{heading}: {about.summary}" for heading, several in commands.items() for about in several}
        listed |= {word: "" for several in commands.values() for about in several for word in about.aliases}
        plugins = [f"{entry.kind}:{entry.name}" for entry in default_registry().all() if entry.distribution == distribution]
        project = tomllib.loads((FOLDER.parent / "packages" / distribution / "pyproject.toml").read_text(encoding="utf-8"))
        needs = [word.partition("==")[0] for word in project["project"]["dependencies"] if word.startswith("raceway-")]
        packages[distribution] = {"names": own, "commands": listed, "plugins": sorted(plugins), "needs": needs}
        names |= {name: module for name, module in own.items() if "." not in name}
    own_names = (FOLDER / "names.pyi").read_text(encoding="utf-8").partition("\n")[2]
    further = "".join(f"from {module} import {name} as {name}\n" for name, module in sorted(names.items()))
    stub = f"{_HEAD}\n\n__version__: str\n{own_names.rstrip()}\n{further}"
    return {PACKAGES: json.dumps(packages, indent=1) + "\n", STUB: stub}
