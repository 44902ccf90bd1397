"""A scene's formulas, written for other renderers."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from symrender.errors import OptionError
from symrender.scene.load import load

if TYPE_CHECKING:
    from symrender.bridge.glsl import Exported
    from symrender.scene.scene import Scene

FORMS: Final = ("glsl",)
"""Languages there are."""


def export(
    scene: Scene | str | PathLike[str] | Mapping[str, Any],
    form: str = "glsl",
    path: str | PathLike[str] | None = None,
    *,
    lobe: int = 4,
    force: bool = True,
) -> Exported:
    """The formulas of ``scene`` in the language ``form``, with vectors that prove what each function returns.

    ``"glsl"`` is GLSL ES 3.00: ``text``, with ``lobe`` x ``lobe`` directions listed for every lobe, and ``vectors``.
    With a ``path`` the text is written there and the vectors beside it, ``scene.vectors.json`` for ``scene.glsl``.

    Raises ``OptionError`` for another form, for ``lobe`` out of range and without python-flint, ``Unsupported`` for
    lobes in BRDF units, and ``OutputError`` where a file cannot be written, or exists and ``force`` is false.
    """
    if form not in FORMS:
        raise OptionError(f"form: must be one of {', '.join(FORMS)}, got {form!r}")
    from symrender.bridge.glsl import glsl

    made = glsl(load(scene), lobe=lobe)
    if path is not None:
        made.save(Path(path), force=force)
    return made
