"""Drivers of a function generator and a motor, tried against faults of their calls with pretended instruments."""

import os
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import pytest

from sonolube.laboratory.driver_trial import drivers_to_try, faults_of, try_fault

pytestmark = pytest.mark.skipif(os.name == "nt", reason="Windows has no pseudo-terminals")


def test_twenty_faults_of_generator_and_motor_end_with_the_verdict_that_the_instruments_bear_out() -> None:
    drivers = drivers_to_try("tests.laboratory.drivers.pretended_bench")
    faults = faults_of(drivers.roles, quick=True)
    assert len(faults) == 20
    with ThreadPoolExecutor(4) as pool:
        runs = list(pool.map(partial(try_fault, drivers), faults))
    assert [(each.fault, each.wrong) for each in runs if each.wrong] == []
    verdicts = {each.verdict.partition(",")[0].partition(":")[0] for each in runs}
    assert verdicts - {"as they were before the run"} == {"confirmed off", "cut the power"}
    assert all(each.fault.is_lie for each in runs if each.is_on)
