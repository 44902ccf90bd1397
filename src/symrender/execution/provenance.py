"""What an image carries of its making, so that it can be made again from the file alone."""

from __future__ import annotations

import json
from dataclasses import asdict

from symrender.execution.jobs import CHANGES_NO_BYTE
from symrender.scene.dump import to_yaml
from symrender.scene.scene import Scene
from symrender.settings import Settings
from symrender.version import VERSION


def provenance(scene: Scene, settings: Settings, method: str, estimator: str) -> dict[str, str]:
    """Metadata of an image of ``scene``: the scene as text, the settings that decide its bytes, method and units."""
    decisive = {name: value for name, value in asdict(settings).items() if name not in CHANGES_NO_BYTE}
    return {
        "scene": to_yaml(scene),
        "scene_name": scene.name,
        "scene_hash": scene.hash,
        "method": method,
        "settings": json.dumps(decisive, sort_keys=True),
        "seed": str(settings.seed),
        "version": VERSION,
        "estimator": estimator,
        "units": "scene radiance, linear RGB",
        "convention": scene.shading.lobe_units,
    }
