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
_FOUR = ir.VectorType(ir.FloatType(), GROUP)
_INT32, _INT64 = ir.IntType(32), ir.IntType(64)


_known: Any = intrinsic
"""numba's decorator, whose annotations know nothing of the first argument being dropped."""


def _data(context: Any, builder: Any, kind: Any, array: Any) -> Any:
    """Return the pointer to an array's first element."""
    return context.make_array(kind)(context, builder, array).data


def _at(builder: Any, data: Any, index: Any, kind: Any) -> Any:
    """Return the pointer to several elements of an array, from an index on."""
    return builder.bitcast(builder.gep(data, [index]), kind.as_pointer())


def _load(builder: Any, data: Any, index: Any, kind: Any, *, align: int = 8) -> Any:
    """Return elements of an array, in one register."""
    loaded = builder.load(_at(builder, data, index, kind))
    loaded.align = align
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


def _gathered(builder: Any, vector: Any, columns: list[Any]) -> Any:
    """Return the elements of a vector in four columns."""
    register = ir.Constant(_FOUR, [0.0] * GROUP)
    for lane, column in enumerate(columns):
        element = builder.load(builder.gep(vector, [column]))
        register = builder.insert_element(register, element, ir.Constant(_INT32, lane))
    return register


def _parted(builder: Any, pairs: list[Any]) -> tuple[Any, Any]:
    """Return real and imaginary parts of four complex numbers."""
    a, b, c, d = pairs
    left, right = (_shuffled(builder, *two, (0, 1, 2, 3)) for two in ((a, c), (b, d)))
    return _shuffled(builder, left, right, (0, 4, 2, 6)), _shuffled(
        builder, left, right, (1, 5, 3, 7)
    )


def _gathered_pairs(builder: Any, vectors: Any, columns: list[Any]) -> tuple[Any, Any]:
    """Return real and imaginary parts of a complex vector in four columns."""
    numbers = builder.bitcast(vectors, _DOUBLE.as_pointer())
    twice = [builder.shl(column, ir.Constant(_INT64, 1)) for column in columns]
    return _parted(builder, [_load(builder, numbers, at, _PAIR) for at in twice])


class _Call:
    """The arguments of a function that stands for machine code."""

    def __init__(self, context: Any, builder: Any, signature: Any, arguments: Any) -> None:
        self._context, self._builder = context, builder
        self._kinds, self._arguments = signature.args, arguments

    def data(self, place: int, part: int | None = None) -> Any:
        """Return the pointer to the first element of an argument, or of a part of it."""
        kind = self._kinds[place] if part is None else self._kinds[place].types[part]
        return _data(self._context, self._builder, kind, self.value(place, part))

    def value(self, place: int, part: int | None = None) -> Any:
        """Return an argument, or a part of it."""
        argument = self._arguments[place]
        return argument if part is None else self._builder.extract_value(argument, part)


def _products(count: int, *, onto: bool) -> Any:
    """Return the function that sums products over ``count`` entries of a group of rows.

    It writes the sums of ``values[e] * vector[columns[e]]``, all in single precision, to
    ``out[row : row + 4]`` or adds them there (``onto``); ``target`` is (out, row).
    """

    def typed(typing: Any, values: Any, vector: Any, columns: Any, entry: Any, target: Any) -> Any:
        signature = types.void(values, vector, columns, entry, target)

        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            call = _Call(context, builder, signature, arguments)
            values, vector, columns = (call.data(place) for place in range(3))
            place = _at(builder, call.data(4, 0), call.value(4, 1), _FOUR)
            totals = [ir.Constant(_FOUR, [0.0] * GROUP)] * 2
            for k in range(count):
                at = builder.add(call.value(3), ir.Constant(_INT64, GROUP * k))
                found = _gathered(builder, vector, _columns(builder, columns, at))
                factor = _load(builder, values, at, _FOUR, align=4)
                totals[k % 2] = _plus_product(builder, factor, found, totals[k % 2])
            _store_sum(builder, builder.fadd(*totals), place, onto=onto)
            return context.get_dummy_value()

        return signature, generate

    return intrinsic(typed)


def _differences(count: int, *, onto: bool) -> Any:
    """Return the function that applies M and w K to differences, over some entries of four rows.

    ``values`` are the entries m and k of M and K beside the diagonal, in single precision, and
    ``vectors`` holds c + i g in double precision. To ``out[row : row + 4]`` it writes, scaled and
    rounded to single precision, the sums of ``m (c[column] - c[row]) - w k (g[column] - g[row])``
    and the lumped mass times ``c[row]``; ``onto`` leaves the latter out and adds to what is there.
    ``target`` is (out, row, lumped, scale, w).
    """

    def typed(typing: Any, values: Any, vectors: Any, columns: Any, entry: Any, target: Any) -> Any:
        signature = types.void(values, vectors, columns, entry, target)

        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            call = _Call(context, builder, signature, arguments)
            pair, vectors, columns = [call.data(0, 0), call.data(0, 1)], call.data(1), call.data(2)
            row = call.value(4, 1)
            lanes = [builder.add(row, ir.Constant(_INT64, lane)) for lane in range(GROUP)]
            own = _gathered_pairs(builder, vectors, lanes)
            totals = [ir.Constant(_QUAD, [0.0] * GROUP)] * 2
            for k in range(count):
                at = builder.add(call.value(3), ir.Constant(_INT64, GROUP * k))
                found = _gathered_pairs(builder, vectors, _columns(builder, columns, at))
                for part in (0, 1):
                    single = _load(builder, pair[part], at, _FOUR, align=4)
                    factor = builder.fpext(single, _QUAD)
                    apart = builder.fsub(found[part], own[part])
                    totals[part] = _plus_product(builder, factor, apart, totals[part])
            weight = ir.Constant(_QUAD, ir.Undefined)
            for lane in range(GROUP):
                weight = builder.insert_element(weight, call.value(4, 4), ir.Constant(_INT32, lane))
            total = builder.fsub(totals[0], builder.fmul(weight, totals[1]))
            if not onto:
                lumped = _load(builder, call.data(4, 2), row, _QUAD)
                total = _plus_product(builder, lumped, own[0], total)
            scaled = builder.fmul(total, _load(builder, call.data(4, 3), row, _QUAD))
            place = _at(builder, call.data(4, 0), row, _FOUR)
            _store_sum(builder, builder.fptrunc(scaled, _FOUR), place, onto=onto)
            return context.get_dummy_value()

        return signature, generate

    return intrinsic(typed)


def _store_sum(builder: Any, total: Any, place: Any, *, onto: bool) -> None:
    """Store four numbers, or add them to what is there."""
    if onto:
        before = builder.load(place)
        before.align = 4
        total = builder.fadd(before, total)
    builder.store(total, place).align = 4


six_products, add_product = _products(6, onto=False), _products(1, onto=True)
six_differences, add_difference = _differences(6, onto=False), _differences(1, onto=True)


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
