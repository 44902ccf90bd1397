"""Truth and probe at the edges: finite, as good as they say, and exact where a limit has a closed form."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from numeric.conftest import with_parts
from numeric.test_pipeline import DEGENERATE, LIGHT, LOOK, SPHERE, USUAL
from runtimes.test_degenerate import TIES
from runtimes.test_image import layers_of
from symrender.cli import main
from symrender.errors import NonFiniteError, OptionError, Unsupported
from symrender.execution import jobs
from symrender.images.image import Image
from symrender.probe import probe
from symrender.quadrature.split_setup import UNSUPPORTED
from symrender.runtimes import image as symbolic
from symrender.runtimes import truth as truth_kernel
from symrender.scene.load import load
from symrender.scene.scene import Scene
from symrender.truth import truth, verdict

STRATA: dict[str, Any] = {"partition": "equal_weight", "nodes": "barycentre"}
APART = {*TIES, "light in the floor", "cells too small to count"}
"""Scenes where strata are no judge: ties of their very construction, and a texture finer than a double can place, of
which strata read one colour and the truth takes the mean."""


REFUSED = {"huge"}
"""Scenes of which roundings decide what is seen."""
TOLD = [name for name in DEGENERATE if name not in REFUSED]


def scene_of(name: str) -> Scene:
    return Scene.model_validate({"camera": LOOK, "ambient": [0.1, 0.1, 0.1]} | DEGENERATE[name], strict=False)


def true(scene: Scene, size: int | tuple[int, int] = 8, tol: float = 1e-3, budget: int = 3000, **rest: Any) -> Image:
    return truth(scene, size=size, tol=tol, budget=budget, threads=1, **rest)


@pytest.mark.parametrize("name", REFUSED)
def test_scenes_that_roundings_decide_are_refused(name: str) -> None:
    with pytest.raises(Unsupported, match="one surface but for roundings"):
        true(scene_of(name))


@pytest.mark.parametrize("name", TOLD)
def test_degenerate_scenes_are_finite_and_as_good_as_they_say(name: str) -> None:
    scene = scene_of(name)
    image = true(scene)
    coarse, fine = (layers_of(symbolic, scene, 8, lobe=k, **STRATA) for k in (16, 32))
    given = image.layer("status") != UNSUPPORTED
    error = image.layer("error")
    assert np.isfinite(image.radiance).all() and np.isfinite(error[given]).all() and (error >= 0).all()
    assert (image.radiance.min(axis=-1) >= -np.minimum(error, 1)).all()
    assert image.layer("direct").tobytes() == fine["direct"].tobytes()
    if name in APART:
        return
    difference = np.abs(image.radiance - fine["radiance"]).max(axis=-1)
    slack = 4 * np.abs(fine["radiance"] - coarse["radiance"]).max(axis=-1) + 0.01
    assert (difference <= error + slack)[given].all()


@pytest.mark.parametrize("name", TOLD)
def test_uncounted_truth_is_as_good_as_it_says(name: str) -> None:
    loose, tight = true(scene_of(name), tol=1e-2, counts=False), true(scene_of(name), tol=1e-4, budget=100_000)
    given = tight.layer("status") != UNSUPPORTED
    assert (given == (loose.layer("status") != UNSUPPORTED)).all()
    assert np.isfinite(loose.radiance).all()
    away = np.abs(loose.radiance - tight.radiance).max(axis=-1)
    assert (away <= loose.layer("error") + tight.layer("error"))[given].all()


def test_counting_can_be_left_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    counted, free = (truth("gloss", size=24, tol=1e-2, threads=1, counts=counts) for counts in (True, False))
    assert counted.radiance.max() > 0.1
    assert not np.array_equal(counted.radiance, free.radiance)
    away = np.abs(counted.radiance - free.radiance).max(axis=-1)
    assert (away <= counted.layer("error") + free.layer("error")).all()
    assert (free.layer("chambers") < counted.layer("chambers")).sum() > 50
    asked = ["truth", "chapter8", "--size", "4", "--no-counts", "--layers", "error,crossings", "-o", str(tmp_path)]
    assert main(asked) == 2
    assert "crossings cannot be written without counts" in capsys.readouterr().err
    with pytest.raises(OptionError, match="counts"):
        truth("chapter8", size=4, counts=1)  # type: ignore[arg-type]


def test_two_spheres_around_the_eye_leave_no_value_and_say_so(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    spheres = [SPHERE | {"center": LOOK["eye"]}, SPHERE | {"name": "b", "center": LOOK["eye"], "radius": 1.5}]
    scene = Scene.model_validate({"camera": LOOK, **USUAL, "spheres": spheres}, strict=False)
    image = true(scene, 4)
    assert (image.layer("status") == UNSUPPORTED).all() and (image.layer("error") == math.inf).all()
    assert np.isfinite(image.radiance).all() and not image.layer("gloss").any()
    assert not verdict(image).met and verdict(image).missed["unsupported"] == 16
    (tmp_path / "s.json").write_text(scene.model_dump_json())
    words = ["truth", str(tmp_path / "s.json"), "--size", "4", "--json", "--out", str(tmp_path)]
    assert main(words) == 4
    out, err = capfd.readouterr()
    assert json.loads(out)["largest_error"] is None and json.loads(out)["missed"]["unsupported"] == 16
    assert "inside spheres.a" in err and "inside spheres.b" in err
    point = ["probe", str(tmp_path / "s.json"), "--surface", "spheres.a", "-p", "0,0,1", "--json"]
    assert main(point) in (2, 4)


@pytest.mark.parametrize("value", [math.nan, math.inf])
@pytest.mark.parametrize("layer", ["radiance", "error"])
def test_what_is_not_finite_is_named_and_refused(layer: str, value: float, monkeypatch: pytest.MonkeyPatch) -> None:
    prepare = truth_kernel.prepare

    def broken(*arguments: Any) -> Any:
        kernel = prepare(*arguments)

        def fill(x0: int, y0: int, x1: int, y1: int, layers: Any) -> int:
            spent: int = kernel(x0, y0, x1, y1, layers)
            if x0 <= 2 < x1 and y0 <= 3 < y1:
                layers[layer][3, 2] = value
            return spent

        return fill

    monkeypatch.setattr(truth_kernel, "prepare", broken)
    jobs.prepared.cache_clear()
    try:
        if layer == "error" and value == math.inf:
            assert true(scene_of("black light"), 5).layer("error")[3, 2] == math.inf
            return
        with pytest.raises(NonFiniteError, match=r"truth: 1 pixels are not finite: \(2, 3\) on ") as caught:
            true(scene_of("black light"), 5)
    finally:
        jobs.prepared.cache_clear()
    assert caught.value.exit_code == 3


def test_no_angle_is_the_mirror_bit_for_bit() -> None:
    """A lobe of hardly any angle has the mirror's value too; what it may differ by is in its error."""
    scene = load("gloss")
    mirror = true(scene.replace({"floor.lobe.mirror": True}), 16)
    images = [true(scene.replace({"floor.lobe.theta_max": theta}), 16) for theta in (0.0, 1e-300, 1e-12)]
    assert (mirror.layer("gloss").max(axis=-1) > 0.05).mean() > 0.1
    for name, layer in mirror.layers.items():
        assert images[0].layers[name].tobytes() == layer.tobytes(), name
    for image in images[1:]:
        for name in ("radiance", "direct", "gloss", "hit_class", "status"):
            assert image.layers[name].tobytes() == mirror.layers[name].tobytes(), name
        assert (image.layer("error") >= mirror.layer("error")).all()
        assert (image.layer("error") <= np.maximum(1e-3, mirror.layer("error"))).all()


def test_probes_reach_the_ends_of_the_exponent() -> None:
    """n = 0 is the mean over the cap, so the next powers change it by no more than they should; n = 1e12 the mirror."""
    scene = load("gloss").replace({"floor.lobe.theta_max": math.pi / 2})
    points = [(-0.5, -1.5), (0.4, -1.2), (1.1, -0.9)]

    def gloss(exponent: float) -> Any:
        return probe(scene.replace({"floor.lobe.exponent": exponent}), points, tol=1e-7)

    zero, tiny, small = (gloss(n) for n in (0.0, 1e-300, 1e-6))
    assert zero.gloss.max() > 0.01 and not zero.status.any()
    assert zero.gloss.tobytes() == tiny.gloss.tobytes()
    assert np.abs(small.gloss - zero.gloss).max() <= 1e-5 + (small.error + zero.error).max()
    mirror = probe(scene.replace({"floor.lobe.mirror": True}), points, tol=1e-7)
    needle = gloss(1e12)
    assert (mirror.gloss.max(axis=1) > 0.01).any()
    assert (np.abs(needle.gloss - mirror.gloss).max(axis=1) <= 1e-5 + needle.error + mirror.error).all()


def test_disk_of_radius_zero_is_the_point_light() -> None:
    point = {"type": "point", "name": "k", "position": LIGHT["position"]}
    zero, dot = (
        Scene.model_validate({"camera": LOOK, **USUAL, "lights": [light]}, strict=False)
        for light in (LIGHT | {"radius": 0.0}, point)
    )
    a, b = true(zero, 6), true(dot, 6)
    assert a.radiance.max() > 0.1
    for name, layer in a.layers.items():
        assert layer.tobytes() == b.layers[name].tobytes(), name
    for disk in ("2x2", "exact"):
        c, d = (probe(scene, [(1.4, -1.5), (0.3, -1.8)], tol=1e-4, disk=disk) for scene in (zero, dot))
        assert c.gloss.max() > 1e-3 and c.gloss.tobytes() == d.gloss.tobytes()


def test_a_lobe_of_no_weight_costs_nothing() -> None:
    scene = load("gloss")
    parts = ["floor", *(f"spheres.{sphere.name}" for sphere in scene.spheres if sphere.lobe is not None)]
    image = true(scene.replace({f"{part}.lobe.weight": 0.0 for part in parts}), 12)
    assert image.radiance.max() > 0.1 and image.radiance.tobytes() == image.layer("direct").tobytes()
    assert not image.layer("evaluations").any() and not image.layer("error").any()


def test_what_cannot_be_seen_changes_nothing_stated() -> None:
    """A sphere below the floor, one inside another, the same one twice: within the errors, whatever the walls added."""
    base = {"camera": LOOK, "lights": [LIGHT], "floor": {"lobe": {}}, "ambient": [0.1, 0.2, 0.3]}
    plain = Scene.model_validate(base | {"spheres": [SPHERE]}, strict=False)
    reference = true(plain, 8, budget=20000)
    assert (reference.layer("gloss").max(axis=-1) > 0.01).sum() > 20
    for other in (
        {"name": "b", "center": [1.0, -1.0, -0.9], "radius": 0.8, "color": [1.0, 1.0, 1.0]},
        {"name": "b", "center": [0.1, 0.0, 1.0], "radius": 0.5, "color": [1.0, 1.0, 1.0]},
        SPHERE | {"name": "b", "color": [1.0, 1.0, 1.0]},
    ):
        image = true(with_parts(plain, spheres=[SPHERE, other]), 8, budget=20000)
        assert image.layer("direct").tobytes() == reference.layer("direct").tobytes()
        difference = np.abs(image.radiance - reference.radiance).max(axis=-1)
        assert (difference <= image.layer("error") + reference.layer("error")).all()


def test_odd_sizes() -> None:
    scene = scene_of("horizon")
    for size in ((1, 1), (33, 1), (1, 17)):
        image = true(scene, size)
        assert image.radiance.shape == (size[1], size[0], 3) and np.isfinite(image.radiance).all()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"tol": 0.0}, "tol: must be a number in"),
        ({"tol": -1.0}, "tol: must be a number in"),
        ({"tol": 10.0}, "tol: must be a number in"),
        ({"tol": math.nan}, "tol: must be a number in"),
        ({"tol": 1e-300}, "below double precision"),
        ({"budget": 0}, "budget: must be a whole number from 1"),
        ({"disk": "2x3"}, "disk: must be"),
    ],
)
def test_wrong_options_are_one_line(options: dict[str, Any], message: str) -> None:
    for call in (lambda: truth("gloss", size=2, **options), lambda: probe("gloss", [(0.0, -1.5)], **options)):
        with pytest.raises(OptionError, match=message) as caught:
            call()
        assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize(
    ("points", "surface", "message"),
    [
        ([(math.nan, 0.0)], "floor", "must be finite"),
        ([(0.0, 0.0, 1.0)], "floor", "on the floor"),
        ([(0.0, 0.0, 0.0, 0.0)], "floor", "on the floor"),
        ([(0.0, 0.0, 2.0)], "spheres.A", "unit outward normals"),
        ([(0.0, 0.0)], "spheres.A", "unit outward normals"),
        ([(0.0, 1.0, 0.0)], "spheres.A", "does not face the eye"),
        ([(0.0, 0.0)], "spheres.Z", "surface: must be one of floor, spheres.A"),
    ],
)
def test_wrong_points_are_one_line(points: Any, surface: str, message: str) -> None:
    with pytest.raises(Exception, match=message) as caught:
        probe("gloss", points, surface=surface)
    assert len(str(caught.value).splitlines()) == 1 and getattr(caught.value, "exit_code", 0) == 2


def test_surfaces_asked_together_are_those_asked_alone() -> None:
    """Spheres of one weight share a call of the kernel, but not where the units of their lobes give them two scales."""
    scene = load("gloss").replace({
        "spheres.A.lobe.weight": 0.4, "spheres.A.lobe.exponent": 3.0, "spheres.A.texture": {"type": "solid"},
        "spheres.C.lobe.weight": 0.4, "shading.lobe_units": "brdf_normalised",
    })  # fmt: skip
    whole, alone = (truth(scene, size=10, tol=1e-3, tile=tile, threads=1) for tile in (10, 1))
    seen = whole.layers["hit_class"]
    assert len(np.unique(seen)) == 4 and (whole.layers["gloss"][seen > 1].max(axis=-1) > 0.0).sum() >= 10
    for name, layer in whole.layers.items():
        assert layer.tobytes() == alone.layers[name].tobytes(), name
