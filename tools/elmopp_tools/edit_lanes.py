# SPDX-License-Identifier: Apache-2.0
# Copyright 2026 The ELMOPP authors

"""Hands the lane editor to a browser of this machine, with a picture and a lane file if they are named.

It only reads. It listens on 127.0.0.1 and answers only to that name and to localhost, so that no page of the network
can see the picture by a name that it points here.
"""

from __future__ import annotations

import argparse
import signal
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import NoReturn
from urllib.parse import quote

from PIL import Image, UnidentifiedImageError

from elmopp_tools.draw_lanes import EXIT_DONE, EXIT_REFUSED, RequestError, read_lanes
from elmopp_tools.outputs import why

PAGE = Path(__file__).with_name("lane_editor.html")
PORT = 8138
PORT_MAX = 65535

DESCRIPTION = """\
Draws the lanes of one camera in a browser of this machine: counting lines, zones, masks, the junction. The page checks
what is drawn and saves the lane file; nothing leaves this machine."""

EPILOG = """\
Exit codes: 0 done (ctrl-C); 2 the request cannot be run.

Example:
  tools/edit-lanes --frame picture.png --lanes camera.lanes.json
The page works without this program, too: open tools/elmopp_tools/lane_editor.html in a browser."""


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        self.exit(EXIT_REFUSED, f"edit-lanes: {message} (edit-lanes --help)\n")


@dataclass(frozen=True)
class Document:
    """What is answered at one address."""

    kind: str
    name: str
    body: bytes


class _Server(ThreadingHTTPServer):
    daemon_threads = True

    def __init__(self, port: int, documents: Mapping[str, Document]) -> None:
        super().__init__(("127.0.0.1", port), _Handler)
        self.documents = documents

    @property
    def names(self) -> tuple[str, str]:
        return f"127.0.0.1:{self.server_port}", f"localhost:{self.server_port}"


class _Handler(BaseHTTPRequestHandler):
    server: _Server
    timeout = 10

    def do_GET(self) -> None:
        document = self.server.documents.get(self.path)
        if self.headers.get("Host") not in self.server.names:
            self.send_error(HTTPStatus.FORBIDDEN, f"Host is not this machine; right would be {self.server.names[0]}")
        elif document is None:
            self.send_error(HTTPStatus.NOT_FOUND)
        else:
            self.send_response(HTTPStatus.OK)
            self.send_header("Content-Type", document.kind)
            self.send_header("Content-Length", str(len(document.body)))
            self.send_header("X-Name", quote(document.name))
            self.send_header("X-Content-Type-Options", "nosniff")
            self.send_header("Cache-Control", "no-store")
            self.end_headers()
            self.wfile.write(document.body)

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002  the name of the base class
        """Says nothing: stderr is for refusals."""


def _picture(file: Path) -> Document:
    try:
        with Image.open(file) as picture:
            kind = Image.MIME.get(picture.format or "", "")
            picture.verify()
        return Document(kind, file.name, file.read_bytes())
    except (OSError, UnidentifiedImageError, SyntaxError) as error:
        raise RequestError(f"--frame {file}: is no picture that can be read: {why(error)}") from None


def documents_of(request: argparse.Namespace) -> dict[str, Document]:
    documents = {"/": Document("text/html; charset=utf-8", PAGE.name, PAGE.read_bytes())}
    if request.frame:
        documents["/frame"] = _picture(Path(request.frame))
    if request.lanes:
        read_lanes(Path(request.lanes))
        documents["/lanes"] = Document("application/json", Path(request.lanes).name, Path(request.lanes).read_bytes())
    return documents


def port_of(text: str) -> int:
    if not text.isascii() or not text.isdigit() or int(text) > PORT_MAX:
        raise RequestError(f'--port "{text}": right would be a whole number from 0 to {PORT_MAX}')
    return int(text)


def run(request: argparse.Namespace) -> None:
    port = port_of(request.port)
    documents = documents_of(request)
    try:
        server = _Server(port, documents)
    except OSError as error:
        raise RequestError(
            f"--port {port}: cannot be had, {error.strerror}; right would be another, or 0 for any"
        ) from None
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    with server:
        try:
            print(f"edit-lanes: http://{server.names[0]}/; ctrl-C ends it", flush=True)
            server.serve_forever()
        except KeyboardInterrupt:
            return


def main(arguments: Sequence[str] | None = None) -> int:
    parser = _Parser(
        prog="edit-lanes",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--frame", metavar="IMAGE", help="a picture of the camera")
    parser.add_argument("--lanes", metavar="FILE", help="lane file elmopp-lanes/1 to begin with")
    parser.add_argument("--port", metavar="N", default=str(PORT), help=f"port on 127.0.0.1; 0: any (default: {PORT})")
    try:
        run(parser.parse_args(arguments))
    except RequestError as error:
        print(f"edit-lanes: {error}", file=sys.stderr)
        return EXIT_REFUSED
    return EXIT_DONE
