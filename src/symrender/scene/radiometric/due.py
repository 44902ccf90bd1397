"""What the language of radiometric scenes has and nothing renders yet: refused by name where it is read or asked."""

from __future__ import annotations

from symrender.errors import Unsupported


def refuse_bounces(bounces: int | str, reason: str) -> None:
    """Raise ``Unsupported`` where more light is asked of what has no noise than it integrates.

    ``reason`` is what of the scene keeps one bounce from being integrated, empty if nothing does.
    """
    if bounces == 0 or (bounces == 1 and not reason):
        return
    words = f" in a scene with {reason}" if reason and bounces == 1 else ""
    raise Unsupported(
        f"bounces: {bounces} is not yet integrated{words}; 0 (emission and direct light) is, 1 is between diffuse, "
        "conductor and phong surfaces under point and directional lights, and the numeric pipeline samples any"
    )
