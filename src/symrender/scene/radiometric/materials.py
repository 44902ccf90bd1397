"""Materials: what share of the light that arrives leaves, and where to."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from symrender.scene.radiometric.bump import Bump
from symrender.scene.radiometric.textures import Checkerboard, Image
from symrender.scene.radiometric.values import Alpha, Extinctions, Indices, Power, Shares
from symrender.scene.values import Length, Part


class Solid(Part):
    """One reflectance everywhere."""

    type: Literal["solid"] = "solid"
    color: Annotated[Shares, Field(description="reflectance")] = (0.5, 0.5, 0.5)


class Checker(Part):
    """Fields of two reflectances, bright where floor(x/cell) + floor(y/cell) is even.

    On a plane (x, y) is the place in the plane's own coordinates, a length; on a sphere x = (phi + pi)/pi and
    y = theta/pi, with phi the azimuth and theta the polar angle of the normal, so that x runs from 0 to 2, y from 0
    to 1, and a cell is a part of a half turn.
    """

    type: Literal["checker"] = "checker"
    bright: Annotated[Shares, Field(description="reflectance of the bright fields")] = (0.75, 0.75, 0.75)
    dark: Annotated[Shares, Field(description="reflectance of the dark fields")] = (0.15, 0.15, 0.15)
    cell: Annotated[Length, Field(description="side of a field: a length on a plane, half turns on a sphere")] = 1.0


class Stripes(Part):
    """Stripes of two reflectances, bright where floor(x/cell) is even, with the x of a checker."""

    type: Literal["stripes"] = "stripes"
    bright: Annotated[Shares, Field(description="reflectance of the bright stripes")] = (0.75, 0.75, 0.75)
    dark: Annotated[Shares, Field(description="reflectance of the dark stripes")] = (0.15, 0.15, 0.15)
    cell: Annotated[Length, Field(description="width of a stripe: a length on a plane, half turns on a sphere")] = 1.0


class Marble(Part):
    """Smooth veins: dark + m (bright - dark), m = (1 + sin(2 pi (x + .35 sin(3 pi y))))/2; x, y as of a checker.

    x and y are counted in cells.
    """

    type: Literal["marble"] = "marble"
    bright: Annotated[Shares, Field(description="reflectance between the veins")] = (0.75, 0.75, 0.75)
    dark: Annotated[Shares, Field(description="reflectance of the veins")] = (0.15, 0.15, 0.15)
    cell: Annotated[Length, Field(description="width of a vein: a length on a plane, half turns on a sphere")] = 1.0


def _textured(value: Any) -> Any:
    """A number or three channels are a solid reflectance."""
    return {"type": "solid", "color": value} if isinstance(value, int | float | list | tuple) else value


Reflectance = Annotated[
    Solid | Checker | Stripes | Marble | Checkerboard | Image, Field(discriminator="type"), BeforeValidator(_textured)
]


class Diffuse(Part):
    """Lambert's surface: f = reflectance/pi."""

    type: Literal["diffuse"] = "diffuse"
    reflectance: Annotated[Reflectance, Field(description="share that is reflected, a number, three, or a texture")] = (
        Solid()
    )
    two_sided: Annotated[bool, Field(description="whether it reflects on both sides, else it is black behind")] = False
    bump: Annotated[Bump | None, Field(description="what turns its normals, or nothing")] = None


class Conductor(Part):
    """Rough metal: f = reflectance D F G/(4 cos_i cos_o), D isotropic, F of a conductor, without further bounces.

    ``masking`` separable is G = G1(i) G1(o), correlated 1/G = 1/G1(i) + 1/G1(o) - 1 (height-correlated). ``g1`` walter
    is the rational fit of Beckmann's G1, exactly 1 from 1/(alpha tan theta) = 1.6 on, where it jumps by 5.7e-5.
    """

    type: Literal["conductor"] = "conductor"
    distribution: Annotated[Literal["ggx", "beckmann"], Field(description="of the normals of its facets")] = "ggx"
    alpha: Annotated[Alpha, Field(description="roughness, as it stands in D")]
    eta: Annotated[Indices, Field(description="real part of the index of refraction, a number or three")]
    k: Annotated[Extinctions, Field(description="imaginary part of it, a number or three")]
    masking: Annotated[Literal["separable", "correlated"], Field(description="how G is made of both G1")] = "separable"
    g1: Annotated[Literal["exact", "walter"], Field(description="Smith's G1 of beckmann, or its fit")] = "exact"
    reflectance: Annotated[Reflectance, Field(description="a factor, a number, three, or a texture")] = Solid(
        color=(1.0, 1.0, 1.0)
    )
    two_sided: Annotated[bool, Field(description="whether it reflects on both sides, else it is black behind")] = False
    bump: Annotated[Bump | None, Field(description="what turns its normals, or nothing")] = None

    @model_validator(mode="after")
    def _fits_its_distribution(self) -> Self:
        if self.g1 == "walter" and self.distribution != "beckmann":
            raise PydanticCustomError("scene", "g1: walter is a fit to beckmann, got it with distribution ggx")
        return self


class Phong(Part):
    """Cosine power about the mirror direction: f = reflectance (n + 2)/(2 pi) cos^n."""

    type: Literal["phong"] = "phong"
    exponent: Annotated[Power, Field(description="n, the cosine power")]
    reflectance: Annotated[Reflectance, Field(description="a factor, a number, three, or a texture")] = Solid()
    two_sided: Annotated[bool, Field(description="whether it reflects on both sides, else it is black behind")] = False
    bump: Annotated[Bump | None, Field(description="what turns its normals, or nothing")] = None


Material = Annotated[Diffuse | Conductor | Phong, Field(discriminator="type")]
