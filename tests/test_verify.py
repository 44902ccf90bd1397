"""Brute force over random pixels: a clean image passes, a fault is caught, the receipt says how small a one."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

import symrender as sr
from symrender.errors import OptionError
from symrender.execution.silhouettes import edges
from symrender.scene.arrays import scene_arrays
from symrender.settings import split_settings
from symrender.verify import FALSE_ALARMS, brightest, student_quantile, verify

pytestmark = pytest.mark.timeout(1200)

SIZE = 16


@pytest.fixture(scope="module")
def clean() -> sr.Image:
    return sr.truth("gloss", size=SIZE, tol=1e-4, verify=0.25)


def settings(disk: str = "2x2", aa: str = "analytic"):
    return split_settings(SIZE, tol=1e-4, disk=disk, aa=aa, budget=1_000_000, threads=0, tile=0)


def test_a_clean_image_passes_and_says_so(clean: sr.Image) -> None:
    # a false alarm has a chance of FALSE_ALARMS, and the samples are the same at every run
    receipt = json.loads(clean.meta["verified"])
    assert receipt["verified_pixels"] == SIZE * SIZE // 4
    assert receipt["contradicted"] == 0 and receipt["at"] == [] and 0 < receipt["worst_ratio"] <= 1
    assert receipt["false_alarms"] == FALSE_ALARMS
    assert 0 < receipt["power"][0] <= receipt["power"][1] < 0.05
    assert "verified" not in sr.truth("gloss", size=2, tol=1e-2).meta


@pytest.mark.parametrize("fault", ["missing", "scaled", "channel"])
def test_a_planted_fault_is_caught(clean: sr.Image, fault: str) -> None:
    scene = sr.load("gloss")
    receipt = json.loads(clean.meta["verified"])
    rms = float(np.sqrt(np.mean(clean.radiance**2)))
    layers = {name: clean.layer(name).copy() for name in clean.layers}
    match fault:
        case "missing":
            layers["radiance"] -= scene_arrays(scene).floor.weight * layers["gloss"]
        case "scaled":
            layers["radiance"] *= 1.0 + 8.0 * receipt["power"][1] * rms / np.abs(layers["radiance"]).mean()
        case "channel":
            layers["radiance"][..., 2] += 4.0 * receipt["power"][1] * rms
    found = verify(layers, scene, settings(), 0.25)
    assert found.contradicted > 0.5 * found.verified_pixels * (0.2 if fault == "missing" else 1.0)
    assert found.worst_ratio > 1 and len(found.at) <= 20


@pytest.mark.parametrize(
    ("changes", "disk"),
    [
        ({"shading.highlight_view": "eye", "shading.specular_terminator": "open"}, "2x2"),
        ({"shading.lobe_units": "brdf_normalised"}, "1x1"),
        ({}, "exact"),
        ({"floor.lobe.mirror": True}, "2x2"),
    ],
)
def test_every_convention_is_judged_by_its_own(changes: dict[str, object], disk: str) -> None:
    scene = sr.load("gloss").replace(changes)
    image = sr.truth(scene, size=SIZE, tol=1e-4, disk=disk, verify=0.1)
    receipt = json.loads(image.meta["verified"])
    assert receipt["contradicted"] == 0
    assert receipt["of"] == ("radiance - direct" if disk == "exact" else "radiance")


def test_a_pixel_at_a_silhouette_is_judged_as_the_mean_that_it_is() -> None:
    """Its centre alone would contradict it: a mean over two shapes is the value of neither."""
    scene = sr.load("gloss")
    image = sr.truth(scene, size=SIZE, tol=1e-4, silhouettes=2, verify=0.3)
    receipt = json.loads(image.meta["verified"])
    assert receipt["contradicted"] == 0 and receipt["verified_pixels"] == round(0.3 * SIZE * SIZE)
    layers = {name: image.layer(name) for name in image.layers}
    centres = verify(layers, scene, settings(), 0.3)
    at_edge = edges(image.layer("hit_class"))
    assert centres.contradicted > 3
    assert all(at_edge[j, i] for i, j in centres.at)


def test_the_receipt_is_the_same_for_any_threads(clean: sr.Image) -> None:
    scene = sr.load("gloss")
    one, two = (verify(clean.layers, scene, settings(), 0.1, threads=n) for n in (1, 3))
    assert one == two and one.samples == 16 * 64**2


def test_values_that_are_not_stated_are_skipped(clean: sr.Image) -> None:
    layers = dict(clean.layers)
    layers["error"] = np.full_like(clean.layer("error"), np.inf)
    receipt = verify(layers, sr.load("gloss"), settings(), 0.1)
    assert (receipt.verified_pixels, receipt.contradicted, receipt.worst_ratio) == (0, 0, 0.0)
    assert receipt.skipped == round(0.1 * SIZE * SIZE)
    assert (
        replace(receipt, contradicted=1)
        .text()
        .startswith("verified radiance of 0 pixels by brute force: 1 contradicted")
    )


@pytest.mark.parametrize("share", [-0.1, 1.5, float("nan"), "all", True])
def test_a_share_is_a_share(share: object) -> None:
    with pytest.raises(OptionError, match="verify: must be a share"):
        sr.truth("gloss", size=2, verify=share)  # type: ignore[arg-type]


def test_quantiles_are_those_of_tables() -> None:
    # DLMF and any table: 15 degrees of freedom
    assert student_quantile(15, 0.025) == pytest.approx(2.131449546, rel=1e-8)
    assert student_quantile(15, 0.0005) == pytest.approx(4.072765196, rel=1e-8)
    assert student_quantile(15, 1e-7) > 8


def test_no_pixel_is_brighter_than_the_bound(clean: sr.Image) -> None:
    bound = brightest(scene_arrays(sr.load("gloss")))
    assert (clean.layer("gloss").reshape(-1, 3).max(axis=0) <= bound).all()
