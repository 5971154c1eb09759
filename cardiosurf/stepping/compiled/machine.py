"""What numba has no words for: several numbers in one register, and threads that meet."""

import platform
from collections.abc import Callable
from typing import Any

import llvmlite.binding as llvm
import numba
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

GROUP = 8
"""Rows that are done at once: as many as a register has numbers."""
WINDOW = 2 * GROUP
"""Elements of a vector that the entries of eight rows are picked from at once: two registers."""

_FLOAT, _DOUBLE = ir.FloatType(), ir.DoubleType()
_INT8, _INT32, _INT64 = ir.IntType(8), ir.IntType(32), ir.IntType(64)
_SINGLES, _DOUBLES = ir.VectorType(_FLOAT, GROUP), ir.VectorType(_DOUBLE, GROUP)
_PLACES = {_SINGLES: ir.VectorType(_INT32, GROUP), _DOUBLES: ir.VectorType(_INT64, GROUP)}
_BOTH_HALVES = {
    _SINGLES: "llvm.x86.avx512.vpermi2var.ps.256",
    _DOUBLES: "llvm.x86.avx512.vpermi2var.pd.512",
}
_ONE_HALF = "llvm.x86.avx2.permps"


def _can(feature: str) -> bool:
    """Return whether the processor that is compiled for has a feature, by what numba is told."""
    # by name: the annotations of numba do not know its settings
    told = vars(numba.config)
    if told["CPU_NAME"] or told["CPU_FEATURES"]:
        return f"+{feature}" in (told["CPU_FEATURES"] or "").split(",")
    return bool(llvm.get_host_cpu_features().get(feature, False))


_PICKS_OF_BOTH, _PICKS_OF_ONE = _can("avx512vl"), _can("avx2")

_tools: Any = cgutils
_known: Any = intrinsic
"""numba's decorator, whose annotations know nothing of the first argument being dropped."""


def _data(context: Any, builder: Any, kind: Any, array: Any) -> Any:
    """Return the pointer to an array's first element."""
    return context.make_array(kind)(context, builder, array).data


def _load(builder: Any, data: Any, index: Any, kind: Any) -> Any:
    """Return some elements of an array, from an index on, in one register."""
    loaded = builder.load(builder.bitcast(builder.gep(data, [index]), kind.as_pointer()))
    loaded.align = 4 if kind.element == _FLOAT else 8 if kind.element == _DOUBLE else 1
    return loaded


def _plus_product(builder: Any, left: Any, right: Any, total: Any) -> Any:
    """Return left * right + total, rounded once where the machine can."""
    product = builder.fmul(left, right, flags=("contract",))
    return builder.fadd(product, total, flags=("contract",))


def _all(builder: Any, number: Any, kind: Any) -> Any:
    """Return a register that holds one number everywhere."""
    register = ir.Constant(kind, ir.Undefined)
    for lane in range(GROUP):
        register = builder.insert_element(register, number, ir.Constant(_INT32, lane))
    return register


def _calling(builder: Any, name: str, kind: Any, arguments: list[Any]) -> Any:
    """Return what an instruction of the processor makes of its arguments."""
    function = ir.FunctionType(kind, [argument.type for argument in arguments])
    return builder.call(builder.module.declare_intrinsic(name, (), function), arguments)


class _Slot:
    """An entry of each of eight rows: all in a window of sixteen columns."""

    def __init__(self, builder: Any, base: Any, places: Any, number: Any) -> None:
        self._builder = builder
        first = builder.load(builder.gep(base, [number]))
        self._first = builder.zext(first, _INT64)
        self._entry = builder.mul(number, ir.Constant(_INT64, GROUP))
        self._places = _load(builder, places, self._entry, ir.VectorType(_INT8, GROUP))
        self._packed: Any = None
        if not _PICKS_OF_BOTH:
            at = builder.bitcast(builder.gep(places, [self._entry]), _INT64.as_pointer())
            # as if other threads wrote it, or the compiler takes it out of a vector, byte by byte;
            # for the same reason it is loaded even where nobody asks for it
            self._packed = builder.load_atomic(at, "monotonic", 8)

    def values(self, data: Any, kind: Any) -> Any:
        """Return the entries of a matrix."""
        return _load(self._builder, data, self._entry, kind)

    def pick(self, vector: Any, kind: Any) -> Any:
        """Return the elements of a vector in the columns of the entries."""
        builder = self._builder
        if not (_PICKS_OF_BOTH or (_PICKS_OF_ONE and kind == _SINGLES)):
            return self._pick_one_by_one(vector, kind)
        second = builder.add(self._first, ir.Constant(_INT64, GROUP))
        low, high = (_load(builder, vector, at, kind) for at in (self._first, second))
        wide = _PLACES[kind]
        places = builder.zext(self._places, wide)
        if _PICKS_OF_BOTH:
            return _calling(builder, _BOTH_HALVES[kind], kind, [low, places, high])
        picked = [_calling(builder, _ONE_HALF, kind, [half, places]) for half in (low, high)]
        in_low = builder.icmp_unsigned("<", places, ir.Constant(wide, [GROUP] * GROUP))
        return builder.select(in_low, *picked)

    def _pick_one_by_one(self, vector: Any, kind: Any) -> Any:
        """Pick as any machine can."""
        builder, found = self._builder, ir.Constant(kind, ir.Undefined)
        window = builder.gep(vector, [self._first])
        for k in range(GROUP):
            place = builder.lshr(self._packed, ir.Constant(_INT64, 8 * k))
            place = builder.and_(place, ir.Constant(_INT64, 255))
            element = builder.load(builder.gep(window, [place]))
            found = builder.insert_element(found, element, ir.Constant(_INT32, k))
        return found


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

    def sums(self, kinds: tuple[Any, ...], products: Callable[[_Slot], list[Any]]) -> list[Any]:
        """Return the sums of products over the slots of a group.

        The second argument of the call is (windows, places, first slot, slots); ``products``
        returns a pair of factors for each sum.
        """
        builder, base, places = self._builder, self.data(1, 0), self.data(1, 1)
        totals = [_tools.alloca_once_value(builder, ir.Constant(kind, None)) for kind in kinds]
        with _tools.for_range(builder, self.value(1, 3), intp=_INT64) as loop:
            slot = _Slot(builder, base, places, builder.add(self.value(1, 2), loop.index))
            for total, (left, right) in zip(totals, products(slot), strict=True):
                builder.store(_plus_product(builder, left, right, builder.load(total)), total)
        return [builder.load(total) for total in totals]


@_known  # type: ignore[untyped-decorator]
def products(typing: Any, out: Any, slots: Any, values: Any, vector: Any) -> Any:
    """Write the sums of ``values[e] * vector[column of e]`` to eight rows, in single precision.

    ``out`` is (array, first row), ``slots`` (windows, places, first slot, how many).
    """
    signature = types.void(out, slots, values, vector)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        call = _Call(context, builder, signature, arguments)
        values, vector = call.data(2), call.data(3)
        (total,) = call.sums(
            (_SINGLES,), lambda slot: [(slot.values(values, _SINGLES), slot.pick(vector, _SINGLES))]
        )
        _store(builder, total, call.data(0, 0), call.value(0, 1))
        return context.get_dummy_value()

    return signature, generate


@_known  # type: ignore[untyped-decorator]
def differences(typing: Any, out: Any, slots: Any, values: Any, vectors: Any, nodal: Any) -> Any:
    """Apply M and w K to differences, for eight rows.

    ``values`` are the entries m and k of M and K beside the diagonal, in single precision, and
    ``vectors`` c and g in double precision. Writes, scaled and rounded to single precision, the
    sums of ``m (c[column] - c[row]) - w k (g[column] - g[row])`` and the lumped mass times
    ``c[row]``. ``out`` is (array, first row), ``nodal`` (lumped, scale, w).
    """
    signature = types.void(out, slots, values, vectors, nodal)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        call = _Call(context, builder, signature, arguments)
        row, two = call.value(0, 1), (0, 1)
        entries, vectors = ([call.data(place, part) for part in two] for place in (2, 3))
        own = [_load(builder, vector, row, _DOUBLES) for vector in vectors]

        def factors(slot: _Slot) -> list[Any]:
            return [
                (
                    builder.fpext(slot.values(entries[part], _SINGLES), _DOUBLES),
                    builder.fsub(slot.pick(vectors[part], _DOUBLES), own[part]),
                )
                for part in two
            ]

        moved, spread = call.sums((_DOUBLES, _DOUBLES), factors)
        weight = _all(builder, call.value(4, 2), _DOUBLES)
        total = builder.fsub(moved, builder.fmul(weight, spread))
        lumped = _load(builder, call.data(4, 0), row, _DOUBLES)
        total = _plus_product(builder, lumped, own[0], total)
        scaled = builder.fmul(total, _load(builder, call.data(4, 1), row, _DOUBLES))
        _store(builder, builder.fptrunc(scaled, _SINGLES), call.data(0, 0), row)
        return context.get_dummy_value()

    return signature, generate


def _store(builder: Any, numbers: Any, data: Any, row: Any) -> None:
    """Store eight numbers."""
    place = builder.bitcast(builder.gep(data, [row]), _SINGLES.as_pointer())
    builder.store(numbers, place).align = 4


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
