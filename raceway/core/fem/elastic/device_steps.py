"""Explicit steps of elastic bodies on a CUDA device: the functions of ``explicit_kernels`` in one kernel.

All threads take the parts of a step together and wait for each other between them.  Elements leave their forces, nodes gather them:
every sum has one order, however many threads there are, and equal runs have equal bits.
"""

from __future__ import annotations

from collections import namedtuple
from functools import cache
from time import perf_counter
from typing import Any

import numpy as np

from raceway.core.fem.elastic import device
from raceway.core.fem.elastic.device import device_source
from raceway.core.fem.elastic.explicit import ExplicitSteps
from raceway.core.fem.elastic.explicit_kernels import (
    DONE,
    DT,
    LEFT,
    MOVED,
    STIFFENED,
    carry,
    field_at,
    find_peaks,
    move_frame,
    press,
    push,
    sum_balls,
    sum_frame,
    sum_pairs,
)
from raceway.core.fem.hexahedron.stiffness import corner_modes, element_force
from raceway.core.fem.hexahedron.strain import nodal
from raceway.core.recorder import Recorder
from raceway.core.time.stepped import CLOSED, compare
from raceway.errors import RacewayError

cuda: Any = device.cuda()
#: Seconds of a launch, after which the host hears of Ctrl-C, and of steps between two copies of the state, where no row is recorded.
_LOOK_S, _TAKE_S = 0.1, 2.0

#: Elements' corners (m, 8), number of each one's moduli (m,), moduli over 64 (k, 3) [Pa]; coordinates (3 n,); out: forces of
#: the corners (m, 24); of each node where its corners begin, and these as 8 element + corner; its ball, or -1; out: force on
#: what is held or tied (3 n,).
_Mesh = namedtuple("_Mesh", "cells material moduli x forces starts slots ball held")
#: Of each node where its points begin, and these as 8 point + corner.
_Corners = namedtuple("_Corners", "starts slots")


# numba types what devices run by its arguments; no annotations stand beside these.
def _put(out, e, c, f):  # type: ignore[no-untyped-def]
    """Component c of the forces of all corners of an element."""
    out[e, c], out[e, 3 + c], out[e, 6 + c], out[e, 9 + c] = f[0], f[1], f[2], f[3]
    out[e, 12 + c], out[e, 15 + c], out[e, 18 + c], out[e, 21 + c] = f[4], f[5], f[6], f[7]


def _elements(first, stride, mesh, u):  # type: ignore[no-untyped-def]
    for e in range(first, mesh.cells.shape[0], stride):
        k = mesh.material[e]
        x, moved = corner_modes(mesh.cells, e, mesh.x), corner_modes(mesh.cells, e, u)
        f = element_force(x, moved, mesh.moduli[k, 0], mesh.moduli[k, 1], mesh.moduli[k, 2])
        _put(mesh.forces, e, 0, nodal(f[0]))
        _put(mesh.forces, e, 1, nodal(f[1]))
        _put(mesh.forces, e, 2, nodal(f[2]))


def _move(first, stride, onward, dt, mesh, nodes, corners, cage, points):  # type: ignore[no-untyped-def]
    for i in range(first, nodes.u.size, stride):
        n, c, f = i // 3, i % 3, 0.0
        for k in range(mesh.starts[n], mesh.starts[n + 1]):
            f += mesh.forces[mesh.slots[k] >> 3, 3 * (mesh.slots[k] & 7) + c]
        for k in range(corners.starts[n], corners.starts[n + 1]):
            point, corner = corners.slots[k] >> 3, corners.slots[k] & 7
            f -= points.weights[point, corner] * points.force[point, c]
        if mesh.ball[n] >= 0:
            f += nodes.mass[n] * field_at(mesh.ball[n], n, cage, mesh.x)[c]
        if nodes.inverse[i] == 0.0:
            mesh.held[i] = f
            continue
        nodes.a[i] = (nodes.load[i] - f) * nodes.inverse[i]
        if onward:
            nodes.half[i] += dt * nodes.a[i]
            nodes.u[i] += dt * nodes.half[i]


@cache
def _kernel(law):  # type: ignore[no-untyped-def]
    def advance(first, begin, end, count, numbers, mesh, nodes, corners, cage, frame, points):  # type: ignore[no-untyped-def]
        """Steps ``begin`` to ``end - 1`` of those from ``first`` to ``count - 1``, fewer where points have moved or stiffened too far."""
        me, stride, grid = cuda.grid(1), cuda.gridsize(1), cuda.cg.this_grid()
        for step in range(begin, end):
            if numbers[LEFT] > 0.0:
                return
            onward = step + 1 < count
            for i in range(me, points.area.size, stride):
                press(i, i + 1, step > first, numbers, law, nodes, points)
            _elements(me, stride, mesh, nodes.u)
            sum_balls(me, stride, cage, nodes.mass, mesh.x, nodes.u)
            grid.sync()
            sum_pairs(me, stride, points)
            push(me, stride, cage)
            grid.sync()
            _move(me, stride, onward, numbers[DT], mesh, nodes, corners, cage, points)
            find_peaks(me, stride, numbers, points)
            grid.sync()
            sum_frame(me, stride, step, frame, mesh.held)
            grid.sync()
            if me == 0:
                move_frame(step, onward, numbers, frame)
            grid.sync()
            carry(me, stride, nodes, frame)
            grid.sync()

    return cuda.jit(device_source(advance))


class DeviceSteps(ExplicitSteps):
    """The steps of ``ExplicitSteps`` on a CUDA device, of all points.

    The state comes back where a row is recorded, and the CPU computes the row, with its energies: a microsecond an element on one
    core, and of a million elements a copy of some 100 MB.  A device that fails leaves the state of the last copy.
    """

    margin, lanes = np.inf, 128

    def __init__(self, system: Any, dt: float) -> None:
        super().__init__(system, dt)
        #: Steps to the next copy of the state, and of a launch; kernel with its grid.
        self.device, self.most, self._look = device.title(), 1, 1
        self._launch: Any = None
        a, bodies = system.assembly, self._bodies
        ball = np.full(a.nodes, -1, dtype=np.int32)
        for b, (begin, end) in enumerate(self._cage.spans):
            ball[begin:end] = b
        material = np.repeat(np.arange(len(bodies.ranges), dtype=np.int32), bodies.ranges[:, 1] - bodies.ranges[:, 0])
        self._mesh = _on_device(_Mesh(
            np.asfortranarray(bodies.cells), material, bodies.moduli / 64.0, bodies.x, np.zeros((len(bodies.cells), 24), order="F"),
            *_gathered(bodies.cells, a.nodes), ball, np.zeros(3 * a.nodes),
        ))  # fmt: skip
        self._frame = self._frame._replace(places=a.tied, rows=np.arange(len(a.tied)))

    def _advance(self, recorder: Recorder, first: int, count: int, numbers: np.ndarray, points: Any) -> None:
        """As on the CPU; ConvergenceError where the device fails."""
        start = perf_counter()
        try:
            self._take_steps(recorder, first, count, numbers, points)
        except RacewayError:
            raise
        except Exception as why:  # of the driver
            raise recorder.stalled([], f"the CUDA device failed ({why}); the last copy of the state was made") from why
        self.most = max(1, int((numbers[DONE] - first) * _TAKE_S / (perf_counter() - start)))

    def _take_steps(self, recorder: Recorder, first: int, count: int, numbers: np.ndarray, points: Any) -> None:
        system, contact, told = self._system, self._contact, cuda.to_device(numbers)
        corners = _Corners(*_gathered(points.nodes, system.assembly.nodes))
        mine = self._nodes, corners, self._cage, self._frame, points
        theirs = [_on_device(each) for each in mine]
        while numbers[DONE] < count and not numbers[MOVED]:
            begin, start = int(numbers[DONE]), perf_counter()
            arguments = first, begin, min(begin + self._look, count), count, told, self._mesh, *theirs
            self._launch = self._launch or device.together(_kernel(contact.law), arguments)
            self._launch(*arguments)
            told.copy_to_host(numbers)
            # The first launch compiles the kernel.
            self._look = min(2 * self._look, max(1, int(self._look * _LOOK_S / (perf_counter() - start))))
            if numbers[STIFFENED]:
                theirs[-1].stiffness.copy_to_host(contact.stiffness)
                now = recorder.time_of(recorder.done + int(numbers[DONE]))
                compare(system.stable_step(), system, recorder, f" at t = {now:.6g} s, {CLOSED}")
                theirs[-1].stiffest.copy_to_device(contact.stiffest)
                numbers[STIFFENED] = numbers[LEFT] = 0.0
                told.copy_to_device(numbers)
        of_points = ("memory", "committed", "place", "dissipated", "displacement", "velocity", "scalar")
        for k, names in ((0, ("u", "half", "a")), (3, ("q", "half", "a")), (4, of_points)):
            for name in names:
                getattr(theirs[k], name).copy_to_host(getattr(mine[k], name))


def _on_device(arrays: Any) -> Any:
    """A named tuple with copies of its arrays."""
    return arrays._make(map(cuda.to_device, arrays))


def _gathered(corners: np.ndarray, nodes: int) -> tuple[np.ndarray, np.ndarray]:
    """For each of ``nodes`` where its corners begin, and all corners (m, 8) by their nodes, as 8 row + column."""
    order = np.argsort(corners.ravel(), kind="stable").astype(np.int32)
    return np.r_[0, np.cumsum(np.bincount(corners.ravel(), minlength=nodes))].astype(np.int32), order
