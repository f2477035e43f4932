"""Arguments of tasks from Python: what is coerced, what is refused by name in one line, and what is a fault."""

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from decimal import Decimal
from inspect import signature
from pathlib import Path
from typing import Any, NoReturn, get_args

import numpy as np
import pandas as pd
import pint
import xarray as xr
from hypothesis import given, settings, strategies as st
from pytest import MonkeyPatch, approx, mark, raises

import sonolube as sl
from sonolube.errors import InvalidInput, SonolubeError, UnexpectedFault
from sonolube.measurement import read_recording
from sonolube.measurement.measured_runs import read_runs
from sonolube.tasks import faults
from sonolube.tasks.answer import Answer, answer
from sonolube.tasks.boundary import choices_of, described
from sonolube.tasks.files import NamedBytes, with_names_only
from sonolube.tasks.parameters import RigFile
from sonolube.tasks.predict import rig_record
from sonolube.tasks.table import TASKS
from sonolube.tasks.task import task

EXAMPLES = Path(__file__).parents[2] / "examples"
RIG = EXAMPLES / "rigs" / "tribometer.toml"
RUNS = EXAMPLES / "tribometer-runs.csv"
KNOWN = sl.read_rig(RIG)
UNITS: Any = pint.UnitRegistry()
HEAT = {"pin": "stainless_steel_316", "disc": "aluminium_2024"}


class Unprintable:
    def __repr__(self) -> str:
        raise RuntimeError


ON = {"rig": KNOWN}
WRONG: list[tuple[Callable[..., Any], dict[str, Any], str]] = [
    (sl.friction, {"rig": None}, "rig must be a rig, the path of its file, its bytes, or an answer with .*, got None"),
    (sl.friction, {"rig": 3}, "rig must be a rig, .*, got 3"),
    (sl.friction, {"rig": pd.DataFrame({"a": [1]})}, r"rig must be a rig, .*, got a DataFrame of shape \(1, 1\)"),
    (sl.friction, {"rig": Unprintable()}, "rig must be a rig, .*, got an Unprintable"),
    (sl.friction, {"rig": "a\0b"}, r"rig 'a\\x00b' is no path: it has a character that no name of a file has"),
    (sl.friction, {"rig": "\ud800"}, r"rig '\\ud800' is no path"),
    (sl.friction, {"rig": b"title"}, r"rig\.toml: not valid TOML"),
    (sl.friction, {"rig": b"\xff"}, r"rig\.toml: "),
    (sl.friction, {"rig": "x" * 5000}, "File name too long|cannot be read"),
    (sl.friction, {**ON, "model": ["x"]}, r"model must be a text, got \['x'\]"),
    (sl.friction, {**ON, "model": "m" * 50_000}, "unknown .*'m{200}"),
    (sl.friction, {**ON, "interval": "no"}, "interval must be True or False, got 'no'"),
    (sl.friction, {**ON, "evidence": 3}, "evidence must be the path of a file, its bytes, .*, got 3"),
    (sl.friction, {**ON, "load": "5 m"}, "contact.normal_load.*5 m is a length"),
    (sl.friction, {**ON, "load": [5, 6]}, r"load must be a number in SI or a text with its unit, got \[5, 6\]"),
    (sl.friction, {**ON, "load": UNITS("3 s")}, "load '3 second' has no unit of the kind N"),
    (sl.friction, {**ON, "changes": ["drive"]}, "'drive' must look like KEY=VALUE"),
    (sl.friction, {**ON, "changes": {"drive.frequency": 3}}, r"changes must be a list, got \{'drive.freq"),
    (sl.compare, {"load": 5}, "load needs a rig"),
    (sl.compare, {"model": 3}, "model must be a text, got 3"),
    (sl.predict, {**ON, "draws": "200"}, "draws must be a whole number, got '200'"),
    (sl.predict, {**ON, "draws": float("nan")}, "draws must be a whole number, got nan"),
    (sl.predict, {**ON, "draws": 10**400}, "draws must be a number that a float holds, got 1000.*000"),
    (sl.predict, {**ON, "draws": np.array([200, 300])}, r"draws must be one number, got a ndarray of shape \(2,\)"),
    (sl.predict, {**ON, "runs": 3}, "runs must be the path of a table, its bytes, a DataFrame"),
    (sl.predict, {**ON, "runs": xr.Dataset()}, "runs: a dataset of runs has one dimension, got none"),
    (sl.predict, {**ON, "runs": xr.Dataset({"a": (("x", "y"), np.eye(2))})}, r"got x \(2\), y \(2\)"),
    (sl.predict, {**ON, "runs": xr.Dataset({"a": ("x", [1.0])})}, "runs: needs a column friction_reduction"),
    (sl.predict, {**ON, "runs": pd.DataFrame({"friction_ratio": ["x", "y"]})}, "friction_ratio 'x' is no number"),
    (sl.predict, {**ON, "laboratory": [1]}, "each of laboratory must be a rig and its runs, got 1"),
    (sl.predict, {**ON, "laboratory": 3}, "laboratory must be a mapping of rigs to runs, got 3"),
    (sl.fit, {"runs": None}, "runs must be the path of a table, .*, got None"),
    (sl.thermal, {**ON, "duration": np.array([1.0, 2.0])}, r"duration must be one number, got a ndarray"),
    (sl.thermal, {**ON, "duration": 1j}, "duration must be a number in SI or a text with its unit, got 1j"),
    (sl.thermal, {**ON, "duration": True}, "duration must be a number in SI or a text with its unit, got True"),
    (sl.sweep, {**ON, "over": ["a"]}, "over must be a mapping, such as .*, got \\['a'\\]"),
    (sl.sweep, {**ON, "over": {3: "a"}}, "each key of over must be a text, got 3"),
    (sl.sweep, {**ON, "over": {"drive.frequency": [None]}}, "over drive.frequency must be a number in SI or a text"),
    (sl.sweep, {**ON, "keep": 3}, "keep must be a function, got 3"),
    (sl.simulate, {**ON, "progress": 3}, "progress must be a function, got 3"),
    (sl.measure.friction, {"files": None}, "files must be the path of a file, its bytes, or NamedBytes, got None"),
    (sl.measure.friction, {"files": [1]}, "files must be the path of a file, its bytes, or NamedBytes, got 1"),
    (sl.measure.friction, {"files": {"a": 1}}, "files must be a list"),
    (sl.measure.friction, {"files": xr.Dataset({"a": ("t", np.array([object()]))})}, "files: this dataset has content"),
    (sl.measure.friction, {"files": RUNS, "step": {"0s:3s": [1]}}, "step 0s:3s must be a text, got \\[1\\]"),
    (sl.plan, {**ON, "comparison": 3}, "comparison must be one of paired, separate, got 3"),
]  # fmt: skip


@mark.parametrize(("function", "arguments", "line"), WRONG, ids=range(len(WRONG)))
def test_a_wrong_value_is_refused_in_one_short_line_that_names_its_argument(
    function: Callable[..., Any], arguments: dict[str, Any], line: str
) -> None:
    with raises(SonolubeError, match=line) as refused:
        function(**arguments)
    text = str(refused.value)
    assert not isinstance(refused.value, UnexpectedFault)
    assert "\n" not in text
    assert len(text) <= 4100


@mark.parametrize("load", [5, "5 N", "5000 mN", np.float32(5), np.array(5.0), xr.DataArray(5.0), UNITS("5 N"),
                           UNITS("5 kN") / 1000])  # fmt: skip
def test_a_load_of_any_kind_of_number_is_that_of_the_terminals_option(load: Any) -> None:
    expected = float(sl.friction(sl.read_rig(RIG, changes=["contact.normal_load=5N"]))["friction_force"])
    assert float(sl.friction(RIG, load=load)["friction_force"]) == approx(expected, rel=1e-12)


def test_entries_are_replaced_in_a_rig_its_file_its_bytes_and_an_answer_alike() -> None:
    expected = sl.read_rig(RIG, changes=["sliding.sliding_speed=87mm/s", "contact.normal_load=4N"])
    rigs: list[Any] = [RIG, str(RIG), KNOWN, RIG.read_bytes(), NamedBytes("a.toml", RIG.read_bytes()), sl.friction(RIG)]
    for rig in rigs:
        found = sl.contact(rig, load=4, changes=["sliding.sliding_speed=87mm/s"]).rig
        assert (found.normal_load, found.sliding_speed) == approx((expected.normal_load, expected.sliding_speed))


def test_a_source_of_the_amplitude_is_chosen_as_on_the_terminal() -> None:
    assert sl.friction(RIG, amplitude="per-volt").rig.amplitude_source == "per-volt"
    with raises(InvalidInput, match="amplitude_source"):
        sl.friction(RIG, amplitude="guessed")


def test_quantities_of_pint_are_their_texts() -> None:
    by_text = sl.thermal(RIG, **HEAT, duration="2 min", heat_capacity="1.5 J/K")
    by_pint = sl.thermal(RIG, **HEAT, duration=2 * UNITS.minute, heat_capacity=UNITS("1.5 J/K"))
    name = "temperature_rise"
    assert float(by_pint[name]) == approx(float(by_text[name]), rel=1e-12)


def ratios(answer: Any) -> Any:
    return np.asarray(answer["friction_ratio"])


def test_runs_by_path_bytes_table_and_dataset_give_the_same_prediction() -> None:
    read = read_runs(RUNS)
    plain = read.to_dataframe().drop(columns="friction_reduction").reset_index(drop=True)
    headed = pd.read_csv(RUNS, comment="#")
    labelled = plain.to_xarray()
    labelled["sliding_speed"] = ("index", 1e3 * plain["sliding_speed"].to_numpy(), {"units": "mm/s"})
    ratio = plain.drop(columns=["friction_force", "intrinsic_friction_force"])
    ratio["friction_ratio"] = plain["friction_force"] / plain["intrinsic_friction_force"]
    ratio["operator"] = "A. N."
    expected = ratios(sl.predict(RIG, runs=RUNS, draws=200))
    every: list[Any] = [RUNS.read_bytes(), read, headed, plain, plain.to_xarray(), labelled, ratio, ratio.to_xarray(),
                 read.assign_coords(run=["a", "b", "c", "d"]), plain.set_index("sliding_speed")]  # fmt: skip
    for runs in every:
        assert ratios(sl.predict(KNOWN, runs=runs, draws=200)) == approx(expected, rel=1e-12)


def test_a_dataset_of_runs_keeps_its_names_and_says_which_variables_are_left_out() -> None:
    given_runs = xr.Dataset(
        {"friction_ratio": ("run", [0.4, np.nan, 0.6]), "humidity": ("run", [1, 2, 3])}, coords={"run": ["a", "b", "c"]}
    )
    caveats = sl.predict(RIG, runs=given_runs, draws=200).caveats()
    assert any("1 column is left out: 'humidity'" in line for line in caveats)
    assert any("1 of 3 runs have no friction yet and are left out (line 2)" in line for line in caveats)


def recording(path: Path) -> Path:
    time_, force = np.arange(400) / 100, 0.4 + 0.02 * (-1.0) ** np.arange(400)
    pd.DataFrame({"time (s)": time_, "friction_force (N)": force}).to_csv(path, index=False)
    return path


def test_a_recording_by_path_bytes_table_and_dataset_gives_the_same_friction(tmp_path: Path) -> None:
    path = recording(tmp_path / "test.csv")
    table = pd.read_csv(path)
    in_si = table.rename(columns=lambda name: name.partition(" (")[0])
    every: list[Any] = [path, path.read_bytes(), read_recording(path), table, in_si, in_si.set_index("time"),
                  in_si.set_index("time").to_xarray(), [read_recording(path)], iter([path])]  # fmt: skip
    for files in every:
        found = sl.measure.friction(files)
        assert float(found["mean_force"]) == approx(0.4, rel=1e-9)
        assert float(found["friction_force_fluctuation"]) == approx(0.02, rel=1e-3)


def test_one_model_alone_is_a_list_of_it() -> None:
    assert [each.model.name for each in sl.compare(model="kinematic").fits] == ["kinematic"]


ANY: Any = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.complex_numbers() | st.text(max_size=8)
    | st.binary(max_size=8) | st.decimals() | st.sampled_from([np.float32(1), np.array(1), np.array([1, 2]), object,
    object(), pd.DataFrame({"a": [1]}), xr.Dataset(), UNITS("1 m"), UNITS.Quantity([1, 2], "s"), Decimal(3),
    10**400, Path("a"), NamedBytes("a", b""), range(3), len, pd.Series([1.0]), np.datetime64("2020"), np.str_("x")]),
    lambda each: st.lists(each, max_size=3) | st.dictionaries(st.text(max_size=3) | st.integers(), each, max_size=3),
    max_leaves=4,
)  # fmt: skip
ARGUMENTS = [(each.function, name) for each in TASKS for name in signature(each.function).parameters]


@settings(max_examples=300, deadline=None)
@given(value=ANY, argument=st.sampled_from(ARGUMENTS))
def test_any_value_for_any_argument_of_any_task_is_coerced_or_refused_by_name(value: Any, argument: Any) -> None:
    function, name = argument
    try:
        found = function._coercions[name](name, value)
    except SonolubeError as failure:
        refused = str(failure)
    else:
        refused = name
    assert name in refused
    assert len(refused) < 1000
    if refused != name:
        return
    kind = get_args(function.__signature__.parameters[name].annotation)[0]
    if choices_of(kind) and isinstance(found, str):
        assert found in choices_of(kind)
    if isinstance(getattr(function._marks[name], "unit", None), str) and found is not None:
        assert isinstance(found, float | int | str)


@settings(max_examples=25, deadline=None)
@given(value=ANY, argument=st.sampled_from([
    (sl.friction, "model"), (sl.friction, "load"), (sl.friction, "evidence"), (sl.friction, "changes"),
    (sl.contact, "rig"), (sl.fit, "runs"), (sl.measure.friction, "files"), (sl.measure.surface, "files"),
    (sl.materials, "name"), (sl.published, "table"), (sl.mapping, "file"), (sl.schema, "kind")]))  # fmt: skip
def test_a_call_with_any_value_answers_or_refuses(value: Any, argument: Any) -> None:
    function, name = argument
    rig = ON if function is sl.friction else {}
    failure: SonolubeError | None = None
    try:
        function(**rig | {name: value})
    except SonolubeError as refused:
        failure = refused
    assert not isinstance(failure, UnexpectedFault)
    assert "\n" not in str(failure)


# ---- what no refusal foresees


def broken(*_: object, **__: object) -> NoReturn:
    raise ZeroDivisionError("of a part")


def test_what_no_refusal_foresees_is_one_line_with_a_file_that_reproduces_it(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(rig_record, "friction_point", broken)
    with raises(UnexpectedFault) as raised:
        sl.friction(RIG, model="kinematic", changes=["contact.normal_load=4N"])
    text = str(raised.value)
    found = re.search(r"ZeroDivisionError \(of a part\) in sonolube/.*, and attach (\S+), which reproduces it$", text)
    assert found is not None
    assert "\n" not in text
    assert isinstance(raised.value.__cause__, ZeroDivisionError)
    record = json.loads(Path(found[1]).read_text(encoding="utf-8"))
    assert record["task"] == "friction"
    assert record["arguments"]["model"] == "kinematic"
    assert {"sonolube", "python", "platform"} <= set(record["versions"])
    assert "ZeroDivisionError: of a part" in record["traceback"]
    Path(found[1]).unlink()


def test_a_record_that_cannot_be_written_is_no_second_fault(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(rig_record, "friction_point", broken)
    monkeypatch.setattr("tempfile.mkdtemp", broken)
    with raises(UnexpectedFault, match=r"by the form Fault on the page of the repository$"):
        sl.friction(RIG)


def test_a_record_has_small_files_and_the_names_of_others(tmp_path: Path) -> None:
    small, large = tmp_path / "a.csv", tmp_path / "b.csv"
    small.write_bytes(b"abc")
    large.write_bytes(bytes(300_000))
    arguments = {"files": [small, large], "bytes": NamedBytes("c", b"abc"), "text": "y" * 9000, "over": {"a": (1, 2)}}
    fault = faults.unexpected(ValueError("x" * 9000), "t", arguments | {"rig": KNOWN, "odd": Unprintable()})
    assert len(str(fault)) < 1000
    file = Path(str(fault).partition(", and attach ")[2].partition(",")[0])
    content = json.loads(file.read_text(encoding="utf-8"))["arguments"]
    assert content["files"] == [{"path": str(small), "base64": "YWJj"}, {"path": str(large)}]
    assert content["bytes"] == {"name": "c", "base64": "YWJj"}
    assert (content["rig"], content["odd"]) == (f"DrivenRig {RIG}", "Unprintable")
    assert (len(content["text"]), content["over"]) == (2000, {"a": [1, 2]})
    file.unlink()


@answer
class Nothing(Answer):
    pass


def test_exceptions_of_the_callers_functions_and_of_memory_stay_what_they_are() -> None:
    def failing(*_: object) -> NoReturn:
        raise KeyError("mine")

    with raises(KeyError, match="mine"):
        sl.sweep(RIG, over={"sliding.sliding_speed": [0.02, 0.03]}, progress=failing)

    @task
    def large(rig: RigFile) -> Nothing:
        """Take all memory."""
        raise MemoryError

    with raises(MemoryError):
        large(KNOWN)


def test_what_the_system_refuses_is_one_line_with_the_file() -> None:
    refused = faults.refused_by_system(PermissionError(13, "Permission denied", "/a\nb"))
    assert str(refused) == "/a\\nb: Permission denied"
    assert isinstance(refused, OSError)
    assert str(faults.refused_by_system(OSError())) == "OSError"


def test_names_of_private_files_are_found_in_long_texts_too() -> None:
    text = "x" * 2_000_000
    assert with_names_only(text) == text
    assert with_names_only(f"{text} /tmp/sonolube-bytes-ab_1{os.sep}a.csv: is empty") == f"{text} a.csv: is empty"
    assert with_names_only("sonolube-bytes-" * 2_000) == "sonolube-bytes-" * 2_000


def test_a_long_key_of_a_mapping_is_refused_briefly() -> None:
    toml = f'[channels.{"k" * 50_000}]\ncolumn = "a"\n'.encode()
    with raises(SonolubeError) as refused:
        sl.measure.friction(NamedBytes("a.csv", b"a,b\n1,2\n"), mapping=NamedBytes("m.toml", toml))
    assert len(str(refused.value)) < 4100


def test_the_boundary_imports_neither_pandas_nor_xarray_nor_pint() -> None:
    code = (
        "import sys, sonolube.tasks.boundary\n"
        "print([name for name in ('pandas', 'xarray', 'pint', 'numpy') if name in sys.modules])"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"


def test_a_value_is_described_briefly_whatever_it_holds() -> None:
    long = ("x" * 10**6, list(range(10**6)), {"a" * 10**5: [1] * 10**5}, 10**5000, [Unprintable()], b"\0" * 10**6)
    for value in long:
        text = described(value)
        assert len(text) <= 200
        assert "\n" not in text


@mark.parametrize("head", [b"", b"LabVIEW Measurement\n", b"a,b\n1,2\n"])
@mark.parametrize("name", ["a.tdms", "a.lvm", "a.csv", "a.mat", "a.toml"])
def test_a_file_is_judged_by_its_size_and_first_bytes_before_it_is_read(
    tmp_path: Path, monkeypatch: MonkeyPatch, name: str, head: bytes
) -> None:
    def read(*_: object, **__: object) -> NoReturn:
        raise AssertionError

    monkeypatch.setattr(Path, "read_bytes", read)
    monkeypatch.setattr("hashlib.file_digest", read)
    path = tmp_path / name
    with path.open("wb") as stream:
        stream.write(head)
        stream.truncate(3 * 10**9)
    for function in (sl.measure.friction, sl.measure.surface, sl.measure.impedance, sl.mapping, sl.fit, sl.contact):
        call: Any = function
        with raises(SonolubeError, match=re.escape(name)) as refused:
            call(path)
        assert not isinstance(refused.value, UnexpectedFault)
        assert not str(refused.value).endswith(":")


@mark.parametrize("title", ["a\nb", "a\r\nb", "a\u2028b"])
def test_a_title_of_several_lines_is_refused(title: str) -> None:
    content = RIG.read_text(encoding="utf-8").replace('title = "', f"title = {json.dumps(title)}\n#", 1)
    with raises(InvalidInput, match="title"):
        sl.contact(NamedBytes("a.toml", content.encode()))
