"""What the truth says of a pair: how far each image is from it, and how well that is known."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from symrender.images.image import Image
from symrender.ledger.compare import Comparison, compare
from symrender.ledger.ledger import Ledger, Pipeline

LAYERS = ("radiance", "gloss")


@dataclass(frozen=True)
class Judged:
    """One image of a pair beside the truth, layer by layer."""

    pipeline: Pipeline
    comparisons: dict[str, Comparison]


@dataclass(frozen=True)
class Judgement:
    """Both images of a pair beside the truth.

    ``doubt`` is the RMS of the truth's own stated errors: by the triangle inequality no RMS distance from the true
    image differs by more from the distance given here.
    """

    judged: tuple[Judged, ...]
    doubt: float
    largest_error: float
    missed: int

    def as_json(self) -> dict[str, Any]:
        """Plain data, as the page and programs read it."""
        return {
            "doubt": self.doubt,
            "largest_error": self.largest_error,
            "missed": self.missed,
            "pictures": {
                j.pipeline.name: {
                    "estimator": j.pipeline.estimator,
                    "seconds": j.pipeline.timing.seconds,
                    "evaluations": j.pipeline.timing.evaluations,
                    "layers": {name: c.as_json() for name, c in j.comparisons.items()},
                }
                for j in self.judged
            },
        }


def judge(truth: Image, numeric: Image, symbolic: Image, ledger: Ledger) -> Judgement:
    """Judge both images of a pair; ``ImageError`` where they cannot be compared with ``truth``."""
    images = {"numeric": numeric, "symbolic": symbolic}
    error = truth.layer("error")
    judged = tuple(
        Judged(p, {name: compare(truth, images[p.name], layer=name) for name in LAYERS}) for p in ledger.pipelines
    )
    doubt = float(np.sqrt(np.mean(error**2)))
    return Judgement(judged, doubt, float(error.max()), int((truth.layer("status") != 0).sum()))
