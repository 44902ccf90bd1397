"""The JSON Schema says what the loader does, as far as a schema can."""

from __future__ import annotations

import json
from typing import Any

from symrender.limits import MAX_SPHERES
from symrender.scene.load import load
from symrender.scene.parameters import parameters
from symrender.scene.schema import json_schema


def test_units_ranges_and_closed_objects() -> None:
    schema = json_schema()
    parts: dict[str, Any] = schema["$defs"]
    assert schema["properties"]["spheres"]["maxItems"] == MAX_SPHERES
    assert {"Sphere", "Floor", "Lobe", "DiskLight", "PointLight", "PlaneCamera", "LookAtCamera", "Marble"} <= set(parts)
    assert all(part["additionalProperties"] is False for part in (schema, *parts.values()))
    radius = parts["Sphere"]["properties"]["radius"]
    assert (radius["type"], radius["unit"], radius["minimum"]) == ("number", "length", 1e-150)
    fov = parts["LookAtCamera"]["properties"]["fov"]
    assert (fov["unit"], fov["exclusiveMinimum"], fov["exclusiveMaximum"]) == ("degree", 0, 180)
    assert parts["Sphere"]["properties"]["center"]["minItems"] == 3
    json.dumps(schema, allow_nan=False)


def test_every_number_has_a_unit() -> None:
    def units(node: Any) -> list[Any]:
        if isinstance(node, dict):
            own = [node.get("unit")] if node.get("type") == "number" else []
            return own + [unit for entry in node.values() for unit in units(entry)]
        return [unit for entry in node for unit in units(entry)] if isinstance(node, list) else []

    found = units(json_schema())
    assert len(found) > 40
    assert None not in found
    assert {p.unit for p in parameters(load("gloss"))} <= set(found)
