"""From a contradiction to its smallest scene: drop, blacken and round while the contradiction remains."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from .case import Case

Test = Callable[[Case], bool]


def shrunk(case: Case, fails: Test, most: int = 200) -> Case:
    """The smallest case found in ``most`` tries that still ``fails``."""
    tries = 0
    again = True
    while again and tries < most:
        again = False
        for smaller in simpler(case):
            tries += 1
            if tries > most:
                break
            try:
                worse = fails(smaller)
            except (ValueError, KeyError, ZeroDivisionError):
                continue
            if worse:
                case, again = smaller, True
                break
    return case


def simpler(case: Case) -> Iterator[Case]:
    """Cases one step simpler: one part less, one part plainer, one number rounder."""
    if len(case.points) > 1:
        for point in case.points:
            yield replace(case, points=[point])
    scene = case.scene
    for part in ("lights", "spheres"):
        for k, item in enumerate(scene.get(part, ())):
            if f"{part}.{item['name']}" != case.surface:
                yield _changed(case, lambda s, part=part, k=k: s[part].pop(k))
    if case.surface != "floor" and "floor" in scene:
        yield _changed(case, lambda s: s.pop("floor"))
    for k, sphere in enumerate(scene["spheres"]):
        if sphere.get("texture", {"type": "solid"})["type"] != "solid":
            yield _changed(case, lambda s, k=k: s["spheres"][k].update(texture={"type": "solid"}))
        if f"spheres.{sphere['name']}" != case.surface and "lobe" in sphere:
            yield _changed(case, lambda s, k=k: s["spheres"][k].pop("lobe"))
        if sphere.get("color") != [0.0, 0.0, 0.0]:
            yield _changed(case, lambda s, k=k: s["spheres"][k].update(color=[0.0, 0.0, 0.0]))
    for k, light in enumerate(scene["lights"]):
        if light["type"] == "disk":
            point = {key: light[key] for key in ("name", "position", "color")} | {"type": "point"}
            yield _changed(case, lambda s, k=k, point=point: s["lights"].__setitem__(k, point))
        if light["color"] != [1.0, 1.0, 1.0]:
            yield _changed(case, lambda s, k=k: s["lights"][k].update(color=[1.0, 1.0, 1.0]))
    floor = scene.get("floor")
    if floor is not None and floor["texture"] != {"type": "solid", "color": [0.0, 0.0, 0.0]}:
        yield _changed(case, lambda s: s["floor"].update(texture={"type": "solid", "color": [0.0, 0.0, 0.0]}))
    if floor is not None and case.surface != "floor" and "lobe" in floor:
        yield _changed(case, lambda s: s["floor"].pop("lobe"))
    for key in ("ambient", "background"):
        if scene.get(key, [0.0] * 3) != [0.0] * 3:
            yield _changed(case, lambda s, key=key: s.update({key: [0.0] * 3}))
    plain = {
        "model": "blinn", "highlight_view": "ray", "specular_terminator": "cut", "lobe_units": "lobe_average",
        "ka": 0.0, "kd": 0.0, "ks": 0.0,
    }  # fmt: skip
    for key, value in plain.items():
        if scene["shading"].get(key, value) != value:
            yield _changed(case, lambda s, key=key, value=value: s["shading"].update({key: value}))
    if case.disk == "2x2":
        yield replace(case, disk="1x1")
    for digits in (1, 2, 3):
        rounder = _rounded(scene, digits)
        if rounder != scene:
            yield replace(case, scene=rounder)
        points = [[round(x, digits) for x in point] for point in case.points]
        if case.surface == "floor" and points != case.points:
            yield replace(case, points=points)
        for part in ("lights", "spheres"):
            for k, item in enumerate(scene[part]):
                rounder = _rounded(item, digits)
                if rounder != item:
                    yield _changed(case, lambda s, part=part, k=k, r=rounder: s[part].__setitem__(k, r))


def _changed(case: Case, change: Callable[[dict[str, Any]], object]) -> Case:
    scene = copy.deepcopy(case.scene)
    change(scene)
    return replace(case, scene=scene)


def _rounded(value: Any, digits: int) -> Any:
    if isinstance(value, float):
        return round(value, digits)
    if isinstance(value, list | tuple):
        return [_rounded(x, digits) for x in value]
    if isinstance(value, dict):
        return {k: _rounded(v, digits) for k, v in value.items()}
    return value
