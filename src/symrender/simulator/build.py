"""Simulator: one self-contained HTML file in which a scene is rendered live, by both estimators.

The page holds the program twice: as GLSL for its panels and as JavaScript, in double precision, for the probe. Both
are emitted from the formulas; nothing of the mathematics is written in the page. Nothing is loaded from anywhere.
"""

from __future__ import annotations

import base64
import hashlib
import html as html_text
import json
from dataclasses import asdict, dataclass
from functools import cache
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from symrender.errors import Unsupported
from symrender.images.output import write_bytes
from symrender.images.picture import CLASSES, SEQUENTIAL
from symrender.jit.records import column, columns, flat
from symrender.limits import (
    MAX_SIMULATOR_INSTANTS,
    MAX_SIMULATOR_LIGHT_POINTS,
    MAX_SIMULATOR_LOBE,
    MAX_SIMULATOR_LOBES,
    MAX_SIMULATOR_PLACES,
    MAX_SIMULATOR_PLANES,
    MAX_SIMULATOR_RINGS,
    MAX_SIMULATOR_SPHERES,
)
from symrender.scene import arrays as at
from symrender.scene.light import DiskLight
from symrender.scene.load import load
from symrender.scene.records import Camera, Floor, Light, Plane, Sphere
from symrender.scene.texture import Checker
from symrender.simulator.columns import entries
from symrender.simulator.picture import picture
from symrender.simulator.presets import glossy, presets
from symrender.simulator.state import State
from symrender.version import VERSION

if TYPE_CHECKING:
    from symrender.kernel.program import Program
    from symrender.scene.scene import Scene

_SCRIPTS: Final = (
    *("tables.js", "places.js", "gpu.js", "cpu.js", "reference.js", "present.js", "means.js", "controls.js"),
    *("mean_controls.js", "legend.js", "converge.js", "mean_reference.js"),
    *("disc.js", "pointer.js", "space.js", "video.js", "recipe.js", "certify.js", "links.js", "events.js", "page.js"),
)
_DISK_STRATA: Final = 2
_FORMULAS: Final = ("log_power",)
_LIT: Final = ("pixel_direct", "pixel_numeric", "pixel_symbolic")
"""Passes that do nothing with light points but sum their light."""
_VERTEX: Final = """#version 300 es
void main() {
  // one triangle that covers the target
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}
"""


@dataclass(frozen=True)
class Simulator:
    """A scene's page: ``html`` is the whole file, ``name`` the scene's; shown inline in a notebook."""

    html: str
    name: str

    def save(self, path: str | Path, *, force: bool = True) -> None:
        """Write the page; ``OutputError`` when it cannot be written."""
        write_bytes(path, self.html.encode(), force=force)

    def __repr__(self) -> str:
        return f"Simulator({self.name}, {len(self.html) / 1000:.0f} kB of HTML)"

    def _repr_html_(self) -> str:
        return (
            f'<iframe srcdoc="{html_text.escape(self.html)}" width="100%" height="900" '
            'style="border: 0" title="symrender simulator"></iframe>'
        )


def simulator(scene: Scene | str | Path | dict[str, Any], path: str | Path | None = None) -> Simulator:
    """Compile a scene to one offline HTML page with live estimators.

    Parameters
    ----------
    scene : str, path, mapping or scene
        A scene in units of the series.
    path : str or path, optional
        File that is written.

    Returns
    -------
    Simulator
        The page; it is shown in a notebook.

    Raises
    ------
    Unsupported
        The scene exceeds the limits of a page, is radiometric or has lobes in BRDF units.
    OutputError
        The file cannot be written.

    Notes
    -----
    The page draws by WebGL 2 with float targets, else by JavaScript, slowly.
    """
    chosen = load(scene, "simulator")
    made = simulator_page(chosen)
    if path is not None:
        made.save(path)
    return made


def simulator_page(scene: Scene, *, served: bool = False) -> Simulator:
    """The page of ``scene``; ``served``, it may ask the server it came from for proved intervals, and nothing else."""
    _check(scene)
    return Simulator(_page(scene, served), scene.name)


def _check(scene: Scene) -> None:
    if scene.shading.lobe_units != "lobe_average":
        raise Unsupported(
            f"simulator: shading.lobe_units {scene.shading.lobe_units} is not drawn; a page shows lobe_average"
        )
    points = light_point_count(scene)
    for what, count, most in (
        ("spheres", len(scene.spheres), MAX_SIMULATOR_SPHERES),
        ("planes", len(scene.planes), MAX_SIMULATOR_PLANES),
        ("surfaces with the floor", 1 + len(scene.spheres) + len(scene.planes), MAX_SIMULATOR_LOBES),
        ("light points", points, MAX_SIMULATOR_LIGHT_POINTS),
    ):
        if count > most:
            raise Unsupported(f"simulator: {count} {what} exceed {most}, the most a page's uniform blocks hold")


@cache
def _program() -> Program:
    from symrender.kernel.assemble_pixels import pixel_program

    return pixel_program()


@cache
def script() -> str:
    """The program in JavaScript, the same for every scene."""
    from symrender.targets import javascript

    return javascript.emit(_program())


@cache
def formulas() -> str:
    """The formulas the page's own scripts name, in JavaScript."""
    from symrender.expression.formulas.every import LEAVES
    from symrender.targets.leaf_braces import javascript_module

    return javascript_module([LEAVES[name] for name in _FORMULAS])


@cache
def shaders(spheres: int, planes: int, points: int) -> dict[str, str]:
    """The fragment shaders by pass, the same for every scene of as many spheres, planes and light points.

    Those named ``own`` read an eye and a time of every pixel.
    """
    from symrender.kernel.assemble_pixels import PASSES, SPREAD
    from symrender.kernel.straighten import straightened
    from symrender.targets import glsl

    # a light that is off is a row of zeros, black where light is summed; chambers are counted, so they ask for the rows
    shapes = {"spheres": spheres, "planes": planes}
    rows = {name: shapes | ({"points": points} if name in _LIT else {}) for name in PASSES}
    parts = {name: straightened(_program().part(name), rows[name]) for name in PASSES}
    return {name: glsl.emit(part) for name, part in parts.items()} | {
        f"{name} own": glsl.emit(parts[name], spread=True) for name in SPREAD
    }


@cache
def reads() -> dict[str, list[str]]:
    """The tables each pass reads, by name."""
    from symrender.kernel.assemble_pixels import PASSES, TABLES
    from symrender.kernel.program import Array

    functions = {function.name: function for function in _program().functions}
    return {
        name: [p.name for p in functions[name].parameters if isinstance(p, Array) and not TABLES[p.name].scratch]
        for name in (*PASSES, "pixel_seen")
    }


@cache
def takes() -> dict[str, list[str]]:
    """The arguments of each pass, by name."""
    from symrender.kernel.assemble_pixels import PASSES

    functions = {function.name: function for function in _program().functions}
    return {name: [p.name for p in functions[name].parameters] for name in PASSES}


@cache
def _gauss() -> list[list[list[float]]]:
    """Nodes in [0, 1] and weights, whose sum is 1, of Gauss rules of 1, 2, ... nodes."""
    rules = [np.polynomial.legendre.leggauss(n) for n in range(1, MAX_SIMULATOR_INSTANTS + 1)]
    return [[(0.5 + 0.5 * x).tolist(), (0.5 * w).tolist()] for x, w in rules]


def light_point_count(scene: Scene) -> int:
    """Points the lights of a scene are replaced by in a page: a disk is four, whatever its radius."""
    return sum(_DISK_STRATA**2 if isinstance(light, DiskLight) else 1 for light in scene.lights)


def page_data(scene: Scene) -> dict[str, Any]:
    """What the page is told of the scene: plain data only."""
    from symrender.kernel.assemble_pixels import TABLES
    from symrender.targets.glsl import blocks

    arrays = at.scene_arrays(scene)
    spheres = arrays.spheres
    # a texture that may be chosen later takes its defaults where the present one has no such number
    for row, sphere in zip(spheres, scene.spheres, strict=True):
        for name in ("ku", "kv", "dark"):
            if not hasattr(sphere.texture, name):
                setattr(row, name, getattr(Checker(), name))
    return {
        "name": scene.name,
        "description": scene.description,
        "hash": scene.hash,
        "version": VERSION,
        "arrays": {
            name: flat(getattr(arrays, name)).tolist()
            for name in ("spheres", "floor", "planes", "lights", "shading", "camera")
        },
        "fields": {
            name: {"columns": columns(kind), **{field: column(kind, field) for field in kind.names()}}
            for name, kind in (
                ("sphere", Sphere),
                ("floor", Floor),
                ("plane", Plane),
                ("light", Light),
                ("camera", Camera),
            )
        },
        "spheres": [sphere.name for sphere in scene.spheres],
        "planes": [plane.name for plane in scene.planes],
        "lights": [{"name": light.name, "disk": isinstance(light, DiskLight)} for light in scene.lights],
        "glossy": glossy(scene),
        "parameters": list(entries(scene)),
        "defaults": asdict(State()),
        "presets": [asdict(p) for p in presets(scene)],
        "limits": {
            "lobe": MAX_SIMULATOR_LOBE,
            "pixel": MAX_SIMULATOR_PLACES,
            "instants": MAX_SIMULATOR_INSTANTS,
            "rings": MAX_SIMULATOR_RINGS,
        },
        "gauss": _gauss(),
        "tables": {name: {"columns": t.columns, "rows": t.rows} for name, t in TABLES.items()},
        "blocks": blocks(),
        "reads": reads(),
        "takes": takes(),
        "shaders": shaders(len(scene.spheres), len(scene.planes), light_point_count(scene)),
        "vertex": _VERTEX,
        "classes": CLASSES,
        "scale": SEQUENTIAL,
    }


def escaped(data: Any) -> str:
    """JSON that cannot end, open or comment out an element it stands in."""
    text = json.dumps(data, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _page(scene: Scene, served: bool) -> str:
    files = resources.files("symrender.simulator") / "page"
    style = (files / "style.css").read_text(encoding="utf-8")
    code = "\n".join([script(), formulas(), *((files / name).read_text(encoding="utf-8") for name in _SCRIPTS)])
    code = f'(() => {{\n"use strict";\n{code}\n}})();'
    policy = (
        f"default-src 'none'; script-src {_digest(code)}; style-src {_digest(style)}; img-src data: blob:; "
        "media-src blob:; base-uri 'none'; form-action 'none'" + ("; connect-src 'self'" if served else "")
    )
    holes = {
        "policy": html_text.escape(policy),
        "title": html_text.escape(f"{scene.name}: symrender simulator"),
        "name": html_text.escape(scene.name),
        "picture": base64.b64encode(picture(scene)).decode(),
        "style": style,
        "script": code,
        "data": escaped(page_data(scene) | {"served": served}),
    }
    text = (files / "page.html").read_text(encoding="utf-8")
    parts = text.split("@@")
    if set(parts[1::2]) != set(holes):
        raise ValueError("page.html: holes and values differ")
    return "".join(holes[part] if k % 2 else part for k, part in enumerate(parts))


def _digest(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
