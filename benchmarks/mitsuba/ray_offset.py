"""Light that bounces once in Mitsuba is that of a surface moved by its ray offset.

    pip install mitsuba symrender
    python ray_offset.py [--quick]

Secondary rays of Mitsuba 3.9.1 start (1 + max |p|) 8.94e-5 off the surface, p in units of the scene. A patch of floor
beside a ball, under one lamp that nothing hides: the light that the floor sends on after one bounce is known to ten
digits. The scene is exported twice: as it is, and scaled by 1000 about the patch, where the offset is a thousandth of
that in the middle and less than a hundredth anywhere; no pixel of the truth changes. What the offset in the middle
predicts is the truth of the scene with floor and camera raised by it, for from there the bounced rays start. Both
renders are audited, seed by seed, and the difference of what bounced is taken with the same random numbers, each less
Mitsuba's own direct light, which has no noise: its camera's rays are in single precision, too. DRJIT_LIBLLVM_PATH may
have to name LLVM's library.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any, Final

import numpy as np

import symrender as sr

PATCH: Final = (0.3, 0.0, 0.0)
OFFSET: Final = 1500.0 * 2.0**-24
"""Mitsuba's ``RayEpsilon`` in single precision."""
SIZE: Final = (8, 8)
SEEDS: Final = 16
PLACES: Final = (("as it is", 1.0, (0.0, 0.0, 0.0)), ("times 1000 about the patch", 1000.0, PATCH))


def scene(raised: float = 0.0) -> Any:
    """The scene, its floor and camera ``raised``, so that every ray meets the floor below the same place."""
    x, y, z = PATCH
    return sr.load(
        {
            "name": "patch",
            "units": "radiometric",
            "bounces": 1,
            "camera": {"type": "look_at", "eye": [x, -0.3, 0.2 + raised], "target": [x, y, z + raised], "fov": 1.5},
            "materials": {
                "sand": {"type": "diffuse", "reflectance": 0.8},
                "chalk": {"type": "diffuse", "reflectance": 0.9},
            },
            "shapes": [
                {"type": "plane", "name": "floor", "point": [0, 0, raised], "normal": [0, 0, 1], "material": "sand"},
                {"type": "sphere", "name": "ball", "center": [x + 0.24, 0, 0.2], "radius": 0.2, "material": "chalk"},
            ],
            "lights": [{"type": "point", "name": "lamp", "position": [x - 0.5, 0, 0.3], "intensity": 10}],
        }
    )


def rendered(folder: Path, samples: int, seed: int, *, bounces: int = 1) -> Path:
    """What Mitsuba makes of the exported scene with one seed; without its bounce by the very same rays."""
    text = (folder / "scene.xml").read_text("utf-8")
    name, depth = f"depth_{bounces + 2}.xml", '<integer name="max_depth" value="{}"/>'
    assert depth.format(3) in text
    (folder / name).write_text(text.replace(depth.format(3), depth.format(bounces + 2)), "utf-8")
    out = folder / f"seed_{seed}_bounces_{bounces}"
    words = ["--samples", str(samples), "--seed", str(seed), "--scene", name, "--out", str(out)]
    subprocess.run([sys.executable, str(folder / "run.py"), *words], check=True, stdout=sys.stderr)
    return out.with_suffix(".npz")


def mean(render: Path) -> float:
    """Mean radiance of an image."""
    return float(sr.read_image(render).radiance.mean())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="a hundredth of the samples, which shows nothing")
    samples = (1 << 18) // (64 if parser.parse_args().quick else 1)
    import mitsuba as mi

    true = sr.truth(scene(), size=SIZE, tol=1e-10)
    bounced = true.layer("indirect").mean()
    assert true.layer("error").max() < 1e-7 * bounced, "the truth is not known well enough"
    print("## ray_offset\n")
    print(
        f"Mitsuba {mi.__version__}, {SIZE[0]} x {SIZE[1]} pixels, {SEEDS} seeds of {samples} samples a pixel each, "
        f"{SIZE[0] * SIZE[1] * SEEDS * samples:.2g} in all. Radiance {true.radiance.mean():.10g}, of which bounced "
        f"{bounced:.10g}, stated error {true.layer('error').max():.1e}. Differences are over the bounced light.\n"
    )
    print("| scene | predicted by the offset | bounced, found | found less expected | z | audit |")
    print("| --- | --- | --- | --- | --- | --- |")
    each, z, verdicts, predicted = [], [], [], []
    with tempfile.TemporaryDirectory() as folder:
        for name, scale, center in PLACES:
            # the offset is of the place in the renderer's own units, and given back in those of the scene
            far = max(abs(scale * (p - c)) for p, c in zip(PATCH, center, strict=True))
            moved = sr.truth(scene((1.0 + far) * OFFSET / scale), size=SIZE, tol=1e-10)
            predicted.append(moved.layer("indirect").mean() / bounced - 1.0)
            there = Path(folder) / f"{scale:g}"
            sr.export(scene(), "mitsuba", there, size=SIZE, rays="centre", scale=scale, center=center)
            direct = mean(rendered(there, 16, 0, bounces=0))
            renders = [rendered(there, samples, seed) for seed in range(SEEDS)]
            each.append(np.array([mean(render) for render in renders]) - direct)
            verdict = sr.audit(renders, scene(), truth=true, explain=False)
            whole = next(test for test in verdict.regions if test.region == "all")
            z.append(whole.z)
            verdicts.append(verdict.passed)
            off, error = whole.bias / bounced, whole.error / bounced
            print(
                f"| {name} | {predicted[-1]:+.2e} | {each[-1].mean():.7g} | {off:+.2e} +- {error:.1e} "
                f"| {z[-1]:+.1f} | {'passed' if verdict.passed else 'failed'} |",
                flush=True,
            )
    apart = (each[0] - each[1]) / bounced
    shift, error = apart.mean(), apart.std(ddof=1) / np.sqrt(SEEDS)
    expected = predicted[0] - predicted[1]
    told = f"{shift:+.3e} +- {error:.1e} (z {shift / error:+.1f})"
    print(f"\nThe first less the second, with the same random numbers: {told}, predicted {expected:+.3e}.\n")
    beside = abs(shift / expected - 1.0)
    claims = (
        ("the scene out of the offset's reach passes", verdicts[1]),
        (f"the difference over its prediction, less one, is {beside:.3f}, target <= 0.05", beside <= 0.05),
    )
    for what, held in claims:
        print(f"- {what}: {'held' if held else 'MISSED'}\n")
    sys.exit(0 if all(held for _, held in claims) else 1)


if __name__ == "__main__":
    main()
