"""Mutants of the models: one changed operator, number or function each, run against the tests of their line.

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
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src" / "sonolube"
ROOMS = {
    "contact": 45, "friction": 60, "wear": 12, "thermal": 35, "actuator": 35, "metrics": 20, "surfaces": 45,
    "dynamics": 30, "fem": 18,
}  # fmt: skip
_OTHER_TESTS = (
    "tests/validation",
    "tests/rig",
    "tests/reproduce",
    "tests/design",
    "tests/dong2015",
    "tests/measurement",
)
_LIMIT = 900.0  # s, of the tests of a stage
_DEFINITIONS = (ast.FunctionDef, ast.ClassDef)
_OPERATORS: dict[type, tuple[str, str]] = {
    ast.Add: ("+", "-"), ast.Sub: ("-", "+"), ast.Mult: ("*", "/"), ast.Div: ("/", "*"), ast.Pow: ("**", "*"),
    ast.Lt: ("<", ">"), ast.Gt: (">", "<"), ast.LtE: ("<=", ">"), ast.GtE: (">=", "<"),
}  # fmt: skip
_NAMES = {
    "sin": "cos", "cos": "sin", "maximum": "minimum", "minimum": "maximum", "max": "min", "min": "max", "real": "imag",
    "imag": "real", "sinh": "cosh", "cosh": "sinh", "log": "sqrt", "exp": "expm1", "argmax": "argmin",
    "argmin": "argmax", "cumsum": "cumprod", "conj": "abs", "i0e": "i1e", "i1e": "i0e", "k0": "k1",
    "ellipk": "ellipe", "ellipe": "ellipk",
}  # fmt: skip
_NOT_MODELS = ("figure", "/gpu/", "__init__", "mode_files")
_NOT_PHYSICS = ("require", "Invalid", "Outside", "Unknown", "warn", "approx_text", "format_si", "njit", "VariantTable")


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

    def applied(self, text: str) -> str | None:
        """Text of the file with the change; None where the line is no longer there."""
        lines = text.splitlines(keepends=True)
        found = [i for i, each in enumerate(lines) if each.strip() == self.line]
        if len(found) <= self.occurrence:
            return None
        i = found[self.occurrence]
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

    def visit_Subscript(self, node: ast.Subscript) -> None:
        self.visit(node.value)

    def visit_Call(self, node: ast.Call) -> None:
        name = ast.unparse(node.func).rpartition(".")[2]
        if name.startswith(_NOT_PHYSICS):
            return
        if name in _NAMES and node.func.end_col_offset is not None and node.func.lineno == node.func.end_lineno:
            self._add(node.func.lineno, node.func.end_col_offset - len(name), name, _NAMES[name])
        self.generic_visit(node)

    def visit_Attribute(self, node: ast.Attribute) -> None:
        if node.attr in ("real", "imag") and node.end_lineno == node.lineno and node.end_col_offset is not None:
            self._add(node.lineno, node.end_col_offset - 4, node.attr, _NAMES[node.attr])
        self.generic_visit(node)

    def visit_BinOp(self, node: ast.BinOp) -> None:
        self._operator(node.left, node.op, node.right)
        self.generic_visit(node)

    def visit_Compare(self, node: ast.Compare) -> None:
        self._operator(node.left, node.ops[0], node.comparators[0])
        self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        if isinstance(node.op, ast.USub) and not isinstance(node.operand, ast.Constant):
            self._add(node.lineno, node.col_offset, "-", "")
        self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> None:
        if type(node.value) in (int, float) and node.end_col_offset is not None:
            old = self.lines[node.lineno - 1][node.col_offset : node.end_col_offset]
            value = node.value
            self._add(node.lineno, node.col_offset, old, "1" if value == 0 else "2" if value == 1 else f"(1.5 * {old})")

    def _operator(self, left: ast.expr, op: ast.AST, right: ast.expr) -> None:
        if type(op) not in _OPERATORS or left.end_lineno != right.lineno or left.end_col_offset is None:
            return
        old, new = _OPERATORS[type(op)]
        between = self.lines[right.lineno - 1][left.end_col_offset : right.col_offset]
        if between.count(old) == 1 and not ("*" in old and old == "*" and "**" in between):
            self._add(right.lineno, left.end_col_offset + between.index(old), old, new)

    def _add(self, row: int, column: int, old: str, new: str) -> None:
        if self.lines[row - 1].isascii():
            self.places.append((row, column, old, new))


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


def sampled(seed: int = 0) -> Iterator[Mutant]:
    """Mutants drawn from every room of models, as many as ROOMS says, at most one a line."""
    rng = random.Random(seed)
    for room, number in ROOMS.items():
        files = sorted((SOURCE / room).rglob("*.py"))
        physics = [file for file in files if not any(word in file.as_posix() for word in _NOT_MODELS)]
        found = [mutant for file in physics for mutant in mutants_of(file)]
        rng.shuffle(found)
        lines: set[tuple[str, str]] = set()
        for mutant in found:
            if (mutant.file, mutant.line) not in lines and len(lines) < number:
                lines.add((mutant.file, mutant.line))
                yield mutant


def tests_of(file: str) -> list[list[str]]:
    """Tests to run against a module in turn: its own, those that name what it defines, its room's, those above."""
    path = Path(file)
    tests = sorted((ROOT / "tests").rglob("test_*.py"))
    own = [test for test in tests if test.stem == f"test_{path.stem}" and path.parts[0] in test.as_posix()]
    defined = [
        node.name
        for node in ast.parse((SOURCE / file).read_text(encoding="utf-8")).body
        if isinstance(node, _DEFINITIONS)
    ]
    named = re.compile(rf"\b({'|'.join(name for name in defined if not name.startswith('_'))})\b")
    naming = [test for test in tests if test not in own and named.search(test.read_text(encoding="utf-8"))]
    room = [test for test in tests if path.parts[0] in test.relative_to(ROOT / "tests").parts[0]]
    stages = [[test.relative_to(ROOT).as_posix() for test in stage] for stage in (own, naming, room)]
    return [stage for stage in [*stages, list(_OTHER_TESTS)] if stage]


def killed_by(mutant: Mutant, first: str = "") -> str:
    """Test that fails with the mutant, "" where all pass.

    Parameters
    ----------
    mutant : Mutant
    first : str
        A test to try before the others, such as that which killed it before.

    Raises
    ------
    LookupError
        If the line of the mutant is no longer there.
    """
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(shutil.copytree(SOURCE, Path(folder) / "sonolube", ignore=shutil.ignore_patterns("*.pyc")))
        file = copy / mutant.file
        changed = mutant.applied(file.read_text(encoding="utf-8"))
        if changed is None:
            raise LookupError(f"the line of a mutant is gone: {mutant}")
        file.write_text(changed, encoding="utf-8")
        # compiled callers of a changed kernel would run what they were compiled with
        cache = {"NUMBA_CACHE_DIR": f"{folder}/numba"} if "numba" in changed else {}
        environment = {**os.environ, "PYTHONPATH": folder, "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg", **cache}
        for tests in [[first]] * bool(first) + tests_of(mutant.file):
            if failed := _failed(tests, environment):
                return failed
    return ""


def _failed(tests: list[str], environment: dict[str, str]) -> str:
    """First test that fails, or the tests' names where they did not end in time; "" where all pass."""
    options = ["-x", "-q", "--no-header", "-p", "no:cacheprovider", "--tb=no", "-rfE"]
    run = subprocess.Popen(
        [sys.executable, "-m", "pytest", *options, *tests],
        cwd=ROOT,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        start_new_session=True,
    )
    try:
        output, _ = run.communicate(timeout=_LIMIT)
    except subprocess.TimeoutExpired:
        os.killpg(run.pid, signal.SIGKILL)
        run.communicate()
        return f"{' '.join(tests)} did not end within {_LIMIT:.0f} s"
    if run.returncode in (0, 5):
        return ""
    named = [line.split()[1] for line in output.splitlines() if line.startswith(("FAILED ", "ERROR "))]
    return named[0] if named else "collection"


def main(list_file: str, records: str) -> None:
    """Run every mutant of a new sample and append its outcome to a file of records, from which a list is made.

    Parameters
    ----------
    list_file : str
        JSON to write in the end: mutant, the test that killed it, and "" to be filled in for those that survive.
    records : str
        JSON lines, continued where an earlier run stopped.
    """
    path = Path(records)
    done = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()] if path.exists() else []
    with path.open("a", encoding="utf-8") as stream:
        for mutant in list(sampled())[len(done) :]:
            done.append({"mutant": asdict(mutant), "killed_by": killed_by(mutant), "equivalent": ""})
            stream.write(json.dumps(done[-1]) + "\n")
            stream.flush()
    Path(list_file).write_text(json.dumps(done, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
