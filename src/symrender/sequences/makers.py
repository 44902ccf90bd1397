"""What a frame becomes: images and a row of figures, one maker for each kind of image."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from symrender.fill import Crew
from symrender.image import Image
from symrender.scene.scene import Scene
from symrender.settings import Settings
from symrender.units import Job

Row = dict[str, Any]
"""Column to plain value."""


class Maker(Protocol):
    """Makes the images of a frame."""

    def jobs(self, scene: Scene) -> tuple[Job, ...]:
        """The jobs of a frame."""

    def make(self, crew: Crew, scene: Scene) -> tuple[Mapping[str, Image], Row]:
        """Images by name, and their figures."""


@dataclass(frozen=True)
class Rendered:
    """Frames as ``symrender render`` makes them; the row is their ledger."""

    settings: Settings

    def jobs(self, scene: Scene) -> tuple[Job, ...]:
        """One job a pipeline asked for."""
        from symrender.render import plan

        return plan(scene, self.settings)

    def make(self, crew: Crew, scene: Scene) -> tuple[Mapping[str, Image], Row]:
        """Both images, their costs and their differences."""
        from symrender.render import carry_out

        pair = carry_out(crew, self.jobs(scene), scene)
        row: Row = {}
        for pipeline in pair.ledger.pipelines:
            row[f"{pipeline.name}_seconds"] = round(pipeline.timing.seconds, 4)
            row[f"{pipeline.name}_evaluations"] = pipeline.timing.evaluations
        for layer, compared in pair.ledger.comparisons.items():
            row[f"{layer}_signal"] = compared.whole.signal
            row[f"{layer}_rmse"] = compared.whole.rmse
            row[f"{layer}_max_abs"] = compared.whole.max_abs
        if pair.ledger.comparisons:
            row["flips"] = pair.ledger.flips
        images = {"numeric": pair.numeric, "symbolic": pair.symbolic}
        return {name: image for name, image in images.items() if image is not None}, row


@dataclass(frozen=True)
class Certain:
    """Frames as ``symrender truth`` makes them; the row says how many pixels met the tolerance."""

    settings: Settings

    def jobs(self, scene: Scene) -> tuple[Job, ...]:
        """The one job."""
        from symrender.truth import truth_job

        return (truth_job(scene, self.settings),)

    def make(self, crew: Crew, scene: Scene) -> tuple[Mapping[str, Image], Row]:
        """The image and its verdict."""
        from symrender.truth import true_image, verdict

        image = true_image(crew, self.jobs(scene)[0], scene)
        judged = verdict(image)
        row: Row = {"pixels": judged.pixels, "largest_error": judged.largest}
        return {"truth": image}, row | {f"missed_{name}": count for name, count in judged.missed.items()}
