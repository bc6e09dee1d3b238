"""Ctrl-C is answered wherever it arrives."""

from __future__ import annotations

import signal
import threading
import time

import pytest

from raceway.commands.interrupt import Interrupts


class Finalized:
    def __del__(self):
        signal.raise_signal(signal.SIGINT)


def _raw_object_cache_notify():
    """Named like the compiler's callback, whose exceptions are dropped."""
    try:
        signal.raise_signal(signal.SIGINT)
    except KeyboardInterrupt:
        pytest.fail("raised where it would be forgotten")


@pytest.fixture(autouse=True)
def pythons_own_handler():
    """A shell may start a program in the background with Ctrl-C ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize("arrive", [Finalized, _raw_object_cache_notify, lambda: signal.raise_signal(signal.SIGINT)])
def test_ctrl_c_is_not_lost_in_a_callback_or_a_finalizer(arrive):
    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt), Interrupts():
        arrive()
        while time.monotonic() < begun + 10.0:
            time.sleep(0.01)
    # It is delivered again after 0.05 s; the rest is for busy cores.
    assert time.monotonic() - begun < 5.0
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


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
