"""Notebooks in a real Jupyter kernel: one picture a plot, tables for answers, progress, and those that are shipped."""

from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from nbclient import NotebookClient
from notebooks import cells_of, jupyter

NOTEBOOK: Any = import_module("nbformat")  # which has no types
ROOT = Path(__file__).parents[1]
NOTEBOOKS = sorted((ROOT / "examples" / "notebooks").glob("*.py"))

pytestmark = pytest.mark.slow


def executed(cells: list[str], *, folder: Path) -> list[list[Any]]:
    """Outputs of cells, run one after the other in a fresh kernel."""
    notebook = NOTEBOOK.v4.new_notebook(cells=[NOTEBOOK.v4.new_code_cell(cell) for cell in cells])
    NotebookClient(notebook, timeout=None, kernel_name="python3", resources={"metadata": {"path": folder}}).execute()
    return [list(cell.outputs) for cell in notebook.cells]


def pictures(outputs: list[Any]) -> int:
    """Number of pictures among the outputs of a cell."""
    return sum("image/png" in output.get("data", {}) for output in outputs)


@pytest.mark.parametrize("inline", [False, True])
def test_each_plot_of_a_fresh_kernel_is_one_picture(inline: bool) -> None:
    first = "import sonolube as sl\nrig = sl.read_rig('tribometer.toml')"
    cells = [
        first + ("\n%matplotlib inline" if inline else ""),
        "sl.plot(sl.simulate(rig))",
        "swept = sl.sweep(rig, over={'drive.voltage_peak_to_peak': '10V:20V:3'})\nsl.plot(swept)",
        "swept.plot(style='slides')",
        "sl.friction(rig)",
    ]
    outputs = executed(cells, folder=ROOT / "examples" / "rigs")
    assert [pictures(each) for each in outputs] == [0, 1, 1, 1, 0]
    assert "<table>" in outputs[-1][0]["data"]["text/html"]


def test_progress_is_one_line_that_disappears() -> None:
    cell = (
        "from sonolube.tasks import progress\n"
        "progress._SHORT = progress._BETWEEN = 0.0\n"
        "import sonolube as sl\n"
        "sl.sweep('tribometer.toml', over={'sliding.sliding_speed': '10mm/s:50mm/s:3'}, chunk=1);"
    )
    (outputs,) = executed([cell], folder=ROOT / "examples" / "rigs")
    shown = [each["data"]["text/html"] for each in outputs if "text/html" in each.get("data", {})]
    assert shown == [""]


@pytest.mark.parametrize("script", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_shipped_notebook_prints_and_shows_each_figure_once(script: Path) -> None:
    file = script.with_suffix(".ipynb")
    assert file.read_text(encoding="utf-8") == jupyter(cells_of(script)), "run python docs/_ext/notebooks.py"
    notebook = NOTEBOOK.read(file, as_version=4)
    NotebookClient(
        notebook, timeout=None, kernel_name="python3", resources={"metadata": {"path": script.parent}}
    ).execute()
    for cell in notebook.cells:
        if cell.cell_type == "code":
            draws = cell.source.strip().splitlines()[-1].startswith(("sl.plot(", "shown_in_notebooks("))
            assert pictures(cell.outputs) == draws, cell.source
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    assert pictures(outputs)
    assert any(output.output_type == "stream" or "text/plain" in output.get("data", {}) for output in outputs)
