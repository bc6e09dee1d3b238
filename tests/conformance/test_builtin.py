"""Every built-in plug-in passes the suite of its kind."""

import pytest

from raceway.extend import Registry
from raceway.testing import check

ENTRIES = list(Registry(third_party=False).all())
#: Whose own tests are quick.
DEAR = (
    "dask", "processes", "film", "elastic", "condensed", "cylindrical_rollers", "structured", "pictures", "periodic", "line", "hertz",
    "generalized_alpha", "central_difference", "measured", "unidirectional", "sine_fit", "impedance_fit", "order_tracking",
)  # fmt: skip
MARKS = {"gmsh": [pytest.mark.slow, pytest.mark.needs("gmsh")], **dict.fromkeys(DEAR, pytest.mark.slow)}


@pytest.mark.parametrize(
    "entry", [pytest.param(e, marks=MARKS.get(e.name, ())) for e in ENTRIES], ids=[f"{e.kind}:{e.name}" for e in ENTRIES]
)
def test_conforms(entry):
    conformity = check(entry)
    bad = [f"{row.name} ({row.status}): {row.message}" for row in conformity.rows if not row.good]
    assert conformity.conforms, "\n".join(bad)
    assert len(conformity.rows) >= 3


def test_every_kind_with_built_ins_is_there():
    assert {e.kind for e in ENTRIES} >= {"contact_law", "excitation", "integrator", "identifier"}
