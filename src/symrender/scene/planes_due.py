"""What does not know planes yet refuses a scene that has some, by name."""

from __future__ import annotations

from symrender.errors import Unsupported
from symrender.scene.scene import Scene


def refuse_planes(scene: Scene, what: str) -> None:
    """Raise ``Unsupported`` where ``what`` is asked of a scene with planes."""
    if scene.planes:
        names = ", ".join(plane.name for plane in scene.planes[:3])
        raise Unsupported(f"planes: {what} does not know them yet ({names}); render numerically or by strata")
