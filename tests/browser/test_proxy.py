"""The workbench below a prefix, behind proxies that rewrite nothing but the path."""

import http.client
import threading
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager
from dataclasses import replace
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect
from tests.browser.pages import PROXIED, VOLTS, at_rest, enter, go, numbers, opened, saved
from tests.browser.workbench import Served, served
from tests.chromium import CHROMIUM

PREFIX = "/user/jo/proxy/8765"
_OF_A_CONNECTION = ("connection", "keep-alive", "transfer-encoding", "content-length")

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine; Debian's package is called chromium"),
]


@contextmanager
def proxied(workbench: Served, *, host: str) -> Iterator[str]:
    """Address of a proxy of the workbench below a prefix; the Host header passes as the browser sends it."""

    class Handler(BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"

        def _pass(self) -> None:
            if not self.path.startswith(f"{PREFIX}/"):
                self.send_error(404)
                return
            body = self.rfile.read(int(self.headers.get("content-length", 0)))
            with closing(http.client.HTTPConnection("127.0.0.1", workbench.port, timeout=300)) as connection:
                headers = {name: value for name, value in self.headers.items() if name.lower() not in _OF_A_CONNECTION}
                connection.request(self.command, self.path.removeprefix(PREFIX), body=body or None, headers=headers)
                reply = connection.getresponse()
                content = reply.read()
            self.send_response_only(reply.status)
            for name, value in reply.getheaders():
                if name.lower() not in _OF_A_CONNECTION:
                    self.send_header(name, value)
            self.send_header("content-length", str(len(content)))
            self.end_headers()
            self.wfile.write(content)

        do_GET = do_POST = do_DELETE = _pass  # noqa: N815 - names of the library

        def log_request(self, *args: object) -> None:
            """Write no log."""

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    server.daemon_threads = True
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield f"http://{host}:{server.server_port}{PREFIX}/"
    finally:
        server.shutdown()
        server.server_close()
        thread.join()


@pytest.mark.parametrize(
    ("host", "options"),
    [("localhost", ()), (PROXIED, ("--allow-host", PROXIED))],
    ids=["as Jupyter on this computer", "as nginx with a name"],
)
def test_the_workbench_is_used_below_a_prefix(
    host: str, options: tuple[str, ...], browser: Browser, workbench: Served, tmp_path: Path
) -> None:
    with ExitStack() as stack:
        behind = stack.enter_context(served(tmp_path, *options)) if options else workbench
        address = stack.enter_context(proxied(behind, host=host))
        behind = replace(behind, link=f"{address}?token={behind.token}")
        with opened(browser, behind) as page:
            assert page.url.startswith(f"{address}#/predict")
            enter(page, VOLTS, "21 V")
            shown = numbers(page)
            assert len(shown) >= 6
            page.get_by_test_id("take").click()
            assert "21 V" in saved(page, "toml")
            page.keyboard.press("Escape")
            page.reload()
            at_rest(page)
            assert numbers(page) == shown
            go(page, "explore")
            page.get_by_test_id("study:start").check()
            page.get_by_test_id("start-job").click()
            page.get_by_test_id("study").wait_for()
            go(page, "jobs")
            expect(page.get_by_test_id("jobs").locator("li")).to_have_count(1)
            expect(page.get_by_test_id("job-state")).to_have_text("done")
            page.get_by_test_id("open-job").click()
            page.get_by_test_id("job-result").wait_for()


def test_a_proxy_whose_name_was_not_allowed_is_refused(browser: Browser, workbench: Served) -> None:
    with proxied(workbench, host=PROXIED) as address:
        page = browser.new_page()
        reply = page.goto(f"{address}?token={workbench.token}")
        assert reply is not None
        assert reply.status == 421
        page.close()
