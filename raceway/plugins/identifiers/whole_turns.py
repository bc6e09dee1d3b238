"""Fourier lines are taken over whole turns: what a record holds beyond them is left out at its beginning."""

from __future__ import annotations

from typing import TYPE_CHECKING

import attrs

if TYPE_CHECKING:
    from raceway.core.stepping.record import Record


def whole_turns(record: Record) -> Record:
    """The last whole turns of a record; the record itself where it holds nothing else or less than one turn."""
    per_turn = record.schedule.steps_per_turn // record.schedule.stride
    length = len(record.time) // per_turn * per_turn
    if length in (0, len(record.time)):
        return record
    names = ("time", "displacement", "velocity", "force", "gap", "contact_force", "ball")
    return attrs.evolve(record, **{name: getattr(record, name)[-length:] for name in names})
