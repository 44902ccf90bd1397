"""What a frame becomes: images and a row of figures, one maker for each kind of image."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

from symrender.execution.fill import Crew
from symrender.execution.jobs import Job
from symrender.images.image import Image
from symrender.scene.scene import Scene
from symrender.settings import Settings

Row = dict[str, Any]
"""Column to plain value."""


class Maker(Protocol):
    """Makes the images of a frame. ``signed``: they hold values of both signs, not light."""

    @property
    def signed(self) -> bool:
        """Whether 0 is the middle of what the images hold."""

    def names(self, scene: Scene) -> tuple[str, ...]:
        """Names of the images ``make`` returns, as they stand in file names."""

    def jobs(self, scene: Scene) -> tuple[Job, ...]:
        """The jobs of a frame."""

    def make(self, crew: Crew, scene: Scene) -> tuple[Mapping[str, Image], Row]:
        """Images by name, and their figures."""


@dataclass(frozen=True)
class Rendered:
    """Frames as ``symrender render`` makes them; the row is their ledger."""

    settings: Settings
    signed: bool = field(default=False, init=False)

    def names(self, scene: Scene) -> tuple[str, ...]:
        """``numeric``, ``symbolic``, or both."""
        return tuple(job.kind for job in self.jobs(scene))

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
    signed: bool = field(default=False, init=False)

    def names(self, scene: Scene) -> tuple[str, ...]:
        """``truth``."""
        return ("truth",)

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


@dataclass(frozen=True)
class Sloped:
    """Frames as ``symrender gradient`` makes them, an image a parameter of ``wrt``; the row says how each fared."""

    settings: Settings
    wrt: tuple[str, ...]
    signed: bool = field(default=True, init=False)

    def names(self, scene: Scene) -> tuple[str, ...]:
        """``gradient_`` and each parameter, vectors written out; errors where one has no derivative."""
        from symrender.gradient import file_stem

        return tuple(file_stem(name) for name, _ in self.jobs(scene)[0].wrt)

    def jobs(self, scene: Scene) -> tuple[Job, ...]:
        """The one job."""
        from symrender.gradient import gradient_job

        return (gradient_job(scene, self.wrt, self.settings),)

    def make(self, crew: Crew, scene: Scene) -> tuple[Mapping[str, Image], Row]:
        """An image a parameter, its largest error and how many pixels missed, by status."""
        from symrender.gradient import STATUS, file_stem, gradient_images

        images = gradient_images(crew, self.jobs(scene)[0], scene)
        row: Row = {"pixels": self.settings.width * self.settings.height}
        for name, image in images.items():
            status = image.layer("status")
            row[f"{name}_largest_error"] = float(image.layer("error").max())
            row |= {f"{name}_missed_{label}": int((status == code).sum()) for code, label in STATUS.items() if code}
        return {file_stem(name): image for name, image in images.items()}, row
