"""TOML to plain data with marks."""

from __future__ import annotations

import re
import tomllib
from typing import Final

from symrender.scene.document import Document, Malformed, Mark
from symrender.scene.outline_toml import outline_toml
from symrender.scene.printable import printable

_WHERE: Final = re.compile(r"(.*?) \(at (?:line (\d+), column (\d+)|end of document)\)", re.DOTALL)


def parse_toml(text: str, origin: str) -> Document:
    """Plain data and the mark of each key and item; Malformed says where the text is no TOML."""
    marks = outline_toml(text)
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        match = _WHERE.fullmatch(str(error))
        what = match[1] if match else str(error)
        mark = Mark(int(match[2]), int(match[3])) if match and match[2] else Mark.at(text, len(text))
        raise Malformed(f"not valid TOML: {printable(what, 100)}", mark) from None
    except ValueError as error:  # a date that is no date
        raise Malformed(f"not valid TOML: {printable(str(error), 100)}") from None
    return Document(data, origin, marks)
