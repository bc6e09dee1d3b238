"""The types of the kernels that reach the time loops as function pointers, and the records that those pass on.

A kernel carries one explicit signature of C-contiguous float64 arrays, so that one compiled loop serves every
plug-in of its kind.  A record is a named tuple: its fields are read by name, and cost nothing in machine code.
"""

import operator
from collections.abc import Mapping
from typing import Any, NamedTuple, cast

import numba
import numpy as np
from numba import boolean, float64, int64, types, void
from numba.core import cgutils
from numba.core.datamodel.models import OpaqueModel
from numba.core.typing.templates import Signature
from numba.extending import NativeValue, lower_builtin, register_model, unbox

#: A part of numba's compiler, which types some of itself only.
_Numba = Any


class Pointer(types.Callable, types.Opaque):
    """The type of a kernel of one signature among the arguments of another, which calls it where its machine code begins.

    numba's own type of a function asks Python twice for each at every call of a kernel from Python, and writes two ways to call it into
    the machine code, with all fields of all records.  An argument is any object with an ``address``, see ``raceway.core.jit.Kernel``.
    """

    def __init__(self, signature: Signature) -> None:
        self.signature = signature
        super().__init__(f"Pointer({signature})")

    def get_call_type(
        self, context: _Numba, args: tuple[types.Type, ...], kws: Mapping[str, types.Type]
    ) -> Signature | None:
        kinds = self.signature.args
        fits = not kws and len(args) == len(kinds) and all(map(context.can_convert, args, kinds))
        return cast(Signature, self.signature.replace(recvr=self)) if fits else None

    def get_call_signatures(self) -> tuple[list[Signature], bool]:
        return [self.signature], False

    def get_impl_key(self, sig: Signature) -> type[types.Type]:
        return Pointer


register_model(Pointer)(OpaqueModel)


@unbox(Pointer)
def _address(_kind: Pointer, kernel: _Numba, wrapper: _Numba) -> NativeValue:
    builder, python = wrapper.builder, wrapper.pyapi
    number = python.object_getattr_string(kernel, "address")
    with builder.if_then(cgutils.is_null(builder, number), likely=False):
        builder.ret(python.get_null_object())
    address = python.long_as_voidptr(number)
    python.decref(number)
    return NativeValue(address)


@lower_builtin(Pointer, Pointer, types.VarArg(types.Any))
def _call(context: _Numba, builder: _Numba, sig: Signature, args: list[_Numba]) -> _Numba:
    convention, kind = context.call_conv, sig.args[0].signature
    function = builder.bitcast(args[0], convention.get_function_type(kind.return_type, kind.args).as_pointer())
    status, answer = convention.call_function(builder, function, kind.return_type, kind.args, args[1:])
    with cgutils.if_unlikely(builder, status.is_error):
        convention.return_status_propagate(builder, status)
    return answer


VECTOR = float64[::1]
MATRIX = float64[:, ::1]
CUBE = float64[:, :, ::1]


def _entry(context: _Numba, builder: _Numba, sig: Signature, array: _Numba, index: _Numba) -> _Numba:
    """The address of an entry; negative indices count from the end.

    As numba's own, which writes some fifty instructions where ten do: a tenth of what kernels take to compile.
    """
    kind, indices = sig.args[:2]
    parts = cgutils.unpack_tuple(builder, index) if isinstance(indices, types.BaseTuple) else [index]
    data, shape = (context.data_model_manager[kind].get_field_position(name) for name in ("data", "shape"))
    offset = None
    for axis, part in enumerate(parts):
        size = builder.extract_value(array, [shape, axis])
        if not getattr(part, "constant", -1) >= 0:
            behind = builder.icmp_signed("<", part, part.type(0))
            part = builder.select(behind, builder.add(part, size), part)
        if context.enable_boundscheck:
            cgutils.do_boundscheck(context, builder, part, size, axis)
        offset = part if offset is None else builder.add(builder.mul(offset, size), part)
    return builder.gep(builder.extract_value(array, data), [offset])


def _take(context: _Numba, builder: _Numba, sig: Signature, args: list[_Numba]) -> _Numba:
    return builder.load(_entry(context, builder, sig, *args))


def _put(context: _Numba, builder: _Numba, sig: Signature, args: list[_Numba]) -> None:
    builder.store(args[2], _entry(context, builder, sig, *args[:2]))


for _kind, _index in ((VECTOR, int64), (MATRIX, types.UniTuple(int64, 2)), (CUBE, types.UniTuple(int64, 3))):
    lower_builtin(operator.getitem, _kind, _index)(_take)
    lower_builtin(operator.setitem, _kind, _index, float64)(_put)

#: law(gap, gap_rate, params, state_old, state_new, dt, force, d_gap, d_rate)
LAW = void(VECTOR, VECTOR, MATRIX, MATRIX, MATRIX, float64, VECTOR, VECTOR, VECTOR)
LAW_POINTER = Pointer(LAW)

#: force(t, params, out (5,))
FORCE = void(float64, VECTOR, VECTOR)
#: (rows): numbers of one point each, in and out.
ROWS = void(MATRIX)
FORCE_POINTER = Pointer(FORCE)


def record(kind: type[tuple[Any, ...]], *fields: types.Type) -> types.BaseTuple:
    """numba's type of a named tuple whose fields have these types."""
    return types.BaseTuple.from_types(fields, kind)


class Balls(NamedTuple):
    """``position`` (Z, 2 to 8), and its rate = ``gain`` [1/s] * position + ``history`` (like position) [m/s]: an integrator's formula."""

    position: np.ndarray
    gain: float
    history: np.ndarray


class Contacts(NamedTuple):
    """Contact law with its parameters (2 Z, k), its memory (2 Z, m) before and after, and the step between the two [s]."""

    law: Any
    params: np.ndarray
    old: np.ndarray
    new: np.ndarray
    dt: float


class Constants(NamedTuple):
    """Numbers of the bearing (n,) and of each ball (Z, k): ``raceway.core.ring.kernels.layout``."""

    scalars: np.ndarray
    table: np.ndarray


class Response(NamedTuple):
    """Internal force (5,), its derivatives by displacement and by velocity, each (5, 5) or (0, 0), and rows of work (r, 2 Z)."""

    f: np.ndarray
    K: np.ndarray
    C: np.ndarray
    work: np.ndarray


BALLS = record(Balls, MATRIX, float64, MATRIX)
CONTACTS = record(Contacts, LAW_POINTER, MATRIX, MATRIX, MATRIX, float64)
CONSTANTS = record(Constants, VECTOR, MATRIX)
RESPONSE = record(Response, VECTOR, MATRIX, MATRIX, MATRIX)

#: system(t, q (5,), v (5,), balls, contacts, constants, response) -> status, see raceway.core.ring.kernels
SYSTEM = int64(float64, VECTOR, VECTOR, BALLS, CONTACTS, CONSTANTS, RESPONSE)
SYSTEM_POINTER = Pointer(SYSTEM)


class Forces(NamedTuple):
    """The bearing's compiled forces: a ``SYSTEM``, the law with its parameters (2 Z, k), and the constants."""

    system: Any
    law: Any
    law_params: np.ndarray
    constants: Constants


class Linear(NamedTuple):
    """Linear parts (5, 5), 1 for unknowns and 0 for coordinates that are held (5,), and the constant load (5,) [N, N m]."""

    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    free: np.ndarray
    load: np.ndarray


class Outer(NamedTuple):
    """Excitation with its parameters (k,), and the time over which it grows smoothly from zero [s]; 0 for none."""

    force: Any
    params: np.ndarray
    ramp: float


class Steps(NamedTuple):
    """Step [s], number of the step that the motion stands at, and steps to take."""

    dt: float
    first: int
    total: int


class State(NamedTuple):
    """Motion (4, 5): q, v, a, net force; positions of the balls (Z, c) now and a step before; the law's memory (2 Z, m)."""

    motion: np.ndarray
    ball: np.ndarray
    ball_before: np.ndarray
    memory: np.ndarray


class Recording(NamedTuple):
    """Every ``stride``-th step is noted in rows (n, 16) and probes (n, 3 to 6, 2 Z); counters (8,)."""

    stride: int
    rows: np.ndarray
    probes: np.ndarray
    counters: np.ndarray


class StaticState(NamedTuple):
    """A state at rest: displacement (5,), positions of the balls (Z, c), the law's memory (2 Z, m)."""

    q: np.ndarray
    ball: np.ndarray
    memory: np.ndarray


FORCES = record(Forces, SYSTEM_POINTER, LAW_POINTER, MATRIX, CONSTANTS)
LINEAR = record(Linear, MATRIX, MATRIX, MATRIX, VECTOR, VECTOR)
OUTER = record(Outer, FORCE_POINTER, VECTOR, float64)
STEPS = record(Steps, float64, int64, int64)
STATE = record(State, MATRIX, MATRIX, MATRIX, MATRIX)
RECORDING = record(Recording, int64, MATRIX, CUBE, VECTOR)
STATIC = record(StaticState, VECTOR, MATRIX, MATRIX)

#: loop(forces, linear, outer, coefficients (k,), steps, state, recording) -> steps done, see raceway.core.time.compiled
LOOP = int64(FORCES, LINEAR, OUTER, VECTOR, STEPS, STATE, RECORDING)

#: solve_equilibrium(forces, linear, tolerance, t, state, response, report (2,)) -> status, see raceway.core.ring.equilibrium
EQUILIBRIUM = int64(FORCES, LINEAR, float64, float64, STATIC, RESPONSE, VECTOR)


def signature_words(signature: Signature) -> str:
    """A numba signature as one writes it: ``none(float64[::1], float64[:, ::1])``."""

    def word(kind: Any) -> str:
        if isinstance(kind, numba.types.BaseNamedTuple):
            numba_type: Any = kind  # numba types a part of it only
            return str(numba_type.instance_class.__name__)
        if not isinstance(kind, numba.types.Array):
            return str(kind)
        last = "::1" if kind.layout == "C" else ":"
        return f"{kind.dtype}[{', '.join([':'] * (kind.ndim - 1) + [last])}]"

    return f"{signature.return_type}({', '.join(word(kind) for kind in signature.args)})"


#: Of equilibria of many points: relative residual.
TOLERANCE = 1e-12
#: Status beside those of ``raceway.core.ring.equilibrium``: some motion is held by less than this part of the stiffest one.
LOOSE, LEAST = 5, 1e-9


class Points(NamedTuple):
    """Numbers of n points: ``scalars`` (n, s), ``table`` (n, Z, c), law's ``params`` (n, 2 Z, k), ``load`` (n, 5), ``shaft`` (n,)
    [N m/rad] against tilts, and ``guess`` (n, 5) to begin with."""

    scalars: np.ndarray
    table: np.ndarray
    params: np.ndarray
    load: np.ndarray
    shaft: np.ndarray
    guess: np.ndarray


class States(NamedTuple):
    """What is computed of n points: displacement (n, 5), positions of balls (n, Z, b), tangent of the contacts and their
    damping (n, 5, 5), or (0, 5, 5) where that is not asked for, contact forces (n, 2 Z), status (n,)."""

    q: np.ndarray
    ball: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    force: np.ndarray
    status: np.ndarray


class Kernels(NamedTuple):
    """``system`` (a ``SYSTEM``), ``base`` (the one whose forces have a potential, ``columns`` of ``ball``) and ``law`` (a ``LAW``);
    ``lanes`` : whether the balls are those of ``raceway.core.ring.lockstep``, rigid or condensed, none acting on another."""

    system: Any
    base: Any
    columns: int
    law: Any
    lanes: bool


POINTS = record(Points, MATRIX, CUBE, CUBE, MATRIX, VECTOR, MATRIX)
STATES = record(States, MATRIX, CUBE, CUBE, CUBE, MATRIX, int64[::1])
KERNELS = record(Kernels, SYSTEM_POINTER, SYSTEM_POINTER, int64, LAW_POINTER, boolean)
