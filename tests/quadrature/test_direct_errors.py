"""Direct light of exact disks, and its derivative: what is stated where a highlight ends inside the disk."""

from __future__ import annotations

import numpy as np
import pytest

import symrender as sr
from symrender.scene.scene import Scene

SIZE = (9, 6)
NAME = "lights.key.color.r"


def blunt() -> Scene:
    """Phong's highlight of shininess 1 under an open terminator: its base ends inside a wide disk; no lobes."""
    scene = sr.load("chapter8")
    changes: dict[str, object] = {
        "shading.shininess": 1.0, "shading.specular_terminator": "open", "shading.model": "phong",
        "lights.key.radius": 2.5, "floor.lobe.weight": 0.0,
    }  # fmt: skip
    return scene.replace(changes | {f"spheres.{s.name}.lobe.weight": 0.0 for s in scene.spheres if s.lobe})


@pytest.mark.parametrize("tol", [1e-3, 1e-4, 1e-5])
def test_two_orders_are_two_rules(tol: float) -> None:
    """Values against those of a finer tolerance, derivatives against differences, in which a colour is linear."""
    scene = blunt()

    def image(color: float, tol: float) -> sr.Image:
        return sr.truth(scene.replace({NAME: color}), size=SIZE, tol=tol, disk="exact", threads=1)

    high, low = image(1.0, 1e-11), image(0.5, 1e-11)
    value = image(1.0, tol)
    seen = high.layer("hit_class") > 0
    assert seen.sum() >= 20 and np.abs(high.radiance - low.radiance)[seen].max() > 0.01
    off = np.abs(value.radiance - high.radiance).max(axis=-1)
    assert (off <= value.layer("error") + high.layer("error") + 1e-12)[seen].all()
    slope = sr.gradient(scene, [NAME], size=SIZE, tol=tol, disk="exact", threads=1)[NAME]
    away = np.abs(slope.radiance - 2.0 * (high.radiance - low.radiance)).max(axis=-1)
    known = slope.layer("status") < 3
    assert (known & seen).sum() >= 20
    assert (away <= slope.layer("error") + 1e-10)[known & seen].all()


def test_points_of_the_disk_agree() -> None:
    """On what nothing shadows, the disk's own points converge to it, within what it states."""
    scene = blunt()
    exact = sr.truth(scene, size=SIZE, tol=1e-6, disk="exact", threads=1)
    coarse, fine = (sr.truth(scene, size=SIZE, tol=1e-6, disk=k, threads=1) for k in ("32x32", "64x64"))
    change = np.abs(fine.layer("direct") - coarse.layer("direct")).max(axis=-1)
    settled = (exact.layer("hit_class") > 0) & (change < 2e-6)
    assert settled.sum() >= 15
    off = np.abs(exact.layer("direct") - fine.layer("direct")).max(axis=-1)
    assert (off <= exact.layer("error") + 2.0 * change + 1e-8)[settled].all()
