"""Elliptic Hertz contact: Harris & Mindel (1973), Fig. 15, and Harris & Kotzalas, Essential Concepts, Table 6.1.

Fig. 15: the contact angle is the loaded one, and curvatures are taken at it; units in, lb, psi.  E = 29.0e6 psi is
inferred (the printed 2.96e7 psi is off by a constant factor).  Tolerance 5e-5: five printed digits.
Table 6.1: a*, b*, delta* are free of units; F(rho) is the curvature difference.  Tolerance 4e-4: the table's four digits and
its own numerical error.
"""

from __future__ import annotations

import pytest

from raceway.studies.verify.study import verify


@pytest.mark.parametrize(
    ("case", "tolerance", "numbers"), [("harris-mindel-1973-hertz-inner", 5e-5, 4), ("harris-table-6.1", 4e-4, 63)]
)
def test_ellipse(case, tolerance, numbers):
    found = verify(only=case)
    assert len(found.rows) == numbers
    assert {row.tolerance for row in found.rows} == {tolerance}
    assert found.passed, [(row.quantity, row.error) for row in found.rows if not row.ok]
