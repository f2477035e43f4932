"""State of an installation, how to mend it, and a self-check against closed forms: as text and JSON."""

import os
import platform
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from shutil import which
from typing import Any

import sonolube
from sonolube.extras import EXTRAS, installed_version, required_packages
from sonolube.laboratory.drivers import known_drivers
from sonolube.models.dynamics.warm_up import compiled_code_folder, is_compiled
from sonolube.report.blocks import Block, Rows
from sonolube.report.results.self_checks import SELF_CHECKS

_PROGRAMS = {  # names of each program, and what it is for
    "C compiler": (("cc", "gcc", "clang"), "compiles what control exports", "apt-get install gcc libc6-dev"),
    "CalculiX": (("ccx",), "compared with by tests and benchmarks only", "apt-get install calculix-ccx"),
    "Chromium": (("chromium", "chromium-browser", "google-chrome"), "tests of pages only", "apt-get install chromium"),
}


@dataclass(frozen=True, kw_only=True)
class Installation:
    """State of an installation.

    Parameters
    ----------
    packages : mapping of str to str
        Versions of the required packages; empty where one is missing.
    extras : mapping of str to bool
        Whether each optional part is installed.
    cache_folder : Path
        Of compiled code.
    cache_was_warm : bool
    programs : mapping of str to str
        Path of each other program; empty where there is none.
    drivers : mapping of str to tuple of str
        Names of the drivers of devices by their roles, with the package of those that others add.
    checks : sequence of mapping
        Outcomes of the self-checks.
    """

    packages: Mapping[str, str]
    extras: Mapping[str, bool]
    cache_folder: Path
    cache_was_warm: bool
    programs: Mapping[str, str]
    drivers: Mapping[str, tuple[str, ...]]
    checks: Sequence[Mapping[str, Any]]

    @property
    def cache_is_writable(self) -> bool:
        """Whether compiled code can be kept."""
        return _is_writable(self.cache_folder)

    @property
    def healthy(self) -> bool:
        """Whether all self-checks pass, all required packages are there, and compiled code can be kept."""
        return all(each["passed"] for each in self.checks) and all(self.packages.values()) and self.cache_is_writable

    def blocks(self) -> Sequence[Block]:
        """Sections of the state, each missing part with its remedy, and the verdict."""
        return [
            f"sonolube {sonolube.__version__} in {Path(sonolube.__file__).parent}",
            f"Python {platform.python_version()} on {platform.platform(terse=True)} {platform.machine()},"
            f" {os.cpu_count()} processor cores",
            "required packages",
            Rows([(name, found or f"missing: pip install {name}") for name, found in self.packages.items()]),
            "optional parts",
            Rows([(name, self._extra(name)) for name in self.extras]),
            "compiled code",
            Rows([("folder", self._cache())]),
            "other programs",
            Rows([(name, self._program(name)) for name in self.programs]),
            "drivers of devices",
            Rows([(role, ", ".join(names)) for role, names in self.drivers.items()]),
            "self-check",
            Rows([(str(each["title"]), _verdict(each)) for each in self.checks]),
            self._verdict(),
        ]

    def object(self) -> dict[str, Any]:
        """Same as an object."""
        return {
            "version": sonolube.__version__,
            "folder": str(Path(sonolube.__file__).parent),
            "python": platform.python_version(),
            "executable": sys.executable,
            "platform": platform.platform(),
            "processor_cores": os.cpu_count(),
            "packages": {name: found or None for name, found in self.packages.items()},
            "extras": {
                name: {
                    "installed": installed,
                    "command": EXTRAS[name].command,
                    "obstacle": EXTRAS[name].obstacle or None,
                }
                for name, installed in self.extras.items()
            },
            "compiled_code": {
                "folder": str(self.cache_folder),
                "writable": self.cache_is_writable,
                "warm": self.cache_was_warm,
            },
            "programs": {name: path or None for name, path in self.programs.items()},
            "drivers": {role: list(names) for role, names in self.drivers.items()},
            "checks": [dict(each) for each in self.checks],
            "healthy": self.healthy,
        }

    def _extra(self, name: str) -> str:
        """Package of an optional part with its version, or how to install it."""
        extra = EXTRAS[name]
        if self.extras[name]:
            return f"{extra.package} {installed_version(extra.package)}".strip()
        return f"not installed: {extra.command}"

    def _cache(self) -> str:
        """Folder of compiled code, and what to expect of it."""
        state = "warm" if self.cache_was_warm else "was cold: the first computation compiled for some 20 s"
        remedy = "" if self.cache_is_writable else "; not writable: set NUMBA_CACHE_DIR to a folder that is"
        return f"{self.cache_folder}, {state}{remedy}"

    def _program(self, name: str) -> str:
        """Path of a program, or how to install it, with what it is for."""
        _, purpose, remedy = _PROGRAMS[name]
        return f"{self.programs[name] or f'not found: {remedy}'} ({purpose})"

    def _verdict(self) -> str:
        """Verdict in one line."""
        passed = sum(bool(each["passed"]) for each in self.checks)
        if self.healthy:
            return f"all {passed} checks passed"
        return f"{passed} of {len(self.checks)} checks passed; mend what is named above, or install anew"


def installation(advance: Callable[[str, int, int], None]) -> Installation:
    """State of this installation, all self-checks made."""
    warm, outcomes = is_compiled(), []
    for done, check in enumerate(SELF_CHECKS):
        advance(check.title, done, len(SELF_CHECKS))
        outcomes.append(check.outcome())
    return Installation(
        packages=required_packages(),
        extras={name: extra.is_installed for name, extra in EXTRAS.items()},
        cache_folder=compiled_code_folder(),
        cache_was_warm=warm,
        programs={name: _found(names) for name, (names, _, _) in _PROGRAMS.items()},
        drivers=known_drivers(),
        checks=tuple(outcomes),
    )


def _verdict(check: Mapping[str, Any]) -> str:
    """Outcome of a self-check."""
    if check["passed"]:
        return f"passed, {check['computed']:.6g}"
    return f"FAILED: {check['computed']} instead of {check['expected']:.6g}, {check['reason']}"


def _found(names: Sequence[str]) -> str:
    """Path of the first of these programs, empty where there is none."""
    return next((path for name in names if (path := which(name))), "")


def _is_writable(folder: Path) -> bool:
    """Whether files can be written to a folder, or to the nearest one above it that exists."""
    existing = next(each for each in (folder, *folder.parents) if each.exists())
    return existing.is_dir() and os.access(existing, os.W_OK)
