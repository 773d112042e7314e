"""The target of the console script and of `python -m mujoco_impact`."""

from __future__ import annotations

import sys


def main() -> None:
    """Runs the command line; says so if the packages it needs are missing."""
    try:
        from mujoco_impact.cli import app
    except ModuleNotFoundError as error:
        if error.name not in ("typer", "rich"):
            raise
        sys.stderr.write(
            f"mujoco-impact: the command line needs {error.name}: "
            "run `pip install mujoco-impact[cli]`\n"
        )
        raise SystemExit(2) from error
    app()


if __name__ == "__main__":
    main()
