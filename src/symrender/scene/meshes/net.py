"""What a file of a mesh holds, in whatever language: vertices, and polygons that are cut into triangles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Final

from symrender.limits import MAX_TRIANGLES
from symrender.scene.meshes.polygons import CrossesItself, Face, triangles

_WORDS: Final = {"uv": "texture coordinates", "normals": "normals"}
NO_NORMALS: Final = "its shading normals are not used: faces are flat, and other renderers shade by these normals"


class BadMesh(Exception):
    """A refusal of a mesh's file: what is wrong, after where in the file."""


@dataclass
class Net:
    """Vertices and polygons as they are read, and ``notes`` of what else the file says that is not used."""

    vertices: list[list[float]] = field(default_factory=list)
    polygons: list[tuple[Sequence[int], str]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    uv: list[list[float]] = field(default_factory=list)
    normals: list[list[float]] = field(default_factory=list)
    beside: dict[str, dict[int, Sequence[int]]] = field(default_factory=lambda: {"uv": {}, "normals": {}})
    """Of polygons which coordinates and normals their corners have, where they are not those of their vertices."""
    _triangles: int = 0

    def put_vertex(self, place: list[float], where: str) -> None:
        """Add a vertex; BadMesh names ``where`` it stands if there are too many."""
        if len(self.vertices) == MAX_TRIANGLES:
            raise BadMesh(f"{where}: a mesh may have at most {MAX_TRIANGLES} vertices")
        self.vertices.append(place)

    def put_beside(self, name: str, value: list[float], where: str) -> None:
        """Add a texture coordinate (``uv``) or a normal (``normals``); BadMesh if there are too many."""
        values = getattr(self, name)
        if len(values) == MAX_TRIANGLES:
            raise BadMesh(f"{where}: a mesh may have at most {MAX_TRIANGLES} texture coordinates and normals each")
        values.append(value)

    def put_face(self, corners: Sequence[int], where: str) -> None:
        """Add a face; BadMesh names ``where`` it stands if it has too few corners, or there are too many triangles."""
        if len(corners) < 3:
            raise BadMesh(f"{where}: a face must have at least 3 vertices, got {len(corners)}")
        self._triangles += len(corners) - 2
        if self._triangles > MAX_TRIANGLES:
            raise BadMesh(f"{where}: a mesh may have at most {MAX_TRIANGLES} triangles")
        self.polygons.append((corners, where))

    def fields(self, smooth: bool = False) -> dict[str, Any]:
        """Vertices, faces, coordinates and notes as fields of a mesh, and normals if it is ``smooth``.

        Faces without an area are left out, and of faces that lie in each other all but the first; a note counts both.
        """
        if not smooth and (self.beside["normals"] or len(self.normals) == len(self.vertices)):
            self.notes.append(NO_NORMALS)
        faces, sources, flat, double = self._cut() if self._mixed() else self._triangles_kept()
        if flat or double:
            parts_left = [f"{flat} without an area"] * (flat > 0) + [f"{double} that lie in others"] * (double > 0)
            self.notes.append(f"of {len(self.polygons)} faces {' and '.join(parts_left)} are left out")
        if not faces:
            raise BadMesh(f"{self.polygons[0][1]}: a mesh must have a face with an area, got none")
        found = {"vertices": self.vertices, "faces": faces}
        for name in ("uv", "normals") if smooth else ("uv",):
            own = self._of_vertices(name, faces, sources)
            if getattr(self, name) and not own:
                self.notes.append(f"its {_WORDS[name]} are not used: not every corner of a face has one")
            found |= own
        return found | ({"notes": "; ".join(self.notes)} if self.notes else {})

    def _mixed(self) -> bool:
        """Whether some polygon is no triangle."""
        return self._triangles > len(self.polygons)

    def _triangles_kept(self) -> tuple[list[Face], list[int], int, int]:
        """What ``_cut`` returns where all polygons are triangles, at once for all of them."""
        import numpy as np

        from symrender.scene.meshes.many import first_alike, flat_ones

        faces = np.array([corners for corners, _ in self.polygons], dtype=np.int64)
        thin = flat_ones(np.array(self.vertices)[faces])
        full = np.flatnonzero(~thin)
        alike = first_alike(self.vertices, faces[full]) if len(full) else full
        kept = full[alike == np.arange(len(full))]
        return list(map(tuple, faces[kept].tolist())), kept.tolist(), int(thin.sum()), len(full) - len(kept)

    def _cut(self) -> tuple[list[Face], list[int], int, int]:
        """(faces, the polygon each is of, polygons without an area, polygons that lie in others)."""
        first: dict[tuple[float, ...], int] = {}
        same = [first.setdefault(tuple(place), k) for k, place in enumerate(self.vertices)]
        known: set[tuple[int, ...]] = set()
        faces: list[Face] = []
        sources: list[int] = []
        flat = double = 0
        for place, (corners, where) in enumerate(self.polygons):
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
            sources += [place] * len(new)
        return faces, sources, flat, double

    def _of_vertices(self, name: str, faces: list[Face], sources: list[int]) -> dict[str, Any]:
        """Coordinates or normals as fields of a mesh; nothing where some corner of a face has none.

        ``sources`` are the polygons that the faces were cut from.
        """
        values, beside = getattr(self, name), self.beside[name]
        if not all(math.isfinite(x) for value in values for x in value):
            return {}
        if not beside:
            return {name: values} if len(values) == len(self.vertices) else {}
        own: list[Face] = []
        for face, source in zip(faces, sources, strict=True):
            named = beside.get(source)
            if named is None or not 0 <= min(named) <= max(named) < len(values):
                return {}
            corners = self.polygons[source][0]
            at = dict(zip(reversed(corners), reversed(named), strict=True))
            a, b, c = face
            own.append((at[a], at[b], at[c]))
        return {name: values} | (
            {} if own == faces and len(values) == len(self.vertices) else {f"{name.removesuffix('s')}_faces": own}
        )


def _outline(corners: list[int]) -> tuple[int, ...]:
    """The corners from the least one on, towards the lesser of its neighbours: the same from either side."""
    at = corners.index(min(corners))
    ahead = corners[at:] + corners[:at]
    back = [ahead[0], *ahead[:0:-1]]
    return tuple(min(ahead, back))
