"""The tables of a scene's shapes, as the functions of the program read them."""

from __future__ import annotations

from symrender.kernel.program import Records
from symrender.scene.records import Floor, Plane, Sphere

SPHERES = Records("spheres", 2, Sphere)
FLOOR = Records("floor", 1, Floor)
PLANES = Records("planes", 2, Plane)
