"""Prints the requirements of a pyproject.toml, extras included, one a line.

    requirements.py PYPROJECT [GROUP]    with GROUP, those of that dependency group

Used by `scripts/setup`, which installs the project against a MuJoCo of its own choice
and so cannot let pip read them, and by scripts that install a group of their own.
"""

import sys
from pathlib import Path

if sys.version_info >= (3, 11):
    import tomllib
else:
    from pip._vendor import tomli as tomllib


def requirements(text: str, group: str | None = None) -> list[str]:
    """Returns run-time requirements and those of all extras, or those of one group."""
    settings = tomllib.loads(text)
    if group is not None:
        return list(settings["dependency-groups"][group])
    project = settings["project"]
    extras = project["optional-dependencies"].values()
    return project["dependencies"] + [line for extra in extras for line in extra]


if __name__ == "__main__":
    pyproject, *chosen = sys.argv[1:]
    print("\n".join(requirements(Path(pyproject).read_text(encoding="utf-8"), *chosen)))
