"""Serve one page to this machine alone."""

from __future__ import annotations

from collections.abc import Callable
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

from symrender.errors import OptionError
from symrender.simulator.build import Simulator

_HERE = "127.0.0.1"


def server(page: Simulator, port: int = 0) -> ThreadingHTTPServer:
    """A server bound to the loopback interface that knows one address, ``/``; the caller runs and closes it."""
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

        def log_message(self, format: str, *args: object) -> None:
            """Say nothing."""

    try:
        return ThreadingHTTPServer((_HERE, port), Handler)
    except OSError as error:
        raise OptionError(f"port: {port} cannot be served on: {error.strerror or error}") from None


def serve(page: Simulator, *, port: int = 0, told: Callable[[str], object] | None = print) -> None:
    """Serve ``page`` on the loopback interface until interrupted; ``told`` is given the address."""
    with server(page, port) as running:
        if told is not None:
            told(f"http://{_HERE}:{running.server_port}/ (Ctrl-C stops)")
        running.serve_forever()
