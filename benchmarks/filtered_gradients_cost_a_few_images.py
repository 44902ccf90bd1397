"""The gradient of a filtered image by a place, a radius or the eye costs at most four of its images.

    python benchmarks/filtered_gradients_cost_a_few_images.py [--quick]

``metal`` without bounces, one thread, ``filter: box`` and the same tolerance for the image and its derivatives, in
turns. Of bounced light ``interreflection``. Time is CPU time; the fewest of some turns counts, as what else runs on a
machine only adds.
"""

from __future__ import annotations

from functools import partial

from measure import Report, arguments, interleaved

import symrender as sr
from symrender.scene.radiometric.scene import RadiometricScene

NAMES = {
    "a ball's place": ("shapes.A.center.x",),
    "its radius": ("shapes.A.radius",),
    "the eye": ("camera.eye.x",),
    "all three": ("shapes.A.center.x", "shapes.A.radius", "camera.eye.x"),
}
TURNS, QUICK = 3, 1
MOST = 4.0


def ratios(
    report: Report, scene: RadiometricScene, size: int, tol: float, names: dict[str, tuple[str, ...]], turns: int
) -> list[float]:
    """CPU times of derivatives over those of the image, one parameter after the other; all are in a table."""
    image = partial(sr.truth, scene, size=size, tol=tol, filter="box", threads=1)
    rivals = {"the image": image} | {
        label: partial(sr.gradient, scene, wrt, size=size, tol=tol, filter="box", threads=1)
        for label, wrt in names.items()
    }
    seconds = {label: min(each) for label, each in interleaved(rivals, turns).items()}
    found = [seconds[label] / seconds["the image"] / len(names[label]) for label in names]
    rows = []
    for label, wrt in names.items():
        images = sr.gradient(scene, wrt, size=size, tol=tol, filter="box", threads=1)
        missed = [int((each.layer("status") != 0).sum()) for each in images.values()]
        rows.append((label, seconds[label], seconds[label] / seconds["the image"], ", ".join(map(str, missed))))
    report.say(f"{scene.name}, {size} x {size}, tol {tol:g}; the image takes {seconds['the image']:.3g} CPU s.")
    report.table(("derivative by", "CPU s", "over the image", "pixels that miss the tolerance"), rows)
    return found


def main() -> None:
    options = arguments(__doc__)
    turns = QUICK if options.quick else TURNS
    report = Report("filtered_gradients_cost_a_few_images", __doc__.split("\n")[0])
    metal = sr.load("metal")
    assert isinstance(metal, RadiometricScene)
    metal = metal.replace({"bounces": 0})
    for size, tol in ((24, 1e-3),) if options.quick else ((64, 1e-3), (128, 1e-3), (64, 1e-4)):
        found = ratios(report, metal, size, tol, NAMES, turns)
        report.claim_time(f"images a derivative, {size} x {size}, {tol:g}", max(found), 0, MOST)
    if not options.quick:
        balls = sr.load("interreflection")
        assert isinstance(balls, RadiometricScene)
        name = next(f"shapes.{shape.name}" for shape in balls.shapes if shape.type == "sphere")
        bounced: dict[str, tuple[str, ...]] = {
            "a ball's place": (f"{name}.center.x",),
            "its radius": (f"{name}.radius",),
            "the eye": ("camera.eye.x",),
        }
        found = ratios(report, balls, 12, 3e-3, bounced, 1)
        report.claim_time("images a derivative, bounced light", max(found), 0, MOST)
    report.leave()


if __name__ == "__main__":
    main()
