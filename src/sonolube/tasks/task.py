"""A task: a function with annotated arguments that returns one answer, and the call that it answers."""

from collections.abc import Callable, Iterable, Mapping
from contextlib import AbstractContextManager, nullcontext
from contextvars import ContextVar
from functools import update_wrapper
from inspect import Parameter as Argument, Signature, cleandoc, signature
from math import inf, isfinite
from numbers import Real
from types import NoneType
from typing import Any, Generic, Literal, ParamSpec, TypeVar, get_args, get_origin, get_type_hints, overload

from sonolube.errors import InvalidInput, SonolubeError, UnknownName
from sonolube.tasks.answer import Answer
from sonolube.tasks.files import private_files, with_names_only
from sonolube.tasks.parameters import Call, File, Mark, Number, Parameter, RigParameter, Watched, members_of
from sonolube.tasks.progress import cell_progress, is_in_notebook, observed, watched, within
from sonolube.tasks.table import split_examples
from sonolube.text.units import temperature_difference_to_si, to_si

P = ParamSpec("P")
A = TypeVar("A", bound=Answer)
_RIG = "The rig, or the path of its file."
_DOORS = {
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
        kinds = {name: get_args(argument.annotation)[0] for name, argument in arguments}
        self._choices = {name: _choices(kind) for name, kind in kinds.items()}
        self._numbers = {name: set(members_of(kind)) for name, kind in kinds.items() if _is_plain_number(kind)}
        if function.__doc__:
            self.__doc__ = _described(function.__doc__, self.__signature__.parameters, self._marks)

    def __call__(self, *positional: P.args, **named: P.kwargs) -> A:
        """Answer to the arguments."""
        bound = self.__signature__.bind(*positional, **named)
        given = frozenset(bound.arguments)
        bound.apply_defaults()
        call = Call(self._function.__name__, dict(bound.arguments), given, self._marks, _NAMES.get())
        _refuse_impossible(call, self._choices)
        _refuse_other_than_numbers(call, self._numbers)
        try:
            with (
                within(_CALL, call),
                private_files(),
                in_notebooks(),
                watched(bound.arguments.get("progress"), bound.arguments.get("cancelled")),
            ):
                found = self._function(*positional, **named)
        except SonolubeError as failure:
            failure.args = tuple(with_names_only(each) if isinstance(each, str) else each for each in failure.args)
            raise
        object.__setattr__(found, "call", call)
        return found

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
    """Signature of a function, with the arguments that its `**watch` stands for."""
    form = signature(function)
    own = [each for each in form.parameters.values() if each.kind is not Argument.VAR_KEYWORD]
    if len(own) < len(form.parameters):
        watched_by = get_type_hints(Watched, include_extras=True)
        own += [Argument(each, Argument.KEYWORD_ONLY, default=None, annotation=watched_by[each]) for each in watched_by]
    return form.replace(parameters=own)


def _choices(kind: Any) -> tuple[Any, ...]:
    """Words of which an argument of a type is one, or has several; empty where it may be anything else."""
    if get_origin(kind) is Literal:
        return get_args(kind)
    members = [_choices(each) for each in get_args(kind) if each not in (NoneType, ...)]
    return tuple(word for words in members for word in words) if all(members) else ()


def _refuse_impossible(call: Call, choices: Mapping[str, tuple[Any, ...]]) -> None:
    """Refuse words that are no choice, and plain numbers out of their range."""
    for name, value in call.arguments.items():
        mark = call.marks[name]
        if choices[name] and value is not None:
            for word in [value] if isinstance(value, str) else value:
                if word not in choices[name]:
                    raise UnknownName.among(choices[name], kind=shown(name), name=word)
        elif isinstance(mark, Parameter) and mark.unit is None and isinstance(value, int | float):
            _require_within(mark, name, value, value)


def _is_plain_number(kind: Any) -> bool:
    """Whether an argument of a type is a number without a unit, and nothing else."""
    return bool(members_of(kind)) and set(members_of(kind)) <= {int, float}


def _refuse_other_than_numbers(call: Call, numbers: Mapping[str, set[type]]) -> None:
    """Refuse texts for plain numbers, and fractions for whole ones."""
    for name, kinds in numbers.items():
        value = call.arguments[name]
        is_whole = float not in kinds
        is_number = isinstance(value, Real) and not isinstance(value, bool)
        if value is not None and not (is_number and (not is_whole or value == int(value))):
            what = "a whole number" if is_whole else "a number"
            raise InvalidInput(f"{shown(name)} must be {what}, got {value!r}", key=name)


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
