"""Run studies in full: ``python -m reliability [NAME ...] [--trials N] [--workers N]``.

Records are appended to out/reliability/NAME-HASH.jsonl as trials end; a run continues where an earlier one stopped,
unless the code that the study names as its sources has changed. A complete study writes its measures to
docs/reliability/NAME.json, from which docs/reliability.md is written.
"""

import argparse
import contextlib
import json
import sys
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict
from functools import partial
from hashlib import sha256
from pathlib import Path

from reliability.page import DATA, write_page
from reliability.studies import NAMES, study
from reliability.study import Record, attempt, judged

FOLDER = Path("out/reliability")
_REPORT_EVERY = 10.0  # s


def _attempt(name: str, seed: int) -> Record:
    return attempt(study(name), seed)


def _source(name: str) -> str:
    """Hash of the study and its sources, so that records of other code are not continued."""
    files = [
        *(path for source in study(name).sources for path in sorted(Path("src/sonolube").glob(source))),
        Path(__file__).parent / "studies" / f"{name}.py",
    ]
    return sha256(b"".join(path.read_bytes() for path in files)).hexdigest()[:12]


def _recorded(path: Path) -> Iterator[Record]:
    """Records of an earlier run; a last line that a kill cut short is left out."""
    if path.exists():
        for line in path.read_text(encoding="utf-8").splitlines():
            with contextlib.suppress(json.JSONDecodeError):
                yield json.loads(line)


def run(name: str, *, trials: int | None, workers: int) -> bool:
    """Run the missing trials of a study, and whether all its measures hold."""
    chosen = study(name)
    count = chosen.trials if trials is None else trials
    path = FOLDER / f"{name}-{_source(name)}.jsonl"
    path.parent.mkdir(parents=True, exist_ok=True)
    records = {int(str(record["seed"])): record for record in _recorded(path) if int(str(record["seed"])) < count}
    missing = [seed for seed in range(count) if seed not in records]
    started = reported = time.monotonic()
    with path.open("a", encoding="utf-8") as stream, ProcessPoolExecutor(workers) as pool:
        stream.write("\n" if records else "")
        for number, done in enumerate(as_completed(pool.submit(partial(_attempt, name, seed)) for seed in missing), 1):
            record = done.result()
            stream.write(json.dumps(record) + "\n")
            stream.flush()
            records[int(str(record["seed"]))] = record
            if time.monotonic() - reported > _REPORT_EVERY or number == len(missing):
                reported = time.monotonic()
                left = (reported - started) / number * (len(missing) - number)
                sys.stderr.write(f"{name}: {len(records)} of {count} trials, {left:.0f} s left\n")
    return _conclude(name, [records[seed] for seed in range(count)], whole=trials is None)


def _conclude(name: str, records: Sequence[Record], *, whole: bool) -> bool:
    """Print the measures of a study; those of a full run go to the page."""
    measures = judged(study(name), records)
    for measure in measures:
        sys.stdout.write(f"{'ok  ' if measure.holds else 'MISS'} {measure.label}: {measure.value} ({measure.bar})\n")
    if whole:
        data = {"trials": len(records), "measures": [asdict(measure) for measure in measures]}
        DATA.mkdir(exist_ok=True)
        (DATA / f"{name}.json").write_text(json.dumps(data, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
        write_page()
    return all(measure.holds for measure in measures)


def main() -> int:
    """Exit status: 0 where every measure holds."""
    parser = argparse.ArgumentParser(prog="python -m reliability", description=__doc__)
    parser.add_argument("names", nargs="*", choices=[*NAMES, []], metavar="NAME", help=", ".join(NAMES))
    parser.add_argument("--trials", type=int, help="fewer trials than the full study; the page is left as it is")
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    held = [run(name, trials=options.trials, workers=options.workers) for name in options.names or NAMES]
    return 0 if all(held) else 1


if __name__ == "__main__":
    sys.exit(main())
