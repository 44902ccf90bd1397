"""The whole of a kernel: every function it reaches, once for each list of argument types, and their constants."""

from __future__ import annotations

import builtins
import functools
import hashlib
import re
from collections.abc import Sequence
from dataclasses import dataclass
from types import FunctionType, ModuleType
from typing import Any, Final

import numpy as np

from symrender.jit.arithmetic import literal
from symrender.jit.function import Function
from symrender.jit.marks import is_inlined, is_marked
from symrender.jit.parts import parted
from symrender.jit.places import Places
from symrender.jit.refused import Refused
from symrender.jit.runtime import EXTERNAL, HELPERS
from symrender.jit.source import Source, source_of, text_of
from symrender.jit.types import (
    NOTHING,
    U8,
    Array,
    Element,
    Scalar,
    Static,
    Tuple,
    Type,
    Value,
    element_of,
    parts_of,
    slots_of,
)

ENTRY: Final = "symrender_kernel"

_NAMES: Final = re.compile(r"@([\w.]+)")

_ATTRIBUTES: Final = """
attributes #0 = { alwaysinline nounwind }
attributes #1 = { nounwind }
attributes #2 = { nounwind willreturn memory(none) }
!0 = !{}
"""


@dataclass(frozen=True)
class Site:
    """A place where an index is checked."""

    file: str
    line: int
    reason: str


@dataclass(frozen=True)
class Translation:
    """LLVM IR of a kernel in one or more modules, the type of its result, and what it was made of.

    ``texts``: SHA-256 of the text of every module a function comes from; ``constants``: a digest of the value of every
    global that was read, by module and name; ``sites``: the checks of a build with checks, by their numbers.
    """

    modules: tuple[str, ...]
    result: Type
    texts: dict[str, str]
    constants: dict[tuple[str, str], str]
    sites: tuple[Site, ...]
    functions: int


class Program:
    """Functions, constants and declarations while they are gathered."""

    def __init__(self, checked: bool = False) -> None:
        self.checked = checked
        self.sites: list[Site] = []
        self.texts: dict[str, str] = {}
        self.constants: dict[tuple[str, str], str] = {}
        self._functions: dict[tuple[FunctionType, tuple[Type, ...]], Function | None] = {}
        self._symbols: set[str] = set()
        self._used: set[str] = set()
        self._tables: dict[str, str] = {}
        self._arrays: dict[int, tuple[Any, Value]] = {}

    def specialised(self, function: FunctionType, types: tuple[Type, ...]) -> Function:
        """The function for these argument types, translated."""
        key = function, types
        if key not in self._functions:
            self._functions[key] = None
            symbol = f"{function.__name__}.{_named_by(function, types)}"
            while symbol in self._symbols:
                symbol += "."
            self._symbols.add(symbol)
            self._functions[key] = Function(self, function, types, symbol, is_inlined(function))
        found = self._functions[key]
        if found is None:
            raise Refused(f"{function.__qualname__} calls itself")
        return found

    def source(self, function: FunctionType) -> Source:
        """Where a function is written; its text is noted."""
        found = source_of(function)
        module = function.__module__
        if module not in self.texts:
            text = text_of(function.__code__, function.__globals__)
            self.texts[module] = hashlib.sha256(text.encode()).hexdigest()
        return found

    def runtime(self, name: str) -> str:
        """Name of a helper, which is noted."""
        self._used.add(name)
        return f"@{name}"

    def check_site(self, file: str, line: int, reason: str) -> int:
        """Number under which a failed check of this place is reported."""
        self.sites.append(Site(file, line, reason))
        return len(self.sites)

    def global_value(self, function: FunctionType, name: str) -> Value:
        """Value of a module's constant, function or module, which is noted."""
        names = function.__globals__
        if name in names:
            found = names[name]
            self.constants[function.__module__, name] = digest_of(found)
        elif hasattr(builtins, name):
            found = getattr(builtins, name)
        else:
            raise Refused(f"{name} is defined nowhere")
        if isinstance(found, FunctionType) and not is_marked(found) and found.__module__ != function.__module__:
            raise Refused(f"{name} is not marked as jitable")
        return self.constant(found)

    def attribute(self, holder: Any, name: str) -> Value:
        """Attribute of a module."""
        if not isinstance(holder, ModuleType) or not hasattr(holder, name):
            raise Refused(f"{holder!r} has no attribute {name} that can be used")
        return self.constant(getattr(holder, name))

    def constant(self, value: Any) -> Value:
        """A Python object as a value."""
        if isinstance(value, np.bool_ | bool):
            return literal(bool(value))
        if isinstance(value, np.uint64):
            return Value(U8, (str(int(value)),))
        if isinstance(value, np.signedinteger | int):
            return literal(int(value))
        match value:
            case None:
                return Value(NOTHING)
            case float():
                return literal(float(value))
            case tuple():
                items = [self.constant(item) for item in value]
                parts = tuple(part for item in items for part in item.parts)
                names = tuple(getattr(type(value), "_fields", ()))
                return Value(Tuple(tuple(item.type for item in items), names), parts)
            case np.ndarray():
                return self._array(value)
        return Value(Static(value))

    def _array(self, value: np.ndarray[Any, Any]) -> Value:
        if id(value) not in self._arrays:
            element = element_of(value.dtype)
            if not isinstance(element, Element):
                raise Refused("a constant array of records")
            listed = ", ".join(f"i8 {byte}" for byte in np.ascontiguousarray(value).tobytes())
            name = self._table(f"private unnamed_addr constant [{value.nbytes} x i8] [{listed}], align 16")
            parts = (name, *(str(n) for n in value.shape))
            self._arrays[id(value)] = value, Value(Array(element, value.ndim, True), parts)
        return self._arrays[id(value)][1]

    def table(self, kind: Scalar, operands: list[str]) -> str | None:
        """Name of a constant array of these numbers, None where one of them is not constant."""
        if any(operand.startswith("%") for operand in operands):
            return None
        listed = ", ".join(f"{kind.llvm} {operand}" for operand in operands)
        text = f"private unnamed_addr constant [{len(operands)} x {kind.llvm}] [{listed}]"
        return self._table(text)

    def _table(self, text: str) -> str:
        """Name of a constant: the same wherever the same is needed, so that parts of kernels can be the same."""
        name = f"table.{_short_digest(text)}"
        self._tables[name] = f"@{name} = {text}"
        return f"@{name}"

    def translate(self, function: FunctionType, types: tuple[Type, ...]) -> Translation:
        """LLVM IR of a kernel for arguments of these types."""
        entry = self.specialised(function, types)
        reached: dict[str, Function] = {}
        waiting = [entry]
        while waiting:
            current = waiting.pop()
            if current.symbol not in reached:
                reached[current.symbol] = current
                waiting += current.callees
        everything = [(each, False) for each in reached.values()]
        # what says which check failed is one place in memory
        divided = [everything] if self.checked else parted(entry, reached)
        called_abroad = {each.symbol for functions in divided for each, foreign in functions if foreign}
        modules = []
        for functions in divided:
            parts = [
                _declared(each) if foreign else _defined(each, each.symbol in called_abroad)
                for each, foreign in functions
            ]
            parts += [self._border(entry)] * (functions is divided[0])
            modules.append("\n".join((*self._needed(parts), *parts, _ATTRIBUTES)))
        result = entry.result or NOTHING
        return Translation(tuple(modules), result, self.texts, self.constants, tuple(self.sites), len(reached))

    def _needed(self, parts: Sequence[str]) -> list[str]:
        """Declarations, constants and helpers that these definitions use."""
        named = set(_NAMES.findall("\n".join(parts)))
        declared: dict[str, None] = {}
        helpers = []
        for name in sorted(self._used & named):
            for line in (HELPERS[name] if name in HELPERS else EXTERNAL[name]).strip().splitlines():
                if line.startswith("declare"):
                    declared[line] = None
                else:
                    helpers.append(line)
        return [*declared, *(self._tables[name] for name in sorted(self._tables.keys() & named)), *helpers]

    def _border(self, entry: Function) -> str:
        """The function called from Python: arguments from one block of slots, the result into the slots after them."""
        body = Places(self, "")
        arguments, start = [], 0
        for type in entry.types:
            value, start = body.from_slots(type, "%block", start)
            arguments += [f"{part} {name}" for part, name in zip(parts_of(type), value.parts, strict=True)]
        if self.checked:
            body.do("store i64 0, ptr @failed")
        result = entry.result or NOTHING
        kinds = parts_of(result)
        kind = "void" if not kinds else kinds[0] if len(kinds) == 1 else f"{{ {', '.join(kinds)} }}"
        call = f"call fastcc {kind} @{entry.symbol}({', '.join(arguments)})"
        if not kinds:
            body.do(call)
        else:
            packed = body.op(call)
            for k, part in enumerate(kinds):
                operand = packed if len(kinds) == 1 else body.op(f"extractvalue {kind} {packed}, {k}")
                operand = body.op(f"zext i1 {operand} to i64") if part == "i1" else operand
                address = body.op(f"getelementptr i64, ptr %block, i64 {start + k}")
                body.do(f"store {'i64' if part == 'i1' else part} {operand}, ptr {address}")
        body.do(f"ret i64 {body.op('load i64, ptr @failed') if self.checked else '0'}")
        flag = "@failed = internal global i64 0\n" if self.checked else ""
        return "\n".join((f"{flag}define i64 @{ENTRY}(ptr %block) #1 {{", *body.slots, *body.lines, "}"))


def _defined(function: Function, shared: bool) -> str:
    """Definition of a function, that other modules call where ``shared``."""
    linkage = "" if shared else "internal "
    return "\n".join((f"define {linkage}{function.head} {{", *function.slots, *function.lines, "}"))


def _declared(function: Function) -> str:
    """Declaration of a function that another module defines."""
    return f"declare {function.head}"


def digest_of(value: Any) -> str:
    """A text that differs where the value of a global differs, as far as a kernel can see it."""
    match value:
        case FunctionType():
            return f"function {value.__module__}.{value.__qualname__}"
        case ModuleType():
            return f"module {value.__name__}"
        case np.ndarray():
            return f"array {value.dtype.descr} {value.shape} {hashlib.sha256(value.tobytes()).hexdigest()}"
        case type():
            return f"class {value.__module__}.{value.__qualname__} {getattr(value, '_fields', ())}"
        case np.dtype():
            return f"dtype {value.descr}"
    return f"{type(value).__name__} {value!r}"


def _named_by(function: FunctionType, types: tuple[Type, ...]) -> str:
    """What tells a function for these types from all others, in every process the same."""
    return _short_digest(function.__module__, function.__qualname__, *map(_shown, types))


@functools.lru_cache(maxsize=4096)
def _shown(type: Type) -> str:
    return _short_digest(repr(type))


def _short_digest(*texts: str) -> str:
    return hashlib.sha256("\0".join(texts).encode()).hexdigest()[:20]


def translated(function: FunctionType, types: tuple[Type, ...], *, checked: bool = False) -> Translation:
    """LLVM IR of a kernel; raises ``Refused``, with file and line, where it leaves the subset."""
    return Program(checked).translate(function, types)


def slots_in(types: tuple[Type, ...], result: Type) -> int:
    """Slots of a call: arguments and result."""
    return sum(map(slots_of, types)) + len(parts_of(result))
