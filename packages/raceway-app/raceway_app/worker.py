"""A process of its own that computes pictures of scenes, so that the page answers meanwhile and a long run can be stopped."""

import contextlib
import gc
import json
import signal
import threading
import time
import traceback
from collections.abc import Callable, Sequence
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import attrs

from raceway import RacewayError, Scene
from raceway.extend import Given, Tables
from raceway_app.session import mistakes_of

#: A run that does not end when it is stopped for so long [s] is ended with its process; pictures that take so long are stopped by others;
#: progress is told so often; without a change for so long scenes are run, then their curves, drawn at a quarter of the points, get all.
_GRACE_S, _HURRY_S, _SOON_S, _REST_S = 2.0, 0.5, 0.2, 0.06


@attrs.frozen
class Job:
    """Scenes to compute, or a file to write of one."""

    number: int  # of the change that asks for it
    scenes: dict[int, tuple[int, Given]]  # panel -> number of its last change, and scene
    #: axis of the curves -> its ends, where these are not the scene's own
    ranges: dict[str, tuple[float, float]] = attrs.field(factory=dict)
    file: str = ""  # "png" or "ross", written at ``path``; empty: a picture
    path: Path = Path()


@attrs.frozen
class News:
    """What the process reports: ``kind`` is "progress", "picture" (screen, bodies and rings as JSON, curves), "drawn" (curves of all scenes), "refused", "stopped", "file", "failed file" or "done"."""

    number: int
    panel: int
    kind: str
    content: Any = None


class Stopped(KeyboardInterrupt):
    """The page does not want the rest."""


class Worker:
    """The process; ``on_news`` is called in a thread of its own."""

    def __init__(self, plugins: Sequence[Path], on_news: Callable[[News], None]) -> None:
        self._plugins, self._tell = list(plugins), on_news
        self._lock = threading.Lock()
        self._running: Job | None = None
        self._drawn = self._stopped = False  # whether its curves are shown, so that the rest can be stopped; whether it is
        self._closed = False
        self._waiting: list[Job] = []
        self._start()

    @property
    def process_id(self) -> int | None:
        """Of the present process."""
        return self._process.pid

    def submit(self, job: Job) -> None:
        """Compute, after what runs now.  Pictures take the place of those that wait or take long; files are written."""
        with self._lock:
            if not job.file:
                before = [late for late in self._waiting if not late.file]
                self._waiting = [late for late in self._waiting if late.file]
                if self._running is not None and not self._running.file:
                    # Scenes of it that have not changed since are computed again.
                    before.insert(0, self._running)
                    threading.Timer(0.0 if self._drawn else _HURRY_S, self._interrupt, (self._running,)).start()
                for late in reversed(before):
                    job = attrs.evolve(job, scenes={**late.scenes, **job.scenes})
            self._waiting.append(job)
            if self._running is None:
                self._send()

    def stop(self) -> None:
        """Stop what runs, and forget what waits."""
        with self._lock:
            self._waiting.clear()
        if self._running is not None:
            self._interrupt(self._running)

    def close(self) -> None:
        """End the process."""
        with self._lock:
            self._running, self._closed = None, True
            self._waiting.clear()
            self._process.terminate()
            self._process.join(5.0)
            self._connection.close()
            self._stops.close()

    def _start(self) -> None:
        context = get_context("spawn")
        self._connection, far_end = context.Pipe()
        stops, self._stops = context.Pipe(duplex=False)  # an event would lie locked where a process is killed
        self._count = 0  # of jobs sent
        self._process = context.Process(target=serve, args=(far_end, stops, self._plugins), daemon=True)
        self._process.start()
        far_end.close()
        stops.close()
        threading.Thread(target=self._listen, args=(self._connection,), daemon=True).start()

    def _send(self) -> None:
        """The next job."""
        self._running = self._waiting.pop(0) if self._waiting else None
        self._drawn = self._stopped = False
        if self._running is not None:
            self._count += 1
            with contextlib.suppress(OSError):  # of a process that has ended, which is told where it is listened to
                self._connection.send(self._running)

    def _interrupt(self, job: Job) -> None:
        """A job that still runs is not wanted."""
        with self._lock:
            if self._running is job and not self._stopped:
                self._stopped = True
                with contextlib.suppress(OSError):
                    self._stops.send(self._count)
                timer = threading.Timer(_GRACE_S, self._end, (job,))
                timer.daemon = True
                timer.start()

    def _end(self, job: Job) -> None:
        """A job that does not listen ends with its process."""
        with self._lock:
            if self._running is job:
                self._process.kill()

    def _listen(self, connection: Connection) -> None:
        """Hand on what the process reports, until it ends; then start another one unless it was closed."""
        while True:
            try:
                news = connection.recv()
            except (EOFError, OSError):
                break
            with self._lock:  # stopped for the sake of a job that has the scene, too
                obsolete = news.kind == "stopped" and any(news.panel in job.scenes for job in self._waiting)
            if not obsolete:
                self._tell(attrs.evolve(news, kind="refused") if news.kind == "stopped" else news)
            if news.kind == "drawn":
                self._drawn = True
                if self._waiting and self._running is not None:
                    self._interrupt(self._running)
            elif news.kind == "done":
                with self._lock:
                    self._send()
        with self._lock:
            if self._closed:
                return
            last_job, self._running = self._running, None
            message = "stopped" if self._stopped else "the process that computes has ended: was there memory enough?"
            connection.close()
            self._stops.close()
            self._start()
        if last_job is not None:
            for panel, (number, _) in last_job.scenes.items():
                self._tell(News(number, panel, "failed file" if last_job.file else "refused", [("", message)]))
            self._tell(News(last_job.number, -1, "done"))
        with self._lock:
            self._send()


def serve(connection: Connection, stops: Connection, plugins: Sequence[Path]) -> None:
    """Jobs from a connection until it closes: what the process runs."""
    from raceway.extend import registry_with

    with contextlib.suppress(EOFError, KeyboardInterrupt, BrokenPipeError):
        registry_with(plugins)
        from raceway_app import picture  # noqa: F401  while nobody waits

        pictures, garbage_free = _Pictures(connection), False
        signal.signal(signal.SIGINT, pictures.interrupt)
        threading.Thread(target=pictures.listen, args=(stops,), daemon=True).start()
        while True:
            job: Job = connection.recv()
            pictures.sketch(job)
            for panel, (number, scene_input) in job.scenes.items():
                pictures.answer(job, panel, number, scene_input)
            connection.send(News(job.number, -1, "done"))
            if not garbage_free:  # what was compiled has put Python's search for cycles off
                gc.collect()
                garbage_free = True
            if not connection.poll(_REST_S):
                pictures.refine()


class _Pictures:
    """Answers to jobs."""

    def __init__(self, connection: Connection) -> None:
        from raceway_app.picture import Curves

        self._connection, self._stop, self._runs = connection, threading.Event(), False
        self._count = self._last = 0  # of jobs begun, and of the last that is to be stopped
        self._shapes: dict[int, object] = {}
        self._curves = Curves(), Curves()
        self._kinds: dict[int, tuple[object, Any]] = {}  # panel -> form of what was run before, titles of its curves
        self._answered: dict[int, int] = {}  # panel -> number
        self._coarse: dict[int, tuple[int, Any]] = {}  # panel -> number, and what curves at few points are drawn of

    def listen(self, stops: Connection) -> None:
        """Pass the wish to stop on, as the signal that ends a command between two steps of Python."""
        with contextlib.suppress(EOFError, OSError):
            while True:
                self._last = stops.recv()
                if self._last >= self._count:
                    self._stop.set()
                    signal.raise_signal(signal.SIGINT)

    def sketch(self, job: Job) -> None:
        """Curves at few points of scenes that differ by numbers alone from those before; their runs begin when no change comes."""
        from raceway.extend import default_registry
        from raceway_app import picture

        self._count += 1
        self._stop.clear()
        if self._last >= self._count:
            self._stop.set()
        drawn, news = dict[int, tuple[int, Any]](), list[News]()
        try:
            for panel, (number, scene_input) in job.scenes.items() if not job.file else ():
                if number in (self._answered.get(panel), self._coarse.get(panel, (-1,))[0]):
                    continue
                scene = scene_input.scene(default_registry())
                kind, titles = self._kinds.get(panel, (None, {}))
                if kind != (of := picture.form(scene))[0]:
                    return
                parts = scene, of, titles, picture.axes_of(scene, job.ranges)
                curves = self._curves[panel].draw(parts, self._go_on, few=True)
                news.append(News(number, panel, "picture", {"curves": curves}))
                drawn[panel] = number, parts
        except (Exception, Stopped):  # the run tells it
            return
        if news:
            for one in [*news, News(job.number, -1, "drawn")]:
                self._connection.send(one)
            self._coarse |= drawn
            self._stop.wait(_REST_S)

    def interrupt(self, *_: object) -> None:
        """A run, and nothing else: its signal comes at any time."""
        if self._runs:
            self._runs = False
            raise Stopped

    def _go_on(self) -> None:
        if self._stop.is_set() or self._connection.poll():
            raise Stopped

    def refine(self) -> None:
        """Curves at all their points, until another job comes."""
        with contextlib.suppress(Stopped):
            for panel, (number, parts) in list(self._coarse.items()):
                if self._answered.get(panel) == number:
                    curves = self._curves[panel].draw(parts, self._go_on)
                    self._connection.send(News(number, panel, "picture", {"curves": curves}))
                del self._coarse[panel]

    def answer(self, job: Job, panel: int, number: int, scene_input: Given) -> None:
        """One scene; a mistake or a failure is reported, never raised."""
        from raceway.extend import default_registry
        from raceway_app import picture

        last_report, refusal = time.monotonic(), "failed file" if job.file else "refused"

        def tell(kind: str, content: Any = None) -> None:
            self._connection.send(News(number, panel, kind, content))

        def progress(part: str, steps: int = 0, total: int = 0) -> None:
            nonlocal last_report
            self._go_on()
            if time.monotonic() - last_report > _SOON_S:
                last_report = time.monotonic()
                tell("progress", (part, steps, total))

        try:
            if job.file:
                tell("file", picture.write_file(job.file, scene_input.scene(default_registry()), job.path, progress))
            elif self._answered.get(panel) != number:
                self._go_on()
                self._draw(job, panel, scene_input.scene(default_registry()), tell, progress)
                self._answered[panel] = number
        except Stopped:
            tell(refusal if job.file else "stopped", [("", "stopped")])
        except RacewayError as error:
            tell(refusal, mistakes_of(error))
        except Exception as error:  # a third party's own code: the page goes on
            tell(refusal, [("", f"{type(error).__name__}: {error}"), ("", traceback.format_exc(limit=-2))])

    def _draw(self, job: Job, panel: int, scene: Scene, tell: Callable[..., None], progress: Callable[..., None]) -> None:
        import raceway
        from raceway.extend import duration
        from raceway_app import picture

        if (prediction := raceway.plan(scene).predicted_wall_s) > _SOON_S:
            tell("progress", (f"planned: {duration(prediction)}", 0, 0))
        try:
            self._runs = True
            result = raceway.run(scene, progress=progress)
            state = picture.at_rest(result)
            content: Tables = {"screen": picture.result_picture(result, state)}
        finally:
            self._runs = False
        shape = (scene.bearing, scene.bodies)
        try:
            bodies = picture.bodies_picture(result, state, self._shapes.get(panel) != shape)
            fixed = {name: bodies.pop(name) for name in list(bodies) if name.startswith("fixed")}
            content |= {"bodies": json.dumps(bodies), "why": ""} | ({"rings": json.dumps(fixed)} if fixed else {})
            self._shapes[panel] = shape
        except RacewayError as error:
            content |= {"bodies": "", "why": str(error)}
        number, titles, of = job.scenes[panel][0], picture.titles_of(result), picture.form(scene)
        parts = scene, of, titles, picture.axes_of(scene, job.ranges)
        if self._coarse.get(panel, (-1,))[0] != number:
            content["curves"] = self._curves[panel].draw(parts, self._go_on, few=True)
        self._kinds[panel], self._coarse[panel] = (of[0], titles), (number, parts)
        tell("picture", content)
