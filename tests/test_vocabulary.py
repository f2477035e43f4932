"""One vocabulary: the names, units and symbols of docstrings and results are those of the list."""

import importlib
import inspect
import pkgutil
import re
from collections.abc import Iterator
from typing import Any

import pytest

import sonolube
from sonolube.errors import UnknownName
from sonolube.units import to_si
from sonolube.vocabulary import quantities, quantity

ENTRY = re.compile(r"^(\w+(?:, \w+)*) : [^\n]*\n((?:[ ]{4,}[^\n]*\n?|\n(?=[ ]{4}))*)", re.MULTILINE)
UNIT = re.compile(r"\[([^\[\]]*)\]\s*$")


def public_things() -> Iterator[tuple[str, Any]]:
    for found in pkgutil.walk_packages(sonolube.__path__, "sonolube."):
        module = importlib.import_module(found.name)
        for name, thing in vars(module).items():
            if name.startswith("_") or getattr(thing, "__module__", None) != found.name:
                continue
            if inspect.isclass(thing) or inspect.isfunction(thing):
                yield f"{found.name}.{name}", thing


PUBLIC = dict(public_things())


@pytest.mark.parametrize("name", PUBLIC)
def test_everything_public_is_documented(name: str) -> None:
    assert (PUBLIC[name].__doc__ or "").strip()


@pytest.mark.parametrize("name", PUBLIC)
def test_documented_units_are_those_of_the_vocabulary(name: str) -> None:
    text = inspect.cleandoc(PUBLIC[name].__doc__ or "")
    for names, description in ENTRY.findall(text):
        unit = UNIT.search(description.strip())
        for parameter in names.split(", "):
            if parameter in quantities():
                assert unit is not None, f"{name}: {parameter} is documented without its unit"
                assert unit[1] == quantity(parameter).unit, f"{name}: {parameter}"
            else:
                assert unit is None, f"{name}: {parameter} has a unit but is not in the vocabulary"


@pytest.mark.parametrize("name", PUBLIC)
def test_physical_arguments_are_documented_and_cannot_be_swapped(name: str) -> None:
    thing = PUBLIC[name]
    if inspect.isclass(thing):
        return
    entries = ENTRY.findall(inspect.cleandoc(thing.__doc__ or ""))
    documented = {part for names, _ in entries for part in names.split(", ")}
    for parameter in inspect.signature(thing).parameters.values():
        if parameter.name in quantities():
            assert parameter.kind is inspect.Parameter.KEYWORD_ONLY, f"{name}: {parameter.name} can be swapped"
            assert parameter.name in documented, f"{name}: {parameter.name} is not documented"


@pytest.mark.parametrize("name", quantities())
def test_every_unit_is_one_the_house_can_read(name: str) -> None:
    unit = quantity(name).unit
    assert to_si(f"1 {unit}", unit=unit, name=name) == 1.0


def test_an_unknown_quantity_is_answered_with_the_closest() -> None:
    with pytest.raises(UnknownName, match=r"unknown quantity 'normal_lod'; did you mean normal_load\?"):
        quantity("normal_lod")
