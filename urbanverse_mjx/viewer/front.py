"""Server of the public page, which embeds viser's page, and of sockets for key and gamepad input and a headset's image.

viser's client does not report held keys, key releases or gamepads. This page embeds viser's as a frame of the same
origin, so that it also receives the frame's key events; viser's server runs behind it on a local port.

In:   requests and sockets of browsers.
Out:  `Inputs` for a `Teleop`.
When: while a page is open; all in a thread of its own.
"""

import asyncio
import contextlib
import http
import itertools
import json
import logging
import pathlib
import threading
import time
import urllib.error
import urllib.parse
import urllib.request
from collections.abc import Callable, Iterator, Mapping
from typing import Any, Protocol

import cv2
import numpy as np
import viser
from websockets.asyncio.client import connect
from websockets.asyncio.server import Server, ServerConnection, serve
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed, InvalidHandshake
from websockets.http11 import Request, Response
from websockets.typing import Subprotocol

from ..datatypes import ValidationError
from .ports import free_port
from .recording import private_server
from .teleop import Inputs, Teleop

#: Paths of viser's page, of the socket for keys, of that for the robot's camera, and of the library's page.
FRAME, DRIVE, CAMERA, LIBRARY = "/viser", "/drive", "/camera", "/library"
#: Takes the path below `LIBRARY` and the query; returns type and content, or raises a ValidationError.
Library = Callable[[str, Mapping[str, str]], tuple[str, bytes]]
#: State of the page, see `teleop.html`, until a street is shown on it.
LOADING = {
    "mode": "policy",
    "who": "loading",
    "note": "a first start compiles streets for minutes; the terminal shows its progress",
    "interventions": 0,
    "seconds": 0.0,
    "latency": None,
    "last": False,
}
_PAGE = pathlib.Path(__file__).with_name("teleop.html")
_SCRIPT = pathlib.Path(__file__).with_name("headset.js")
_MAX_BODY = 50 * 2**20  # bytes of a message; viser's own limit
#: s between two states sent to a browser, between two looks for a new image, and between two measurements of its delay.
_TELL_EVERY, _LOOK_EVERY, _PING_EVERY = 0.1, 0.02, 2.0
_JPEG_QUALITY = 90
_FORWARDED = ("Content-Type", "Content-Encoding")


class Shown(Protocol):
    """What the page shows, see `DrivePage`."""

    state: dict[str, Any]
    image: np.ndarray | None
    watched: Callable[[], bool]


class Front:
    """Serves the page on a port until `stop` is called.

    Args:
      host, port: 0 takes a free one.
      behind: viser's port on this machine.
      teleop: receives the inputs.
      state: function that returns the shown state as a JSON object; called often, from a thread; default: `LOADING`.

    Attributes:
      library: answers the requests below `LIBRARY`, from several threads; None: there is no such page.
      camera: returns the image (H, W, 3) u8 RGB of the robot's camera, the same array until there is another, or None;
        called often, from a thread, while `watched`.

    Raises:
      ValidationError: the port is in use.
    """

    def __init__(
        self, host: str, port: int, behind: int, teleop: Teleop, state: Callable[[], dict[str, Any]] = lambda: LOADING
    ) -> None:
        self.port = free_port(host, port)
        self.state = state
        self.library: Library | None = None
        self.camera: Callable[[], np.ndarray | None] = lambda: None
        self._host, self._behind, self._teleop = host, behind, teleop
        self._page, self._script = _PAGE.read_bytes(), _SCRIPT.read_bytes()
        self._watching = 0
        self._numbers = itertools.count()
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)
        self._thread.start()
        try:
            self._server: Server = asyncio.run_coroutine_threadsafe(self._open(), self._loop).result()
        except OSError as error:  # taken since it was found free
            self._end()
            raise ValidationError(f"--port: found {self.port} on {host} taken, needed a free one.") from error

    @property
    def address(self) -> str:
        """Returns the address of the page for a local browser."""
        return f"http://{'127.0.0.1' if self._host == '0.0.0.0' else self._host}:{self.port}"

    def show(self, page: "Shown") -> None:
        """Takes state and camera image from a page, and tells it whether a headset shows them."""
        self.state, self.camera = lambda: page.state, lambda: page.image
        page.watched = lambda: self.watched

    @property
    def watched(self) -> bool:
        """Whether a headset shows the robot's camera."""
        return self._watching > 0

    def stop(self) -> None:
        """Closes all connections and the port."""

        async def close() -> None:
            self._server.close()
            await self._server.wait_closed()

        with contextlib.suppress(TimeoutError):
            asyncio.run_coroutine_threadsafe(close(), self._loop).result(5.0)
        self._end()

    def _end(self) -> None:
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(5.0)
        if not self._thread.is_alive():
            self._loop.close()

    async def _open(self) -> Server:
        return await serve(
            self._socket,
            self._host,
            self.port,
            process_request=self._respond,
            select_subprotocol=_viser_protocol,
            compression=None,
            max_size=_MAX_BODY,
            ping_interval=_PING_EVERY,
            close_timeout=1.0,
            open_timeout=None,  # of a request, too, and drawing a image may take longer than its 10 s
            logger=_log(),
        )

    async def _respond(self, _: ServerConnection, request: Request) -> Response | None:
        """Returns the page or one of viser's files, or None for sockets."""
        if request.headers.get("Upgrade", "").lower() == "websocket":
            return None
        path = request.path.partition("?")[0]
        if path == "/":
            return _response(http.HTTPStatus.OK, self._page, {"Content-Type": "text/html; charset=utf-8"})
        if path == f"/{_SCRIPT.name}":
            return _response(http.HTTPStatus.OK, self._script, {"Content-Type": "text/javascript; charset=utf-8"})
        if path == FRAME or path.startswith(f"{FRAME}/"):
            return await asyncio.to_thread(self._of_viser, path.removeprefix(FRAME) or "/", request)
        if self.library is not None and (path == LIBRARY or path.startswith(f"{LIBRARY}/")):
            return await asyncio.to_thread(self._of_library, self.library, request.path)
        return _response(http.HTTPStatus.NOT_FOUND, b"not found", {"Content-Type": "text/plain"})

    @staticmethod
    def _of_library(library: Library, address: str) -> Response:
        path, _, query = address.partition("?")
        values = dict(urllib.parse.parse_qsl(query, keep_blank_values=False))
        try:
            kind, body = library(path.removeprefix(LIBRARY).strip("/"), values)
        except ValidationError as error:
            said = json.dumps({"error": str(error)}, ensure_ascii=False).encode()
            return _response(http.HTTPStatus.BAD_REQUEST, said, {"Content-Type": "application/json"})
        return _response(http.HTTPStatus.OK, body, {"Content-Type": kind})

    def _of_viser(self, path: str, request: Request) -> Response:
        accepted = {"Accept-Encoding": request.headers.get("Accept-Encoding", "identity")}
        asked = urllib.request.Request(f"http://127.0.0.1:{self._behind}{path}", headers=accepted)
        # Proxy settings of the environment must not apply to local ports.
        opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
        try:
            with opener.open(asked, timeout=10.0) as answer:
                kept = {name: answer.headers[name] for name in _FORWARDED if name in answer.headers}
                return _response(http.HTTPStatus.OK, answer.read(), kept)
        except urllib.error.HTTPError as error:
            return _response(http.HTTPStatus(error.code), b"not found", {"Content-Type": "text/plain"})
        except OSError:
            return _response(http.HTTPStatus.BAD_GATEWAY, b"the viewer has ended", {"Content-Type": "text/plain"})

    async def _socket(self, browser: ServerConnection) -> None:
        path = browser.request.path.partition("?")[0] if browser.request is not None else ""
        with contextlib.suppress(ConnectionClosed):
            if path == DRIVE:
                await self._drive(browser)
            elif path == CAMERA:
                await self._show(browser)
            elif path.rstrip("/") == FRAME:
                await self._relay(browser)
            else:
                await browser.close(1008, f"found no {path[:60]}")

    async def _drive(self, browser: ServerConnection) -> None:
        """Receives a browser's inputs until it disconnects, and sends it the state."""
        number = next(self._numbers)
        telling = asyncio.create_task(self._send_state(browser))
        try:
            async for message in browser:
                # Half of the round trip that the pings measure.
                self._teleop.receive(number, Inputs.parse(message), time.monotonic(), 0.5 * browser.latency)
        except ValidationError as error:
            await browser.close(1003, str(error)[:120])
        finally:
            telling.cancel()
            self._teleop.leave(number)

    async def _send_state(self, browser: ServerConnection) -> None:
        sent = None
        with contextlib.suppress(ConnectionClosed):
            while True:
                # A page may have been opened before there is a library.
                state = json.dumps({**self.state(), "library": self.library is not None})
                if state != sent:
                    await browser.send(state)
                    sent = state
                await asyncio.sleep(_TELL_EVERY)

    async def _show(self, browser: ServerConnection) -> None:
        """Sends a headset each new image as a JPEG until it disconnects."""
        self._watching += 1
        gone, sent = asyncio.create_task(browser.wait_closed()), None
        try:
            while not gone.done():
                image = self.camera()
                if image is not None and image is not sent:
                    await browser.send(await asyncio.to_thread(_jpeg, image))
                    sent = image
                await asyncio.wait([gone], timeout=_LOOK_EVERY)
        finally:
            gone.cancel()
            self._watching -= 1

    async def _relay(self, browser: ServerConnection) -> None:
        """Relays messages between a browser and viser in both directions until one of them disconnects."""
        protocols = None if browser.subprotocol is None else [browser.subprotocol]
        try:
            inner = await connect(
                f"ws://127.0.0.1:{self._behind}",
                subprotocols=protocols,
                max_size=_MAX_BODY,
                compression=None,
                ping_interval=None,
                proxy=None,
                close_timeout=1.0,
            )
        except (OSError, InvalidHandshake):
            await browser.close(1001, "the viewer has ended")
            return
        async with inner:
            directions = [asyncio.create_task(_pass_on(*pair)) for pair in ((browser, inner), (inner, browser))]
            await asyncio.wait(directions, return_when=asyncio.FIRST_COMPLETED)
            for direction in directions:
                direction.cancel()
        if inner.close_code is not None and inner.close_code >= 1002:
            # Such as viser's answer to a client of another version.
            code = inner.close_code if inner.close_code not in (1005, 1006, 1015) else 1001
            await browser.close(code, inner.close_reason or "")


def _log() -> logging.Logger:
    """Returns the connection log, without unused speculative connections of browsers."""
    log = logging.getLogger(__name__)
    log.addFilter(lambda record: record.getMessage() != "opening handshake failed")
    return log


@contextlib.contextmanager
def served(host: str, port: int, teleop: Teleop) -> Iterator[tuple[viser.ViserServer, Front]]:
    """Starts viser's server and the public page in front of it.

    Raises:
      ValidationError: the port is in use.
    """
    port = free_port(host, port)
    with private_server() as server:
        front = Front(host, port, server.get_port(), teleop)
        try:
            yield server, front
        finally:
            front.stop()


def _jpeg(image: np.ndarray) -> bytes:
    done, body = cv2.imencode(".jpg", image[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY])
    assert done
    return body.tobytes()


async def _pass_on(source: Any, target: Any) -> None:
    with contextlib.suppress(ConnectionClosed):
        async for message in source:
            await target.send(message)


def _viser_protocol(_: ServerConnection, offered: Any) -> Subprotocol | None:
    """Returns the first offered protocol, which is the version of viser's client that viser checks."""
    return next(iter(offered), None)


def _response(status: http.HTTPStatus, body: bytes, headers: dict[str, str]) -> Response:
    given = {**headers, "Content-Length": str(len(body)), "Cache-Control": "no-cache"}
    return Response(status.value, status.phrase, Headers(given), body)
