"""Picture of a contact law: force, stiffness and damping over the approach, and the loop of a cycle."""

from __future__ import annotations

from typing import TYPE_CHECKING

from raceway.plugins.reports.pictures import new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from raceway.studies.law.bench import LawBench

_OWN, _HERTZ, _FAINT = "#0b5fa5", "#555f6b", "#c8501e"


def draw(found: LawBench) -> Figure:
    """Four panels."""
    figure = new_figure(9.6, 7.2)
    (force, loop), (stiffness, damping) = figure.subplots(2, 2)
    micro, contact, motion = 1e6 * found.approach, found.contact, found.cycle
    force.plot(micro, found.force, color=_OWN, label=found.law)
    force.plot(micro, found.hertz_force, color=_HERTZ, linestyle="--", label="Hertz")
    rate = 1e3 * abs(motion.rate).max()
    for values, word, style in ((found.closing, "closing", "-"), (found.opening, "opening", ":")):
        force.plot(micro, values, color=_FAINT, linestyle=style, linewidth=0.9, label=f"{word} at {rate:.3g} mm/s")
    force.plot([1e6 * contact.approach], [contact.load], "o", color=_OWN, label="equilibrium")
    force.set(xlabel="approach [µm]", ylabel="force [N]", title="Force")
    stiffness.plot(micro, 1e-6 * found.stiffness, color=_OWN, label=found.law)
    stiffness.plot(micro, 1e-6 * found.hertz_stiffness, color=_HERTZ, linestyle="--", label="Hertz")
    stiffness.set(xlabel="approach [µm]", ylabel="stiffness [N/µm]", title="Stiffness at rest")
    damping.plot(micro, found.damping, color=_OWN, label=found.law)
    damping.set(xlabel="approach [µm]", ylabel="damping [N s/m]", title="Damping at rest")
    loop.plot(1e6 * motion.approach, motion.force, color=_OWN, label=f"{motion.frequency:.4g} Hz")
    loop.set(
        xlabel="approach [µm]", ylabel="force [N]",
        title=f"Cycle: {1e6 * motion.energy:.3g} µJ lost, K {1e-6 * motion.stiffness:.4g} N/µm, C {motion.damping:.3g} N s/m",
    )  # fmt: skip
    for panel in (force, stiffness):
        panel.legend(frameon=False, fontsize=8.5)
    figure.suptitle(
        f"{found.law}, {contact.race} contact of ball {contact.ball}: {found.title.partition(chr(10))[0]}", fontsize=10.5
    )
    return figure
