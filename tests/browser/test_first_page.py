"""Answers that are shipped for the first page: those that are computed, and only for its own requests."""

import asyncio
import json
from collections.abc import Mapping
from typing import Any, cast

import pytest
from starlette.responses import Response
from tests.same import same

from sonolube.browser.example_pictures import FOLDER, example_entry
from sonolube.browser.first_page import REQUESTS, computed_answers, shipped_answer, shipped_answers
from sonolube.browser.routes import Workbench
from sonolube.browser.worker import Pool, encoded
from sonolube.example_files import example_files

CHANGED = {"rig": {"name": "tribometer", "changes": {"contact.normal_load": "4 N"}}}


def test_shipped_answers_are_those_that_are_computed() -> None:
    same(
        shipped_answers(), computed_answers(), relative=1e-6, absolute=1e-9
    )  # else: python -m sonolube.browser.first_page


def test_the_gallery_has_each_example_rig_with_its_answer_of_now() -> None:
    listed = json.loads((FOLDER / "examples.json").read_text(encoding="utf-8"))
    assert [each["name"] for each in listed] == [name for name, each in example_files().items() if each.is_rig]
    for name in ("power_map", "webbing_on_ring"):  # else: python -m sonolube.browser.example_pictures
        entry = example_entry(name)
        del entry["picture"]
        assert entry in listed
    assert all((FOLDER / f"{each['name']}.svg").stat().st_size < 4000 for each in listed)


def test_they_are_given_to_the_first_page_only_and_while_no_worker_has_started() -> None:
    for kind, payload in REQUESTS.items():
        assert json.loads(shipped_answer(kind, payload) or b"") == shipped_answers()[kind]
    assert shipped_answer("rig", CHANGED) is None
    assert shipped_answer("take", REQUESTS["rig"]) is None


class SlowPool:
    """Stands in for a pool."""

    def __init__(self, *, is_warm: bool) -> None:
        self.is_warm = is_warm

    async def ask(self, kind: str, payload: Mapping[str, Any], places: object, **more: object) -> tuple[int, bytes]:
        return 200, encoded("computed")


@pytest.mark.parametrize(
    ("is_warm", "rigs", "is_computed"), [(False, {}, False), (True, {}, True), (False, {"own": "own.toml"}, True)]
)
def test_a_worker_answers_as_soon_as_there_is_one(is_warm: bool, rigs: dict[str, str], is_computed: bool) -> None:
    unused: Any = type("Unused", (), {"folder": ""})()
    pool = cast("Pool", SlowPool(is_warm=is_warm))
    workbench = Workbench(pool=pool, jobs=unused, uploads=unused, rigs=rigs, opened="tribometer")
    reply: Response = asyncio.run(workbench._ask("rig", REQUESTS["rig"]))
    assert (bytes(reply.body) == b'"computed"') is is_computed
