"""Times and memory of the workbench in Chromium: its start, an update, twenty sessions at once, and whether it grows.

    python benchmarks/workbench_times.py [--starts 5] [--updates 200] [--sessions 20] [--loads 1000] [--many 10000]

prints a table for `docs/speed.md`. Kernels are compiled before. Times of the start count from the command; the browser
runs already. An update is a step of the slider of the drive voltage on the page Predict, one in flight; the clients of
the other sessions ask as fast as they are answered, from this process, on the same cores.
"""

import argparse
import http.client
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import psutil  # type: ignore[import-untyped]
from playwright.sync_api import Browser, Page, sync_playwright
from tests.chromium import CHROMIUM, FLAGS

VOLTS = "drive.voltage_peak_to_peak"
MEBIBYTE = 2**20
STEPS = """async ([key, steps]) => {
  const slider = document.querySelector(`[data-test="slider:${key}"]`);
  const numbers = document.querySelector('[data-test=numbers]');
  const times = [];
  const middle = Number(slider.value);
  for (let step = 0; step < steps; step += 1) {
    const begun = performance.now();
    const changed = new Promise((done) => {
      const seen = new MutationObserver(() => {
        seen.disconnect();
        requestAnimationFrame(() => setTimeout(() => done(true)));
      });
      seen.observe(numbers, {subtree: true, characterData: true, childList: true});
      setTimeout(() => done(false), 5000);
    });
    slider.value = middle - 40 + 20 * (step % 5);
    slider.dispatchEvent(new Event('input', {bubbles: true}));
    if (await changed) times.push(performance.now() - begun);
    while (document.querySelector('.body > [aria-busy=true]')) await new Promise(requestAnimationFrame);
  }
  return times;
}"""


class Client:
    """A session without a browser: asks for updates one after the other."""

    def __init__(self, link: str) -> None:
        self._link = urlsplit(link)
        self._connection = http.client.HTTPConnection("127.0.0.1", self._link.port, timeout=120)
        self._cookie = ""
        _, headers = self.get(f"/?{self._link.query}")
        self._cookie = headers["set-cookie"].partition(";")[0]

    def get(self, path: str) -> tuple[bytes, Any]:
        """Content and headers of a reply."""
        self._connection.request("GET", path, headers={"cookie": self._cookie, "accept-encoding": "gzip"})
        with closing(self._connection.getresponse()) as reply:
            return reply.read(), reply.headers

    def update(self, step: int) -> float:
        """Seconds of an answer to a moved slider."""
        changes = {VOLTS: f"{14 + 0.01 * (step % 1000):.4g} V"}
        body = json.dumps({"rig": {"name": "tribometer", "changes": changes}, "draws": 1000})
        begun = time.perf_counter()
        headers = {"cookie": self._cookie, "content-type": "application/json", "accept-encoding": "gzip"}
        self._connection.request("POST", "/api/tasks/predict?tables=no", body, headers)
        with closing(self._connection.getresponse()) as reply:
            reply.read()
            assert reply.status == 200
        return time.perf_counter() - begun


@contextmanager
def workbench(folder: str) -> Iterator[tuple[str, psutil.Process, float]]:
    """Link and process of a workbench, and the time of the command."""
    begun = time.perf_counter()
    program = [str(Path(sys.executable).with_name("sonolube")), "app", "--no-browser", "--port", "0"]
    process = subprocess.Popen(program, stdout=subprocess.PIPE, text=True, env=os.environ | {"XDG_STATE_HOME": folder})
    assert process.stdout is not None
    try:
        found = re.search(r"http://\S+", process.stdout.readline())
        assert found is not None
        yield found[0], psutil.Process(process.pid), begun
    finally:
        process.terminate()
        process.wait(60)


def start(browser: Browser, folder: str) -> dict[str, float]:
    """Seconds from the command to each state of the first page, and kilobytes that were transferred."""
    page = browser.new_page()
    sizes: list[float] = []
    devtools = page.context.new_cdp_session(page)
    devtools.send("Network.enable")
    devtools.on("Network.loadingFinished", lambda event: sizes.append(event["encodedDataLength"]))
    with workbench(folder) as (link, _, begun):
        found = {"ready": time.perf_counter() - begun}
        opened = time.perf_counter() - begun
        page.goto(link, wait_until="commit")
        page.wait_for_selector("[data-test^='chart:'] canvas")
        found["first figure"] = time.perf_counter() - begun
        painted = "performance.getEntriesByName('first-contentful-paint')[0]?.startTime ?? 0"
        found["first paint"] = opened + page.evaluate(painted) / 1e3
        page.wait_for_load_state("networkidle")
        found["kilobytes"] = sum(sizes) / 1e3
        page.evaluate(STEPS, [VOLTS, 1])
        page.close()
    with workbench(folder) as (link, _, begun):
        Client(link).update(0)
        found["numbers of a worker"] = time.perf_counter() - begun
    return found


def updates(page: Page, parent: psutil.Process, steps: int) -> tuple[list[float], float, float]:
    """Milliseconds from slider to repaint, of the browser's main thread, and of the processes of the server, a step."""
    devtools = page.context.new_cdp_session(page)
    devtools.send("Performance.enable")

    def busy() -> float:
        metrics = devtools.send("Performance.getMetrics")["metrics"]
        return float(next(each["value"] for each in metrics if each["name"] == "TaskDuration"))

    page.evaluate(STEPS, [VOLTS, 20])
    browser, server = busy(), processor_time(parent)
    times = page.evaluate(STEPS, [VOLTS, steps])
    return times, 1e3 * (busy() - browser) / steps, 1e3 * (processor_time(parent) - server) / steps


def processor_time(parent: psutil.Process) -> float:
    """Seconds of processor time of a process and its children."""
    times = [each.cpu_times() for each in (parent, *parent.children(recursive=True))]
    return float(sum(each.user + each.system for each in times))


def memory(parent: psutil.Process) -> list[float]:
    """Resident memory of the server and of its workers, the largest last. [MiB]"""
    children = [each for each in parent.children() if each.memory_info().rss > 50 * MEBIBYTE]
    return [
        each.memory_info().rss / MEBIBYTE for each in (parent, *sorted(children, key=lambda c: c.memory_info().rss))
    ]


def crowd(link: str, count: int, done: threading.Event) -> list[list[float]]:
    """Times of updates of several sessions until an event, in seconds."""
    times: list[list[float]] = [[] for _ in range(count)]

    def session(at: int) -> None:
        client, step = Client(link), 37 * at
        while not done.is_set():
            times[at].append(client.update(step))
            step += 1

    threads = [threading.Thread(target=session, args=(at,), daemon=True) for at in range(count)]
    for thread in threads:
        thread.start()
    return times


def growth(link: str, parent: psutil.Process, *, loads: int, many: int) -> tuple[list[float], list[float], list[float]]:
    """Memory after a tenth of the loads, after them, and after further updates."""
    client = Client(link)
    page = client.get("/")[0]
    names = ["/", "/api/start", "/api/jobs", "/static/first-page.json", "/static/scripts/main.js", "/static/app.css"]
    assert page
    for _ in range(loads // 10):
        _ = [client.get(name) for name in names]
    _ = [client.update(step) for step in range(many // 10)]
    first = memory(parent)
    for _ in range(loads):
        _ = [client.get(name) for name in names]
    after_loads = memory(parent)
    _ = [client.update(step) for step in range(many)]
    return first, after_loads, memory(parent)


def row(what: str, bar: str, value: str) -> None:
    """Write a row of the table."""
    sys.stdout.write(f"| {what} | {bar} | {value} |\n")
    sys.stdout.flush()


def main() -> None:
    """Measure and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    for name, default in (("starts", 5), ("updates", 200), ("sessions", 20), ("loads", 1000), ("many", 10_000)):
        parser.add_argument(f"--{name}", type=int, default=default)
    chosen = parser.parse_args()
    if CHROMIUM is None:
        sys.exit("no Chromium on this machine; Debian's package is called chromium")
    sys.stdout.write("| what | bar | measured |\n|---|---|---|\n")
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        found = [start(browser, folder) for _ in range(chosen.starts)]
        bars = {"ready": 1.0, "first paint": 0.5, "first figure": 1.0, "numbers of a worker": 2.0}
        for name, bar in bars.items():
            values = [each[name] for each in found]
            row(f"{name} after the command", f"{bar:g} s", f"{statistics.median(values):.2f} s")
        row("transferred for the first page", "150 kB", f"{found[-1]['kilobytes']:.0f} kB")
        with workbench(folder) as (link, parent, _):
            page = browser.new_page()
            page.goto(link)
            page.wait_for_selector("[data-test=numbers]")
            times, own, server = updates(page, parent, chosen.updates)
            row("an update, processor time of the server", "25 ms", f"{server:.1f} ms")
            row("an update, browser's main thread", "40 ms", f"{own:.0f} ms")
            row("slider to repaint, 95 %, alone", "100 ms", f"{percentile(times):.0f} ms")
            resting = memory(parent)
            row("memory of the server", "60 MB", f"{resting[0]:.0f} MiB")
            row("memory of a worker", "220 MB", f"{resting[-1]:.0f} MiB")
            done = threading.Event()
            others = crowd(link, chosen.sessions - 1, done)
            times = page.evaluate(STEPS, [VOLTS, 40])
            done.set()
            row(f"slider to repaint, 95 %, {chosen.sessions} sessions", "300 ms", f"{percentile(times):.0f} ms")
            elsewhere = [1e3 * each for session in others for each in session[5:]]
            row("the same, of the other sessions, answers", "", f"{percentile(elsewhere):.0f} ms")
            page.close()
        with workbench(folder) as (link, parent, _):
            first, loaded, last = growth(link, parent, loads=chosen.loads, many=chosen.many)
            row(f"server, growth over {chosen.loads} page loads", "2 MB", f"{loaded[0] - first[0]:.1f} MiB")
            row(f"server, growth over {chosen.many} updates", "2 MB", f"{last[0] - loaded[0]:.1f} MiB")
            row(f"worker, growth over {chosen.many} updates", "2 MB", f"{last[-1] - loaded[-1]:.1f} MiB")
        browser.close()


def percentile(times: list[float]) -> float:
    """Time below which 95 % lie."""
    return statistics.quantiles(times, n=20)[-1]


if __name__ == "__main__":
    main()
