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
    """Write a scene for another renderer: its formulas in GLSL, or the scene for Mitsuba 3 or pbrt-v4.

    Parameters
    ----------
    scene : str, path, mapping or scene
        In units of the series for GLSL, radiometric for Mitsuba and pbrt.
    form : {"glsl", "mitsuba", "pbrt"}
        What is written.
    path : str or path, optional
        File (GLSL) or folder that is written.
    force : bool
        Replace existing files.
    **options : dict
        For GLSL ``lobe``; for the others ``size``, ``samples``, ``scale``, ``center``, ``rays``, ``reach`` and
        ``calibration``, as on the command line.

    Returns
    -------
    Exported or Carried
        The texts, with test vectors (GLSL) or a receipt.

    Raises
    ------
    OptionError
        The form or an option does not exist, or python-flint is missing for GLSL.
    Unsupported
        The other renderer cannot state the scene.
    OutputError
        A file cannot be written, or exists and ``force`` is false.

    Notes
    -----
    GLSL ES 3.00 comes with vectors whose true results are enclosed by ball arithmetic. Mitsuba and pbrt get a program
    that renders the scene and keeps moments, as ``audit`` reads them.

    Examples
    --------
    >>> import symrender as sr
    >>> made = sr.export("metal", "mitsuba", size=(64, 32), rays="centre")
    >>> sorted(made.files)
    ['receipt.json', 'run.py', 'scene.xml']
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
