"""The server of the studio: its port, its start and its end."""

from __future__ import annotations

import errno
import logging
import os
import signal
import socket
import threading
from collections.abc import Callable
from importlib import import_module
from types import FrameType
from typing import TYPE_CHECKING

import uvicorn

from fuzzytrack.studio.access import Access, check_token, new_token
from fuzzytrack.studio.app import make_app
from fuzzytrack.studio.folder import Folder
from fuzzytrack.studio.limits import MESSAGE_BYTES
from fuzzytrack.studio.memory import give_back_at_once
from fuzzytrack.studio.notes import warnings_to_notes

if TYPE_CHECKING:
    from fuzzytrack.studio.pages import Studio

__all__ = ["StudioOnce", "listen", "make_server", "serve"]

LOCAL = "127.0.0.1"
# A page that is open finds the server again at the same port after a start.
_USUAL_PORT = 8098


def serve(
    folder: str | os.PathLike[str],
    *,
    host: str | None = None,
    port: int | None = None,
    token: str | None = None,
    started: Callable[[str], None],
    command: Callable[..., str] | None = None,
) -> None:
    """Serve the studio until it is interrupted.

    Parameters
    ----------
    folder : str or path
        Rule bases, scenarios and recordings of the user; no others can be opened.
    host : str, optional
        Address to listen at; only this computer unless given, and then a token is needed too.
    port : int, optional
        0 for any free one; 8098 unless given, or any free one if that is in use.
    token : str, optional
        Secret in the address of the page; a random one unless given.
    started : callable
        Called with the address of the page as soon as it can be opened.
    command : callable, optional
        See `fuzzytrack.studio.pages.Studio`.

    Raises
    ------
    ValueError
        If the folder does not exist, a host is given without a token, or the port cannot be used.
    """
    if host is not None and token is None:
        raise ValueError(
            "host and token: others can reach an address that is not only of this computer; give a "
            "token of your own too"
        )
    token = new_token() if token is None else check_token(token)
    give_back_at_once()
    studio = StudioOnce(Folder(folder), command)
    with listen(host or LOCAL, port) as listening:
        access = Access(host or LOCAL, listening.getsockname()[1], token)
        server = make_server(studio, access)
        # For good: uvicorn gives signals back when it ends, and one more that comes then would end
        # this process before its processes are ended.
        for number in _ends():
            signal.signal(number, server.handle_exit)
        with warnings_to_notes():
            threading.Thread(target=studio.warm, daemon=True).start()
            started(f"http://{_written(access)}/#token={token}")
            server.run(sockets=[listening])


class StudioOnce:
    """Makes the studio when it is called first; the server listens before.

    Parameters
    ----------
    folder : Folder
    command : callable, optional
        As for `fuzzytrack.studio.pages.Studio`.
    """

    def __init__(self, folder: Folder, command: Callable[..., str] | None = None) -> None:
        self._given = folder, command
        self._lock = threading.Lock()
        self._made: Studio | None = None

    def __call__(self) -> Studio:
        """The studio."""
        with self._lock:
            if self._made is None:
                from fuzzytrack.studio.pages import Studio

                self._made = Studio(*self._given)
            return self._made

    def warm(self) -> None:
        """Import and do once what takes long for the first time."""
        self()
        import_module("fuzzytrack.studio.connection")
        self().warm()


def make_server(studio: Callable[[], Studio], access: Access) -> uvicorn.Server:
    """Make the server; it is given a socket that listens."""
    config = uvicorn.Config(
        make_app(studio, access),
        log_config=None,
        log_level="warning",
        access_log=False,
        server_header=False,
        date_header=False,
        proxy_headers=False,
        ws="websockets-sansio",
        ws_max_size=MESSAGE_BYTES,
        # Compressed messages could be small and yet fill the memory.
        ws_per_message_deflate=False,
        timeout_graceful_shutdown=1,
    )
    return _Server(config)


class _Server(uvicorn.Server):
    """A server that a signal ends in order, however often it comes.

    After a second Ctrl-C that of uvicorn leaves out the end of the application, which ends the
    processes; and it raises a signal again, which ends this process before they are told.
    """

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """End when all that has been asked for is answered, or after a second."""
        self.should_exit = True

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """End; what is given up after that second is no error, and is not logged as one."""
        logging.getLogger("uvicorn.error").setLevel(logging.CRITICAL)
        await super().shutdown(sockets)


def _ends() -> list[signal.Signals]:
    """Signals that end the server: Ctrl-C, a stop of the system, and a terminal that is closed."""
    names = ("SIGINT", "SIGTERM", "SIGHUP")
    return [getattr(signal, name) for name in names if hasattr(signal, name)]


def _written(access: Access) -> str:
    """Host and port in an address that a browser of this computer opens."""
    host = {"0.0.0.0": LOCAL, "::": "::1"}.get(access.host, access.host)
    return f"[{host}]:{access.port}" if ":" in host else f"{host}:{access.port}"


def listen(host: str, port: int | None) -> socket.socket:
    """A socket that listens; at any free port if none is given and the usual one is in use."""
    ports = (_USUAL_PORT, 0) if port is None else (port,)
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    for each in ports:
        try:
            return socket.create_server((host, each), family=family)
        except UnicodeError:
            raise ValueError(f"host: {host!r} is no name of a computer, and no address") from None
        except OSError as error:
            failure = error
    # Errors of names have numbers of their own, below 0.
    if (failure.errno or 0) < 0 or failure.errno == errno.EADDRNOTAVAIL:
        raise ValueError(f"host: {host!r} is no address of this computer; give one that it has")
    # The text of the error repeats the address.
    why = os.strerror(failure.errno or errno.EIO)
    what = f"cannot listen at {host}, port {ports[-1]}: {why}"
    raise ValueError(f"port: {what}; give another, or 0 for any free one")
