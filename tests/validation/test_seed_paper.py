"""Lubricants 2026, 14(3), 128, section 3.3: the rotating force of the test rig, 7.1 g at 90 mm.

Frame: radial, as put out by the excitations' compiled kernels.  Normalisation: F0 = m e w^2 for the rotor, half of it for
each of two bearings.  Tolerance 1e-5: six printed digits.
"""

from __future__ import annotations

from raceway.studies.verify.study import verify


def test_force_and_frequency_of_both_excitations():
    found = verify(only="seed-unbalance")
    assert len(found.rows) == 2 * 4 * 3
    assert {row.tolerance for row in found.rows} == {1e-5}
    assert found.passed, [(row.quantity, row.error) for row in found.rows if not row.ok]
