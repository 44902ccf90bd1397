"""Arrays and records: where an element lies, views by slices, what is read and stored."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from symrender.jit.arithmetic import Arithmetic, literal
from symrender.jit.body import whole
from symrender.jit.types import (
    B1,
    F8,
    I8,
    MOVING,
    NOTHING,
    V8,
    Array,
    Block,
    Bundle,
    Element,
    Nothing,
    Racked,
    Record,
    Scalar,
    Static,
    Tuple,
    Type,
    Value,
    elements_in,
    parts_of,
    shown,
    size_of,
    slots_of,
)

_SLOT: Final = Element("slot", "i64", 8, I8)


@dataclass(frozen=True)
class Span:
    """A slice of one axis, step 1; None where it is left open."""

    low: Value | None
    high: Value | None


Index = Value | Span


class Places(Arithmetic):
    """What is done with memory."""

    def items(self, value: Value) -> list[Value]:
        """Values of a tuple's items."""
        match value.type:
            case Tuple(items=types):
                found, at = [], 0
                for type in types:
                    n = len(parts_of(type))
                    found.append(Value(type, value.parts[at : at + n]))
                    at += n
                return found
            case Bundle(items=types):
                return [self.bundled(value, k) for k in range(len(types))]
            case Array(ndim=1):
                length = whole(value.parts[1])
                if length is not None:
                    return [self.element(value, [literal(k)]) for k in range(length)]
        raise self.refuse(f"{shown(value.type)} cannot be unpacked: its length is not known")

    def unpacked(self, value: Value, count: int) -> list[Value]:
        """Values of the items of a tuple, or of an array that has ``count``."""
        if not isinstance(value.type, Array):
            return self.items(value)
        if self.module.checked:
            self.check(self.op(f"icmp eq i64 {value.parts[1]}, {count}"), "an array of another length is unpacked")
        return [self.element(value, [literal(k)]) for k in range(count)]

    def bundled(self, value: Value, index: int) -> Value:
        """Item of a named tuple that the caller holds; it never changes while the kernel runs."""
        assert isinstance(value.type, Bundle)
        start = sum(map(slots_of, value.type.items[:index]))
        return self.from_slots(value.type.items[index], value.parts[0], start)[0]

    def shelved(self, value: Value, index: Value) -> Value:
        """Item of a rack."""
        assert isinstance(value.type, Racked)
        at = self.times(self._index(index, value.parts[1]), str(slots_of(value.type.item)))
        return Value(value.type.item, (self._address(_SLOT, value.parts[0], at),))

    def from_slots(self, type: Type, base: str, start: int) -> tuple[Value, int]:
        """An argument read from eight-byte slots, and the slot after it."""
        match type:
            case Bundle():
                return Value(type, (self._slot(base, start),)), start + slots_of(type)
            case Tuple(items=items):
                parts: list[str] = []
                for item in items:
                    value, start = self.from_slots(item, base, start)
                    parts += value.parts
                return Value(type, tuple(parts)), start
        parts = []
        for part in parts_of(type):
            kind = "i64" if part == "i1" else part
            found = self.op(f"load {kind}, ptr {self._slot(base, start)}, !invariant.load !0")
            parts.append(self.op(f"icmp ne i64 {found}, 0") if part == "i1" else found)
            start += 1
        return Value(type, tuple(parts)), start

    def _slot(self, base: str, index: int) -> str:
        return base if index == 0 else self.op(f"getelementptr inbounds i64, ptr {base}, i64 {index}")

    def times(self, a: str, b: str) -> str:
        """Product of two whole numbers."""
        m, n = whole(a), whole(b)
        if m is not None and n is not None:
            return str(m * n)
        return b if m == 1 else a if n == 1 else self.op(f"mul i64 {a}, {b}")

    def plus(self, a: str, b: str) -> str:
        """Sum of two whole numbers."""
        m, n = whole(a), whole(b)
        if m is not None and n is not None:
            return str(m + n)
        return b if m == 0 else a if n == 0 else self.op(f"add i64 {a}, {b}")

    def strides(self, value: Value) -> list[str]:
        """Bytes between neighbours along each axis of an array."""
        assert isinstance(value.type, Array)
        n = value.type.ndim
        if not value.type.contiguous:
            return list(value.parts[1 + n :])
        found = [str(size_of(value.type.element))]
        for length in reversed(value.parts[2 : 1 + n]):
            found.insert(0, self.times(found[0], length))
        return found[-n:] if n else []

    def _address(self, element: Element | Record, base: str, index: str) -> str:
        kind = element.llvm if isinstance(element, Element) else f"[{element.size} x i8]"
        return base if index == "0" else self.op(f"getelementptr inbounds {kind}, ptr {base}, i64 {index}")

    def _index(self, value: Value, length: str) -> str:
        """A number as an index of an axis of this length; only literals count from the end."""
        if not isinstance(value.type, Scalar) or value.type in (F8, V8, *MOVING):
            raise self.refuse(f"an index is {shown(value.type)}")
        (operand,) = self.convert(value, I8).parts
        known = whole(operand)
        if known is not None and known < 0:
            operand = self.plus(length, operand)
        if self.module.checked:
            inside = self.op(f"icmp ult i64 {operand}, {length}")
            self.check(inside, f"index beyond an axis ({shown(value.type)})")
        return operand

    def check(self, holds: str, reason: str) -> None:
        """Leave the function where the condition does not hold; the first such place is reported."""
        raise NotImplementedError

    def element(self, value: Value, index: list[Index]) -> Value:
        """``value[index]``: a number, a record or a view."""
        address, rest, lengths, strides = self._walk(value, index)
        assert isinstance(value.type, Array)
        element = value.type.element
        if not lengths:
            return Value(element, (address,)) if isinstance(element, Record) else self.read_number(element, address)
        type = Array(element, len(lengths), rest)
        return Value(type, (address, *lengths, *([] if rest else strides)))

    def _walk(self, value: Value, index: list[Index]) -> tuple[str, bool, list[str], list[str]]:
        """Address of what an index leaves, whether it is contiguous, and its lengths and strides."""
        if not isinstance(value.type, Array):
            raise self.refuse(f"{shown(value.type)} has no elements")
        n, element = value.type.ndim, value.type.element
        if len(index) > n:
            raise self.refuse(f"{len(index)} indices of {n} axes")
        lengths, left = list(value.parts[1 : 1 + n]), []
        offsets: list[str] = []
        for axis, item in enumerate(index):
            if isinstance(item, Span):
                low, length = self._span(item, lengths[axis])
                offsets.append(low)
                left.append(length)
            else:
                offsets.append(self._index(item, lengths[axis]))
        left += lengths[len(index) :]
        spans = [axis for axis, item in enumerate(index) if isinstance(item, Span)]
        contiguous = value.type.contiguous and (not spans or spans == [len(index) - 1] or self._whole(index, spans))
        if value.type.contiguous:
            at = "0"
            for axis in range(len(index)):
                at = self.plus(self.times(at, lengths[axis]) if at != "0" else "0", offsets[axis])
            for axis in range(len(index), n):
                at = self.times(at, lengths[axis]) if at != "0" else at
            address = self._address(element, value.parts[0], at)
        else:
            steps, at = self.strides(value), "0"
            for axis, offset in enumerate(offsets):
                at = self.plus(at, self.times(offset, steps[axis]))
            address = value.parts[0] if at == "0" else self.op(f"getelementptr i8, ptr {value.parts[0]}, i64 {at}")
        strides = [] if contiguous else [s for k, s in enumerate(self.strides(value)) if k >= len(index) or k in spans]
        return address, contiguous, left, strides

    def _whole(self, index: list[Index], spans: list[int]) -> bool:
        """Whether all slices but the first are open and no number comes after the first one."""
        after = index[spans[0] + 1 :]
        return all(isinstance(item, Span) and item.low is None and item.high is None for item in after)

    def _span(self, span: Span, length: str) -> tuple[str, str]:
        """Start and length of a slice, cut to the axis as Python cuts it."""
        low = "0" if span.low is None else self._bound(span.low, length)
        high = length if span.high is None else self._bound(span.high, length)
        m, n = whole(low), whole(high)
        if m == 0:
            return low, high
        if m is not None and n is not None:
            return low, str(max(0, n - m))
        count = self.op(f"sub i64 {high}, {low}")
        some = self.op(f"icmp sgt i64 {count}, 0")
        return low, self.op(f"select i1 {some}, i64 {count}, i64 0")

    def _bound(self, value: Value, length: str) -> str:
        if not isinstance(value.type, Scalar) or value.type in (F8, V8, *MOVING):
            raise self.refuse(f"a slice's bound is {shown(value.type)}")
        (operand,) = self.convert(value, I8).parts
        known, most = whole(operand), whole(length)
        if known is not None and most is not None:
            return str(max(0, min(known if known >= 0 else known + most, most)))
        if known is None or known < 0:
            ended = self.op(f"add i64 {operand}, {length}")
            minus = self.op(f"icmp slt i64 {operand}, 0")
            operand = self.op(f"select i1 {minus}, i64 {ended}, i64 {operand}")
            below = self.op(f"icmp slt i64 {operand}, 0")
            operand = self.op(f"select i1 {below}, i64 0, i64 {operand}")
        beyond = self.op(f"icmp sgt i64 {operand}, {length}")
        return self.op(f"select i1 {beyond}, i64 {length}, i64 {operand}")

    def put(self, target: Value, index: list[Index], value: Value) -> None:
        """``target[index] = value``."""
        address, contiguous, lengths, strides = self._walk(target, index)
        assert isinstance(target.type, Array)
        element = target.type.element
        if lengths:
            view = Value(Array(element, len(lengths), contiguous), (address, *lengths, *strides))
            self._fill(view, value)
        elif isinstance(element, Element):
            self.write_number(element, address, value)
        elif value.type == element:
            self.copy(address, value.parts[0], str(element.size))
        else:
            raise self.refuse(f"{shown(value.type)} stored in an array of records")

    def _fill(self, view: Value, value: Value) -> None:
        """Store a number, a tuple or an array in every element of a view of one axis."""
        assert isinstance(view.type, Array)
        if view.type.ndim != 1:
            raise self.refuse("only slices that leave one axis can be assigned to")
        if isinstance(value.type, Tuple | Bundle):
            items = self.items(value)
            if self.module.checked:
                self.check(self.op(f"icmp eq i64 {view.parts[1]}, {len(items)}"), "a tuple of another length")
            for k, item in enumerate(items):
                self.put(view, [literal(k)], item)
            return
        if isinstance(value.type, Array):
            if value.type.ndim != 1:
                raise self.refuse("an array of several axes assigned to one")
            if self.module.checked:
                self.check(self.op(f"icmp eq i64 {view.parts[1]}, {value.parts[1]}"), "an array of another length")
            if view.type.contiguous and value.type == view.type:
                # what is copied may overlap
                size = self.times(view.parts[1], str(size_of(view.type.element)))
                self.copy(view.parts[0], value.parts[0], size)
                return
        with Counted(self, view.parts[1]) as counter:
            index: list[Index] = [Value(I8, (counter,))]
            self.put(view, index, self.element(value, index) if isinstance(value.type, Array) else value)

    def copy(self, target: str, source: str, size: str) -> None:
        """Copy bytes."""
        name = self.module.runtime("llvm.memmove.p0.p0.i64")
        self.do(f"call void {name}(ptr {target}, ptr {source}, i64 {size}, i1 false)")

    def field(self, value: Value, name: str) -> Value:
        """``value.name`` of a record, an array, a tuple or a named tuple."""
        match value.type:
            case Record():
                found = value.type.field(name)
                if found is None:
                    raise self.refuse(f"{shown(value.type)} has no field {name}")
                address, kind = self._at(value.parts[0], found[0]), found[1]
                if isinstance(kind, Element):
                    return self.read_number(kind, address)
                return self._placed(kind, address)
            case Bundle(names=names) if name in names:
                return self.bundled(value, names.index(name))
            case Tuple(names=names) if name in names:
                return self.items(value)[names.index(name)]
            case Array(ndim=n) if name in ("shape", "size", "ndim"):
                lengths = value.parts[1 : 1 + n]
                if name == "shape":
                    return Value(Tuple((I8,) * n), lengths)
                if name == "ndim":
                    return literal(n)
                product = "1"
                for each in lengths:
                    product = self.times(product, each)
                return Value(I8, (product,))
        raise self.refuse(f"{shown(value.type)} has no attribute {name}")

    def _at(self, base: str, offset: int) -> str:
        return base if offset == 0 else self.op(f"getelementptr inbounds i8, ptr {base}, i64 {offset}")

    def _placed(self, kind: Record | Block, address: str) -> Value:
        if isinstance(kind, Record):
            return Value(kind, (address,))
        return Value(Array(kind.element, len(kind.shape), True), (address, *map(str, kind.shape)))

    def put_field(self, target: Value, name: str, value: Value) -> None:
        """``target.name = value`` of a record."""
        found = target.type.field(name) if isinstance(target.type, Record) else None
        if found is None:
            raise self.refuse(f"{shown(target.type)} has no field {name} to assign to")
        address, kind = self._at(target.parts[0], found[0]), found[1]
        if isinstance(kind, Element):
            self.write_number(kind, address, value)
        elif isinstance(kind, Record) and value.type == kind:
            self.copy(address, value.parts[0], str(kind.size))
        elif isinstance(kind, Block) and value.type == Array(kind.element, len(kind.shape), True):
            lengths = tuple(map(str, kind.shape))
            if value.parts[1:] != lengths:
                raise self.refuse(f"field {name} has lengths {lengths}, and the array is not known to have them")
            self.copy(address, value.parts[0], str(elements_in(kind.shape) * size_of(kind.element)))
        else:
            raise self.refuse(f"{shown(value.type)} assigned to field {name}")

    def same(self, a: Value, b: Value) -> Value:
        """``a is b``, where one of them is None."""
        if not isinstance(a.type, Nothing) and not isinstance(b.type, Nothing):
            raise self.refuse("`is` asks for None only")
        return Value(B1, ("true" if a.type == b.type == NOTHING else "false",))

    def known(self, value: Value) -> object:
        """What a static value is."""
        if not isinstance(value.type, Static):
            raise self.refuse(f"{shown(value.type)} where a known object is wanted")
        return value.type.value


class Counted:
    """A loop of as many passes as an operand says; gives the counter's register."""

    def __init__(self, body: Places, count: str) -> None:
        self.body, self.count = body, count

    def __enter__(self) -> str:
        body = self.body
        (self.slot,) = body.slot(I8)
        self.head, self.inside, self.end = (body.name(kind) for kind in ("head", "body", "end"))
        body.do(f"store i64 0, ptr {self.slot}")
        body.label(self.head)
        counter = body.op(f"load i64, ptr {self.slot}")
        body.fork(body.op(f"icmp slt i64 {counter}, {self.count}"), self.inside, self.end)
        body.label(self.inside)
        return counter

    def __exit__(self, *_: object) -> None:
        body = self.body
        before = body.op(f"load i64, ptr {self.slot}")
        body.do(f"store i64 {body.op(f'add nsw i64 {before}, 1')}, ptr {self.slot}")
        body.jump(self.head)
        body.label(self.end)
