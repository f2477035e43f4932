"""The first trials of every study of reliability fail nowhere and meet its bars; its page is that of its data."""

from pytest import mark
from reliability.page import PAGE, page
from reliability.studies import NAMES, study
from reliability.study import attempt, judged


@mark.parametrize("name", NAMES)
def test_the_first_trials_of_a_study_meet_its_bars(name: str) -> None:
    chosen = study(name)
    records = [attempt(chosen, seed) for seed in range(chosen.sample)]
    missed = [measure for measure in judged(chosen, records, sample=True) if not measure.holds]
    assert not missed


def test_the_page_of_reliability_is_that_of_its_data() -> None:
    assert PAGE.read_text(encoding="utf-8") == page()
