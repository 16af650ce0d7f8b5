"""One socket of a page: its requests in their order, the answers, and events."""

from __future__ import annotations

import asyncio
import contextlib

from starlette.websockets import WebSocket, WebSocketDisconnect

from fuzzytrack.errors import in_one_sentence
from fuzzytrack.studio.access import PROTOCOL
from fuzzytrack.studio.command_table import find_handler
from fuzzytrack.studio.handlers import Later, Result
from fuzzytrack.studio.limits import WAITING
from fuzzytrack.studio.messages import (
    Layers,
    MessageError,
    Request,
    answer,
    error,
    event,
    read_request,
)
from fuzzytrack.studio.pages import Page, Studio
from fuzzytrack.studio.threads import Threads

__all__ = ["Connection"]

# Messages that wait for a page that reads none.
_OUTBOX = 256
# Seconds between a change and its draft on disk.
_SAVING = 1.0
#: Codes with which a socket is closed: the page went on elsewhere; it reads no messages.
MOVED, SLOW = 4001, 4002


class Connection:
    """One socket.

    Commands of a page are done one after the other, in the order in which they came; what takes
    long in them, such as a surface, goes on while later ones are done.

    Parameters
    ----------
    socket : WebSocket
        It has been checked already.
    studio : Studio
    threads : Threads
    """

    def __init__(self, socket: WebSocket, studio: Studio, threads: Threads) -> None:
        self._socket = socket
        self._studio = studio
        self._threads = threads
        self._page: Page | None = None
        self._loop = asyncio.get_running_loop()
        self._outbox: asyncio.Queue[str | bytes | None] = asyncio.Queue(_OUTBOX)
        self._room = asyncio.Semaphore(WAITING)
        self._tasks: set[asyncio.Task[None]] = set()
        self._drafts: set[asyncio.Task[None]] = set()
        self._order = asyncio.Lock()
        self._saving: asyncio.TimerHandle | None = None
        self._code = 1000

    async def serve(self) -> None:
        """Answer messages until the socket is closed."""
        await self._socket.accept(subprotocol=PROTOCOL)
        sender = asyncio.create_task(self._send_all())
        receiver = asyncio.create_task(self._receive_all())
        try:
            await asyncio.wait({sender, receiver}, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for task in (sender, receiver, *self._tasks):
                task.cancel()
            if self._saving is not None:
                self._saving.cancel()
            if self._page is not None:
                self._page.leave(self)
                await self._threads.run(self._page.save_draft)
            with contextlib.suppress(RuntimeError, WebSocketDisconnect):
                await self._socket.close(self._code)

    # ---------------------------------------------------------------- out

    def send(self, message: str | bytes | None) -> None:
        """Send a message, from any thread; none closes the socket behind those before it."""
        with contextlib.suppress(RuntimeError):  # the server has ended meanwhile
            self._loop.call_soon_threadsafe(self._put, message)

    def move(self) -> None:
        """Close the socket, since the page has another one now; from any thread."""
        text = "this page was opened again elsewhere, and goes on there; open the studio anew here"
        self.send(event("notice", text=text))
        self._code = MOVED
        self.send(None)

    def _put(self, message: str | bytes | None) -> None:
        try:
            self._outbox.put_nowait(message)
        except asyncio.QueueFull:
            self._code = SLOW
            self._loop.create_task(self._socket.close(SLOW))

    async def _send_all(self) -> None:
        with contextlib.suppress(RuntimeError, WebSocketDisconnect):
            while (message := await self._outbox.get()) is not None:
                if isinstance(message, str):
                    await self._socket.send_text(message)
                else:
                    await self._socket.send_bytes(message)

    # ---------------------------------------------------------------- in

    async def _receive_all(self) -> None:
        while True:
            await self._room.acquire()
            message = await self._socket.receive()
            if message["type"] != "websocket.receive":
                return
            task = asyncio.create_task(self._handle(message.get("text")))
            self._tasks.add(task)
            task.add_done_callback(self._done)

    def _done(self, task: asyncio.Task[None]) -> None:
        self._tasks.discard(task)
        self._room.release()

    async def _handle(self, text: str | None) -> None:
        try:
            if text is None:
                raise MessageError("binary messages are not read")
            request = read_request(text)
        except MessageError as failure:
            await self._outbox.put(error(failure.seq, failure))
            return
        named = self._studio.folder.without_path
        try:
            found = await self._do(request)
        except ValueError as failure:
            found = error(request.seq, failure, named)
        except OSError as failure:
            found = error(request.seq, failure.strerror or str(failure), named)
        except Exception as failure:
            # A plug-in may raise anything, and a mistake of ours must not take the page down.
            said = f"{request.command}: {in_one_sentence(failure)}"
            found = error(request.seq, said, named)
        await self._outbox.put(found)

    async def _do(self, request: Request) -> str | bytes:
        async with self._order:
            result = await self._threads.run(lambda: self._call(request))
        if self._saving is None:
            self._saving = self._loop.call_later(_SAVING, self._save)
        if isinstance(result, Later):
            result = await self._threads.run(result.work)
        if isinstance(result, Layers):
            return result.message(request.seq)
        assert not isinstance(result, Later)
        return answer(request.seq, result)

    def _save(self) -> None:
        """Keep a draft, some time after a change, so that a drag is not kept at every step."""
        self._saving = None
        if self._page is not None:
            task = self._loop.create_task(self._threads.run(self._page.save_draft))
            self._drafts.add(task)
            task.add_done_callback(self._drafts.discard)

    def _call(self, request: Request) -> Result:
        """Do a command; runs in a thread."""
        handler = find_handler(request.command)
        if request.command == "hello":
            self._greet(request)
        if self._page is None:
            raise ValueError("say hello first: the session is not known")
        with self._page.turn():
            return handler(self._page, request.arguments)

    def _greet(self, request: Request) -> None:
        """Find the page of this socket."""
        key = request.arguments.get("session")
        page = self._studio.open(key if isinstance(key, str) else None)
        if self._page not in (None, page):
            self._page.leave(self)
        other = page.join(self)
        if other is not None and other is not self:
            other.move()
        self._page = page
