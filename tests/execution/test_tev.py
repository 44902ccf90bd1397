"""tev as a place to look: a server of the test's own reads the packets as tev does and holds the image they make."""

from __future__ import annotations

import socket
import struct
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symrender as sr
from slow_kind import slow_job
from symrender.errors import OptionError, OutputError
from symrender.execution.fill import Crew, Means
from symrender.execution.preview import Preview
from symrender.execution.tev import TevPreview, watched


class Viewer:
    """What tev would hold: images by name, and how many packets made them."""

    def __init__(self) -> None:
        self.images: dict[str, np.ndarray] = {}
        self.packets: list[int] = []
        self._data = b""

    def feed(self, data: bytes) -> None:
        self._data += data
        while len(self._data) >= 4 and len(self._data) >= (size := struct.unpack_from("<I", self._data)[0]):
            self._one(self._data[4:size])
            self._data = self._data[size:]

    def _one(self, packet: bytes) -> None:
        at = 0

        def take(code: str) -> Any:
            nonlocal at
            values = struct.unpack_from("<" + code, packet, at)
            at += struct.calcsize("<" + code)
            return values if len(values) > 1 else values[0]

        def text() -> str:
            nonlocal at
            end = packet.index(b"\0", at)
            found, at = packet[at:end].decode(), end + 1
            return found

        operation, _, name = take("B"), take("?"), text()
        self.packets.append(operation)
        if operation == 4:
            width, height, count = take("3i")
            assert [text() for _ in range(count)] == ["R", "G", "B"]
            self.images[name] = np.full((height, width, 3), np.nan, np.float32)
        else:
            assert operation == 6
            channels = [text() for _ in range(take("i"))]
            x, y, width, height = take("4i")
            offsets, strides = take("3q"), take("3q")
            floats = np.frombuffer(packet, "<f4", offset=at)
            at = len(packet)
            for k, (_, offset, stride) in enumerate(zip(channels, offsets, strides, strict=True)):
                values = floats[offset::stride][: width * height].reshape(height, width)
                self.images[name][y : y + height, x : x + width, k] = values
        assert at == len(packet), "the packet ends where its fields do"


@contextmanager
def viewer() -> Iterator[tuple[str, Viewer]]:
    """A viewer and its address; at the end all that was sent has been read."""
    seen = Viewer()
    with socket.create_server(("127.0.0.1", 0)) as server:

        def listen() -> None:
            client, _ = server.accept()
            with client:
                while data := client.recv(1 << 16):
                    seen.feed(data)

        thread = threading.Thread(target=listen, daemon=True)
        thread.start()
        yield f"tev://127.0.0.1:{server.getsockname()[1]}", seen
        thread.join(20)
        assert not thread.is_alive()


def test_tev_holds_the_image_that_was_made() -> None:
    with viewer() as (address, seen):
        preview = TevPreview(address)
        with Crew(Means(2, 4), (job := slow_job(24, 18, 20),), preview=preview) as crew:
            layers, _ = crew.fill(job)
        del preview, crew
    assert (seen.images["symrender slow"] == layers["radiance"].astype(np.float32)).all()
    assert seen.packets.count(4) == 1 and seen.packets.count(6) == 30, "every tile is sent, and sent once"
    assert np.ptp(layers["radiance"]) > 0


def test_render_sends_linear_light_of_both_sides() -> None:
    with viewer() as (address, seen):
        pair = sr.render("gloss", size=(24, 16), lobe=1, tile=8, preview=address)
    for name, image in (("numeric", pair.numeric), ("symbolic", pair.symbolic)):
        assert image is not None
        assert (seen.images[f"symrender {name}"] == image.radiance.astype(np.float32)).all()


def test_a_tev_that_goes_away_costs_the_preview_alone() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        preview = TevPreview(f"tev://127.0.0.1:{server.getsockname()[1]}")
        server.accept()[0].close()
    with Crew(Means(1, 2), (job := slow_job(24, 18, 4),), preview=preview) as crew:
        layers, _ = crew.fill(job)
    assert np.isfinite(layers["radiance"]).all()


def test_where_a_preview_goes(tmp_path: Path) -> None:
    assert isinstance(watched(tmp_path / "a.png"), Preview)
    with socket.create_server(("127.0.0.1", 0)) as server:
        free = server.getsockname()[1]
    with pytest.raises(OutputError, match=rf"no tev answers at 127.0.0.1:{free} \(.*refused\); start it"):
        watched(f"tev://127.0.0.1:{free}")
    for wrong in ("tev://", "tev://localhost:99999", "tev://a b"):
        with pytest.raises(OptionError, match="must be tev or tev://HOST:PORT"):
            watched(wrong)
