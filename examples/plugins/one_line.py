from pathlib import Path

import attrs

from raceway import hookimpl


@attrs.frozen
class OneLine:
    """The stiffness in one line of text."""

    name = "one_line"
    suffixes = (".txt",)
    of_results = True

    def write(self, folder, result):
        path = Path(folder) / "stiffness.txt"
        path.write_text(f"{result.identification.equivalent_stiffness:.6g} N/m\n", encoding="utf-8")
        return [path]


@hookimpl
def raceway_formats():
    return [OneLine]
