"""The first trials of every study of reliability fail nowhere and meet its bars; its page is that of its data."""

from collections import Counter

from pytest import mark
from reliability.mutant_list import MutantList
from reliability.mutation import SOURCE, Mutant
from reliability.page import PAGE, page
from reliability.studies import NAMES, mutants_above_models, mutants_of_models, study
from reliability.study import attempt, judged

LISTS = (mutants_of_models.LIST, mutants_above_models.LIST)  # of which one is empty until it is drawn


@mark.parametrize("name", NAMES)
def test_the_first_trials_of_a_study_meet_its_bars(name: str) -> None:
    chosen = study(name)
    records = [attempt(chosen, seed) for seed in range(chosen.sample)]
    missed = [measure for measure in judged(chosen, records, sample=True) if not measure.holds]
    assert not missed


@mark.parametrize("name", NAMES)
def test_the_sources_of_a_study_are_there(name: str) -> None:
    assert [source for source in study(name).sources if not list(SOURCE.glob(source))] == []


def test_the_page_of_reliability_is_that_of_its_data() -> None:
    assert PAGE.read_text(encoding="utf-8") == page()


@mark.parametrize("mutants", [each for each in LISTS if each.entries], ids=lambda each: each.name)
def test_the_listed_mutants_are_a_whole_sample_of_which_few_survive_or_the_page_names_those(
    mutants: MutantList,
) -> None:
    rooms = Counter(mutants.room(Mutant(**entry["mutant"])) for entry in mutants.entries)
    assert rooms == mutants.rooms
    killable = [entry for entry in mutants.entries if not entry["equivalent"]]
    survivors = [entry["mutant"] for entry in killable if not entry["killed_by"]]
    named = PAGE.read_text(encoding="utf-8")
    assert (
        len(survivors) <= (1 - mutants.bar) * len(killable)
        or [mutant for mutant in survivors if f"`{mutant['file']}`: `{mutant['line']}`" not in named] == []
    )
