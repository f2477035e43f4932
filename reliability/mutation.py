"""Mutants, one changed comparison, constant, sign, call, argument or condition each, run against their tests.

A mutant is named by its file, the text of its line and the place in it, so that the list outlives changes elsewhere.
"""

import ast
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src" / "sonolube"
_OTHER_TESTS = ("tests/validation", "tests/rig", "tests/studies", "tests/design", "tests/measurement")
_LIMIT = 900.0  # s, of the tests of a stage
_NOT_A_FAILURE = (0, 5)  # exit statuses of pytest: all pass, none collected
_NOT_RUN = 4  # exit status of pytest: a test is not there, or the import of its file fails
_DEFINITIONS = (ast.FunctionDef, ast.ClassDef)
_OPERATORS: dict[type, tuple[str, ...]] = {
    ast.Add: ("+", "-"), ast.Sub: ("-", "+"), ast.Mult: ("*", "/"), ast.Div: ("/", "*"), ast.Pow: ("**", "*"),
    ast.Lt: ("<", ">"), ast.Gt: (">", "<"), ast.LtE: ("<=", ">"), ast.GtE: (">=", "<"),
    ast.Eq: ("==", "!="), ast.NotEq: ("!=", "=="), ast.FloorDiv: ("//", "/"), ast.Mod: ("%", "*"),
    ast.Is: ("is", "is not"), ast.IsNot: ("is not", "is"), ast.In: ("in", "not in"), ast.NotIn: ("not in", "in"),
}  # fmt: skip
_BOUNDS = {"<": "<=", "<=": "<", ">": ">=", ">=": ">"}  # where integers are compared
_NAMES = {
    "sin": "cos", "cos": "sin", "maximum": "minimum", "minimum": "maximum", "max": "min", "min": "max", "real": "imag",
    "imag": "real", "sinh": "cosh", "cosh": "sinh", "log": "sqrt", "exp": "expm1", "argmax": "argmin",
    "argmin": "argmax", "cumsum": "cumprod", "conj": "abs", "i0e": "i1e", "i1e": "i0e", "k0": "k1",
    "ellipk": "ellipe", "ellipe": "ellipk", "any": "all", "all": "any", "floor": "ceil", "ceil": "floor",
}  # fmt: skip
_SYMMETRIC = ("min", "max", "minimum", "maximum", "isclose", "allclose", "hypot", "gcd")  # in their first arguments
_DROPPED = ("abs", "sorted", "reversed", "round", "sqrt", "log", "log10", "exp", "unique", "sort", "strip", "deg2rad")
_NOT_MODELS = ("figure", "__init__", "mode_files")
_NOT_PHYSICS = ("Invalid", "Outside", "Unknown", "warn", "approx_text", "format_si", "njit", "VariantTable", "Field")
_LOOKS = (
    "size",
    "width",
    "alpha",
    "zorder",
    "dpi",
    "pad",
    "style",
    "colour",
    "color",
    "rotation",
    "ncol",
    "loc",
    "heights",
    "columns",
)
_SWAPPED = 2  # arguments that are swapped, the first of a call


@dataclass(frozen=True, kw_only=True, slots=True)
class Mutant:
    """A change of one place of a line.

    Parameters
    ----------
    file : str
        Below src/sonolube.
    line : str
        Text of the line, without indentation.
    occurrence : int
        Which of the equal lines of the file, from 0.
    column : int
        Of the changed text in `line`.
    old, new : str
        The text and its replacement.
    """

    file: str
    line: str
    occurrence: int
    column: int
    old: str
    new: str

    def row(self, text: str) -> int | None:
        """Row of the line in the text of its file, from 0; None where the line is no longer there."""
        found = [i for i, each in enumerate(text.splitlines()) if each.strip() == self.line]
        return found[self.occurrence] if len(found) > self.occurrence else None

    def applied(self, text: str) -> str | None:
        """Text of the file with the change; None where the line is no longer there."""
        if (i := self.row(text)) is None:
            return None
        lines = text.splitlines(keepends=True)
        start = len(lines[i]) - len(lines[i].lstrip()) + self.column
        if not lines[i].startswith(self.old, start):
            return None
        lines[i] = lines[i][:start] + self.new + lines[i][start + len(self.old) :]
        return "".join(lines)

    def __str__(self) -> str:
        changed = self.line[: self.column] + self.new + self.line[self.column + len(self.old) :]
        return f"{self.file}: {self.line}  ->  {changed}"


class _Finder(ast.NodeVisitor):
    """Places of a module to change: row, column, old and new text."""

    def __init__(self, lines: list[str]) -> None:
        self.lines = lines
        self.places: list[tuple[int, int, str, str]] = []

    def visit_Raise(self, node: ast.Raise) -> None: ...
    def visit_Assert(self, node: ast.Assert) -> None: ...
    def visit_JoinedStr(self, node: ast.JoinedStr) -> None: ...
    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self.visit(node.value)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        for statement in node.body:
            self.visit(statement)

    def visit_ClassDef(self, node: ast.ClassDef) -> None:
        for statement in node.body:
            self.visit(statement)

    def visit_Subscript(self, node: ast.Subscript) -> None:
        self.visit(node.value)

    def visit_Slice(self, node: ast.Slice) -> None: ...

    def visit_If(self, node: ast.If) -> None:
        if ast.unparse(node.test) in ("TYPE_CHECKING", "__name__ == '__main__'"):
            return
        self._inverted(node.test)
        self.generic_visit(node)

    def visit_IfExp(self, node: ast.IfExp) -> None:
        self._inverted(node.test)
        self.generic_visit(node)

    def visit_comprehension(self, node: ast.comprehension) -> None:
        for test in node.ifs:
            self._inverted(test)
        self.generic_visit(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> None:
        old, new = ("and", "or") if isinstance(node.op, ast.And) else ("or", "and")
        self._between(node.values[0], node.values[1], old, new)
        self.generic_visit(node)

    def visit_Expr(self, node: ast.Expr) -> None:
        if isinstance(node.value, ast.Call) and (text := self._text(node.value)):
            self._add(node.lineno, node.col_offset, text, "None")
        self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> None:
        name = ast.unparse(node.func).rpartition(".")[2]
        if name.startswith(_NOT_PHYSICS):
            return
        if name in _NAMES and node.func.end_col_offset is not None and node.func.lineno == node.func.end_lineno:
            self._add(node.func.lineno, node.func.end_col_offset - len(name), name, _NAMES[name])
        self._dropped(node, name)
        if name not in _SYMMETRIC:
            self._swapped(node)
        for child in ast.iter_child_nodes(node):
            if name != "zip" or not isinstance(child, ast.keyword):  # strict= changes nothing among equal lengths
                self.visit(child)

    def visit_keyword(self, node: ast.keyword) -> None:
        if not str(node.arg).endswith(_LOOKS):
            self.generic_visit(node)

    def visit_Attribute(self, node: ast.Attribute) -> None:
        if node.attr in ("real", "imag") and node.end_lineno == node.lineno and node.end_col_offset is not None:
            self._add(node.lineno, node.end_col_offset - 4, node.attr, _NAMES[node.attr])
        self.generic_visit(node)

    def visit_BinOp(self, node: ast.BinOp) -> None:
        if not _is_text(node.left) and not _is_text(node.right):
            self._operator(node.left, node.op, node.right)
        self.generic_visit(node)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        old, *new = _OPERATORS.get(type(node.op), ("",))
        if new and not _is_text(node.value):
            self._between(node.target, node.value, f"{old}=", f"{new[0]}=")
        self.generic_visit(node)

    def visit_Compare(self, node: ast.Compare) -> None:
        right = node.comparators[0]
        self._operator(node.left, node.ops[0], right)
        old = _OPERATORS.get(type(node.ops[0]), ("",))[0]
        if old in _BOUNDS and (_is_whole(node.left) or _is_whole(right)):
            self._between(node.left, right, old, _BOUNDS[old])
        self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        if isinstance(node.op, ast.USub) and not isinstance(node.operand, ast.Constant):
            self._add(node.lineno, node.col_offset, "-", "")
        self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> None:
        if node.end_col_offset is None:
            return
        if type(node.value) is bool:
            self._add(node.lineno, node.col_offset, str(node.value), str(not node.value))
        if type(node.value) in (int, float):
            old = self.lines[node.lineno - 1][node.col_offset : node.end_col_offset]
            value = node.value
            self._add(node.lineno, node.col_offset, old, "1" if value == 0 else "2" if value == 1 else _larger(old))

    def _inverted(self, test: ast.expr) -> None:
        if not isinstance(test, ast.Compare | ast.NamedExpr) and (text := self._text(test)):
            self._add(test.lineno, test.col_offset, text, f"(not ({text}))")

    def _dropped(self, node: ast.Call, name: str) -> None:
        """A call of one argument that leaves it as it is."""
        if name in _DROPPED and len(node.args) == 1 and not node.keywords:
            text, argument = self._text(node), self._text(node.args[0])
            if text and argument:
                self._add(node.lineno, node.col_offset, text, f"({argument})")

    def _swapped(self, node: ast.Call) -> None:
        """The first two arguments by position, or the values of two by name, in each other's place."""
        pair: Sequence[ast.expr] = node.args[:_SWAPPED]
        if len(pair) < _SWAPPED:
            named = [each.value for each in node.keywords]
            pair = [value for value in named if isinstance(value, ast.Name | ast.Attribute)][:_SWAPPED]
        if len(pair) < _SWAPPED or any(isinstance(each, ast.Constant | ast.Starred | ast.JoinedStr) for each in pair):
            return
        first, second = pair
        before, after = self._text(first), self._text(second)
        if before and after and first.lineno == second.lineno and before != after:
            line = self.lines[first.lineno - 1]
            between = line[first.end_col_offset : second.col_offset]
            self._add(first.lineno, first.col_offset, f"{before}{between}{after}", f"{after}{between}{before}")

    def _operator(self, left: ast.expr, op: ast.AST, right: ast.expr) -> None:
        if type(op) in _OPERATORS:
            old, new = _OPERATORS[type(op)]
            self._between(left, right, old, new)

    def _between(self, left: ast.expr, right: ast.expr, old: str, new: str) -> None:
        if left.end_lineno != right.lineno or left.end_col_offset is None:
            return
        between = self.lines[right.lineno - 1][left.end_col_offset : right.col_offset]
        if between.count(old) == 1 and not (old == "*" and "**" in between):
            self._add(right.lineno, left.end_col_offset + between.index(old), old, new)

    def _text(self, node: ast.expr) -> str:
        """Text of an expression on one line; "" of one on several."""
        if node.lineno != node.end_lineno or node.end_col_offset is None:
            return ""
        return self.lines[node.lineno - 1][node.col_offset : node.end_col_offset]

    def _add(self, row: int, column: int, old: str, new: str) -> None:
        if self.lines[row - 1].isascii():
            self.places.append((row, column, old, new))


def _is_text(node: ast.expr) -> bool:
    """Whether an expression is plainly a text or a list, whose sum has no difference."""
    return isinstance(node, ast.JoinedStr | ast.List | ast.Tuple) or (
        isinstance(node, ast.Constant) and isinstance(node.value, str | bytes)
    )


def _is_whole(node: ast.expr) -> bool:
    """Whether an expression is plainly a whole number."""
    counted = isinstance(node, ast.Call) and ast.unparse(node.func) == "len"
    return counted or (isinstance(node, ast.Constant) and type(node.value) is int and node.value > 0)


def _larger(old: str) -> str:
    """Constant half as large again, a whole one by one more."""
    return f"({old} + 1)" if old.isdecimal() and int(old) > 1 else f"(1.5 * {old})"


def mutants_of(file: Path) -> list[Mutant]:
    """All mutants of a module."""
    text = file.read_text(encoding="utf-8")
    lines = text.splitlines()
    finder = _Finder(lines)
    finder.visit(ast.parse(text))
    return [_mutant(file, lines, *place) for place in sorted(set(finder.places))]


def _mutant(file: Path, lines: list[str], row: int, column: int, old: str, new: str) -> Mutant:
    line = lines[row - 1]
    stripped = line.strip()
    return Mutant(
        file=file.relative_to(SOURCE).as_posix(), line=stripped,
        occurrence=sum(each.strip() == stripped for each in lines[: row - 1]),
        column=column - (len(line) - len(line.lstrip())), old=old, new=new,
    )  # fmt: skip


def sampled(rooms: Mapping[str, int], *, kept: Sequence[Mutant] = (), seed: int = 0) -> Iterator[Mutant]:
    """Mutants drawn from rooms, with those kept as many as a room is to have, at most one a line."""
    rng = random.Random(seed)
    for room, number in rooms.items():
        files = sorted((SOURCE / room).rglob("*.py")) or [SOURCE / room]
        computing = [file for file in files if not any(word in file.as_posix() for word in _NOT_MODELS)]
        found = [mutant for file in computing for mutant in mutants_of(file)]
        rng.shuffle(found)
        lines = {(mutant.file, mutant.line) for mutant in kept if mutant.file.startswith(room)}
        for mutant in found:
            if (mutant.file, mutant.line) not in lines and len(lines) < number:
                lines.add((mutant.file, mutant.line))
                yield mutant


def room_of(file: str) -> Path:
    """Folder of a module's room below src/sonolube, and of its tests below tests: models/contact, or rig."""
    parts = Path(file).parts
    return Path(*parts[: 2 if parts[0] in ("models", "facts") else 1])


def tests_of(file: str) -> list[list[str]]:
    """Tests to run against a module in turn: its own, its room's, and last those above.

    Tests that name what the module defines stand first in their stage.
    """
    path = Path(file)
    names = re.compile(rf"\b({'|'.join(_public_names(file))})\b")
    every = sorted(
        (ROOT / "tests").rglob("test_*.py"), key=lambda test: not names.search(test.read_text(encoding="utf-8"))
    )
    room = [test for test in every if test.relative_to(ROOT / "tests").is_relative_to(room_of(file))]
    own = [test for test in room if test.stem == f"test_{path.stem}"]
    naming = [test for test in every if test not in room and names.search(test.read_text(encoding="utf-8"))]
    naming.sort(key=lambda test: _OTHER_TESTS[0] not in test.as_posix())
    stages = (own, [test for test in room if test not in own], naming)
    named = [[test.relative_to(ROOT).as_posix() for test in stage] for stage in stages]
    return [*named[:2], [*named[2], *_OTHER_TESTS]]


def _public_names(file: str) -> list[str]:
    """Names that a module defines, without those that begin with an underscore; its own where there are none."""
    body = ast.parse((SOURCE / file).read_text(encoding="utf-8")).body
    defined = [node.name for node in body if isinstance(node, _DEFINITIONS) and not node.name.startswith("_")]
    constants = [
        target.id
        for node in body
        if isinstance(node, ast.Assign)
        for target in node.targets
        if isinstance(target, ast.Name) and not target.id.startswith("_")
    ]
    return [*defined, *constants] or [Path(file).stem]


def _compiled_with(file: str) -> Iterator[str]:
    """The module and those with compiled kernels that name something of it, or of such a module: their caches age."""
    kernels = {
        path.relative_to(SOURCE).as_posix(): text
        for path in SOURCE.rglob("*.py")
        if "numba" in (text := path.read_text(encoding="utf-8"))
    }
    waiting = [file]
    while waiting:
        yield (module := waiting.pop())
        kernels.pop(module, None)
        names = re.compile(rf"\b({'|'.join(_public_names(module))})\b")
        naming = [other for other, text in kernels.items() if names.search(text)]
        waiting += naming
        for other in naming:
            del kernels[other]


@cache
def _copy() -> Path:
    """Copy of the package for this process, whose mutants follow one another."""
    folder = Path(tempfile.mkdtemp(prefix="mutants-"))
    (folder / "examples").symlink_to(ROOT / "examples")  # which the package finds from its own place
    return Path(shutil.copytree(SOURCE, folder / "src" / "sonolube"))


def first_failure(mutant: Mutant, stages: Sequence[Sequence[str]], *, limit: float = _LIMIT) -> str:
    """First test that fails with a mutant among stages of tests, "" where all pass.

    Parameters
    ----------
    mutant : Mutant
    stages : sequence of sequence of str
        Names of tests or of their files; a stage runs in one process, the next only where it passes.
    limit : float
        Of a stage, after which the mutant counts as found: a mutant may loop. [s]

    Raises
    ------
    LookupError
        If the line of the mutant is no longer there.
    """
    original = (SOURCE / mutant.file).read_text(encoding="utf-8")
    changed = mutant.applied(original)
    if changed is None:
        raise LookupError(f"the line of a mutant is gone: {mutant}")
    copy = _copy()
    for module in map(Path, _compiled_with(mutant.file)):  # callers would run what they were compiled with
        for compiled in (copy / module.parent / "__pycache__").glob(f"{module.stem}.*"):
            compiled.unlink()
    environment = {**os.environ, "PYTHONPATH": str(copy.parent), "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg"}
    environment["PYTHONDONTWRITEBYTECODE"] = "1"
    (copy / mutant.file).write_text(changed, encoding="utf-8")
    try:
        for tests in stages:
            if tests and (failed := _failed(tests, environment, limit)):
                return failed
    finally:
        (copy / mutant.file).write_text(original, encoding="utf-8")
    return ""


def _failed(tests: Sequence[str], environment: dict[str, str], limit: float) -> str:
    """First test that fails, or the tests' names where they did not end in time; "" where all pass."""
    options = ["-x", "-q", "--no-header", "-p", "no:cacheprovider", "--tb=no", "-rfE"]
    run = subprocess.Popen(
        [sys.executable, "-m", "pytest", *options, *tests],
        cwd=ROOT,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    try:
        output, errors = run.communicate(timeout=limit)
    except subprocess.TimeoutExpired:
        os.killpg(run.pid, signal.SIGKILL)
        run.communicate()
        return f"{len(tests)} tests did not end within {limit:.0f} s"
    if run.returncode in _NOT_A_FAILURE:
        return ""
    if run.returncode == _NOT_RUN and (there := _there(tests, errors)) != list(tests):
        return _failed(there, environment, limit) if there else ""
    named = [
        line.partition(" ")[2].partition(" - ")[0]
        for line in output.splitlines()
        if line.startswith(("FAILED ", "ERROR "))
    ]
    return named[0] if named else "collection"


def _there(tests: Sequence[str], errors: str) -> list[str]:
    """Tests that pytest has not called missing: one that was renamed must not keep the others from running."""
    missing = [line for line in errors.splitlines() if "not found: " in line]
    return [test for test in tests if not any(line.endswith(test) for line in missing)]


def entries_of(list_file: Path) -> list[dict[str, Any]]:
    """Entries of a list whose lines are still there: mutant, the test that killed it, why it changes nothing."""
    entries = json.loads(list_file.read_text(encoding="utf-8")) if list_file.exists() else []
    return [entry for entry in entries if _is_there(Mutant(**entry["mutant"]))]


def _is_there(mutant: Mutant) -> bool:
    file = SOURCE / mutant.file
    return file.exists() and mutant.applied(file.read_text(encoding="utf-8")) is not None


def main(room: str, number: str, seed: str = "0") -> None:
    """Print mutants drawn from a folder or file below src/sonolube, each with the test of its room that fails."""
    for mutant in sampled({room.removesuffix("/"): int(number)}, seed=int(seed)):
        killed = first_failure(mutant, tests_of(mutant.file)[:2])
        sys.stdout.write(f"{'killed  ' if killed else 'SURVIVED'} {mutant}\n    {killed}\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main(*sys.argv[1:])
