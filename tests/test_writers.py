"""Files are written by sonolube.storage.files and growing_files: no other module opens, moves or removes one."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[1] / "src" / "sonolube"
STUDIES = Path(__file__).parents[1] / "studies"
WRITERS = {SOURCE / "storage" / "files.py", SOURCE / "storage" / "growing_files.py"}
METHODS = {  # of paths, or of modules that move and remove files
    *("write_text", "write_bytes", "touch", "unlink", "rename", "replace", "symlink_to", "hardlink_to", "link_to"),
    *("mkdir", "rmdir", "removedirs", "renames", "remove", "makedirs", "rmtree", "move", "copy", "copy2", "copyfile"),
}
MODULES = {"shutil", "tempfile", "sqlite3"}  # made to write
READING = {"which", "get_terminal_size"}  # of these modules
EXCEPTED = {  # calls of modules that replace nothing of users: a file without a name, and folders of their own
    "browser/answer_files.py": ("import tempfile", "TemporaryDirectory("),
    "browser/jobs.py": ("import shutil", "mkdir(", "shutil.rmtree("),
    "browser/lab/routes.py": ("(record.folder / 'log.txt').open('xb')",),
    "browser/lab/runner_records.py": ("import shutil", "mkdir(", "shutil.rmtree("),
    "browser/worker.py": ("import tempfile", "TemporaryDirectory("),
    "browser/server.py": ("webbrowser.open(",),
    "browser/uploads.py": ("import ", "mkdtemp(", "rmtree(", "path.open('xb')", "path.unlink("),
    "cli/runs.py": ("answer.save(out)",),  # by storage.files
    "design/fmu/mock_up_unit.py": ("import TemporaryDirectory", "TemporaryDirectory(", "joinpath(each).write_bytes("),
    "laboratory/driver_trial/": ("os.open(self.log", "import TemporaryDirectory", "TemporaryDirectory("),
    "models/fem/mesh/": ("TemporaryFile", "import TemporaryDirectory"),
    "storage/user_files.py": ("os.O_RDONLY",),  # reads pipes
    "operating_system.py": ("source.replace(target)", "path.unlink(missing_ok=True)"),  # for files
    "tasks/faults.py": ("import tempfile", "tempfile.mkdtemp("),
    "tasks/files.py": ("tempfile", "TemporaryDirectory", "path.write_bytes(file.content)"),
    "execution/compilation.py": ("import tempfile", "tempfile.gettempdir()", "folder.mkdir(mode=stat.S_IRWXU"),
}
IN_MEMORY = {"BytesIO", "StringIO"}
TO_FILES = {"savefig": 0, "savez": 0, "savez_compressed": 0, "savetxt": 0, "to_netcdf": 0, "to_csv": 0, "save": 0}
OPENERS = {"h5py.File": 1, "h5netcdf.File": 1, "netcdf_file": 1, "ZipFile": 1, "io.open": 1, "open": 1}
HANDLES = {"self._unfinished", "unfinished"}  # an `UnfinishedFile`


def dotted(node: ast.expr) -> str:
    """Name of a function as written, such as `np.savez`."""
    return ast.unparse(node) if isinstance(node, ast.Name | ast.Attribute) else f"().{getattr(node, 'attr', '')}"


def argument(call: ast.Call, place: int, *keywords: str) -> ast.expr | None:
    """Argument of a call by its place or name."""
    named = {keyword.arg: keyword.value for keyword in call.keywords}
    found = [named[name] for name in keywords if name in named]
    return call.args[place] if len(call.args) > place else (found[0] if found else None)


def in_memory(tree: ast.Module) -> set[str]:
    """Names of variables that hold a file in memory."""
    names = set()
    for node in ast.walk(tree):
        value = getattr(node, "value", None)
        if not isinstance(value, ast.Call) or dotted(value.func).rpartition(".")[2] not in IN_MEMORY:
            continue
        if isinstance(node, ast.Assign):
            names |= {ast.unparse(target) for target in node.targets}
        elif isinstance(node, ast.NamedExpr | ast.AnnAssign):
            names.add(ast.unparse(node.target))
    return names


def opens_for_writing(call: ast.Call, place: int) -> bool:
    """Whether a call opens a file with a mode other than reading; a mode that is not written out counts."""
    mode = argument(call, place, "mode")
    if mode is None:
        return False
    return not isinstance(mode, ast.Constant) or not set(str(mode.value)) <= set("rbt")


def is_path_method(call: ast.Call) -> bool:
    """Whether a method of METHODS may be a path's: others of these names belong to texts, arrays, lists and records."""
    method = dotted(call.func).rpartition(".")[2]
    if method == "replace":
        return len(call.args) == 1 and not call.keywords
    return method not in ("copy", "move", "remove")


def writes(call: ast.Call, memory: set[str]) -> bool:
    """Whether a call writes, moves or removes a file."""
    name = dotted(call.func)
    method = name.rpartition(".")[2]
    module = name.partition(".")[0]
    if module in MODULES or name in ("TemporaryFile", "NamedTemporaryFile", "mkstemp", "mkdtemp"):
        return True
    if module == "os":
        return method in {"open", *METHODS}
    if method in METHODS:
        return isinstance(call.func, ast.Attribute) and is_path_method(call)
    if method in TO_FILES:
        target = argument(call, TO_FILES[method], "path", "fname", "file")
        return target is not None and ast.unparse(target).partition(" :=")[0].strip("(") not in memory
    if name in OPENERS:
        target = call.args[0] if call.args else None
        return opens_for_writing(call, OPENERS[name]) and (target is None or ast.unparse(target) not in memory)
    if method != "open" or not isinstance(call.func, ast.Attribute):
        return False
    of_a_class = name[:1].isupper()  # such as PIL's Image.open(file), whose first argument is no mode
    return opens_for_writing(call, 1 if of_a_class else 0)


def writing_calls(tree: ast.Module) -> Iterator[str]:
    """Calls of a module that write, as written."""
    memory = in_memory(tree) | HANDLES
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and writes(node, memory):
            yield f"{node.lineno}: {ast.unparse(node)}"
        if isinstance(node, ast.Import | ast.ImportFrom):
            module = getattr(node, "module", None)
            names = [alias.name for alias in node.names]
            yield from (
                f"{node.lineno}: import {name}" for name in names if name not in READING and {name, module} & MODULES
            )


def test_files_alone_writes() -> None:
    found = []
    for path in sorted({*SOURCE.rglob("*.py"), *STUDIES.rglob("*.py")} - WRITERS):
        place = path.relative_to(SOURCE if path.is_relative_to(SOURCE) else STUDIES).as_posix()
        calls = writing_calls(ast.parse(path.read_text(encoding="utf-8")))
        excepted = next((calls for beginning, calls in EXCEPTED.items() if place.startswith(beginning)), ())
        found += [f"{place}:{call}" for call in calls if not any(each in call for each in excepted)]
    assert found == []


@pytest.mark.parametrize("writer", sorted(WRITERS), ids=lambda path: path.stem)
def test_the_writer_itself_is_found(writer: Path) -> None:
    assert list(writing_calls(ast.parse(writer.read_text(encoding="utf-8"))))


@pytest.mark.parametrize(
    "line",
    [
        "open('a', 'w')",
        "open('a', mode='ab')",
        "path.open('x')",
        "path.open(mode=given)",
        "path.write_text(text)",
        "path.write_bytes(content)",
        "os.open(path, os.O_RDWR)",
        "os.replace(a, b)",
        "path.rename(b)",
        "path.replace(b)",
        "path.unlink()",
        "figure.savefig(path)",
        "data.to_netcdf(path, engine='h5netcdf')",
        "data.to_netcdf(path=path)",
        "np.savez('a.npz', x=x)",
        "h5py.File(path, 'w')",
        "h5netcdf.File(path, 'a')",
        "sqlite3.connect(path)",
        "tempfile.mkstemp()",
        "from tempfile import mkdtemp",
        "import shutil",
        "shutil.copyfile(a, b)",
        "ZipFile(path, 'w')",
        "image.save(path)",
    ],
)
def test_every_way_to_write_a_file_is_recognised(line: str) -> None:
    assert list(writing_calls(ast.parse(line)))


@pytest.mark.parametrize(
    "line",
    [
        "path.open('rb')",
        "open(path)",
        "h5py.File(path, 'r')",
        "content = io.BytesIO()\nfigure.savefig(content, format='png')",
        "np.savez(buffer := io.BytesIO(), x=x)",
        "bytes(data.to_netcdf(engine='h5netcdf'))",
        "text.replace('a', 'b')",
        "replace(record, a=1)",
        "array.copy()",
    ],
)
def test_reading_and_files_in_memory_are_free(line: str) -> None:
    assert not list(writing_calls(ast.parse(line)))
