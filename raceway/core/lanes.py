"""One number of each of four balls at a time: a type for kernels, which vector units add and multiply as fast as one number.

Kernels call these functions without the first arguments, ``context`` and ``builder``: their bodies write machine code.

Arithmetic, comparisons and ``where`` act on each lane alone, as IEEE 754 has it of the single numbers; a number beside lanes stands in
each of them.  Rows of any length are taken in blocks of ``WIDTH``: ``live_of`` tells which lanes of a block lie in the row, ``take`` reads
zeros beyond it, ``put`` writes nothing there.  Processors with shorter vectors do the same in two or four pieces.

Examples
--------
>>> import numpy as np
>>> from numba import float64, void
>>> from raceway.core.jit import jit
>>> from raceway.core.lanes import WIDTH, live_of, put, take, where
>>> @jit(void(float64[:, ::1]))
... def halve_negative(rows):
...     for k in range(0, rows.shape[1], WIDTH):
...         live = live_of(k, rows.shape[1])
...         x = take(rows, 0, k, live)
...         put(rows, 1, k, live, where(x < 0.0, 0.5 * x, x))
>>> rows = np.array([[-2.0, 4.0, -6.0, 8.0, -10.0], 5 * [0.0]])
>>> halve_negative(rows)
>>> rows[1]
array([-1.,  4., -3.,  8., -5.])
"""

import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import boolean, float64, int64, types
from numba.core import cgutils
from numba.core.datamodel.models import PrimitiveModel
from numba.core.typing.templates import ConcreteTemplate, infer_global, signature
from numba.extending import lower_builtin, register_model
from numba.np.arrayobj import populate_array

from raceway.core.signatures import MATRIX, VECTOR

#: A part of numba's compiler, which types some of itself only.
_Numba = Any

#: Lanes of a value.
WIDTH = 4


class _Lanes(types.Type):
    """A type of ``WIDTH`` values side by side."""


#: Numbers, and truths of conditions, side by side.
LANES, MASK = _Lanes(f"float64x{WIDTH}"), _Lanes(f"booleanx{WIDTH}")
_NUMBERS, _TRUTHS = ir.VectorType(ir.DoubleType(), WIDTH), ir.VectorType(ir.IntType(1), WIDTH)
_INTEGER, _INDEX = ir.IntType(64), ir.IntType(32)


@register_model(_Lanes)
class _Model(PrimitiveModel):
    def __init__(self, manager: _Numba, kind: types.Type) -> None:
        super().__init__(manager, kind, _NUMBERS if kind is LANES else _TRUTHS)


_Write = Callable[..., _Numba]


def _register(function: _Numba, answer: types.Type, cases: tuple[tuple[types.Type, ...], ...], write: _Write) -> None:
    """Let kernels call a function of some types of arguments: ``write(context, builder, *args)`` gives its machine code."""
    attributes = {"key": function, "cases": [signature(answer, *case) for case in cases]}
    infer_global(function, types.Function(type("_Template", (ConcreteTemplate,), attributes)))
    for case in cases:
        lower_builtin(function, *case)(lambda context, builder, _sig, args: write(context, builder, *args))


def _machine_code(answer: types.Type, *cases: tuple[types.Type, ...]) -> Callable[[_Write], _Write]:
    """Let kernels call a function whose body writes its machine code."""

    def register(write: _Write) -> _Write:
        _register(write, answer, cases, write)
        return write

    return register


def _spread(builder: _Numba, value: _Numba) -> _Numba:
    """A number as lanes; lanes as they are."""
    if isinstance(value.type, ir.VectorType):
        return value
    unknown = ir.Constant(ir.VectorType(value.type, WIDTH), ir.Undefined)
    one = builder.insert_element(unknown, value, _INDEX(0))
    return builder.shuffle_vector(one, unknown, ir.Constant(ir.VectorType(_INDEX, WIDTH), [0] * WIDTH))


def _lanewise(answer: types.Type, *cases: tuple[types.Type, ...], of: _Numba = None) -> Callable[[_Write], _Write]:
    """The same where arguments are lanes, or numbers for all of them: ``write(builder, *lanes)``; ``of`` : one of Python's operators."""

    def register(write: _Write) -> _Write:
        def lower(_context: _Numba, builder: _Numba, *args: _Numba) -> _Numba:
            return write(builder, *(_spread(builder, value) for value in args))

        _register(of or write, answer, cases, lower)
        return write

    return register


_TWO = (LANES, LANES), (LANES, float64), (float64, LANES)
for _operator, _name in (
    (operator.add, "fadd"), (operator.iadd, "fadd"), (operator.sub, "fsub"), (operator.mul, "fmul"), (operator.truediv, "fdiv")
):  # fmt: skip
    _lanewise(LANES, *_TWO, of=_operator)(lambda builder, x, y, name=_name: getattr(builder, name)(x, y))
for _operator, _name in (
    (operator.lt, "<"), (operator.gt, ">"), (operator.le, "<="), (operator.ge, ">="), (operator.eq, "==")
):  # fmt: skip
    _lanewise(MASK, *_TWO, of=_operator)(lambda builder, x, y, name=_name: builder.fcmp_ordered(name, x, y))
_lanewise(LANES, (LANES,), of=operator.neg)(lambda builder, x: builder.fneg(x))
_lanewise(MASK, (MASK, MASK), of=operator.and_)(lambda builder, x, y: builder.and_(x, y))
_lanewise(MASK, (MASK, MASK), of=operator.or_)(lambda builder, x, y: builder.or_(x, y))
_lanewise(MASK, (MASK,), of=operator.invert)(lambda builder, x: builder.not_(x))


def _call(builder: _Numba, name: str, answer: _Numba, *args: _Numba) -> _Numba:
    kind = ir.FunctionType(answer, [arg.type for arg in args])
    return builder.call(cgutils.get_or_insert_function(builder.module, kind, f"llvm.{name}"), args)


@_lanewise(LANES, (LANES,))
def root(builder: _Numba, x: _Numba) -> _Numba:
    """The square root of each lane."""
    return _call(builder, f"sqrt.v{WIDTH}f64", _NUMBERS, x)


@_lanewise(LANES, (LANES, LANES, LANES), (LANES, LANES, float64))
def multiply_add(builder: _Numba, x: _Numba, y: _Numba, z: _Numba) -> _Numba:
    """x y + z of each lane, rounded once."""
    return _call(builder, f"fma.v{WIDTH}f64", _NUMBERS, x, y, z)


@_lanewise(LANES, (LANES, float64))
def rough_power(builder: _Numba, x: _Numba, exponent: _Numba) -> _Numba:
    """Positive numbers to a power between -1 and 1, within 6 %: exponent and mantissa are near a logarithm, which the power multiplies.

    The upper halves of numbers suffice, which vector units convert.
    """
    upper, whole = ir.VectorType(ir.IntType(32), WIDTH), ir.VectorType(_INTEGER, WIDTH)
    half = ir.Constant(whole, [32] * WIDTH)
    bits = builder.sitofp(builder.trunc(builder.lshr(builder.bitcast(x, whole), half), upper), _NUMBERS)
    one = ir.Constant(
        _NUMBERS, [0x3FF00000 - 54000.0] * WIDTH
    )  # the upper half of 1.0, less what makes errors of both signs alike
    power = builder.fadd(builder.fmul(exponent, builder.fsub(bits, one)), one)
    return builder.bitcast(builder.shl(builder.zext(builder.fptosi(power, upper), whole), half), _NUMBERS)


@_lanewise(LANES, *_TWO)
def larger(builder: _Numba, x: _Numba, y: _Numba) -> _Numba:
    """The larger one in each lane; the second one beside NaN."""
    return builder.select(builder.fcmp_ordered(">", x, y), x, y)


@_lanewise(LANES, *_TWO)
def smaller(builder: _Numba, x: _Numba, y: _Numba) -> _Numba:
    """The smaller one in each lane; the second one beside NaN."""
    return builder.select(builder.fcmp_ordered("<", x, y), x, y)


@_lanewise(LANES, *((MASK, *case) for case in (*_TWO, (float64, float64))))
def where(builder: _Numba, condition: _Numba, x: _Numba, y: _Numba) -> _Numba:
    """x in lanes where the condition holds, else y."""
    return builder.select(condition, x, y)


@_lanewise(LANES, (float64,))
def spread(_builder: _Numba, x: _Numba) -> _Numba:
    """A number in each lane."""
    return x


@_lanewise(MASK, (int64, int64))
def live_of(builder: _Numba, first: _Numba, end: _Numba) -> _Numba:
    """Which lanes of the block that begins at ``first`` lie before ``end``."""
    return builder.icmp_signed("<", builder.add(first, ir.Constant(first.type, list(range(WIDTH)))), end)


@_lanewise(boolean, (MASK,))
def any_of(builder: _Numba, live: _Numba) -> _Numba:
    """Whether any lane is true."""
    bits = builder.bitcast(live, ir.IntType(WIDTH))
    return builder.icmp_unsigned("!=", bits, bits.type(0))


@_lanewise(float64, (LANES,))
def sum_of(builder: _Numba, x: _Numba) -> _Numba:
    """The sum of the lanes, of neighbours first."""
    parts = [builder.extract_element(x, _INDEX(lane)) for lane in range(WIDTH)]
    while len(parts) > 1:
        parts = [builder.fadd(a, b) for a, b in zip(parts[::2], parts[1::2], strict=True)]
    return parts[0]


def _place(context: _Numba, builder: _Numba, matrix: _Numba, row: _Numba, column: _Numba) -> _Numba:
    array = context.make_array(MATRIX)(context, builder, matrix)
    columns = builder.extract_value(array.shape, 1)
    return builder.gep(array.data, [builder.add(builder.mul(row, columns), column)])


@_machine_code(MATRIX, (VECTOR,))
def row_of(context: _Numba, builder: _Numba, vector: _Numba) -> _Numba:
    """A vector as the only row of a matrix."""
    array, matrix = context.make_array(VECTOR)(context, builder, vector), context.make_array(MATRIX)(context, builder)
    size = builder.extract_value(array.shape, 0)
    shape, strides = [_INTEGER(1), size], [builder.mul(size, array.itemsize), array.itemsize]
    populate_array(matrix, array.data, shape, strides, array.itemsize, None)
    return matrix._getvalue()


_ENTRIES = MATRIX, int64, int64, MASK


@_machine_code(LANES, _ENTRIES)
def take(context: _Numba, builder: _Numba, matrix: _Numba, row: _Numba, column: _Numba, live: _Numba) -> _Numba:
    """Entries [row, column], [row, column + 1] and so on in the live lanes, 0 in the others."""
    place = builder.bitcast(_place(context, builder, matrix, row, column), _NUMBERS.as_pointer())
    return _call(builder, f"masked.load.v{WIDTH}f64.p0", _NUMBERS, place, _INDEX(8), live, ir.Constant(_NUMBERS, None))


@_machine_code(types.none, (*_ENTRIES, LANES), (*_ENTRIES, float64))
def put(context: _Numba, builder: _Numba, matrix: _Numba, row: _Numba, column: _Numba, live: _Numba, x: _Numba) -> _Numba:
    """The live lanes to the entries [row, column], [row, column + 1] and so on."""
    place = builder.bitcast(_place(context, builder, matrix, row, column), _NUMBERS.as_pointer())
    bits = builder.bitcast(live, ir.IntType(WIDTH))
    x = _spread(builder, x)
    with builder.if_else(builder.icmp_unsigned("==", bits, bits.type(2**WIDTH - 1)), likely=True) as (whole, part):
        with whole:
            builder.store(x, place, align=8)
        with part:
            _call(builder, f"masked.store.v{WIDTH}f64.p0", ir.VoidType(), x, place, _INDEX(8), live)
    return context.get_dummy_value()


@_machine_code(LANES, _ENTRIES)
def column_of(context: _Numba, builder: _Numba, matrix: _Numba, first: _Numba, column: _Numba, live: _Numba) -> _Numba:
    """Entries [first, column], [first + 1, column] and so on in the live lanes, that of the first row in the others."""
    lanes = ir.Constant(_NUMBERS, ir.Undefined)
    for lane in range(WIDTH):
        inside = builder.extract_element(live, _INDEX(lane))
        row = builder.select(inside, builder.add(first, _INTEGER(lane)), first)
        number = builder.load(_place(context, builder, matrix, row, column))
        lanes = builder.insert_element(lanes, number, _INDEX(lane))
    return lanes
