"""The picture of sensitivities: a panel of bars for each quantity, keys from the strongest down."""

from __future__ import annotations

from textwrap import wrap
from typing import TYPE_CHECKING

from raceway.plugins.pictures import new_figure
from raceway.storage.tables import ReadTables

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MORE, _LESS = "#0b5fa5", "#c8501e"
#: Keys at most, and influence over the largest one below which none is drawn.
_MOST, _LEAST = 14, 1e-3


def draw(content: ReadTables) -> Figure:
    """Bars of relative influence, per cent a quantity grows when a key grows by one per cent."""
    names = list(content["quantities"])
    keys = [
        key for key in content["keys"] if _largest(key, names) >= _LEAST * max(_largest(k, names) for k in content["keys"])
    ]
    keys = sorted(keys, key=lambda key: -_largest(key, names))[:_MOST]
    figure = new_figure(2.6 + 2.3 * len(names), 1.6 + 0.32 * max(len(keys), 3))
    panels = figure.subplots(1, len(names), sharey=True, squeeze=False)[0]
    for panel, name in zip(panels, names, strict=True):
        shares = [key["influence"].get(name, 0.0) for key in keys]
        colours = [_MORE if share >= 0.0 else _LESS for share in shares]
        panel.barh(range(len(keys)), shares, color=colours, height=0.66)
        panel.axvline(0.0, color="#555f6b", linewidth=0.8)
        reach = 1.55 * max((abs(share) for share in shares), default=1.0) or 1.0
        panel.set_xlim(-reach, reach)
        for place, share in enumerate(shares):
            if abs(share) >= _LEAST:
                side = "left" if share >= 0.0 else "right"
                panel.annotate(f"{share:+.2g}", (share, place), (3 if share >= 0.0 else -3, 0), textcoords="offset points", ha=side, va="center", fontsize=8)  # fmt: skip
        panel.set_title(name.replace("_", " "), fontsize=11)
        panel.set_xlabel("% per % of the key", fontsize=9)
        panel.set_yticks(range(len(keys)), [key["key"] for key in keys], fontsize=9)
        panel.set_ylim(len(keys) - 0.4, -0.6)
    figure.suptitle("\n".join(line for text in content["title"].splitlines() for line in wrap(text, 90)), fontsize=11)
    return figure


def _largest(key: ReadTables, names: list[str]) -> float:
    return max((abs(key["influence"].get(name, 0.0)) for name in names), default=0.0)
