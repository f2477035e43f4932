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
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src" / "sonolube"
ROOMS = {
    "models/contact": 45, "models/friction": 60, "models/wear": 12, "models/thermal": 35, "models/actuator": 35,
    "facts/metrics": 20, "models/surfaces": 45, "models/dynamics": 30, "models/fem": 18,
}  # fmt: skip
_OTHER_TESTS = (
    "tests/validation",
    "tests/rig",
    "tests/reproduction",
    "tests/design",
    "tests/dong2015",
    "tests/measurement",
)
_LIMIT = 900.0  # s, of the tests of a stage
_NOT_A_FAILURE = (0, 4, 5)  # exit statuses of pytest: all pass, no such test, none collected
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
_NOT_MODELS = ("figure", "jax_kernels", "__init__", "mode_files")
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


def sampled(kept: Sequence[Mutant] = (), *, seed: int = 0) -> Iterator[Mutant]:
    """Mutants drawn from every room of models, with those kept as many as ROOMS says, at most one a line."""
    rng = random.Random(seed)
    for room, number in ROOMS.items():
        files = sorted((SOURCE / room).rglob("*.py"))
        physics = [file for file in files if not any(word in file.as_posix() for word in _NOT_MODELS)]
        found = [mutant for file in physics for mutant in mutants_of(file)]
        rng.shuffle(found)
        lines = {(mutant.file, mutant.line) for mutant in kept if mutant.file.startswith(f"{room}/")}
        for mutant in found:
            if (mutant.file, mutant.line) not in lines and len(lines) < number:
                lines.add((mutant.file, mutant.line))
                yield mutant


def tests_of(file: str) -> list[list[str]]:
    """Tests to run against a module in turn: its own, its room's, and last those above.

    Tests that name what the module defines stand first in their stage.
    """
    path = Path(file)
    names = re.compile(rf"\b({'|'.join(_public_names(file))})\b")
    every = sorted(
        (ROOT / "tests").rglob("test_*.py"), key=lambda test: not names.search(test.read_text(encoding="utf-8"))
    )
    room = [test for test in every if path.parts[:2] == test.relative_to(ROOT / "tests").parts[:2]]
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


def killed_by(mutant: Mutant, first: str = "", *, stages: int = 3) -> str:
    """Test that fails with the mutant, "" where all pass.

    Parameters
    ----------
    mutant : Mutant
    first : str
        A test to try before the others, such as that which killed it before.
    stages : int
        How many stages of `tests_of` to try.

    Raises
    ------
    LookupError
        If the line of the mutant is no longer there.
    """
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(shutil.copytree(SOURCE, Path(folder) / "sonolube"))
        file = copy / mutant.file
        changed = mutant.applied(file.read_text(encoding="utf-8"))
        if changed is None:
            raise LookupError(f"the line of a mutant is gone: {mutant}")
        file.write_text(changed, encoding="utf-8")
        for module in map(Path, _compiled_with(mutant.file)):  # callers would run what they were compiled with
            for compiled in (copy / module.parent / "__pycache__").glob(f"{module.stem}.*"):
                compiled.unlink()
        environment = {**os.environ, "PYTHONPATH": folder, "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg"}
        for tests in [[first] if first else [], *tests_of(mutant.file)[:stages]]:
            if tests and (failed := _failed(tests, environment)):
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
    if run.returncode in _NOT_A_FAILURE:
        return ""
    named = [
        line.partition(" ")[2].partition(" - ")[0]
        for line in output.splitlines()
        if line.startswith(("FAILED ", "ERROR "))
    ]
    return named[0] if named else "collection"


def entries_of(list_file: Path) -> list[dict[str, Any]]:
    """Entries of a list whose lines are still there: mutant, the test that killed it, why it changes nothing."""
    entries = json.loads(list_file.read_text(encoding="utf-8")) if list_file.exists() else []
    return [entry for entry in entries if _is_there(Mutant(**entry["mutant"]))]


def _is_there(mutant: Mutant) -> bool:
    file = SOURCE / mutant.file
    return file.exists() and mutant.applied(file.read_text(encoding="utf-8")) is not None


def main(list_file: str, records: str) -> None:
    """Fill a list up to the number of mutants of every room: sample those that it lacks, run and add them.

    Parameters
    ----------
    list_file : str
        JSON, written in the end; entries of survivors are to be given their reason, or a test that kills them.
    records : str
        JSON lines of the new entries, continued where an earlier run stopped.
    """
    path = Path(records)
    done = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()] if path.exists() else []
    entries = entries_of(Path(list_file)) + done
    with path.open("a", encoding="utf-8") as stream:
        for mutant in sampled([Mutant(**entry["mutant"]) for entry in entries]):
            entries.append({"mutant": asdict(mutant), "killed_by": killed_by(mutant), "equivalent": ""})
            stream.write(json.dumps(entries[-1]) + "\n")
            stream.flush()
    Path(list_file).write_text(json.dumps(entries, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
