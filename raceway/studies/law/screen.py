"""A contact law on the screen."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Group, RenderableType

from raceway.commands.screen import Words, rows_table, sections, written
from raceway.commands.screen.text import Row
from raceway.storage.tables import ReadTables

#: Part of the energy that passes through a cycle below which none is lost, but for rounding.
_ROUNDING = 1e-9


def law_screen(content: ReadTables, files: Sequence[str]) -> RenderableType:
    """The contact, the law beside Hertz', the cycle."""
    loop = content["cycle"]
    head = (
        f"{content['law']}: {content['race']} contact of ball {content['ball']}, {content['load']:.4g} N at an approach of "
        f"{1e6 * content['approach']:.4g} µm"
    )
    rows = [
        {
            "approach\nµm": f"{1e6 * row['approach']:.4g}",
            "force\nN": f"{row['force']:.5g}",
            "Hertz\nN": f"{row['hertz_force']:.5g}",
            "stiffness\nN/µm": f"{1e-6 * row['stiffness']:.5g}",
            "Hertz'\nN/µm": f"{1e-6 * row['hertz_stiffness']:.5g}",
            "damping\nN s/m": f"{row['damping']:.4g}",
        }
        for row in content["rows"]
    ]
    told: list[Row] = [
        ("Cycle", "", f"{loop['frequency']:.4g} Hz, {1e6 * loop['amplitude']:.4g} µm about the equilibrium"),
        ("stiffness K", f"{1e-6 * loop['stiffness']:.5g} N/µm", "in phase with the approach"),
        ("damping C", f"{loop['damping']:.4g} N s/m", "in phase with its rate"),
        ("energy lost", f"{1e6 * loop['energy']:.4g} µJ", _loss(content)),
        ("loss factor", f"{loop['loss_factor']:.3g}", "w C / K"),
    ]
    opens = [Words("the contact opens on the way")] if loop["opens"] else []
    return Group(
        Words(head, "bold"), Words(content["title"], "dim"), rows_table(rows), sections(told), *opens, *written(files)
    )


def _loss(content: ReadTables) -> str:
    loop = content["cycle"]
    passed = abs(loop["stiffness"]) * loop["amplitude"] ** 2
    if abs(loop["energy"]) > _ROUNDING * passed:
        return "a cycle" if content["dissipative"] else "a cycle, all by contact.damping"
    return "a cycle: dry, no damping is modelled"
