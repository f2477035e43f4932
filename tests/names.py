"""Names of modules that tests replace."""

from types import ModuleType
from typing import Any


def names_of(module: ModuleType) -> Any:
    """A module with the names that it has imported, which it does not export: a test replaces what they stand for."""
    return module
