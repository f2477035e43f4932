"""Settings of other arithmetic: each names what a processor has, the others are left out with a reason."""

from pathlib import Path

import pytest
from tests import arithmetic
from tests.arithmetic import COMPILED, CORE, NUMBA, NUMPY, PART, THREADS, environment, settings

ROOT = Path(__file__).parents[1]
WIDE = {"dispatched": ["X86_V3", "X86_V4"], "vectors": ["SSE42", "AVX2", "X86_V3", "X86_V4"], "cores": 8, "core": "Zen"}
NARROW = {"dispatched": ["X86_V3"], "vectors": ["SSE42", "AVX2", "X86_V3"], "cores": 2, "core": "Haswell"}
OTHER = {"dispatched": [], "vectors": ["NEON"], "cores": 2, "core": "NeoverseN1"}  # another family of processors


def test_the_part_is_there() -> None:
    assert all((ROOT / name).is_file() for name in {*PART, *COMPILED})


def test_a_processor_with_wide_vectors_runs_every_setting() -> None:
    given = {name: value for setting in settings(WIDE) for name, value in setting.environment.items()}
    assert given.keys() == {NUMPY, CORE, NUMBA, *THREADS}
    assert [setting.environment[NUMPY] for setting in settings(WIDE) if NUMPY in setting.environment] == [
        "X86_V3 X86_V4",
        "X86_V4",
    ]
    assert not any(setting.lacks for setting in settings(WIDE))


@pytest.mark.parametrize(
    ("own", "left_out"),
    [
        (
            NARROW,
            ["numpy with the lowest of its loops for this processor", "OpenBLAS for Haswell", "OpenBLAS for SkylakeX"],
        ),
        (
            OTHER,
            [
                "numpy without its loops for this processor",
                "numpy with the lowest of its loops for this processor",
                *(f"OpenBLAS for {core}" for core in ("Haswell", "SkylakeX", "Nehalem")),
            ],
        ),
    ],
)
def test_what_a_processor_lacks_is_left_out_with_a_reason(own: dict[str, object], left_out: list[str]) -> None:
    assert [setting.name for setting in settings(own) if setting.lacks] == left_out


def test_a_setting_stands_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(CORE, "Prescott")
    monkeypatch.setenv(THREADS[0], "7")
    (numba,) = (setting for setting in settings(WIDE) if NUMBA in setting.environment)
    told = environment(numba)
    assert (told.get(CORE), told[THREADS[0]], told[NUMBA]) == (None, "1", "generic")
    assert arithmetic.report(numba)["numba"] == "generic"
