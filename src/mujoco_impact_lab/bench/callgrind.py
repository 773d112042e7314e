"""Instructions of a function of a program, counted by valgrind's callgrind."""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from pathlib import Path

from mujoco_impact.errors import ImpactError


class InstructionsError(ImpactError):
    """Valgrind is missing or the workload failed."""


def count_in(program: Path, function: str, *arguments: str) -> tuple[int, int]:
    """Returns the instructions in a function of a program, and the steps it prints.

    Args:
        program: What to run.
        function: Pattern of the name of the function, which counts with what it calls.
        *arguments: Of the program.

    Raises:
        InstructionsError: If valgrind is missing or the program failed.
    """
    valgrind = shutil.which("valgrind")
    if valgrind is None:
        msg = "instruction counts need valgrind: install it (apt install valgrind)"
        raise InstructionsError(msg)
    with tempfile.TemporaryDirectory() as folder:
        command = [
            valgrind,
            "--tool=callgrind",
            f"--toggle-collect={function}",
            f"--callgrind-out-file={folder}/callgrind.out",
            str(program),
            *arguments,
        ]
        ran = subprocess.run(command, capture_output=True, text=True, check=False)
    if ran.returncode:
        msg = f"{program.name} failed under valgrind: {ran.stderr.strip()[-300:]}"
        raise InstructionsError(msg)
    instructions = _number(r"Collected\s*:\s*(\d+)", ran.stderr)
    return instructions, _number(r"steps (\d+)", ran.stdout)


def _number(pattern: str, text: str) -> int:
    """Returns the number that a pattern finds in a text."""
    found = re.search(pattern, text)
    if found is None:
        msg = f"no match of {pattern!r} in the output {text.strip()[-300:]!r}"
        raise InstructionsError(msg)
    return int(found.group(1))
