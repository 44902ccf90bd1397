"""How what is missing is installed: the packages of the extras, as the installed metadata list them."""

from __future__ import annotations

import re
from importlib.metadata import requires
from typing import Final

_REQUIREMENT: Final = re.compile(
    r"(?P<name>[A-Za-z0-9._-]+)(?:\[(?P<of>[\w,-]+)])?(?P<range>[^;]*);\s*extra\s*==\s*['\"](?P<extra>[\w-]+)['\"]"
)


def extras() -> dict[str, list[str]]:
    """The requirements of every extra, with those of extras it includes: ``{"flip": ["flip-evaluator>=1.6"]}``."""
    found = [match for line in requires("symrender") or () if (match := _REQUIREMENT.fullmatch(line))]
    listed: dict[str, list[str]] = {}
    for match in sorted(found, key=lambda match: match["name"] == "symrender"):
        mine = listed.setdefault(match["extra"], [])
        if match["name"] == "symrender":
            mine += [part for other in (match["of"] or "").split(",") for part in listed.get(other, ())]
        else:
            mine.append(match["name"] + match["range"].strip())
    return listed


def remedy(extra: str) -> str:
    """The line that installs what ``extra`` needs, wherever symrender itself came from."""
    return "pip install " + " ".join(f"'{part}'" for part in extras().get(extra, [f"symrender[{extra}]"]))
