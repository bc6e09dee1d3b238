"""Who may talk to the server: a browser on this machine that was given the address with its token."""

from __future__ import annotations

import hmac
from collections.abc import Awaitable, Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from aiohttp.web import Request, StreamResponse

#: Names of this machine that a browser may use; others are another site's that points here.
_HOSTS = ("127.0.0.1", "localhost", "[::1]")
_POLICY = (  # {host}: address and port of the server
    "default-src 'self'; script-src 'self' 'unsafe-eval' 'unsafe-inline'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
    "connect-src 'self' ws://{host}; frame-ancestors 'none'; form-action 'none'; base-uri 'self'"
)
_HEADERS = {
    "Content-Security-Policy": _POLICY, "X-Content-Type-Options": "nosniff", "Referrer-Policy": "no-referrer", "Cache-Control": "no-store"
}  # fmt: skip

Handler = Callable[["Request"], Awaitable["StreamResponse"]]


def guard(token: str) -> Callable[[Request, Handler], Awaitable[StreamResponse]]:
    """Middleware of aiohttp that refuses (403) other hosts, pages of other origins, and what has neither the token nor its cookie.

    The first request carries ``?token=``; the cookie that it is answered with does for all that follow.
    """
    from aiohttp.web import Response, middleware

    @middleware
    async def check(request: Request, handler: Handler) -> StreamResponse:
        host, origin = request.headers.get("Host", ""), request.headers.get("Origin")
        name = f"raceway_{host.rpartition(':')[2]}"
        secret = request.query.get("token") or request.cookies.get(name, "")
        if host.rpartition(":")[0] not in _HOSTS or origin not in (None, f"http://{host}"):
            return Response(status=403, text="another host's page\n")
        if not hmac.compare_digest(secret.encode(), token.encode()):
            return Response(status=403, text="open the address that `raceway app` has printed: it carries a token\n")
        response = await handler(request)
        if not response.prepared:
            response.headers.update({name: words.replace("{host}", host) for name, words in _HEADERS.items()})
            if "token" in request.query:
                response.set_cookie(name, token, httponly=True, samesite="Strict", path="/")
        return response

    return check
