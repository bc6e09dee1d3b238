"""Rows of a curve over speed, load or tilt stiffness: by the compiled loop where that decides, else by runs that continue each other."""

from collections.abc import Sequence
from contextlib import suppress

import numpy as np

from raceway import ConvergenceError, Function, RacewayError, Result, function, scene_from_dict
from raceway.extend import (
    ERROR, FAILED, FORCE_AMPLITUDE, OF_ORBITS, Attractor, K, Registry, Status, Tables, Z, attractor_beside_run,
    attractor_from_rest, lasting, run, without_mesh,
)  # fmt: skip

#: Turns of the motion that is integrated where no ring stays on a steady one; half of them are judged.
TURNS = 800
#: What a row has of the compiled loop, and what decides whether that is the motion of a run: one whose stiffness changes by less than
#: this part of its mean has no other motion beside it (of 1296 points in the study, two have one from a change of 0.11 on).
_LOOPED = {"k": K.name, "abs_z": Z.name, "force_n": FORCE_AMPLITUDE.name, "error": ERROR.name}
_LINEAR = 0.1


def failure(why: RacewayError) -> Tables:
    """Status of a run that ended with an error, and the reason in one line."""
    return {"status": why.status, "reason": " ".join(str(why).split())}


def rows_of_curve(points: Sequence[Tables], registry: Registry) -> list[Tables]:
    """One row a point, in order; a run that fails or is refused becomes a row with its reason.

    As in a run-up each motion is continued from that at the speed before, stable or not, and over several tilt stiffnesses from that at
    the one before; where that does not lead on, it is searched for.
    Where it is unstable, or none is found, ``instead`` states what a ring does, by time integration: from beside that motion, or from rest.
    With friction the orbit of another start is the motion without it at the same point, where that was run.

    points : tables of scenes that differ in axial load, speed and tilt stiffness; those with friction last
    """
    steady = [tables for tables in points if tables["integrator"]["kind"] == "periodic"]
    rows: list[Tables | None] = [*(_looped(steady, registry) if steady else []), *[None] * (len(points) - len(steady))]

    supports, without_friction = [tables["supports"] for tables in points], dict[tuple[float, float, int], Result | None]()

    def place(k: int) -> tuple[float, float, int, bool]:
        load, speed = points[k]["load"]["axial"], points[k]["excitation"]["speed_rpm"]
        return load, speed, supports.index(supports[k]), k >= len(steady)

    looped, near, before = {k for k, row in enumerate(rows) if row}, None, 0
    same = 1 if all(one == supports[0] for one in supports) else 2  # over stiffness: at the same speed
    for k in sorted(range(len(points)), key=place):
        at, follows = place(k)[:3], place(before)[:same] == place(k)[:same]
        near = near if follows else None
        if k in looped:
            before, near = k, None
        elif k >= len(steady):
            rows[k], _ = _point_row(points[k], registry, without_friction.get(at))
        else:
            if follows and before in looped:  # the motion that the compiled loop found there, where a run finds it, too
                near = None
                with suppress(RacewayError):
                    near = run(scene_from_dict(points[before], registry), registry, stay=True)
            row, result = _point_row(points[k], registry, near)
            rows[k], before, without_friction[at] = row, k, result
            near = result if row["status"] == Status.COMPLETED or row.get("found") == "directly" else near
    return [row for row in rows if row]


def _looped(points: Sequence[Tables], registry: Registry) -> Sequence[Tables | None]:
    """Rows of steady orbits that a compiled loop finds, that are not unstable, and beside which there is no other one; None elsewhere."""
    f, numbers = loop_of(points, registry)
    if f is None:
        return [None] * len(points)
    answer = f.looped(numbers)
    multiplier, change = (answer[name] for name in OF_ORBITS)
    return [
        {
            "speed_rpm": tables["excitation"]["speed_rpm"], "axial_n": tables["load"]["axial"], "status": Status.COMPLETED,
            "reason": "", "found": "directly", "mesh_error": None, **{key: float(answer[name][point]) for key, name in _LOOPED.items()},
        }
        if lasting(multiplier[point]) and change[point] <= _LINEAR
        else None
        for point, tables in enumerate(points)
    ]  # fmt: skip


def loop_of(points: Sequence[Tables], registry: Registry) -> tuple[Function | None, dict[str, np.ndarray]]:
    """The compiled loop of a curve, None where it has none or states no error of a mesh, and what varies along the curve."""
    paths = {"load.axial": "axial", "excitation.speed_rpm": "speed_rpm", "supports.tilt": "tilt"}
    columns = {key: [tables[key.partition(".")[0]][name] for tables in points] for key, name in paths.items()}
    numbers = {key: np.array(column, dtype=float) for key, column in columns.items() if not isinstance(column[0], str)}
    try:
        f = function(scene_from_dict(points[0], registry), numbers, [*_LOOPED.values(), *OF_ORBITS], threads=1)
    except RacewayError:  # its row says why
        return None, numbers
    return (None if f.why_slow or not f.contacts_alone else f), numbers


def _point_row(tables: Tables, registry: Registry, near: Result | None) -> tuple[Tables, Result | None]:
    """The row of a run, continued from ``near``, and its result."""
    row: Tables = {"speed_rpm": tables["excitation"]["speed_rpm"], "axial_n": tables["load"]["axial"]}
    try:
        scene = scene_from_dict(tables, registry)
        try:
            result = run(scene, registry, near=near, stay="unstable")
        except ConvergenceError as why:
            if not scene.integrator.method.steady:
                raise
            motion = attractor_from_rest(scene, row["speed_rpm"], TURNS)
            if motion.kind == FAILED:
                raise
            reason = f"{' '.join(str(why).split()).partition(': ')[0]}; instead, from rest: {motion.words}"
            return {**row, "status": Status.UNSTEADY, "reason": reason, "instead": _plain_row(motion)}, None
    except RacewayError as why:
        return {**row, **failure(why)}, None
    identification, error, floquet = result.identification, result.error, result.stability["floquet"]
    assert identification is not None
    status, reason = Status.COMPLETED, ""
    if floquet is not None and floquet["verdict"] == "unstable":
        motion = attractor_beside_run(result, row["speed_rpm"], TURNS)
        row["instead"] = _plain_row(motion)
        grows = f"the steady motion is unstable, disturbances grow {floquet['largest']:.4g} times per turn"
        status, reason = Status.UNSTABLE, f"{grows}; instead: {motion.words}"
    numbers = {"k": K.of(result), "abs_z": abs(identification.dynamic_stiffness), "force_n": identification.force_amplitude}
    errors = {"error": without_mesh(error), "mesh_error": error["mesh"]}
    return {**row, "status": status, "reason": reason, "found": floquet and floquet["found"], **numbers, **errors}, result


def _plain_row(motion: Attractor) -> Tables:
    """Without the section, which a page of hundreds of points has no use for."""
    return {name: value for name, value in motion.to_dict().items() if name != "section"}
