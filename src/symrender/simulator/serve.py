"""Serve one page to this machine alone."""

from __future__ import annotations

import json
from collections.abc import Callable
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import numpy as np

from symrender.errors import OptionError, SymrenderError
from symrender.scene.arrays import scene_arrays
from symrender.scene.scene import Scene
from symrender.simulator.build import Simulator
from symrender.simulator.state import from_url

_HERE = "127.0.0.1"
_MOST_BYTES = 20_000
_DISK_STRATA = 2
_WIDTH, _MOST_BOXES = 1e-4, 40_000


def certified(scene: Scene, asked: Any) -> dict[str, Any]:
    """Proved bounds of gloss at a floor point, as a page asks for them: {fragment, point}.

    A page replaces a disk light by 2 x 2 points, and so does what is enclosed. OptionError says what is wrong.
    """
    from symrender.certify.enclosure import certify

    try:
        state, point = from_url(str(asked["fragment"])), np.array([float(v) for v in asked["point"]])
    except (KeyError, TypeError, ValueError):
        raise OptionError("certify: must be asked with a state and a point") from None
    if point.shape != (3,) or not np.isfinite(point).all() or point[2] != 0.0:
        raise OptionError("certify: needs a point of the floor")
    arrays = scene_arrays(state.apply(scene))
    found = certify(arrays, point, _DISK_STRATA, _WIDTH, _MOST_BOXES)
    return {"low": found.low.tolist(), "high": found.high.tolist(), "boxes": found.boxes}


def server(page: Simulator, port: int = 0, *, scene: Scene | None = None) -> ThreadingHTTPServer:
    """A server bound to the loopback interface that knows one address, ``/``; the caller runs and closes it.

    With ``scene`` it also answers ``POST /certify``, to its own page only: other pages cannot send it JSON.
    """
    body = page.html.encode()

    class Handler(BaseHTTPRequestHandler):
        """Answers with the page."""

        def do_GET(self) -> None:
            """The page at ``/``, nothing anywhere else."""
            found = self.path.partition("?")[0] == "/"
            self.send_response(200 if found else 404)
            self.send_header("Content-Type", "text/html; charset=utf-8" if found else "text/plain")
            self.send_header("Content-Length", str(len(body) if found else 0))
            self.send_header("X-Content-Type-Options", "nosniff")
            self.send_header("Referrer-Policy", "no-referrer")
            self.end_headers()
            if found:
                self.wfile.write(body)

        def do_POST(self) -> None:
            """Proved bounds at ``/certify``."""
            host, port = self.headers.get("Host"), self.connection.getsockname()[1]
            length = int(self.headers.get("Content-Length") or 0)
            kind = self.headers.get("Content-Type") == "application/json"
            status, answer = 404, {"error": "not found"}
            if scene is not None and self.path == "/certify" and kind and host == f"{_HERE}:{port}":
                status, answer = 400, {"error": "certify: the question is too long"}
                if 0 < length <= _MOST_BYTES:
                    try:
                        status, answer = 200, certified(scene, json.loads(self.rfile.read(length)))
                    except (SymrenderError, ValueError) as error:
                        answer = {"error": str(error)}
            text = json.dumps(answer).encode()
            self.send_response(status)
            self.send_header("Content-Type", "application/json")
            self.send_header("Content-Length", str(len(text)))
            self.end_headers()
            self.wfile.write(text)

        def log_message(self, format: str, *args: object) -> None:
            """Say nothing."""

    try:
        return ThreadingHTTPServer((_HERE, port), Handler)
    except OSError as error:
        raise OptionError(f"port: {port} cannot be served on: {error.strerror or error}") from None


def serve(
    page: Simulator,
    *,
    port: int = 0,
    scene: Scene | None = None,
    told: Callable[[str], object] | None = print,
    opened: Callable[[str], object] | None = None,
) -> None:
    """Serve ``page`` on the loopback interface until interrupted; ``told`` and ``opened`` are given the address."""
    with server(page, port, scene=scene) as running:
        if opened is not None:
            opened(f"http://{_HERE}:{running.server_port}/")
        if told is not None:
            told(f"http://{_HERE}:{running.server_port}/ (Ctrl-C stops)")
        running.serve_forever()
