"""A PNG sequence as mp4 or webm, through imageio-ffmpeg (extra ``video``)."""

from __future__ import annotations

import secrets
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np

from symrender.errors import OptionError, OutputError, Unsupported, remedy
from symrender.images.output import check_target, write_bytes

Container = Literal["mp4", "webm", "none"]
_CODECS: Final = {"mp4": "libx264", "webm": "libvpx-vp9"}
MAX_RATE: Final = 240.0
"""Most frames a second."""


def check_video(container: Container, rate: float) -> None:
    """Refuse, before any frame is rendered, what ``write_video`` could not do."""
    if not 0 < rate <= MAX_RATE:
        raise OptionError(f"rate: must be a number in (0, {MAX_RATE:g}], frames a second, got {rate!r}")
    if container != "none":
        _encoder()


def write_video(frames: Sequence[Path], path: Path, *, rate: float, force: bool = True) -> None:
    """Encode PNG ``frames`` (one size, sRGB) at ``rate`` frames a second; the ending of ``path`` says how.

    ``.mp4`` is H.264, ``.webm`` VP9, both 4:2:0 and lossy: pictures to look at, not to measure. A side of odd length
    gains one row or column. Raises OutputError when the encoder fails; ``path`` holds the old bytes or the new.
    """
    from PIL import Image as Pillow

    check_target(path, force=force)
    container = path.suffix.removeprefix(".")
    encoder = _encoder()
    temporary = path.with_name(f".{path.stem[:40]}.{secrets.token_hex(8)}.tmp{path.suffix}")
    with Pillow.open(frames[0]) as first:
        size = first.size
    writer = encoder.write_frames(
        str(temporary),
        size,
        fps=rate,
        codec=_CODECS[container],
        quality=8,
        macro_block_size=1,
        pix_fmt_out="yuv420p",
        ffmpeg_log_level="error",
        output_params=["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-fflags", "+bitexact", "-flags:v", "+bitexact"],
    )
    try:
        writer.send(None)
        for frame in frames:
            with Pillow.open(frame) as picture:
                writer.send(np.ascontiguousarray(picture.convert("RGB")))
        writer.close()
        data = temporary.read_bytes()
    except OSError as error:
        reason = " ".join(str(error).split())[:160]
        raise OutputError(f"{path}: the video encoder failed: {reason}") from None
    finally:
        writer.close()
        temporary.unlink(missing_ok=True)
    write_bytes(path, data, force=force)


def _encoder() -> Any:
    try:
        import imageio_ffmpeg

        imageio_ffmpeg.get_ffmpeg_exe()
    except (ImportError, RuntimeError):
        raise Unsupported(
            f"video: needs imageio-ffmpeg; install it with: {remedy('video')}, or ask for --video none"
        ) from None
    return imageio_ffmpeg
