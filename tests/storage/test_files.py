"""Files are replaced whole or not at all; what is no regular file, or is an input, is never replaced."""

import os
import subprocess
import sys
from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path

import pytest
from pytest import MonkeyPatch, mark, raises

from sonolube.errors import InvalidInput
from sonolube.operating_system import remove_file
from sonolube.storage.files import (
    clear_unfinished,
    expect_file,
    expect_files,
    locked_folder,
    unfinished_file,
    write_atomically,
)
from sonolube.storage.user_files import command_files, expect_target, record_input

LargestFile = Callable[[int], AbstractContextManager[None]]


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_a_file_is_replaced_whole_and_keeps_its_permissions(tmp_path: Path) -> None:
    path = tmp_path / "page.html"
    path.write_text("old")
    path.chmod(0o640)
    assert write_atomically(path, "neu") == path
    assert (path.read_text(), path.stat().st_mode & 0o777, names(tmp_path)) == ("neu", 0o640, ["page.html"])


@mark.parametrize("mask", [0o022, 0o077])
def test_a_new_file_has_the_permissions_of_the_umask(tmp_path: Path, mask: int) -> None:
    before = os.umask(mask)
    try:
        write_atomically(tmp_path / "deeper" / "page.html", b"new")
    finally:
        os.umask(before)
    assert (tmp_path / "deeper" / "page.html").stat().st_mode & 0o777 == 0o666 & ~mask


def test_writing_through_a_link_replaces_what_it_leads_to(tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    target, link = tmp_path / "data" / "page.html", tmp_path / "link.html"
    target.write_text("old")
    link.symlink_to("data/page.html")
    write_atomically(link, "new")
    assert link.is_symlink()
    assert target.read_text() == "new"


def hostile(folder: Path, kind: str) -> Path:
    """A path that stands for no regular file."""
    path = folder / "target"
    if kind == "folder":
        path.mkdir()
    elif kind == "pipe":
        os.mkfifo(path)
    elif kind == "link to a pipe":
        os.mkfifo(folder / "pipe")
        path.symlink_to("pipe")
    elif kind == "dangling link":
        path.symlink_to("nowhere")
    elif kind == "loop":
        path.symlink_to("target")
    elif kind == "device":
        return Path("/dev/null")
    else:
        path.write_text("in the way")
        return path / "deeper"
    return path


REFUSED = {
    "folder": "it is a folder; name a file",
    "pipe": "it is a named pipe, which would be replaced; name a file",
    "link to a pipe": "it is a named pipe, which would be replaced; name a file",
    "dangling link": "it is a link to nowhere, which does not exist; remove the link",
    "loop": "Too many levels of symbolic links",
    "device": "it is a device, which would be replaced; name a file",
    "below a file": "Not a directory",
}


@mark.parametrize("kind", REFUSED)
def test_what_is_no_regular_file_is_refused_and_stays(tmp_path: Path, kind: str) -> None:
    path = hostile(tmp_path, kind)
    before = names(tmp_path)
    for write in (expect_file, lambda target: write_atomically(target, "new")):
        with raises(InvalidInput) as refused:
            write(path)
        assert str(refused.value) == f"{path}: cannot be written: {REFUSED[kind]}"
    assert names(tmp_path) == before
    assert Path("/dev/null").is_char_device()


def test_a_write_protected_file_is_refused(tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    (tmp_path / "kept").touch(mode=0o444)
    monkeypatch.setattr(
        "sonolube.storage.user_files.os.access", lambda path, mode: False
    )  # root may write to every file
    with raises(InvalidInput, match="it is write-protected"):
        write_atomically(tmp_path / "kept", "new")


@mark.parametrize("link", ["itself", "symbolic", "hard"])
def test_an_input_is_not_replaced_under_any_name(tmp_path: Path, link: str) -> None:
    read, path = tmp_path / "test.csv", tmp_path / ("test.csv" if link == "itself" else "other")
    read.write_text("recorded")
    if link == "symbolic":
        path.symlink_to(read)
    elif link == "hard":
        path.hardlink_to(read)
    refused = "an input of this command; name another file"
    with command_files():
        record_input(read)
        for write in (expect_target, expect_file, lambda target: write_atomically(target, "new")):
            with raises(InvalidInput, match=refused):
                write(path)
    with command_files():
        expect_target(path)
        with raises(InvalidInput, match=refused):
            record_input(read)
    assert read.read_text() == "recorded"


def test_the_files_of_a_folder_that_is_read_are_inputs(tmp_path: Path) -> None:
    (tmp_path / "test.csv").write_text("recorded")
    with command_files():
        record_input(tmp_path)
        with raises(InvalidInput, match="it is an input"):
            expect_files(tmp_path, ("*.csv",))


def test_two_outputs_that_are_one_file_are_refused(tmp_path: Path) -> None:
    (tmp_path / "a.png").touch()
    (tmp_path / "a.svg").hardlink_to(tmp_path / "a.png")
    with command_files(), raises(InvalidInput, match=r"a\.svg: cannot be written: it and .*a\.png.* are one file"):
        expect_files(tmp_path, ("a.*",))
    with command_files():
        expect_target(tmp_path / "a.png")
        expect_target(tmp_path / "a.png")


@mark.parametrize(("folder", "reason"), [("file", "it is no folder"), ("file/deeper", "file is no folder")])
def test_a_folder_that_cannot_be_made_is_refused(tmp_path: Path, folder: str, reason: str) -> None:
    (tmp_path / "file").touch()
    with raises(InvalidInput, match=f"{folder}: cannot be written: .*{reason}"):
        expect_files(tmp_path / folder, ())


def test_a_folder_behind_a_dangling_link_and_names_beyond_the_file_system_are_refused(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to("nowhere")
    for folder, reason in {
        "link/out": "is a link to nowhere",
        "x" * 300: "too long",
        f"a/{'x' * 300}": "too long",
    }.items():
        with raises(InvalidInput, match=reason):
            expect_files(tmp_path / folder, ())


def test_testing_a_folder_leaves_nothing_in_it(tmp_path: Path) -> None:
    expect_files(tmp_path / "new" / "deeper", ("page.html", "figures/*"))
    expect_file(tmp_path / "new" / "page.html")
    assert names(tmp_path) == []


def test_an_error_inside_leaves_the_old_content_and_no_other_file(tmp_path: Path) -> None:
    path = tmp_path / "page.html"
    path.write_text("old")
    with raises(ZeroDivisionError), unfinished_file(path) as file:
        file.write(b"new" * (1 // 0))
    assert (path.read_text(), names(tmp_path)) == ("old", ["page.html"])


@mark.parametrize("size", [0, 1, 4095, 99_999])
def test_a_full_disk_is_one_line_and_leaves_the_old_content(
    tmp_path: Path, size: int, largest_file: LargestFile
) -> None:
    path = tmp_path / "page.html"
    path.write_text("old")
    with largest_file(size), raises(InvalidInput) as refused:
        write_atomically(path, b"x" * 100_000)
    assert str(refused.value) == f"{path}: cannot be written: File too large"
    assert (path.read_text(), names(tmp_path)) == ("old", ["page.html"])


@mark.skipif(sys.platform != "linux" or os.geteuid() != 0, reason="only root mounts a file system")
def test_a_file_system_without_space_is_named_as_such(tmp_path: Path) -> None:
    disk = tmp_path / "disk"
    disk.mkdir()
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", disk], check=False).returncode:
        pytest.skip("no file system can be mounted here")
    try:
        write_atomically(disk / "page.html", "old")
        with raises(InvalidInput, match=r"page\.html: cannot be written: No space left on device"):
            write_atomically(disk / "page.html", b"x" * 100_000)
        assert ((disk / "page.html").read_text(), names(disk)) == ("old", ["page.html"])
    finally:
        subprocess.run(["umount", disk], check=True)


def another_process(folder: Path, code: str) -> "subprocess.Popen[bytes]":
    """Process that has run code and then waits."""
    begin = "import sys\nfrom pathlib import Path\nfrom sonolube.storage.files import locked_folder, unfinished_file\n"
    end = "    print('ready', flush=True)\n    sys.stdin.read()\n"
    process = subprocess.Popen(
        [sys.executable, "-c", f"{begin}{code}\n{end}"], cwd=folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE
    )
    assert process.stdout
    assert process.stdout.readline() == b"ready\n"
    return process


def test_unfinished_files_of_dead_processes_are_cleared_and_those_of_living_ones_kept(tmp_path: Path) -> None:
    code = "with unfinished_file(Path('page.html')) as file:\n    file.write(b'half')"
    with another_process(tmp_path, code) as dead, another_process(tmp_path, code) as living:
        assert len(names(tmp_path)) == 2
        dead.kill()
        dead.wait()
        expect_file(tmp_path / "page.html")
        assert len(names(tmp_path)) == 1
        living.kill()
    (tmp_path / ".sweep.nc.of_an_earlier_version").touch()
    (tmp_path / ".hidden").touch()
    clear_unfinished(tmp_path, ".sweep.nc.*")
    assert names(tmp_path) == [".hidden"]


def test_a_folder_is_locked_by_one_living_process(tmp_path: Path) -> None:
    with another_process(tmp_path, "with locked_folder(Path(), purpose='sweep'):") as other:
        line = f"^{tmp_path}: another sweep is at work in it; wait for it, or name another folder$"
        with raises(InvalidInput, match=line), locked_folder(tmp_path, purpose="sweep"):
            pass
        other.kill()
    with locked_folder(tmp_path, purpose="sweep"):
        assert names(tmp_path) == [".sonolube.lock"]
        with raises(InvalidInput), locked_folder(tmp_path, purpose="sweep"):
            pass
    assert names(tmp_path) == []


def test_removing_what_is_not_there_is_no_error(tmp_path: Path) -> None:
    (tmp_path / "a").touch()
    for _ in range(2):
        remove_file(tmp_path / "a")
    assert names(tmp_path) == []
