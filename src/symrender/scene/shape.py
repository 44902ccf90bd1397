"""Shapes: spheres and the floor plane z = 0."""

from __future__ import annotations

from symrender.scene.lobe import Lobe
from symrender.scene.texture import FloorChecker, FloorTexture, Solid, SphereTexture
from symrender.scene.values import Albedo, Length, Part, PartName, Point3


class Sphere(Part):
    """A sphere; what is below the floor is invisible from above."""

    name: PartName
    center: Point3
    radius: Length
    color: Albedo = (0.5, 0.5, 0.5)
    texture: SphereTexture = Solid()
    lobe: Lobe | None = None


class Floor(Part):
    """The plane z = 0, seen from above; from below it is black."""

    texture: FloorTexture = FloorChecker()
    lobe: Lobe | None = None
