"""Tests that compute most under other arithmetic than this processor's own: `make arithmetic`.

numpy, OpenBLAS and numba choose their loops by the processor, and the order of sums follows from that and from the
number of threads: the last digits of a number are those of one machine. Each setting below is another machine; a part
of the tests runs under each alone, and holds what the whole suite holds here. A setting that this processor lacks is
left out and said. The last line of a run is a setting with its counts; the exit code is 1 where a test has failed.
"""

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any

NUMPY, CORE, NUMBA = "NPY_DISABLE_CPU_FEATURES", "OPENBLAS_CORETYPE", "NUMBA_CPU_NAME"
THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "NUMBA_NUM_THREADS")

# of numpy and OpenBLAS: sums, transforms, factors and fits, and the terminal beside Python
PART = (
    "tests/identification/test_circuit_fit.py",
    "tests/models/contact/test_rough.py",
    "tests/models/fem/solver/test_modes.py",
    "tests/models/fem/solver/test_multifrontal.py",
    "tests/models/surfaces/test_gaussian_filter.py",
    "tests/tasks/predict/test_operating_point.py",
    "tests/tasks/predict/test_predict.py",
)
# of numba, which compiles anew for another processor: few kernels
COMPILED = ("tests/models/surfaces/test_gaussian_filter.py", "tests/tasks/predict/test_operating_point.py")

_PROBE = """
import ctypes, glob, json, os
import numpy
from numba.core.registry import cpu_target
from numpy._core import _multiarray_umath as core
libraries = glob.glob(os.path.join(os.path.dirname(numpy.__file__), "..", "numpy.libs", "*openblas64*"))
threads = [ctypes.CDLL(each).scipy_openblas_get_num_threads64_() for each in libraries]
print(json.dumps({
    "dispatched": [name for name in core.__cpu_dispatch__ if core.__cpu_features__[name]],
    "vectors": [name for name, has in core.__cpu_features__.items() if has],
    "numba": cpu_target.target_context.codegen().magic_tuple()[1],
    "threads": threads[0] if threads else None,
    "cores": os.cpu_count(),
}))
"""


@dataclass(frozen=True)
class Setting:
    """Another machine: what the environment says, and what a program then reports; or why it is left out."""

    name: str
    environment: dict[str, str] = field(default_factory=dict)
    reported: dict[str, Any] = field(default_factory=dict)
    part: Sequence[str] = PART
    lacks: str = ""


def settings(own: dict[str, Any]) -> Iterator[Setting]:
    """Settings for a processor, by what a program reports on it."""
    has = own["dispatched"]
    yield Setting(
        "numpy without its loops for this processor",
        {NUMPY: " ".join(has)},
        {"dispatched": []},
        lacks="" if has else "there are none",
    )
    yield Setting(
        "numpy with the lowest of its loops for this processor",
        {NUMPY: " ".join(has[1:])},
        {"dispatched": has[:1]},
        lacks="" if has[1:] else f"there are no others than {' '.join(has) or 'the plain ones'}",
    )
    is_wide = bool({"X86_V4", "AVX512_SKX", "AVX512F"} & set(own["vectors"]))
    for core, lacks in (
        ("Haswell", "" if "AVX2" in own["vectors"] else "this processor has no AVX2"),
        ("SkylakeX", "" if is_wide else "this processor has no AVX-512"),
        ("Nehalem", "" if "SSE42" in own["vectors"] else "this processor has no SSE4.2"),
    ):
        same = "it is taken without a setting" if core == own["core"] else ""
        yield Setting(f"OpenBLAS for {core}", {CORE: core}, {"core": core}, lacks=lacks or same)
    yield Setting("numba for any processor", {NUMBA: "generic"}, {"numba": "generic"}, part=COMPILED)
    for count in (1, 4):  # OpenBLAS takes no more threads than there are cores
        name = f"{count} thread{'s' if count > 1 else ''}"
        yield Setting(name, dict.fromkeys(THREADS, str(count)), {"threads": min(count, own["cores"])})


def environment(setting: Setting) -> dict[str, str]:
    """Environment of a setting alone."""
    others = {name: value for name, value in os.environ.items() if name not in (NUMPY, CORE, NUMBA, *THREADS)}
    return others | {THREADS[0]: "1", "MPLBACKEND": "Agg"} | setting.environment


def report(setting: Setting) -> dict[str, Any]:
    """What a program reports of numpy, OpenBLAS and numba under a setting."""
    told = environment(setting) | {"OPENBLAS_VERBOSE": "2"}
    run = subprocess.run([sys.executable, "-c", _PROBE], env=told, capture_output=True, text=True, check=True)
    found: dict[str, Any] = json.loads(run.stdout)
    return found | {"core": next(iter(re.findall(r"^Core: (\S+)", run.stderr, re.MULTILINE)), None)}


def has_taken_effect(setting: Setting) -> bool:
    """Whether what a program reports is that of the setting; what it does not report is believed."""
    found = report(setting)
    return all(found[name] in (value, None) for name, value in setting.reported.items())


def has_passed(setting: Setting) -> bool:
    """Run the part of a setting, and print one line with its counts and seconds, below what has failed."""
    if setting.lacks:
        tell(f"{setting.name}: left out, {setting.lacks}")
        return True
    if not has_taken_effect(setting):
        tell(f"{setting.name}: without effect on {report(setting)}")
        return False
    words = ["-m", "pytest", "-q", "-n", "0", "-p", "no:cacheprovider", *setting.part]
    run = subprocess.run(
        [sys.executable, *words], env=environment(setting), capture_output=True, text=True, check=False
    )
    failed = run.stdout + run.stderr if run.returncode else ""
    *_, line = run.stdout.splitlines() or ["no report"]  # such as: 3 failed, 141 passed in 20.46s
    tell(f"{failed}{setting.name}: {line.strip('= ')}")
    return run.returncode == 0


def tell(line: str) -> None:
    """Write a line at once."""
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def main() -> None:
    """Run every setting in a process of its own, two at a time."""
    with ThreadPoolExecutor(2) as pool:
        results = list(pool.map(has_passed, settings(report(Setting("own")))))
    sys.exit(not all(results))


if __name__ == "__main__":
    main()
