"""The conformance suite of identifiers: a known stiffness, mass and damping must come back from spoilt records."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from raceway.core.signals.identification import Identification
from raceway.storage.tables import Tables
from raceway.testing.signals import (
    DAMPING,
    FORCE,
    FREQUENCY,
    MASS,
    STIFFNESS,
    dynamic_stiffness,
    equilibrium_at_rest,
    model_of,
    synthetic_record,
)
from raceway.testing.suite import Suite, check_class, duty, require

if TYPE_CHECKING:
    from raceway.core.stepping.record import Record
    from raceway.framework.contracts import Identifier

#: (sense, direction [rad]) of the forces that are tried.
_FORCES = ((1, 0.0), (-1, 0.0), (0, 0.0), (0, 1.1))
#: Speeds of identifiers that need several, as multiples of ``FREQUENCY``.
_SPEEDS = (0.6, 0.8, 1.0, 1.2, 1.4)


class IdentifierSuite(Suite):
    """Duties of ``raceway.framework.contracts.Identifier``.

    Notes
    -----
    ``records`` is empty for identifiers that need the equilibrium only, one record for "record", and five records at
    different speeds, the schedule's turn being one period, for "speeds".  The excitation knows its phase.
    """

    kind = "identifier"

    @duty("attributes: needs, definition, options")
    def test_declaration(self, identifier: Identifier) -> None:
        check_class("identifier", identifier)
        known = {"record", "speeds", "equilibrium", "period", "phase"}
        needs = identifier.needs
        require(
            isinstance(needs, frozenset) and needs and needs <= known,
            f"`needs` = {needs!r}: a frozenset out of {sorted(known)}",
        )
        require(
            isinstance(identifier.definition, str) and len(identifier.definition) > 20, "`definition` must be a sentence"
        )

    @duty("an Identification with frequency, mass and force amplitude")
    def test_answer(self, identifier: Identifier) -> None:
        found = self._identify(identifier)
        require(isinstance(found, Identification), f"identify() returns {type(found).__name__}, not an Identification")
        require(
            abs(found.frequency_hz - FREQUENCY) < 1e-9 * FREQUENCY,
            f"frequency_hz = {found.frequency_hz:g}, not {FREQUENCY:g}",
        )
        require(abs(found.mass_used - MASS) < 1e-3 * MASS, f"mass_used = {found.mass_used:g} kg; the model says {MASS:g}")
        require(
            abs(found.force_amplitude - FORCE) < 1e-3 * FORCE,
            f"force_amplitude = {found.force_amplitude:g} N, not {FORCE:g}",
        )
        values = (found.forward_amplitude, found.backward_amplitude, found.orbit_major, found.orbit_minor)
        require(np.isfinite(values).all() and min(values) >= 0.0, "orbit amplitudes must be finite and not negative")

    @duty("recovers K, m and C from a clean record, for forces that turn forward, backward, or not")
    def test_clean(self, identifier: Identifier) -> str:
        return self._recovers(identifier, 1e-8)

    @duty("... with a mean and a drift of ten times the 1x amplitude")
    def test_drift(self, identifier: Identifier) -> str:
        # A Fourier line loses a ramp only as far as its slope is known from the turns' means.
        return self._recovers(identifier, 1e-3, mean=50.0, drift=10.0)

    @duty("... with 2x and 3x lines as large as the 1x")
    def test_harmonics(self, identifier: Identifier) -> str:
        # Short tracking windows that fit 1x and 2x only let some of 3x leak in at their ends.
        return self._recovers(identifier, 1e-3, harmonics=1.0)

    @duty("... with noise of a tenth of the 1x amplitude")
    def test_noise(self, identifier: Identifier) -> str:
        # 2160 samples at least: 0.1 sqrt(2 / 2160) = 0.3 %, three times that for safety.
        return self._recovers(identifier, 1e-2, noise=0.1)

    @duty("... with a window that is not whole turns")
    def test_window(self, identifier: Identifier) -> str:
        return self._recovers(identifier, 1e-3, turns=9.37, mean=3.0, harmonics=0.3)

    @duty("records and equilibrium are left untouched")
    def test_input_untouched(self, identifier: Identifier) -> None:
        records = self._records(identifier, {})
        before = [(r.displacement.copy(), r.force.copy()) for r in records]
        identifier.identify(records, equilibrium_at_rest(), model_of())
        for record, (x, f) in zip(records, before, strict=True):
            require(np.array_equal(record.displacement, x) and np.array_equal(record.force, f), "a record was changed")

    def _records(self, identifier: Identifier, spoilt: Tables) -> list[Record]:
        if "speeds" in identifier.needs:
            return [synthetic_record(frequency=r * FREQUENCY, seed=k, **spoilt) for k, r in enumerate(_SPEEDS)]
        return [synthetic_record(**spoilt)] if "record" in identifier.needs else []

    def _identify(self, identifier: Identifier, sense: int = 1, direction: float = 0.0, **spoilt: float) -> Identification:
        records = self._records(identifier, {"sense": sense, "direction": direction, **spoilt})
        return identifier.identify(records, equilibrium_at_rest(), model_of(sense, direction))

    def _recovers(self, identifier: Identifier, tolerance: float, **spoilt: float) -> str:
        if spoilt and not identifier.needs & {"record", "speeds"}:
            return "no record is used"
        w, wanted = 2.0 * np.pi * FREQUENCY, dynamic_stiffness()
        for sense, direction in _FORCES:
            found = self._identify(identifier, sense, direction, **spoilt)
            where = f"force of sense {sense}" + (f" along {np.degrees(direction):.0f} deg" if sense == 0 else "")
            off = abs(found.dynamic_stiffness - wanted) / abs(wanted)
            require(off < tolerance, f"{where}: Z is off by {100 * off:.3g} %, {100 * tolerance:g} % allowed")
            off = abs(found.equivalent_stiffness - STIFFNESS) / abs(wanted)
            require(off < tolerance, f"{where}: K = Re Z + m w^2 is off by {100 * off:.3g} %")
            # C is asked for to the same share of |Z|: the phase is what a record resolves.
            off = abs(found.equivalent_damping - DAMPING) * w / abs(wanted)
            require(off < tolerance, f"{where}: C = Im Z / w is off by {100 * off:.3g} % of |Z| / w")
        return ""
