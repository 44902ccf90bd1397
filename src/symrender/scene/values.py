"""The number types of a scene: finite, bounded, never coerced from text or booleans.

Each alias states unit and range once; the schema, the ``params`` table and the error messages all read it here.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field
from pydantic_core import PydanticCustomError

from symrender.limits import (
    MAX_COORDINATE,
    MAX_EXPONENT,
    MAX_PART_NAME,
    MAX_RADIANCE,
    MAX_SHININESS,
    MAX_TEXTURE_FREQUENCY,
    MIN_LENGTH,
)


class Part(BaseModel):
    """Base of everything in a scene: immutable, strict, no unknown keys."""

    model_config = ConfigDict(frozen=True, strict=True, extra="forbid", allow_inf_nan=False)


def listed(value: Any) -> Any:
    """A tuple for a list, anything else as it is."""
    return tuple(value) if isinstance(value, list) else value


def at_most(limit: int) -> Callable[[Any], Any]:
    """Validator of a list that looks at its length before its items, so that a long one has one problem, not many."""

    def check(value: Any) -> Any:
        if isinstance(value, list | tuple) and len(value) > limit:
            raise PydanticCustomError("scene", f"must hold at most {limit} entries, got {len(value)}")
        return listed(value)

    return check


class Held(dict[str, Any]):
    """A mapping of a scene: it can be read, compared and hashed, and not changed."""

    def _refuse(self, *_: Any, **__: Any) -> Any:
        raise TypeError("a scene is not changed in place, replace() makes another")

    __setitem__ = __delitem__ = __ior__ = clear = pop = popitem = setdefault = update = _refuse

    def __hash__(self) -> int:  # type: ignore[override]
        return hash(frozenset(self.items()))

    def __reduce__(self) -> tuple[type[Held], tuple[dict[str, Any]]]:
        return Held, (dict(self),)


Coordinate = Annotated[float, Field(ge=-MAX_COORDINATE, le=MAX_COORDINATE, json_schema_extra={"unit": "length"})]
Length = Annotated[float, Field(ge=MIN_LENGTH, le=MAX_COORDINATE, json_schema_extra={"unit": "length"})]
Extent = Annotated[float, Field(ge=0, le=MAX_COORDINATE, json_schema_extra={"unit": "length"})]
Share = Annotated[float, Field(ge=0, le=1, json_schema_extra={"unit": "1"})]
Radiance = Annotated[float, Field(ge=0, le=MAX_RADIANCE, json_schema_extra={"unit": "radiance"})]
Exponent = Annotated[float, Field(ge=0, le=MAX_EXPONENT, json_schema_extra={"unit": "1"})]
Shininess = Annotated[float, Field(ge=0, le=MAX_SHININESS, json_schema_extra={"unit": "1"})]
HalfAngle = Annotated[float, Field(ge=0, le=math.pi / 2, json_schema_extra={"unit": "rad"})]
Frequency = Annotated[float, Field(ge=0, le=MAX_TEXTURE_FREQUENCY, json_schema_extra={"unit": "half-periods"})]
FieldOfView = Annotated[float, Field(gt=0, lt=180, json_schema_extra={"unit": "degree"})]
PartName = Annotated[str, Field(pattern=rf"^[A-Za-z][A-Za-z0-9_-]{{0,{MAX_PART_NAME - 1}}}$")]

Point3 = Annotated[tuple[Coordinate, Coordinate, Coordinate], BeforeValidator(listed)]
Point2 = Annotated[tuple[Coordinate, Coordinate], BeforeValidator(listed)]
Albedo = Annotated[tuple[Share, Share, Share], BeforeValidator(listed)]
Colour = Annotated[tuple[Radiance, Radiance, Radiance], BeforeValidator(listed)]
