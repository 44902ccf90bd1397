"""Every public limit, in one table.

An input beyond a limit is refused with an error that names the limit, before anything is allocated.
"""

from __future__ import annotations

from typing import Final

MAX_FILE_BYTES: Final = 1 << 21
"""Largest scene file, bytes."""
MAX_FOREIGN_BYTES: Final = 1 << 25
"""Largest scene file of another renderer, and most bytes of all files that one includes: they may hold meshes."""
MAX_DEPTH: Final = 32
"""Deepest nesting of a scene file."""
MAX_KEYS: Final = 100_000
"""Most keys and items in a scene file: as many spheres as there may be, all of them told in full, take 73,813."""
MAX_ITEMS: Final = 1 << 20
"""Most keys and items of a scene that Python holds, or that symrender wrote: those of all triangles there may be."""
MAX_MAPPING: Final = 64
"""Most keys of one mapping in a scene file."""
MAX_NAME: Final = 100
"""Longest name of a scene, characters."""
MAX_PART_NAME: Final = 32
"""Longest name of a sphere, a plane or a light, characters."""
MAX_SPHERES: Final = 4096
"""Most spheres in a scene."""
MAX_PLANES: Final = 16
"""Most planes in a scene, beside its floor."""
MAX_SHAPES: Final = 1024
"""Most shapes in a radiometric scene."""
MAX_TRIANGLES: Final = 1_000_000
"""Most triangles of all meshes in a radiometric scene together, and most vertices of one mesh."""
MAX_QUADRATURE_TRIANGLES: Final = 100_000
"""Most triangles that quadrature takes: 1 GB of memory; the path tracer takes ``MAX_TRIANGLES``."""
MAX_MESH_BYTES: Final = 1 << 28
"""Largest file of a mesh, bytes: an OBJ of 10^6 triangles with normals and texture coordinates has 130 MB."""
MAX_PICTURE_BYTES: Final = 1 << 27
"""Largest file of an image that a scene names, bytes."""
MAX_PICTURE_PIXELS: Final = 1 << 25
"""Most pixels of an image that a scene names, 8192 x 4096: 800 MB of memory."""
MAX_LIGHTS: Final = 256
"""Most lights in a scene."""
MAX_BOUNCES: Final = 1024
"""Most reflections beyond the direct light that a scene may ask for by number."""
MAX_LIGHT_POINTS: Final = 65_536
"""Most points all disk lights together are replaced by under a K x K rule."""
MAX_PIXELS: Final = 1 << 28
"""Most pixels in an image, unless ``max_pixels`` says otherwise."""
MAX_SILHOUETTES: Final = 8
"""Largest K of the K x K points of a pixel beside another shape."""
MIN_FILTER_RADIUS: Final = 0.5
"""Least half width of a filter's support, pixels."""
MAX_FILTER_RADIUS: Final = 2.0
"""Largest half width of a filter's support, pixels."""
MAX_LOBE: Final = 4096
"""Largest K of the K x K lobe strata."""
MAX_DISK: Final = 256
"""Largest K of the K x K disk strata."""
MAX_EXPONENT: Final = 1e12
"""Largest lobe exponent; beyond it, ask for ``mirror: true``."""
MAX_COORDINATE: Final = 1e12
"""Largest magnitude of a coordinate, scene units."""
MIN_LENGTH: Final = 1e-150
"""Smallest radius; the square of anything shorter is not a normal number."""
MAX_RADIANCE: Final = 1e12
"""Largest colour component of a light, scene units of radiance."""
MAX_SHININESS: Final = 1e9
"""Largest exponent of a highlight."""
MIN_ALPHA: Final = 1e-4
"""Smallest roughness of a conductor."""
MIN_INDEX: Final = 1e-3
"""Smallest real part of a conductor's index of refraction; below it Fresnel's formula loses digits."""
MAX_INDEX: Final = 1e3
"""Largest real or imaginary part of a conductor's index of refraction."""
MAX_TIME: Final = 1e6
"""Farthest the shutter opens and closes from time 0, seconds."""
MAX_TEXTURE_FREQUENCY: Final = 4096
"""Largest number of texture half-periods around a sphere."""
MAX_FORMULA_DEPTH: Final = 12
"""Most operations of a height field's formula inside each other."""
MAX_TERMS: Final = 64
"""Most numbers, coordinates and operations of a height field's formula."""
MAX_OPERANDS: Final = 16
"""Most formulas in one sum or product."""
MAX_FORMULA_POWER: Final = 16
"""Largest power of a formula."""
MAX_THREADS: Final = 1024
"""Most worker threads."""
MIN_TOLERANCE: Final = 1e-13
"""Smallest tolerance double precision can meet."""
MAX_PRODUCT_EXPONENT: Final = 1024
"""Largest whole power a kernel computes by products."""
MAX_TEXTURE_DEGREE: Final = 64
"""Largest frequency whose texture sign a kernel computes as a polynomial."""
MAX_FOOTPRINT_LINES: Final = 4096
"""Most checker lines the contour of a pixel's footprint may cross; beyond, the checker is its mean."""
MAX_SIMULATOR_SPHERES: Final = 60
"""Most spheres of a scene in the simulator: a uniform block of a GPU holds no more."""
MAX_SIMULATOR_PLANES: Final = 8
"""Most planes of a scene in the simulator, beside its floor."""
MAX_SIMULATOR_LOBES: Final = 64
"""Most surfaces of a scene in the simulator, its floor (counted also where there is none), spheres and planes."""
MAX_SIMULATOR_LIGHT_POINTS: Final = 128
"""Most points all lights together are replaced by in the simulator."""
MAX_SIMULATOR_LOBE: Final = 16
"""Largest K of the K x K strata in the simulator."""
MAX_SIMULATOR_PLACES: Final = 8
"""Largest n of the n x n places within a pixel of the simulator."""
MAX_SIMULATOR_INSTANTS: Final = 16
"""Most instants of the shutter's time in the simulator."""
MAX_SIMULATOR_RINGS: Final = 4
"""Most rings of places on the lens of the simulator, each of as many places as four times their number."""
MAX_LISTED_LOBE: Final = 32
"""Most K of a rule that an exported text lists direction by direction."""
MAX_STATE_BYTES: Final = 1 << 16
"""Longest state of a simulator read from a URL, bytes."""
MAX_AUDIT_PIXELS: Final = 1 << 26
"""Most pixels of all renders of an audit together."""
MAX_AUDIT_SAMPLES: Final = 1 << 40
"""Most samples a pixel that an audit is told of."""
MIN_SEEDS: Final = 8
"""Fewest images whose scatter is taken for a variance."""
MAX_SEEDS: Final = 1024
"""Most images of one audit."""
