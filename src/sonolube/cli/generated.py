"""Commands from tasks: arguments and options by the annotations of a task, and the delivery of its answer."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from inspect import Parameter as Argument, Signature, signature
from pathlib import Path
from typing import Annotated, Any, Literal, get_args, get_origin

import typer

from sonolube.cli.console import options
from sonolube.cli.console.delivery import deliver
from sonolube.cli.console.options import (
    AnswersFolder,
    ContinuedFolder,
    OutputFile,
    OutputFolder,
    RigPath,
    answers_folder,
    is_given,
    operator_arguments,
    progress,
)
from sonolube.errors import InvalidInput
from sonolube.execution.compilation import few_points
from sonolube.tasks.parameters import (
    DoorParameter,
    File,
    KeyValues,
    Mark,
    OwnFolder,
    Parameter,
    RigParameter,
    item_of,
    members_of,
)
from sonolube.tasks.progress import observed
from sonolube.tasks.table import Task
from sonolube.tasks.task import argument_names, marks_of
from sonolube.text.units import unit_description

_RIG_HELP = "The rig, as a TOML file or its folder."
_RIG = {"load": options.Load, "amplitude": options.Amplitude, "changes": options.Changes}
_OUT_HELP = "Folder for report, figures and data."
_KEEP_HELP = (
    "Folder for report, figures and data, and for what is computed so far, from which an interrupted run continues; a"
    " folder of its own in out by default."
)
_KEPT_HELP = "Keep finished parts here, so that an interrupted run goes on."


@dataclass(frozen=True, slots=True)
class _Input:
    """Argument of a task: its mark, how it is typed, and the arguments by which typer reads it."""

    name: str
    mark: Mark
    flag: str
    arguments: tuple[Argument, ...]

    def is_given(self, given: frozenset[str]) -> bool:
        """Whether it was typed, or cannot be left out."""
        return any(each.name in given or each.default is Argument.empty for each in self.arguments)

    def value(self, typed: Mapping[str, Any], own: Collection[str]) -> Any:
        """Value that the task takes."""
        if isinstance(self.mark, RigParameter):
            entries = {key: None if key in own else typed.get(key) for key in _RIG}
            return options.rig_of_options(typed[self.name], **entries)
        assert isinstance(self.mark, Parameter)
        return (
            _by_key(self.flag, self.mark.kind, typed[self.name])
            if isinstance(self.mark, KeyValues)
            else typed[self.name]
        )


def argument(name: str, annotation: Any, default: Any = Argument.empty) -> Argument:
    """Argument of the function that typer reads: its name, annotation for typer, and default."""
    return Argument(name, Argument.KEYWORD_ONLY, default=default, annotation=annotation)


def command_of(
    task: Task,
    *,
    more: Sequence[Argument] = (),
    complete: Callable[[dict[str, Any], Mapping[str, Any]], dict[str, Any]] | None = None,
    delivery: Callable[[Any, Mapping[str, Any]], None] | None = None,
) -> Callable[..., None]:
    """Function of a command by its task, as typer reads it.

    With the arguments of the task, those of the rig's file, and those of the delivery.
    """
    function = task.function
    marks = marks_of(function)
    inputs = [
        _input(each, marks[name], task.writes, is_required=complete is None)
        for name, each in signature(function).parameters.items()
        if not isinstance(marks[name], DoorParameter)
    ]
    names = {each.name: each.flag or each.arguments[0].name.upper() for each in inputs}
    keep = marks.get("keep")

    def run(context: typer.Context, **typed: Any) -> None:
        given = frozenset(name for name in typed if is_given(context, name))
        out = answers_folder(next((typed[each.name] for each in inputs if isinstance(each.mark, RigParameter)), None))
        with argument_names(lambda name: names.get(name, name)), observed(progress), few_points():
            arguments = {each.name: each.value(typed, names) for each in inputs if each.is_given(given)}
            if keep is not None:
                arguments["keep"] = typed["keep"] if "keep" in typed else typed["out"] or (lambda name: out / name)
            if "operator" in marks:
                arguments |= operator_arguments()
            answer = function(**(arguments if complete is None else complete(arguments, typed)))
            if delivery is not None:
                return delivery(answer, typed)
            return deliver(
                answer,
                folder=typed.get("out") or (None if task.writes_on_request else Path(task.folder or out)),
                report=typed.get("report"),
                as_json=typed["json"],
                full=typed.get("full", True),
                command=" ".join(context.command_path.split()[:2]),
            )

    own = _ordered(inputs)
    form = Signature([argument("context", typer.Context), *more, *own, *_delivery(task, marks)])
    run.__signature__ = form  # type: ignore[attr-defined]
    run.__annotations__ = {name: each.annotation for name, each in form.parameters.items()}
    run.__doc__ = task.summary
    return run


def _ordered(inputs: Sequence[_Input]) -> list[Argument]:
    """Arguments for typer, those of a rig's file last; a task's own of the same name stands in place of one."""
    every = [each for one in inputs for each in one.arguments if isinstance(one.mark, Parameter)]
    rig = [each for one in inputs for each in one.arguments if isinstance(one.mark, RigParameter)]
    taken = {each.name for each in every}
    files = [each for each in rig if each.name not in _RIG]
    return [*files, *every, *(each for each in rig if each.name in _RIG and each.name not in taken)]


def _input(given: Argument, mark: Mark, writes: str, *, is_required: bool) -> _Input:
    """Argument of a task as typer reads it."""
    name = given.name
    if isinstance(mark, RigParameter):
        flag = f"--{name}" if given.kind is Argument.KEYWORD_ONLY else ""
        about: dict[str, Any] = {"metavar": "RIG.toml", "help": _RIG_HELP}
        info = typer.Option(flag, **about) if flag else typer.Argument(**about)
        path: Any = Annotated[Path | None, info, RigPath()] if mark.is_optional else Annotated[Path, info, RigPath()]
        default = None if mark.is_optional else Argument.empty
        own = [argument(name, path, default)]
        kinds = {key: each for key, each in _RIG.items() if key not in mark.without}
        own += [argument(key, each, None) for key, each in kinds.items()]
        return _Input(name, mark, flag or "RIG.toml", tuple(own))
    assert isinstance(mark, Parameter)
    by_place = given.kind is Argument.POSITIONAL_OR_KEYWORD and not mark.option
    flag = "" if by_place else mark.option or f"--{name.replace('_', '-')}"
    kind = _typed_kind(get_args(given.annotation)[0], mark)
    default = None if isinstance(given.default, tuple | Mapping) else given.default
    if default is Argument.empty and not is_required:
        default = None
    annotation: Any = Annotated[kind | None if default is None else kind, _description(mark, flag, default, kind)]
    if isinstance(mark, OwnFolder):
        annotation = Annotated[annotation, OutputFolder(writes) if writes else ContinuedFolder()]
    return _Input(name, mark, flag.partition(" ")[0], (argument(name, annotation, default),))


def _typed_kind(kind: Any, mark: Parameter) -> Any:
    """Type that typer reads for an argument of a type."""
    if isinstance(mark, KeyValues):
        return list[str]
    if (item := item_of(kind)) is not None:
        each = _typed_kind(item, mark)
        words = get_args(each) if get_origin(each) is Literal else ()  # which typer does not take several of
        return list[StrEnum("Choice", {word: word for word in words}) if words else each]  # type: ignore[misc]
    if isinstance(mark, File | OwnFolder):
        return Path
    return str if mark.unit is not None else members_of(kind)[0]


def _description(mark: Parameter, flag: str, default: Any, kind: Any) -> Any:
    """Description of an argument for typer."""
    limits: dict[str, Any] = (
        {"min": mark.lowest, "max": mark.highest} if kind in (int, float, list[int], list[float]) else {}
    )
    shared: dict[str, Any] = {"help": mark.help, "metavar": _metavar(mark)} | limits
    if not flag:
        return typer.Argument(**shared)
    return typer.Option(*([f"{flag}/--no-{flag[2:]}"] if default is True else flag.split()), **shared)


def _metavar(mark: Parameter) -> str | None:
    """Placeholder of a value in the help; the kind of quantity where nothing is given, such as FORCE."""
    if mark.kind or not mark.unit:
        return mark.kind or ("KEY=VALUE" if isinstance(mark, KeyValues) else None)
    return unit_description(mark.unit).partition(",")[0].partition(" ")[2].upper()


def _delivery(task: Task, marks: Mapping[str, Mark]) -> list[Argument]:
    """Arguments of the delivery: folders of what is kept and of the files, page and JSON."""
    arguments, keep = [], marks.get("keep")
    keeps = isinstance(keep, DoorParameter) and not keep.files
    if isinstance(keep, DoorParameter) and keep.files:
        option = typer.Option(metavar="FOLDER", help=_KEPT_HELP)
        own: Any = Annotated[Path | None, option, OutputFolder(keep.files)]
        arguments.append(argument("keep", own, None))
    if task.writes and "out" not in marks:
        about = typer.Option(help=_KEEP_HELP if keeps else _OUT_HELP)
        folder: Any = Annotated[Path | None, about, AnswersFolder(task.writes)]
        default = None if keeps or task.folder or task.writes_on_request else options.OUT
        arguments.append(argument("out", folder, default))
    if task.has_report:
        info = typer.Option(metavar="PAGE.html", help="Self-contained page to write.")
        page: Any = Annotated[Path | None, info, OutputFile()]
        arguments.append(argument("report", page, None))
    if any(isinstance(mark, RigParameter) for mark in marks.values()):
        arguments.append(argument("full", options.Full, False))
    return [*arguments, argument("json", options.Json, False)]


def _by_key(flag: str, form: str, entries: Sequence[str]) -> dict[str, str]:
    """Values of entries KEY=VALUE by key."""
    values: dict[str, str] = {}
    for entry in entries:
        key, equals, value = (part.strip() for part in entry.partition("="))
        if not (key and equals and value):
            raise InvalidInput(f"{flag} {entry!r} must look like {form or 'KEY=VALUE'}")
        if key in values:
            raise InvalidInput(f"{flag} {key} was given twice")
        values[key] = value
    return values
