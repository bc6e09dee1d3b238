"""Picture of a contact law: force, stiffness and damping over the approach, and the loop of a cycle."""

from __future__ import annotations

from typing import TYPE_CHECKING

from raceway.plugins.pictures import new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from raceway.points.law import LawCurves

_OWN, _HERTZ, _MOVING = "#0b5fa5", "#555f6b", "#c8501e"


def draw(found: LawCurves) -> Figure:
    """Four panels."""
    figure = new_figure(9.6, 7.2)
    (force, loop), (stiffness, damping) = figure.subplots(2, 2)
    micro, contact, motion = 1e6 * found.approach, found.contact, found.cycle
    for panel, still, hertz, unit in ((force, found.force, found.hertz_force, 1.0), (stiffness, found.stiffness, found.hertz_stiffness, 1e-6)):  # fmt: skip
        panel.plot(micro, unit * still[0], color=_OWN, label=f"{found.law} at rest")
        panel.plot(micro, unit * hertz, color=_HERTZ, linestyle="--", label="Hertz")
    damped = bool((found.force != found.force[0]).any())
    for k, word, style in ((1, "closing", "-"), (2, "opening", ":")) if damped else ():
        label = f"{word} at {1e3 * abs(found.rate[k]):.3g} mm/s"
        for panel, values in ((force, found.force), (damping, found.damping)):
            panel.plot(micro, values[k], color=_MOVING, linestyle=style, linewidth=0.9, label=label)
    damping.plot(micro, found.damping[0], color=_OWN, label="at rest" if damped else found.damping_origin)
    if not damped:
        damping.set_ylim(0.0, 1.0)
    force.plot([1e6 * contact.approach], [contact.load], "o", color=_OWN, label="equilibrium")
    loop.plot(1e6 * motion.approach, motion.force, color=_OWN)
    force.set(ylabel="force [N]", title="Force")
    stiffness.set(ylabel="stiffness [N/µm]", title="Stiffness at rest")
    damping.set(ylabel="damping [N s/m]", title="Damping, the force's derivative by the rate")
    loop.set(
        ylabel="force [N]",
        title=f"Cycle at {motion.frequency:.4g} Hz: {1e6 * motion.energy:.3g} µJ lost, C {motion.damping:.4g} N s/m",
    )
    for panel in (force, stiffness, damping, loop):
        panel.set_xlabel("approach [µm]")
    for panel in (force, stiffness, damping):
        panel.legend(frameon=False, fontsize=8.5)
    figure.suptitle(
        f"{found.law}, {contact.race} contact of ball {contact.ball}: {found.title.partition(chr(10))[0]}", fontsize=10.5
    )
    return figure
