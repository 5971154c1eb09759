"""Ctrl-C and SIGTERM: let a march end its step, and a file its writing."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

Handler = Callable[[int, FrameType | None], None]


class HeldSignals:
    """Whether a signal came while signals are held."""

    def __init__(self) -> None:
        self._received = False

    def receive(self, number: int, frame: FrameType | None) -> None:
        """Remember a signal; this is the handler."""
        self._received = True

    def heed(self) -> None:
        """Interrupt at a place where that does no harm.

        Raises
        ------
        KeyboardInterrupt
            If a signal came.
        """
        if self._received:
            raise KeyboardInterrupt


@contextmanager
def held_signals() -> Iterator[HeldSignals]:
    """Hold Ctrl-C and SIGTERM back until the ``with`` block is done, then interrupt.

    A library that calls back into Python (HDF5) does not survive a KeyboardInterrupt there, and
    files that belong together must not be parted by one. An error inside the block goes first.

    Raises
    ------
    KeyboardInterrupt
        After the block, if a signal came.
    """
    held = HeldSignals()
    with _handled_by(held.receive):
        yield held
    held.heed()


@contextmanager
def stopped_by_signals(stop: Callable[[], None]) -> Iterator[None]:
    """Let Ctrl-C and SIGTERM call ``stop`` instead of interrupting in mid-step.

    A second signal interrupts at once.
    """

    def handle(number: int, frame: FrameType | None) -> None:
        stop()
        signal.signal(number, signal.default_int_handler)

    with _handled_by(handle):
        yield


@contextmanager
def _handled_by(handler: Handler) -> Iterator[None]:
    """Give both signals a handler; not outside the main thread, where Python handles none."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before: dict[signal.Signals, Any] = {}
    try:
        for number in (signal.SIGINT, signal.SIGTERM):
            before[number] = signal.signal(number, handler)
        yield
    finally:
        for number, earlier in before.items():
            # a handler that was not set from Python cannot be set from it either
            signal.signal(number, signal.SIG_DFL if earlier is None else earlier)
