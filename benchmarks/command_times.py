"""Seconds of whole commands: the first run with no compiled kernel on disk, and later runs.

    python benchmarks/command_times.py [--runs 3] [--only WORD ...]

prints a table for `docs/speed.md`. Each command runs in a process and a folder of its own; the cache of kernels is a
new folder for each command, so that its first run compiles all that it needs. Processor time is that of the process and
of those that it starts. Of later runs the median of the clock stands, and the least and the median of the processor
time: on a shared machine the least comes nearest to the program's own.
"""

import argparse
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
RIG = str(EXAMPLES / "rigs" / "tribometer.toml")
COMMANDS = (
    ("--version",),
    ("materials",),
    ("actuators",),
    ("published",),
    ("schema",),
    ("contact", RIG),
    ("friction", RIG),
    ("wear", RIG),
    ("simulate", RIG),
    ("predict", RIG),
    ("response", RIG, "--from", "15kHz", "--to", "35kHz"),
    ("transient", RIG, "--duration", "0.06s"),
    ("thermal", RIG, "--pin", "stainless_steel_316", "--disc", "aluminium_2024"),
    ("regime", RIG, "--film-coefficient", "0.25", "--asperity-pressure", "10MPa"),
    ("sweep", RIG, "--over", "drive.voltage_peak_to_peak=2V:28V:27"),
    ("map", str(EXAMPLES / "rigs" / "power_map.toml"), "--kind", "velocity-power"),
    ("uncertainty", str(EXAMPLES / "rigs" / "tribometer_uncertain.toml"), "--samples", "256"),
    ("optimise", RIG, "--target-friction", "0.15"),
    ("control", RIG, "--friction", "0.5N", "--factor", "1.15", "--warming", "40K"),
    ("efficiency", str(EXAMPLES / "efficiency-runs.csv"), "--rig", str(EXAMPLES / "rigs" / "power_map.toml")),
    ("compare", RIG),
    ("literature", RIG),
    ("fit", str(EXAMPLES / "tribometer-runs.csv"), "--rig", RIG),
    ("plan", RIG),
    ("identify", "decay-length", str(EXAMPLES / "decay-length-run.csv"), "--free-frequency", "40Hz"),
    ("identify", "rig", RIG, "--facts", str(EXAMPLES / "facts" / "tribometer.toml"), "--out", "my.toml"),
    ("modes", "block", "--set", "length=127mm", "--set", "width=60.96mm", "--set", "thickness=25.4mm"),
    (
        "horn",
        "design",
        "stepped_horn",
        "--frequency",
        "20kHz",
        "--material",
        "titanium_6al4v",
        "--set",
        "end_radius=10mm",
    ),
    ("impedance", "compute", "tribometer_actuator", "--clamp", "back.-z", "--to", "40kHz"),
)

LONG = 6.0  # s of processor time from which a later run is not repeated


def run_once(arguments: tuple[str, ...], cache: str) -> tuple[float, float]:
    """Return wall and processor time of one run of a command. [s]"""
    program = [str(Path(sys.executable).with_name("sonolube")), *arguments]
    with tempfile.TemporaryDirectory() as folder:
        before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        done = subprocess.run(
            program,
            cwd=folder,
            env=os.environ | {"NUMBA_CACHE_DIR": cache},
            capture_output=True,
            text=True,
            check=False,
        )
        wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        sys.exit(f"{' '.join(program)}: {done.stderr}")
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    """Measure the commands and print their table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--runs", type=int, default=3, help="later runs of which least and median are taken, of short commands"
    )
    parser.add_argument("--only", nargs="*", default=[], help="only commands with one of these words in their name")
    chosen = parser.parse_args()
    heads = ("first run", "its processor time", "later runs", "their least processor time", "its median")
    sys.stdout.write(f"| command | {', s | '.join(heads)}, s |\n|---{'|---' * len(heads)}|\n")
    for arguments in COMMANDS:
        name = " ".join(word if "/" not in word else Path(word).name for word in arguments)
        if chosen.only and not any(word in arguments[:2] for word in chosen.only):
            continue
        with tempfile.TemporaryDirectory() as cache:
            cold = run_once(arguments, cache)
            warm = [run_once(arguments, cache)]
            again = chosen.runs - 1 if warm[0][1] < LONG else 0
            warm += [run_once(arguments, cache) for _ in range(again)]
        walls, times = zip(*warm, strict=True)
        wall, least, median = statistics.median(walls), min(times), statistics.median(times)
        sys.stdout.write(f"| `{name}` | {cold[0]:.1f} | {cold[1]:.1f} | {wall:.2f} | {least:.2f} | {median:.2f} |\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
