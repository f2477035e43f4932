"""Notebooks: scripts in percent format, executed cell by cell, as Markdown with their output and as Jupyter files."""

import ast
import io
import json
import re
import warnings
from contextlib import chdir, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from matplotlib import pyplot as plt
from matplotlib.figure import Figure
from pictures import image, kept, write

_CELL = re.compile(r"^# %%(.*)$", re.MULTILINE)


@dataclass(frozen=True)
class Cell:
    """Text of one cell, without its comment signs where it is Markdown."""

    text: str
    is_markdown: bool


def cells_of(script: Path) -> list[Cell]:
    """Return the cells of a notebook in percent format."""
    _, *parts = _CELL.split(script.read_text(encoding="utf-8"))
    cells = []
    for kind, text in zip(parts[::2], parts[1::2], strict=True):
        is_markdown = kind.strip() == "[markdown]"
        shown = re.sub(r"^# ?", "", text, flags=re.MULTILINE) if is_markdown else text
        cells.append(Cell(shown.strip(), is_markdown))
    return cells


def executed(script: Path) -> list[tuple[Cell, str, list[Figure]]]:
    """Run a notebook in its folder and return each cell with what it printed and its figures."""
    space: dict[str, Any] = {"__name__": "notebook"}
    with chdir(script.parent), warnings.catch_warnings():
        warnings.simplefilter("error")
        return [(cell, *_run(cell, space)) for cell in cells_of(script)]


def _run(cell: Cell, space: dict[str, Any]) -> tuple[str, list[Figure]]:
    """Execute a cell; a figure in its last line is shown, as Jupyter does."""
    if cell.is_markdown:
        return "", []
    tree, last = ast.parse(cell.text), None
    if tree.body and isinstance(tree.body[-1], ast.Expr):
        last = ast.Expression(tree.body.pop().value)  # type: ignore[attr-defined]
    printed = io.StringIO()
    with redirect_stdout(printed):
        exec(compile(tree, "cell", "exec"), space)
        value = eval(compile(last, "cell", "eval"), space) if last else None
        if value is not None and not isinstance(value, Figure):
            printed.write(f"{value}\n")
    figures = [value] if isinstance(value, Figure) else [plt.figure(number) for number in plt.get_fignums()]
    plt.close("all")
    return printed.getvalue().rstrip(), figures


def markdown_of(script: Path) -> tuple[str, Path]:
    """Return a notebook as Markdown, with `{folder}` where its pictures lie, and that folder."""
    folder, text = kept(script, lambda folder: _written(script, folder))
    return str(text), folder


def _written(script: Path, folder: Path) -> str:
    """Execute a notebook, write pictures and Jupyter file, and return its Markdown."""
    blocks, pictures = [], 0
    for cell, printed, figures in executed(script):
        blocks.append(cell.text if cell.is_markdown else f"```python\n{cell.text}\n```")
        if printed:
            blocks.append(f":::{{container}} output\n```text\n{printed}\n```\n:::")
        for figure in figures:
            pictures += 1
            name = f"{script.stem}-{pictures}.png"
            write(figure, folder / name)
            blocks.append(image("Figure of the cell above", f"{{folder}}/{name}"))
    (folder / f"{script.stem}.ipynb").write_text(jupyter(cells_of(script)), encoding="utf-8")
    return "\n\n".join(blocks)


def jupyter(cells: list[Cell]) -> str:
    """Return cells as a Jupyter file (nbformat 4.4), without output."""
    content: list[dict[str, Any]] = [
        {"cell_type": "markdown", "metadata": {}, "source": cell.text}
        if cell.is_markdown
        else {"cell_type": "code", "metadata": {}, "source": cell.text, "outputs": [], "execution_count": None}
        for cell in cells
    ]
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    return json.dumps(
        {"nbformat": 4, "nbformat_minor": 4, "metadata": {"kernelspec": kernel}, "cells": content}, indent=1
    )


def write_all(folder: Path) -> None:
    """Write every notebook of a folder as a Jupyter file beside its script."""
    for script in sorted(folder.glob("*.py")):
        script.with_suffix(".ipynb").write_text(jupyter(cells_of(script)), encoding="utf-8")


if __name__ == "__main__":
    write_all(Path(__file__).parents[2] / "examples" / "notebooks")
