"""What a file of a mesh holds, in whatever language: vertices, and faces cut into triangles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final

from symrender.limits import MAX_TRIANGLES

_MOST: Final = MAX_TRIANGLES


class BadMesh(Exception):
    """A refusal of a mesh's file: what is wrong, after where in the file."""


@dataclass
class Net:
    """Vertices and faces, as they are read; faces of more corners are fans of triangles about their first."""

    vertices: list[list[float]] = field(default_factory=list)
    faces: list[list[int]] = field(default_factory=list)

    def put_vertex(self, place: list[float], where: str) -> None:
        """Add a vertex; BadMesh names ``where`` it stands if there are too many."""
        if len(self.vertices) == _MOST:
            raise BadMesh(f"{where}: a mesh may have at most {_MOST} vertices")
        self.vertices.append(place)

    def put_face(self, corners: Sequence[int], where: str) -> None:
        """Add a face; BadMesh names ``where`` it stands if it has too few corners, or there are too many triangles."""
        if len(corners) < 3:
            raise BadMesh(f"{where}: a face must have at least 3 vertices, got {len(corners)}")
        if len(self.faces) + len(corners) - 2 > _MOST:
            raise BadMesh(f"{where}: a mesh may have at most {_MOST} triangles")
        self.faces += [[corners[0], corners[k], corners[k + 1]] for k in range(1, len(corners) - 1)]
