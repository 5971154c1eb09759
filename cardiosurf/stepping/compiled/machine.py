"""What numba has no words for: pairs of numbers in one register, and threads that meet."""

from typing import Any

from llvmlite import ir
from numba import typeof, types
from numba.extending import intrinsic

_DOUBLE = ir.DoubleType()
_PAIR = ir.VectorType(_DOUBLE, 2)
_TWO: Any = typeof((0.0, 0.0))  # type: ignore[no-untyped-call]
_INT32, _INT64 = ir.IntType(32), ir.IntType(64)


_known: Any = intrinsic
"""numba's decorator, whose annotations know nothing of the first argument being dropped."""


def _data(context: Any, builder: Any, kind: Any, array: Any) -> Any:
    """Return the pointer to an array's first element."""
    return context.make_array(kind)(context, builder, array).data


def _number(builder: Any, data: Any, at: Any) -> Any:
    """Return an element of an array."""
    return builder.load(builder.gep(data, [at]))


def _index(builder: Any, data: Any, at: Any) -> Any:
    """Return an index, as if other threads wrote them: loops over it are not done in vectors."""
    return builder.load_atomic(builder.gep(data, [at]), "monotonic", 4)


def _two(builder: Any, data: Any, at: Any) -> Any:
    """Return two numbers that lie side by side in memory, in one register."""
    both = builder.load(builder.bitcast(builder.gep(data, [at]), _PAIR.as_pointer()))
    both.align = 8
    return both


def _add_product(builder: Any, left: Any, right: Any, total: Any) -> Any:
    """Return left * right + total, rounded once where the machine can."""
    product = builder.fmul(left, right, flags=("contract",))
    return builder.fadd(product, total, flags=("contract",))


def _parts(builder: Any, pair: Any) -> list[Any]:
    """Return the two numbers of a register."""
    return [builder.extract_element(pair, ir.Constant(_INT32, k)) for k in (0, 1)]


_NONE = ir.Constant(_PAIR, [0.0, 0.0])


def _pairs(count: int) -> Any:
    """Return the function that sums ``pair[e] * vectors[columns[e]]`` over entries from e on.

    One register holds the two products, which halves the loads; numba does not find that.
    """

    def typed(typing: Any, pair: Any, vectors: Any, columns: Any, entry: Any) -> Any:
        signature = _TWO(pair, vectors, columns, entry)

        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            arrays = zip(signature.args[:3], arguments[:3], strict=True)
            pair, vectors, columns = (_data(context, builder, *array) for array in arrays)
            sums = [_NONE, _NONE]
            for k in range(count):
                at = builder.add(arguments[3], ir.Constant(_INT64, k))
                column = builder.zext(_number(builder, columns, at), _INT64)
                left, right = (
                    _two(builder, data, builder.shl(place, ir.Constant(_INT64, 1)))
                    for data, place in ((pair, at), (vectors, column))
                )
                sums[k % 2] = _add_product(builder, left, right, sums[k % 2])
            both = _parts(builder, builder.fadd(*sums))
            return context.make_tuple(builder, signature.return_type, both)

        return signature, generate

    return intrinsic(typed)


def _products(count: int) -> Any:
    """Return the function that sums ``values[e] * vector[columns[e]]`` over entries from e on.

    Two products share a register. Left to itself the compiler gathers the vector's elements with
    instructions that take longer than loading them one by one.
    """

    def typed(typing: Any, values: Any, vector: Any, columns: Any, entry: Any) -> Any:
        signature = types.float64(values, vector, columns, entry)

        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            arrays = zip(signature.args[:3], arguments[:3], strict=True)
            values, vector, columns = (_data(context, builder, *array) for array in arrays)
            total = _NONE
            for k in range(0, count, 2):
                right = _NONE
                for part in range(min(2, count - k)):
                    at = builder.add(arguments[3], ir.Constant(_INT64, k + part))
                    column = builder.zext(_index(builder, columns, at), _INT64)
                    element = _number(builder, vector, column)
                    right = builder.insert_element(right, element, ir.Constant(_INT32, part))
                at = builder.add(arguments[3], ir.Constant(_INT64, k))
                if count - k > 1:
                    left = _two(builder, values, at)
                else:
                    only = _number(builder, values, at)
                    left = builder.insert_element(_NONE, only, ir.Constant(_INT32, 0))
                total = _add_product(builder, left, right, total)
            return builder.fadd(*_parts(builder, total))

        return signature, generate

    return intrinsic(typed)


one_pair, six_pairs = _pairs(1), _pairs(6)
one_product, six_products = _products(1), _products(6)


@_known  # type: ignore[untyped-decorator]
def atomic_add(typing: Any, array: Any, index: Any, amount: Any) -> Any:
    """Add to an int64 of an array at once for all threads; return what was there before."""
    signature = types.int64(array, index, amount)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        data = _data(context, builder, signature.args[0], arguments[0])
        index = context.cast(builder, arguments[1], signature.args[1], types.int64)
        amount = context.cast(builder, arguments[2], signature.args[2], types.int64)
        return builder.atomic_rmw("add", builder.gep(data, [index]), amount, "seq_cst")

    return signature, generate


@_known  # type: ignore[untyped-decorator]
def pause(typing: Any) -> Any:
    """Let other threads run on this core for a while."""
    signature = types.int32()

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        kind = ir.FunctionType(_INT32, [])
        name = "sched_yield"
        function = builder.module.globals.get(name) or ir.Function(builder.module, kind, name)
        return builder.call(function, [])

    return signature, generate
