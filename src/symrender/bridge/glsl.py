"""The formulas of a scene as GLSL ES 3.00, for renderers that draw it themselves.

One text: the elementary functions whose accuracy in single precision is known, the formulas this scene needs, its
numbers as constants, and for every lobe its density and its rule, directions with weights. Beside it, what each
function returns at points of the scene, proved: ``vectors.py``.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from symrender.bridge.situations import hits, light_calls, lobe_calls
from symrender.bridge.vectors import vectors
from symrender.errors import OptionError, Unsupported
from symrender.expression.formulas.every import LEAVES
from symrender.images.output import check_target, write_bytes
from symrender.leaves import values
from symrender.limits import MAX_LISTED_LOBE
from symrender.quadrature.strata import rings, rule
from symrender.runtimes import numba
from symrender.scene.light import DiskLight
from symrender.targets.leaf_braces import glsl_module
from symrender.version import VERSION

if TYPE_CHECKING:
    from symrender.scene.lobe import Lobe
    from symrender.scene.scene import Scene

_COUNT: Final = 8
"""Vectors of each function, but for those that show a guard."""
_SEED: Final = 7


@dataclass(frozen=True)
class Exported:
    """GLSL ``text`` without a version line or ``main``, and the ``vectors`` that prove what its functions return."""

    text: str
    vectors: dict[str, Any]

    def save(self, path: str | Path, *, force: bool = True) -> tuple[Path, Path]:
        """Write ``path`` and, beside it, the vectors as JSON; returns both. ``OutputError`` where that fails."""
        target = Path(path)
        beside = target.with_name(f"{target.stem}.vectors.json")
        check_target(beside, force=force)
        write_bytes(target, self.text.encode(), force=force)
        write_bytes(beside, (json.dumps(self.vectors, indent=1, allow_nan=False) + "\n").encode(), force=force)
        return target, beside


def glsl(scene: Scene, *, lobe: int = 4) -> Exported:
    """The formulas of ``scene`` and rules of ``lobe`` x ``lobe`` directions, equal weight at barycentres.

    Raises ``Unsupported`` for lobes in BRDF units and ``OptionError`` without python-flint, which proves the vectors.
    """
    if scene.shading.lobe_units != "lobe_average":
        raise Unsupported(f"export glsl: shading.lobe_units {scene.shading.lobe_units} is not written")
    if not 1 <= lobe <= MAX_LISTED_LOBE:
        raise OptionError(f"lobe: must be from 1 to {MAX_LISTED_LOBE}, got {lobe}")
    glossy = list(_glossy(scene))
    lights = _names((light.name for light in scene.lights), "lights")
    used = ["mirror_direction", "sphere_hit", "floor_hit", "lobe_chord", "lobe_density", _term(scene), "light_channel"]
    parts = [_head(scene), glsl_module([LEAVES[name] for name in used]).rstrip()]
    parts += [_lobe(name, title, held, lobe) for name, title, held in glossy]
    if scene.lights:
        parts.append(_shading(scene))
        parts += [_light(scene, k, lights[light.name]) for k, light in enumerate(scene.lights)]
    rng = np.random.default_rng(_SEED)
    calls = list(hits(scene, rng, _COUNT))
    for name, _, held in glossy:
        calls += lobe_calls(name, held, rng, _COUNT)
    calls += light_calls(scene, lights, rng, _COUNT)
    asked = sorted({call.function for call in calls})
    told = {
        "version": VERSION,
        "scene": scene.name,
        "hash": scene.hash,
        "read": "low <= true value <= high; a float32 evaluation lies within [low - float32, high + float32]",
        "functions": {name: _signature(name) for name in asked},
        "vectors": list(vectors(calls)),
    }
    return Exported("\n\n".join(parts) + "\n", told)


def _signature(name: str) -> dict[str, Any]:
    if name in LEAVES:
        leaf = LEAVES[name]
        several = len(leaf.result_names) > 1
        return {
            "arguments": [f"float {x}" for x in leaf.scalars],
            "returns": "void" if several else "float",
            "out": list(leaf.result_names) if several else [],
        }
    arguments = ("direction", "axis") if name.endswith("_lobe") else ("light", "place", "normal", "view", "albedo")
    return {
        "arguments": [f"vec3 {x}" for x in arguments],
        "returns": "float" if len(arguments) == 2 else "vec3",
        "out": [],
    }


def _term(scene: Scene) -> str:
    return f"{scene.shading.model}_term"


def _number(x: float) -> str:
    text = str(np.float32(x))
    return text if "." in text or "e" in text else f"{text}.0"


def _vector(v: Iterable[float]) -> str:
    parts = [_number(x) for x in v]
    return f"vec{len(parts)}({', '.join(parts)})"


def _names(names: Iterable[str], kind: str) -> dict[str, str]:
    """A GLSL identifier for each part, by its name; underscores never stand in pairs, which GLSL keeps for itself."""
    found: dict[str, str] = {}
    for k, name in enumerate(names):
        plain = f"{kind}_{re.sub('[_-]+', '_', name).rstrip('_')}"
        found[name] = plain if plain not in found.values() else f"{plain}_{k}"
    return found


def _glossy(scene: Scene) -> Iterator[tuple[str, str, Lobe]]:
    """Identifier, dotted name and lobe of every surface that has one with a width."""
    names = _names((sphere.name for sphere in scene.spheres), "spheres")
    surfaces: list[tuple[str, str, Lobe | None]] = [
        (names[sphere.name], f"spheres.{sphere.name}", sphere.lobe) for sphere in scene.spheres
    ]
    if scene.floor is not None:
        surfaces.insert(0, ("floor", "floor", scene.floor.lobe))
    for identifier, title, held in surfaces:
        if held is not None and held.weight > 0 and held.theta_max > 0 and not held.mirror:
            yield identifier, title, held


def _head(scene: Scene) -> str:
    return (
        f"// The formulas of scene {scene.hash[:12]}, written by symrender {VERSION}: GLSL ES 3.00, single precision.\n"
        '// Put it after a version line and "precision highp float;". Beside it lie vectors that tell what it returns.'
    )


def _lobe(name: str, title: str, held: Lobe, k: int) -> str:
    log_rim = values.log_rim(held.theta_max)
    log_whole = values.log_normaliser(log_rim, held.exponent)
    half = math.sin(held.theta_max / 2)
    formulas: Any = numba.plain(numba.image_text())
    ring = rings(formulas, held.exponent, held.theta_max, k, nodes="barycentre", partition="equal_weight")
    found = rule(ring, sectors=k, normalised=False)
    rows = [_vector([*d, w]) for d, w in zip(found.directions.tolist(), found.weights.tolist(), strict=True)]
    listed = ",\n".join(f"  {row}" for row in rows)
    return f"""// {title}: reflects {name}_weight * mean radiance under cos^n, within theta_max of the mirror direction
const float {name}_weight = {_number(held.weight)}, {name}_exponent = {_number(held.exponent)};
const float {name}_theta_max = {_number(held.theta_max)}, {name}_log_normaliser = {_number(log_whole)};

// Density per solid angle of a direction about the mirror direction, both unit; 0 outside the cone.
float {name}_lobe(vec3 direction, vec3 axis) {{
  float square = lobe_chord(direction.x, direction.y, direction.z, axis.x, axis.y, axis.z);
  return square > {_number(4 * half * half)} ? 0.0 : lobe_density(square, {name}_exponent, {name}_log_normaliser);
}}

// {k} rings x {k} sectors: direction in the frame (across, beyond, axis), and its weight; they sum to 1.
const vec4 {name}_rule[{len(rows)}] = vec4[{len(rows)}](
{listed}
);"""


def _shading(scene: Scene) -> str:
    s = scene.shading
    return (
        "// Every light: color (kd albedo N.l + ks s), unblocked; ambient light adds ka ambient, which is a colour.\n"
        f"const float ka = {_number(s.ka)}, kd = {_number(s.kd)}, ks = {_number(s.ks)}, "
        f"shininess = {_number(s.shininess)};\n"
        f"const vec3 ambient = {_vector(scene.ambient)}, background = {_vector(scene.background)};"
    )


def _light(scene: Scene, k: int, name: str) -> str:
    light, term = scene.lights[k], _term(scene)
    kind = "a point"
    if isinstance(light, DiskLight):
        kind = f"a disk of radius {_number(light.radius)} that faces {_vector(light.target)}"
    cut = "highlight" if scene.shading.specular_terminator == "open" else "(cosine > 0.0 ? highlight : 0.0)"
    arguments = ", ".join(f"{v}.{c}" for v in ("to_light", "normal", "view") for c in "xyz")
    channels = ",\n    ".join(f"light_channel({name}_color.{c}, kd, ks, albedo.{c}, lit, shown)" for c in "rgb")
    return f"""// {scene.lights[k].name}: {kind}.
const vec3 {name}_position = {_vector(light.position)}, {name}_color = {_vector(light.color)};

// What a place reflects of one point of it toward ``view``, nothing in between; normal and view are unit.
vec3 {name}_light(vec3 light, vec3 place, vec3 normal, vec3 view, vec3 albedo) {{
  vec3 to_light = light - place;
  float cosine, highlight;
  {term}({arguments}, shininess, cosine, highlight);
  float lit = max(cosine, 0.0), shown = {cut};
  return vec3(
    {channels}
  );
}}"""
