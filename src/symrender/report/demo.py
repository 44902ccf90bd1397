"""Both pictures of a scene and the truth beside them, at the size the truth fits into."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

from symrender.errors import OptionError
from symrender.execution.fill import Crew, Means
from symrender.execution.jobs import code_digest
from symrender.execution.preview import Watch
from symrender.execution.tiles import Progress, thread_count
from symrender.images.image import Image
from symrender.render import Pair, carry_out, plan
from symrender.report.fitting import fitting
from symrender.report.judgement import Judgement, judge
from symrender.scene.scene import Scene
from symrender.settings import Settings, split_settings
from symrender.truth import true_image, truth_job

Finished = Callable[[str, Image], None]
"""``finished(name, image)``, called as soon as ``numeric``, ``symbolic`` or ``truth`` stands."""


@dataclass(frozen=True)
class Demo:
    """The pair of ``scene``, its ``truth``, and what the one says of the other.

    All three images are of one size: that of ``asked``, or the largest share of it (3/4, 1/2, 3/8, ...) at which
    the truth was expected to take at most ``seconds``; ``expected`` is how many at the size taken.
    """

    scene: Scene
    asked: Settings
    settings: Settings
    pair: Pair
    truth: Image
    truth_seconds: float
    judgement: Judgement
    seconds: float
    expected: float

    @property
    def numeric(self) -> Image:
        """The image of the conventional side."""
        assert self.pair.numeric is not None
        return self.pair.numeric

    @property
    def symbolic(self) -> Image:
        """The image of the rule over strata."""
        assert self.pair.symbolic is not None
        return self.pair.symbolic

    @property
    def truth_tol(self) -> float:
        """The error asked of every pixel of the truth, scene radiance."""
        return float(json.loads(self.truth.meta["settings"])["tol"])

    @property
    def threads(self) -> int:
        """Threads that worked."""
        return thread_count(self.settings.threads)

    @property
    def code(self) -> str:
        """What identifies the code that made the images."""
        return code_digest()[:16]

    @property
    def smaller(self) -> bool:
        """Whether the images are smaller than was asked."""
        return self.settings.width < self.asked.width


def demo(
    scene: Scene,
    settings: Settings,
    *,
    tol: float,
    seconds: float,
    progress: Progress | None = None,
    preview: Watch | None = None,
    finished: Finished | None = None,
) -> Demo:
    """Make the pair ``settings`` describe and the truth to ``tol`` in at most about ``seconds`` more.

    Each image is told to ``finished`` as soon as it stands; a pair told first at the size asked is told again if the
    truth does not fit that size. OptionError where ``settings`` leave out a side.
    """
    if settings.numeric == "none" or settings.symbolic == "none":
        raise OptionError("numeric, symbolic: a report shows both, neither may be 'none'")
    if not 0 < seconds < float("inf"):
        raise OptionError(f"seconds: must be a finite number > 0, got {seconds!r}")
    jobs = plan(scene, settings)
    size = (settings.width, settings.height)
    means = Means(settings.threads, settings.tile)
    true_settings = split_settings(
        size,
        tol=tol,
        disk=settings.disk,
        aa=settings.aa,
        budget=settings.budget,
        threads=settings.threads,
        tile=settings.tile,
        counts=False,
        silhouettes=settings.silhouettes,
    )
    job = truth_job(scene, true_settings)
    with Crew(means, (*jobs, job), progress, preview=preview) as crew:
        pair = carry_out(crew, jobs, scene, finished)
        assert pair.symbolic is not None
        taken, expected = fitting(job, crew.workers, pair.symbolic.layer("hit_class"), seconds)
        small = replace(settings, width=taken.width, height=taken.height)
        if small != settings:
            pair = carry_out(crew, plan(scene, small), scene, finished)
        begun = time.perf_counter()
        truth = true_image(crew, truth_job(scene, taken), scene)
        spent = time.perf_counter() - begun
    if finished is not None:
        finished("truth", truth)
    assert pair.numeric is not None and pair.symbolic is not None
    judgement = judge(truth, pair.numeric, pair.symbolic, pair.ledger)
    return Demo(scene, settings, small, pair, truth, spent, judgement, seconds, expected)
