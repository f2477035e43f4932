"""No test compares by `==` numbers that two ways computed; they agree to rounding, by `tests.same` or `approx`.

Found are two numbers, arrays, datasets, objects of JSON or contents of files that are held equal and of which none is
written out in the test, and two results of one function. A name stands for what it was bound to last.
"""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

TESTS = Path(__file__).parent

NUMBERS = {"float", "item", "mean", "median", "norm", "quantile", "std", "to_numpy", "values"}
OBJECTS = {"answer", "dataset", "json", "json_object", "loads", "object", "to_json"}
FILES = {"content", "files", "netcdf", "read_bytes", "read_text", "tobytes"}
EQUALITIES = {"array_equal", "assert_array_equal", "assert_equal", "assert_identical", "equals", "identical"}
COPIES = {"asarray", "concatenate", "dict", "items", "list", "load", "ravel", "reshape", "sorted", "tolist", "tuple"}
WORDS = {  # what gives words, paths and whole numbers, whatever numbers it is given
    *("Path", "argmax", "argmin", "bool", "count", "elements", "get_ylabel", "glob", "isfinite", "isin", "isnan"),
    *("int", "iterdir", "keys", "len", "repr", "rglob", "set", "str"),
    *("contents", "daqmx_resource", "names", "notes_of", "orders", "printable", "status_counts", "visa_resource"),
}

# comparisons of one number, by file: how many are found, and why both sides are that number
ONE_NUMBER: dict[str, tuple[int, str]] = {
    "browser/lab/test_protocol_view.py": (1, "words"),
    "browser/lab/test_runs_view.py": (1, "words"),
    "browser/test_added_step_page.py": (1, "a row, which is a whole number"),
    "browser/test_live_run.py": (2, "extremes are samples"),
    "browser/test_mode_view.py": (4, "words, digits as they are shown, and a file that is read back"),
    "browser/test_pages.py": (2, "digits that are shown"),
    "browser/test_proxy.py": (1, "digits that are shown"),
    "browser/test_recording_view.py": (2, "extremes are samples, and a view is kept"),
    "browser/test_scan_walk.py": (2, "ends of a section that stay as they are"),
    "browser/test_server.py": (1, "a file that is sent"),
    "browser/test_taken_away.py": (1, "a file that is read back"),
    "browser/test_uploads.py": (2, "words, and a file that is sent"),
    "browser/test_worker.py": (3, "the same reply, and the number of a process"),
    "browser/test_worker_pool.py": (1, "words"),
    "charts/test_thinning.py": (1, "extremes are samples"),
    "cli/console/test_outputs.py": (1, "files that stay as they are"),
    "cli/design/test_plan.py": (1, "friction of the same row"),
    "cli/design/test_sweep.py": (2, "words"),
    "cli/lab/test_lab_commands.py": (1, "a whole number"),
    "cli/lookup/test_mapping.py": (2, "words"),
    "cli/predict/test_model_range.py": (1, "a ratio that is kept as it is"),
    "cli/predict/test_rig_record.py": (1, "words"),
    "cli/test_interruption.py": (1, "docs/commands.md promises a resumed sweep to the last bit"),
    "cli/test_one_answer.py": (1, "digits that are printed"),
    "cli/test_one_default.py": (2, "words"),
    "design/fmu/test_units.py": (4, "docs/fmu.md promises the same unit to the last byte"),
    "design/horns/test_profile.py": (2, "ends of lines that are drawn from one point"),
    "design/optimisation/test_design_output.py": (1, "text that is written twice"),
    "design/test_horn_drawing.py": (1, "one solid, written twice"),
    "design/test_parameter_sweep.py": (4, "docs/commands.md promises a resumed sweep to the last bit, by any workers"),
    "design/test_sobol.py": (2, "columns that are copied"),
    "facts/protocol/test_edits.py": (5, "text that is read"),
    "facts/protocol/test_library.py": (1, "text that is read"),
    "facts/protocol/test_protocol.py": (3, "text that is read back"),
    "facts/published/test_derived_statements.py": (1, "one printed number"),
    "facts/published/test_printed_tables.py": (1, "a table and its dataset"),
    "facts/published/test_values.py": (1, "one printed number"),
    "laboratory/catalogue/test_catalogue.py": (1, "a file that stays as it is"),
    "laboratory/records/test_exports.py": (1, "samples that are stored"),
    "laboratory/records/test_observation.py": (
        2,
        "samples that are stored; docs/commands.md promises a watched run byte by byte",
    ),
    "laboratory/records/test_raw_blocks.py": (2, "samples that are stored"),
    "laboratory/records/test_recorded_part.py": (2, "samples that are stored"),
    "laboratory/records/test_recorder.py": (5, "samples that are stored"),
    "laboratory/records/test_recovery.py": (3, "samples that are stored"),
    "laboratory/records/test_set_points.py": (5, "set points that are stored"),
    "laboratory/test_interlocks.py": (1, "settings by default"),
    "laboratory/test_watching.py": (1, "samples that are shown"),
    "laboratory/virtual_tribometer/test_disturbances.py": (1, "settings that are kept"),
    "laboratory/virtual_tribometer/test_truth.py": (1, "the load of the rig by default"),
    "measurement/mode_shapes/test_mode_shapes.py": (2, "one file in two forms, which are read"),
    "measurement/recordings/test_pyramid.py": (4, "extremes are samples"),
    "measurement/recordings/test_reader.py": (5, "samples that are read"),
    "measurement/surface_files/test_lateral_units.py": (1, "heights that are read"),
    "measurement/surface_files/test_reader.py": (1, "heights that are read"),
    "measurement/surface_files/test_xyz.py": (1, "heights that are read"),
    "measurement/test_limits.py": (1, "samples that are read"),
    "measurement/test_measured_runs.py": (1, "a table that is read"),
    "measurement/test_run_table.py": (1, "a mapping that is read back"),
    "models/dynamics/gap_laws/test_tabulated.py": (1, "statuses"),
    "models/dynamics/test_structure.py": (1, "a copy"),
    "models/fem/solver/test_multifrontal.py": (1, "whole numbers"),
    "models/surfaces/test_finish.py": (1, "a grade of a table"),
    "models/surfaces/test_gaussian_filter.py": (1, "a constant is promised to be reproduced exactly"),
    "prediction/test_calibration.py": (1, "whole numbers"),
    "report/test_measurement.py": (1, "rows without an entry"),
    "rig/test_datasets.py": (2, "arrays that are stored"),
    "rig/test_lubrication.py": (1, "names"),
    "rig/test_parametric_study.py": (1, "a dataset that is stored"),
    "rig/test_rig_object.py": (2, "entries of a file, written and read back"),
    "rig/test_start_up_transient.py": (1, "text that is read"),
    "studies/dong2015/hardware/test_collar_designs.py": (1, "sizes that are copied"),
    "studies/dong2015/test_report.py": (1, "one answer, written and read back"),
    "tasks/impedance/test_computed_impedance.py": (2, "keys and kinds"),
    "tasks/lookup/test_example.py": (2, "files that are written and read"),
    "tasks/lookup/test_lookup.py": (1, "one answer, printed and read back"),
    "tasks/measure/test_measured_files.py": (3, "one answer, stored and read back"),
    "tasks/predict/test_new.py": (1, "entries of a file, written and read back"),
    "tasks/test_answer.py": (1, "words"),
    "test_gallery.py": (2, "colours that stay as they are"),
    "test_tiers.py": (2, "names of tests"),
    "test_wheel.py": (2, "files of one archive"),
    "validation/test_nptdms_whole_file.py": (1, "samples that are read by two programs"),
    "validation/test_salib_sobol.py": (1, "columns that are copied"),
    "validation/test_study_table.py": (1, "empty cells"),
}

Bindings = dict[str, ast.expr]


def name_of(node: ast.expr) -> str:
    """Last name of a function, method, attribute or variable; of a call, that of the function."""
    match node:
        case ast.Call(func=function):
            return name_of(function)
        case ast.Attribute(attr=name) | ast.Name(id=name):
            return name
    return ""


def origins(node: ast.expr, known: Bindings) -> Iterator[ast.expr]:
    """Calls, attributes and constants that a value is made of, through copies, choices, sums and names."""
    parts: list[ast.expr]
    match node:
        case ast.Name(id=name) if name in known:
            parts = [known[name]]
            known = {each: value for each, value in known.items() if each != name}  # lest it be bound to itself
        case ast.Subscript(value=part) | ast.Starred(value=part) | ast.UnaryOp(operand=part):
            parts = [part]
        case ast.ListComp(elt=part) | ast.GeneratorExp(elt=part) | ast.DictComp(value=part):
            parts = [part]
        case ast.List(elts=parts) | ast.Tuple(elts=parts) | ast.Dict(values=parts):
            pass
        case ast.BinOp(left=one, right=other) | ast.IfExp(body=one, orelse=other):
            parts = [one, other]
        case ast.Call(func=ast.Attribute(value=part), args=[]) | ast.Call(args=[part, *_]) if name_of(node) in COPIES:
            parts = [part]
        case _:
            yield node
            return
    for part in parts:
        yield from origins(part, known)


def bindings(function: ast.AST) -> Bindings:
    """Names of a function with what they are bound to, item by item; an item of a loop stands for all of them."""
    found: Bindings = {}
    for node in ast.walk(function):
        match node:
            case ast.Assign(targets=[target], value=value):
                found |= bound(target, value)
            case ast.For(target=target, iter=value) | ast.comprehension(target=target, iter=value):
                found |= bound(target, value)
            case ast.withitem(context_expr=value, optional_vars=ast.expr() as target):
                found |= bound(target, value)
    return found


def bound(target: ast.expr, value: ast.expr) -> Bindings:
    """Names of a target with the parts of a value."""
    match target, value:
        case ast.Name(id=name), _:
            return {name: value}
        case (ast.Tuple(elts=names), ast.Tuple(elts=parts)) if len(names) == len(parts):
            pairs = zip(names, parts, strict=True)
            return {name: part for one, each in pairs for name, part in bound(one, each).items()}
        case ast.Tuple(elts=names), _:
            return {name: part for one in names for name, part in bound(one, value).items()}
    return {}


def compared(statement: ast.AST) -> Iterator[tuple[ast.expr, ast.expr, bool]]:
    """Pairs that a statement holds equal, and whether by a function for arrays and datasets."""
    denied = {node.operand for node in ast.walk(statement) if isinstance(node, ast.UnaryOp)}
    for node in ast.walk(statement):
        match node:
            case ast.Compare(left=left, ops=operators, comparators=others):
                for operator, one, other in zip(operators, [left, *others], others, strict=False):
                    if isinstance(operator, ast.Eq):
                        yield one, other, False
            case ast.Call(func=ast.Attribute(value=one, attr="equals" | "identical"), args=[other]):
                yield one, other, True
            case ast.Call(args=[one, other, *_]) if name_of(node) in EQUALITIES and node not in denied:
                yield one, other, True


def is_suspect(one: ast.expr, other: ast.expr, known: Bindings, *, is_array: bool) -> bool:
    """Whether both may be numbers, or files of numbers, that were computed."""
    sides = [list(origins(each, known)) for each in (one, other)]
    names = [{name_of(part) for part in parts} - {"", "inf", "nan"} for parts in sides]
    if not all(names) or any(each & (WORDS | {"approx"}) for each in names):
        return False
    calls = [{name_of(part) for part in parts if isinstance(part, ast.Call)} for parts in sides]
    kinds = [NUMBERS | OBJECTS, FILES | OBJECTS]
    return is_array or bool(calls[0] & calls[1]) or any(names[0] & kind and names[1] & kind for kind in kinds)


def is_order(one: ast.expr, other: ast.expr) -> bool:
    """Whether the order of values is looked at: they are compared with themselves, sorted."""
    match other:
        case ast.Call(func=ast.Name(id="sorted"), args=[part]):
            return ast.dump(part) == ast.dump(one)
    return False


def faults(source: str) -> Iterator[str]:
    """Comparisons of computed numbers in the functions of a source."""
    for function in ast.parse(source).body:
        known = bindings(function)
        for statement in ast.walk(function):
            if isinstance(statement, ast.Assert | ast.Expr):
                for one, other, is_array in compared(statement):
                    if is_suspect(one, other, known, is_array=is_array) and not is_order(one, other):
                        yield f"line {one.lineno}: {ast.unparse(one)} == {ast.unparse(other)}"


@pytest.mark.parametrize(
    ("body", "count"),
    [
        ("assert predict(a) == predict(b)", 1),
        ("one, other = predict(a), predict(b)\n    assert one == other", 1),
        ("one, other = (predict(each) for each in rigs)\n    assert one == other", 1),
        ("found = [predict(each) for each in rigs]\n    assert found[0] == found[1]", 1),
        ("assert answer.json_object() == json.loads(run.stdout)", 1),
        ("low, high = data.quantile([0.1, 0.9]).to_numpy()\n    assert [low, high] == answer.object()['interval']", 1),
        ("assert float(data['ratio']) == np.mean(values)", 1),
        ("assert one.values.tolist() == float(other)", 1),
        ("for name, content in answer.files().items():\n        assert (folder / name).read_bytes() == content", 1),
        ("assert np.array_equal(batch.ratio, alone.ratio)", 1),
        ("np.testing.assert_array_equal(fast(x), slow(x))", 1),
        ("assert one.dataset().identical(other.dataset())", 1),
        ("xr.testing.assert_identical(first, second)", 1),
        ("assert predict(a) == predict(b) == predict(c)", 2),
        ("assert float(data['ratio']) == 0.5", 0),
        ("assert data.to_numpy().tolist() == [0.5, np.nan]", 0),
        ("assert data.to_numpy() == approx(other.to_numpy())", 0),
        ("same(predict(a), predict(b))", 0),
        ("assert answer.object()['models'] == names", 0),
        ("assert predict(a) != predict(b)", 0),
        ("assert not np.array_equal(one, other)", 0),
        ("assert np.array_equal(np.isnan(one), refused)", 0),
        ("assert len(one.values) == len(other.values)", 0),
        ("widths = list(data.values)\n    assert widths == sorted(widths)", 0),
    ],
)
def test_numbers_of_two_ways_held_equal_are_found(body: str, count: int) -> None:
    assert len(list(faults(f"def test() -> None:\n    {body}\n"))) == count


def test_no_test_holds_numbers_equal_that_two_ways_computed() -> None:
    sources = {path.relative_to(TESTS).as_posix(): path.read_text(encoding="utf-8") for path in TESTS.rglob("*.py")}
    sources.pop("same.py")  # which compares for all
    found = {name: list(faults(source)) for name, source in sources.items()}
    counts = {name: len(each) for name, each in found.items() if each}
    known = {name: count for name, (count, _) in ONE_NUMBER.items()}
    wrong = [name for name in counts | known if counts.get(name) != known.get(name)]
    assert not wrong, {name: found.get(name) for name in wrong}
