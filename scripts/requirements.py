"""Prints the requirements of a pyproject.toml, extras included, one a line.

Used by `scripts/setup`, which installs the project against a MuJoCo of its own choice
and so cannot let pip read them.
"""

import sys
from pathlib import Path

if sys.version_info >= (3, 11):
    import tomllib
else:
    from pip._vendor import tomli as tomllib


def requirements(text: str) -> list[str]:
    """Returns run-time requirements and those of all extras."""
    project = tomllib.loads(text)["project"]
    extras = project.get("optional-dependencies", {})
    # dm_control and peers are heavy: only the tests that need them install them
    wanted = [extra for extra in extras if extra not in OPTIONAL]
    return project["dependencies"] + [
        line for extra in wanted for line in extras[extra]
    ]


OPTIONAL = ("peers",)

if __name__ == "__main__":
    print("\n".join(requirements(Path(sys.argv[1]).read_text(encoding="utf-8"))))
