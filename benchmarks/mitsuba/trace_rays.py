"""Traces rays through an exported scene with Mitsuba 3: means and second moments, and the CPU time it took.

    python benchmarks/mitsuba/trace_rays.py FOLDER SAMPLES

FOLDER holds ``scene.xml`` and ``rays.npz`` with ``origins`` and ``directions`` (N, 3) at its scale; ``traced.npz`` is
written beside them. The line printed names the version, samples and CPU seconds, compilation left out.
"""

import sys
import time
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np

BATCH = 1 << 20


def main() -> None:
    folder, samples = Path(sys.argv[1]), int(sys.argv[2])
    mi.set_variant("llvm_ad_rgb")
    scene = mi.load_file(str(folder / "scene.xml"))
    with np.load(folder / "rays.npz") as file:
        origins, directions = file["origins"], file["directions"]
    count = len(origins)
    each = max(1, min(samples, BATCH // count))
    mean, square, done, seconds = np.zeros((count, 3)), np.zeros((count, 3)), 0, 0.0
    while done < samples + each:
        begun = time.process_time()
        sampler = mi.load_dict({"type": "independent"})
        sampler.seed(1 + done, count * each)
        ray = mi.RayDifferential3f(
            mi.Point3f(np.repeat(origins, each, axis=0).T), mi.Vector3f(np.repeat(directions, each, axis=0).T)
        )
        light = scene.integrator().sample(scene, sampler, ray)[0]
        dr.eval(light)
        values = np.array(light, dtype=np.float64).reshape(3, count, each)
        # the first round compiles, and is not counted
        if done > 0:
            seconds += time.process_time() - begun
            mean += values.sum(axis=2).T
            square += (values**2).sum(axis=2).T
        done += each
    taken = done - each
    np.savez(folder / "traced.npz", mean=mean / taken, square=square / taken, samples=taken)
    print(f"Mitsuba {mi.__version__}, {count} rays, {taken} samples each, {seconds:.6g} CPU s")


if __name__ == "__main__":
    main()
