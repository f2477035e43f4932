"""Names of `sonolube` itself: each task under the name of its command, whatever was imported before."""

import copy
import pickle
import pydoc
import subprocess
import sys
from functools import wraps
from inspect import signature

import pytest
from pytest import raises

import sonolube as sl


def test_a_task_is_a_function_to_signature_pickle_copy_and_help() -> None:
    own = [name for name in signature(sl.contact.__wrapped__).parameters if name != "entries"]
    assert list(signature(sl.contact).parameters) == [*own, "changes", "load"] != own
    assert pickle.loads(pickle.dumps(sl.contact)) is copy.copy(sl.contact) is sl.contact
    assert sl.contact.__name__ == sl.contact.__qualname__ == wraps(sl.contact)(lambda: None).__name__ == "contact"
    assert "Example: sonolube contact" in pydoc.render_doc(sl.contact)
    assert not hasattr(sl.predict, "no_such_name")


def test_a_name_that_never_was_is_unknown() -> None:
    with raises(AttributeError, match="no_such_task"):
        _ = sl.no_such_task  # type: ignore[attr-defined]
    with raises(ModuleNotFoundError, match="No module named"):
        exec("import sonolube.no_such_room")


ROOMS = """
import importlib, pkgutil, sonolube
for module in pkgutil.walk_packages(sonolube.__path__, "sonolube."):
    if "__main__" not in module.name:
        importlib.import_module(module.name)
"""
NAMES = """
import sonolube as sl
from sonolube.tasks.table import TASKS
for task in TASKS:
    found = sl
    for word in task.name.replace("-", "_").split():
        found = getattr(found, word)
    assert callable(found), task.name
    assert found is task.function, task.name
"""


@pytest.mark.parametrize("code", [ROOMS + NAMES, NAMES + ROOMS + NAMES], ids=["rooms first", "tasks first"])
def test_every_task_has_the_name_of_its_command_whatever_was_imported_before(code: str) -> None:
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stderr
