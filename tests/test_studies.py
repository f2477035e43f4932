"""Studies by their entry points: found, missing, and such as cannot be loaded."""

from collections.abc import Callable, Iterator
from importlib.metadata import EntryPoint

import pytest
from pytest import CaptureFixture, MonkeyPatch, raises

from sonolube import studies
from sonolube.cli import main
from sonolube.errors import InvalidInput, MissingPackage, UnknownName
from sonolube.models import fem
from sonolube.studies import GROUP, study, study_horn_face, study_transducers
from sonolube.tasks.parts.named_parts import transducers

Hide = Callable[[list[EntryPoint]], None]


@pytest.fixture
def only(monkeypatch: MonkeyPatch) -> Iterator[Hide]:
    """Function that lets these entry points be the only ones of the group."""

    def hide(points: list[EntryPoint]) -> None:
        monkeypatch.setattr(studies, "entry_points", lambda group: points)
        studies.studies.cache_clear()

    yield hide
    studies.studies.cache_clear()


def test_the_study_of_the_dissertation_is_found_with_its_hardware() -> None:
    assert "Ultrasonic Lubrication" in study("dong2015").title
    assert {"collar", "tribometer_actuator"} <= set(study_transducers())
    with raises(UnknownName, match=r"^unknown horn 'brass'; known: aluminium, steel$"):
        study_horn_face("brass")


@pytest.mark.parametrize(
    "words", [["reproduce"], ["reproduce", "--chapter", "3", "--json"], ["horn", "face", "aluminium"]]
)
def test_without_a_study_a_command_that_needs_one_says_so_in_one_line(
    words: list[str], only: Hide, capfd: CaptureFixture[str]
) -> None:
    only([])
    with raises(SystemExit) as ended:
        main(words)
    out, err = capfd.readouterr()
    assert (ended.value.code, out, err.count("\n")) == (2, "", 1)
    assert "is not installed" in err or "is installed: install sonolube" in err
    assert "install sonolube anew" in err


def test_without_a_study_the_general_transducers_are_left(only: Hide) -> None:
    only([])
    assert dict(transducers()) == dict(fem.TRANSDUCERS)
    assert not studies.studies()


def test_a_study_that_is_not_installed_is_named_beside_those_that_are() -> None:
    with raises(MissingPackage, match=r"^the study other2020 is not installed; installed: dong2015: install"):
        study("other2020")


def test_a_study_whose_module_is_broken_is_named_with_its_fault(only: Hide) -> None:
    only([EntryPoint(name="other2020", value="no_such_module_here:STUDY", group=GROUP)])
    with raises(InvalidInput, match=r"^the study other2020 cannot be loaded \(ModuleNotFoundError: No module named"):
        study("other2020")
