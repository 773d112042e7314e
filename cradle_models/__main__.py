"""``python -m cradle_models [FOLDER]``: write the shipped models anew."""

import sys
from pathlib import Path

from cradle_models.catalogue import FOLDER, write_models


def main(arguments: list[str]) -> int:
    """Write the models into the folder given, or into this package."""
    if len(arguments) > 1 or arguments[:1] in (["-h"], ["--help"]):
        sys.stderr.write(f"{__doc__}\n")
        return 0 if len(arguments) == 1 else 2
    folder = Path(arguments[0]) if arguments else FOLDER
    for path in write_models(folder):
        sys.stdout.write(f"{path}\n")
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
