"""Colours of a Mitsuba file as linear RGB: rgb, one number, curves, files of curves, black bodies."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from symrender.errors import SceneError
from symrender.limits import MAX_FILE_BYTES
from symrender.scene.document import Malformed
from symrender.scene.files import Opener, found
from symrender.scene.mitsuba.properties import Properties, name_of, numbers
from symrender.scene.mitsuba.xml_tree import Element
from symrender.scene.printable import printable
from symrender.scene.read import decoded
from symrender.scene.spectra.curves import Rgb, black_body, emitted, measured, parsed_spd, reflected

Convert = Callable[[list[float], list[float]], Rgb]
EMITTED: Final[Convert] = emitted
REFLECTED: Final[Convert] = reflected
MEASURED: Final[Convert] = measured
COLOURS: Final = ("rgb", "srgb", "spectrum", "blackbody", "float", "integer")
"""Tags that say a colour."""
_ONE: Final = [360.0, 830.0]
_SRGB: Final = 0.04045


class Reader:
    """Reads colours of a scene, and files that they name."""

    def __init__(self, folders: list[str], opener: Opener, old: bool) -> None:
        self.folders, self.opener, self.old = folders, opener, old
        self.outer = np.eye(4)
        """From the file's coordinates to those of the scene: a mirroring where the camera mirrors its image."""

    @property
    def mirrored(self) -> bool:
        """Whether the scene is the mirror image of the file's."""
        return bool(self.outer[0, 0] < 0.0)

    def path(self, element: Element, name: str) -> str:
        """The name by which the opener opens a file that an element names."""
        try:
            return found(name, self.folders, self.opener)
        except SceneError as error:
            raise Malformed(f"{name_of(element)}: {error}", element.mark) from None

    def taken(self, properties: Properties, name: str, default: float | None, convert: Convert) -> list[float]:
        """The colour of a name, grey by default; refused where it is missing and there is no default."""
        element = properties.take(name, *COLOURS)
        if element is None:
            if default is None:
                raise properties.wrong(f"needs {name}")
            return [default] * 3
        return self.of(element, convert)

    def of(self, element: Element, convert: Convert) -> list[float]:
        """The colour that an element says."""
        given = element.attributes
        try:
            match element.tag:
                case "rgb":
                    return self._rgb(element, given.get("value", ""))
                case "srgb":
                    return _decoded(element, given.get("value", ""))
                case "float" | "integer":
                    return numbers(element, given.get("value", ""), 1) * 3
                case "blackbody":
                    return list(convert(*_black_body(element)))
                case _:
                    return self._spectrum(element, convert)
        except ValueError as error:
            raise Malformed(f"{name_of(element)}: {error}", element.mark) from None

    def _rgb(self, element: Element, text: str) -> list[float]:
        if self.old and text.startswith("#"):
            return [code / 255.0 for code in _codes(element, text)]
        words = text.replace(",", " ").split()
        return numbers(element, text, 1) * 3 if len(words) == 1 else numbers(element, text, 3)

    def _spectrum(self, element: Element, convert: Convert) -> list[float]:
        given = element.attributes
        if "type" in given:
            return self._plugin(element, convert)
        if "filename" in given:
            path = self.path(element, given["filename"])
            try:
                text = decoded(self.opener(path, MAX_FILE_BYTES + 1), path)
                return list(convert(*parsed_spd(text)))
            except (SceneError, ValueError) as error:
                raise Malformed(f"{name_of(element)}: {printable(path)}: {error}", element.mark) from None
        text = given.get("value", "")
        if ":" in text:
            pairs = [pair.split(":") for pair in text.replace(",", " ").replace(": ", ":").split()]
            if any(len(pair) != 2 for pair in pairs):
                raise Malformed("spectrum: must be pairs of wavelength:value, as 400:0.3, 500:0.4", element.mark)
            flat = numbers(element, " ".join(word for pair in pairs for word in pair), 2 * len(pairs))
            return list(convert(flat[0::2], flat[1::2]))
        words = text.replace(",", " ").split()
        if self.old and len(words) == 3:
            return numbers(element, text, 3)
        (value,) = numbers(element, text, 1)
        # Mitsuba integrates a constant where it emits, and keeps the number where it reflects
        return list(convert(_ONE, [value] * 2)) if convert is EMITTED else [value] * 3

    def _plugin(self, element: Element, convert: Convert) -> list[float]:
        properties = Properties(element)
        kind = element.attributes["type"]
        match kind:
            case "uniform" | "d65":
                colour = [properties.number("scale" if kind == "d65" else "value", 1.0)] * 3
                inner = self.taken(properties, "color", 1.0, convert) if kind == "d65" else [1.0] * 3
                colour = [a * b for a, b in zip(colour, inner, strict=True)]
            case "rgb" | "srgb":
                colour = self.taken(properties, "color", None, convert)
            case "irregular":
                texts = [properties.word(name, "").replace(",", " ").split() for name in ("wavelengths", "values")]
                wavelengths, values = (numbers(element, " ".join(words), len(words)) for words in texts)
                colour = list(convert(wavelengths, values))
            case "regular":
                low, high = (properties.number(f"wavelength_{end}") for end in ("min", "max"))
                words = properties.word("values", "").replace(",", " ").split()
                values = numbers(element, " ".join(words), len(words))
                if len(values) < 2:
                    raise Malformed(
                        f"spectrum regular: values must be two numbers at least, got {len(values)}", element.mark
                    )
                step = (high - low) / (len(values) - 1)
                colour = list(convert([low + step * k for k in range(len(values))], values))
            case "blackbody":
                wavelengths, values = black_body(
                    properties.number("temperature"), scale=properties.number("scale", 1.0)
                )
                colour = list(convert(wavelengths, values))
            case _:
                known = "uniform, d65, rgb, irregular, regular and blackbody"
                raise properties.wrong(f"no such spectrum here; known are {known}")
        properties.done("what says its numbers")
        return colour


def _black_body(element: Element) -> tuple[list[float], list[float]]:
    """The curve of a black body as version 0.x writes it: ``temperature="5000K" scale="1"``."""
    given = element.attributes
    (temperature,) = numbers(element, given.get("temperature", "").strip().rstrip("kK"), 1)
    (scale,) = numbers(element, given.get("scale", "1"), 1)
    return black_body(temperature, scale=scale)


def _codes(element: Element, text: str) -> list[int]:
    digits = text.strip().removeprefix("#")
    if len(digits) != 6 or any(c not in "0123456789abcdefABCDEF" for c in digits):
        raise Malformed(f"{name_of(element)}: must be six hexadecimal digits, got {printable(text)}", element.mark)
    return [int(digits[k : k + 2], 16) for k in (0, 2, 4)]


def _decoded(element: Element, text: str) -> list[float]:
    """Linear channels of codes of sRGB, #rrggbb or three numbers up to 1."""
    if text.strip().startswith("#"):
        codes = [code / 255.0 for code in _codes(element, text)]
    else:
        words = text.replace(",", " ").split()
        codes = numbers(element, text, 1) * 3 if len(words) == 1 else numbers(element, text, 3)
    return [c / 12.92 if c <= _SRGB else ((c + 0.055) / 1.055) ** 2.4 for c in codes]
