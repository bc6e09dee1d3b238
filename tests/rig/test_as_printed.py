"""The shaft correction as the article prints it: its formula, and the beam that it equals for twice the span."""

from __future__ import annotations

from math import pi

import pytest

from raceway.studies.rig.as_printed import critical_speed, readings
from tests.rig.conftest import SPEED

#: A 1x line at the sensor [m].
LINE = 12e-6 + 1e-6j


def bow(reading, rig, force: float, held) -> float:
    """Deflection that a reading takes off the line [m]."""
    return (LINE - force / complex(reading.stiffness - held.mass * SPEED**2, reading.damping * SPEED)).real


def test_the_printed_formula_is_the_article_s_and_with_twice_the_span_timoshenko_s_beam(rig, held):
    found = {one.correction: one for one in readings(rig, held, SPEED, LINE)}
    whole, a, span = rig.unbalance * SPEED**2, rig.sensor_distance, rig.span
    bending = rig.young * pi / 64.0 * rig.shaft_diameter**4
    grown = 1.0 / (1.0 - (SPEED / critical_speed(rig, held)) ** 2)
    printed = whole * a * (3.0 * span**2 - 16.0 * a**2) / (192.0 * bending)
    # Timoshenko: P a (3 L^2 - 4 a^2) / (48 E I) at a from the support of a simply supported beam of span L.
    beam = whole * a * (3.0 * span**2 - 4.0 * a**2) / (48.0 * bending)
    assert bow(found["as printed"], rig, 0.5 * whole, held) == pytest.approx(grown * printed, rel=1e-9)
    assert bow(found["as printed, with L twice the span"], rig, 0.5 * whole, held) == pytest.approx(grown * beam, rel=1e-9)
    assert bow(found["none"], rig, 0.5 * whole, held) == pytest.approx(0.0, abs=1e-15)
