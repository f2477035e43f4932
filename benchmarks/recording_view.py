"""Times of a long recording on the page Data: the view of a part on the server, and frames while it is moved.

    python benchmarks/recording_view.py [--samples 2000000] [--views 200] [--frames 300]

The recording has time, voltage and friction force, as netCDF. Views are of random parts of any length. Frames are those
that Chromium draws while the pointer pans over the figure, zoomed to a twentieth: the time between them.
"""

import argparse
import shutil
import statistics
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import xarray as xr
from tests.browser.pages import at_rest, opened, started_browser
from tests.browser.workbench import served

from sonolube.browser.recording_view import file_view, recording_view
from sonolube.browser.requests import Places
from sonolube.browser.worker import encoded
from sonolube.measurement.recordings.reader import write_recording

_RATE = 20e3  # Hz
_FRAMES = """async (count) => {
  const figure = document.querySelector('[data-test=trace-figure]');
  const box = figure.getBoundingClientRect();
  const [y, at] = [box.top + 60, (share) => box.left + box.width * share];
  const send = (kind, x) => figure.dispatchEvent(
    new PointerEvent(kind, {clientX: x, clientY: y, pointerId: 1, bubbles: true}));
  figure.setPointerCapture = () => {};
  const frame = () => new Promise(requestAnimationFrame);
  const between = [];
  send('pointerdown', at(0.5));
  let last = await frame();
  for (let k = 0; k < count; k += 1) {
    send('pointermove', at(0.5 + 0.4 * Math.sin(k / 10)));
    const now = await frame();
    between.push(now - last);
    last = now;
  }
  send('pointerup', at(0.5));
  return between;
}"""


def written(folder: Path, samples: int) -> Path:
    """Recording with steps of the voltage."""
    t = np.arange(samples) / _RATE
    voltage = 28.0 * (np.floor(t / 10) % 2)
    force = 1 - 0.01 * voltage + 0.05 * np.random.default_rng(0).standard_normal(samples)
    variables = {
        "voltage_peak_to_peak": ("time", voltage, {"units": "V"}),
        "friction_force": ("time", force, {"units": "N"}),
    }
    recording = xr.Dataset(variables, coords={"time": ("time", t, {"units": "s"})})
    return write_recording(recording, path=folder / "long.nc")


def say(what: str, times: list[float]) -> None:
    """Print the median, 95 % and most of some times in ms."""
    ends = f"95 % {np.percentile(times, 95):.1f} ms, at most {max(times):.1f} ms"
    sys.stdout.write(f"{what}: median {statistics.median(times):.1f} ms, {ends}\n")


def server_times(path: Path, views: int) -> None:
    """Print the time of the first reading, and of views with their JSON."""
    with tempfile.TemporaryDirectory() as folder:
        shutil.copyfile(path, Path(folder, "0" * 32))
        places, file = Places(rigs={}, uploads=folder), {"name": path.name, "upload": "0" * 32}
        begun = time.perf_counter()
        view = file_view({"file": file}, places)
        sys.stdout.write(f"read once, with its extremes: {time.perf_counter() - begun:.2f} s\n")
        rng, times, largest = np.random.default_rng(1), [], 0
        for _ in range(views):
            ends = sorted(rng.uniform(view["begin"], view["end"], 2))
            begun = time.perf_counter()
            content = encoded(recording_view({"file": file, "from": ends[0], "to": ends[1]}, places))
            times.append(1e3 * (time.perf_counter() - begun))
            largest = max(largest, len(content))
        say(f"a view of at most {largest / 1e3:.0f} kB", times)


def frame_times(path: Path, frames: int) -> None:
    """Print the time between frames while the recording is panned."""
    with (
        tempfile.TemporaryDirectory() as folder,
        served(Path(folder)) as workbench,
        started_browser() as browser,
        opened(browser, workbench, viewport={"width": 1280, "height": 900}) as page,
    ):
        page.get_by_test_id("page:data").click()
        page.get_by_test_id("data-files").set_input_files(path)
        page.get_by_test_id("trace-shown").wait_for()
        at_rest(page)
        page.get_by_test_id("trace-figure").focus()
        for _ in range(13):
            page.keyboard.press("+")
        page.wait_for_timeout(1000)
        between = page.evaluate(_FRAMES, frames)
        say(f"between {frames} frames while panning, {sum(each > 20.0 for each in between)} of them late", between)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    for name, count in (("samples", 2_000_000), ("views", 200), ("frames", 300)):
        parser.add_argument(f"--{name}", type=int, default=count)
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        path = written(Path(folder), chosen.samples)
        server_times(path, chosen.views)
        frame_times(path, chosen.frames)


if __name__ == "__main__":
    main()
