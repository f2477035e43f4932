"""One law for vibration along the normal and within the plane beside the two that ship, by blind scores."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from reliability.joint_law import SLIP_RATIO, JointLaw, JointPopulation
from reliability.study import Measure, Record, Study
from sonolube.prediction.calibration import Calibration, blind_calibration, plane_calibration
from sonolube.prediction.evidence import published_rigs
from sonolube.prediction.hierarchy import PROBABILITIES, Prior
from sonolube.prediction.within_plane import plane_rigs

TWO_LAWS = "two laws (shipped)"
"""Name of what the others stand beside."""

_ONE_DISCREPANCY = Prior(correlation_length=(1e3, 1e-3))  # the same at all conditions of a rig
_Scored = Callable[[], tuple[Calibration, Calibration, float | None]]


@dataclass(frozen=True, kw_only=True)
class Law:
    """Law with the calibrations of its blind predictions along the normal and within the plane, and effective draws."""

    name: str
    scored: _Scored


def _shipped() -> tuple[Calibration, Calibration, float | None]:
    return blind_calibration(), plane_calibration(), None


def _joint(name: str, law: JointLaw) -> Law:
    """Law that is learned from the tests in all directions together."""

    def scored() -> tuple[Calibration, Calibration, float | None]:
        normal, rigs = len(published_rigs()), (*published_rigs(), *plane_rigs())
        population = JointPopulation(law=law, rigs=rigs)
        found = [population.unseen(place) for place in range(len(rigs))]
        parts = found[:normal], found[normal:]
        along, within = (
            Calibration(name=name, predictions=tuple(one for rig in part for one in rig)) for part in parts
        )
        return along, within, population.effective_draws()

    return Law(name=name, scored=scored)


LAWS = (
    Law(name=TWO_LAWS, scored=_shipped),
    _joint("one law", JointLaw()),
    _joint("one law, one discrepancy a rig", JointLaw(prior=_ONE_DISCREPANCY)),
    _joint("two laws of one decay length", JointLaw(is_one_slip=False)),
    _joint("two laws of one decay length, one discrepancy a rig", JointLaw(prior=_ONE_DISCREPANCY, is_one_slip=False)),
)


def _trial(seed: int) -> Record:
    law = LAWS[seed]
    along, within, effective = law.scored()
    return {
        "name": law.name,
        "along": [along.covered(probability) for probability in PROBABILITIES],
        "tests_along": len(along.predictions),
        "crps_along": along.crps,
        "within": [within.covered(probability) for probability in PROBABILITIES],
        "tests_within": len(within.predictions),
        "crps_within": within.crps_by_rig,
        "effective": effective,
    }


def _measures(records: Sequence[Record]) -> list[Measure]:
    scores = "along the normal within 50, 80, 95 %; CRPS; within the plane likewise; mean CRPS of its sources"
    return [
        Measure(label=f"{record['name']}: {scores}; effective draws", value=score_text(record)) for record in records
    ]


def score_text(record: Record) -> str:
    """Scores of a law in one line, its numbers between semicolons."""
    along, within, effective = record["along"], record["within"], record["effective"]
    assert isinstance(along, list)
    assert isinstance(within, list)
    return "; ".join(
        (
            f"{'/'.join(map(str, along))} of {record['tests_along']}",
            f"{float(str(record['crps_along'])):.3f}",
            f"{'/'.join(map(str, within))} of {record['tests_within']}",
            f"{float(str(record['crps_within'])):.3f}",
            "-" if effective is None else f"{float(str(effective)):.0f}",
        )
    )


STUDY = Study(
    title="One law for all directions",
    question="Asperities on exponential heights with a latent decay length along the normal and a latent slip length"
    " within the plane, learned from all tests together: each set along the normal and each source within the plane is"
    " predicted from all others. One law takes the slip length for the memory length along the normal; two laws of one"
    " decay length share that length alone. Assumed: a slip length of phi decay lengths, with a lognormal phi of each"
    f" rig about a common one, whose prior is Mindlin's mu C of {SLIP_RATIO:.2f} within a factor of e; all other priors"
    " are those that ship.",
    sources=tuple(
        f"prediction/{name}.py" for name in ("calibration", "evidence", "hierarchy", "posterior", "within_plane")
    ),
    trials=len(LAWS),
    sample=1,
    trial=_trial,
    measures=_measures,
)
"""One law for all directions."""
