"""Gradient images against differences of ``truth``, their layers, their files and what they refuse."""

from __future__ import annotations

import numpy as np
import pytest

import symrender as sr
from symrender.errors import OptionError
from symrender.quadrature.split_setup import EVENT
from symrender.scene.parameters import get

WRT = ["spheres.B.center.x", "floor.lobe.weight", "camera.eye.z", "floor.texture.cell"]
SIZE = (10, 6)


@pytest.fixture(scope="module")
def images() -> dict[str, sr.Image]:
    return sr.gradient("gloss", WRT, size=SIZE, tol=1e-4, threads=2)


def test_images_are_differences_of_truth(images: dict[str, sr.Image]) -> None:
    scene = sr.load("gloss")
    for name in WRT:
        at = float(get(scene, name))
        sides = {
            h: sr.truth(scene.replace({name: at + h}), size=SIZE, tol=1e-7, threads=2)
            for h in (2e-4, -2e-4, 1e-4, -1e-4)
        }
        for layer in ("gloss", "direct", "radiance"):
            coarse, fine = (
                (sides[h].layer(layer) - sides[-h].layer(layer)) / (2 * h) for h in (2e-4, 1e-4)
            )  # fmt: skip
            settled = np.abs(coarse - fine).max(axis=-1) < 3e-3
            gap = np.abs(images[name].layer(layer) - (4 * fine - coarse) / 3).max(axis=-1)
            if layer == "gloss" and name == "floor.lobe.weight":
                assert (images[name].layer("gloss") == 0).all()
                continue
            assert settled.mean() >= 0.9, (name, layer)
            assert (gap[settled] < 5e-3).mean() >= 0.97, (name, layer)
        assert np.abs(images[name].radiance).max() > 0.05, name


def test_layers(images: dict[str, sr.Image]) -> None:
    assert list(images) == WRT
    for name, image in images.items():
        assert image.meta["parameter"] == name
        assert (image.width, image.height) == SIZE
        weight = np.array([0.0, 0.85, 0.15, 0.4, 0.15])[image.layer("hit_class").astype(int)]
        if name != "floor.lobe.weight":
            total = image.layer("direct") + weight[..., None] * image.layer("gloss")
            assert np.abs(image.radiance - total).max() < 1e-12
        assert (image.layer("status") == 0).mean() > 0.95
        assert np.isfinite(image.layer("error")).all()


def test_threads_change_no_byte(images: dict[str, sr.Image]) -> None:
    # the panels follow the parameters asked for, so the same ones are asked for
    again = sr.gradient("gloss", WRT, size=SIZE, tol=1e-4, threads=1, tile=3)
    for name in WRT:
        assert np.array_equal(again[name].radiance, images[name].radiance), name


def test_vectors_are_components() -> None:
    found = sr.gradient("furnace", ["camera.eye"], size=2)
    assert list(found) == ["camera.eye.x", "camera.eye.y", "camera.eye.z"]


def test_a_furnace_stays_what_it_is() -> None:
    """In a world of constant radiance nothing that moves changes a lobe that lies above its horizon."""
    scene = sr.load("furnace")
    names = [p.name for p in scene.parameters() if p.name.startswith("spheres.") and "center" in p.name]
    assert names
    for image in sr.gradient(scene, names, size=4, tol=1e-6).values():
        assert np.abs(image.layer("gloss")).max() < 1e-6


@pytest.mark.parametrize("wrt", [[], "spheres.B.center.x"])
def test_something_must_be_asked_for(wrt: object) -> None:
    with pytest.raises(OptionError, match="wrt"):
        sr.gradient("gloss", wrt, size=2)  # type: ignore[arg-type]


def test_where_a_weight_moves_the_values_error_and_status_count() -> None:
    """d/dw (w gloss) is gloss: cut short, it is no better known than the value is."""
    name, tol = "floor.lobe.weight", 1e-7
    known = sr.truth("gloss", size=SIZE, tol=1e-8, threads=2)
    image = sr.gradient("gloss", [name], size=SIZE, tol=tol, budget=2_000, threads=2)[name]
    floor = known.layer("hit_class") == 1
    error, status = image.layer("error")[floor], image.layer("status")[floor]
    off = np.abs(image.radiance - known.layer("gloss"))[floor].max(axis=-1)
    assert floor.sum() >= 10 and (known.layer("gloss")[floor] > 0.01).any()
    assert ((status == 1) & (error > tol)).sum() >= 5
    assert (status[error > tol] == 1).all()
    assert (off <= error + known.layer("error")[floor]).all()


def test_a_floor_in_which_a_light_lies_has_one_sided_derivatives() -> None:
    scene = {
        "camera": {"type": "look_at", "eye": [0, -4, 1.5], "target": [0, 0, 0.2]},
        "spheres": [{"name": "A", "center": [0, 0, 0.5], "radius": 0.5, "color": [0.5, 0.5, 0.5]}],
        "floor": {"texture": {"type": "solid", "color": [0.8, 0.8, 0.8]}},
        "lights": [{"name": "L", "type": "point", "position": [1.5, -1.0, 0.0], "color": [1, 1, 1]}],
    }
    names = ["lights.L.position.x", "lights.L.position.z"]
    for height, kinked in ((0.0, True), (1e-9, False)):
        risen = sr.load(scene).replace({"lights.L.position.z": height})
        along, up = (sr.gradient(risen, names, size=8, tol=1e-4, threads=1)[name] for name in names)
        floor = up.layers["hit_class"] == 1.0
        assert floor.sum() > 30 and (~floor).sum() > 3
        assert ((up.layers["status"] == EVENT) == (floor & kinked)).all()
        assert (along.layers["status"] != EVENT).all()


def test_surfaces_asked_together_are_those_asked_alone() -> None:
    """Spheres of one weight share a call of the kernel, but not where the weight of one of them moves."""
    scene = sr.load("gloss").replace({f"spheres.{name}.lobe.weight": 0.4 for name in "AC"})
    wrt = ["spheres.A.lobe.weight", "spheres.B.center.x"]
    whole, alone = (sr.gradient(scene, wrt, size=8, tol=1e-3, tile=tile, threads=1) for tile in (8, 1))
    assert len(np.unique(whole[wrt[0]].layers["hit_class"])) == 4
    assert all(np.abs(whole[name].layers["radiance"]).max() > 0.01 for name in wrt)
    for name in wrt:
        for layer, values in whole[name].layers.items():
            assert values.tobytes() == alone[name].layers[layer].tobytes(), (name, layer)
