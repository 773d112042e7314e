"""Tables of a report."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from html import escape

from rich.table import Table
from rich.text import Text

from mujoco_impact.text import printable


def html_table(
    headings: Sequence[str],
    rows: Iterable[Sequence[str]],
    *,
    caption: str = "",
    left: Sequence[bool] = (),
    bold: Sequence[bool] = (),
) -> str:
    """Returns a table of text.

    Args:
        headings: Of the columns.
        rows: The cells of each row.
        caption: Text above.
        left: Which columns hold words instead of numbers; the first by default.
        bold: Which rows stand out.
    """
    words = left or [column == 0 for column in range(len(headings))]
    kinds = ['class="text"' if word else "" for word in words]
    head = _cells("th", headings, kinds)
    body = []
    for number, row in enumerate(rows):
        mark = ' class="ours"' if number < len(bold) and bold[number] else ""
        body.append(f"<tr{mark}>{_cells('td', row, kinds)}</tr>")
    above = f"<caption>{_text(caption)}</caption>" if caption else ""
    return (
        f'<div class="wide"><table>{above}<thead><tr>{head}</tr></thead>'
        f"<tbody>{''.join(body)}</tbody></table></div>"
    )


def of_terminal(table: Table) -> str:
    """Returns a table of the terminal."""
    columns = [[_plain(cell) for cell in column.cells] for column in table.columns]
    return html_table(
        [_plain(column.header) for column in table.columns],
        list(zip(*columns, strict=True)),
        caption=_plain(table.title or ""),
        left=[column.justify == "left" for column in table.columns],
        bold=["bold" in str(row.style or "") for row in table.rows],
    )


def _cells(tag: str, cells: Sequence[str], kinds: Sequence[str]) -> str:
    """Returns the cells of one row."""
    return "".join(
        f"<{tag} {kind}>{_text(cell)}</{tag}>"
        for cell, kind in zip(cells, kinds, strict=True)
    )


def _text(text: str) -> str:
    """Returns text as HTML; what stands between backticks is code."""
    lines = "\n".join(printable(line) for line in text.split("\n"))
    return re.sub(r"`([^`]+)`", r"<code>\1</code>", escape(lines))


def _plain(cell: object) -> str:
    """Returns the text of a cell of the terminal."""
    return cell.plain if isinstance(cell, Text) else str(cell)
