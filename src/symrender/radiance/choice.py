"""Which provider computes each component of an image, and why no other does."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from symrender.errors import Unsupported
from symrender.runtimes.exposed import check_means
from symrender.runtimes.radiometric import check
from symrender.scene.radiometric.arrays import RadiometricArrays
from symrender.settings import Settings


@dataclass(frozen=True)
class Plan:
    """What is sampled of an image, with the reason; ``""`` where quadrature covers it.

    ``direct`` holds emitted and direct light, ``indirect`` light that is reflected more than once.
    """

    direct: str
    indirect: str

    @property
    def sampled(self) -> bool:
        """Whether any component is sampled."""
        return bool(self.direct or self.indirect)

    def providers(self) -> dict[str, str]:
        """The provider of each layer, with the reason where it is not quadrature."""
        told = {"emitted": self.direct, "direct": self.direct, "indirect": self.indirect}
        return {name: f"sampled: {reason}" if reason else "quadrature" for name, reason in told.items()}


def plan_of(arrays: RadiometricArrays, settings: Settings) -> Plan:
    """Return who computes which component of an image.

    Raises
    ------
    Unsupported
        With ``method: quadrature``, if quadrature does not cover the whole image.
    """
    if settings.method == "sampled":
        asked = "method: sampled was asked for"
        return Plan(asked, asked)
    if settings.method == "quadrature":
        _check(arrays, settings)
        return Plan("", "")
    whole = _reason(arrays, settings)
    if not whole or not arrays.bounces:
        return Plan(whole, whole)
    return Plan(_reason(replace(arrays, bounces=0), settings), whole)


def _check(arrays: RadiometricArrays, settings: Settings) -> None:
    """Raise ``Unsupported`` if quadrature does not cover an image."""
    check(arrays)
    check_means(arrays, settings)


def refusal(check: Callable[[], None]) -> Unsupported | None:
    """What ``check`` raises if something is not covered, None if it returns."""
    try:
        check()
    except Unsupported as error:
        return error
    return None


def _reason(arrays: RadiometricArrays, settings: Settings) -> str:
    """Why quadrature does not cover an image, ``""`` if it does."""
    return str(refusal(lambda: _check(arrays, settings)) or "")
