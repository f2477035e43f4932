"""Messages between two processes: lines put together from parts, damaged ones passed over, beats heard as life."""

import json
import os
from collections.abc import Iterator
from contextlib import suppress
from queue import SimpleQueue
from typing import Any

import pytest

from sonolube.laboratory.switch_off.messages import Link


@pytest.fixture
def pair() -> Iterator[tuple[Link, int, SimpleQueue[Any]]]:
    """A link that listens, the handle of its other side, and what it took; None for the end."""
    inward, far_out = os.pipe()
    far_in, outward = os.pipe()
    link, taken = Link(inward, outward), SimpleQueue[Any]()
    link.listen(taken.put, lambda: taken.put(None))
    yield link, far_out, taken
    link.close()
    for handle in (far_in, outward, far_out):
        with suppress(OSError):
            os.close(handle)


def test_messages_are_whole_lines_of_json_whatever_the_parts_in_which_they_come(
    pair: tuple[Link, int, SimpleQueue[Any]],
) -> None:
    _, far, taken = pair
    text = (
        json.dumps({"number": 1, "text": "Spannung 20 V, µ"}).encode() + b'\nrest of a line}\n{}\n[3]\n{"number": 2}\n'
    )
    for place in range(0, len(text), 7):
        os.write(far, text[place : place + 7])
    assert [taken.get(timeout=60)["number"] for _ in range(2)] == [1, 2]
    os.close(far)
    assert taken.get(timeout=60) is None
    assert taken.empty()


def test_a_beat_is_a_sign_of_life_and_no_message(pair: tuple[Link, int, SimpleQueue[Any]]) -> None:
    link, far, taken = pair
    link._heard -= 1e6
    assert link.silence > 1e6
    os.write(far, b'{}\n{"number": 3}\n')
    assert taken.get(timeout=60) == {"number": 3}
    assert link.silence < 1e6


def test_a_message_to_a_side_that_has_ended_is_dropped() -> None:
    inward, outward = os.pipe()
    os.close(inward)
    link = Link(-1, outward)
    link.send(number=1)
    os.close(outward)
