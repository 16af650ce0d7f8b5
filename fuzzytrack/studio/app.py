"""The web application: the page with its files, and the socket that all data go through."""

from __future__ import annotations

import contextlib
import re
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import TYPE_CHECKING

from starlette.applications import Starlette
from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocket

from fuzzytrack.studio.access import HEADERS, Access
from fuzzytrack.studio.threads import Threads

if TYPE_CHECKING:
    from fuzzytrack.studio.pages import Studio

__all__ = ["make_app"]

_STATIC = Path(__file__).resolve().parent / "static"
_NAME = re.compile(r"[a-z0-9_-]+\.(?:js|css|svg)", re.ASCII)
_TYPES = {
    ".html": "text/html",
    ".js": "text/javascript",
    ".css": "text/css",
    ".svg": "image/svg+xml",
}


def make_app(studio: Callable[[], Studio], access: Access) -> ASGIApp:
    """Make the application.

    Parameters
    ----------
    studio : callable
        Gives what the pages work on, which is closed with the application. It is called with the
        first socket: what it imports takes longer than all else at the start.
    access : Access
        Who may use it.
    """
    threads = Threads()

    async def page(request: Request) -> Response:
        return _file("index.html")

    async def static(request: Request) -> Response:
        name = request.path_params["name"]
        return _file(name) if _NAME.fullmatch(name) else _missing()

    async def socket(websocket: WebSocket) -> None:
        found = await threads.run(studio)
        from fuzzytrack.studio.connection import Connection

        await Connection(websocket, found, threads).serve()

    @contextlib.asynccontextmanager
    async def life(app: Starlette) -> AsyncIterator[None]:
        yield
        studio().close()

    routes = [
        Route("/", page),
        Route("/static/{name}", static),
        WebSocketRoute("/socket", socket),
    ]
    return _Guard(Starlette(routes=routes, lifespan=life), access)


class _Guard:
    """Refuses foreign hosts and sockets without the token; puts the headers on every answer."""

    def __init__(self, app: ASGIApp, access: Access) -> None:
        self._app = app
        self._access = access

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "websocket":
            headers = Headers(scope=scope)
            if not self._access.admits(headers, scope.get("subprotocols", [])):
                await receive()
                # Before the socket is accepted this is an answer of status 403.
                await send({"type": "websocket.close", "code": 1008})
                return
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return

        async def with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                MutableHeaders(scope=message).update(HEADERS)
            await send(message)

        if self._access.knows(Headers(scope=scope)):
            await self._app(scope, receive, with_headers)
        else:
            answer = PlainTextResponse("this server has another name\n", 400)
            await answer(scope, receive, with_headers)


def _file(name: str) -> Response:
    """A file of the page; all lie in one folder of the package."""
    try:
        content = (_STATIC / name).read_bytes()
    except OSError:
        return _missing()
    return Response(content, media_type=_TYPES[Path(name).suffix])


def _missing() -> Response:
    return PlainTextResponse("there is no such file\n", 404)
