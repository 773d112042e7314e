"""Prints the requirements of a pyproject.toml, extras included, one a line.

    requirements.py PYPROJECT [EXTRA]    with EXTRA, only those of that extra

Used by `scripts/setup`, which installs the project against a MuJoCo of its own choice
and so cannot let pip read them.
"""

import sys
from pathlib import Path

if sys.version_info >= (3, 11):
    import tomllib
else:
    from pip._vendor import tomli as tomllib


def requirements(text: str, extra: str | None = None) -> list[str]:
    """Returns run-time requirements and those of all extras, or those of one extra."""
    project = tomllib.loads(text)["project"]
    extras = project.get("optional-dependencies", {})
    if extra is not None:
        return list(extras[extra])
    wanted = [extra for extra in extras if extra not in OPTIONAL]
    return project["dependencies"] + [
        line for extra in wanted for line in extras[extra]
    ]


OPTIONAL = ("docs", "peers")
"""Extras that no test needs."""

if __name__ == "__main__":
    pyproject, *chosen = sys.argv[1:]
    print("\n".join(requirements(Path(pyproject).read_text(encoding="utf-8"), *chosen)))
