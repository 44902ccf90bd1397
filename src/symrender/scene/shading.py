"""How a lit point is shaded, for the whole scene."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from symrender.scene.values import Part, Share, Shininess


class Shading(Part):
    """Direct light at Q: ka ambient + sum over lights color V (kd albedo max(0, N.l) + ks s).

    s = max(0, N.h)^shininess with h = unit(l + v) (``blinn``) or max(0, r.v)^shininess with r = 2 (N.l) N - l
    (``phong``). ``highlight_view`` says whose v a reflected highlight uses: the reflecting point's (``ray``) or
    the camera's (``eye``, the source chapter's choice). ``specular_terminator`` says whether s is cut where
    N.l < 0 (``cut``) or not (``open``, the source chapter's choice). ``lobe_units`` says what all lobes of the scene
    compute: the mean of radiance under cos^n theta (``lobe_average``), or the integral of a BRDF of value
    (n + 2)/(2 pi) cos^n theta, with the surface cosine inside (``brdf_normalised``).
    """

    model: Annotated[Literal["blinn", "phong"], Field(description="the highlight")] = "blinn"
    ka: Annotated[Share, Field(description="weight of the ambient light")] = 0.1
    kd: Annotated[Share, Field(description="weight of the diffuse term")] = 0.7
    ks: Annotated[Share, Field(description="weight of the highlight")] = 0.5
    shininess: Annotated[Shininess, Field(description="exponent of the highlight")] = 32.0
    highlight_view: Annotated[Literal["ray", "eye"], Field(description="whose view a reflected highlight uses")] = "ray"
    specular_terminator: Annotated[
        Literal["cut", "open"], Field(description="whether a highlight ends where N.l < 0")
    ] = "cut"
    lobe_units: Annotated[Literal["lobe_average", "brdf_normalised"], Field(description="what every lobe computes")] = (
        "lobe_average"
    )
