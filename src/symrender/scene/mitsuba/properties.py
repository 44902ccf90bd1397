"""The properties of one Mitsuba plugin, taken one by one; what nobody takes is refused."""

from __future__ import annotations

from typing import Final

from symrender.scene.document import Malformed
from symrender.scene.mitsuba.xml_tree import Element
from symrender.scene.numerals import number
from symrender.scene.printable import printable

_PARTS: Final = ("bsdf", "emitter", "film", "sampler", "rfilter", "medium", "shape", "integrator", "phase", "volume")
VALUES: Final = (
    "integer", "float", "string", "boolean", "rgb", "srgb", "spectrum", "blackbody", "point", "vector", "transform",
)  # fmt: skip


def name_of(element: Element) -> str:
    """``bsdf diffuse``, as messages call a plugin."""
    kind = element.attributes.get("type")
    return f"{element.tag} {printable(kind)}" if kind else element.tag


def numbers(element: Element, text: str, count: int) -> list[float]:
    """``count`` finite numbers, between them commas or blanks."""
    words = text.replace(",", " ").split()
    if len(words) != count:
        raise Malformed(f"{name_of(element)}: must be {count} numbers, got {len(words)}", element.mark)
    try:
        return [float(number(word)) for word in words]
    except ValueError as error:
        said = str(error)
        what = said if said.startswith(("must", "a number")) else f"must be numbers, got {printable(text)}"
        raise Malformed(f"{name_of(element)}: {what}", element.mark) from None


class Properties:
    """The children of a plugin by name; ``done`` refuses those that were not taken."""

    def __init__(self, element: Element, names: dict[str, str] | None = None) -> None:
        self.element = element
        self.mark = element.mark
        self.named: dict[str, Element] = {}
        self.others: list[Element] = []
        for child in element.children:
            name = child.attributes.get("name")
            if name is None:
                if child.tag in VALUES:
                    raise Malformed(f"{child.tag} of {name_of(element)}: needs a name", child.mark)
                self.others.append(child)
            elif child.tag in _PARTS:
                # the name of a part says nothing beside its tag
                self.others.append(child)
            elif name in self.named:
                first = self.named[name].mark.line
                raise Malformed(f"{printable(name)}: given twice, first on line {first}", child.mark)
            else:
                self.named[name] = child

    def wrong(self, message: str, at: Element | None = None) -> Malformed:
        """A refusal of this plugin, or of one of its properties."""
        return Malformed(f"{name_of(self.element)}: {message}", (at or self.element).mark)

    def take(self, name: str, *tags: str) -> Element | None:
        """The property of a name, which must be one of ``tags``; None where it is not given."""
        found = self.named.pop(name, None)
        if found is not None and found.tag not in tags:
            raise self.wrong(f"{name} must be {' or '.join(tags)}, got {printable(found.tag)}", found)
        return found

    def value(self, element: Element) -> str:
        """The attribute ``value``."""
        if "value" not in element.attributes:
            raise self.wrong(f"{element.tag} {printable(element.attributes.get('name', ''))} needs a value", element)
        return element.attributes["value"]

    def pop(self, *names: str) -> None:
        """Pass over properties that change no image."""
        for name in names:
            self.named.pop(name, None)

    def parts(self, *tags: str) -> list[Element]:
        """The children of these tags, which count as taken."""
        found = [child for child in self.others if child.tag in tags]
        self.others = [child for child in self.others if child.tag not in tags]
        return found

    def flag(self, name: str, default: bool) -> bool:
        """A boolean."""
        given = self.word(name, "true" if default else "false").strip().lower()
        if given not in ("true", "false"):
            raise self.wrong(f"{name} must be true or false, got {printable(given)}")
        return given == "true"

    def number(self, name: str, default: float | None = None) -> float:
        """A number; refused where it is missing and there is no default."""
        found = self.take(name, "float", "integer")
        if found is not None:
            return numbers(found, self.value(found), 1)[0]
        if default is None:
            raise self.wrong(f"needs {name}")
        return default

    def word(self, name: str, default: str) -> str:
        """A text, or true or false of a boolean."""
        found = self.take(name, "string", "boolean")
        return default if found is None else self.value(found)

    def place(self, name: str, default: tuple[float, float, float] | None = None) -> list[float]:
        """A place or a vector; refused where it is missing and there is no default."""
        found = self.take(name, "point", "vector")
        if found is None:
            if default is None:
                raise self.wrong(f"needs {name}")
            return list(default)
        if "value" in found.attributes:
            return numbers(found, found.attributes["value"], 3)
        return numbers(found, " ".join(found.attributes.get(axis) or "0" for axis in "xyz"), 3)

    def done(self, known: str) -> None:
        """Refuse what was not taken."""
        left = [(printable(name), child) for name, child in self.named.items()]
        left += [(name_of(child), child) for child in self.others]
        wrong = [self.wrong(f"{what} has no meaning here; known are {known}", child) for what, child in left]
        if wrong:
            wrong[0].others = [each.problem for each in wrong[1:]]
            raise wrong[0]
