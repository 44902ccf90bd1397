"""What a file of a mesh holds, in whatever language: vertices, and polygons that are cut into triangles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Final

from symrender.limits import MAX_TRIANGLES
from symrender.scene.meshes.polygons import CrossesItself, Face, triangles

NO_NORMALS: Final = "its shading normals are not used: faces are flat, and other renderers shade by these normals"


class BadMesh(Exception):
    """A refusal of a mesh's file: what is wrong, after where in the file."""


@dataclass
class Net:
    """Vertices and polygons as they are read, and ``notes`` of what else the file says that is not used."""

    vertices: list[list[float]] = field(default_factory=list)
    polygons: list[tuple[Sequence[int], str]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    _triangles: int = 0

    def put_vertex(self, place: list[float], where: str) -> None:
        """Add a vertex; BadMesh names ``where`` it stands if there are too many."""
        if len(self.vertices) == MAX_TRIANGLES:
            raise BadMesh(f"{where}: a mesh may have at most {MAX_TRIANGLES} vertices")
        self.vertices.append(place)

    def put_face(self, corners: Sequence[int], where: str) -> None:
        """Add a face; BadMesh names ``where`` it stands if it has too few corners, or there are too many triangles."""
        if len(corners) < 3:
            raise BadMesh(f"{where}: a face must have at least 3 vertices, got {len(corners)}")
        self._triangles += len(corners) - 2
        if self._triangles > MAX_TRIANGLES:
            raise BadMesh(f"{where}: a mesh may have at most {MAX_TRIANGLES} triangles")
        self.polygons.append((corners, where))

    def fields(self) -> dict[str, Any]:
        """Vertices, faces and notes as fields of a mesh.

        Faces without an area are left out, and of faces that lie in each other all but the first; a note counts both.
        """
        first: dict[tuple[float, ...], int] = {}
        same = [first.setdefault(tuple(place), k) for k, place in enumerate(self.vertices)]
        known: set[tuple[int, ...]] = set()
        faces: list[Face] = []
        flat = double = 0
        for corners, where in self.polygons:
            try:
                cut = triangles(corners, self.vertices)
            except CrossesItself:
                raise BadMesh(f"{where}: a face must not cross itself, seen along its normal") from None
            if not cut:
                flat += 1
                continue
            outline = _outline([same[k] for k in corners])
            parts = [(face, _outline([same[k] for k in face])) for face in cut]
            new = [face for face, around in parts if around not in known] if outline not in known else []
            double += len(new) < len(cut)
            known |= {outline, *(around for _, around in parts)}
            faces += new
        if flat or double:
            parts_left = [f"{flat} without an area"] * (flat > 0) + [f"{double} that lie in others"] * (double > 0)
            self.notes.append(f"of {len(self.polygons)} faces {' and '.join(parts_left)} are left out")
        if not faces:
            raise BadMesh(f"{self.polygons[0][1]}: a mesh must have a face with an area, got none")
        return {"vertices": self.vertices, "faces": faces} | ({"notes": "; ".join(self.notes)} if self.notes else {})


def _outline(corners: list[int]) -> tuple[int, ...]:
    """The corners from the least one on, towards the lesser of its neighbours: the same from either side."""
    at = corners.index(min(corners))
    ahead = corners[at:] + corners[:at]
    back = [ahead[0], *ahead[:0:-1]]
    return tuple(min(ahead, back))
