"""Distributions with entry points, written into a folder on the path as an installer would."""

import importlib
import textwrap


class FakeSite:
    """A folder of installed distributions, visible to this process while a test runs."""

    def __init__(self, folder, monkeypatch):
        self.folder = folder
        monkeypatch.syspath_prepend(str(folder))
        for variable in ("RACEWAY_DISABLE", "RACEWAY_PLUGINS", "RACEWAY_TRACE"):
            monkeypatch.delenv(variable, raising=False)

    def install(self, distribution, source, version="1.0", entry=None):
        """A distribution with one module; its entry point is named like the distribution unless said otherwise."""
        entry = entry or distribution
        module = f"module_of_{distribution.replace('-', '_')}_{self.folder.name.replace('-', '_')}"
        (self.folder / f"{module}.py").write_text(textwrap.dedent(source))
        info = self.folder / f"{distribution.replace('-', '_')}-{version}.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {distribution}\nVersion: {version}\n")
        (info / "entry_points.txt").write_text(f"[raceway]\n{entry} = {module}\n")
        importlib.invalidate_caches()


#: A law that works, {name} and {cls} to be filled in.
LAW = """
import attrs
from typing import ClassVar
from raceway import hookimpl
from raceway.contact_laws.hertz import Hertz

@attrs.frozen
class {cls}(Hertz):
    name: ClassVar[str] = "{name}"

@hookimpl
def raceway_contact_laws():
    return [{cls}]
"""
