"""Who may use the page: a token, and only from the page itself."""

from __future__ import annotations

import hmac
import ipaddress
import secrets
import socket
from collections.abc import Mapping
from dataclasses import dataclass, field
from http.cookies import CookieError, SimpleCookie
from urllib.parse import urlsplit

_TOKEN_BYTES = 24
_LOOPBACK_NAMES = frozenset({"localhost", "127.0.0.1", "::1"})


@dataclass(frozen=True)
class Access:
    """The token, and the names under which this machine serves.

    The cookie is no substitute for it: a browser sends cookies to every port of a host, so that
    another user's server on this machine may see it. It opens the empty page; the socket, from
    which all that is shown comes, wants the token.

    Another user of the machine, and a page of another site in the same browser, do not know the
    token. A name that an attacker points at this machine (DNS rebinding) is none of ``names``.
    """

    names: frozenset[str]
    token: str = field(default_factory=lambda: secrets.token_urlsafe(_TOKEN_BYTES))
    # Cookies do not know ports: two servers of one machine must not overwrite each other's.
    cookie: str = field(default_factory=lambda: f"tpc_live_{secrets.token_hex(4)}")
    cookie_value: str = field(default_factory=lambda: secrets.token_urlsafe(_TOKEN_BYTES))

    def knows(self, token: str) -> bool:
        """Whether this is the token; the time that this takes does not tell how much is right."""
        return _is_equal(self.token, token)

    def has_cookie(self, header: str) -> bool:
        """Whether a Cookie header has ours."""
        try:
            found = SimpleCookie(header).get(self.cookie)
        except CookieError:
            return False
        return found is not None and _is_equal(self.cookie_value, found.value)

    @property
    def set_cookie(self) -> str:
        """The Set-Cookie header: scripts cannot read it, other sites cannot send it."""
        return f"{self.cookie}={self.cookie_value}; Path=/; HttpOnly; SameSite=Strict"

    def serves(self, host: str, reached: str) -> bool:
        """Whether a Host header names this machine.

        The port is not looked at, so that a tunnel (``ssh -L``) may have another one.

        Args:
            host: the header.
            reached: the address of this machine that the request came to.
        """
        name = host_name(host)
        return bool(name) and (name in self.names or name == _address(reached))


def _is_equal(wanted: str, given: str) -> bool:
    return hmac.compare_digest(wanted.encode(), given.encode("utf-8", "replace"))


def host_name(host: str) -> str:
    """The name or address in a Host header, in small letters; empty if it is none.

    >>> host_name("Robot.local:8080"), host_name("[::1]:80"), host_name("a@b"), host_name("")
    ('robot.local', '::1', '', '')
    """
    if not host or any(sign in host for sign in "@/?#\\ "):
        return ""
    try:
        return urlsplit(f"//{host}").hostname or ""
    except ValueError:
        return ""


def is_same_origin(origin: str, host: str) -> bool:
    """Whether an Origin header is that of the page, which was served under this Host.

    >>> is_same_origin("http://127.0.0.1:8080", "127.0.0.1:8080")
    True
    >>> is_same_origin("null", "127.0.0.1:8080"), is_same_origin("http://evil", "127.0.0.1:8080")
    (False, False)
    """
    return bool(host) and origin.lower() == f"http://{host.lower()}"


def names_of(address: str) -> frozenset[str]:
    """The names under which a server at an address may be asked for, besides the address itself."""
    if _is_loopback(address):
        return _LOOPBACK_NAMES
    here = socket.gethostname().lower()
    own = frozenset() if _is_any(address) else frozenset({address.lower()})
    return _LOOPBACK_NAMES | own | {here, f"{here.partition('.')[0]}.local"}


def shown_host(address: str, environment: Mapping[str, str]) -> str:
    """The host to put into an address for people: one that other machines reach, if any do."""
    if not _is_any(address):
        return f"[{address}]" if ":" in address else address
    named = environment.get("ROS_IP") or environment.get("ROS_HOSTNAME")
    if named and named != "localhost" and not named.startswith("127."):
        return f"[{named}]" if ":" in named else named
    return _route() or "127.0.0.1"


def is_private(address: str) -> bool:
    """Whether a server at this address is reached from this machine alone."""
    return _is_loopback(address)


def _route() -> str:
    """The address of this machine on the way to others; nothing is sent to find it."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            # An address for documentation, which nobody has.
            probe.connect(("192.0.2.1", 9))
            return str(probe.getsockname()[0])
        except OSError:
            return ""


def _address(text: str) -> str:
    """An address as a Host header has it: without a zone, and IPv4 as such."""
    try:
        found = ipaddress.ip_address(text.partition("%")[0])
    except ValueError:
        return text
    mapped = getattr(found, "ipv4_mapped", None)
    return str(mapped or found)


def _is_loopback(address: str) -> bool:
    if address.lower() == "localhost":
        return True
    try:
        return ipaddress.ip_address(address).is_loopback
    except ValueError:
        return False


def _is_any(address: str) -> bool:
    return address in ("", "0.0.0.0", "::", "*")
