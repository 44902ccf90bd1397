"""One question the adversary asks: a scene, a surface, points on it, and how the value is to be had."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Case:
    """``points``: on the floor (x, y, 0), or unit normals of a sphere. ``seed`` makes it again from its family."""

    family: str
    seed: int
    scene: dict[str, Any]
    surface: str
    points: list[list[float]]
    disk: str = "2x2"
    tol: float = 1e-5
    budget: int = 1_000_000

    @property
    def name(self) -> str:
        """What the case is called."""
        return f"{self.family}#{self.seed}"

    def text(self) -> str:
        """The case as JSON."""
        return json.dumps(asdict(self), indent=1)


def read_cases(path: Path) -> list[Case]:
    """The case, or the list of cases, of a JSON file; what else an entry says is left out."""
    data = json.loads(path.read_text("utf-8"))
    names = Case.__dataclass_fields__
    return [
        Case(**{k: v for k, v in entry.items() if k in names}) for entry in ([data] if isinstance(data, dict) else data)
    ]
