"""Change of stiffness by elastic rings and balls: ``raceway.bodies.elastic_change``, which needs no mesh, against condensed bodies."""

from __future__ import annotations

import raceway as rw
from benchmarks.checks import Row
from raceway.bodies.elastic_change import elastic_change

TITLE = "Elastic rings and balls against rigid ones"
COMMAND = "python -m benchmarks.checks elastic_change"
_BEARINGS = "608 6000 6200 628 6205 6008 6310 6220 6040 61808 61820 61908 61930 7000C 7014C 7032C 7206C 7220C 7206A 7914C 7904C 7914A5 7040A"
#: Axial loads over the static rating.
_LOADS = (0.005, 0.02, 0.08)


def rows() -> list[Row]:
    """Estimated over computed changes of kyy and kxx, least and largest of all bearings and loads."""
    ratios: dict[str, list[float]] = {"kyy": [], "kxx": []}
    for name in _BEARINGS.split():
        rating = rw.catalogue(name)[0].ratings["static_rating"]
        for load in _LOADS:
            scene = {"bearing": {"preset": name}, "load": {"axial": load * rating}}
            rigid, condensed = rw.run(scene), rw.run(scene | {"bodies": {"kind": "condensed"}})
            estimate, computed = elastic_change(rigid.model, rigid.equilibrium), condensed.to_dict()["model"]["elasticity"]
            assert not isinstance(estimate, str), estimate
            for axis, quantity in enumerate(("kxx", "kyy")):
                ratios[quantity].append(estimate[quantity] / computed[axis][axis])
    of_kyy, of_kxx = ((min(values), max(values)) for values in (ratios["kyy"], ratios["kxx"]))
    return [
        Row("estimated over computed change of kyy", "{:.3f} to {:.3f}".format(*of_kyy), "1 to 1.2", of_kyy[0] >= 1.0 and of_kyy[1] <= 1.2, COMMAND),
        Row("estimated over computed change of kxx", "{:.3f} to {:.3f}".format(*of_kxx), "1 to 2", of_kxx[0] >= 1.0 and of_kxx[1] <= 2.0, COMMAND),
    ]  # fmt: skip
