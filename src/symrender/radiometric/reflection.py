"""What a material makes of light from one direction: its texture, and f cos_i channel by channel."""

from __future__ import annotations

import math

from symrender.jit.marks import inlined, jitable
from symrender.leaves import radiometric as leaves
from symrender.leaves import values
from symrender.radiometric.vectors import Vector, dot, minus, vector
from symrender.radiometric.world import World
from symrender.scene.arrays import CHECKER, MARBLE, SOLID, STRIPES
from symrender.scene.radiometric.arrays import BECKMANN, CONDUCTOR, DIFFUSE, SPHERE
from symrender.scene.radiometric.records import Material


@inlined
def even(x: float) -> bool:
    """Whether the field that holds x is an even one."""
    return x - 2.0 * math.floor(0.5 * x) < 1.0


@jitable
def reflectance(world: World, own: int, place: Vector) -> Vector:
    """Reflectance of piece ``own`` at a place of it."""
    piece = world.pieces[own]
    material = world.materials[int(piece.material)]
    share = 1.0
    if material.texture != SOLID:
        if piece.kind == SPHERE:
            outward = minus(place, vector(piece.place))
            r = piece.radius
            x, y = leaves.sphere_turns(outward[0] / r, outward[1] / r, outward[2] / r)
        else:
            x, y = leaves.plane_place(*place, *vector(piece.place), *vector(piece.east), *vector(piece.north))
        x, y = x / material.cell, y / material.cell
        if material.texture == MARBLE:
            share = leaves.vein_share(x, y)
        elif material.texture == CHECKER:
            share = 1.0 if even(x) == even(y) else 0.0
        elif material.texture == STRIPES:
            share = 1.0 if even(x) else 0.0
    dark, bright = material.dark, material.bright
    return (
        leaves.field_channel(dark[0], bright[0], share),
        leaves.field_channel(dark[1], bright[1], share),
        leaves.field_channel(dark[2], bright[2], share),
    )


@jitable
def masking(material: Material, inward: float, outward: float) -> float:
    """G of a conductor at the cosines of light and view."""
    if material.density == BECKMANN:
        if material.walter != 0.0:
            a, b = leaves.walter_masking(inward, material.alpha), leaves.walter_masking(outward, material.alpha)
        else:
            a, b = leaves.beckmann_masking(inward, material.alpha), leaves.beckmann_masking(outward, material.alpha)
    else:
        a, b = leaves.ggx_masking(inward, material.alpha), leaves.ggx_masking(outward, material.alpha)
    return leaves.correlated_masking(a, b) if material.correlated != 0.0 else leaves.separable_masking(a, b)


@jitable
def reflected(material: Material, albedo: Vector, normal: Vector, view: Vector, light: Vector) -> Vector:
    """f cos_i of unit vectors to the eye and to the light, both above the surface."""
    inward, outward = dot(normal, light), dot(normal, view)
    if inward <= 0.0 or outward <= 0.0:
        return (0.0, 0.0, 0.0)
    if material.kind == DIFFUSE:
        share = leaves.diffuse_reflection(inward)
        return (albedo[0] * share, albedo[1] * share, albedo[2] * share)
    if material.kind == CONDUCTOR:
        cosine, sine2, incidence = leaves.half_angles(*normal, *view, *light)
        if material.density == BECKMANN:
            density = leaves.beckmann_density(cosine, sine2, material.alpha)
        else:
            density = leaves.ggx_density(cosine, sine2, material.alpha)
        shade = masking(material, inward, outward)
        eta, k = material.eta, material.k
        red = leaves.conductor_fresnel(incidence, eta[0], k[0])
        green = leaves.conductor_fresnel(incidence, eta[1], k[1])
        blue = leaves.conductor_fresnel(incidence, eta[2], k[2])
        return (
            albedo[0] * leaves.facet_reflection(density, shade, red, outward),
            albedo[1] * leaves.facet_reflection(density, shade, green, outward),
            albedo[2] * leaves.facet_reflection(density, shade, blue, outward),
        )
    axis = values.mirror_direction(-view[0], -view[1], -view[2], *normal)
    scale = leaves.phong_scale(material.exponent, inward)
    share = values.lobe_density(values.lobe_chord(*light, *axis), material.exponent, -math.log(scale))
    return (albedo[0] * share, albedo[1] * share, albedo[2] * share)
