"""Table of ``raceway study article --bodies elastic``.  Prints nothing by itself."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Group, RenderableType

from raceway.commands.screen import Words, rows_table, written
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.article.elastic.words import gib, per_cent


def elastic_screen(content: ReadTables, files: Sequence[str]) -> RenderableType:
    """Pressures, differences from condensed bodies, balance of energy and cost of every run.

    Parameters
    ----------
    content : what ``--json`` prints;  files : what was written
    """
    rows = content["rows"]
    at_rest = [_rest_cells(row) for row in rows if row["phase"] == "static"]
    moving = [_motion_cells(row) for row in rows if row["phase"] == "motion"]
    cost = content["cost"]
    lines = [
        f"{row['phase']} {row['case']}, {row['bodies']} bodies: {row['status']}: {row['reason']}"
        for row in rows
        if row["reason"]
    ]
    lines += [f"elements of elastic bodies: {content['elements']}"] if content["elements"] else []
    end = f"{content['runs']} runs, {content['failed']} failed; {cost['wall_s']:.0f} s, {cost['cpu_s']:.0f} s of processor time"
    end += f"; {cost['reused']} rows taken from earlier" if cost["reused"] else ""
    return Group(
        Words(content["title"], "bold"),
        rows_table(at_rest, f"at rest: nodal peak pressure of the most loaded ball from Hertz's; Q (ball loads), x, y, kyy from {content['reference']} bodies"),
        rows_table(moving, f"{content['speed_rpm']:g} r/min, {content['turns']} turn{'s' if content['turns'] > 1 else ''} of {content['steps_per_turn']} steps; K, |Z| and w C over |Z| from {content['reference']} bodies"),
        *(Words(line, "magenta") for line in lines),
        Words(end, "dim"),
        *written(files),
    )  # fmt: skip


def _rest_cells(row: ReadTables) -> Tables:
    hertz, other = row.get("from_hertz") or {}, row.get("from_condensed") or {}
    return {
        "load N": f"{row['axial_n']:g}" + (f" + {row['radial_n']:g}" if row["radial_n"] else ""),
        "bodies": row["bodies"],
        "p in %": _percent((hertz.get("inner") or {}).get("most_loaded")),
        "p out %": _percent((hertz.get("outer") or {}).get("most_loaded")),
        "Q %": _percent(other.get("ball_loads")),
        "x %": _percent(other.get("x")),
        "y %": _percent(other.get("y")),
        "kyy %": _percent(other.get("kyy")),
        **_cost_cells(row),
    }


def _motion_cells(row: ReadTables) -> Tables:
    found, other = row.get("identified") or {}, row.get("from_condensed") or {}
    balance = row.get("energy_balance")
    return {
        "force": row["case"].split()[0],
        "bodies": row["bodies"],
        "K N/µm": "-" if not found else f"{1e-6 * found['k']:.2f}",
        "C N s/m": "-" if not found else f"{found['c']:.0f}",
        "|Z| N/µm": "-" if not found else f"{1e-6 * found['abs_z']:.2f}",
        "K %": _percent(other.get("k")),
        "wC %": _percent(other.get("wc")),
        "|Z| %": _percent(other.get("abs_z")),
        "energy": "-" if balance is None else f"{balance:.1e}",
        **_cost_cells(row),
    }


def _cost_cells(row: ReadTables) -> Tables:
    cost = row["cost"]
    return {"CPU s": f"{cost['cpu_s']:.1f}", "GiB": gib(cost)}


def _percent(part: float | None) -> str:
    """Per cent without the sign, which the head has."""
    return per_cent(part).removesuffix(" %")
