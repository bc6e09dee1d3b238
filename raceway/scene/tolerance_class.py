"""Tolerance classes by name: of bearings (ISO 492, ABEC) and of balls (ISO 3290), as ranges of a scene's keys.

Notes
-----
A class limits the boundary dimensions and the running accuracy of rings; nothing in it limits grooves, contact angles or clearances.  What
changes contacts are the fits: a bore may lie below its nominal diameter by the class's deviation of the mean bore, which tightens the fit
on the shaft, an outside diameter likewise, which loosens the one in the housing.  The scene's interferences are those of rings without
deviation.  Widths and run-outs are left out.  A ball grade limits the variation of the mean diameters in a lot.

References
----------
ISO 492, deviations of the mean bore and outside diameter in a single plane, as makers and dealers print them: bores of Normal, 6 and 5 at
gld-bearing.com, wd-bearing.com; outside diameters of Normal and 6 in NTN, Ball and Roller Bearings, table 7; class 5 at nodeshk.com; 4 (ABEC 7)
at manv.in; 2 (ABEC 9) at loyal.sg; sizes that were found there only.  Names of classes: ABMA standard 20.  ISO 3290-1:2014, variation of the ball
lot diameter, at rgpballs.com.
"""

from __future__ import annotations

from raceway.errors import SceneError
from raceway.framework.options import nearest
from raceway.scene.scene import Scene

#: Keys of the table [tolerances] that are names, no paths.
NAMES = ("class", "balls")
#: (over, up to and including [mm], deviation [µm]) of the mean bore diameter by class, and of the outside diameter; upper deviation 0.
_EDGES = (2.5, 10.0, 18.0, 30.0, 50.0, 80.0, 120.0, 150.0, 180.0, 250.0, 315.0)
_BORE = {
    "Normal": (8.0, 8.0, 10.0, 12.0, 15.0, 20.0, 25.0, 25.0, 30.0, 35.0),
    "P6": (7.0, 7.0, 8.0, 10.0, 12.0, 15.0, 18.0, 18.0, 22.0),
    "P5": (5.0, 5.0, 6.0, 8.0, 9.0, 10.0, 13.0, 13.0, 15.0, 18.0),
    "P4": (4.0, 4.0, 5.0, 6.0, 7.0),
    "P2": (2.5, 2.5, 2.5, 2.5, 4.0, 5.0, 7.0, 7.0),
}
_OUTER_EDGES = (18.0, 30.0, 50.0, 80.0, 120.0, 150.0, 180.0, 250.0, 315.0, 400.0)
_OUTER = {
    "Normal": (9.0, 11.0, 13.0, 15.0, 18.0, 25.0, 30.0, 35.0, 40.0),
    "P6": (8.0, 9.0, 11.0, 13.0, 15.0, 18.0, 20.0, 25.0, 28.0),
    "P5": (6.0, 7.0, 9.0, 10.0, 11.0, 13.0, 15.0, 18.0, 20.0),
    "P4": (5.0, 6.0, 7.0, 8.0, 9.0),
    "P2": (4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 8.0),
}
_ALSO = {"P0": "Normal", "ABEC 1": "Normal", "ABEC 3": "P6", "ABEC 5": "P5", "ABEC 7": "P4", "ABEC 9": "P2"}
#: Grade -> variation of the ball lot diameter [µm].
_BALLS = {
    "G3": 0.13, "G5": 0.25, "G10": 0.5, "G16": 0.8, "G20": 1.0, "G24": 1.2, "G28": 1.4, "G40": 2.0, "G60": 3.0, "G100": 5.0,
    "G200": 10.0,
}  # fmt: skip


def ranges_of(scene: Scene, key: str, name: str) -> dict[str, tuple[float, float]]:
    """Path -> how far the number at it may lie below and above the scene's [m].

    Parameters
    ----------
    key : one of ``NAMES``;  name : such as "P4", "ABEC 7" or "G5"

    Raises
    ------
    SceneError
        No such name; a size that the class's table does not have; a class that changes nothing, or that leaves a ring loose.
    """
    if key == "balls":
        variation = 1e-6 * _BALLS[_known(key, name, [*_BALLS])]
        return {"bearing.ball_diameter": (0.5 * variation, 0.5 * variation)}
    known = _known(key, name, [*_BORE, *_ALSO])
    known, warm, found = _ALSO.get(known, known), scene.mounting, {}
    if warm.shaft_interference > 0.0:
        bore = _deviation(key, name, "bore", scene.bearing.bore, _EDGES, _BORE[known])
        found["mounting.shaft_interference"] = (0.0, bore)
    if warm.housing_interference > 0.0:
        outer = _deviation(key, name, "outer_diameter", scene.bearing.outer_diameter, _OUTER_EDGES, _OUTER[known])
        if outer >= warm.housing_interference:
            why = (
                f"leaves outer rings loose: their diameter may be {1e6 * outer:.3g} µm smaller, the fit has "
                f"{1e6 * warm.housing_interference:.3g} µm. Take a tighter one, or give tolerances of the fits by their keys"
            )
            raise SceneError.at(key, name, why)
        found["mounting.housing_interference"] = (outer, 0.0)
    if not found:
        why = (
            "changes nothing here: a class limits bore and outside diameter, which act through fits, and the scene has none. Give "
            "mounting.shaft_interference or mounting.housing_interference, or leave it out"
        )
        raise SceneError.at(key, name, why)
    return found


def _known(key: str, name: str, names: list[str]) -> str:
    if name not in names:
        raise SceneError.at(key, name, f"must be one of {', '.join(names)}{nearest(name, names)}")
    return name


def _deviation(
    key: str, name: str, dimension: str, size: float | None, edges: tuple[float, ...], values: tuple[float, ...]
) -> float:
    """Of a dimension [m], in metres."""
    millimetres = 1e3 * (size or 0.0)
    for low, high, value in zip(edges, edges[1:], values, strict=False):
        if low < millimetres <= high:
            return 1e-6 * value
    why = f"has no value here for bearing.{dimension} = {millimetres:g} mm: its table goes from {edges[0]:g} to {edges[len(values)]:g} mm"
    raise SceneError.at(key, name, f"{why}. Give tolerances of the fits by their keys")
