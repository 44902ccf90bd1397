"""The parameters of one directive, taken one by one; what nobody takes is refused."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from symrender.errors import SceneError
from symrender.limits import MAX_FILE_BYTES
from symrender.scene.document import Malformed, Mark
from symrender.scene.files import Opener
from symrender.scene.files import found as found_file
from symrender.scene.pbrt.directives import Directive, Parameter
from symrender.scene.printable import printable
from symrender.scene.read import decoded
from symrender.scene.spectra import cie
from symrender.scene.spectra.curves import (
    Rgb,
    black_body,
    checked,
    linear_rgb,
    measured,
    parsed_spd,
    reflected,
    tristimulus,
)

_VISIBLE: Final = (360.0, 830.0)
"""The wavelengths that pbrt traces, in nm."""


def _of_luminance_one(wavelengths: list[float], values: list[float]) -> Rgb:
    """Linear RGB of a light's curve, divided by its luminance, as pbrt takes lights."""
    xyz = tristimulus(wavelengths, values, emits=True)
    if not xyz[1] > 0.0:
        raise ValueError("a light must have a luminance above 0")
    r, g, b = (max(0.0, c) / xyz[1] for c in linear_rgb(xyz))
    return r, g, b


class Parameters:
    """What stands behind a directive; ``done`` refuses what was not taken."""

    def __init__(self, directive: Directive) -> None:
        self.directive = directive
        self.mark = directive.mark
        self._left = dict(directive.parameters)

    def beside(self, defaults: Mapping[str, Parameter]) -> Parameters:
        """These parameters, and those of ``Attribute`` directives that stand above them."""
        if defaults:
            merged = {**defaults, **self.directive.parameters}
            return Parameters(replace(self.directive, parameters=merged))
        return self

    def wrong(self, name: str, message: str) -> Malformed:
        """A refusal of a parameter, or of the whole directive where ``name`` is empty."""
        given = self.directive.parameters.get(name)
        path = (self.directive.name, name) if name else (self.directive.name,)
        return Malformed(message, given.mark if given else self.mark, path)

    def where(self, name: str) -> Mark:
        """Where a parameter stands, or its directive."""
        given = self.directive.parameters.get(name)
        return given.mark if given else self.mark

    def given(self, name: str) -> bool:
        """Whether there is a parameter of that name."""
        return name in self.directive.parameters

    def take(self, name: str, *kinds: str) -> Parameter | None:
        """The parameter of a name, which must be of one of ``kinds``; None where it is not given."""
        found = self._left.pop(name, None)
        if found is not None and found.type not in kinds:
            raise self.wrong(name, f"must be {' or '.join(kinds)}, got {found.type}")
        return found

    def _some(self, name: str, count: int, *kinds: str) -> tuple[float, ...] | None:
        found = self.take(name, *kinds)
        if found is not None and len(found.numbers) != count:
            raise self.wrong(name, f"must be {count} numbers, got {len(found.numbers)}")
        return None if found is None else found.numbers

    def number(self, name: str, default: float, kind: str = "float") -> float:
        """One number."""
        found = self._some(name, 1, kind)
        return default if found is None else found[0]

    def triple(self, name: str, kind: str, default: tuple[float, float, float]) -> tuple[float, float, float]:
        """A place or a vector."""
        found = self._some(name, 3, kind)
        return default if found is None else (found[0], found[1], found[2])

    def several(self, name: str, count: int, kind: str) -> tuple[float, ...]:
        """So many numbers, which must be given."""
        found = self._some(name, count, kind)
        if found is None:
            raise self.wrong("", f"must have {name}, {count} numbers of type {kind}")
        return found

    def word(self, name: str, default: str, kind: str = "string") -> str:
        """A string, or ``true`` or ``false`` of a bool."""
        found = self.take(name, kind)
        if found is None:
            return default
        if len(found.strings) != 1:
            raise self.wrong(name, f"must be one {kind}, got {len(found.strings)}")
        return found.strings[0]

    def must(self, name: str, got: object, due: object, why: str = "") -> None:
        """Refuse what is not ``due``."""
        if got != due:
            shown = printable(got) if isinstance(got, str) else f"{got:g}" if isinstance(got, float) else str(got)
            wanted = f"{due:g}" if isinstance(due, float) else str(due)
            raise self.wrong(name, f"must be {wanted}, got {shown}{f': {why}' if why else ''}")

    def colour(self, name: str, kind: str, opener: Opener, default: Rgb | None = None) -> Rgb | None:
        """A colour in linear RGB, of what ``emits`` (of luminance 1 if no rgb), ``reflects``, or of an ``index``."""
        found = self.take(name, "rgb", "spectrum", "blackbody", "float")
        if found is None:
            return default
        try:
            if found.type == "blackbody":
                if len(found.numbers) != 1:
                    raise ValueError(f"must be a temperature, got {len(found.numbers)} numbers")
                return _of_luminance_one(*black_body(found.numbers[0]))
            if found.type == "float" or (found.type == "rgb" and len(found.numbers) == 3):
                r, g, b = found.numbers if found.type == "rgb" else found.numbers * 3
                return (r, g, b)
            if found.type == "rgb":
                raise ValueError(f"must be 3 numbers, got {len(found.numbers)}")
            wavelengths, values = self._curve(found, opener)
        except ValueError as error:
            raise self.wrong(name, str(error)) from None
        if (
            wavelengths[0] <= _VISIBLE[0]
            and wavelengths[-1] >= _VISIBLE[1]
            and len(set(values)) == 1
            and kind != "emits"
        ):
            return (values[0], values[0], values[0])
        if kind == "emits":
            return _of_luminance_one(wavelengths, values)
        return reflected(wavelengths, values) if kind == "reflects" else measured(wavelengths, values)

    def _curve(self, found: Parameter, opener: Opener) -> tuple[list[float], list[float]]:
        """Wavelengths and values of a spectrum, of its numbers, or of the file that it names."""
        if not found.strings:
            wavelengths, values = list(found.numbers[::2]), list(found.numbers[1::2])
            checked(wavelengths, values)
            return wavelengths, values
        (name,) = found.strings
        if name.startswith("stdillum-D65"):
            return [cie.FIRST + cie.STEP * k for k in range(len(cie.D65))], list(cie.D65)
        if not name.endswith(".spd"):
            raise ValueError(f"the spectrum {printable(name)} by name is not supported")
        try:
            path = found_file(name, [""], opener)
            return parsed_spd(decoded(opener(path, MAX_FILE_BYTES + 1), path))
        except SceneError as error:
            raise ValueError(str(error)) from None

    def passed(self, *names: str) -> None:
        """Pass over parameters that say nothing of a scene."""
        for name in names:
            self._left.pop(name, None)

    def done(self, known: str) -> None:
        """Refuse what was not taken."""
        left = self._left.items()
        wrong = [self.wrong(name, f"must be left out, got {each.type}: known are {known}") for name, each in left]
        if wrong:
            wrong[0].others = [each.problem for each in wrong[1:]]
            raise wrong[0]
