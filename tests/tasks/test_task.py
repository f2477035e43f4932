"""Tasks: their calls, the reading of quantities, names in refusals, progress and cancellation, bytes as files."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Unpack

from pytest import approx, mark, raises

from sonolube.errors import InvalidInput
from sonolube.report.blocks import Block, Rows
from sonolube.tasks.answer import Answer, answer
from sonolube.tasks.files import InputFile, NamedBytes, file_path
from sonolube.tasks.parameters import File, Number, Parameter, Watched
from sonolube.tasks.progress import TaskCancelled, stage
from sonolube.tasks.task import argument_names, in_si, refuse_unused, task


@answer
class Length(Answer):
    metres: float

    def blocks(self) -> Sequence[Block]:
        return ["length", Rows([("length", f"{self.metres:g} m")])]

    def object(self) -> dict[str, Any]:
        return {"length": {"value": self.metres, "unit": "m"}}


@task
def stretched(
    length: Annotated[Number, Parameter("At rest.", unit="m", lowest=0)],
    *,
    strain: Annotated[Number, Parameter("Of the rod.", unit="")] = "10 %",
    table: Annotated[InputFile | None, File("Of what is added.")] = None,
    note: Annotated[str | None, Parameter("With a table.")] = None,
    **watch: Unpack[Watched],
) -> Length:
    """Length of a rod under strain.

    Example: sonolube stretched 1m

    Examples
    --------
    >>> stretched("1 m").metres
    1.1
    """
    if table is None:
        refuse_unused("note", because="without a table")
    more = 0.0 if table is None else float(file_path(table).read_text())
    with stage("stretching") as advance:
        for number in range(3):
            advance("parts", number, 3)
    return Length(metres=in_si("length", length) * (1 + in_si("strain", strain)) + more)


@mark.parametrize("length", ["2 m", "200cm", 2.0, 2])
def test_text_with_a_unit_and_a_number_in_si_are_one(length: Number) -> None:
    assert stretched(length).metres == approx(2.2)


def test_an_answer_prints_as_text_and_as_tables_of_a_notebook() -> None:
    found = stretched("1 m", strain=0)
    assert str(found) == "length\n  length  1 m"
    assert found._repr_html_() == "<p>length</p><table><tbody><tr><th>length</th><td>1 m</td></tr></tbody></table>"
    assert float(found["length"]) == 1.0
    assert found.dataset()["length"].attrs["units"] == "m"


def test_a_figure_that_an_answer_lacks_is_refused() -> None:
    with raises(InvalidInput, match="nothing that could be drawn"):
        stretched("1 m").plot()


def test_the_call_tells_what_was_given_and_what_was_left() -> None:
    call = stretched("1 m", strain="3 %").call
    assert call is not None
    assert call.task == "stretched"
    assert call.settings() == [("length", "1 m"), ("strain", "3 %")]
    by_default = stretched("1 m").call
    assert by_default is not None
    assert by_default.settings()[1] == ("strain", "10 % (default)")


@mark.parametrize("length", ["2 N", "two", float("nan"), -1.0])
def test_a_refusal_names_the_argument_as_it_was_given(length: Number) -> None:
    with raises(InvalidInput, match=r"^length"):
        stretched(length)
    with argument_names(lambda name: f"--{name}"), raises(InvalidInput, match=r"^--length"):
        stretched(length)


def test_an_argument_that_is_not_used_is_refused_where_it_was_given() -> None:
    with raises(InvalidInput, match="note has no meaning without a table"):
        stretched(1.0, note="x")


def test_progress_is_reported_to_the_caller_and_asks_whether_to_stop() -> None:
    seen: list[tuple[str, int, int]] = []
    stretched(1.0, progress=lambda *each: seen.append(each))
    assert seen == [("stretching: parts", number, 3) for number in range(3)]
    with raises(TaskCancelled, match="stretching"):
        stretched(1.0, cancelled=lambda: len(seen) > 0)
    assert stretched(1.0, cancelled=lambda: False).metres == approx(1.1)


def test_bytes_with_a_name_stand_for_a_file_and_leave_nothing(tmp_path: Path) -> None:
    path = tmp_path / "more.txt"
    path.write_text("0.5")
    given = stretched(1.0, table=path).metres
    assert stretched(1.0, table=NamedBytes("more.txt", b"0.5")).metres == given
    with raises(InvalidInput, match="without a folder"):
        stretched(1.0, table=NamedBytes("../more.txt", b"0.5"))


def test_the_docstring_lists_the_arguments_with_their_units() -> None:
    assert stretched.__doc__ is not None
    assert "length : float or str\n    At rest. [m]" in stretched.__doc__


def test_the_docstring_ends_with_the_examples() -> None:
    assert stretched.__doc__ is not None
    assert stretched.__doc__.endswith('\n\nExamples\n--------\n>>> stretched("1 m").metres\n1.1')
    assert stretched.__doc__.index("Parameters\n") < stretched.__doc__.index("Examples\n")


def test_an_argument_without_a_meaning_is_a_mistake_of_the_task() -> None:
    def wrong(length: float) -> Length:
        return Length(metres=length)

    with raises(TypeError, match="length needs a Parameter"):
        task(wrong)
