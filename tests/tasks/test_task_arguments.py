"""Arguments of a task: words, plain numbers and quantities that are refused, and their lines in its docstring."""

import pickle
from collections.abc import Sequence
from typing import Annotated, Any, Literal

from pytest import approx, mark, raises

from sonolube.errors import InvalidInput, UnexpectedFault, UnknownName
from sonolube.report.blocks import Block
from sonolube.tasks.answer import Answer, answer
from sonolube.tasks.files import InputFile
from sonolube.tasks.parameters import File, Keep, Number, Parameter, RigFile
from sonolube.tasks.plot import plot
from sonolube.tasks.task import argument_names, given_arguments, in_si, plausible, refuse_unused, shown, task


@answer
class Said(Answer):
    values: tuple[Any, ...]

    def blocks(self) -> Sequence[Block]:
        return []

    def object(self) -> dict[str, Any]:
        return {}


@task
def turned(
    way: Annotated[Literal["left", "right"] | None, Parameter("Of turning.")] = "left",
    *,
    ways: Annotated[Sequence[Literal["left", "right"]], Parameter("Of all.")] = (),
    times: Annotated[int, Parameter("How often.", lowest=1, highest=9)] = 2,
    share: Annotated[float | None, Parameter("Of a turn.", lowest=0)] = None,
    name: Annotated[str | int | None, Parameter("Of the turn.")] = None,
    warmer: Annotated[Number | None, Parameter("Than the room.", unit="K")] = None,
    force: Annotated[Number, Parameter("Of turning.", unit="N", highest=5e9)] = 1.0,
) -> Said:
    """Turns of a knob."""
    given = given_arguments(("way", "times", "name"))
    return Said(values=(in_si("warmer", warmer), plausible("force", force), given, shown("force")))


@task
def read(rig: RigFile, table: Annotated[InputFile, File("Of it.")], keep: Keep = None) -> Said:
    """What a file says.

    Examples
    --------
    >>> read
    """
    return Said(values=())


@mark.parametrize(
    ("arguments", "words"),
    [({"way": "up"}, "unknown way 'up'; known: left, right"),
     ({"way": "lefft"}, "unknown way 'lefft'; did you mean left?"),
     ({"ways": ["left", "down"]}, "unknown ways 'down'; known: left, right")],
)  # fmt: skip
def test_a_word_that_is_no_choice_is_refused_with_the_choices(arguments: dict[str, Any], words: str) -> None:
    with raises(UnknownName) as refused:
        turned(**arguments)
    assert str(refused.value) == words


@mark.parametrize(
    ("arguments", "words", "key"),
    [({"times": 0}, "times must be finite and lie between 1 and 9, got 0", "times"),
     ({"times": 10}, "times must be finite and lie between 1 and 9, got 10", "times"),
     ({"times": 1.5}, "times must be a whole number, got 1.5", "times"),
     ({"times": "2"}, "times must be a whole number, got '2'", "times"),
     ({"times": True}, "times must be a whole number, got True", "times"),
     ({"share": "1"}, "share must be a number, got '1'", "share"),
     ({"share": -0.5}, "share must be finite and lie between 0 and inf, got -0.5", "share"),
     ({"share": float("inf")}, "share must be finite and lie between 0 and inf, got inf", "share"),
     ({"force": "6 GN"}, "force must be finite and lie between -inf and 5000000000.0, got 6 GN", "force"),
     ({"force": "1 m"}, "force", "force"),
     ({"warmer": "40 degC"}, "warmer", "warmer")],
)  # fmt: skip
def test_a_number_of_the_wrong_kind_or_range_is_refused_by_its_name(
    arguments: dict[str, Any], words: str, key: str
) -> None:
    with raises(InvalidInput) as refused:
        turned(**arguments)
    assert str(refused.value).startswith(words)
    assert getattr(refused.value, "key", "") == key


def test_ends_of_ranges_whole_fractions_and_nothing_are_accepted() -> None:
    for times in (1, 9, 2.0):
        turned(times=times)  # type: ignore[arg-type]
    turned(None, share=0, name=3)
    turned("right", ways=("left", "right"), share=0.25, name="x")


def test_quantities_are_in_si_and_temperature_differences_have_no_zero_point() -> None:
    warmer, force, *_ = turned(warmer="40 K", force="2 kN").values
    assert warmer == approx(40.0)
    assert force == approx(2000.0)
    assert turned(force=0).values[0] is None
    with raises(InvalidInput, match=r"^force 3 GN lies beyond any rig: expected 1 pN to 1 GN$"):
        turned(force="3 GN")


def test_given_arguments_are_those_not_left_to_their_defaults() -> None:
    assert turned().values[2] == {}
    assert turned("left", name=None, times=2).values[2] == {"way": "left", "times": 2}
    assert given_arguments(("way",)) == {}
    refuse_unused("way", because="outside a task")


def test_names_are_those_of_the_door_inside_a_block_only() -> None:
    with argument_names(lambda name: f"--{name}"):
        assert turned().values[3] == "--force"
        with raises(UnknownName, match=r"^unknown --way 'up'"):
            turned("up")  # type: ignore[arg-type]
    assert turned().values[3] == "force"


def test_a_quantity_outside_a_task_or_without_a_unit_is_a_mistake_of_the_task() -> None:
    with raises(TypeError, match=r"^force is no quantity of the running task$"):
        in_si("force", 1.0)
    assert in_si("force", None) is None

    @task
    def mistaken(times: Annotated[int, Parameter("How often.")]) -> Said:
        """Mistaken."""
        return Said(values=(in_si("times", times),))

    with raises(UnexpectedFault, match=r"times is no quantity of the running task") as raised:
        mistaken(2)
    assert isinstance(raised.value.__cause__, TypeError)


def test_a_docstring_says_of_each_argument_its_kind_default_meaning_and_unit() -> None:
    lines = str(turned.__doc__).splitlines()
    assert lines[:4] == ["Turns of a knob.", "", "Parameters", "----------"]
    assert lines[lines.index("times : int, default 2") + 1] == "    How often."
    assert lines[lines.index("warmer : float or str, default None") + 1] == "    Than the room. [K]"
    assert lines[lines.index("ways : Sequence[Literal['left', 'right']], default ()") + 1] == "    Of all."
    assert str(turned.__doc__).endswith("[N]\n")
    assert str(read.__doc__) == (
        "What a file says.\n\nParameters\n----------\nrig : Rig, str or Path\n    The rig, or the path of its file.\n"
        "table : str, Path or NamedBytes\n    Of it.\n"
        "keep : str | pathlib.Path | Callable[[str], pathlib.Path] | None, default None\n"
        "    Folder for what is computed so far, from which an interrupted task continues.\n"
        "\nExamples\n--------\n>>> read"
    )


def test_a_task_is_pickled_by_its_name() -> None:
    assert pickle.loads(pickle.dumps(read)) is read
    assert repr(read) == f"<task {__name__}.read>"


@mark.parametrize("result", [3, "text"])
def test_only_answers_and_datasets_of_tasks_are_drawn(result: Any) -> None:
    names = "comparison, map, prediction, simulation, sweep"
    with raises(InvalidInput) as refused:
        plot(result)
    said = f"plot draws answers of tasks, and datasets of {names}, got {type(result).__name__}"
    assert str(refused.value) == said


def test_a_dataset_of_another_result_is_refused_by_its_name() -> None:
    class Labelled:
        attrs = {"result": "wear"}  # noqa: RUF012

    labelled: Any = Labelled()
    with raises(InvalidInput, match=r", got wear$"):
        plot(labelled)
