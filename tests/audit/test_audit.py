"""Whole audits: the right tracer passes, planted mistakes fail and are named, and a sequence stops when it may."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import symrender as sr
from symrender.audit.audit import filter_of
from symrender.errors import ImageError, OptionError, Unsupported
from symrender.execution.fill import Crew
from symrender.execution.jobs import Job
from symrender.execution.provenance import provenance
from symrender.images.image import Image
from symrender.scene.load import AnyScene
from symrender.scene.parameters import get
from symrender.settings import RADII, split_settings

SIZE = (24, 16)
Truths = Callable[[str], tuple[AnyScene, Image]]


def seeds(mutants: ModuleType, truths: Truths, name: str, count: int, samples: int = 16) -> list[Image]:
    scene, _ = truths(name)
    return [mutants.rendered(scene, SIZE, samples, 500 + k, plain=False) for k in range(count)]


def test_false_alarms_of_the_right_tracer(mutants: ModuleType, truths: Truths) -> None:
    """100 audits at level .05, half by moments, half by seeds: 5 expected, more than 12 are no chance (.999)."""
    alarms = 0
    for k in range(50):
        scene, true = truths("bounce" if k % 2 else "sky")
        image = mutants.rendered(scene, SIZE, 64, 9000 + k, plain=False)
        images = [mutants.rendered(scene, SIZE, 8, 20_000 + 8 * k + s, plain=False) for s in range(8)]
        alarms += not sr.audit(image, scene, truth=true, samples=64, level=0.05, explain=False).passed
        alarms += not sr.audit(images, scene, truth=true, level=0.05, explain=False).passed
    assert alarms <= 12


@pytest.mark.parametrize(
    "name",
    [
        *("missing cosine", "no shadow rays", "last bounce lit twice", "no bounced light"),
        *("checker off by half a cell", "weights squared on one side", "alpha squared", "Schlick for Fresnel"),
        *("correlated for separable masking", "pixels half a column off"),
    ],
)
def test_planted_mistakes_fail(name: str, mutants: ModuleType, truths: Truths) -> None:
    mutant = next(m for m in mutants.MUTANTS if m.name == name)
    scene, true = truths(mutant.scene)
    exact = mutant.scene in mutants.NOISE_FREE
    with mutants.planted(mutant):
        image = mutants.rendered(scene, SIZE, 1 if exact else 16, 3, plain=True)
    verdict = sr.audit(image, scene, truth=true, samples=16, noise_free=exact, explain=False)
    assert not verdict.passed and verdict.sentence().startswith("Failed: ")
    right = mutants.rendered(scene, SIZE, 1 if exact else 16, 3, plain=True)
    assert sr.audit(right, scene, truth=true, samples=16, noise_free=exact, explain=False).passed


def test_a_moved_parameter_is_named_with_its_value(mutants: ModuleType, truths: Truths) -> None:
    scene, true = truths("metal")
    wrong = scene.replace({"materials.a.alpha": 0.404})
    render = Image({"radiance": sr.truth(wrong, size=SIZE).radiance})
    verdict = sr.audit(render, scene, truth=true, noise_free=True, wrt=["materials.a.alpha", "materials.b.alpha"])
    assert not verdict.passed
    named = {found.name: found for found in verdict.attribution}
    assert named["materials.a.alpha"].value == pytest.approx(0.404, abs=2e-4)
    assert verdict.attribution[0].name == "materials.a.alpha" and verdict.attribution[0].explains > 0.99
    assert verdict.attribution[0].how == "by its exact derivative"


def test_where_light_bounces_a_moved_light_is_named_too(mutants: ModuleType, truths: Truths) -> None:
    scene, true = truths("bounce")
    name = "lights.lamp.position.z"
    wrong = Image({"radiance": sr.truth(scene.replace({name: 2.45}), size=SIZE, tol=1e-6).radiance})
    (found,) = (
        e for e in sr.audit(wrong, scene, truth=true, noise_free=True, wrt=[name]).attribution if e.name == name
    )
    assert found.how == "by its exact derivative"
    assert found.current == 2.4 and found.value == pytest.approx(2.45, abs=0.01)


def test_where_a_derivative_is_refused_a_difference_stands_for_it() -> None:
    clay = {"type": "diffuse", "reflectance": 0.7, "two_sided": True}
    floor = {"type": "rectangle", "name": "floor", "corner": [0, 0, 0], "edge_u": [2, 0, 0], "edge_v": [0, 2, 0]}
    wall = {"type": "rectangle", "name": "wall", "corner": [0, 2, 0], "edge_u": [2, 0, 0], "edge_v": [0, 0, 2]}
    scene = sr.load(
        {"units": "radiometric", "name": "corner", "bounces": 1, "materials": {"clay": clay},
         "camera": {"type": "look_at", "eye": [1, -3, 2], "target": [1, 1.5, 0.5], "fov": 40},
         "shapes": [floor | {"material": "clay"}, wall | {"material": "clay"}],
         "lights": [{"type": "point", "name": "lamp", "position": [1, 1, 1.5], "intensity": 5}]}
    )  # fmt: skip
    name = "lights.lamp.position.z"
    with pytest.raises(Unsupported, match="by what lights send"):
        sr.gradient(scene, [name], size=SIZE, tol=1e-3)
    true, wrong = (sr.truth(s, size=SIZE, tol=1e-4) for s in (scene, scene.replace({name: 1.55})))
    assert true.layer("indirect").max() > 0.01 and np.abs(true.radiance - wrong.radiance).max() > 0.01
    render = Image({"radiance": wrong.radiance})
    named = sr.audit(render, scene, truth=true, noise_free=True, wrt=[name]).attribution
    (found,) = (e for e in named if e.name == name)
    assert found.how == "by a central difference of two truths"
    assert found.current == 1.5 and found.value == pytest.approx(1.55, abs=0.01)


def test_a_known_mistake_is_named(mutants: ModuleType, truths: Truths) -> None:
    scene, true = truths("metal")
    wrong = scene.replace({"materials.a.alpha": 0.4**2})
    render = Image({"radiance": sr.truth(wrong, size=SIZE).radiance})
    verdict = sr.audit(render, scene, truth=true, noise_free=True)
    assert verdict.attribution[0].name == "the renderer had: alpha squared of materials.a"
    assert verdict.attribution[0].consistent


def test_a_factor_is_measured(mutants: ModuleType, truths: Truths) -> None:
    scene, true = truths("bounce")
    images = [Image({"radiance": 1.02 * i.radiance}) for i in seeds(mutants, truths, "bounce", 16)]
    verdict = sr.audit(images, scene, truth=true, explain=False)
    scale = verdict.tests[0]
    assert scale.outcome == "failed" and abs(scale.bias - 0.02) < 4 * scale.error < 0.01


def test_a_channel_that_is_off_is_named(truths: Truths) -> None:
    scene, true = truths("metal")
    render = Image({"radiance": np.array([1.0, 0.9, 1.0]) * true.radiance})
    verdict = sr.audit(render, scene, truth=true, noise_free=True)
    best = verdict.attribution[0]
    assert not verdict.passed and best.name == "the factor of green" and best.consistent, verdict.text()
    assert abs(best.value - 0.9) < 1e-6, best


def test_series_scenes_are_audited_by_exact_derivatives() -> None:
    scene = sr.load("gloss")
    true = sr.truth(scene, size=12, tol=1e-6)
    wrong = sr.truth(scene.replace({"floor.lobe.weight": 0.303}), size=12, tol=1e-6)
    current = scene.floor.lobe.weight
    rng = np.random.default_rng(1)
    renders = [
        Image({"radiance": wrong.radiance * (1 + 1e-4 * rng.standard_normal(wrong.radiance.shape))}) for _ in range(8)
    ]
    right = [Image({"radiance": true.radiance * (1 + 0.02 * rng.standard_normal((12, 12, 3)))}) for _ in range(8)]
    verdict = sr.audit(right, scene, truth=true)
    assert verdict.passed and {t.region for t in verdict.regions} >= {"all", "floor", "silhouettes", "busy lobes"}
    found = sr.audit(renders, scene, truth=true, wrt=["floor.lobe.weight"]).attribution
    named = next(e for e in found if e.name == "floor.lobe.weight")
    assert named.current == current and named.how == "by its exact derivative"
    assert named.value == pytest.approx(0.303, abs=max(4 * named.error, 1e-4))


@pytest.mark.parametrize("scene", ["gloss", "metal"])
def test_a_truth_says_what_its_pixels_are(scene: str, tmp_path: Path) -> None:
    """In either kind of units, also from a file; of an image made elsewhere nothing is known."""
    loaded = sr.load(scene)
    for name in RADII:
        settings = split_settings(2, tol=1e-2, disk="2x2", aa="none", budget=9, threads=1, tile=0, filter=name)
        nothing = {"radiance": np.zeros((2, 2, 3))}
        true = Image(nothing, provenance(Job.of("truth", loaded, settings), loaded, "truth", "none"))
        path = tmp_path / f"{name}.exr"
        true.save(path)
        assert filter_of(true) == filter_of(path) == name
    assert filter_of(replace(true, meta={})) == "centre"


def test_a_sequence_stops_at_the_first_decision(mutants: ModuleType, truths: Truths) -> None:
    scene, true = truths("bounce")
    drawn = []

    def images(factor: float) -> Iterator[Image]:
        for k in range(64):
            drawn.append(k)
            made = mutants.rendered(scene, SIZE, 16, 700 + k, plain=False)
            yield Image({"radiance": factor * made.radiance})

    failed = sr.audit(images(1.1), scene, truth=true, sequential=True, explain=False)
    assert not failed.passed and failed.looks == 1 and len(drawn) == 8 and failed.level == 0.005
    drawn.clear()
    passed = sr.audit(images(1.0), scene, truth=true, sequential=True, visible=0.02, explain=False)
    assert passed.passed and passed.samples == len(drawn) < 64
    drawn.clear()
    last = sr.audit(images(1.0), scene, truth=true, sequential=True, explain=False)
    assert last.samples == 64 and last.looks == 4


def test_the_truth_is_rendered_far_under_the_noise(mutants: ModuleType, truths: Truths) -> None:
    scene, _ = truths("bounce")
    verdict = sr.audit(seeds(mutants, truths, "bounce", 8), scene, explain=False)
    assert verdict.passed
    whole = [t for t in verdict.regions if t.region == "all"]
    assert len(whole) == 3 and all(0 < t.allowance < 0.2 * t.error for t in whole)


def test_beyond_a_given_truth_no_image_is_rendered(
    mutants: ModuleType, truths: Truths, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Regions once took five images more, each computed seven times: a minute where a million pixels are."""
    scene, true = truths("bounce")
    images = seeds(mutants, truths, "bounce", 8)
    rendered: list[str] = []

    def counted(self: Crew, job: Job) -> None:
        rendered.append(job.kind)
        raise AssertionError("an image was rendered")

    monkeypatch.setattr(Crew, "fill", counted)
    verdict = sr.audit(images, scene, truth=true, explain=False)
    names = {test.region for test in verdict.regions}
    assert verdict.passed and names >= {"shadow edges of lights.sun", "texture lines"} and not rendered
    with pytest.raises(AssertionError):
        sr.audit(images, scene, explain=False)


def test_what_cannot_be_judged(mutants: ModuleType, truths: Truths) -> None:
    scene, true = truths("bounce")
    images = seeds(mutants, truths, "bounce", 8)
    stranger = Image({"radiance": true.radiance}, {"scene_hash": "f" * 64})
    for renders, options, message in (
        (images, {"truth": Image({"radiance": true.radiance})}, "has no error layer"),
        (images, {"truth": Image({**true.layers, "error": -true.layer("error") - 1})}, "negative"),
        (images, {"truth": Image({**true.layers, "error": np.full(true.layer("error").shape, np.inf)})}, "no stated"),
        (
            [Image({"radiance": i.radiance[:8]}) for i in images],
            {"truth": true},
            "are 24 x 8 pixels, the truth 24 x 16",
        ),
        ([stranger, *images[1:]], {"truth": true}, "made of scene ffffffffffff"),
        (images, {"truth": Image(true.layers, {"scene_hash": "f" * 64})}, "is the truth of scene ffff"),
    ):
        with pytest.raises(ImageError, match=message):
            sr.audit(renders, scene, **options)
    for options in ({"level": 0.9}, {"tol": 7.0}, {"level": float("nan")}):
        with pytest.raises(OptionError):
            sr.audit(images, scene, truth=true, **options)
    with pytest.raises(OptionError, match="at least 8"):
        sr.audit(images[:3], scene, truth=true, sequential=True)


def test_a_verdict_says_who_is_unverified(mutants: ModuleType, truths: Truths) -> None:
    scene, true = truths("bounce")
    images = seeds(mutants, truths, "bounce", 8)
    notes = sr.audit(images, scene, truth=true).notes
    assert any("unverified scene" in note for note in notes)
    sealed = [Image(i.layers, {"scene_hash": scene.hash}) for i in images]
    assert not any("unverified scene" in note for note in sr.audit(sealed, scene, truth=true).notes)


@pytest.mark.parametrize("size", [(1, 1), (1, 9), (5, 2)])
def test_the_smallest_images(size: tuple[int, int], mutants: ModuleType) -> None:
    scene = mutants.scene_of("sky")
    images = [mutants.rendered(scene, size, 64, k, plain=False) for k in range(8)]
    verdict = sr.audit(images, scene, tol=1e-6)
    assert verdict.passed and verdict.size == size
    one = sr.audit(images[0], scene, samples=64, tol=1e-6)
    assert one.passed and one.regions[0].pixels == size[0] * size[1]


def slopes(mutants: ModuleType, scene: AnyScene, name: str, step: float, seed: int) -> Image:
    """The derivative as a renderer that knows none finds it: two images with the same random numbers."""
    value = float(get(scene, name))
    high, low = (
        mutants.rendered(scene.replace({name: value + s}), SIZE, 16, seed, plain=False).radiance for s in (step, -step)
    )
    return Image({"radiance": (high - low) / (2 * step)})


def test_derivatives_are_audited(mutants: ModuleType, truths: Truths) -> None:
    """The share of a ball's light by its own reflectance: right from 12 seeds, and 4 % low found and measured."""
    scene, _ = truths("sky")
    name = "materials.a.reflectance.color.g"
    images = [slopes(mutants, scene, name, 0.05, 3000 + k) for k in range(12)]
    assert np.abs(images[0].radiance).max() > 0.5
    passed = sr.audit(images, scene, derivative=name)
    assert passed.passed and any(f"the derivative in {name}" in note for note in passed.notes)
    low = sr.audit([Image({"radiance": 0.96 * image.radiance}) for image in images], scene, derivative=name)
    assert not low.passed
    factor = next(found for found in low.attribution if found.name == "the factor of the whole image")
    assert abs(factor.value - 0.96) < 4 * factor.error < 0.03
    # metal has no noise: a wrong alpha squared in the derivative's place shows at once
    metal, alpha = truths("metal")[0], "materials.a.alpha"
    exact = Image({"radiance": sr.gradient(metal, [alpha], size=SIZE)[alpha].radiance})
    assert sr.audit(exact, metal, derivative=alpha, noise_free=True).passed
    other = sr.gradient(metal.replace({alpha: 0.41}), [alpha], size=SIZE)[alpha]
    assert not sr.audit(Image({"radiance": other.radiance}), metal, derivative=alpha, noise_free=True).passed


def test_what_a_derivative_cannot_be(mutants: ModuleType, truths: Truths) -> None:
    scene, true = truths("sky")
    images = seeds(mutants, truths, "sky", 8)
    with pytest.raises(OptionError, match="must name one number"):
        sr.audit(images, scene, derivative="lights.dome.radiance")
    with pytest.raises(OptionError, match="leave it out"):
        sr.audit(images, scene, derivative="lights.dome.radiance.r", wrt=["lights.dome.radiance.r"])
    with pytest.raises(ImageError, match=r"is the derivative in no parameter, not in lights\.dome"):
        sr.audit(images, scene, derivative="lights.dome.radiance.r", truth=true)
    slope = sr.gradient(scene, ["lights.dome.radiance.g"], size=SIZE)["lights.dome.radiance.g"]
    with pytest.raises(ImageError, match=r"is the derivative in lights.dome.radiance.g, not in none"):
        sr.audit(images, scene, truth=slope)
