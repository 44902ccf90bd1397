"""As the exponent grows the lobe's average closes on the mirror, like 1/n where the mirror ray is far from every wall.

A pixel is near a wall when some ray within REACH of its mirror ray meets another shape, another colour of a checker,
or another set of lit light points; there the approach is slower.
"""

from __future__ import annotations

import math

import numpy as np
from measure import Report, arguments

from symrender.numeric.lights import light_points
from symrender.numeric.pipeline import trace
from symrender.render import render
from symrender.scene import arrays as at
from symrender.scene.arrays import SceneArrays, scene_arrays
from symrender.scene.load import load
from symrender.scene.scene import Scene

REACH = 6.0
"""Lobe widths 1/sqrt(n) of the widest lobe."""
SIGNAL = 0.02
RINGS, SECTORS = 4, 24


def unit(v: np.ndarray) -> np.ndarray:
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def floor_points(scene: Scene, size: int) -> tuple[np.ndarray, np.ndarray]:
    """Where the ray of every pixel of a look-at camera meets the plane z = 0, and its mirror direction, (h, w, 3)."""
    camera = scene.camera
    forward = unit(np.array(camera.target) - camera.eye)
    right = unit(np.cross(forward, camera.up))
    screen = (2 * (np.arange(size) + 0.5) / size - 1) * math.tan(math.radians(camera.fov) / 2)
    across, up = np.meshgrid(screen, -screen)
    rays = unit(forward + across[..., None] * right + up[..., None] * np.cross(right, forward))
    with np.errstate(divide="ignore"):
        points = np.array(camera.eye) - rays * (camera.eye[2] / rays[..., 2:])
    return points, rays * (1.0, 1.0, -1.0)


def labels(arrays: SceneArrays, origin: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """What a ray from the floor sees, as whole numbers: shape, side of its checker, which light points reach it."""
    _, shape, distance = trace(arrays, origin, direction, at.FLOOR)
    met = shape != at.NOTHING
    rows = np.zeros((len(shape), 2 + len(light_points(arrays.lights, 2)[0])), dtype=np.int64)
    rows[:, 0] = shape
    j = shape[met].astype(int) - at.FIRST_SPHERE
    sphere = np.asarray(arrays.spheres)[j]
    q = origin[met] + distance[met, None] * direction[met]
    n = unit(q - sphere["center"])
    u, v = (np.arctan2(n[:, 1], n[:, 0]) + np.pi) / (2 * np.pi), np.arccos(np.clip(n[:, 2], -1, 1)) / np.pi
    side = np.sin(np.pi * u * sphere["ku"]) * np.sin(np.pi * v * sphere["kv"]) >= 0
    rows[met, 1] = side & (sphere["texture"] == at.CHECKER)
    for k, light in enumerate(light_points(arrays.lights, 2)[0]):
        away = light - q
        reach = np.linalg.norm(away, axis=1)
        _, _, first = trace(arrays, q, away / reach[:, None], shape[met])
        rows[met, 2 + k] = ((away * n).sum(axis=1) > 0) & (first > reach)
    return rows


def near_walls(arrays: SceneArrays, origin: np.ndarray, mirror: np.ndarray, angle: float) -> np.ndarray:
    """Whether a label changes within ``angle`` of the mirror ray, (N,)."""
    here = labels(arrays, origin, mirror)
    u1 = unit(np.cross(mirror, (0.3, 0.5, 0.8)))
    u2 = np.cross(mirror, u1)
    near = np.zeros(len(origin), dtype=bool)
    for ring in range(1, RINGS + 1):
        tilt = angle * ring / RINGS
        for phi in 2 * np.pi * np.arange(SECTORS) / SECTORS:
            rays = math.cos(tilt) * mirror + math.sin(tilt) * (math.cos(phi) * u1 + math.sin(phi) * u2)
            near |= (rays[:, 2] <= 0) | (labels(arrays, origin, unit(rays)) != here).any(axis=1)
    return near


def main() -> None:
    options = arguments(__doc__)
    size = 96 if options.quick else 256
    powers = range(12, 18, 2) if options.quick else range(12, 19)
    exponents = [2.0**p for p in powers]
    report = Report("mirror_anchor", f"gloss, {size} x {size}, n from {exponents[0]:g} to {exponents[-1]:g}.")
    scene = load("gloss")
    # other surfaces do not change the floor's gloss, and cost time
    scene = scene.replace({f"spheres.{name}.lobe.weight": 0.0 for name in "ABC"})
    arrays = scene_arrays(scene)

    def gloss(exponent: float | None) -> dict[str, np.ndarray]:
        change = {"floor.lobe.mirror": True} if exponent is None else {"floor.lobe.exponent": exponent}
        pair = render(
            *(scene.replace(change),),
            size=size,
            lobe=1 if exponent is None else 32,
            numeric="importance",
            partition="equal_weight",
            nodes="barycentre",
        )
        return {name: getattr(pair, name).layers["gloss"] for name in ("numeric", "symbolic")}

    mirror = gloss(None)
    apart = float(np.abs(mirror["numeric"] - mirror["symbolic"]).max())
    points, directions = floor_points(scene, size)
    lit = mirror["symbolic"].max(axis=2) > SIGNAL
    near, beside = np.zeros_like(lit), np.zeros_like(lit)
    near[lit] = near_walls(arrays, points[lit], directions[lit], REACH / math.sqrt(exponents[0]))
    beside[near] = near_walls(arrays, points[near], directions[near], 1 / math.sqrt(exponents[-1]))
    groups = {"far from walls": lit & ~near, "near walls": near & ~beside, "beside a wall": beside}
    levels = {name: float(np.median(mirror["symbolic"][mask].max(axis=1))) for name, mask in groups.items()}
    medians: dict[tuple[str, str], list[float]] = {}
    for exponent in exponents:
        for pipeline, image in gloss(exponent).items():
            for name, mask in groups.items():
                gap = np.abs(image - mirror[pipeline])[mask].max(axis=1)
                medians.setdefault((pipeline, name), []).append(float(np.median(gap)))
    slopes = {key: float(np.polyfit(np.log(exponents), np.log(gaps), 1)[0]) for key, gaps in medians.items()}
    report.table(
        ("pipeline", "pixels", "number", "median mirror", *(f"2^{p}" for p in powers), "slope in log n"),
        [
            (pipeline, name, int(groups[name].sum()), levels[name], *gaps, f"{slopes[pipeline, name]:.3f}")
            for (pipeline, name), gaps in medians.items()
        ],
    )
    report.say(
        f"Median over pixels of |lobe - mirror|, worst channel; 32 x 32 directions, of equal weight (symbolic) and by "
        f"importance (numeric). Near: within {REACH:g} widths of the widest lobe, so the narrow ones leave the wall "
        f"behind; beside: within one width of the narrowest. The black image is the column "
        f"`median mirror`. The two pipelines' mirror images differ by at most {apart:.1e}."
    )
    enough = 100 if options.quick else 1000
    assert int(groups["far from walls"].sum()) >= enough, "too few pixels far from walls"
    for pipeline in ("numeric", "symbolic"):
        slope = slopes[pipeline, "far from walls"]
        report.claim_number(f"slope far from walls, {pipeline} ({slope:.3f}), distance from -1", abs(slope + 1), 0.1)
    report.leave()


if __name__ == "__main__":
    main()
