"""Doing something to a library as soon as it is there, whichever is imported first.

The library is not imported for this: where it comes later, what runs its module does
it after it.
"""

from __future__ import annotations

import importlib.abc
import importlib.util
import sys
from collections.abc import Callable, Sequence
from importlib.machinery import ModuleSpec
from types import ModuleType

Action = Callable[[ModuleType], object]


def when_imported(name: str, action: Action) -> None:
    """Calls action(module) now, or once the module has been imported.

    Args:
        name: Full name of the module, such as "mujoco.mjx".
        action: What is done, once.
    """
    if name in sys.modules:
        action(sys.modules[name])
    else:
        sys.meta_path.insert(0, _Finder(name, action))


class _Finder(importlib.abc.MetaPathFinder):
    """Finds one module as the others do, and acts once it has run."""

    def __init__(self, name: str, action: Action) -> None:
        """Starts as not asked."""
        self._name = name
        self._action = action
        self._asking = False

    def find_spec(
        self,
        fullname: str,
        path: Sequence[str] | None = None,  # noqa: ARG002
        target: ModuleType | None = None,  # noqa: ARG002
    ) -> ModuleSpec | None:
        """Returns where the module is; None for anything else."""
        if fullname != self._name or self._asking:
            return None
        self._asking = True
        try:
            spec = importlib.util.find_spec(fullname)
        finally:
            self._asking = False
        if spec is None or spec.loader is None:
            return None
        run = spec.loader.exec_module

        def run_and_act(module: ModuleType) -> None:
            run(module)
            if self in sys.meta_path:
                sys.meta_path.remove(self)
            self._action(module)

        spec.loader.exec_module = run_and_act  # type: ignore[method-assign]
        return spec
