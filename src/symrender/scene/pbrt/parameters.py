"""The parameters of one directive, taken one by one; what nobody takes is refused."""

from __future__ import annotations

from itertools import pairwise
from typing import Final

from symrender.scene.document import Malformed, Mark
from symrender.scene.pbrt.directives import Directive, Parameter
from symrender.scene.printable import printable

_WAY: Final = (
    "pbrt makes a spectrum of them, so a coloured scene is three grey files, as `symrender export` writes them"
)
_VISIBLE: Final = (360.0, 830.0)
"""The wavelengths that pbrt traces, in nm."""


class Parameters:
    """What stands behind a directive; ``done`` refuses what was not taken."""

    def __init__(self, directive: Directive) -> None:
        self.directive = directive
        self.mark = directive.mark
        self._left = dict(directive.parameters)

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

    def light(self, name: str, default: float) -> float:
        """A grey light, in units of the film's white."""
        found = self.take(name, "rgb", "spectrum", "blackbody")
        if found is None:
            return default
        if found.type != "rgb":
            raise self.wrong(
                name, f"must be rgb of three equal numbers, got {found.type}: only the film's white keeps its number"
            )
        return self._grey(found)

    def grey(self, name: str, default: float | None = None) -> float:
        """A grey reflectance or index: an rgb of three equal numbers, or a spectrum that is one number throughout."""
        found = self.take(name, "rgb", "spectrum", "blackbody")
        if found is None:
            if default is None:
                raise self.wrong("", f"must have {name}: pbrt takes that of copper otherwise, a spectrum")
            return default
        if found.type == "blackbody" or found.strings:
            what = f"the spectrum {printable(found.strings[0])}" if found.strings else found.type
            raise self.wrong(
                name, f"must be one number at all wavelengths, got {what}, which three channels cannot hold"
            )
        return self._grey(found) if found.type == "rgb" else self._constant(found)

    def _grey(self, found: Parameter) -> float:
        if len(found.numbers) != 3 or len(set(found.numbers)) != 1:
            told = " ".join(f"{x:g}" for x in found.numbers[:6])
            raise self.wrong(found.name, f"must be three equal numbers, got {told}: {_WAY}")
        return found.numbers[0]

    def _constant(self, found: Parameter) -> float:
        """The number of a spectrum of wavelengths and values, all of them the same over all that pbrt traces."""
        lengths, values = found.numbers[::2], found.numbers[1::2]
        rising = all(a < b for a, b in pairwise(lengths))
        if len(lengths) != len(values) or not rising:
            raise self.wrong(
                found.name, f"must be pairs of rising wavelengths and values, got {len(found.numbers)} numbers"
            )
        if len(set(values)) != 1 or lengths[0] > _VISIBLE[0] or lengths[-1] < _VISIBLE[1]:
            told = " ".join(f"{x:g}" for x in found.numbers[:6])
            raise self.wrong(
                found.name, f"must be one number from 360 to 830 nm, got {told}, which three channels cannot hold"
            )
        return values[0]

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
