"""Every real number has one dotted name, a unit and a range, and can be read and replaced by it."""

from __future__ import annotations

import pytest

from symrender.errors import SceneError
from symrender.scene import gallery
from symrender.scene.load import load
from symrender.scene.parameters import Parameter, get, parameters
from symrender.scene.scene import Scene
from symrender.scene.values import Part

NAMED = {
    "spheres.A.center.x": "length",
    "spheres.B.radius": "length",
    "spheres.A.color.r": "1",
    "spheres.A.texture.ku": "half-periods",
    "floor.lobe.exponent": "1",
    "floor.lobe.weight": "1",
    "floor.lobe.theta_max": "rad",
    "floor.texture.bright.r": "1",
    "floor.texture.offset.x": "length",
    "lights.fill.position.x": "length",
    "lights.key.radius": "length",
    "lights.key.target.z": "length",
    "camera.eye.x": "length",
    "shading.shininess": "1",
    "ambient.r": "radiance",
    "background.g": "radiance",
}


def numbers(value: object) -> list[float]:
    """All floats in a scene, found without any names."""
    if isinstance(value, Part):
        return [number for key in type(value).model_fields for number in numbers(getattr(value, key))]
    if isinstance(value, tuple):
        return [number for entry in value for number in numbers(entry)]
    return [value] if isinstance(value, float) else []


@pytest.mark.parametrize("name", gallery.names())
def test_every_number_once(name: str) -> None:
    scene = load(name)
    listed = scene.parameters()
    assert listed == parameters(scene)
    assert len(listed) >= 30
    assert [p.value for p in listed] == numbers(scene)
    assert len({p.name for p in listed}) == len(listed)
    for p in listed:
        assert p.low <= p.value <= p.high
        assert p.description
        assert p.unit in ("length", "radiance", "rad", "degree", "half-periods", "1")
        assert get(scene, p.name) == p.value


def test_the_names_users_know() -> None:
    units = {p.name: p.unit for p in load("chapter8").parameters()}
    assert {name: units[name] for name in NAMED} == NAMED
    assert {"camera.window_half", "camera.window_center.x"} <= set(units)
    fov = next(p for p in load("gloss").parameters() if p.name == "camera.fov")
    assert fov == Parameter("camera.fov", 28.5, "degree", 0.0, 180.0, "vertical field of view")


def test_get_takes_any_part() -> None:
    scene = load("chapter8")
    assert get(scene, "camera.eye") == (0.0, 0.0, 4.0)
    assert get(scene, "shading.model") == "blinn"
    assert get(scene, "spheres.B") is scene.spheres[1]
    assert get(scene, "spheres[1].center[2]") == 1.3
    assert get(scene, "floor.lobe") is scene.floor.lobe  # type: ignore[union-attr]
    assert isinstance(scene, Scene)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("spheres.B.raduis", "spheres.B.raduis: unknown name 'raduis' in spheres.B, did you mean 'radius'"),
        ("sphere.B.radius", "sphere.B.radius: unknown name 'sphere', did you mean 'spheres'"),
        ("spheres.C.radius", "spheres.C.radius: unknown name 'C' in spheres, known are A, B"),
        ("spheres[2].radius", "spheres[2].radius: unknown name '2' in spheres, known are A, B"),
        ("camera.eye.r", "camera.eye.r: unknown name 'r' in camera.eye, known are x, y, z"),
        ("ambient.x", "ambient.x: unknown name 'x' in ambient, known are r, g, b"),
        ("camera.eye.xy", "camera.eye.xy: unknown name 'xy' in camera.eye"),
        ("camera.fov", "camera.fov: unknown name 'fov' in camera"),
        ("spheres.B.texture.ku", "spheres.B.texture.ku: unknown name 'ku' in spheres.B.texture"),
        ("camera.eye.x.y", "camera.eye.x.y: unknown name 'y' in camera.eye.x"),
        ("model_config", "model_config: unknown name 'model_config'"),
        ("__class__", "__class__: unknown name '__class__'"),
        ("", "the empty name: not a parameter name such as spheres.A.radius"),
        (".", ".: not a parameter name such as spheres.A.radius"),
        ("spheres[-1]", "spheres[-1]: not a parameter name such as spheres.A.radius"),
        ("spheres[9999999]", "spheres[9999999]: not a parameter name such as spheres.A.radius"),
        ("a." * 100_000, "a.a."),
        ("\x1b[0m\u202e", "\\x1b[0m\\u202e: not a parameter name such as"),
    ],
)
def test_unknown_names_and_the_nearest(name: str, said: str) -> None:
    for attempt in (get, lambda scene, name: scene.replace({name: 1})):
        with pytest.raises(SceneError) as error:
            attempt(load("chapter8"), name)
        assert str(error.value).startswith(said)
        assert str(error.value).isprintable()
        assert len(str(error.value)) <= 300
