"""Materials: what share of the light that arrives leaves, and where to."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from symrender.limits import MIN_INDEX
from symrender.scene.nearest import did_you_mean
from symrender.scene.printable import shown
from symrender.scene.radiometric.bump import Bump
from symrender.scene.radiometric.metals import METALS
from symrender.scene.radiometric.textures import Checkerboard, Image
from symrender.scene.radiometric.values import Alpha, Extinctions, Index, MetalIndices, Power, Shares
from symrender.scene.root import wrong
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


Distribution = Annotated[Literal["ggx", "beckmann"], Field(description="of the normals of its facets")]
Masking = Annotated[Literal["separable", "correlated"], Field(description="how G is made of both G1")]
SmithG1 = Annotated[Literal["exact", "walter"], Field(description="Smith's G1 of beckmann, or its fit")]
Roughness = Annotated[Alpha, Field(description="roughness, as it stands in D; 0 is smooth")]


def _check_g1(g1: str, distribution: str) -> None:
    """Raise PydanticCustomError for the fit of another distribution's G1."""
    if g1 == "walter" and distribution != "beckmann":
        raise PydanticCustomError("scene", f"g1: walter is a fit to beckmann, got it with distribution {distribution}")


class Conductor(Part):
    """Metal, rough or smooth: f = reflectance D F G/(4 cos_i cos_o), D isotropic, F of a conductor.

    Light that facets send to each other is not followed. With ``alpha`` 0 it is a mirror: the share ``reflectance`` F
    of light goes into the mirror direction.
    ``masking`` separable is G = G1(i) G1(o), correlated 1/G = 1/G1(i) + 1/G1(o) - 1 (height-correlated). ``g1`` walter
    is the rational fit of Beckmann's G1, exactly 1 from 1/(alpha tan theta) = 1.6 on, where it jumps by 5.7e-5.
    ``material`` stands for the ``eta`` and ``k`` of a metal by name, which the scene then holds; ``none`` is a mirror
    that takes no light.
    """

    type: Literal["conductor"] = "conductor"
    material: Annotated[
        str,
        Field(exclude=True, description="a metal by its symbol, Au, Ag, Cu, Al, Cr and others, in place of eta and k"),
    ] = ""
    distribution: Distribution = "ggx"
    alpha: Roughness
    eta: Annotated[MetalIndices, Field(description="real part of the index of refraction, a number or three")]
    k: Annotated[Extinctions, Field(description="imaginary part of it, a number or three")]
    masking: Masking = "separable"
    g1: SmithG1 = "exact"
    reflectance: Annotated[Reflectance, Field(description="a factor, a number, three, or a texture")] = Solid(
        color=(1.0, 1.0, 1.0)
    )
    two_sided: Annotated[bool, Field(description="whether it reflects on both sides, else it is black behind")] = False
    bump: Annotated[Bump | None, Field(description="what turns its normals, or nothing")] = None

    @model_validator(mode="before")
    @classmethod
    def _is_named(cls, data: Any) -> Any:
        """The indices of a metal that is named."""
        if not isinstance(data, dict) or not isinstance(name := data.get("material"), str) or not name:
            return data
        if name not in METALS:
            guess = did_you_mean(name, METALS) or f", known are {', '.join(METALS)}"
            raise wrong(f"unknown metal {shown(name)}{guess}", "material")
        if "eta" in data or "k" in data:
            raise wrong("stands for eta and k, which are given too", "material")
        eta, k = METALS[name]
        return {key: value for key, value in data.items() if key != "material"} | {"eta": eta, "k": k}

    @model_validator(mode="after")
    def _is_a_conductor(self) -> Self:
        _check_g1(self.g1, self.distribution)
        for eta, k in zip(self.eta, self.k, strict=True):
            if eta < MIN_INDEX and not (eta == 0.0 and k > 0.0):
                raise wrong(f"must be at least {MIN_INDEX:g}, or 0 with a k above 0, got {eta:g}", "eta")
        return self


class Phong(Part):
    """Cosine power about the mirror direction: f = reflectance (n + 2)/(2 pi) cos^n."""

    type: Literal["phong"] = "phong"
    exponent: Annotated[Power, Field(description="n, the cosine power")]
    reflectance: Annotated[Reflectance, Field(description="a factor, a number, three, or a texture")] = Solid()
    two_sided: Annotated[bool, Field(description="whether it reflects on both sides, else it is black behind")] = False
    bump: Annotated[Bump | None, Field(description="what turns its normals, or nothing")] = None


class Dielectric(Part):
    """Glass: light is reflected by its surface, or refracted through it, on both sides; nothing is absorbed.

    ``ior`` is the index of the inside, where the shape's normal points away from, over that of the outside. Smooth
    (``alpha`` 0) the share F goes into the mirror direction and 1 - F into that of Snell's law; F is Fresnel's of
    unpolarised light. Rough, facets do the same: B. Walter, Marschner, Li, Torrance, "Microfacet models for refraction
    through rough surfaces", EGSR 2007 (doi:10.2312/EGWR/EGSR07/195-206). Radiance is divided by the square of the
    relative index where it goes through. ``thin`` is a pane without thickness: with the reflections between its two
    faces it sends 2 F/(1 + F) back and the rest straight on. A shadow ray ends at glass.
    """

    two_sided: ClassVar[bool] = True
    bump: ClassVar[None] = None

    type: Literal["dielectric"] = "dielectric"
    ior: Annotated[Index, Field(description="index of the inside over that of the outside")]
    alpha: Roughness = 0.0
    thin: Annotated[bool, Field(description="whether it is a pane without thickness, which bends no ray")] = False
    distribution: Distribution = "ggx"
    masking: Masking = "separable"
    g1: SmithG1 = "exact"
    reflectance: Annotated[
        Reflectance, Field(description="a factor of what it reflects: a number, three, or a texture")
    ] = Solid(color=(1.0, 1.0, 1.0))
    transmittance: Annotated[Shares, Field(description="a factor of what goes through, a number or three")] = (
        1.0,
        1.0,
        1.0,
    )

    @model_validator(mode="after")
    def _is_glass(self) -> Self:
        _check_g1(self.g1, self.distribution)
        if self.thin and self.alpha:
            raise wrong(f"must be 0 of a pane that is thin, got {self.alpha:g}", "alpha")
        if self.alpha and self.ior == 1.0:
            raise wrong("must not be 1 of a rough dielectric: its facets would bend no ray", "ior")
        return self


class Plastic(Part):
    """A diffuse base under a smooth or rough dielectric layer, with the light that is reflected between the two.

    f = ``specular`` times the reflection of the layer, as of a ``dielectric``, + rho T(i) T(o)/(pi ior^2 (1 - rho R)),
    rho = ``diffuse``, T the share of light from a direction that the layer lets through, R the share that it returns of
    diffuse light from within. Without ``nonlinear`` the denominator has R in place of rho R, so that colours keep their
    saturation. This is the `plastic` of Mitsuba 3 and, with ``alpha`` above 0, its `roughplastic`, with their R and T:
    smooth, T = 1 - F and R is the fit of Egan and Hilgeman (1973) or of d'Eon and Irving (2011); rough, T and R are
    those of facets, T linear between 64 cosines.
    """

    type: Literal["plastic"] = "plastic"
    ior: Annotated[Index, Field(description="index of the layer over that of the outside")]
    alpha: Roughness = 0.0
    diffuse: Annotated[Reflectance, Field(description="reflectance of the base, a number, three, or a texture")] = (
        Solid()
    )
    specular: Annotated[Shares, Field(description="a factor of what the layer reflects, a number or three")] = (
        1.0,
        1.0,
        1.0,
    )
    nonlinear: Annotated[bool, Field(description="whether light between base and layer changes colours")] = False
    distribution: Distribution = "ggx"
    masking: Masking = "separable"
    g1: SmithG1 = "exact"
    two_sided: Annotated[bool, Field(description="whether it reflects on both sides, else it is black behind")] = False
    bump: Annotated[Bump | None, Field(description="what turns its normals, or nothing")] = None

    @model_validator(mode="after")
    def _is_plastic(self) -> Self:
        _check_g1(self.g1, self.distribution)
        return self

    @property
    def reflectance(self) -> Reflectance:
        """What its texture changes."""
        return self.diffuse


Material = Annotated[Diffuse | Conductor | Phong | Dielectric | Plastic, Field(discriminator="type")]
