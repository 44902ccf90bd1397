"""The number types of radiometric scenes; a number alone stands for three equal channels."""

from __future__ import annotations

from typing import Annotated, Any, Final

from pydantic import AfterValidator, BeforeValidator, Field
from pydantic_core import PydanticCustomError

from symrender.limits import MAX_COORDINATE, MAX_EXPONENT, MAX_INDEX, MAX_RADIANCE, MAX_TIME, MIN_ALPHA, MIN_INDEX
from symrender.scene.values import Length, listed

CHANNELS: Final = 3


def triple(value: Any) -> Any:
    """Three equal channels for a number, a tuple for a list, anything else as it is."""
    if type(value) in (int, float):
        return (value,) * CHANNELS
    return tuple(value) if isinstance(value, list) else value


def _smooth_or_rough(value: float) -> float:
    """Refuse a roughness of which facets have no double-precision density."""
    if 0.0 < value < MIN_ALPHA:
        raise PydanticCustomError(
            "scene",
            "must be 0, which is smooth, or at least {least}, got {value}",
            {"least": MIN_ALPHA, "value": value},
        )
    return value


Alpha = Annotated[float, Field(ge=0, le=1, json_schema_extra={"unit": "1"}), AfterValidator(_smooth_or_rough)]
Index = Annotated[float, Field(ge=MIN_INDEX, le=MAX_INDEX, json_schema_extra={"unit": "1"})]
Extinction = Annotated[float, Field(ge=0, le=MAX_INDEX, json_schema_extra={"unit": "1"})]
Power = Annotated[float, Field(ge=0, le=MAX_EXPONENT, json_schema_extra={"unit": "1"})]
_Share = Annotated[float, Field(ge=0, le=1, json_schema_extra={"unit": "1"})]
_Intensity = Annotated[float, Field(ge=0, le=MAX_RADIANCE, json_schema_extra={"unit": "W/sr"})]
_Irradiance = Annotated[float, Field(ge=0, le=MAX_RADIANCE, json_schema_extra={"unit": "W/m2"})]
_Radiance = Annotated[float, Field(ge=0, le=MAX_RADIANCE, json_schema_extra={"unit": "W/m2/sr"})]

_Speed = Annotated[float, Field(ge=-MAX_COORDINATE, le=MAX_COORDINATE, json_schema_extra={"unit": "length"})]
_Time = Annotated[float, Field(ge=-MAX_TIME, le=MAX_TIME, json_schema_extra={"unit": "s"})]

Velocity = Annotated[tuple[_Speed, _Speed, _Speed], BeforeValidator(listed)]
Times = Annotated[tuple[_Time, _Time], BeforeValidator(listed)]
Angle = Annotated[float, Field(ge=0, le=180, json_schema_extra={"unit": "degree"})]
Rotation = Annotated[float, Field(ge=-360, le=360, json_schema_extra={"unit": "degree"})]
Size3 = Annotated[tuple[Length, Length, Length], BeforeValidator(listed)]
_Place = Annotated[int, Field(ge=0)]
Corners = Annotated[tuple[_Place, _Place, _Place], BeforeValidator(listed)]
Shares = Annotated[tuple[_Share, _Share, _Share], BeforeValidator(triple)]
_MetalIndex = Annotated[float, Field(ge=0, le=MAX_INDEX, json_schema_extra={"unit": "1"})]
MetalIndices = Annotated[tuple[_MetalIndex, _MetalIndex, _MetalIndex], BeforeValidator(triple)]
Extinctions = Annotated[tuple[Extinction, Extinction, Extinction], BeforeValidator(triple)]
Intensities = Annotated[tuple[_Intensity, _Intensity, _Intensity], BeforeValidator(triple)]
Irradiances = Annotated[tuple[_Irradiance, _Irradiance, _Irradiance], BeforeValidator(triple)]
Radiances = Annotated[tuple[_Radiance, _Radiance, _Radiance], BeforeValidator(triple)]
