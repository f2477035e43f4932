"""Options, checked outputs, questions and progress of the terminal.

Options are those of rigs, figures and JSON. Outputs are checked before anything is computed. Progress is a bar with
stage and time left, plain lines where standard error is no terminal.
"""

import os
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from functools import wraps
from glob import escape
from pathlib import Path
from threading import Event, Thread
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar, get_type_hints

import typer

from sonolube.errors import InvalidInput, SonolubeError
from sonolube.operating_system import TypedLines
from sonolube.storage.files import expect_file, expect_files
from sonolube.storage.user_files import command_files, record_input
from sonolube.tasks.parameters import with_entries
from sonolube.text.plain_text import printable
from sonolube.text.units import to_si

if TYPE_CHECKING:
    from rich.progress import Task

    from sonolube.facts.protocol import Prompt
    from sonolube.laboratory import RunControl
    from sonolube.rig import Rig


AmplitudeSource = Literal["measured", "computed", "waveguide", "per-volt"]
FigureStyleName = Literal["journal", "slides"]

Changes = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Replace an entry, such as sliding.sliding_speed=87mm/s."),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object, all quantities in SI.")]
Full = Annotated[bool, typer.Option("--full", help="Print all of the answer in place of a first screen.")]
Load = Annotated[str | None, typer.Option(metavar="FORCE", help="Normal load instead of the rig's, such as 40N.")]
Amplitude = Annotated[
    AmplitudeSource | None,
    typer.Option(
        "--amplitude",
        metavar="measured|computed|waveguide|per-volt",
        help="Source of the amplitude; by default measured, else computed from stack and structure, else waveguide, "
        "else per volt.",
    ),
]
Style = Annotated[
    FigureStyleName,
    typer.Option("--style", help="Sizes of figures: for the columns of a journal (85 and 174 mm), or for slides."),
]
OUT = Path("out")


def rig_of_options(
    path: Path | None,
    *,
    load: str | None = None,
    changes: list[str] | None = None,
    amplitude: AmplitudeSource | None = None,
) -> "Rig | None":
    """Rig of a file with entries replaced, `--load` and `--amplitude` among them; None where no file is named."""
    if path is None:
        for option, value in {"--set": changes, "--amplitude": amplitude, "--load": load}.items():
            if value:
                raise InvalidInput(f"{option} needs a rig; name its file, such as examples/rigs/tribometer.toml")
        return None
    if load is not None:
        to_si(load, unit="N", name="--load")
    return with_entries(path, load=load, amplitude=amplitude, changes=changes or ())


_Mark = TypeVar("_Mark")


@dataclass(frozen=True, slots=True)
class OutputFile:
    """Marks, in the annotation of an argument, the path of a file that the command writes."""

    def expect(self, path: Path, stems: Mapping[str, str]) -> None:
        """Raise InvalidInput if the file cannot be written."""
        expect_file(path)


@dataclass(frozen=True, slots=True)
class OutputFolder:
    """Marks, in the annotation of an argument, the folder in which the command writes files.

    Parameters
    ----------
    names : str
        Names of the files with spaces between, * for what is not known before the computation; an argument in braces
        stands for its name without folder and ending, as in "{rig}-response.*".
    """

    names: str = ""

    def expect(self, path: Path, stems: Mapping[str, str]) -> None:
        """Raise InvalidInput if files of these names cannot be written in the folder."""
        expect_files(path, tuple(name.format_map(stems) for name in self.names.split()))


@dataclass(frozen=True, slots=True)
class AnswersFolder(OutputFolder):
    """Marks the folder of the files of an answer, which is that of the rig's folder where none is typed."""


@dataclass(frozen=True, slots=True)
class RigPath:
    """Marks, in the annotation of an argument, the file or the folder of a rig."""


@dataclass(frozen=True, slots=True)
class ContinuedFolder:
    """Marks, in the annotation of an argument, a folder of records that the command completes where they are."""


def with_checked_files(command: Callable[..., None]) -> Callable[..., None]:
    """Command that refuses outputs which cannot be written, or are its inputs, before it computes.

    With the same arguments.
    """

    @wraps(command)
    def run(**arguments: Any) -> None:
        arguments |= _folders_of_rig(command, arguments)
        with command_files():
            marks, continued = output_marks(command), _marked(command, ContinuedFolder)
            for name, value in arguments.items():
                if name not in marks and name not in continued:
                    for path in _paths(value):
                        record_input(path)
            stems = {name: _stem(value) for name, value in arguments.items()}
            for name, mark in marks.items():
                if arguments[name] is not None:
                    mark.expect(arguments[name], stems)
            command(**arguments)

    return run


def answers_folder(rig: Path | None) -> Path:
    """Folder of the files of an answer where none is typed: that in the folder of a rig, or the usual one."""
    if rig is None or not rig.is_dir():
        return OUT
    from sonolube.rig.file.rig_folder import ANSWERS

    return rig / ANSWERS


def _folders_of_rig(command: Callable[..., None], arguments: Mapping[str, Any]) -> dict[str, Path]:
    """Folders of answers that were not typed, and lie in that of the rig."""
    rigs = [arguments[name] for name in _marked(command, RigPath)]
    untyped = [
        name
        for name in (_marked(command, AnswersFolder) if rigs else ())
        if arguments[name] == OUT and not is_given(arguments["context"], name)
    ]
    return {name: answers_folder(rigs[0]) for name in untyped}


def is_given(context: typer.Context, name: str) -> bool:
    """Whether an argument was typed."""
    return getattr(context.get_parameter_source(name), "name", "DEFAULT") != "DEFAULT"


def output_marks(command: Callable[..., None]) -> dict[str, OutputFile | OutputFolder]:
    """Marks of the arguments of a command that are outputs."""
    return _marked(command, OutputFile) | _marked(command, OutputFolder)


def _marked(command: Callable[..., None], kind: type[_Mark]) -> dict[str, _Mark]:
    """Marks of a kind by the arguments of a command that have one."""
    hints = get_type_hints(command, include_extras=True)
    return {
        name: mark
        for name, hint in hints.items()
        for mark in getattr(hint, "__metadata__", ())
        if isinstance(mark, kind)
    }


def _paths(value: Any) -> Iterator[Path]:
    """Paths of the value of an argument; texts only where they name a file."""
    for each in value if isinstance(value, list | tuple) else [value]:
        if isinstance(each, Path):
            yield each
        elif isinstance(each, str) and Path(each).suffix:
            yield Path(each)


def _stem(value: Any) -> str:
    """Name of a file, or of a choice, in a pattern."""
    path = Path(str(value))
    return escape(path.resolve().name if isinstance(value, Path) and path.is_dir() else path.stem)


_POLL = 0.1  # s, between two looks at requests to end while an operator is asked


def is_terminal() -> bool:
    """Whether somebody can answer questions."""
    return sys.stdin.isatty() and sys.stderr.isatty()


def ask(option: str, text: str, default: str, read: Callable[[str], object]) -> str:
    """Answer to a question for what an option gives, asked again until it can be read.

    An empty line stands for the default.
    """
    while True:
        typer.echo(f"{text} [{default}]: ", nl=False, err=True)
        line = sys.stdin.readline()
        if not line:
            typer.echo(err=True)
            raise InvalidInput(f"the input ended at {option}; nothing is written")
        answer = line.strip() or default
        try:
            read(answer)
        except SonolubeError as refusal:
            typer.echo(f"  {printable(' '.join(str(refusal).split()))}", err=True)
        else:
            return answer


def operator_arguments() -> dict[str, Any]:
    """Arguments of a run by which a person at the terminal confirms its prompts; none where nobody can."""
    if not is_terminal():
        return {}
    from sonolube.laboratory import RunControl

    control = RunControl()
    return {"control": control, "operator": Operator(control)}


@dataclass(frozen=True, slots=True)
class Operator:
    """Person at the terminal who confirms prompts; requests to end the run are heard meanwhile.

    Parameters
    ----------
    control : RunControl
    """

    control: "RunControl"

    def __call__(self, prompt: "Prompt") -> bool:
        """Show a prompt, and return whether it is confirmed by an empty line or by yes."""
        sys.stderr.write(printable(f"\r\x1b[K{prompt.task}: {prompt.text}\n  done? [Y/n] "))
        sys.stderr.flush()
        lines = TypedLines()
        while not self.control.stop_reason:
            answer = lines.next(_POLL)
            if answer is not None:
                if not answer:
                    self.control.stop("the input has ended")
                return bool(answer) and answer.strip().lower() in ("", "y", "yes")
        return False


Advance = Callable[[str, int, int], None]

SHORT = 2.0
"""Time of work that is not reported where standard error is no terminal. [s]"""
_BETWEEN_LINES = 10.0  # s


def progress(title: str) -> AbstractContextManager[Advance]:
    """Report the progress of the work inside a `with` block.

    Called with what is done now, the number done and their total.
    """
    is_terminal = sys.stderr.isatty() and os.environ.get("TERM") != "dumb"
    return _bar(title) if is_terminal else _lines(title)


def time_left(elapsed: float, done: int, total: int | None) -> str:
    """Time left in words if the rest goes on at the same pace, such as "about 12 s left"; empty while unknown."""
    if not total or not 0 < done <= total:
        return ""
    left = elapsed * (total - done) / done
    return f"about {left:.0f} s left" if left < 90 else f"about {left / 60:.0f} min left"


@contextmanager
def _bar(title: str) -> Iterator[Advance]:
    """Draw a bar with stage, count, time gone and time left; without a count while the total is unknown."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, ProgressColumn, TextColumn, TimeElapsedColumn
    from rich.text import Text

    class Count(ProgressColumn):
        def render(self, task: "Task") -> Text:
            if not task.total:
                return Text("")
            done = int(task.completed)
            left = time_left(task.elapsed or 0.0, done, int(task.total))
            return Text(f"{done}/{int(task.total)}  {left}".rstrip())

    columns = (TextColumn("{task.description}", markup=False), BarColumn(), TimeElapsedColumn(), Count())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(title, total=None)
        yield lambda what, done, total: bar.update(
            task, description=printable(f"{title}: {what}"), completed=done, total=total or None
        )


@contextmanager
def _lines(title: str) -> Iterator[Advance]:
    """Print a line after the first seconds and then every few, from a thread, until the work is done."""
    start, ended = time.monotonic(), Event()
    state: list[tuple[str, int, int]] = [("", 0, 0)]

    def print_lines() -> None:
        wait = SHORT
        while not ended.wait(wait):
            what, done, total = state[0]
            gone = time.monotonic() - start
            parts = [f"{done} of {total}" if total else "", f"{gone:.0f} s", time_left(gone, done, total)]
            stage = f"{title}: {what}" if what else title
            sys.stderr.write(printable(f"{stage} ({', '.join(filter(None, parts))})") + "\n")
            wait = _BETWEEN_LINES

    def advance(what: str, done: int, total: int) -> None:
        state[0] = (what, done, total)

    thread = Thread(target=print_lines, daemon=True)
    thread.start()
    try:
        yield advance
    finally:
        ended.set()
        thread.join()
