"""Parts of the uncertainty: elastic bodies without a mesh against condensed ones, default hypotheses inside the range of the others."""

import numpy as np

import raceway as rw
from checks.robustness import Row
from raceway.pipeline.uncertainty import elastic_change

_BEARINGS = "608 6000 6200 628 6205 6008 6310 6220 6040 61808 61820 61908 61930 7000C 7014C 7032C 7206C 7220C 7206A 7914C 7904C 7914A5 7040A"


def rows() -> list[Row]:
    """Estimated over computed changes of kyy and kxx, least and largest of all bearings and loads; the middle of hypotheses."""
    ratios: dict[str, list[float]] = {"kxx": [], "kyy": []}
    for name in _BEARINGS.split():
        for load in (0.005, 0.02, 0.08):  # over the static rating
            scene = {"bearing": {"preset": name}, "load": {"axial": load * rw.catalogue(name)[0].ratings["static_rating"]}}
            rigid, condensed = rw.run(scene), rw.run(scene | {"bodies": {"kind": "condensed"}})
            estimate, computed = elastic_change(rigid.model, rigid.equilibrium), condensed.to_dict()["model"]["elasticity"]
            for axis, (quantity, of_quantity) in enumerate(ratios.items()):
                of_quantity.append(dict(estimate)[quantity] / computed[axis][axis])
    elastic = [
        Row(f"elastic bodies: estimated over computed change of {quantity}", f"{min(found):.3f} to {max(found):.3f}",
            f"1 to {most:g}", min(found) >= 1.0 and max(found) <= most)
        for (quantity, found), most in zip(ratios.items(), (2.0, 1.2), strict=True)
    ]  # fmt: skip
    return [_hypotheses(), *elastic]


def _hypotheses() -> Row:
    """200 random bearings, loads, speeds (n d_m of 1e5 to 1.2e6 mm r/min) and tilts; a spread below 0.1 % has no ends."""
    presets = [entry for pattern in ("70*", "72*C", "79*") for entry in rw.catalogue(pattern)]
    draw, inside, spread = np.random.default_rng(51), 0, 0
    for _ in range(200):
        entry = presets[draw.integers(len(presets))]
        rpm = np.exp(draw.uniform(*np.log([1e5, 1.2e6]))) / (1e3 * entry.table["pitch_diameter"])
        axial = np.exp(draw.uniform(*np.log([0.004, 0.05]))) * entry.ratings.get("static_rating", 1e4)
        force = {"kind": "bidirectional", "speed_rpm": rpm, "amplitude": "constant", "force": 0.05 * axial}
        supports = {"tilt": str(draw.choice(["locked", "free"]))}
        scene = {"bearing": {"preset": entry.name}, "load": {"axial": axial}, "supports": supports, "excitation": force}
        low, high = rw.run(scene).model_spread[0]["equivalent_stiffness"]
        least = 0.02 * (high - low) if max(-low, high) >= 1e-3 else 0.0
        inside, spread = inside + (low <= -least and high >= least), spread + (least > 0.0)
    return Row("K inside its hypotheses, of 200", float(inside), f"196; {spread} spread", inside >= 196)
