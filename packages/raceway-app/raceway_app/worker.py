"""A process of its own that computes pictures of scenes, so that the page answers meanwhile and a long run can be stopped."""

from __future__ import annotations

import contextlib
import gc
import json
import threading
import time
import traceback
from collections.abc import Callable, Sequence
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.synchronize import Event
from pathlib import Path
from typing import Any

import attrs

from raceway import RacewayError, SceneError
from raceway.extend import Given, Tables

#: A run that does not end at a chunk of steps after so long [s] is ended with its process.
_GRACE_S = 2.0
#: Pictures that are computed for so long [s] are stopped by others.
_HURRY_S = 0.5
#: Numbers that take longer [s] are shown before the curves.
_SOON_S = 0.2
#: Without a change for so long [s] curves get all their points; until then they have a quarter of them.
_REST_S = 0.15


@attrs.frozen
class Job:
    """Scenes to compute, or a file to write of one.

    Attributes
    ----------
    number : of the change that asks for it
    scenes : panel -> number of its last change, and scene
    ranges : axis of the curves -> its ends, where these are not the scene's own
    file : "png" or "ross", to be written at ``path``; empty: a picture
    """

    number: int
    scenes: dict[int, tuple[int, Given]]
    ranges: dict[str, tuple[float, float]] = attrs.field(factory=dict)
    file: str = ""
    path: Path = Path()


@attrs.frozen
class News:
    """What the process reports: ``kind`` is "progress", "picture" (screen, bodies and rings as JSON, curves), "refused", "stopped", "file", "failed file" or "done"."""

    number: int
    panel: int
    kind: str
    content: Any = None


class Stopped(Exception):
    """The page does not want the rest."""


class Worker:
    """The process; ``on_news`` is called in a thread of its own."""

    def __init__(self, plugins: Sequence[Path], on_news: Callable[[News], None]) -> None:
        self._plugins, self._tell = list(plugins), on_news
        self._lock = threading.Lock()
        self._running: Job | None = None
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
                    threading.Timer(_HURRY_S, self._interrupt, (self._running,)).start()
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

    def _start(self) -> None:
        context = get_context("spawn")
        self._connection, far_end = context.Pipe()
        self._event = context.Event()
        self._process = context.Process(target=serve, args=(far_end, self._event, self._plugins), daemon=True)
        self._process.start()
        far_end.close()
        threading.Thread(target=self._listen, args=(self._connection,), daemon=True).start()

    def _send(self) -> None:
        """The next job."""
        self._running = self._waiting.pop(0) if self._waiting else None
        if self._running is not None:
            self._event.clear()
            with contextlib.suppress(OSError):  # of a process that has ended, which is told where it is listened to
                self._connection.send(self._running)

    def _interrupt(self, job: Job) -> None:
        """A job that still runs is not wanted."""
        with self._lock:
            if self._running is job and not self._event.is_set():
                self._event.set()
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
            if news.kind == "done":
                self._next()
        with self._lock:
            if self._closed:
                return
            last_job, self._running = self._running, None
            message = "stopped" if self._event.is_set() else "the process that computes has ended: was there memory enough?"
            connection.close()
            self._start()
        if last_job is not None:
            for panel, (number, _) in last_job.scenes.items():
                self._tell(News(number, panel, "failed file" if last_job.file else "refused", [("", message)]))
            self._tell(News(last_job.number, -1, "done"))
        self._next()

    def _next(self) -> None:
        with self._lock:
            self._send()


def serve(connection: Connection, stop: Event, plugins: Sequence[Path]) -> None:
    """Jobs from a connection until it closes: what the process runs."""
    from raceway.extend import registry_with

    with contextlib.suppress(EOFError, KeyboardInterrupt, BrokenPipeError):
        registry_with(plugins)
        from raceway_app import picture  # noqa: F401  while nobody waits

        pictures, garbage_free = _Pictures(connection, stop), False
        while True:
            job: Job = connection.recv()
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

    def __init__(self, connection: Connection, stop: Event) -> None:
        self._connection, self._stop = connection, stop
        self._shapes: dict[int, object] = {}
        self._coarse: dict[int, tuple[int, Any, Any]] = {}  # panel -> number, result and axes of curves at few points

    def refine(self) -> None:
        """Curves at all their points, until another job comes."""
        from raceway_app import picture

        def wait(_name: str) -> None:
            if self._connection.poll():
                raise Stopped

        with contextlib.suppress(Stopped):
            for panel, (number, result, axes) in list(self._coarse.items()):
                self._connection.send(News(number, panel, "picture", {"curves": picture.curves(result, axes, wait)}))
                del self._coarse[panel]

    def answer(self, job: Job, panel: int, number: int, scene_input: Given) -> None:
        """One scene; a mistake or a failure is reported, never raised."""
        last_report, refusal = time.monotonic(), "failed file" if job.file else "refused"

        def tell(kind: str, content: Any = None) -> None:
            self._connection.send(News(number, panel, kind, content))

        def progress(part: str, steps: int = 0, total: int = 0) -> None:
            nonlocal last_report
            if self._stop.is_set():
                raise Stopped
            if time.monotonic() - last_report > _SOON_S:
                last_report = time.monotonic()
                tell("progress", (part, steps, total))

        try:
            if job.file:
                from raceway.extend import default_registry
                from raceway_app import picture

                tell("file", picture.write_file(job.file, scene_input.scene(default_registry()), job.path, progress))
            else:
                self._draw(job, panel, scene_input, tell, progress)
        except Stopped:
            tell(refusal if job.file else "stopped", [("", "stopped")])
        except SceneError as error:
            tell(refusal, [(mistake.path, str(mistake)) for mistake in error.mistakes])
        except RacewayError as error:
            tell(refusal, [("", str(error))])
        except Exception as error:  # a third party's own code: the page goes on
            tell(refusal, [("", f"{type(error).__name__}: {error}"), ("", traceback.format_exc(limit=-2))])

    def _draw(
        self, job: Job, panel: int, scene_input: Given, tell: Callable[..., None], progress: Callable[..., None]
    ) -> None:
        import raceway
        from raceway.extend import default_registry, duration
        from raceway_app import picture

        scene, start = scene_input.scene(default_registry()), time.monotonic()
        if (prediction := raceway.plan(scene).predicted_wall_s) > _SOON_S:
            tell("progress", (f"planned: {duration(prediction)}", 0, 0))
        result = raceway.run(scene, progress=progress)
        state = picture.at_rest(result)
        content: Tables = {"screen": picture.result_picture(result, state)}
        shape = (scene.bearing, scene.bodies)
        try:
            bodies = picture.bodies_picture(result, state, self._shapes.get(panel) != shape)
            fixed = {name: bodies.pop(name) for name in list(bodies) if name.startswith("fixed")}
            content |= {"bodies": json.dumps(bodies), "why": ""} | ({"rings": json.dumps(fixed)} if fixed else {})
            self._shapes[panel] = shape
        except RacewayError as error:
            content |= {"bodies": "", "why": str(error)}
        if time.monotonic() - start > _SOON_S:  # else one picture with its curves: a page draws itself anew for each
            tell("picture", content)
            content = {}
        self._coarse[panel] = job.scenes[panel][0], result, (axes := picture.axes_of(scene, job.ranges))
        axes = {name: attrs.evolve(axis, count=axis.count // 4) for name, axis in axes.items()}
        tell("picture", content | {"curves": picture.curves(result, axes, lambda name: progress(f"curves over {name}"))})
