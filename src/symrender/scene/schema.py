"""JSON Schema of scene files, for editors that complete and check them."""

from __future__ import annotations

from typing import Any

from symrender.scene.scene import Scene


def json_schema() -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of a scene; numbers carry their range and, under ``unit``, their unit.

    Conditions between fields (unique names, ``eye`` and ``target`` apart, ``up`` across the view) are beyond it.
    """
    schema = Scene.model_json_schema(mode="validation")
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
