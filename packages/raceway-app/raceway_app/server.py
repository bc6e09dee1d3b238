"""``raceway app``: the page of one or two scenes, served on this machine alone."""

from __future__ import annotations

import asyncio
import hmac
import logging
import os
import secrets
import sys
import webbrowser
from collections import deque
from collections.abc import Awaitable, Callable, Iterable
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from raceway import RacewayError, SceneError
from raceway.extend import (
    FILE, Given, SceneSource, Tables, as_given, as_scene, common, csv_text, found_by, plugin_files, print_json, registry_with, set_keys,
    writable, write_whole,
)  # fmt: skip
from raceway_app.session import Session, groups, texts
from raceway_app.worker import Job, News, Worker

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
    """Middleware of aiohttp that refuses (403) other hosts, pages of other origins, and what has neither ``?token=`` nor its answer's cookie."""
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


#: What is opened without a scene: the two excitation models under identical settings.
_EXAMPLE: Tables = {
    "title": "B7206C under 1 kN and the rig's unbalance",
    "bearing": {"preset": "B7206C"}, "supports": {"tilt": "locked"}, "rotor": {"mass": 2.0}, "load": {"axial": 1000.0},
    "excitation": {"kind": "bidirectional", "speed_rpm": 12000.0, "unbalance": 6.39e-4, "load_share": 0.5},
    "contact": {"kind": "hertz", "damping": 0.001},
}  # fmt: skip
_NAMES = ("A", "B")


class Page:
    """State of the page, and what its buttons do; the state is shared by all tabs."""

    def __init__(self, session: Session, worker: Worker) -> None:
        from trame_server import Server

        self.session, self.worker = session, worker
        self.ranges: dict[str, tuple[float, float]] = {}
        self.server = Server("raceway", client_type="vue3")
        self.state: Any = self.server.state
        self._loop: asyncio.AbstractEventLoop | None = None
        self._job = -1  # the last that computes pictures
        self._numbers: dict[int, int] = {}  # panel -> number of the change that its picture belongs to
        self._reports: deque[News] = deque()
        self.state.update({f"{name}_{k}": None for k in (0, 1) for name in ("screen", "rings", "bodies", "curves")})
        self.state.update({"forms": [], "note": "", "ranges": {}, "done": -1, "shown": -1, "busy": {}})
        self.state.designations = [[entry.name, entry.title.partition(": ")[2]] for entry in found_by("*")]
        self.state.update({"trame__title": "Raceway", "folder": str(session.folder)})
        self._show([0, 1])
        triggers = {
            "range": self.on_range, "write": self.on_write, "stop": worker.stop,
            "change": lambda panels, *change: self._after(session.change, [int(k) for k in panels], *change),
            "compare": lambda on: self._after(session.compare, bool(on)),
            "undo": lambda: self._after(session.undo), "redo": lambda: self._after(session.undo, False),
        }  # fmt: skip
        for name, act in triggers.items():
            self.server.controller.trigger(name)(act)
        data, view = (Path(str(files(name).joinpath("data"))) for name in ("raceway_app", "raceway_view"))
        self.server.enable_module(
            {
                "serve": {"raceway": str(data), "raceway_view": str(view)}, "vue_use": ["raceway_app"],
                "scripts": ["raceway_view/view.js", "raceway/app.js"], "styles": ["raceway/app.css"],
            }
        )  # fmt: skip
        self.state.trame__template_main = (data / "app.html").read_text(encoding="utf-8")

    def on_range(self, axis: str, low: float, high: float) -> None:
        """The ends of an axis of the curves."""
        if isinstance(low, int | float) and isinstance(high, int | float) and 0.0 <= low < high < 1e9:
            self.ranges = {**self.ranges, str(axis): (float(low), float(high))}
            self.session.number += 1
            self._show(list(range(len(self.session.scenes))))
        else:
            self.state.note = f"an axis goes from 0 or more up to a larger number below 1e9, not from {low} to {high}"

    def on_write(self, kind: str, panel: int) -> None:
        """A file: of the scene ("scene"), the curves ("csv"), pictures ("png"), coefficients ("ross")."""
        session = self.session
        panel = int(panel == 1 and len(session.scenes) == 2)
        try:
            if kind == "scene":
                self.state.note = f"written: {session.save(panel)}"
            elif kind == "csv":
                text = csv_text(list(_curve_rows(self.state[f"curves_{k}"] for k in (0, 1))))
                self.state.note = f"written: {write_whole(text.encode(), session.file('curves', '.csv'))}"
            elif kind in ("png", "ross"):
                path = session.file(*{"png": ("pictures", ""), "ross": ("bearing", ".toml")}[kind], panel)
                scenes = {panel: (session.number, session.scenes[panel])}
                self.worker.submit(Job(session.number, scenes, file=kind, path=path))
                self.state.note = "writing"
        except RacewayError as error:
            self.state.note = str(error)

    def _after(self, act: Callable[..., list[int]], *words: Any) -> None:
        """Do something to the session, then show what has changed."""
        self.state.note = ""
        try:
            self._show(act(*words))
        except (SceneError, TypeError, ValueError, AttributeError) as error:
            self.state.note = str(error)

    def _show(self, changed: list[int]) -> None:
        """The form, and new pictures of panels that have changed; their old numbers are marked as such until then."""
        session = self.session
        scenes: dict[int, tuple[int, Given]] = {}
        panels: list[Tables] = []
        for k, tables in enumerate(session.scenes):
            scene, mistakes = session.checked(k)
            input_texts, valid = texts(tables, scene)
            panels.append({
                "name": _NAMES[k], "said": input_texts, "holds": valid, "mistakes": mistakes, "title": tables.merged().get("title", ""),
                "command": session.command(k), "python": session.python(k) if scene is not None else "",
            })  # fmt: skip
            if k in changed:
                self._numbers[k] = session.number
                if scene is None:
                    self._forget(k)
                else:
                    scenes[k] = session.number, tables
        if len(panels) == 1 and self._numbers.pop(1, None) is not None:  # what is computed of it still is dropped
            self._forget(1)
        busy = {k: words for k, words in (self.state.busy or {}).items() if int(k) not in changed and int(k) < len(panels)}
        busy |= {str(k): "computing" for k in scenes}
        undo, redo = session.can_undo
        self.state.update({
            "panels": panels, "can_undo": undo, "can_redo": redo, "number": session.number,
            "busy": busy, "ranges": dict(self.ranges),
        })  # fmt: skip
        if (forms := [groups(tables) for tables in session.scenes]) != self.state.forms:  # the largest part, of kinds alone
            self.state.forms = forms
        if scenes:
            self._job = session.number
            self.worker.submit(Job(session.number, scenes, dict(self.ranges)))
        elif not busy:
            self.state.update({"shown": session.number, "done": session.number})

    def _forget(self, panel: int) -> None:
        """A scene that is refused, or is no more, has no numbers."""
        self.state.update({f"{name}_{panel}": None for name in ("screen", "bodies", "curves")})

    def hear(self, news: News) -> None:
        """In the worker's thread: what is reported within 1 ms goes to the page together, which is drawn once."""
        self._reports.append(news)
        if self._loop is not None:
            self._loop.call_soon_threadsafe(self._loop.call_later, 1e-3, self._take)

    def _take(self) -> None:
        with self.state:
            while self._reports:
                self._news(self._reports.popleft())

    def _news(self, news: News) -> None:
        """What the worker reports, unless the scene has changed meanwhile."""
        panel, state = news.panel, self.state
        if news.kind == "file":
            state.note = f"written: {', '.join(news.content)}"
        elif news.kind == "failed file":
            state.note = f"not written: {'; '.join(sentence for _, sentence in news.content)}"
        elif news.kind in ("drawn", "done"):
            if news.number == self._job:
                now = self.session.number
                state.update({"shown": now} if news.kind == "drawn" else {"shown": now, "busy": {}, "done": now})
        elif self._numbers.get(panel) != news.number:
            return
        elif news.kind == "progress":
            part, steps, total = news.content
            state.busy = {**state.busy, str(panel): f"{part} {100 * steps // total} %" if total else part}
        elif news.kind == "refused":
            self._forget(panel)
            panels = [dict(panel_state) for panel_state in state.panels]
            panels[panel]["mistakes"] = news.content
            state.panels = panels
        elif news.kind == "picture":
            if "screen" in news.content:
                state[f"screen_{panel}"] = {**news.content["screen"], "number": news.number}
                state[f"bodies_{panel}"] = {name: news.content[name] for name in ("bodies", "why")}
            if "rings" in news.content:
                state[f"rings_{panel}"] = {"rings": news.content["rings"], "number": news.number}
            if "curves" in news.content:
                state[f"curves_{panel}"] = news.content["curves"]
                for curve in news.content["curves"]:  # axes stay while a key is changed
                    if curve["lines"]:
                        self.ranges.setdefault(curve["axis"], (curve["x"][0], curve["x"][-1]))

    def serve(self, port: int, token: str, ready: Callable[[str], None]) -> None:
        """Until Ctrl-C."""
        server = self.server

        async def session(request: Any) -> Any:  # a page of trame asks a launcher of processes first
            from aiohttp.web import json_response

            return json_response({"sessionURL": f"ws://{request.headers['Host']}/ws", "secret": "wslink-secret"})

        def bind(app: Any) -> None:
            app.app.middlewares.append(guard(token))
            app.app.router.add_post("/paraview/", session)

        def begin(**_: object) -> None:
            self._loop = asyncio.get_running_loop()
            self._take()
            ready(f"http://127.0.0.1:{server.port}/index.html?token={token}")

        server.controller.on_server_bind.add(bind)
        server.controller.on_server_ready.add(begin)
        logging.getLogger("aiohttp").setLevel(logging.CRITICAL)  # requests that are none
        os.environ["WSLINK_WS_COMPRESS"] = "0"  # nothing is far
        arguments, sys.argv = sys.argv, sys.argv[:1]
        try:
            quiet = {"open_browser": False, "show_connection_info": False, "disable_logging": True}
            server.start(port=port, host="127.0.0.1", timeout=0, **quiet)
        finally:
            sys.argv = arguments


def _curve_rows(curves: Iterable[list[Tables] | None]) -> Iterable[Tables]:
    """A row for each point of each curve."""
    for name, panels in zip(_NAMES, curves, strict=True):
        for content in panels or ():
            for line in content["lines"]:
                for x, y in zip(content["x"], line["y"], strict=True):
                    yield {
                        "scene": name, "axis": content["label"], "x": x, "quantity": line["name"], "unit": content["unit"],
                        "value": "" if y is None else y,
                    }  # fmt: skip


def app(
    scene: SceneSource | None = None,
    *,
    out: str | Path | None = None,
    port: int = 0,
    ready: Callable[[str], None] = print,
    plugins: Iterable[str | Path] = (),
) -> None:
    """Look at a scene in a browser and change it: bearing, ball loads, curves over speed and load; served to this machine alone, until Ctrl-C.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables; None: the two excitation models of an example side by side
    out : folder in which the page's buttons write, and nowhere else; None: raceway-out/app
    port : of the server on 127.0.0.1; 0: any that is free
    ready : called with the address, which carries a token, once the page can be opened
    plugins : files of one-off plug-ins that scenes may use

    Raises
    ------
    SceneError
        A source that is no scene.
    RacewayError
        trame is missing, or the port is taken.

    Examples
    --------
    >>> import raceway as rw
    >>> rw.app("examples/b7206.toml", ready=lambda address: print(address[:17]))  # doctest: +SKIP
    http://127.0.0.1:
    """
    paths = [Path(path) for path in plugins]
    worker = Worker(paths, lambda news: page.hear(news))  # begins beside what follows
    try:
        registry_with(paths)
        tables = as_given(_EXAMPLE if scene is None else scene)
        session = Session((tables,), writable(Path(out) if out is not None else Path("raceway-out") / "app"))
        if scene is None:
            session.compare(True)
            session = Session(session.scenes, session.folder)  # nothing was changed that could be undone
        page = Page(session, worker)
        page.serve(port, secrets.token_urlsafe(24), ready)
    finally:
        worker.close()


@click.command("app", short_help="A page to look at a scene and change it, on this machine.")
@click.argument("scene", type=FILE, required=False)
@set_keys
@click.option("--out", type=FILE, metavar="DIR", help="Folder in which the page writes, and nowhere else [raceway-out/app].")
@click.option("--port", type=click.IntRange(0, 65535), default=0, metavar="N", help="On 127.0.0.1 [any that is free].")
@click.option("--browser/--no-browser", default=True, help="Open the page (default).")
@plugin_files
@common
def app_command(
    scene: Path | None,
    changes: tuple[str, ...],
    out: Path | None,
    port: int,
    browser: bool,
    plugins: tuple[Path, ...],
    as_json: bool,
) -> int:
    """A scene as a form beside its bearing, ball loads, K, C and life over speed and load; each change is computed at once.

    Without SCENE the two excitation models of an example stand side by side.  The page is served to this machine alone, at an address
    with a token, until Ctrl-C; it writes into one folder only.

    \b
    Example:
      raceway app examples/b7206.toml
      raceway app examples/duplex_db.toml --out spindle --no-browser
    """
    opened = as_scene(scene, *changes, plugins=plugins) if scene is not None and changes else scene

    def ready(address: str) -> None:
        if as_json:
            print_json({"address": address})
        else:
            click.echo(f"{address}\n  the page; Ctrl-C here ends it")
        if browser:
            webbrowser.open(address)

    app(opened, out=out, port=port, ready=ready, plugins=plugins)
    return 0
