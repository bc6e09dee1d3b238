"""Commands that are asked to end at random moments, by each of three signals."""

import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import attrs

from checks.robustness import Row, below
from checks.validation.command_line import SMALL_ARTICLE
from checks.validation.sessions import left
from checks.validation.sweeps import SCENE, rows_of

CODES = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGHUP: 129}
_PATIENCE_S = 5.0
_COUNT, _SEED = 100, 17
_SWEEP = ("sweep", str(SCENE), "--set", "integrator.kind=periodic", "--grid", "excitation.speed_rpm=10980:15000:160")
_AXES = ("--vary", "excitation.kind=unidirectional,bidirectional", "--vary", "load.axial=400:1200:4")
COMMANDS = {
    "run": ("run", str(SCENE), "--pictures"), "sweep, serial": _SWEEP,
    "sweep, processes": (*_SWEEP, "--executor", "processes"), "sweep, dask": (*_SWEEP, "--executor", "dask"),
    "view": ("view", str(SCENE), "--html"), "compare": ("compare", str(SCENE), *_AXES),
    "study": ("study", "article", *SMALL_ARTICLE, "--processes", "2"),
}  # fmt: skip


@attrs.frozen
class Ended:
    """How a process ended.

    number : signal that was sent;  after_s : so long after its handler was there;  lived : whether it was still at work
    lines : of standard error;  left : processes of its session after 5 s
    """

    command: str
    out: Path
    number: int
    after_s: float
    lived: bool
    code: int
    lines: list[str]
    left: int

    @property
    def told(self) -> bool:
        """One line that says what stopped it; a second one says how much is done, or where a comparison or a study goes on."""
        word = "Ctrl-C" if self.number == signal.SIGINT else signal.Signals(self.number).name
        stopped = [line for line in self.lines if line.startswith(f"stopped by {word}")]
        rest = [line for line in self.lines if line not in stopped]
        return (
            len(stopped) == 1
            and len(rest) <= self.command.startswith(("sweep", "compare", "study"))
            and "Traceback" not in str(self.lines)
        )


def started(words: tuple[str, ...], out: Path) -> subprocess.Popen[bytes]:
    """A command in a session of its own, with Python's own Ctrl-C: what a shell starts in the background ignores it."""
    return subprocess.Popen(
        [sys.executable, "-m", "raceway", *words, "--out", str(out)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
        start_new_session=True,
        preexec_fn=partial(signal.signal, signal.SIGINT, signal.SIG_DFL),
    )  # fmt: skip


def handled(process: subprocess.Popen[bytes]) -> None:
    """Wait until the program answers SIGTERM: what arrives while the interpreter itself starts is the interpreter's."""
    bit = 1 << (signal.SIGTERM - 1)
    while process.poll() is None:
        status = Path(f"/proc/{process.pid}/status").read_text(encoding="ascii")
        if int(status.partition("SigCgt:")[2].split()[0], 16) & bit:
            return
        time.sleep(0.002)


def ended(command: str, out: Path, number: int, after_s: float, to_group: bool) -> Ended:
    """Send a signal to a process, or as a terminal does to its whole group, and see how it ends."""
    process = started(COMMANDS[command], out)
    handled(process)
    time.sleep(after_s)
    lived = process.poll() is None
    if lived:
        (os.killpg if to_group else os.kill)(process.pid, number)
    error = process.communicate(timeout=120.0)[1].decode(errors="replace")
    there = left(process.pid, _PATIENCE_S)
    return Ended(command, out, number, after_s, lived, process.returncode, error.splitlines(), len(there))


def whole(folder: Path) -> dict[str, tuple[float, Any]]:
    """Seconds from the handlers to the end, and what is kept, of each command undisturbed."""
    found = {}
    for command, words in COMMANDS.items():
        for _ in range(2):  # the first one fills the caches
            out = folder / command
            shutil.rmtree(out, ignore_errors=True)
            process = started(words, out)
            handled(process)
            begin = time.monotonic()
            process.communicate()
            seconds = time.monotonic() - begin
        if process.returncode:
            raise RuntimeError(f"{command} ended with code {process.returncode}")
        found[command] = seconds, kept(command, out)
    return found


def kept(command: str, out: Path) -> Any:
    """What a command keeps that has to be equal: rows of a sweep after it was gone on with, of a comparison, numbers of a run."""
    if command.startswith("sweep"):
        return rows_of(out)
    if command == "compare":
        rows = json.loads((out / "compare.json").read_text())["rows"] if (out / "compare.json").is_file() else []
        return [(row["point"], row["result"]["identification"]) for row in rows]
    return json.loads((out / "result.json").read_text())["identification"] if (out / "result.json").is_file() else None


def resumed(end: Ended, wanted: Any) -> bool:
    """Whether a sweep goes on to the same rows, and what the others kept is whole and the same."""
    if end.command.startswith("sweep"):
        from click.testing import CliRunner

        from raceway.cli.main import main as command

        done = CliRunner().invoke(command, [*_SWEEP, "--out", str(end.out), "--resume"])
        same = done.exit_code == 0 and kept(end.command, end.out) == wanted
        if not same:
            print(done.output, file=sys.stderr)
        return same
    try:
        found = kept(end.command, end.out)
    except ValueError:  # half a file
        return False
    if any(not path.read_bytes().rstrip().endswith(b"IEND\xaeB`\x82") for path in end.out.rglob("*.png")):
        return False
    return bool(found == wanted[: len(found)]) if end.command == "compare" else found in (None, wanted)


def rows() -> list[Row]:
    """Signals at random moments of each command's life, two commands at a time; those that had ended before are not counted."""
    # Another number of threads rounds a matrix product otherwise: the same as the commands have.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        undisturbed = whole(folder)

        def one(k: int) -> Ended:
            chance = random.Random(1000 * _SEED + k)
            command, number = list(COMMANDS)[k % len(COMMANDS)], list(CODES)[k // len(COMMANDS) % len(CODES)]
            for again in range(50):
                after = chance.uniform(0.0, undisturbed[command][0])
                end = ended(command, folder / f"{k}-{again}", number, after, chance.random() < 0.5)
                if end.lived:
                    return end
            raise RuntimeError(f"{command} always ends before its signal")

        with ThreadPoolExecutor(2) as pool:
            found = list(pool.map(one, range(_COUNT)))
        equal = [resumed(end, undisturbed[end.command][1]) for end in found]
        for end, same in zip(found, equal, strict=True):
            if not (same and end.told and end.code == CODES[end.number] and not end.left):
                print(end, same, file=sys.stderr)
    took = ", ".join(f"{name} {seconds:.2f} s" for name, (seconds, _) in undisturbed.items())
    note = f"SIGINT, SIGTERM, SIGHUP to the process or its group, at a moment drawn from the whole life: {took}"

    def every(words: str, good: Iterable[bool], note: str = "") -> Row:
        count = sum(good)
        return Row(words, f"{count} of {_COUNT}", "all", count == _COUNT, note)

    return [
        every("commands that end with the signal's exit code, 130, 143 or 129", (e.code == CODES[e.number] for e in found), note),
        every("one line that says what stopped it, no traceback", (e.told for e in found), "a sweep's second line says how much is done"),
        every("resumed to the same rows; files of the others whole and the same", equal),
        below("processes left 5 s after a signal", sum(e.left for e in found), 0),
    ]  # fmt: skip
