"""An audit that looks several times, as images come, and keeps its level.

The level is spent: look j = 1, 2, ... has level / 2^j, so by Bonferroni's inequality the chance of any false alarm in
all looks together is at most the level, whatever the dependence between them. Spending functions: Lan and DeMets,
doi:10.1093/biomet/70.3.659.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

import numpy as np
import numpy.typing as npt

from symrender.audit.measured import NOWHERE, Measured, Origin, Render, of_seeds, radiances
from symrender.audit.verdict import Verdict
from symrender.errors import OptionError
from symrender.limits import MAX_SEEDS, MIN_SEEDS

Array = npt.NDArray[np.float64]
Look = Callable[[Measured, float, int], Verdict]


def sequential(renders: Iterable[Render], level: float, visible: float, look: Look) -> Verdict:
    """Look after 8, 16, 32 ... images and after the last; stop at the first decision.

    A look that fails decides; so does one that passes with a power that sees ``visible``, a relative bias of the whole
    image (0: only the last image decides). Images after the decision are not read.
    """
    source: Iterator[Render] = iter(renders)
    held: Array | None = None
    receipts: tuple[str, ...] = ()
    origin: Origin | None = None
    verdict: Verdict | None = None
    for number, count in enumerate(_looks(), start=1):
        fresh = [render for _, render in zip(range(count - (0 if held is None else len(held))), source, strict=False)]
        if fresh:
            more, named, origin = radiances(fresh, origin)
            receipts += named
            if held is not None and more.shape[1:] != held.shape[1:]:
                raise OptionError("renders: must all have the size of the first")
            held = more if held is None else np.concatenate([held, more])
        elif verdict is not None:
            return verdict
        if held is None or len(held) < MIN_SEEDS:
            got = 0 if held is None else len(held)
            raise OptionError(f"sequential: needs at least {MIN_SEEDS} images of {MIN_SEEDS} seeds, got {got}")
        verdict = look(of_seeds(held, receipts, origin or NOWHERE), level / 2.0**number, number)
        whole = max((t.visible_relative for t in verdict.regions if t.region == "all"), default=np.inf)
        decided = verdict.verdict == "failed" or (verdict.passed and whole <= visible)
        if decided or len(held) < count:
            return verdict
    raise OptionError(f"sequential: {MAX_SEEDS} images are the most")


def _looks() -> Iterator[int]:
    count = MIN_SEEDS
    while count <= MAX_SEEDS:
        yield count
        count *= 2
