"""Ctrl-C, SIGTERM and SIGHUP are answered wherever they arrive, in one line, and leave no process behind."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path

import click
import pytest

from checks.validation.command_line import MINIMAL, PATIENCE_S, python
from checks.validation.scenes import built_in
from checks.validation.sessions import left
from raceway import Answer, Command
from raceway.cli.interrupt import Interrupts, farewell
from raceway.extend import Interrupted
from raceway.plugins.executors import WATCH, deaf_to_terminals

Processes = built_in("executor", "processes")

CODES = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGHUP: 129}


class Finalized:
    def __del__(self):
        signal.raise_signal(signal.SIGINT)


def _raw_object_cache_notify():
    """Named like the compiler's callback, whose exceptions are dropped."""
    try:
        signal.raise_signal(signal.SIGINT)
    except KeyboardInterrupt:
        pytest.fail("raised where it would be forgotten")


#: What frees a lock of an import, by the file and the name that Python gives it.
_OF_AN_IMPORT = "def cb():\n    signal.raise_signal(signal.SIGINT)\n"


def _lock_of_an_import():
    found = {"signal": signal}
    exec(compile(_OF_AN_IMPORT, "<frozen importlib._bootstrap>", "exec"), found)
    try:
        found["cb"]()
    except KeyboardInterrupt:
        pytest.fail("raised where it would be forgotten")


@pytest.fixture(autouse=True)
def pythons_own_handlers():
    """A shell, or ``nohup``, may start a program with signals ignored; libraries leave handlers of their own."""
    before = {number: signal.signal(number, signal.SIG_DFL) for number in CODES}
    signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    for number, handler in before.items():
        signal.signal(number, signal.SIG_DFL if handler is None else handler)


@pytest.mark.parametrize(
    "arrive", [Finalized, _raw_object_cache_notify, _lock_of_an_import, lambda: signal.raise_signal(signal.SIGINT)]
)
def test_ctrl_c_is_not_lost_in_a_callback_or_a_finalizer(arrive):
    with pytest.raises(KeyboardInterrupt), Interrupts():
        arrive()
        for _ in range(6000):  # it is delivered again after 0.05 s: a guard against a signal that is lost
            time.sleep(0.01)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


@pytest.mark.parametrize("number", CODES)
def test_an_interruption_that_a_library_swallows_is_raised_again(number):
    with pytest.raises(KeyboardInterrupt), Interrupts():
        with suppress(BaseException):
            signal.raise_signal(number)
        for _ in range(6000):
            time.sleep(0.01)


def test_an_interruption_that_is_being_answered_is_not_raised_again():
    steps = []
    with pytest.raises(KeyboardInterrupt), Interrupts():
        try:
            signal.raise_signal(signal.SIGTERM)
        finally:
            try:
                raise ValueError("in between")
            except ValueError:
                time.sleep(1.3)  # it is looked for twice meanwhile
                steps.append("in order")
    assert steps == ["in order"]


class Slow(Answer):
    """What is finished, which takes longer to show than an interruption is looked for."""

    stem = "slow"

    def report(self):
        time.sleep(0.8)
        yield "finished"


def interrupted_front() -> Answer:
    """Stopped on its way."""
    try:
        signal.raise_signal(signal.SIGTERM)
    except KeyboardInterrupt as stop:
        raise Interrupted(Slow()) from stop


def test_what_is_finished_is_shown_in_peace_after_an_interruption(capsys):
    command = Command("slow", interrupted_front, "", "raceway slow", folder=None, pictures=None).click()
    with pytest.raises(click.Abort), Interrupts():
        command.main([], standalone_mode=False)
    assert "finished" in capsys.readouterr().out


def test_a_handler_of_the_caller_and_other_threads_are_left_alone():
    seen = []
    before = signal.signal(signal.SIGINT, lambda *_: seen.append(1))
    try:
        with Interrupts():
            signal.raise_signal(signal.SIGINT)
    finally:
        signal.signal(signal.SIGINT, before)
    assert seen == [1]

    def inside():
        with Interrupts():
            seen.append(2)

    thread = threading.Thread(target=inside)
    thread.start()
    thread.join()
    assert seen == [1, 2]


@pytest.mark.parametrize("number", CODES)
def test_each_signal_is_told_once_and_has_its_code(number):
    said = []
    with pytest.raises(KeyboardInterrupt), Interrupts():
        signal.raise_signal(number)
    assert farewell(said.append) == farewell(said.append) == CODES[number]
    assert len(said) == 1 and ("Ctrl-C" if number == signal.SIGINT else number.name) in said[0]


def test_a_supervisor_that_asks_twice_does_not_break_what_is_put_in_order():
    steps = []
    with pytest.raises(KeyboardInterrupt), Interrupts():
        try:
            signal.raise_signal(signal.SIGTERM)
        finally:
            signal.raise_signal(signal.SIGTERM)
            signal.raise_signal(signal.SIGHUP)
            steps.append("in order")
    assert steps == ["in order"]


def test_nohup_is_respected():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with Interrupts():
            signal.raise_signal(signal.SIGHUP)
    finally:
        signal.signal(signal.SIGHUP, before)


WORKER = """
import os, subprocess, sys, time
child = "import os, sys, time; from raceway.plugins.executors import end_with; end_with(int(sys.argv[1])); time.sleep(1000)"
print(subprocess.Popen([sys.executable, "-c", child, str(os.getpid())]).pid, flush=True)
time.sleep(1000)
"""


def test_a_worker_ends_with_the_process_that_it_works_for():
    parent = subprocess.Popen([sys.executable, "-c", WORKER], stdout=subprocess.PIPE, text=True, start_new_session=True)
    worker = int(parent.stdout.readline())
    parent.kill()
    parent.wait()
    parent.stdout.close()
    found = left(parent.pid, 30.0)
    if found:
        os.kill(worker, signal.SIGKILL)
    assert not found


def threads(_points):
    return [thread.name for thread in threading.enumerate()]


def test_workers_watch_their_parent_from_the_start():
    assert all(WATCH in names for _, names in Processes(workers=1).compute(threads, [(0, []), (1, [])]))


class Deaf:
    """Work that tells the signals that its worker does not hear."""

    def __call__(self, points):
        return [int(number) for number in signal.pthread_sigmask(signal.SIG_BLOCK, ())]

    def fault(self):
        return None


@pytest.mark.slow
@pytest.mark.parametrize("name", ["processes", "dask"])
def test_workers_do_not_hear_a_terminal_from_their_start(name):
    """In a process of its own: what clears up behind the first worker is started with it."""
    code = f"""
from raceway.framework.loading.registry import default_registry
from tests.test_interrupt import Deaf
if __name__ == "__main__":
    executor = default_registry().find("executor", "{name}").plugin(workers=2)
    print([found for _, found in executor.compute(Deaf(), [(number, []) for number in range(4)])])
"""
    found = python("-c", code)
    assert found.returncode == 0, found.stderr
    heard = [{signal.SIGINT, signal.SIGHUP} - set(mask) for mask in json.loads(found.stdout)]
    assert heard == 4 * [set()]


def blocked(process: int) -> set[int]:
    """Signals that a process does not hear."""
    mask = int(Path(f"/proc/{process}/status").read_text().partition("SigBlk:")[2].split()[0], 16)
    return {number for number in (signal.SIGINT, signal.SIGHUP, signal.SIGTERM) if mask >> (number - 1) & 1}


def test_what_is_started_deaf_to_terminals_stays_so_and_nothing_is_lost():
    seen = []
    before = signal.signal(signal.SIGHUP, lambda number, _: seen.append(number))
    try:
        with deaf_to_terminals():
            child = subprocess.Popen(["sleep", "1000"])
            signal.raise_signal(signal.SIGHUP)
            assert not seen
        assert seen == [signal.SIGHUP] and not blocked(os.getpid())
        assert blocked(child.pid) == {signal.SIGINT, signal.SIGHUP}
        child.terminate()
        assert child.wait(PATIENCE_S) == -signal.SIGTERM
    finally:
        signal.signal(signal.SIGHUP, before)


def test_what_clears_up_behind_workers_outlives_a_closed_terminal():
    """It would be started again, with a traceback for everything that it is told of and does not know."""
    from joblib.externals.loky.backend.resource_tracker import _resource_tracker

    list(Processes(workers=1).compute(threads, [(0, [])]))
    assert signal.SIGHUP in blocked(_resource_tracker._pid)


def test_ctrl_c_ends_with_130_and_one_line(tmp_path):
    long = ("--set", "integrator.turns=100", "--set", "integrator.steps_per_turn=3600000")
    words = [sys.executable, "-m", "raceway", "run", MINIMAL, *long, "--out", str(tmp_path / "out")]

    def listen() -> None:  # a background job of a shell has its children ignore the signal
        signal.signal(signal.SIGINT, signal.default_int_handler)

    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(words, preexec_fn=listen, **streams) as process:
        time.sleep(2.5)  # past the imports, inside the 360 million steps
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=PATIENCE_S)
    # While a compiled module is being imported (a busy machine gets no further in that time) Python ends by the signal
    # itself after the same message; a shell reports both as 130.
    assert process.returncode in (130, -signal.SIGINT)
    assert out == ""
    assert err.strip() == "stopped by Ctrl-C; no file is left half-written"
    assert not (tmp_path / "out").exists()


#: A signal while the commands are imported.
LOADING = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell may start a program in the background without
class Interrupted:
    def __getattr__(self, attribute):
        if attribute == "main":
            signal.raise_signal(signal.{name})
sys.modules["raceway.cli.main"] = Interrupted()
from raceway.__main__ import main
main()
"""


@pytest.mark.parametrize(("name", "code", "words"), [("SIGINT", 130, "Ctrl-C"), ("SIGTERM", 143, "SIGTERM")])
def test_a_signal_before_the_commands_are_loaded(name, code, words):
    found = python("-c", LOADING.format(name=name))
    assert found.returncode == code
    assert found.stderr == f"stopped by {words}; no file is left half-written\n"
