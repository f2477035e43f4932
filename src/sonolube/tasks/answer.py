"""Answer of a task in every form in which it is shown: blocks of text, JSON, dataset, figures, files and page."""

import json
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias, TypeVar, dataclass_transform

from sonolube.errors import InvalidInput, UnknownName
from sonolube.report.blocks import (
    Block as Block,
    Rows as Rows,
    ScreenBlock as ScreenBlock,
    Table as Table,
    Verbatim as Verbatim,
    block_html,
    text_lines as text_lines,
)
from sonolube.report.first_screen import LongAnswer
from sonolube.report.results.record_object import scalar_dataset
from sonolube.vocabulary import si as si

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure
    from pandas import DataFrame

    from sonolube.report import Drawing, Page
    from sonolube.rig import Rig
    from sonolube.rig.datasets import LabelledArrays
    from sonolube.tasks.parameters import Call
    from sonolube.tasks.progress import Advance

    Content: TypeAlias = str | bytes | xr.Dataset | LabelledArrays | Path

Dataset: TypeAlias = "xr.Dataset"
"""Labelled dataset, by a name that needs no import of xarray."""

_Answer = TypeVar("_Answer")


class Answer(ABC):
    """Result of a task; a task has one final class of it, made by `answer`.

    `blocks` and `object` are required; the others are empty unless overridden. None of them prints or writes.
    """

    is_lookup: ClassVar[bool] = False
    """Whether `object` is complete in itself: a table of facts, without caveats, assumptions or files."""

    rig: "Rig | None" = None
    """Rig that the result is of."""

    folder: "Path | None" = None
    """Folder of files that exist already, beside which the others belong; None where they may lie anywhere."""

    call: "Call | None" = None
    """Task and the arguments given, by which anybody gets the same answer."""

    @abstractmethod
    def blocks(self) -> Sequence[Block]:
        """Content for people, without caveats and assumptions; its first line says what the result is of."""

    @abstractmethod
    def object(self) -> dict[str, Any]:
        """Object for JSON, all quantities in SI, without caveats and assumptions."""

    def first_blocks(self) -> Sequence[ScreenBlock]:
        """Content of a first screen, what matters most first, where `blocks` is longer than a screen."""
        return self.blocks()

    def caveats(self) -> Sequence[str]:
        """Reasons for which the result may not hold, a line each."""
        return ()

    def leading_caveats(self) -> Sequence[str]:
        """Caveats that stand above the result, below its first line, because they question all of it."""
        return ()

    def assumptions(self) -> Mapping[str, str]:
        """Values for which there is no source, by what was assumed, each with its reason: those of the rig file."""
        return {} if self.rig is None else self.rig.assumptions

    def figures(self) -> "Mapping[str, Drawing]":
        """Figures by name, the first of which shows the result best."""
        return {}

    def files(self) -> "Mapping[str, Content]":
        """Content of further files by name; datasets become netCDF, a path is a file that exists already."""
        return {}

    def page(self) -> "Page | None":
        """Content of a page that shows the figures with settings, facts and tables; None for tasks without one."""
        return None

    def report(self, advance: "Advance") -> str | None:
        """Self-contained page that is written on request; None for tasks without one."""
        return None

    def keeps(self, name: str, present: str) -> bool:
        """Whether the present text of a file of this name would be a loss, so that it is not replaced."""
        return False

    def refusals(self) -> Mapping[str, str]:
        """Reason for each of several inputs that could not be answered, while others were."""
        return {}

    @property
    def has_result(self) -> bool:
        """Whether anything was answered, where `refusals` are not empty."""
        return True

    @property
    def is_failure(self) -> bool:
        """Whether a result says that something failed or is missing."""
        return False

    @property
    def exit_code(self) -> int:
        """Exit code of a program that has shown it: 1 where something failed."""
        return int(self.is_failure)

    def every_caveat(self) -> list[str]:
        """Caveats, those first that stand above the result."""
        return [*self.leading_caveats(), *self.caveats()]

    def every_block(self) -> list[Block]:
        """Content with caveats and assumptions, as all ways in show it."""
        first, *rest = self.blocks() or [""]
        return [
            *([first] if first else []),
            *(f"  caveat: {caveat}" for caveat in self.leading_caveats()),
            *rest,
            *(f"  caveat: {caveat}" for caveat in self.caveats()),
            *(f"  assumed {key}: {reason}" for key, reason in self.assumptions().items()),
        ]

    def full_lines(self, *, line_length: int | None) -> list[str]:
        """Lines of text of all content."""
        return text_lines(self.every_block(), line_length=line_length)

    def first_screen(self, files: Sequence[str] = ()) -> LongAnswer:
        """What a first screen shows in place of all content, with lines on the files that were written."""
        return LongAnswer(
            blocks=self.first_blocks(),
            leading_caveats=self.leading_caveats(),
            caveats=self.caveats(),
            assumptions=self.assumptions(),
            files=files,
        )

    def json_object(self) -> dict[str, Any]:
        """Object for JSON with caveats and assumptions."""
        if self.is_lookup:
            return self.object()
        return self.object() | {"caveats": self.every_caveat(), "assumptions": dict(self.assumptions())}

    def to_json(self) -> str:
        """Answer as a JSON text, all quantities in SI."""
        return json.dumps(self.json_object(), indent=2, allow_nan=False)

    def dataset(self) -> "xr.Dataset":
        """Result as a labelled dataset, with units, caveats and assumptions."""
        import xarray as xr

        found = next((each for name, each in self.files().items() if name.endswith(".nc")), None)
        if isinstance(found, Path):
            found = xr.load_dataset(found)
        elif found is None:
            found = scalar_dataset(self.object())
        labelled = found if isinstance(found, xr.Dataset) else found.dataset()  # type: ignore[union-attr]
        return labelled.assign_attrs(self.notes())

    def notes(self) -> dict[str, str]:
        """Caveats and assumptions as attributes of a dataset."""
        assumed = "\n".join(f"{key}: {reason}" for key, reason in self.assumptions().items())
        return {"caveats": "\n".join(self.every_caveat()), "assumptions": assumed}

    def to_pandas(self) -> "DataFrame":
        """Table of the answer as a terminal prints it: its first table, else its names and values.

        Columns whose cells are all numbers, or empty, are numbers. All tables are in `dataset`.

        Returns
        -------
        pandas.DataFrame

        Raises
        ------
        InvalidInput
            If the answer prints no table.
        """
        from pandas import DataFrame

        shown = self.every_block()
        table = next((each for each in shown if isinstance(each, Table)), None)
        if table is None:
            named = next((each for each in shown if isinstance(each, Rows)), None)
            if named is None:
                raise InvalidInput(f"{self.text().splitlines()[0]}: this answer prints no table")
            table = Table(("name", "value"), [row[:2] for row in named.rows])
        columns = [[row[place] if place < len(row) else "" for row in table.rows] for place in range(len(table.heads))]
        frame = DataFrame({place: _numbers_or_texts(cells) for place, cells in enumerate(columns)})
        return frame.set_axis(list(table.heads), axis="columns")

    def to_netcdf(self, path: str | Path) -> Path:
        """Write the dataset as a netCDF file, whole or not at all."""
        from sonolube.rig import write_netcdf

        return write_netcdf(self.dataset(), path=Path(path))

    def __getitem__(self, name: str) -> "xr.DataArray":
        """Variable of the dataset."""
        return self.dataset()[name]

    def plot(self, title: str | None = None, *, style: str | None = None) -> "Figure":
        """Draw a figure of the answer.

        Parameters
        ----------
        title : str, optional
            Name of a figure, or its end, such as "axial 1"; the first figure where absent.
        style : str, optional
            Key of `sonolube.figure.FIGURE_STYLES`: "journal" or "slides".

        Returns
        -------
        matplotlib.figure.Figure

        Raises
        ------
        InvalidInput
            If the answer has no figure.
        UnknownName
            If it has none of that title.
        """
        from sonolube.figure import figure_style, shown_in_notebooks

        drawings = self.figures()
        if not drawings:
            raise InvalidInput(f"{self.text().splitlines()[0]}: this answer has nothing that could be drawn")
        names = [name for name in drawings if title is None or _plain(name).endswith(_plain(title))]
        if not names:
            raise UnknownName.among(drawings, kind="figure", name=title or "")
        with figure_style(style):
            return shown_in_notebooks(drawings[names[0]].figure())

    def text(self, *, line_length: int | None = 80) -> str:
        """Answer as text, as a terminal prints it; not wrapped where the length is None."""
        return "\n".join(text_lines(self._shown(), line_length=line_length))

    def __str__(self) -> str:
        return self.text()

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        """Tables for notebooks."""
        return "".join(map(block_html, self._shown()))

    def _shown(self) -> list[Block]:
        """Content as Python shows it: with the reasons of refused inputs, which a terminal prints apart."""
        return [*self.every_block(), *(f"  refused: {reason}" for reason in self.refusals().values())]


@dataclass_transform(kw_only_default=True, frozen_default=True, eq_default=False)
def answer(kind: type[_Answer]) -> type[_Answer]:
    """Class of answers as a frozen dataclass that prints as the terminal does."""
    return dataclass(frozen=True, kw_only=True, repr=False, eq=False)(kind)


@answer
class Listing(Answer):
    """Table of facts.

    Parameters
    ----------
    parts : sequence of Block
        For people.
    content : dict
        For JSON.
    labelled : callable, optional
        Returns the same as a dataset; the quantities and texts of the content where absent.
    """

    is_lookup: ClassVar[bool] = True

    parts: Sequence[Block]
    content: dict[str, Any]
    labelled: "Callable[[], Dataset] | None" = None

    def blocks(self) -> Sequence[Block]:
        """Blocks as given."""
        return self.parts

    def object(self) -> dict[str, Any]:
        """Object as given."""
        return self.content

    def dataset(self) -> Dataset:
        """Table as a labelled dataset, with units."""
        return super().dataset() if self.labelled is None else self.labelled()


def _numbers_or_texts(cells: Sequence[str]) -> Sequence[float] | Sequence[str]:
    """Numbers of cells, NaN where one is empty; the cells where one is a text."""
    try:
        return [float(cell) if cell.strip() else float("nan") for cell in cells]
    except ValueError:
        return cells


def _plain(name: str) -> str:
    """Name of a figure for comparison."""
    return name.casefold().replace(" ", "-")
