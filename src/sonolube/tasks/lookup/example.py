"""Task `example`: example files that come with sonolube, to run the examples of help texts and to be changed."""

from collections.abc import Mapping, Sequence
from functools import cache
from typing import Annotated, Any

from sonolube.example_files import ExampleFile, example_file, example_files, without_schema
from sonolube.tasks.answer import Answer, Block, Dataset, Rows, Verbatim, answer
from sonolube.tasks.parameters import Parameter
from sonolube.tasks.table import TASKS
from sonolube.tasks.task import task

_ALL = "all"


@task
def example(
    name: Annotated[
        str | None, Parameter("File to write, such as tribometer, or all; the list by default.", "EXAMPLE")
    ] = None,
) -> "ExampleAnswer":
    """Example files, such as rigs: list them, or write one with its path in the help texts below the current folder.

    Example: sonolube example tribometer

    Examples
    --------
    >>> import sonolube as sl
    >>> answer = sl.example("tribometer")
    >>> list(answer.files())
    ['examples/rigs/tribometer.toml']
    """
    known = example_files()
    if name is None or name == _ALL:
        return ExampleAnswer(examples=tuple(known.values()), is_written=name is not None)
    return ExampleAnswer(examples=(example_file(name),), is_written=True)


@answer
class ExampleAnswer(Answer):
    """Example files by name, path and title, and their contents."""

    examples: tuple[ExampleFile, ...]
    is_written: bool

    def blocks(self) -> Sequence[Block]:
        """Names and titles; of a single example the commands that use it."""
        if len(self.examples) == 1:
            shown = self.examples[0]
            return [f"{shown.name}: {shown.title}", *(Verbatim(f"  try: {command}") for command in _commands(shown))]
        rigs, others = (
            Rows([(each.name, each.title) for each in self.examples if each.is_rig == is_rig])
            for is_rig in (True, False)
        )
        return ["Rigs among the example files, by name", rigs, "Other example files", others]

    def object(self) -> dict[str, Any]:
        """Name, path, title and uses of each example."""
        return {
            "examples": [
                {"name": each.name, "path": each.path, "title": each.title, "commands": _commands(each)}
                for each in self.examples
            ]
        }

    def files(self) -> Mapping[str, str]:
        """Content of the examples that were named, and of the files that belong to them."""
        if not self.is_written:
            return {}
        return {each.path: each.text for one in self.examples for each in (one, *one.companions())}

    def keeps(self, name: str, present: str) -> bool:
        """Whether a file was changed since it was written; the line that names a schema is no change."""
        return without_schema(present) != self.files().get(name)

    def dataset(self) -> Dataset:
        """Paths and titles by name."""
        import xarray as xr

        columns = {"path": [each.path for each in self.examples], "title": [each.title for each in self.examples]}
        return xr.Dataset(
            {name: ("example", texts) for name, texts in columns.items()},
            coords={"example": [each.name for each in self.examples]},
        )


def _commands(shown: ExampleFile) -> list[str]:
    """Commands of help texts that use a file, or the command that runs a script."""
    if shown.is_script:
        return [f"python {shown.path}"]
    return [command for command in _examples() if shown.path in command.split()]


@cache
def _examples() -> tuple[str, ...]:
    """Examples of all help texts."""
    return tuple(each.summary.partition("Example: ")[2].strip() for each in TASKS)
