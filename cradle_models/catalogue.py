"""The models shipped as files: their names, how they are made, where they lie."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

from cradle_models.blocks import dominoes, rocking_block
from cradle_models.errors import UnknownModelError
from cradle_models.free import two_string
from cradle_models.pendulums import row
from cradle_models.sensor import force_sensor
from cradle_models.spheres import bernoulli, cannon, spinning_balls
from cradle_models.table import billiards

#: The eight three-ball patterns of Dondo and Noborio, table 2, in their order.
PAPER_PATTERNS = ("AAA", "AAB", "ABA", "ABB", "BAA", "BAB", "BBA", "BBB")

FOLDER = Path(__file__).resolve().parent


def _makers() -> dict[str, Callable[[], str]]:
    """Return the function that makes each shipped model."""
    makers: dict[str, Callable[[], str]] = {}
    for count in (3, 5, 10):
        makers[f"row_{count}"] = partial(row, "A" * count)
    for pattern in PAPER_PATTERNS:
        name = f"paper_{pattern.lower()}"
        makers[name] = partial(row, pattern, name=name)
    for count in (3, 5):
        makers[f"two_string_{count}"] = partial(two_string, "A" * count)
    makers["force_sensor"] = force_sensor
    makers["billiards"] = billiards
    makers["spinning_balls"] = spinning_balls
    makers["dominoes"] = dominoes
    makers["rocking_block"] = rocking_block
    makers["cannon"] = cannon
    for count in (2, 4):
        makers[f"bernoulli_{count}"] = partial(bernoulli, count)
    return makers


def list_models() -> tuple[str, ...]:
    """Return the names of the shipped models."""
    return tuple(_makers())


def model_path(name: str) -> Path:
    """Return the MJCF file of a shipped model.

    Args:
        name: One of `list_models()`, such as ``row_5``.

    Raises:
        UnknownModelError: No shipped model has this name (also a KeyError).
    """
    if name not in list_models():
        raise UnknownModelError(
            f"no shipped model is named {name!r}; available: "
            f"{', '.join(list_models())} (cradle_models.row() makes any other row)"
        )
    return FOLDER / f"{name}.xml"


def make_model(name: str) -> str:
    """Return the MJCF text of a shipped model, made anew rather than read.

    Raises:
        UnknownModelError: No shipped model has this name (also a KeyError).
    """
    model_path(name)
    return _makers()[name]()


def write_models(folder: Path = FOLDER) -> tuple[Path, ...]:
    """Write all shipped models into `folder` and return their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = tuple(folder / model_path(name).name for name in list_models())
    for name, path in zip(list_models(), paths, strict=True):
        path.write_text(make_model(name), encoding="utf-8")
    return paths
