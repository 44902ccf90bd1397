"""Radiometric scenes bound to a camera: emission and direct light in closed form, one bounce by the split rule."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from symrender.errors import Unsupported
from symrender.jit.compiled import compiled
from symrender.quadrature.split_setup import CAPPED, MET, UNSUPPORTED
from symrender.radiometric import tile
from symrender.radiometric.crossed import buried, crossed
from symrender.radiometric.shaken import doubt, shaken, shaken_rays
from symrender.radiometric.sky import sky_room
from symrender.radiometric.vectors import Array
from symrender.radiometric.world import make_world, make_worlds, seen, seen_all
from symrender.radiosity.coincident import coincident
from symrender.radiosity.endless import netted
from symrender.radiosity.fields import MOST_FIELDS, too_many_fields
from symrender.runtimes.bounce import Bounced, Bouncer
from symrender.runtimes.bounced_pixels import DIRECT_SHARE, direct_budget, node_tolerance, prepare_bounced
from symrender.runtimes.budgets import after, by_share
from symrender.runtimes.cut_bounce import CutBouncer
from symrender.runtimes.exposed import is_exposed, prepare_exposed
from symrender.runtimes.image import TileKernel
from symrender.runtimes.pixels import check_pixels, prepare_means
from symrender.runtimes.radiosity import Gatherer
from symrender.runtimes.tables import Need, table_of
from symrender.scene.arrays import PLANE
from symrender.scene.radiometric.arrays import ALL, AREA, CONDUCTOR, DIFFUSE, EXTENDED, SKY, SPHERE, RadiometricArrays
from symrender.scene.radiometric.bounce import bounce_refusal, lamp_refusal, shape_classes
from symrender.scene.radiometric.bumped import bumped, refuse_bumps
from symrender.scene.radiometric.cut import cut_reason
from symrender.scene.radiometric.due import refuse_bounces, refuse_detail, refuse_sampled
from symrender.scene.radiometric.flat import flat_refusal, is_flat, is_round
from symrender.scene.undecided import one_but_for_roundings, one_surface
from symrender.settings import BUDGET, Settings

Ints = npt.NDArray[np.int64]


def prepare(arrays: RadiometricArrays, settings: Settings) -> TileKernel:
    """Kernel that renders tiles of a scene; Unsupported where ``check`` says so.

    It fills ``emitted``, ``direct``, ``indirect``, ``radiance`` (h, w, 3), ``hit_class``, ``error`` (of radiance: what
    roundings may have done, by the scenes of ``shaken``, and with ``bounces: 1`` what the split rule states) and
    ``status`` (h, w) of the full image.
    Every pixel is a pure function of its place.
    """
    check(arrays)
    if settings.filter != "centre" or is_exposed(arrays):
        return _prepare_means(arrays, settings)
    width, height = settings.width, settings.height
    views = seen_all(shaken(arrays), width, height)
    own, integrated = threading.local(), integrated_layers(arrays)
    for need in tables_needed(arrays, settings):
        table_of(need, settings.threads)

    def render(x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        here, shape = (slice(y0, y1), slice(x0, x1)), (y1 - y0, x1 - x0)
        tile_ = (width, height, x0, y0, x1, y1)
        found = []
        for view in views:
            one = (np.zeros((*shape, 3)), np.zeros((*shape, 3)), np.zeros(shape))
            _kernel("fill_tile")(*view, *tile_, sky_room(view.world), *one)
            found.append(one)
        for name, values in zip(("emitted", "direct", "hit_class"), found[0], strict=True):
            layers[name][here] = values
        closed = [emitted + direct for emitted, direct, _ in found]
        error = doubt(closed[0], closed[1:])
        lost = ~np.isfinite(error)
        layers["direct"][here][lost], layers["error"][here] = 0.0, np.where(lost, np.inf, error)
        layers["radiance"][here] = layers["emitted"][here] + layers["direct"][here]
        layers["status"][here] = np.where(lost, UNSUPPORTED, np.where(error > settings.tol, CAPPED, MET))
        count = shape[0] * shape[1]
        if not integrated:
            return count
        if not hasattr(own, "bouncers"):
            own.bouncers = {name: _bouncer(arrays, name, settings.tol, settings.budget) for name in integrated}
        sent = []
        for view in views:
            directions = np.zeros((count, 3))
            _kernel("fill_directions")(view.window, *tile_, directions)
            sent.append((np.tile(view.eye, (count, 1)), directions))
        status, evaluations = np.zeros(shape, np.int64), np.zeros(count, np.int64)
        if arrays.bounces:
            # a tile may be rendered twice
            layers["indirect"][here] = 0.0
        for name, bouncer in own.bouncers.items():
            found_there = sent_within(bouncer, sent, settings.tol, after(settings.budget, evaluations))
            light = found_there.indirect.reshape(*shape, 3)
            layers[name][here] += light
            layers["radiance"][here] += light
            layers["error"][here] += found_there.error.reshape(shape)
            status = np.maximum(status, found_there.status.reshape(shape))
            evaluations += found_there.evaluations
        layers["status"][here] = _status(layers["error"][here], status, settings.tol)
        return count + int(evaluations.sum())

    return render


def _prepare_means(arrays: RadiometricArrays, settings: Settings) -> TileKernel:
    """The same of means over pixels, lens and shutter.

    ``hit_class`` is that of the ray from the middle of the lens through the centre as the shutter opens.
    """
    width, height = settings.width, settings.height
    view = seen(arrays, width, height)
    bounced = None
    if arrays.bounces and not is_exposed(arrays):
        tol = node_tolerance(settings.tol)
        for need in tables_needed(arrays, settings):
            table_of(need, settings.threads)
        bounced = prepare_bounced(arrays, settings, lambda: _quick_bouncer(arrays, "indirect", tol, settings.budget))
    closed = settings
    if bounced:
        closed = replace(settings, tol=DIRECT_SHARE * settings.tol, budget=direct_budget(settings))
    means = (prepare_exposed if is_exposed(arrays) else prepare_means)(arrays, closed)

    def render(x0: int, y0: int, x1: int, y1: int, layers: Mapping[str, Array]) -> int:
        here, shape = (slice(y0, y1), slice(x0, x1)), (y1 - y0, x1 - x0)
        unused, hit_class = np.zeros((*shape, 3)), np.zeros(shape)
        tile_ = (width, height, x0, y0, x1, y1)
        _kernel("fill_tile")(*view, *tile_, sky_room(view.world), unused, unused, hit_class)
        emitted, direct, error, spent = means(x0, y0, x1, y1)
        layers["emitted"][here], layers["direct"][here], layers["hit_class"][here] = emitted, direct, hit_class
        layers["radiance"][here], layers["error"][here] = emitted + direct, error
        missed = np.where(np.isfinite(error), CAPPED, UNSUPPORTED)
        layers["status"][here] = np.where(error > settings.tol, missed, MET)
        if bounced is not None:
            found = bounced(x0, y0, x1, y1)
            layers["indirect"][here] = found.values.reshape(*shape, 3)
            layers["radiance"][here] += layers["indirect"][here]
            layers["error"][here] += found.error.reshape(shape)
            layers["status"][here] = _status(layers["error"][here], found.status.reshape(shape), settings.tol)
            spent += int(found.evaluations.sum())
        return spent

    return render


def tables_needed(arrays: RadiometricArrays, settings: Settings) -> tuple[Need, ...]:
    """The tables of what faces send each other that ``prepare`` makes, unless they are had before."""
    if not arrays.bounces or not is_flat(arrays) or is_exposed(arrays) or cut_reason(arrays):
        return ()
    tol = settings.tol if settings.filter == "centre" else node_tolerance(settings.tol)
    return (Need(arrays, tol, settings.budget),)


def _bouncer(arrays: RadiometricArrays, layer: str, tol: float, budget: int) -> Bouncer | CutBouncer | Gatherer:
    """Who integrates what a layer has beside closed forms, to ``tol``."""
    if layer == "indirect" and cut_reason(arrays):
        return CutBouncer(arrays)
    return _quick_bouncer(arrays, layer, tol, budget)


def _quick_bouncer(arrays: RadiometricArrays, layer: str, tol: float, budget: int) -> Bouncer | Gatherer:
    """The same where places are not cut by windows: what means over pixels may ask."""
    if layer == "indirect" and is_flat(arrays):
        return Gatherer(arrays, tol, budget)
    if layer == "direct" and not is_round(arrays):
        return Gatherer(arrays, tol, budget, lamps=True)
    return Bouncer(arrays, layer == "direct")


def _status(error: Array, status: Array | Ints, tol: float) -> Ints:
    """Whether errors are within ``tol``, and if not what the split rule says of them."""
    return np.where(error > tol, np.maximum(status, CAPPED), MET).astype(np.int64)


@dataclass(frozen=True)
class Sent:
    """What comes back along N rays: ``emitted``, ``direct``, ``indirect`` (N, 3), then (N,) arrays."""

    emitted: Array
    direct: Array
    indirect: Array
    hit_class: Array
    error: Array
    status: Ints
    evaluations: Ints


def ray_answers(arrays: RadiometricArrays, tol: float, budget: int = BUDGET) -> Callable[[Array, Array], Sent]:
    """What answers for origins and unit directions (N, 3), each to ``tol``, absolute.

    Unsupported where ``check`` says so. Threads may ask at the same time.
    """
    check(arrays)
    worlds, integrated, own = make_worlds(shaken(arrays)), integrated_layers(arrays), threading.local()

    def answer(origins: Array, directions: Array) -> Sent:
        count, sent = len(origins), shaken_rays(arrays, origins, directions)
        found = []
        for world, pair in zip(worlds, sent, strict=True):
            one = (np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count))
            _kernel("fill_rays")(world, *pair, sky_room(world), *one)
            found.append(one)
        emitted, direct, hit_class = found[0]
        error = doubt(emitted + direct, [e + d for e, d, _ in found[1:]])
        lost = ~np.isfinite(error)
        direct[lost], error[lost] = 0.0, np.inf
        indirect, evaluations = np.zeros((count, 3)), np.ones(count, np.int64)
        status = np.where(lost, UNSUPPORTED, MET)
        if not hasattr(own, "bouncers"):
            own.bouncers = {name: _bouncer(arrays, name, tol, budget) for name in integrated}
        for name, bouncer in own.bouncers.items():
            bounced = sent_within(bouncer, sent, tol, after(budget, evaluations - 1))
            if name == "direct":
                direct = direct + bounced.indirect
            else:
                indirect = bounced.indirect
            status, evaluations = np.maximum(status, bounced.status), evaluations + bounced.evaluations
            error = error + bounced.error
        return Sent(emitted, direct, indirect, hit_class, error, _status(error, status, tol), evaluations)

    return answer


def sent_within(
    bouncer: Bouncer | CutBouncer | Gatherer, rays: list[tuple[Array, Array]], tol: float, shares: Ints
) -> Bounced:  # fmt: skip
    """``bouncer.sent`` of rays, each within its own share (N,) of evaluations."""

    def ask(some: Ints, share: int) -> Bounced:
        return bouncer.sent([(origins[some], directions[some]) for origins, directions in rays], tol, share)

    return by_share(ask, np.arange(len(shares)), shares)


def integrated_layers(arrays: RadiometricArrays) -> tuple[str, ...]:
    """The layers of which the split rule has a part: of sky and lamps over what is glossy, and of a bounce."""
    return (*(["direct"] if lamps_on_gloss(arrays) else []), *(["indirect"] if arrays.bounces else []))


def lamps_on_gloss(arrays: RadiometricArrays) -> bool:
    """Whether a sky or a shape that emits may shine on a conductor or a phong material."""
    glossy = any(arrays.materials[int(shape.material)].kind != DIFFUSE for shape in arrays.shapes)
    return glossy and any(light.kind in (SKY, AREA) for light in arrays.lights)


def check(arrays: RadiometricArrays) -> None:
    """Raise ``Unsupported`` for what takes an integral that is not had: of bounces, and of lights on what is glossy."""
    refuse_sampled(arrays)
    refuse_detail(arrays)
    if 1 < arrays.bounces < ALL:
        raise Unsupported(
            f"bounces: {arrays.bounces} is not integrated by quadrature: 0, 1 and all are; paths sample any"
        )
    asked = arrays.bounces if arrays.bounces <= 1 else "all"
    refuse_bumps(arrays)
    reason = cut_reason(arrays)
    if reason:
        _check_cut(arrays, reason)
        return
    flat = is_flat(arrays)
    refuse_bounces(asked, flat_refusal(arrays) if flat else bounce_refusal(arrays), flat)
    pair = buried(arrays) if flat and arrays.bounces else None
    if pair:
        raise Unsupported(
            f"bounces: {asked} is not yet integrated where shapes[{pair[0]}] and shapes[{pair[1]}] cross, one of both "
            "a sphere; apart or touching it is"
        )
    pair = coincident(arrays, make_world(netted(arrays))) if flat and arrays.bounces else None
    if pair:
        raise Unsupported(
            f"bounces: {asked} is not yet integrated where shapes[{pair[0]}] and shapes[{pair[1]}] lie in one plane "
            "and overlap: which of them is seen is not decided; apart it is"
        )
    shape = too_many_fields(make_world(arrays)) if flat and arrays.bounces else -1
    if shape >= 0:
        raise Unsupported(
            f"bounces: {asked} is not yet integrated where textures of flat shapes have more than {MOST_FIELDS} "
            f"fields, with those of shapes[{shape}]; larger fields are"
        )
    used = {int(shape.material) for shape in arrays.shapes}
    glossy = any(arrays.materials[m].kind != DIFFUSE for m in used)
    reason = lamp_refusal(arrays) if glossy else ""
    for light in arrays.lights if reason else ():
        if light.kind in EXTENDED:
            raise Unsupported(
                f"lights: {EXTENDED[int(light.kind)]} over a conductor or a phong material is not yet integrated in a "
                f"scene with {reason}, which takes its lobe; over diffuse ones it is, and the numeric pipeline samples "
                "any"
            )
    if is_round(arrays) and integrated_layers(arrays):
        _check_decided(arrays)
    for index, light in enumerate(arrays.lights):
        other = crossed(arrays, int(light.emitter)) if light.kind == AREA else -1
        if other >= 0:
            emitter = arrays.shapes[int(light.emitter)]
            its = "sphere" if emitter.kind == SPHERE else "shape"
            raise Unsupported(
                f"lights[{index}]: its {its}, shapes[{int(light.emitter)}], crosses shapes[{other}], and what is seen "
                "of it then is not yet integrated; apart it is, and the numeric pipeline samples any"
            )


def _check_cut(arrays: RadiometricArrays, reason: str) -> None:
    """Raise ``Unsupported`` where what places see has walls that are not known, or shapes that rounding decides."""
    check_pixels(arrays, f"bounces: 1 in a scene with {reason},")
    for j in bumped(arrays):
        material = arrays.materials[int(arrays.shapes[j].material)]
        if material.kind == CONDUCTOR and material.geometric and material.correlated:
            raise Unsupported(
                f"bounces: 1 is not yet integrated over a bump on a conductor, that of shapes[{j}], with normals: "
                "geometric and masking: correlated, which bound nothing at grazing angles together; either other is"
            )
    _check_decided(arrays)
    pair = coincident(arrays, make_world(arrays)) if is_flat(arrays) else None
    if pair:
        raise Unsupported(
            f"bounces: 1 is not yet integrated where shapes[{pair[0]}] and shapes[{pair[1]}] lie in one plane and "
            "overlap: which of them is seen is not decided; apart it is"
        )


def _check_decided(arrays: RadiometricArrays) -> None:
    """Raise ``Unsupported`` where rounding decides which of two shapes a direction of a lobe meets."""
    _, kept = shape_classes(arrays)
    spheres = [j for j in kept if arrays.shapes[j].kind == SPHERE]
    planes = [j for j in kept if arrays.shapes[j].kind == PLANE]
    pair = one_surface(
        np.array([arrays.shapes[j].place for j in spheres]).reshape(-1, 3),
        np.array([arrays.shapes[j].radius for j in spheres]),
        np.array([arrays.frames[j].origin for j in planes]).reshape(-1, 3),
        np.array([arrays.frames[j].up for j in planes]).reshape(-1, 3), np.array(arrays.camera.eye),
    )  # fmt: skip
    if pair:
        one, other = ((*spheres, *planes)[j] for j in pair)
        raise Unsupported(one_but_for_roundings(f"shapes[{one}]", f"shapes[{other}]"))


@lru_cache(maxsize=3)
def _kernel(name: str) -> Any:
    """Compiled function of ``radiometric/tile.py``."""
    # the kernels only borrow arrays; counting references to them would cost more than the arithmetic
    return compiled(getattr(tile, name), _nrt=False)
