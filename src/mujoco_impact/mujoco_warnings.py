"""MuJoCo's warnings, collected for those whose simulation gave them."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterator

import mujoco


class _Collectors:
    """The one warning handler that MuJoCo has in a process, shared by threads."""

    def __init__(self) -> None:
        """Starts with nobody who collects."""
        self._lock = threading.RLock()
        self._lists: dict[int, list[list[str]]] = {}
        self._previous: Callable[[str], None] | None = None

    def add(self, messages: list[str]) -> None:
        """Has the warnings of this thread written to a list."""
        with self._lock:
            if not self._lists:
                self._previous = mujoco.get_mju_user_warning()
                mujoco.set_mju_user_warning(self._collect)
            self._lists.setdefault(threading.get_ident(), []).append(messages)

    def remove(self) -> None:
        """Takes away the last list of this thread."""
        with self._lock:
            thread = threading.get_ident()
            self._lists[thread].pop()
            if not self._lists[thread]:
                del self._lists[thread]
            if not self._lists:
                mujoco.set_mju_user_warning(self._previous)

    def _collect(self, message: str) -> None:
        """Writes a warning to the list of its thread.

        A thread that nobody collects for is one of MuJoCo's own, which step for some
        thread of Python: all that collect are told.
        """
        with self._lock:
            own = self._lists.get(threading.get_ident())
            for lists in [own] if own else self._lists.values():
                lists[-1].append(message)


_collectors = _Collectors()


@contextlib.contextmanager
def collected_warnings() -> Iterator[list[str]]:
    """Collects MuJoCo's warnings instead of writing them to MUJOCO_LOG.TXT.

    Those of simulations that other threads of Python run meanwhile are not among them,
    unless they are run by threads of MuJoCo (`mujoco.rollout`) or collected by nobody.
    """
    messages: list[str] = []
    _collectors.add(messages)
    try:
        yield messages
    finally:
        _collectors.remove()
