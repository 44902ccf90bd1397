"""TOML to plain data with line numbers."""

from __future__ import annotations

import re
import tomllib
from typing import Any, Final

from symrender.scene.document import Malformed, Path
from symrender.scene.outline_toml import outline_toml
from symrender.scene.printable import printable

_WHERE: Final = re.compile(r"(.*?) \(at (?:line (\d+), column \d+|end of document)\)", re.DOTALL)


def parse_toml(text: str) -> tuple[Any, dict[Path, int]]:
    """Plain data and the line of each key and item; Malformed names the line of what is refused."""
    lines = outline_toml(text)
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        match = _WHERE.fullmatch(str(error))
        what = match[1] if match else str(error)
        line = int(match[2]) if match and match[2] else text.count("\n") + 1
        raise Malformed(f"not valid TOML: {printable(what, 100)}", line) from None
    except ValueError as error:  # a date that is no date
        raise Malformed(f"not valid TOML: {printable(str(error), 100)}") from None
    return data, lines
