"""Writes the support matrices of docs/support.md and README.md: what truth and gradient accept, found by asking them.

Every cell is one call, of one or two pixels, on a small scene that holds the feature of its row. A call that returns
with a value in every pixel is a tick; an image that quadrature refuses is marked where paths make it, and listed with
the message; so is what is refused. ``--check`` writes
nothing and fails where a page says something else.
"""

from __future__ import annotations

import argparse
import base64
import io
import re
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import symrender as sr

ROOT = Path(__file__).resolve().parent.parent
REGION = r"(?<=<!-- {0} -->\n).*?(?=<!-- /{0} -->)"
YES, SAMPLED, NO = "✓", "≈", ""
PATHS = "sampled: "
"""What the reason of a cell begins with that paths answer."""
UNSUPPORTED = 3
"""The status of a pixel without a value."""
Scene = dict[str, Any]

EYE = {"type": "look_at", "eye": [0.3, -6, 2.5], "target": [0, 0, 0.4], "fov": 30}
CLAY = {"type": "diffuse", "reflectance": 0.6, "two_sided": True}
METAL = {"type": "conductor", "alpha": 0.3, "eta": 1.5, "k": 3, "two_sided": True}
CHECKER = {"type": "checker", "bright": 0.7, "dark": 0.2, "cell": 1}
POINT = {"type": "point", "name": "key", "position": [-2, -3, 4], "intensity": 50}
SKY = {"type": "sky", "name": "sky", "radiance": 0.5}
BALL = {"type": "sphere", "name": "ball", "center": [0, 0, 0.5], "radius": 0.5}
PLANE = {"type": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 0, 1]}
SHEET = {"type": "rectangle", "name": "sheet", "corner": [-3, -3, 0], "edge_u": [6, 0, 0], "edge_v": [0, 6, 0]}
CARD = {"type": "rectangle", "name": "card", "corner": [-1, 1, 0], "edge_u": [2, 0, 0], "edge_v": [0, 0, 1]}
TRIANGLE = {"type": "triangle", "name": "sail", "vertices": [[-1, 1, 0.1], [1, 1, 0.1], [0, 1, 1.5]]}
DISK = {"type": "disk", "name": "disk", "center": [0, 1, 0.6], "normal": [0, -1, 0], "radius": 0.5}
BOX = {"type": "box", "name": "crate", "center": [0, 0.5, 0.4], "size": [0.8, 0.8, 0.8]}
CYLINDER = {"type": "cylinder", "name": "post", "base": [0, 0.5, 0.1], "axis": [0, 0, 0.9], "radius": 0.3, "caps": True}
MESH = {
    "type": "mesh",
    "name": "roof",
    "vertices": [[-0.5, 0, 0.1], [0.5, 0, 0.1], [0, 0.5, 0.1], [0, 0.2, 0.9]],
    "faces": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
}
LAMP = {"type": "rectangle", "name": "panel", "corner": [-1, -1, 4], "edge_u": [0, 2, 0], "edge_v": [2, 0, 0]}
GLOBE = {"type": "sphere", "name": "globe", "center": [-2, -2, 3], "radius": 0.4}


def picture(wide: int, high: int) -> str:
    """A PNG file of grey pixels, as scenes hold it."""
    from PIL import Image

    file = io.BytesIO()
    Image.frombytes("L", (wide, high), bytes(range(40, 40 + wide * high))).save(file, "PNG")
    return base64.b64encode(file.getvalue()).decode()


def physical(*shapes: Mapping[str, Any], lights: tuple[Any, ...] = (POINT,), seen: Any = CLAY, **more: Any) -> Scene:
    """A radiometric scene; the last shape is of the material ``seen``, the others of clay."""
    made = [dict(shape, material="clay") for shape in shapes]
    made[-1]["material"] = "seen"
    return {
        "units": "radiometric",
        "name": "probe",
        "bounces": 0,
        "camera": dict(EYE),
        "materials": {"clay": CLAY, "seen": seen},
        "shapes": made,
        "lights": list(lights),
        **more,
    }


def several(*materials: Scene) -> Scene:
    """Cylinders side by side, each of another material."""
    made = physical(PLANE, CYLINDER)
    made["materials"] |= {f"m{k}": each for k, each in enumerate(materials)}
    for k in range(len(materials)):
        base = [k - 1.0, 0.5, 0.1]
        made["shapes"].insert(1, CYLINDER | {"name": f"post{k}", "material": f"m{k}", "base": base, "radius": 0.2})
    return made


def area(shape: str) -> Scene:
    """A lamp of the shape of this name."""
    return {"type": "area", "name": "lamp", "shape": shape, "radiance": 5}


def textured(texture: Mapping[str, Any]) -> Scene:
    """A diffuse material with a texture."""
    return {"type": "diffuse", "reflectance": dict(texture), "two_sided": True}


def height() -> Scene:
    """A diffuse material with a bump."""
    return CLAY | {"bump": {"height": {"sin": {"mul": [5, "x"]}}, "amplitude": 0.05}}


SURROUNDINGS = {"type": "environment", "name": "sky", "data": picture(8, 4), "scale": 0.5}
RADIOMETRIC: Mapping[str, Scene] = {
    "spheres and planes": physical(PLANE, BALL),
    "rectangles, boxes, triangles": physical(SHEET, TRIANGLE, BOX),
    "disks": physical(SHEET, DISK),
    "meshes": physical(SHEET, MESH),
    "planes and boxes": physical(PLANE, BOX),
    "spheres and boxes": physical(SHEET, BOX, BALL),
    "spots, suns": physical(
        PLANE,
        BALL,
        lights=(
            {
                "type": "spot",
                "name": "spot",
                "position": [-2, -3, 4],
                "direction": [2, 3, -4],
                "intensity": 50,
                "beam": 10,
                "cutoff": 30,
            },
            {"type": "directional", "name": "sun", "direction": [1, 1, -2], "irradiance": 1},
        ),
    ),
    "sky over spheres, planes": physical(PLANE, BALL, lights=(SKY,)),
    "sky over flat shapes": physical(SHEET, BOX, lights=(SKY,)),
    "spherical lamp": physical(PLANE, GLOBE, BALL, lights=(area("globe"),)),
    "flat lamp": physical(LAMP, SHEET, BOX, lights=(area("panel"),)),
    "metal sphere": physical(PLANE, BALL, seen=METAL),
    "metal box": physical(SHEET, BOX, seen=METAL),
    "metal sphere under a lamp": physical(PLANE, GLOBE, BALL, lights=(area("globe"),), seen=METAL),
    "metal sphere, flat lamp, `first_hit`": physical(
        LAMP, SHEET, BALL, lights=(area("panel"),), seen=METAL, gloss="first_hit"
    ),
    "checker": physical(PLANE, BALL, seen=textured(CHECKER)),
    "marble": physical(PLANE, BALL, seen=textured(CHECKER | {"type": "marble"})),
    "bump": physical(SHEET, BALL, seen=height()),
    "cylinders, mirrors, glass, plastic": several(
        {"type": "conductor", "alpha": 0, "material": "Au"},
        {"type": "dielectric", "ior": 1.5},
        {"type": "plastic", "ior": 1.5, "alpha": 0.1, "diffuse": 0.5},
    ),
    "image textures, environment maps": physical(
        PLANE, BALL, lights=(SURROUNDINGS,), seen=textured({"type": "image", "data": picture(8, 4)})
    ),
}

LOBE = {"weight": 0.3, "exponent": 32}
SPHERE = {"name": "A", "center": [0, 0, 0.5], "radius": 0.5}
KEY = {"name": "key", "type": "point", "position": [-2, -3, 4]}
ROUND = {"name": "key", "type": "disk", "position": [-2, -3, 4], "radius": 0.5}


def series(light: Mapping[str, Any] = KEY, **more: Any) -> Scene:
    """A scene in units of the series: a ball on a glossy floor."""
    made = {"camera": dict(EYE), "spheres": [SPHERE], "floor": {"lobe": LOBE}, "lights": [dict(light)]}
    return {"name": "probe", **made, **more}


SERIES: Mapping[str, Scene] = {
    "spheres on a glossy floor": series(),
    "glossy sphere": series(spheres=[SPHERE | {"lobe": LOBE}], floor={}),
    "planes": series(planes=[{"name": "wall", "point": [0, 2, 0], "normal": [0, -1, 0], "lobe": LOBE}]),
    "marble on a sphere": series(spheres=[SPHERE | {"texture": {"type": "marble"}}]),
    "disk light, K x K points": series(ROUND),
    "disk light, exact": series(ROUND),
    "mirror": series(floor={"lobe": LOBE | {"mirror": True}}),
    "lobes in BRDF units": series(shading={"lobe_units": "brdf_normalised"}),
    "Phong highlights": series(shading={"model": "phong"}),
}


def asked(scene: Scene, call: Callable[..., Any], **changes: Any) -> str:
    """An empty text where the call returns a value in every pixel, else why not."""
    options = {name: changes.pop(name) for name in ("filter", "disk", "wrt", "method", "budget") if name in changes}
    try:
        found = call({**scene, **changes}, size=(2, 1), tol=1e-2, **options)
    except sr.SymrenderError as error:
        return str(error).splitlines()[0]
    images = found.values() if isinstance(found, dict) else (found,)
    return "no value" if any((image.layer("status") == UNSUPPORTED).any() for image in images) else ""


def imaged(scene: Scene, **changes: Any) -> str:
    """An empty text where quadrature makes the image, else why not, after ``PATHS`` where paths make it."""
    refused = asked(scene, sr.truth, method="quadrature", **changes)
    if refused and not asked(scene, sr.truth, method="auto", budget=2_000, **changes):
        return PATHS + refused
    return refused


def by_light(scene: Scene) -> str:
    """The answer for a derivative by what a light sends, of an image with all bounces through a lens and a shutter."""
    camera = scene["camera"] | {"aperture": 0.05, "focus": 6}
    changes = {"camera": camera, "shutter": [0, 0.1], "filter": "box", "bounces": "all", "wrt": light_of(scene)}
    refused = asked(scene, sr.gradient, method="quadrature", **changes)
    if refused and not asked(scene, sr.gradient, method="auto", budget=2_000, **changes):
        return PATHS + refused
    return refused


def exposed(scene: Scene) -> str:
    """The answer for an image through a lens and a shutter."""
    camera = scene["camera"] | {"aperture": 0.05, "focus": 6}
    return imaged(scene, camera=camera, shutter=[0, 0.1], filter="box")


def light_of(scene: Scene) -> list[str]:
    """The name of a number that any scene with a light has."""
    light = scene["lights"][0]
    kinds = {"point": "intensity", "spot": "intensity", "sky": "radiance", "area": "radiance", "environment": "scale"}
    return [f"lights.{light['name']}.{kinds[light['type']]}"]


def place_of(scene: Scene) -> list[str]:
    """The name of a number that moves the last shape."""
    shape = scene["shapes"][-1]
    at = {"sphere": "center.x", "box": "center.x", "disk": "center.x", "mesh": "position.x", "cylinder": "base.x"}
    return [f"shapes.{shape['name']}.{at[shape['type']]}"]


Question = Callable[[Scene], str]
PHYSICAL_VERBS: Mapping[str, Question] = {
    "direct light": lambda scene: imaged(scene),
    "one bounce": lambda scene: imaged(scene, bounces=1),
    "all bounces": lambda scene: imaged(scene, bounces="all"),
    "box filter": lambda scene: imaged(scene, filter="box"),
    "lens, shutter": exposed,
    "gradient": lambda scene: asked(scene, sr.gradient, wrt=place_of(scene)),
    "gradient, one bounce": lambda scene: asked(scene, sr.gradient, wrt=place_of(scene), bounces=1),
    "gradient, box filter": lambda scene: asked(scene, sr.gradient, wrt=place_of(scene), filter="box"),
    "gradient by lights, all of these": by_light,
}


def _disk(name: str) -> dict[str, str]:
    return {"disk": "exact"} if name.endswith("exact") else {}


def series_verbs(name: str) -> Mapping[str, Question]:
    """The questions of a row in units of the series."""
    more, wrt = _disk(name), ["spheres.A.center.x"]
    return {
        "truth": lambda scene: asked(scene, sr.truth, **more),
        "box filter": lambda scene: asked(scene, sr.truth, filter="box", **more),
        "gradient": lambda scene: asked(scene, sr.gradient, wrt=wrt, **more),
        "gradient, box filter": lambda scene: asked(scene, sr.gradient, wrt=wrt, filter="box", **more),
        "simulator": lambda scene: page(scene),
    }


def page(scene: Scene) -> str:
    """Whether the simulator takes a scene."""
    try:
        sr.simulator(scene)
    except sr.SymrenderError as error:
        return str(error).splitlines()[0]
    return ""


def table(rows: Mapping[str, Mapping[str, str]], bar: str = " | ") -> str:
    """Ticks where quadrature answers, ``SAMPLED`` where paths do; ``bar`` stands between cells."""
    verbs = list(next(iter(rows.values())))
    lines = [["scene holds", *verbs], ["---"] + [":-:"] * len(verbs)]
    lines += [[name, *map(mark, row.values())] for name, row in rows.items()]
    return "\n".join(f"{bar.lstrip()}{bar.join(line)}{bar.rstrip()}" for line in lines) + "\n"


def mark(said: str) -> str:
    """What a cell shows of an answer."""
    return YES if not said else SAMPLED if said.startswith(PATHS) else NO


def reasons(rows: Mapping[str, Mapping[str, str]]) -> str:
    """Every refusal, as it is printed."""
    lines = ["| scene holds | asked for | message |", "| --- | --- | --- |"]
    lines += [f"| {name} | {verb} | `{said}` |" for name, row in rows.items() for verb, said in row.items() if said]
    return "\n".join(lines) + "\n"


def written(path: Path, regions: Mapping[str, str]) -> str:
    """The text of a page with its marked regions replaced."""
    text = path.read_text("utf-8")
    for mark, inside in regions.items():
        pattern = re.compile(REGION.format(mark), re.DOTALL)
        if not pattern.search(text):
            raise SystemExit(f"{path.name} has no region {mark}")
        text = pattern.sub(lambda _, inside=inside: inside, text)
    return text


def main() -> None:
    """Ask everything, write or compare."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="write nothing, fail where a page differs")
    options = parser.parse_args()
    physical_rows: dict[str, dict[str, str]] = {}
    series_rows: dict[str, dict[str, str]] = {}
    for name, scene in RADIOMETRIC.items():
        physical_rows[name] = {verb: ask(scene) for verb, ask in PHYSICAL_VERBS.items()}
        print(name, physical_rows[name], file=sys.stderr, flush=True)
    for name, scene in SERIES.items():
        series_rows[name] = {verb: ask(scene) for verb, ask in series_verbs(name).items()}
        print(name, series_rows[name], file=sys.stderr, flush=True)
    pages = {
        ROOT / "docs" / "support.md": {
            "support: radiometric": table(physical_rows),
            "support: series": table(series_rows),
            "support: reasons": reasons(physical_rows | series_rows),
        },
        ROOT / "README.md": {"support": table(physical_rows, bar="|")},
    }
    made = {path: written(path, regions) for path, regions in pages.items()}
    if options.check:
        differ = [path.name for path, text in made.items() if path.read_text("utf-8") != text]
        sys.exit(f"not as generated: {', '.join(differ)}" if differ else 0)
    for path, text in made.items():
        path.write_text(text, "utf-8")


if __name__ == "__main__":
    main()
