"""One vocabulary: the names, units and symbols of docstrings and results are those of the list."""

import importlib
import inspect
import pkgutil
import re
from collections.abc import Iterator
from typing import Any

import pytest

import dong2015
import reference_solutions
import sonolube
from sonolube.errors import UnknownName
from sonolube.text.units import to_si
from sonolube.vocabulary import quantities, quantity

ENTRY = re.compile(r"^(\w+(?:, \w+)*) : [^\n]*\n((?:[ ]{4,}[^\n]*\n?|\n(?=[ ]{4}))*)", re.MULTILINE)
UNIT = re.compile(r"\[([^\[\]]*)\]\s*$")


def modules() -> Iterator[pkgutil.ModuleInfo]:
    """Modules of the library and of the studies beside it."""
    for package in (sonolube, dong2015, reference_solutions):
        yield from pkgutil.walk_packages(package.__path__, f"{package.__name__}.")


def public_things() -> Iterator[tuple[str, Any]]:
    for found in modules():
        module = importlib.import_module(found.name)
        for name, thing in vars(module).items():
            if name.startswith("_") or getattr(thing, "__module__", None) != found.name:
                continue
            if inspect.isclass(thing) or inspect.isfunction(thing):
                yield f"{found.name}.{name}", thing


@pytest.fixture(scope="module")
def public() -> dict[str, Any]:
    """Every public class and function by its full name; arguments of tasks have the names of options instead."""
    found = {name: thing for name, thing in public_things() if not hasattr(thing, "__wrapped__")}
    assert len(found) > 2000
    return found


def documented_entries(thing: Any) -> Iterator[tuple[str, str]]:
    """Names and descriptions of the parameters and attributes in a docstring."""
    for names, description in ENTRY.findall(inspect.cleandoc(thing.__doc__ or "")):
        yield from ((name, description) for name in names.split(", "))


def unit_faults(name: str, thing: Any) -> Iterator[str]:
    """Entries of a docstring whose unit is not that of the vocabulary."""
    for parameter, description in documented_entries(thing):
        unit = UNIT.search(description.strip())
        if parameter not in quantities():
            if unit is not None:
                yield f"{name}: {parameter} has a unit but is not in the vocabulary"
        elif unit is None:
            yield f"{name}: {parameter} is documented without its unit"
        elif unit[1] != quantity(parameter).unit:
            yield f"{name}: {parameter} is documented in {unit[1]}"


def exported_names() -> set[str]:
    """Names that the face of any room exports."""
    rooms = ["sonolube", "dong2015", "reference_solutions", *(found.name for found in modules() if found.ispkg)]
    return {name for room in rooms for name in getattr(importlib.import_module(room), "__all__", ())}


def argument_faults(name: str, function: Any, *, is_exported: bool) -> Iterator[str]:
    """Physical arguments of a function that can be swapped, or that the docstring of an exported one lacks."""
    documented = {parameter for parameter, _ in documented_entries(function)}
    for parameter in inspect.signature(function).parameters.values():
        if parameter.name in quantities():
            if parameter.kind is not inspect.Parameter.KEYWORD_ONLY:
                yield f"{name}: {parameter.name} can be swapped"
            if is_exported and parameter.name not in documented:
                yield f"{name}: {parameter.name} is not documented"


def test_everything_public_is_documented(public: dict[str, Any]) -> None:
    assert [name for name, thing in public.items() if not (thing.__doc__ or "").strip()] == []


def test_documented_units_are_those_of_the_vocabulary(public: dict[str, Any]) -> None:
    assert [fault for name, thing in public.items() for fault in unit_faults(name, thing)] == []


def test_physical_arguments_are_documented_and_cannot_be_swapped(public: dict[str, Any]) -> None:
    functions = {name: thing for name, thing in public.items() if not inspect.isclass(thing)}
    exported = exported_names()
    faults = [
        fault
        for name, function in functions.items()
        for fault in argument_faults(name, function, is_exported=name.rpartition(".")[2] in exported)
    ]
    assert faults == []


def test_every_unit_is_one_the_house_can_read() -> None:
    units = {name: quantity(name).unit for name in quantities()}
    assert {name: unit for name, unit in units.items() if to_si(f"1 {unit}", unit=unit, name=name) != 1.0} == {}


def test_an_unknown_quantity_is_answered_with_the_closest() -> None:
    with pytest.raises(UnknownName, match=r"unknown quantity 'normal_lod'; did you mean normal_load\?"):
        quantity("normal_lod")
