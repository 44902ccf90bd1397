"""The scenes as pictures, the same floor at several exponents, and how much of each picture is gloss."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from symrender.chapter.document.effort import Effort
from symrender.chapter.document.figures import Measured, figures_of, shown
from symrender.chapter.document.pictures import element, radiance, stepped, strip
from symrender.chapter.document.tables import table
from symrender.images.image import Image
from symrender.images.views import gloss_view
from symrender.render import render
from symrender.scene import arrays as at
from symrender.scene.load import load
from symrender.scene.parameters import get

_FINE: Final[dict[str, Any]] = {"numeric": "none", "partition": "equal_weight", "nodes": "barycentre"}
_EXPONENTS: Final = (1e9, 4096.0, 256.0, 32.0)
_STEPS: Final = (4.0, 16.0, 64.0, 256.0, 1024.0, 16384.0)
_SHOWN: Final = 0.05
_TOLD: Final = (
    "camera.eye", "spheres.A.center", "spheres.A.radius", "spheres.B.center", "spheres.B.radius",
    "spheres.A.lobe.weight", "floor.lobe.weight", "floor.lobe.exponent", "floor.lobe.theta_max",
    "lights.key.position", "lights.key.radius", "lights.fill.position",
    "shading.ka", "shading.kd", "shading.ks", "shading.shininess",
)  # fmt: skip


def measure(effort: Effort) -> Measured:
    """Blocks ``hero``, ``roughness``, ``scenes.pictures``, ``scenes.table``, ``simulator.poster``.

    Figures ``scenes.*``.
    """
    hero = [
        (_picture(load("gloss").replace({"floor.lobe.exponent": n}), effort.hero, effort.hero_lobe), n) for n in _STEPS
    ]
    gloss, chapter = _picture("gloss", effort.small, 16), _picture("chapter8", effort.small[1], 32)
    blocks = {
        "hero": stepped(
            [
                (radiance(image), f"{n:g}", f"Three spheres on dark polished tiles, reflected with the exponent {n:g}")
                for image, n in hero
            ],
            _STEPS.index(256.0),
            "n",
            "Exponent n of the floor's lobe",
        ),
        "roughness": strip([_at_exponent(effort, n) for n in _EXPONENTS]),
        "scenes.pictures": strip(
            [
                (radiance(chapter), "<code>chapter8</code>", "Two spheres on a chessboard floor from straight above"),
                _floor_gloss(chapter),
                (radiance(gloss), "<code>gloss</code>", "Three spheres seen from low above a polished floor"),
                _floor_gloss(gloss),
            ]
        ),
        "scenes.table": _constants(),
        "simulator.poster": element(radiance(gloss), "The scene of the simulator: three spheres on a polished floor"),
    }
    return Measured(_facts("gloss", gloss) | _facts("chapter8", chapter), blocks)


def _picture(name: Any, size: int | tuple[int, int], lobe: int, **more: Any) -> Image:
    made = render(name, size=size, lobe=lobe, **{**_FINE, **more}).symbolic
    assert made is not None
    return made


def _floor_gloss(image: Image) -> tuple[Any, str, str]:
    floor = (image.layer("hit_class") == at.FLOOR)[:, :, None]
    view = gloss_view(Image(dict(image.layers) | {"gloss": np.where(floor, image.layer("gloss"), 0.0)}, {}))
    return view.pixels, f"{view.caption}, floor", "The gloss of its floor alone"


def _at_exponent(effort: Effort, n: float) -> tuple[Any, str, str]:
    scene = load("gloss").replace({"floor.lobe.exponent": n})
    made = render(scene, size=effort.small, lobe=12, **_FINE).symbolic
    assert made is not None
    label = f"<i>n</i> = {shown(int(n), 'count') if n < 1e6 else shown(n, '1g')}"
    return radiance(made), label, f"The floor's lobe at exponent {n:g}"


def _facts(name: str, image: Image) -> dict[str, Any]:
    floor = image.layer("hit_class") == at.FLOOR
    gloss = np.where(floor[:, :, None], image.layer("gloss"), 0.0)
    reflected = np.where(floor[:, :, None], image.radiance - image.layer("direct"), 0.0)
    where = f"scene {name}, floor of {image.width} x {image.height} pixels, strata of equal weight"
    return figures_of(
        f"scenes.{name}",
        where,
        pixels=image.width * image.height,
        brightest=float(gloss.max()),
        brightest_reflected=float(reflected.max()),
        share=float((reflected.max(axis=2) >= _SHOWN).mean()),
        visible=_SHOWN,
        signal=float(np.sqrt(np.mean(reflected[floor] ** 2))),
        floor=int(floor.sum()),
        kiss=float(get(load(name), "spheres.A.lobe.weight")),
        **{key: float(get(load(name), f"floor.lobe.{key}")) for key in ("exponent", "theta_max", "weight")},
    )


def _constants() -> str:
    def told(scene: Any, name: str) -> str:
        value = get(scene, name)
        return ", ".join(f"{v:g}" for v in value) if isinstance(value, tuple) else f"{value:.5g}"

    scenes = [load("chapter8"), load("gloss")]
    rows = [[name, *(told(scene, name) for scene in scenes)] for name in _TOLD]
    return table(("number", "chapter8", "gloss"), rows, label="Constants of the two scenes")
