"""Scalar products of rows, eight numbers at a time, in instructions that Numba does not choose by itself."""

from collections.abc import Callable, Sequence
from typing import cast

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.base import BaseContext
from numba.core.typing.context import BaseContext as TypingContext
from numba.core.typing.templates import Signature
from numba.extending import intrinsic

from labcal.detect.compiled import compiled

LANES = 8
"""Partial sums of a product. Rows are this long or a multiple of it: what is too much of them is 0. With
four a tile takes nearly twice as long: each addition waits for the one before."""
HIGH, WIDE = 2, 2
"""Rows on the left, and on the right, of which all pairs are multiplied at a time: loads are shared."""
# With four rows on the right a triangle takes a third longer: more of what is above its diagonal is computed.

Code = Callable[[BaseContext, ir.IRBuilder, Signature, Sequence[ir.Value]], ir.Value]
"""A function that writes instructions, and returns where their result is."""
_DOUBLE, _INDEX = ir.DoubleType(), ir.IntType(64)
_VECTOR = ir.VectorType(_DOUBLE, LANES)


@compiled
def add_products(left: np.ndarray, right: np.ndarray, part: tuple[int, int], sums: np.ndarray) -> None:
    """Add the scalar products of every row on the left with every row on the right to `sums`.

    The sum over the places ``k``, ``k + 8``, ... is taken for each of eight lanes, in this order, then these
    are halved: the first four are added to the last four, and so on. The same input gives the same bytes.

    Parameters
    ----------
    left : ndarray, shape (m, n)
        m is a multiple of 2, n of 8.
    right : ndarray, shape (p, n)
        p is a multiple of 2.
    part : (int, int)
        First column and the one after the last; their difference is a multiple of 8.
    sums : ndarray, shape (m, p)
    """
    for i in range(0, left.shape[0], HIGH):
        for j in range(0, right.shape[0], WIDE):
            _add_tile((left, i), (right, j), part, sums)


@compiled
def add_own_products(rows: np.ndarray, width: int, sums: np.ndarray) -> None:
    """Add the scalar products of rows with one another to the lower triangle of `sums`, and some above it.

    Parameters
    ----------
    rows : ndarray, shape (m, n)
        m is a multiple of 2.
    width : int
        So many columns count, a multiple of 8.
    sums : ndarray, shape (m, m)
    """
    for i in range(0, rows.shape[0], HIGH):
        for j in range(0, i + HIGH, WIDE):
            _add_tile((rows, i), (rows, j), (0, width), sums)


@compiled
def filled_up(count: int) -> int:
    """Return the length of rows of so many numbers that zeros fill up to a multiple of the lanes."""
    return -(-count // LANES) * LANES


@compiled
def copy_columns(source: np.ndarray, at: int, target: np.ndarray, place: tuple[int, int]) -> None:
    """Copy columns of every row of `source`, from the column `at` on, to the first rows of `target`.

    `place` is the first column there and the number of columns. Assignment of slices looks for overlaps
    first, which takes longer than copying some hundred numbers.
    """
    first, count = place
    for i in range(source.shape[0]):
        row, copy = source[i, at : at + count], target[i, first : first + count]
        for k in range(count):
            copy[k] = row[k]


@compiled
def _add_tile(
    left: tuple[np.ndarray, int], right: tuple[np.ndarray, int], part: tuple[int, int], sums: np.ndarray
) -> None:
    """Add the products of some rows on the left with some on the right, from a number of each on."""
    tile = _TILE(left[0], left[1], right[0], right[1], part)
    for i in range(HIGH):
        for j in range(WIDE):
            sums[left[1] + i, right[1] + j] += tile[WIDE * i + j]


def _tile_code(
    _context: TypingContext,
    left: types.Array,
    upper: types.Type,
    right: types.Array,
    lower: types.Type,
    part: types.Type,
) -> tuple[Signature, Code]:
    """Return the products of rows on the left with rows on the right, from one row of each on."""
    returned = types.UniTuple(types.float64, HIGH * WIDE)  # type: ignore[no-untyped-call]

    def code(
        context: BaseContext, builder: ir.IRBuilder, signature: Signature, arguments: Sequence[ir.Value]
    ) -> ir.Value:
        kinds, rows = signature.args, []
        for at, count in ((0, HIGH), (2, WIDE)):
            proxy = cgutils.create_struct_proxy(kinds[at])  # type: ignore[no-untyped-call]
            array = proxy(context, builder, value=arguments[at])
            first = context.cast(builder, arguments[at + 1], kinds[at + 1], types.intp)  # type: ignore[no-untyped-call]
            rows += [_row(builder, array, first, number) for number in range(count)]
        begin, end = (
            context.cast(builder, builder.extract_value(arguments[4], k), kinds[4][k], types.intp)  # type: ignore[no-untyped-call]
            for k in range(2)
        )
        totals = [_all_lanes(builder, total) for total in _summed(builder, rows, (begin, end))]
        return context.make_tuple(builder, returned, totals)  # type: ignore[no-untyped-call]

    return returned(left, upper, right, lower, part), code


_TILE = cast(
    "Callable[[np.ndarray, int, np.ndarray, int, tuple[int, int]], tuple[float, ...]]", intrinsic(_tile_code)
)


def _row(builder: ir.IRBuilder, array: cgutils.ValueStructProxy, first: ir.Value, number: int) -> ir.Value:
    """Return the address of the row `number` behind the first, in an array whose rows are without gaps."""
    stride = builder.extract_value(array.strides, 0)
    start = builder.ptrtoint(array.data, _INDEX)
    place = builder.add(start, builder.mul(stride, builder.add(first, ir.Constant(_INDEX, number))))
    return builder.inttoptr(place, _DOUBLE.as_pointer())


def _summed(builder: ir.IRBuilder, rows: list[ir.Value], part: tuple[ir.Value, ir.Value]) -> list[ir.Value]:
    """Return the lanes of the products of the first two rows with each of the others."""
    before, loop, after = builder.block, builder.append_basic_block("sum"), builder.append_basic_block("done")
    zero = ir.Constant(_VECTOR, [0.0] * LANES)
    some = builder.icmp_signed("<", part[0], part[1])
    builder.cbranch(some, loop, after)
    with builder.goto_block(loop):
        place = builder.phi(_INDEX)
        place.add_incoming(part[0], before)
        totals = [builder.phi(_VECTOR) for _ in range(HIGH * WIDE)]
        values = []
        for row in rows:
            address = builder.bitcast(builder.gep(row, [place]), _VECTOR.as_pointer())
            values.append(builder.load(address, align=8))
        pairs = [(one, other) for one in values[:HIGH] for other in values[HIGH:]]
        sums = [builder.fadd(total, builder.fmul(*pair)) for total, pair in zip(totals, pairs, strict=True)]
        following = builder.add(place, ir.Constant(_INDEX, LANES))
        place.add_incoming(following, loop)
        for total, added in zip(totals, sums, strict=True):
            total.add_incoming(zero, before)
            total.add_incoming(added, loop)
        builder.cbranch(builder.icmp_signed("<", following, part[1]), loop, after)
    builder.position_at_end(after)
    results = []
    for added in sums:
        result = builder.phi(_VECTOR)
        result.add_incoming(zero, before)
        result.add_incoming(added, loop)
        results.append(result)
    return results


def _all_lanes(builder: ir.IRBuilder, vector: ir.Value) -> ir.Value:
    """Return the sum of the lanes of a vector, by adding its halves."""
    lanes = LANES
    while lanes > 1:
        lanes //= 2
        parts = []
        for first in (0, lanes):
            numbers = ir.Constant(ir.VectorType(ir.IntType(32), lanes), list(range(first, first + lanes)))
            parts.append(builder.shuffle_vector(vector, ir.Constant(vector.type, ir.Undefined), numbers))
        vector = builder.fadd(*parts)
    return builder.extract_element(vector, ir.Constant(ir.IntType(32), 0))
