"""What numba has no words for: several numbers in one register, and threads that meet."""

import platform
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

GROUP = 4
"""Rows that are done at once: as many as a register has numbers."""

_DOUBLE = ir.DoubleType()
_PAIR, _QUAD = ir.VectorType(_DOUBLE, 2), ir.VectorType(_DOUBLE, GROUP)
_INT32, _INT64 = ir.IntType(32), ir.IntType(64)
_NONE = ir.Constant(_QUAD, [0.0] * GROUP)


_known: Any = intrinsic
"""numba's decorator, whose annotations know nothing of the first argument being dropped."""


def _data(context: Any, builder: Any, kind: Any, array: Any) -> Any:
    """Return the pointer to an array's first element."""
    return context.make_array(kind)(context, builder, array).data


def _at(builder: Any, data: Any, index: Any, kind: Any) -> Any:
    """Return the pointer to several elements of an array, from an index on."""
    return builder.bitcast(builder.gep(data, [index]), kind.as_pointer())


def _load(builder: Any, data: Any, index: Any, kind: Any) -> Any:
    """Return elements of an array, in one register."""
    loaded = builder.load(_at(builder, data, index, kind))
    loaded.align = 8
    return loaded


def _columns(builder: Any, data: Any, entry: Any) -> list[Any]:
    """Return the columns of the entries of a group, two of them with each load.

    Loaded as if other threads wrote them: otherwise the compiler would gather the elements of the
    vector with instructions that take longer than loading them one by one.
    """
    found = []
    for k in range(0, GROUP, 2):
        at = builder.add(entry, ir.Constant(_INT64, k))
        both = builder.load_atomic(_at(builder, data, at, _INT64), "monotonic", 8)
        found.append(builder.zext(builder.trunc(both, _INT32), _INT64))
        found.append(builder.lshr(both, ir.Constant(_INT64, 32)))
    return found


def _shuffled(builder: Any, left: Any, right: Any, order: tuple[int, ...]) -> Any:
    """Return some numbers of two registers in one."""
    mask = ir.Constant(ir.VectorType(_INT32, len(order)), list(order))
    return builder.shuffle_vector(left, right, mask)


def _plus_product(builder: Any, left: Any, right: Any, total: Any) -> Any:
    """Return left * right + total, rounded once where the machine can."""
    product = builder.fmul(left, right, flags=("contract",))
    return builder.fadd(product, total, flags=("contract",))


def _gathered(builder: Any, vector: Any, columns: list[Any]) -> tuple[Any]:
    """Return the elements of a vector in four columns."""
    register = _NONE
    for lane, column in enumerate(columns):
        element = builder.load(builder.gep(vector, [column]))
        register = builder.insert_element(register, element, ir.Constant(_INT32, lane))
    return (register,)


def _gathered_twice(builder: Any, vectors: Any, columns: list[Any]) -> tuple[Any, Any]:
    """Return real and imaginary parts of a complex vector in four columns."""
    numbers = builder.bitcast(vectors, _DOUBLE.as_pointer())
    a, b, c, d = (
        _load(builder, numbers, builder.shl(column, ir.Constant(_INT64, 1)), _PAIR)
        for column in columns
    )
    left, right = (_shuffled(builder, *two, (0, 1, 2, 3)) for two in ((a, c), (b, d)))
    return _shuffled(builder, left, right, (0, 4, 2, 6)), _shuffled(
        builder, left, right, (1, 5, 3, 7)
    )


def _sums(count: int, *, twice: bool, onto: bool) -> Any:
    """Return the function that sums over ``count`` entries of a group of rows.

    It writes the sums of ``values[e] * vector[columns[e]]`` to ``out[row : row + 4]`` or adds them
    there (``onto``); ``target`` is (out, row). With two values (``twice``) and a complex vector
    the sums are of ``values[0][e] * vector.real - values[1][e] * vector.imag``.
    """

    def typed(typing: Any, values: Any, vector: Any, columns: Any, entry: Any, target: Any) -> Any:
        signature = types.void(values, vector, columns, entry, target)

        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            def data(place: int, part: int | None = None) -> Any:
                kind, array = signature.args[place], arguments[place]
                if part is not None:
                    kind, array = kind.types[part], builder.extract_value(array, part)
                return _data(context, builder, kind, array)

            values = [data(0, part) for part in (0, 1)] if twice else [data(0)]
            vector, columns, begin = data(1), data(2), arguments[3]
            place = _at(builder, data(4, 0), builder.extract_value(arguments[4], 1), _QUAD)
            totals = [_NONE, _NONE]
            for k in range(count):
                at = builder.add(begin, ir.Constant(_INT64, GROUP * k))
                found = (_gathered_twice if twice else _gathered)(
                    builder, vector, _columns(builder, columns, at)
                )
                for part, (left, right) in enumerate(zip(values, found, strict=True)):
                    turn = part if twice else k % 2
                    factor = _load(builder, left, at, _QUAD)
                    totals[turn] = _plus_product(builder, factor, right, totals[turn])
            join = builder.fsub if twice else builder.fadd
            total = join(*totals)
            if onto:
                before = builder.load(place)
                before.align = 8
                total = builder.fadd(before, total)
            builder.store(total, place).align = 8
            return context.get_dummy_value()

        return signature, generate

    return intrinsic(typed)


six_products, add_product = (
    _sums(6, twice=False, onto=False),
    _sums(1, twice=False, onto=True),
)
six_differences, add_difference = (
    _sums(6, twice=True, onto=False),
    _sums(1, twice=True, onto=True),
)


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
def atomic_load(typing: Any, array: Any, index: Any) -> Any:
    """Return an int64 of an array as other threads have left it."""
    signature = types.int64(array, index)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        data = _data(context, builder, signature.args[0], arguments[0])
        index = context.cast(builder, arguments[1], signature.args[1], types.int64)
        return builder.load_atomic(builder.gep(data, [index]), "seq_cst", 8)

    return signature, generate


@_known  # type: ignore[untyped-decorator]
def breathe(typing: Any) -> Any:
    """Leave the core to what shares it (another thread of the same core) for some cycles."""
    signature = types.void()

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        if platform.machine() in ("x86_64", "AMD64"):
            kind, name = ir.FunctionType(ir.VoidType(), []), "llvm.x86.sse2.pause"
            known = builder.module.globals.get(name)
            builder.call(known or ir.Function(builder.module, kind, name), [])
        return context.get_dummy_value()

    return signature, generate


@_known  # type: ignore[untyped-decorator]
def give_way(typing: Any) -> Any:
    """Let the system run other threads on this core."""
    signature = types.int32()

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        kind = ir.FunctionType(_INT32, [])
        name = "sched_yield"
        function = builder.module.globals.get(name) or ir.Function(builder.module, kind, name)
        return builder.call(function, [])

    return signature, generate
