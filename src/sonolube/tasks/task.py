"""A task: a function with annotated arguments that returns one answer, and the call that it answers."""

from collections.abc import Callable, Iterable, Mapping
from contextlib import AbstractContextManager, nullcontext
from contextvars import ContextVar
from functools import update_wrapper
from inspect import BoundArguments, Parameter as Argument, Signature, cleandoc, signature
from math import inf, isfinite
from typing import Any, Generic, ParamSpec, TypeVar, get_args, get_type_hints, overload

from sonolube.errors import InvalidInput, SonolubeError
from sonolube.tasks.answer import Answer
from sonolube.tasks.boundary import coercion, is_of_caller
from sonolube.tasks.faults import refused_by_system, tidy, unexpected
from sonolube.tasks.files import private_files
from sonolube.tasks.parameters import Call, File, Mark, Number, Parameter, RigEntry, RigParameter, with_entries
from sonolube.tasks.progress import cell_progress, is_in_notebook, observed, watched, within
from sonolube.tasks.table import split_examples
from sonolube.text.units import temperature_difference_to_si, to_si

P = ParamSpec("P")
A = TypeVar("A", bound=Answer)
_RIG = "The rig, or the path of its file."
_DOORS = {
    "load": "Normal load in place of the rig's, in N or as a text such as '40 N'.",
    "amplitude": "Source of the amplitude in place of the rig's: measured, computed, waveguide or per-volt.",
    "changes": "Entries of the rig to replace, such as 'sliding.sliding_speed=87mm/s'.",
    "progress": "Called with the stage, the number done and their total.",
    "cancelled": "Asked at every report of progress whether to stop; then the task raises TaskCancelled.",
    "keep": "Folder for what is computed so far, from which an interrupted task continues.",
    "operator": "Called with each prompt to the operator; returns whether it is done.",
    "control": "Takes requests of other threads to stop, pause and resume.",
    "watcher": "Shown set points, blocks and events of the run, as `sonolube.laboratory.RunWatcher`.",
}


_CALL: ContextVar[Call | None] = ContextVar("call", default=None)
_NAMES: ContextVar[Callable[[str], str]] = ContextVar("names", default=str)


def marks_of(function: Callable[..., Any]) -> dict[str, Mark]:
    """Marks of the arguments of a task, by name.

    Raises
    ------
    TypeError
        If an argument has none.
    """
    marks = {}
    for name, argument in signature(function).parameters.items():
        found = [each for each in get_args(argument.annotation) if isinstance(each, Mark)]
        if not found:
            raise TypeError(f"{function.__qualname__}: {name} needs a Parameter in its annotation")
        marks[name] = found[0]
    return marks


class TaskFunction(Generic[P, A]):
    """Function of a task, whose answer knows the call, and whose `progress` and `cancelled` reach what it calls.

    Parameters
    ----------
    function : callable
        Its arguments are annotated by `sonolube.tasks.parameters`.
    """

    __wrapped__: Callable[P, A]

    def __init__(self, function: Callable[P, A]) -> None:
        update_wrapper(self, function)
        self._function, self.__signature__ = function, _form(function)
        self._marks = marks_of(self)
        arguments = self.__signature__.parameters.items()
        self._coercions = {
            name: coercion(get_args(argument.annotation)[0], self._marks[name]) for name, argument in arguments
        }
        self._rigs = [name for name, mark in self._marks.items() if isinstance(mark, RigParameter)]
        if function.__doc__:
            self.__doc__ = _described(function.__doc__, self.__signature__.parameters, self._marks)

    def __call__(self, *positional: P.args, **named: P.kwargs) -> A:
        """Answer to the arguments."""
        bound = self.__signature__.bind(*positional, **named)
        try:
            with private_files(), in_notebooks():
                return self._answer(bound)
        except SonolubeError as failure:
            tidy(failure)
            raise
        except OSError as failure:
            raise refused_by_system(failure) from failure
        except (MemoryError, Warning):  # of the machine; of a filter of the user
            raise
        except Exception as failure:
            if is_of_caller(failure):
                raise
            raise unexpected(failure, self._function.__name__, bound.arguments) from failure

    def _answer(self, bound: BoundArguments) -> A:
        """Answer to arguments as they were given."""
        arguments = bound.arguments
        for name, value in arguments.items():
            try:
                arguments[name] = self._coercions[name](shown(name), value)
            except InvalidInput as refusal:
                refusal.key = refusal.key or name
                raise
        self._replace_entries(arguments)
        positional, named = bound.args, bound.kwargs
        given = frozenset(arguments)
        bound.apply_defaults()
        known = {name: value for name, value in bound.arguments.items() if not isinstance(self._marks[name], RigEntry)}
        call = Call(self._function.__name__, known, given, self._marks, _NAMES.get())
        _refuse_out_of_range(call)
        with within(_CALL, call), watched(arguments.get("progress"), arguments.get("cancelled")):
            found = self._function(*positional, **named)
        object.__setattr__(found, "call", call)
        return found

    def _replace_entries(self, arguments: dict[str, Any]) -> None:
        """Replace entries of the rigs by the arguments that say so, which the function of the task does not take."""
        names = [name for name in arguments if isinstance(self._marks[name], RigEntry)]
        entries = {name: value for name in names if (value := arguments.pop(name)) is not None and value != []}
        if not entries:
            return
        rigs = [name for name in self._rigs if arguments.get(name) is not None]
        if not rigs:
            raise InvalidInput(f"{shown(next(iter(entries)))} needs a rig", key=next(iter(entries)))
        for name in rigs:
            arguments[name] = with_entries(arguments[name], **entries)

    def __repr__(self) -> str:
        return f"<task {self.__module__}.{self._function.__qualname__}>"

    def __reduce__(self) -> str:
        return self._function.__qualname__


def task(function: Callable[P, A]) -> TaskFunction[P, A]:
    """Task by its function.

    Parameters
    ----------
    function : callable
        Its arguments are annotated by `sonolube.tasks.parameters`.

    Returns
    -------
    TaskFunction
        With the same arguments, described in its docstring.
    """
    return TaskFunction(function)


def in_notebooks() -> AbstractContextManager[None]:
    """Show progress under the running cell of a notebook, where nothing else shows it."""
    return observed(cell_progress) if is_in_notebook() else nullcontext()


def argument_names(shown: Callable[[str], str]) -> AbstractContextManager[None]:
    """Show arguments by other names in refusals, such as --sliding-speed for sliding_speed, inside a `with` block."""
    return within(_NAMES, shown)


def shown(name: str) -> str:
    """Name of an argument as it is given here, such as sliding_speed in Python and --sliding-speed on a terminal."""
    return _NAMES.get()(name)


@overload
def in_si(name: str, value: Number) -> float: ...
@overload
def in_si(name: str, value: Number | None) -> float | None: ...
def in_si(name: str, value: Number | None) -> float | None:
    """Value in SI of an argument of the running task that is a number or a text with its unit; None as it is.

    Parameters
    ----------
    name : str
        Of the argument, whose annotation has the unit.
    value : float, str or None

    Returns
    -------
    float or None

    Raises
    ------
    InvalidInput
        If a text is no number with a unit of this kind, or the number is not finite or out of its range.
    """
    if value is None:
        return None
    about = _mark(name)
    number = _number_of(value, about.unit or "", name) if isinstance(value, str) else float(value)
    _require_within(about, name, number, value)
    return number


def plausible(name: str, value: Number) -> float:
    """Value in SI as `in_si` gives it, refused where its magnitude lies beyond any rig."""
    from sonolube.rig.file.section import require_plausible

    return require_plausible(in_si(name, value), unit=_mark(name).unit or "", text=f"{shown(name)} {value}")


def _mark(name: str) -> Parameter:
    """Meaning of a quantity among the arguments of the running task."""
    call = _CALL.get()
    about = None if call is None else call.marks.get(name)
    if not isinstance(about, Parameter) or about.unit is None:
        raise TypeError(f"{name} is no quantity of the running task")
    return about


def _number_of(text: str, unit: str, name: str) -> float:
    """Number in SI of a text with its unit."""
    try:
        if unit == "K":
            return temperature_difference_to_si(text, name=shown(name))
        return to_si(text, unit=unit, name=shown(name))
    except InvalidInput as refusal:
        refusal.key = name
        raise


def refuse_unused(*names: str, because: str) -> None:
    """Refuse arguments that were given and that the running task would not use beside the others.

    Parameters
    ----------
    *names : str
        Arguments that have no meaning here.
    because : str
        Where they have none, and where they apply, such as "for --of; it is for --over".

    Raises
    ------
    InvalidInput
        For the first of them that was given.
    """
    for name in given_arguments(names):
        raise InvalidInput(f"{shown(name)} has no meaning {because}", key=name)


def given_arguments(names: Iterable[str]) -> dict[str, Any]:
    """Those of the arguments of the running task that were not left to their defaults, nor None."""
    call = _CALL.get()
    known = {} if call is None else {name: call.arguments[name] for name in names if name in call.given}
    return {name: value for name, value in known.items() if value is not None}


def _form(function: Callable[..., Any]) -> Signature:
    """Signature of a function, with the arguments that its keywords stand for."""
    form = signature(function)
    own = [each for each in form.parameters.values() if each.kind is not Argument.VAR_KEYWORD]
    for each in form.parameters.values():
        if each.kind is Argument.VAR_KEYWORD:
            known = get_type_hints(get_args(each.annotation)[0], include_extras=True)
            own += [Argument(name, Argument.KEYWORD_ONLY, default=None, annotation=known[name]) for name in known]
    return form.replace(parameters=own)


def _refuse_out_of_range(call: Call) -> None:
    """Refuse plain numbers out of their range."""
    for name, value in call.arguments.items():
        mark = call.marks[name]
        if isinstance(mark, Parameter) and mark.unit is None and isinstance(value, int | float):
            _require_within(mark, name, value, value)


def _require_within(mark: Parameter, name: str, number: float, given: Number) -> None:
    """Raise if a number is not finite or out of the range of its argument."""
    low, high = (-inf if mark.lowest is None else mark.lowest), (inf if mark.highest is None else mark.highest)
    if not (isfinite(number) and low <= number <= high):
        raise InvalidInput(f"{shown(name)} must be finite and lie between {low} and {high}, got {given}", key=name)


def _described(text: str, arguments: Mapping[str, Argument], marks: Mapping[str, Mark]) -> str:
    """Docstring with a section of parameters, before its examples."""
    before, examples = split_examples(cleandoc(text))
    lines = [before, "", "Parameters", "----------"]
    for name, argument in arguments.items():
        mark = marks[name]
        default = "" if argument.default is Argument.empty else f", default {argument.default!r}"
        lines.append(f"{name} : {_kind(argument, mark)}{default}")
        help_text = mark.help if isinstance(mark, Parameter) else _DOORS.get(name, _RIG)
        unit = f" [{mark.unit}]" if isinstance(mark, Parameter) and mark.unit is not None else ""
        lines.append(f"    {help_text}{unit}")
    return "\n".join([*lines, "", examples] if examples else [*lines, ""])


def _kind(argument: Argument, mark: Mark) -> str:
    """Type of an argument in a docstring."""
    if isinstance(mark, RigParameter):
        return "Rig, str or Path"
    if isinstance(mark, Parameter) and mark.unit is not None:
        return "float or str"
    if isinstance(mark, File):
        return "str, Path or NamedBytes"
    kind = get_args(argument.annotation)[0]
    text = kind.__name__ if isinstance(kind, type) else str(getattr(kind, "__forward_arg__", kind))
    return text.replace("typing.", "").replace("collections.abc.", "")
