"""Text of one LLVM function while it is written."""

from __future__ import annotations

import struct
from typing import Protocol

from symrender.jit.refused import Refused
from symrender.jit.types import Type, Value, parts_of


class Module(Protocol):
    """What a function needs of the whole it is part of."""

    checked: bool

    def runtime(self, name: str) -> str:
        """Name of a helper written in LLVM IR, or of an external function."""

    def check_site(self, file: str, line: int, reason: str) -> int:
        """Number under which a failed check of this place is reported."""


class Body:
    """Instructions, stack slots and labels of one function."""

    def __init__(self, module: Module, file: str) -> None:
        self.module, self.file, self.line = module, file, 0
        self.slots: list[str] = []
        self.lines: list[str] = []
        self.open = True
        self._count = 0

    def refuse(self, reason: str) -> Refused:
        """The error for a construct on the line at hand."""
        return Refused(reason, self.file, self.line)

    def name(self, prefix: str = "t") -> str:
        """A new register or label, without its sigil."""
        self._count += 1
        return f"{prefix}{self._count}"

    def op(self, text: str) -> str:
        """Write an instruction that has a result; returns the result's name."""
        name = "%" + self.name()
        self.lines.append(f"{name} = {text}")
        return name

    def do(self, text: str) -> None:
        """Write an instruction without result."""
        self.lines.append(text)

    def label(self, label: str) -> None:
        """Begin a block, falling into it where the one before has no end yet."""
        if self.open:
            self.lines.append(f"br label %{label}")
        self.lines.append(f"{label}:")
        self.open = True

    def jump(self, label: str) -> None:
        """End the block."""
        if self.open:
            self.lines.append(f"br label %{label}")
        self.open = False

    def fork(self, condition: str, yes: str, no: str) -> None:
        """End the block by a condition."""
        if condition in ("true", "false"):
            self.jump(yes if condition == "true" else no)
            return
        self.lines.append(f"br i1 {condition}, label %{yes}, label %{no}")
        self.open = False

    def slot(self, type: Type) -> tuple[str, ...]:
        """Stack slots for the parts of a variable of this type; the optimiser makes registers of them."""
        names = []
        for part in parts_of(type):
            names.append("%" + self.name("v"))
            self.slots.append(f"{names[-1]} = alloca {part}")
        return tuple(names)

    def store(self, value: Value, slots: tuple[str, ...]) -> None:
        """Store the parts of a value."""
        for part, operand, slot in zip(parts_of(value.type), value.parts, slots, strict=True):
            self.do(f"store {part} {operand}, ptr {slot}")

    def load(self, type: Type, slots: tuple[str, ...]) -> Value:
        """Value of a variable."""
        parts = zip(parts_of(type), slots, strict=True)
        return Value(type, tuple(self.op(f"load {part}, ptr {slot}") for part, slot in parts))


def double(number: float) -> str:
    """The number as LLVM writes it, exactly."""
    return f"0x{struct.unpack('<Q', struct.pack('<d', number))[0]:016X}"


def whole(operand: str) -> int | None:
    """The number an integer operand is, None where it is a register."""
    return int(operand) if operand.lstrip("-").isdigit() else None
