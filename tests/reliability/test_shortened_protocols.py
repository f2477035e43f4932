"""Shortened protocols on the virtual rig: a signal that ends a run is no failed trial."""

import signal
from pathlib import Path

import pytest
from pytest import MonkeyPatch
from reliability.shortened_protocols import PartsInMemory, require_completed, run_shortened

from sonolube.rig import read_rig

RIG = Path(__file__).parents[2] / "examples" / "rigs" / "power_map.toml"


def test_a_signal_in_a_run_ends_the_study_and_is_not_recorded_as_a_failure(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(PartsInMemory, "begin", lambda *_, **__: signal.raise_signal(signal.SIGTERM))
    with pytest.raises(KeyboardInterrupt, match="map_test: terminated"):
        run_shortened(read_rig(RIG), "map_test", seed=0)


def test_a_run_that_a_limit_stops_is_a_failure() -> None:
    with pytest.raises(RuntimeError, match="map_test: force above its limit"):
        require_completed("map_test", outcome="stopped", reason="force above its limit")
    require_completed("map_test", outcome="completed", reason="")
