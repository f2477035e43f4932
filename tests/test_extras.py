"""Optional parts of the installation: what is imported is declared, and a missing part is refused with its remedy."""

import ast
import re
import sys
import tomllib
from collections.abc import Mapping
from importlib.metadata import packages_distributions
from pathlib import Path

import numpy as np
from pytest import MonkeyPatch, raises

from reference_solutions import boundary_element_contact
from sonolube.errors import MissingPackage
from sonolube.extras import EXTRAS, missing_package
from sonolube.models.surfaces import HeightMap

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def names(requirements: list[str]) -> set[str]:
    return {re.split(r"[<>=;\[ ]", each)[0].lower().replace("_", "-") for each in requirements}


OWN = {"sonolube", "dong2015", "reference_solutions"}


def imported_distributions() -> Mapping[str, set[str]]:
    """Names under which a module of the package's sources may be installed, by the module."""
    known = packages_distributions()
    found: dict[str, set[str]] = {}
    for path in [*(ROOT / "src").rglob("*.py"), *(ROOT / "studies").rglob("*.py")]:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            absolute = isinstance(node, ast.ImportFrom) and not node.level
            modules = [node.module or ""] if isinstance(node, ast.ImportFrom) and absolute else []
            modules += [each.name for each in node.names] if isinstance(node, ast.Import) else []
            for top in {module.partition(".")[0] for module in modules} - OWN - {*sys.stdlib_module_names}:
                found[top] = {each.lower().replace("_", "-") for each in known.get(top, [top])}
    return found


def test_every_extra_of_the_project_has_its_line_in_the_package() -> None:
    declared = PROJECT["optional-dependencies"]
    assert declared.keys() - {"all"} == EXTRAS.keys()
    for name, extra in EXTRAS.items():
        assert {module.lower().replace("_", "-") for module in extra.modules} - {"netgen", "serial"} <= (
            names(declared[name]) | names(declared["surfaces"])
        )
        assert {each.lower() for each in extra.distributions.split()} == names(declared[name])


def test_the_extra_all_has_every_other_that_a_usual_computer_can_use() -> None:
    (every,) = PROJECT["optional-dependencies"]["all"]
    assert set(re.findall(r"[\w-]+", every)) == {"sonolube", *EXTRAS} - {"cluster"}


def test_every_package_that_is_imported_is_required_and_every_extra_is_used() -> None:
    # Pillow, cycler and fontTools come with matplotlib; type checkers have _typeshed; only `learning` needs emcee
    implied = {"pillow", "cycler", "fonttools", "pydantic-core", "-typeshed", "emcee"}
    optional = {name for extra in EXTRAS for name in names(PROJECT["optional-dependencies"][extra])}
    required = names(PROJECT["dependencies"])
    imported = imported_distributions()
    assert {module for module, called in imported.items() if not called & (required | optional | implied)} == set()
    used = {name for called in imported.values() for name in called}
    by_others = {"netgen-mesher", "dask", "pyvisa-py", "pyserial"}  # import_module, distributed, pyvisa
    assert optional - by_others <= used


def test_boundary_elements_without_their_library_name_the_command_that_installs_it(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "ContactMechanics", None)
    flat = HeightMap(height=np.zeros((4, 4)), spacing_x=1e-6, spacing_y=1e-6)
    with raises(MissingPackage, match=r"^boundary elements .* need ContactMechanics.*ContactMechanics$"):
        boundary_element_contact(flat, normal_load=[1.0], effective_modulus=1e9)


def test_a_part_is_installed_if_all_its_modules_are_found(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "netgen", None)
    assert not EXTRAS["fem"].is_installed


def test_a_part_that_is_not_published_for_a_computer_says_so(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr("platform.machine", lambda: "aarch64")
    monkeypatch.setattr("platform.system", lambda: "Linux")
    monkeypatch.setattr("sys.platform", "linux")
    assert str(missing_package("fem")).endswith(
        "need netgen-mesher, which is not published for Linux on aarch64: take macOS or x86_64"
    )
    assert EXTRAS["web"].obstacle == ""
    monkeypatch.setattr("sys.platform", "darwin")
    assert str(missing_package("fem")).endswith("which is not installed: pip install netgen-mesher")


def test_the_error_of_a_missing_part_is_one_line_with_what_is_refused_and_another_way_out() -> None:
    line = "plate.sur: Interactive maps need Plotly, which is not installed: pip install plotly, or take PNG"
    assert str(missing_package("web", context="plate.sur", remedy="take PNG")) == line
