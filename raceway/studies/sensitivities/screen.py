"""The table of ``raceway sensitivities``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from raceway.framework.shown import read_in
from raceway.out.table import rows_table
from raceway.storage.tables import ReadTables

if TYPE_CHECKING:
    from rich.console import RenderableType

#: Influences below this part of the largest one are not shown, files have them.
_SHOWN = 1e-6


def sensitivities_screen(content: ReadTables, files: list[str]) -> RenderableType:
    """Keys in the order of their influence; below, what has none, what has no derivative, and the files."""
    from rich.console import Group
    from rich.text import Text

    quantities = content["quantities"]
    heads = []
    for name, one in quantities.items():
        value, unit = read_in(one["value"], one["unit"])
        heads.append(f"{name.replace('_', ' ')} {value:.5g} {unit}: {one['definition']}")
    rows = []
    for key in (one for one in content["keys"] if one["influence"]):
        row = {"key": key["key"], "value": f"{key['value']:.6g} {key['unit']}".strip()}
        for name in quantities:
            row[f"{name.replace('_', ' ')} [% per %]"] = _share(key, name)
        rows.append(row)
    lines = [f"warning: {text}" for text in content["warnings"]]
    lines += [f"cost: {_cost(content['cost'])}"]
    zero = [key["key"] for key in content["keys"] if not key["influence"]]
    lines += [f"0, so without a share; derivatives in the files: {', '.join(zero)}"] if zero else []
    rough: dict[str, list[str]] = {}
    for key in content["keys"]:
        if key["remark"]:
            rough.setdefault(key["remark"], []).append(key["key"])
    lines += [f"{', '.join(keys)}: {why}" for why, keys in rough.items()]
    if content["without_effect"]:
        lines.append(f"without effect: {', '.join(content['without_effect'])}")
    reasons: dict[str, list[str]] = {}
    for one in content["refused"]:
        reasons.setdefault(one["reason"], []).append(one["key"])
    lines += [f"no derivative by {', '.join(keys)}: {why}" for why, keys in reasons.items()]
    lines += [f"written: {', '.join(files)}"] if files else []
    title = "\n".join([content["title"], *heads])
    return Group(rows_table(rows, title), *(Text(line) for line in lines))


def _share(key: ReadTables, name: str) -> str:
    share = key["influence"].get(name)
    if share is None:
        return ""
    return "0" if abs(share) < _SHOWN else f"{share:+.3g}"


def _cost(cost: ReadTables) -> str:
    return f"{cost['gradients_s']:.2g} s beside {cost['run_s']:.2g} s of the run, {cost['models']} models built"
