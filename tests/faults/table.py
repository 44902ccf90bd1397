"""Planted bugs: for each, the words replaced in a file of the package, and the tests that must notice.

A fault is one a hand could make: a sign, an index, a bound, a forgotten case. ``old`` occurs exactly once in its file.
The tests named are the ones that know a right answer from elsewhere; the golden texts, which notice any change at all,
are not among them.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Fault:
    """One planted bug."""

    kind: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]
    what: str


RAYS = ("numeric/test_rays.py",)
BOTH = ("runtimes/test_image.py", "runtimes/test_anchor.py")
UNITS = ("quadrature/test_lobe_units.py",)
KNOWN = ("adversary/test_recorded.py",)
TRACES = ("chambers/test_events_are_complete.py",)
GLEAMS = ("chambers/test_highlights.py", *KNOWN)
MIRROR = ("quadrature/test_mirror.py",)
FAULTS = (
    Fault("intersection", "numeric/rays.py", "discriminant = radius * radius - dot(l, l)",
          "discriminant = toward * toward - power", RAYS, "the discriminant that cancels for far spheres"),
    Fault("intersection", "numeric/rays.py", "return (other, q) if other < q else (q, other)", "return other, q", RAYS,
          "roots in the order they were computed"),
    Fault("intersection", "numeric/rays.py", "return distance if 0.0 < distance", "return distance if -1e9 < distance",
          (*RAYS, "numeric/test_pipeline.py"), "the floor met behind the eye"),
    Fault("intersection", "expression/intersection.py", "return radius**2 - norm2(cross(f, w))",
          "return radius**2 - norm2(f)", ("expression/test_intersection.py", *BOTH),
          "the source chapter's slip: the centre's distance for the ray's"),
    Fault("intersection", "numeric/sight.py", "if leaves == FIRST_SPHERE + j:", "if leaves == j:",
          ("numeric/test_pipeline.py", *BOTH), "a sphere met by the ray that leaves it"),
    Fault("weights", "expression/lobe.py", "return sp.exp(u * log_cos_a) * (-expm1(-u * drop)) / u",
          "return (sp.exp(u * log_cos_a) - sp.exp(u * (log_cos_a - drop))) / u",
          ("quadrature/test_strata.py", "kernel/test_strata.py"), "weights as a difference of powers"),
    Fault("weights", "numeric/lobe.py", "return -math.expm1(math.log1p(-s * mass) / (exponent + 1.0))",
          "return -math.expm1(math.log1p(-s * mass) / (exponent + 2.0))",
          ("numeric/test_samplers.py", "numeric/test_lobe.py"), "importance samples of a lobe one power narrower"),
    Fault("weights", "quadrature/strata.py", "azimuths = (np.arange(sectors) + 0.5)",
          "azimuths = (np.arange(sectors) % 2 + 0.5)", ("quadrature/test_strata.py", *BOTH), "sectors that coincide"),
    Fault("weights", "quadrature/strata.py", "+ np.log(np.diff(bounds))", "+ 0.0 * np.diff(bounds)",
          ("quadrature/test_strata.py",), "midpoint weights without the ring's width"),
    Fault("normaliser", "numeric/lobe.py", "ratio = u * height / mass", "ratio = exponent * height / mass",
          ("numeric/test_lobe.py", "numeric/test_estimators.py"), "n where n + 1 belongs"),
    Fault("normaliser", "expression/lobe.py", "(exponent + 1)) / (exponent + 1)", "(exponent + 1)) / (exponent + 2)",
          ("expression/test_lobe.py", "runtimes/test_anchor.py"), "the n + 2 of another convention"),
    Fault("normaliser", "quadrature/strata.py", "if not normalised:", "if normalised:",
          ("quadrature/test_strata.py",), "the two estimators exchanged"),
    Fault("units", "numeric/estimators.py", "weight *= cosine", "weight *= w[2]", UNITS,
          "the floor's cosine for that of the surface"),
    Fault("units", "kernel/gather.py", "block.set(share, share * cosine)", "block.set(share, share * z)", UNITS,
          "the cosine about the mirror direction for that about the normal"),
    Fault("units", "quadrature/lobe_units.py", "(exponent + 1.0) * mass", "(exponent + 1.0)", UNITS,
          "a cut lobe scaled as a whole one"),
    Fault("units", "quadrature/split_point.py", "share = facing_mass(n, theta_max, tilt, gauss)",
          "share = facing_mass(n, theta_max, 0.0, gauss)", UNITS, "a sky as bright at grazing view as from above"),
    Fault("horizon", "numeric/estimators.py", "if weight > 0.0 and cosine > 0.0:", "if weight > 0.0:",
          ("numeric/test_estimators.py", "numeric/test_pipeline.py", *BOTH), "lobe rays below the horizon let in"),
    Fault("horizon", "kernel/gather.py", "with block.when(cosine <= 0):",
          "with block.when(cosine <= -1):", BOTH, "the same, symbolically"),
    Fault("shadows", "numeric/shading.py", "if light[2] <= 0.0:", "if light[2] <= -1e9:",
          ("numeric/test_shading.py", "numeric/test_lights.py", *BOTH), "light through the floor"),
    Fault("shadows", "numeric/shading.py", "    if toward <= 0.0:\n        return False\n", "",
          ("numeric/test_shading.py", *BOTH), "shadows thrown by what lies behind"),
    Fault("shadows", "expression/intersection.py",
          "return sp.Or(c * end < 0, sp.And(c >= 0, end >= 0, b < 0, a + b > 0, b**2 >= a * c))",
          "return sp.Or(c * end < 0, sp.And(c >= 0, end >= 0, b < 0, b**2 >= a * c))",
          ("expression/test_intersection.py", "expression/test_segment.py"),
          "shadows thrown by what lies beyond the light"),
    Fault("frames", "numeric/lobe.py", "return u1, cross(m, u1)", "return u1, cross(u1, m)",
          ("numeric/test_lobe.py",), "a left-handed frame"),
    Fault("frames", "numeric/lobe.py", "sign = math.copysign(1.0, m[2])", "sign = 1.0", ("numeric/test_lobe.py",),
          "a frame that fails looking down"),
    Fault("frames", "numeric/rays.py", "np.cross(right, forward) * half", "np.cross(forward, right) * half",
          (*RAYS, "numeric/test_pipeline.py", *BOTH), "images upside down"),
    Fault("frames", "expression/camera.py", "return (2 * i + 1) / width - 1", "return 2 * i / width - 1", BOTH,
          "pixel corners for pixel centres"),
    Fault("frames", "expression/lobe.py", "return incoming - normal * (2 * dot(incoming, normal))",
          "return incoming - normal * dot(incoming, normal)", ("expression/test_lobe.py", *BOTH),
          "the mirror direction in the surface"),
    Fault("colour", "images/srgb.py", "encoded = np.where(x <= 0.0031308", "encoded = np.where(x <= 0.04045",
          ("images/test_srgb.py",), "the decoder's threshold in the encoder"),
    Fault("colour", "images/srgb.py", "np.floor(255.0 * encoded + 0.5)", "np.floor(255.0 * encoded)",
          ("images/test_srgb.py",),
          "truncation for rounding"),
    Fault("colour", "numeric/shading.py", "red += world.lights[index].color[0]", "red += world.lights[index].color[1]",
          ("numeric/test_shading.py", *BOTH), "green light into red"),
    Fault("colour", "quadrature/disk.py", "c / (k * k)", "c / k", ("quadrature/test_disk.py", *BOTH),
          "a disk brighter than its colour"),
    Fault("colour", "expression/shading.py", "return 2 * cosine * dot(normal, view_dir)",
          "return cosine * dot(normal, view_dir)", BOTH, "a Phong lobe about the wrong axis"),
    Fault("texture", "expression/texture.py", "sp.floor((y - offset_y) / cell)", "sp.floor((y + offset_y) / cell)",
          ("expression/test_floor_offset.py",), "a chessboard moved the other way"),
    Fault("texture", "expression/texture.py", "return current, 2 * z * current - previous",
          "return current, 2 * z * current + previous", ("expression/test_texture.py",), "a recurrence with a plus"),
    Fault("tiling", "execution/tiles.py", "yield x, y, min(x + side, width), min(y + side, height)",
          "yield x, y, min(x + side, width - 1), min(y + side, height)",
          ("execution/test_tiles.py", "execution/test_fill.py"),
          "the last column forgotten"),
    Fault("tiling", "execution/jobs.py", "layer[y0:y1, x0:x1]", "layer[x0:x1, y0:y1]",
          ("execution/test_fill.py",), "rows for columns"),
    Fault("tiling", "execution/fill.py", "work = [tile for tile in all_tiles if tile not in left.tiles]",
          "work = all_tiles",
          ("execution/test_fill.py",), "everything rendered again after an interruption"),
    Fault("tiling", "execution/cluster.py", "block[...] = done.blocks[name]", "block[...] = block",
          ("execution/test_cluster.py",),
          "what workers return thrown away"),
    Fault("tiling", "execution/cluster.py", "return ipaddress.ip_address(host).is_loopback", "return True",
          ("execution/test_cluster.py",), "strangers taken for this machine"),
    Fault("truth", "execution/finite.py", 'np.isnan(layers["error"])', 'np.isneginf(layers["error"])',
          ("test_truth.py",),
          "an error that is not a number let out"),
    Fault("truth", "runtimes/truth.py", 'layers["radiance"][pixels] += weights[surface] * found.gloss',
          'layers["radiance"][pixels] += found.gloss', ("test_truth.py",), "the lobe's weight forgotten"),
    Fault("scene", "scene/arrays.py", "MIN_LENGTH if place in earlier else sphere.radius", "sphere.radius",
          ("runtimes/test_properties.py",), "equal spheres that shade each other"),
    Fault("scene", "scene/arrays.py", "return lobe.weight, lobe.exponent, 0.0 if lobe.mirror else lobe.theta_max",
          "return lobe.weight, lobe.exponent, lobe.theta_max", ("runtimes/test_degenerate.py",),
          "a mirror that is a lobe"),
    Fault("journal", "execution/journal.py", "if zlib.crc32(body) == check:", "if body:",
          ("execution/test_journal.py",),
          "damaged records trusted"),
    Fault("journal", "execution/journal.py", 'if note.get("run") == self.digest and (entry', "if (entry",
          ("execution/test_journal.py",),
          "tiles of another run taken"),
    Fault("journal", "execution/jobs.py", 'CHANGES_NO_BYTE: Final = ("threads", "tile", "max_pixels")',
          'CHANGES_NO_BYTE: Final = ("threads", "tile", "max_pixels", "lobe")', ("execution/test_fill.py",),
          "a setting that decides the image left out of the key"),
    Fault("output", "images/output.py", "if temporary.read_bytes() != data:", "if False:", ("images/test_output.py",),
          "a failing disk believed"),
    Fault("highlights", "chambers/highlights.py", "if log_felt(level, max(0.0, chord - varies), shininess) < 0.0:",
          "if log_felt(level, chord, shininess) < 0.0:", GLEAMS, "a highlight judged by the middle of its box"),
    Fault("highlights", "chambers/highlights.py", "chart.least = NEGLIGIBLE * tol /", "chart.least = 1e9 * tol /",
          KNOWN, "highlights above the tolerance left out"),
    Fault("events", "chambers/traces.py", "wanted = j != i and (not both or j < i)", "wanted = j != i and not both",
          TRACES, "pairs of traced curves left out"),
    Fault("events", "chambers/traces.py", "    n = contacts(view, work, events, n, low, high)\n", "", TRACES,
          "outlines that pass over into circles left out"),
    Fault("checker", "quadrature/split_grid.py", "if wide < MOST_REACH * cell:", "if wide < 0.0:", KNOWN,
          "far squares looked for about the foot, not where the lobe is"),
    Fault("mirror", "quadrature/mirror.py", "if 0.0 < t < nearest:", "if 0.0 < t:", MIRROR,
          "a mirror that shows the last sphere, not the first"),
    Fault("mirror", "quadrature/mirror.py", "% 2 == 0\n", "% 2 == 1\n", MIRROR, "dark squares for bright in a mirror"),
    Fault("mirror", "quadrature/split_point.py", "total += largest_gap(value, scratch[31:34])", "total += 0.0",
          MIRROR, "a lobe that is nearly a mirror, stated as one"),
    Fault("budget", "chambers/work.py", "max(work.counts.evaluations, work.counts.labour) >",
          "work.counts.evaluations >", ("quadrature/test_budget.py",), "work that is not shading left uncounted"),
    Fault("budget", "quadrature/split_point.py", "status[i] = CAPPED if bad == 0 or is_spent(work) else NEAR_TANGENT",
          "status[i] = NEAR_TANGENT", ("quadrature/test_budget.py", "quadrature/test_split_point.py"),
          "a spent budget called a tangency"),
    Fault("cache", "jit/entries.py", "if hashlib.sha256(content).digest() == data[:_DIGEST_BYTES] else None",
          "if data else None", ("test_kernel_cache.py",), "a damaged kernel run"),
)  # fmt: skip
