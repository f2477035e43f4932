"""Commands and remarks of what is taken away: options, files by name, seeds, and programs in Python and notebooks."""

import json
import re
from typing import Any

import pytest
from pytest import raises

from sonolube import __version__
from sonolube.browser.answer_files import command, is_file, made_by, marked, named, version_and_seed
from sonolube.browser.requests import Places
from sonolube.browser.take_away import changed_text, taken
from sonolube.errors import InvalidInput, UnknownName
from sonolube.tasks.table import task_named

RIG = {"name": "own", "changes": {"contact.normal_load": "4 N"}}
TYPED = {"name": "tribometer", "changes": {"contact.normal_load": "4 N"}}
NOWHERE = Places(rigs={})
UPLOAD = {"name": "my runs.csv", "upload": "00ff"}
CONTENT = {"name": "b.csv", "content": "YQ=="}


@pytest.mark.parametrize(
    ("task", "arguments", "words"),
    [
        ("friction", {"rig": RIG}, "friction own.toml --set 'contact.normal_load=4 N'"),
        ("friction", {"rig": {"name": ""}}, "friction rig.toml"),
        ("predict", {"rig": RIG, "runs": UPLOAD, "draws": 400},
         "predict own.toml --set 'contact.normal_load=4 N' --runs 'my runs.csv' --draws 400"),
        ("measure friction", {"files": [UPLOAD, CONTENT], "join": True, "sliding_speed": "2 mm/s"},
         "measure friction 'my runs.csv' b.csv --join --sliding-speed '2 mm/s'"),
        ("measure friction", {"files": [CONTENT], "join": False, "sliding_speed": None}, "measure friction b.csv"),
        ("sweep", {"rig": {"name": "own"}, "over": {"a.b": "1:2:3", "c": "4"}, "lowest": "1 V"},
         "sweep own.toml --over a.b=1:2:3 --over c=4 --from '1 V'"),
        ("map", {"rig": {"name": "own"}, "runs": CONTENT, "form": ["png", "svg"]},
         "map own.toml --runs b.csv --form png --form svg"),
        ("materials", {"name": "brass"}, "materials brass"),
    ],
)  # fmt: skip
def test_the_command_of_a_call_has_its_options_and_the_names_of_files(
    task: str, arguments: dict[str, Any], words: str
) -> None:
    assert command(task_named(task), arguments) == f"sonolube {words}"


def test_the_line_has_the_version_and_the_seed_of_a_task_that_draws() -> None:
    predict, friction = task_named("predict"), task_named("friction")
    assert version_and_seed(predict, {"seed": 7}) == f"sonolube {__version__}, seed 7"
    assert version_and_seed(predict, {}) == f"sonolube {__version__}, seed 0"
    assert version_and_seed(friction, {"rig": RIG}) == f"sonolube {__version__}"
    assert made_by(friction, {"rig": {"name": "own"}}) == f"Made by sonolube {__version__}: sonolube friction own.toml"


@pytest.mark.parametrize(
    ("value", "found"),
    [
        (UPLOAD, True),
        (CONTENT, True),
        ({"name": "a"}, False),
        ({"upload": "a"}, False),
        ("a", False),
        ([UPLOAD], False),
    ],
)
def test_a_file_has_a_name_and_a_content_here_or_there(value: Any, found: bool) -> None:
    assert is_file(value) is found


def test_files_stand_by_their_names() -> None:
    assert named([UPLOAD, 3, [CONTENT]]) == ["my runs.csv", 3, ["b.csv"]]


@pytest.mark.parametrize(
    ("name", "content", "found"),
    [
        ("a.csv", "x\n1\n", "# L\nx\n1\n"),
        ("a.TOML", "#:schema s\na = 1\n", "#:schema s\n# L\na = 1\n"),
        ("a.toml", b"a = 1\n", "# L\na = 1\n"),
        ("a.svg", "<?xml?><svg a='1'><g/></svg>", "<?xml?><svg a='1'>\n <desc>L</desc><g/></svg>"),
        ("a.vtu", "<VTKFile b='2'>x", "<VTKFile b='2'>\n<?made-by L?>x"),
        ("a.html", "<html><head><t/></head>", '<html><head>\n<meta name="generator" content="L"><t/></head>'),
        ("a.html", "none", '\n<meta name="generator" content="L">none'),
        ("a.step", "ISO-10303-21;\nISO-10303-21;", "ISO-10303-21;\n/* L */\nISO-10303-21;"),
        ("a.dxf", "0\n", "999\nL\n0\n"),
        ("a.bin", b"\x00", b"\x00"),
        ("csv", "x", "# L\nx"),
    ],
)
def test_each_kind_of_file_holds_its_remark_where_it_takes_one(
    name: str, content: str | bytes, found: str | bytes
) -> None:
    assert marked(name, content, "L") == found


def test_what_would_end_a_remark_is_written_otherwise() -> None:
    assert marked("a.svg", "<svg>", '<b> & "c"') == "<svg>\n <desc>&lt;b&gt; &amp; &quot;c&quot;</desc>"
    assert "* / x" in str(marked("a.step", "ISO-10303-21;", "*/ x"))


def test_the_program_in_python_reads_the_rig_and_prints_the_answer() -> None:
    file = taken({"form": "python", "task": "predict", "arguments": {"draws": 4, "rig": RIG, "runs": UPLOAD}}, NOWHERE)
    assert (file["name"], file["kind"]) == ("own-predict.py", "text/x-python")
    assert file["text"] == (
        f"# Made by sonolube {__version__}, seed 0\n"
        "import sonolube as sl\n\n"
        "rig = sl.read_rig('own.toml', changes=['contact.normal_load=4 N'])\n"
        "answer = sl.predict(rig, draws=4, runs='my runs.csv')\n"
        "print(answer)\n"
    )
    fit = {"runs": CONTENT, "rig": {"name": "own"}, "model": None}
    text = taken({"form": "python", "task": "fit", "arguments": fit}, NOWHERE)["text"]
    assert "answer = sl.fit(rig, runs='b.csv')" in text
    decay = {"form": "python", "task": "measure friction", "arguments": {"files": [CONTENT]}}
    assert "answer = sl.measure.friction(files=['b.csv'])" in taken(decay, NOWHERE)["text"]


def test_a_notebook_draws_a_figure_where_the_task_has_one() -> None:
    for task, count in (("predict", 3), ("friction", 2)):
        file = taken({"form": "notebook", "task": task, "arguments": {"rig": RIG}}, NOWHERE)
        content = json.loads(file["text"])
        assert (content["nbformat"], len(content["cells"])) == (4, count)
        first, second, *rest = content["cells"]
        assert (first["cell_type"], first["id"], "outputs" in first) == ("markdown", "cell-0", False)
        assert first["source"].endswith(f"`{task}`")
        assert (second["cell_type"], second["outputs"], second["execution_count"]) == ("code", [], None)
        assert second["source"].endswith("\nanswer")
        assert [cell["source"] for cell in rest] == ["sl.plot(answer)"] * (count - 2)
        assert file["name"] == f"own-{task}.ipynb"


def test_the_command_line_says_version_and_seed_below() -> None:
    file = taken({"form": "command", "task": "predict", "arguments": {"rig": RIG, "seed": 3}}, NOWHERE)
    assert file["name"] == "own-predict.txt"
    assert file["text"].endswith(f"--seed 3\n# sonolube {__version__}, seed 3")


def test_a_rig_is_taken_with_its_changes_and_not_without_a_rig() -> None:
    rig = {"name": "tribometer", "changes": {"contact.normal_load": "4 N"}}
    file = taken({"form": "toml", "task": "friction", "arguments": {"rig": rig}}, NOWHERE)
    assert (file["name"], file["kind"], 'normal_load = "4 N"' in file["text"]) == (
        "tribometer.toml", "application/toml", True,
    )  # fmt: skip
    with raises(InvalidInput, match=r"^compare was asked without a rig$"):
        taken({"form": "toml", "task": "compare", "arguments": {}}, NOWHERE)
    with raises(InvalidInput, match="materials has no figure to take away"):
        taken({"form": "svg", "task": "materials", "arguments": {"name": "aluminium_2024"}}, NOWHERE)
    with raises(UnknownName, match="unknown form 'tomml'; did you mean toml"):
        taken({"form": "tomml", "task": "friction", "arguments": {}}, NOWHERE)
    assert changed_text('a = "1" # b\n', {}) == 'a = "1" # b\n'


def test_tables_of_an_answer_are_one_below_the_other_and_a_report_has_its_text() -> None:
    file = taken({"form": "csv", "task": "materials", "arguments": {"name": "aluminium_2024"}}, NOWHERE)
    first, heads, *rows = file["text"].splitlines()
    assert first.startswith("# Made by sonolube")
    assert heads == "property,value,source"
    assert rows[-1] == ""
    assert (file["name"], file["kind"]) == ("materials.csv", "text/csv")
    report = taken({"form": "report", "task": "friction", "arguments": {"rig": TYPED}}, NOWHERE)
    assert report["name"] == "tribometer-friction.html"
    assert "Modified pin-on-disc tribometer" in report["text"]
    assert "made by" in report["text"]
    assert "assumed " in report["text"]
    rows = dict(re.findall(r'<tr><th scope="row">([^<]+)</th><td>([^<]*)</td></tr>', report["text"]))
    assert rows["rig"].startswith("Modified pin-on-disc tribometer")
    assert (rows["changed"], rows["interval"]) == ("contact.normal_load=4 N", "yes (default)")
    assert rows["made by"].startswith(f"sonolube {__version__}: sonolube friction tribometer.toml")
    of_no_rig = taken({"form": "report", "task": "materials", "arguments": {"name": "aluminium_2024"}}, NOWHERE)
    assert of_no_rig["name"] == "materials.html"
    assert "made by" in of_no_rig["text"]
