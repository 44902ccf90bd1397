"""A scene written for other renderers: its formulas, or itself."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal, overload

from symrender.errors import OptionError, Unsupported
from symrender.scene.load import Source, in_series, load_any
from symrender.scene.printable import printable
from symrender.scene.radiometric.scene import RadiometricScene

if TYPE_CHECKING:
    from symrender.bridge.carried import Carried
    from symrender.bridge.glsl import Exported


FORMS: Final = ("glsl", "mitsuba", "pbrt")
"""What a scene is written as."""


@overload
def export(
    scene: Source, form: Literal["glsl"] = "glsl", path: str | PathLike[str] | None = None, **options: Any
) -> Exported: ...


@overload
def export(
    scene: Source, form: Literal["mitsuba", "pbrt"], path: str | PathLike[str] | None = None, **options: Any
) -> Carried: ...


def export(
    scene: Source, form: str = "glsl", path: str | PathLike[str] | None = None, *, force: bool = True, **options: Any
) -> Exported | Carried:
    """``scene`` as another renderer takes it, written to ``path`` if there is one, and returned.

    ``"glsl"``, of a scene in units of the series: its formulas in GLSL ES 3.00 (``text``), with ``lobe`` x ``lobe``
    directions listed for every lobe (4), and ``vectors`` that prove what each function returns; they are written
    beside the text, ``scene.vectors.json`` for ``scene.glsl``.
    ``"mitsuba"``, of a radiometric scene: a folder with ``scene.xml``, a program ``run.py`` that renders it, and a
    receipt; options are ``size``, ``samples``, ``scale``, ``center``, ``rays``, ``reach`` and ``calibration`` of
    :func:`symrender.bridge.mitsuba.mitsuba`. ``"pbrt"``, with the same options: a folder with ``scene.pbrt``, or a
    grey file for each channel, a program and a receipt (:func:`symrender.bridge.pbrt.pbrt`).

    Raises ``OptionError`` for another form or option and without python-flint for GLSL, ``Unsupported`` for what the
    other renderer cannot state, and ``OutputError`` where a file cannot be written, or exists and ``force`` is false.
    """
    if form not in FORMS:
        raise OptionError(f"form: must be one of {', '.join(FORMS)}, got {form!r}")
    known = ("lobe",) if form == "glsl" else ("size", "samples", "scale", "center", "rays", "reach", "calibration")
    for name in options:
        if name not in known:
            raise OptionError(f"{name}: export to {form} knows {', '.join(known)}")
    loaded = load_any(scene)
    made: Exported | Carried
    if form == "glsl":
        from symrender.bridge.glsl import glsl

        made = glsl(in_series(loaded, "export to glsl"), lobe=options.get("lobe", 4))
    else:
        if not isinstance(loaded, RadiometricScene):
            raise Unsupported(
                f"{printable(loaded.name)}: {form}: units of the series (lights that do not fall off, lobes that are "
                "averages) are no renderer's; a scene with units: radiometric says light in W/sr and materials as BRDFs"
            )
        if form == "mitsuba":
            from symrender.bridge.mitsuba import mitsuba

            made = mitsuba(loaded, **options)
        else:
            from symrender.bridge.pbrt import pbrt

            made = pbrt(loaded, **options)
    if path is not None:
        made.save(Path(path), force=force)
    return made
