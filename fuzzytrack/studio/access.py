"""Who may use the studio: names of the server, the token of its start, headers of its answers."""

from __future__ import annotations

import ipaddress
import re
import secrets
import socket
from collections.abc import Mapping
from dataclasses import dataclass

__all__ = ["HEADERS", "PROTOCOL", "Access", "check_token", "new_token"]

#: Subprotocol of the socket; the page names it beside the one that holds the token.
PROTOCOL = "fuzzytrack"
_TOKEN = "token."
_SHORTEST = 16
_PORT = 80
_EVERYWHERE = ("0.0.0.0", "::")

_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
    "img-src 'self' data: blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
#: Headers of every answer: nothing from elsewhere, no scripts or styles in the page itself.
HEADERS = {
    "Content-Security-Policy": _POLICY,
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "camera=(), geolocation=(), microphone=()",
    "Cache-Control": "no-cache",
}


def new_token() -> str:
    """Token of a start of the server, which the page has in the fragment of its address."""
    return secrets.token_urlsafe(24)


def check_token(token: str) -> str:
    """The token itself, if it can be guessed by nobody and be written in an address.

    Raises
    ------
    ValueError
        If it is too short, or has other characters.
    """
    if not re.fullmatch(rf"[A-Za-z0-9_-]{{{_SHORTEST},}}", token):
        raise ValueError(
            f"token: needs {_SHORTEST} or more letters, digits, - and _; "
            "leave it out for a random one where only this computer has access"
        )
    return token


@dataclass(frozen=True)
class Access:
    """What a browser must send to get pages, and a socket.

    Attributes
    ----------
    host : str
        Address at which the server listens.
    port : int
        Its port.
    token : str
        The secret of this start.
    """

    host: str
    port: int
    token: str

    def knows(self, headers: Mapping[str, str]) -> bool:
        """Whether a request names this server as its host.

        A page of another site whose name was pointed at this computer names that one.
        """
        name, port = _split(headers.get("host", ""))
        if port != self.port:
            return False
        if name in (self.host, "localhost", "127.0.0.1", "::1"):
            return True
        # The name under which others reach it is not known; no site can be behind a number.
        anywhere = self.host in _EVERYWHERE
        return anywhere and (_is_address(name) or name == socket.gethostname().lower())

    def admits(self, headers: Mapping[str, str], protocols: list[str]) -> bool:
        """Whether a socket may be opened: by a page of this server, with the token.

        Parameters
        ----------
        headers : mapping of str to str
            Headers of the request, names in lower case.
        protocols : list of str
            Subprotocols that it offers.
        """
        if not self.knows(headers) or headers.get("origin") != f"http://{headers.get('host')}":
            return False
        # Old versions of uvicorn give those of one header as one text.
        offered = [name.strip() for each in protocols for name in each.split(",")]
        given = [name.removeprefix(_TOKEN) for name in offered if name.startswith(_TOKEN)]
        right = [secrets.compare_digest(each.encode(), self.token.encode()) for each in given]
        return PROTOCOL in offered and any(right)


def _split(host: str) -> tuple[str, int]:
    """Name and port of a header; port 0, which no server has, if it cannot be read."""
    found = re.fullmatch(r"(\[[0-9a-f:.]+\]|[\w.-]+)(?::(\d{1,5}))?", host.lower(), re.ASCII)
    if not found:
        return "", 0
    return found[1].strip("[]"), int(found[2] or _PORT)


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True
