"""Skipped tests counted: with SONOLUBE_ALLOWED_SKIPS, a run fails if a test without one of these marks skips."""

import os
from collections.abc import Collection

import pytest

SKIPPED: list[tuple[str, str]] = []


def allowed() -> frozenset[str] | None:
    """Marks whose tests may skip, with spaces between; None where all may."""
    text = os.environ.get("SONOLUBE_ALLOWED_SKIPS")
    return None if text is None else frozenset(text.split())


def unexpected(report: pytest.TestReport | pytest.CollectReport, marks: Collection[str]) -> bool:
    """Whether a report is of a skip that none of the marks allows; the failure that is expected is no skip."""
    return report.skipped and not hasattr(report, "wasxfail") and not set(marks) & set(report.keywords)


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    marks = allowed()
    if marks is not None and unexpected(report, marks):
        SKIPPED.append((report.nodeid, _reason(report)))


def pytest_collectreport(report: pytest.CollectReport) -> None:
    if allowed() is not None and report.skipped:
        SKIPPED.append((report.nodeid, _reason(report)))


def pytest_sessionfinish(session: pytest.Session) -> None:
    if SKIPPED and not hasattr(session.config, "workerinput"):
        session.exitstatus = pytest.ExitCode.TESTS_FAILED


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    if SKIPPED:
        terminalreporter.section(f"{len(SKIPPED)} skipped that must run here", red=True, bold=True)
        for name, reason in sorted(set(SKIPPED)):
            terminalreporter.line(f"{name}: {reason}")


def _reason(report: pytest.TestReport | pytest.CollectReport) -> str:
    """Reason of a skip, which names the remedy."""
    return str(report.longrepr[2]) if isinstance(report.longrepr, tuple) else str(report.longrepr)
