"""NSK's catalogue of super-precision bearings: stiffness of DB/DF pairs of 7206C and 7206A against preload.

Frame: axial and radial.  Normalisation: a pair is twice the tangent of one row at an axial load equal to the preload, tilts
locked, and the scene of the pair itself; the catalogue's radial stiffness is a rounded factor times the axial one.  Tolerances: axial 4 % (7206C, to which the
conformity was fitted together with 7206A5) and 1 % (7206A, which was not in the fit); radial 8 %, since the factors have two
digits and hold for the whole catalogue.
"""

from __future__ import annotations

import pytest

from raceway.studies.verify.study import verify


@pytest.mark.parametrize(
    ("case", "axial", "radial", "preloads"),
    [("nsk-7206C-stiffness", 0.04, 0.08, 4), ("nsk-7206A-stiffness", 0.01, 0.08, 3)],
)
def test_stiffness_of_a_pair(case, axial, radial, preloads):
    found = verify(only=case)
    assert [row.tolerance for row in found.rows] == [axial, radial] * preloads * 2
    assert found.passed, [(row.quantity, row.error) for row in found.rows if not row.ok]
