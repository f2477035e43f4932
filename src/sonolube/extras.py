"""Optional parts of the installation: the packages that each brings, what needs them, and how it is installed."""

import platform
import re
import sys
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, requires, version
from importlib.util import find_spec
from pathlib import Path
from types import MappingProxyType

from sonolube.errors import MissingPackage


@dataclass(frozen=True, kw_only=True, slots=True)
class Extra:
    """One optional part of the installation, an extra of the distribution.

    Parameters
    ----------
    name : str
        Of the extra.
    package : str
        Package that it brings, as its users call it.
    distributions : str
        Names by which pip installs what it brings, separated by spaces.
    modules : tuple of str
        Modules that have to be found for the part to work.
    needed_by : str
        What needs it, at the beginning of a sentence.
    machines : tuple of str
        Processors for which the package is published, beside those of macOS; empty where it is for all.
    """

    name: str
    package: str
    distributions: str
    modules: tuple[str, ...]
    needed_by: str
    machines: tuple[str, ...] = ()

    @property
    def obstacle(self) -> str:
        """Why it cannot be installed on this computer; empty where it can."""
        machine = platform.machine()
        if not self.machines or sys.platform == "darwin" or machine in self.machines:
            return ""
        return f"is not published for {platform.system()} on {machine}: take macOS or {self.machines[0]}"

    @property
    def command(self) -> str:
        """Command that installs it."""
        return f"pip install {self.distributions}"

    @property
    def is_installed(self) -> bool:
        """Whether its modules are found; none is imported."""
        return all(_is_found(module) for module in self.modules)


def _extra(name: str, *, modules: Sequence[str], machines: Sequence[str] = (), **texts: str) -> Extra:
    """Optional part of an entry of the file beside this module."""
    return Extra(name=name, modules=tuple(modules), machines=tuple(machines), **texts)


_ENTRIES = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
EXTRAS: Mapping[str, Extra] = MappingProxyType({name: _extra(name, **entry) for name, entry in _ENTRIES.items()})
"""The optional parts by name."""


def missing_package(name: str, *, context: str = "", remedy: str = "") -> MissingPackage:
    """Error of an optional part that is not installed, in one line with the command that installs it."""
    extra = EXTRAS[name]
    line = f"{extra.needed_by} need {extra.package}, which {extra.obstacle or f'is not installed: {extra.command}'}"
    line = f"{context}: {line}" if context else line[:1].lower() + line[1:]
    return MissingPackage(f"{line}, or {remedy}" if remedy else line)


def _is_found(module: str) -> bool:
    """Whether a module can be imported, as far as that is known without importing it."""
    try:
        return find_spec(module) is not None
    except (ImportError, ValueError):  # a module that was set to None or has no spec
        return False


def required_packages() -> dict[str, str]:
    """Versions of the packages that are required.

    By the name of the package; empty where one is missing.
    """
    required = [each for each in requires("sonolube") or () if "extra ==" not in each]
    names = sorted(re.split(r"[^\w.-]", each)[0] for each in required)
    return {name: installed_version(name) for name in names}


def installed_version(package: str) -> str:
    """Version of a package, empty where it is missing."""
    try:
        return version(package)
    except PackageNotFoundError:
        return ""
