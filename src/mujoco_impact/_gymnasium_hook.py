"""Making the environments known to gymnasium, whichever is imported first.

gymnasium has no entry points for environments. It is not imported for this: where it
comes later, what runs its module registers them after it.
"""

from __future__ import annotations

import importlib
import importlib.abc
import importlib.util
import sys
from collections.abc import Sequence
from importlib.machinery import ModuleSpec
from types import ModuleType

_LIBRARY = "gymnasium"


def register_when_imported() -> None:
    """Registers the environments now, or once gymnasium has been imported."""
    if _LIBRARY in sys.modules:
        _register()
    elif not any(isinstance(finder, _Finder) for finder in sys.meta_path):
        sys.meta_path.insert(0, _Finder())


def _register() -> None:
    importlib.import_module("mujoco_impact.envs")


class _Finder(importlib.abc.MetaPathFinder):
    """Finds gymnasium as the others do, and registers once it has run."""

    def __init__(self) -> None:
        """Starts as not asked."""
        self._asking = False

    def find_spec(
        self,
        fullname: str,
        path: Sequence[str] | None = None,  # noqa: ARG002
        target: ModuleType | None = None,  # noqa: ARG002
    ) -> ModuleSpec | None:
        """Returns where gymnasium is; None for anything else."""
        if fullname != _LIBRARY or self._asking:
            return None
        self._asking = True
        try:
            spec = importlib.util.find_spec(fullname)
        finally:
            self._asking = False
        if spec is None or spec.loader is None:
            return None
        run = spec.loader.exec_module

        def run_and_register(module: ModuleType) -> None:
            run(module)
            if self in sys.meta_path:
                sys.meta_path.remove(self)
            _register()

        spec.loader.exec_module = run_and_register  # type: ignore[method-assign]
        return spec
