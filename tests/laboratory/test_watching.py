"""Watchers of a run: what they are told, and that none of them holds or ends it."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from tests.laboratory.simulated_rig import MemoryRecord, SimulatedRig
from tests.laboratory.test_runner import protocol

from sonolube.facts.protocol import SetPoint
from sonolube.laboratory import Block, Channel, Interlock, run_protocol


class Watcher:
    """Watcher that keeps what it is told."""

    def __init__(self) -> None:
        self.blocks: list[tuple[float, Block]] = []
        self.aside: list[Block] = []
        self.steps: list[str] = []
        self.kinds: list[str] = []
        self.limits: dict[str, float] = {}

    def records(self, folder: Path) -> None:
        raise AssertionError("the runner knows no folder")

    def begins(self, channels: Mapping[str, Channel], locks: Sequence[Interlock]) -> None:
        assert set(channels) == set(SimulatedRig().channels)
        self.limits = {lock.channel.name: lock.limit for lock in locks}

    def reaches(self, point: SetPoint) -> None:
        self.steps.append(point.step)

    def takes(self, names: Sequence[str], block: Block, *, time: float) -> None:
        assert "friction_force" in names
        self.blocks.append((time, block))

    def takes_aside(self, names: Sequence[str], block: Block) -> None:
        self.aside.append(block)

    def notes(self, kind: str, facts: Mapping[str, str | float]) -> None:
        self.kinds.append(kind)


class Broken(Watcher):
    """Watcher that raises at all it is told."""

    def __getattribute__(self, name: str) -> object:
        raise ZeroDivisionError(name)


def test_a_watcher_is_told_limits_set_points_events_and_every_block_in_the_time_of_the_protocol() -> None:
    watcher, record, test = Watcher(), MemoryRecord(), protocol(temperature_maximum="350 K")
    run_protocol(test, SimulatedRig().devices(), record, operator=lambda prompt: True, watcher=watcher)
    assert watcher.limits["temperature"] == 350.0
    assert watcher.steps == ["1", "2", "3", "4", "5", *["6"] * 5]
    assert watcher.kinds == [kind for kind, _ in record.notes]
    recorded = np.concatenate([block.values for _, block in watcher.blocks])
    kept = np.concatenate([block.values for block in record.segments[0]])
    np.testing.assert_array_equal(recorded[:, : kept.shape[1]], kept)
    ends = [time + block.samples / block.sample_rate for time, block in watcher.blocks]
    np.testing.assert_allclose([time for time, _ in watcher.blocks[1:]], ends[:-1], atol=1e-9)
    assert ends[-1] == 32.5
    assert watcher.aside  # the temperature while the operator was asked


def test_a_watcher_that_raises_changes_nothing_of_a_run() -> None:
    found = []
    for watcher in (None, Broken()):
        record, rig = MemoryRecord(), SimulatedRig()
        result = run_protocol(protocol(), rig.devices(), record, operator=lambda prompt: True, watcher=watcher)
        found.append((result, rig.calls, record.notes, [block.values.sum() for block in record.segments[0]]))
    assert found[0] == found[1]
