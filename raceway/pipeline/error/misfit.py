"""How far the K and C of several whirl speeds are from Z of the motions at those speeds, and at the scene's own."""

from __future__ import annotations

from math import pi

from raceway.bodies.equilibrium import Equilibrium
from raceway.bodies.model import Model
from raceway.core.signals.identification import Identification
from raceway.pipeline.simulate import simulate
from raceway.plugins.identifiers.fft_1x import Fft1x
from raceway.storage.tables import Tables

#: Relative difference of two speeds that are one.
_SAME = 1e-9
#: Misfit over |Z| above which K and C are told to describe no Z.
_MUCH = 0.05


def largest_misfit(model: Model, equilibrium: Equilibrium, found: Identification) -> tuple[float, float]:
    """Largest |Z - (K - m w^2 + j w C)| over |Z|, and the whirl speed [r/min] where it is.

    Notes
    -----
    Between and beyond the speeds of a fit nothing tells what Z does, a resonance included.  Where the scene's own whirl speed,
    whose Z and K are stated, is none of them, its motion is computed: spin and force are the same.  There the misfit is over
    the smaller one of both Z, so that it is an error of the stated one, too.

    Raises
    ------
    ConvergenceError, StabilityError
        No motion at the scene's own speed.
    """
    series = list(found.series)
    if all(abs(w / found.speed - 1.0) > _SAME for w, _ in series) and not model.traits.every_node:
        record = simulate(model, equilibrium).record
        series.append((found.speed, Fft1x().identify([record], equilibrium, model).dynamic_stiffness))
    sizes = []
    for w, z in series:
        fitted = complex(found.equivalent_stiffness - found.mass_used * w**2, w * found.equivalent_damping)
        scale = min(abs(z), abs(fitted)) if abs(w / found.speed - 1.0) <= _SAME else abs(z)
        sizes.append((abs(z - fitted) / scale, w * 30.0 / pi))
    return max(sizes)


def misfit_warnings(model: Model, error: Tables) -> list[str]:
    """Says where Z over the whirl speeds is not what K and C make of it."""
    size = error["identification"]
    if (
        model.scene.excitation is None
        or "speeds" not in model.scene.identifier.method.needs
        or size is None
        or size <= _MUCH
    ):
        return []
    return [
        f"Z is not of the form K - m w^2 + j w C over these whirl speeds (misfit {size:.2g} of |Z|; free tilts, gyroscopic moments, "
        "a resonance): K and C are those of no speed, take identifier 'fft_1x' at each"
    ]
