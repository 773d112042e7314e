"""Reading text that others wrote, within bounds, and writing files whole or not at all.

What is read may be anything: another encoding, a device without end, a file that was
made to use up memory.
"""

from __future__ import annotations

import contextlib
import errno
import os
import secrets
import shutil
from collections.abc import Iterator
from pathlib import Path

from mujoco_impact.errors import ImpactError

LARGEST_TEXT = 16_000_000
"""Most bytes that are read of a file of shots or parameters; measured shots of three
balls take 400 bytes each."""

LONGEST_QUOTE = 60
"""Most characters that a message quotes of a file."""


def read_text(
    path: str | os.PathLike[str],
    *,
    what: str,
    error: type[ImpactError],
    limit: int = LARGEST_TEXT,
) -> str:
    """Returns the text of a file in UTF-8, without a byte order mark.

    Args:
        path: File to read.
        what: What it should hold, for the message.
        error: What to raise.
        limit: Most bytes that it may have.

    Raises:
        ImpactError: Of the kind `error`, if the file cannot be read, is larger than
            the limit or in another encoding.
    """
    try:
        with Path(path).open("rb") as file:
            content = file.read(limit + 1)
        if len(content) > limit:
            raise ValueError(f"it is larger than {limit / 1e6:g} MB")
        return content.decode("utf-8-sig")
    except (OSError, ValueError) as caught:
        msg = f"cannot read {what} from {os.fspath(path)}: {reason_of(caught)}"
        raise error(msg) from caught


def reason_of(error: OSError | ValueError) -> str:
    """Returns why a file cannot be read."""
    if isinstance(error, UnicodeDecodeError):
        line = error.object[: error.start].count(b"\n") + 1
        return f"it is not UTF-8: byte 0x{error.object[error.start]:02x} in line {line}"
    return getattr(error, "strerror", None) or str(error)


@contextlib.contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yields a file to write, which takes the place of `path` once it is complete.

    If writing fails, `path` stays as it was. What is not a file, such as /dev/stdout,
    is written itself.

    Args:
        path: The file to replace or to make.

    Raises:
        OSError: If it cannot be written; names `path`.
    """
    target = Path(os.path.realpath(path))
    if target.is_dir():
        raise _error(errno.EISDIR, path)
    if target.exists() and not target.is_file():
        yield Path(path)
        return
    if target.exists() and not os.access(target, os.W_OK):
        raise _error(errno.EACCES, path)
    # the ending says what is written to functions that go by it
    part = target.with_name(f".{secrets.token_hex(6)}{target.suffix}")
    try:
        yield part
        if target.exists():
            shutil.copymode(target, part)
        part.replace(target)
    except OSError as error:
        if error.errno is None:
            raise
        raise _error(error.errno, path) from error
    finally:
        with contextlib.suppress(OSError):
            part.unlink()


def check_writable(path: str | os.PathLike[str]) -> None:
    """Raises OSError if `replacing` could not write a file, before there is anything.

    Args:
        path: The file to replace or to make.
    """
    target = Path(os.path.realpath(path))
    if target.is_dir():
        raise _error(errno.EISDIR, path)
    if target.exists() and not target.is_file():
        return
    if not target.parent.is_dir():
        raise _error(errno.ENOENT, path)
    place = target if target.exists() else target.parent
    if not os.access(place, os.W_OK):
        raise _error(errno.EACCES, path)


def _error(number: int, path: str | os.PathLike[str]) -> OSError:
    """Returns the error of a number of the system for a path."""
    return OSError(number, os.strerror(number), os.fspath(path))


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Writes a file in UTF-8, or leaves it as it was; OSError if that cannot be."""
    with replacing(path) as part:
        part.write_text(text, encoding="utf-8")


def quoted(value: object, *, longest: int = LONGEST_QUOTE) -> str:
    """Returns a value as a message quotes it: on one line, and not too long."""
    text = repr(value)
    return text if len(text) <= longest else f"{text[: longest - 3]}..."
