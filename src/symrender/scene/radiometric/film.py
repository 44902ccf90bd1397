"""Size and filter of the image that a file of another renderer asks for; no value depends on them."""

from __future__ import annotations

from typing import Annotated, Final, Literal

from pydantic import Field

from symrender.scene.values import Part

_MOST: Final = 1 << 20

Pixels = Annotated[int, Field(ge=1, le=_MOST)]


class Film(Part):
    """Size and reconstruction filter that a file of Mitsuba or pbrt asks for; options of a render stand above it."""

    width: Annotated[Pixels, Field(description="pixels in a row")]
    height: Annotated[Pixels, Field(description="rows")]
    filter: Annotated[
        Literal["box", "tent", "gaussian", "mitchell", "catmullrom", "lanczos"],
        Field(description="reconstruction filter that the file asks for; not all of them are available"),
    ] = "box"
    filter_radius: Annotated[
        Annotated[float, Field(gt=0, le=64)] | None, Field(description="half the width of the filter, pixels")
    ] = None
    notes: Annotated[str, Field(max_length=2000, description="what of the file is not done as it says")] = ""
