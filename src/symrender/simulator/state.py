"""The state of a page as text for a URL, the same in the page and here: ``#s=`` and deflated JSON in base64url."""

from __future__ import annotations

import base64
import json
import math
import zlib
from dataclasses import asdict, dataclass, field
from typing import Any, Final, Literal, get_args

from symrender.errors import OptionError
from symrender.limits import (
    MAX_SIMULATOR_INSTANTS,
    MAX_SIMULATOR_LOBE,
    MAX_SIMULATOR_PLACES,
    MAX_SIMULATOR_RINGS,
    MAX_STATE_BYTES,
)
from symrender.scene.scene import Scene
from symrender.settings import Partition, Weights

View = Literal["full", "gloss", "direct", "class", "chambers"]
Node = Literal["midpoint", "barycentre"]
Disc = Literal["weight", "angle"]
Pair = Literal["numeric-symbolic", "numeric-reference", "symbolic-reference"]
_VERSION: Final = 1
_SIZES: Final = (16, 1024)
_CHOICES: Final = {"weights": Weights, "nodes": Node, "partition": Partition, "view": View, "disc": Disc, "pair": Pair}


@dataclass(frozen=True)
class State:
    """What a page shows: changes to the scene by dotted name, and how it is rendered.

    ``scene`` maps dotted names to numbers and choices, as ``Scene.replace`` takes them; ``off`` names the lights that
    are switched off. ``exposure`` is in stops, ``pair`` the two panels whose difference is shown,
    ``difference`` the power of ten it is multiplied by (None: scaled to what is there), ``cursor`` the probed pixel
    (column, row) of the image.

    A pixel is a mean over ``pixel`` x ``pixel`` places of it, over ``instants`` of the time between the two of
    ``shutter``, and over a thin lens of the radius ``aperture`` sharp at the distance ``focus`` (None: what the camera
    looks at), at ``rings`` rings of it. ``mover`` names the sphere that has the ``velocity``, in units a second; None
    is the first. 1, a shutter that opens and closes at once and an aperture of 0 are a ray through the centre.
    """

    scene: dict[str, float | str] = field(default_factory=dict)
    off: tuple[str, ...] = ()
    size: int = 256
    lobe: int = 4
    weights: Weights = "exact"
    nodes: Node = "midpoint"
    partition: Partition = "equal_angle"
    normalised: bool = False
    seed: int = 7
    view: View = "full"
    exposure: float = 0.0
    pair: Pair = "numeric-symbolic"
    difference: int | None = None
    disc: Disc = "weight"
    cursor: tuple[int, int] | None = None
    pixel: int = 1
    shutter: tuple[float, float] = (0.0, 0.0)
    instants: int = 4
    mover: str | None = None
    velocity: tuple[float, float, float] = (1.0, 0.0, 0.0)
    aperture: float = 0.0
    focus: float | None = None
    rings: int = 2

    def __post_init__(self) -> None:
        for name, kind in _CHOICES.items():
            if getattr(self, name) not in get_args(kind):
                raise OptionError(f"{name}: must be one of {', '.join(get_args(kind))}, got {getattr(self, name)!r}")
        for name, low, high in (
            ("size", *_SIZES),
            ("lobe", 1, MAX_SIMULATOR_LOBE),
            ("seed", 0, (1 << 31) - 1),
            ("difference", 0, 6),
            ("pixel", 1, MAX_SIMULATOR_PLACES),
            ("instants", 1, MAX_SIMULATOR_INSTANTS),
            ("rings", 1, MAX_SIMULATOR_RINGS),
        ):
            value = getattr(self, name)
            if name == "difference" and value is None:
                continue
            if type(value) is not int or not low <= value <= high:
                raise OptionError(f"{name}: must be a whole number from {low} to {high}, got {value!r}")
        if type(self.normalised) is not bool:
            raise OptionError(f"normalised: must be true or false, got {self.normalised!r}")
        if not isinstance(self.exposure, int | float) or not math.isfinite(self.exposure) or abs(self.exposure) > 16:
            raise OptionError(f"exposure: must be a number of stops from -16 to 16, got {self.exposure!r}")
        self._check_exposure()
        if not all(isinstance(name, str) for name in (*self.off, *self.scene)):
            raise OptionError("off, scene: must name lights and numbers of the scene")
        cursor = self.cursor
        if cursor is not None and not (len(cursor) == 2 and all(type(v) is int and 0 <= v < self.size for v in cursor)):
            raise OptionError(f"cursor: must be (column, row) inside the image, got {cursor!r}")

    def _check_exposure(self) -> None:
        for name, count in (("shutter", 2), ("velocity", 3)):
            value = getattr(self, name)
            if not isinstance(value, tuple) or len(value) != count or not all(map(_is_finite, value)):
                raise OptionError(f"{name}: must be {count} finite numbers, got {value!r}")
        if self.shutter[0] > self.shutter[1]:
            raise OptionError(f"shutter: must open before it closes, got {self.shutter!r}")
        if not _is_finite(self.aperture) or self.aperture < 0:
            raise OptionError(f"aperture: must be a finite number, 0 or more, got {self.aperture!r}")
        if self.focus is not None and not (_is_finite(self.focus) and self.focus > 0):
            raise OptionError(f"focus: must be a finite number above 0, got {self.focus!r}")
        if self.mover is not None and not isinstance(self.mover, str):
            raise OptionError(f"mover: must name a sphere, got {self.mover!r}")

    def apply(self, scene: Scene) -> Scene:
        """``scene`` with the changes of this state; SceneError where it has no such number or part.

        What moves stands where it is in the middle of the shutter's time, as a page's probe sees it.
        """
        return self.at(scene, 0.5 * (self.shutter[0] + self.shutter[1]))

    def at(self, scene: Scene, time: float) -> Scene:
        """``scene`` with the changes of this state at a ``time`` in seconds."""
        changes: dict[str, object] = dict(self.scene)
        changes |= {f"lights.{name}.color": (0.0, 0.0, 0.0) for name in self.off}
        changed = _with_textures(scene, changes).replace(changes)
        way = [time * v for v in self.velocity]
        if not scene.spheres or not any(way):
            return changed
        mover = self.mover if self.mover is not None else scene.spheres[0].name
        center = next((sphere.center for sphere in changed.spheres if sphere.name == mover), (0.0, 0.0, 0.0))
        return changed.replace({f"spheres.{mover}.center": tuple(c + w for c, w in zip(center, way, strict=True))})


def _is_finite(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _with_textures(scene: Scene, changes: dict[str, object]) -> Scene:
    """Change the kind of textures, taking ``texture.type`` out of ``changes``."""
    from symrender.scene.parameters import get

    for name in [n for n in changes if n.endswith(".texture.type")]:
        kind, path = changes.pop(name), name.removesuffix(".type")
        held = get(scene, path).model_dump()
        keys = {"checker": ("ku", "kv", "dark"), "stripes": ("ku", "dark"), "marble": ("ku", "kv")}.get(str(kind), ())
        values = {key: changes.pop(f"{path}.{key}", held.get(key)) for key in ("ku", "kv", "dark")}
        scene = scene.replace({path: {"type": kind, **{k: values[k] for k in keys if values[k] is not None}}})
    return scene


def to_fragment(state: State) -> str:
    """``#s=...`` for ``state``; only what differs from the defaults is stored."""
    plain, plain_defaults = asdict(state), asdict(State())
    kept = {key: value for key, value in plain.items() if value != plain_defaults[key]}
    text = json.dumps({"v": _VERSION, **kept}, separators=(",", ":"), allow_nan=False)
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    packed = packer.compress(text.encode()) + packer.flush()
    return "#s=" + base64.urlsafe_b64encode(packed).decode().rstrip("=")


def to_url(state: State, page: str) -> str:
    """``page`` (an address or a file name) showing ``state``."""
    return page.partition("#")[0] + to_fragment(state)


def from_url(url: str) -> State:
    """The state of an address with ``#s=...``, bit for bit; OptionError for anything else."""
    _, found, text = url.partition("#s=")
    if not found or len(text) > MAX_STATE_BYTES:
        raise OptionError(f"url: must end in #s=..., at most {MAX_STATE_BYTES} characters, got {url[:60]!r}")
    try:
        unpacker = zlib.decompressobj(-15)
        packed = base64.b64decode(text + "=" * (-len(text) % 4), altchars=b"-_", validate=True)
        plain = json.loads(unpacker.decompress(packed, MAX_STATE_BYTES))
    except (ValueError, zlib.error, RecursionError):
        raise OptionError(f"url: #s= holds no state, got {text[:60]!r}") from None
    return from_plain(plain)


def from_plain(plain: Any) -> State:
    """State from the plain data a page stores."""
    if not isinstance(plain, dict) or plain.pop("v", None) != _VERSION:
        raise OptionError(f"url: the state must be of version {_VERSION}")
    unknown = set(plain) - set(asdict(State()))
    if unknown:
        raise OptionError(f"url: unknown entries {', '.join(sorted(map(repr, unknown)))[:80]}")
    if not isinstance(plain.get("scene", {}), dict):
        raise OptionError("url: scene must map names to values")
    for key in ("off", "cursor", "shutter", "velocity"):
        if isinstance(plain.get(key), list):
            plain[key] = tuple(plain[key])
    try:
        return State(**plain)
    except TypeError:
        raise OptionError("url: the state holds values of the wrong kind") from None
