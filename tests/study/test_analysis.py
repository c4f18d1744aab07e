"""User studies: Fleiss' kappa, shares and means, careless participants, and files that are refused."""

import csv
import pathlib

import numpy as np
import pytest

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.study import Material, StudyPlan, Trial, analyse, fleiss_kappa, plan_study, read_answers
from urbanverse_mjx.study.agreement import kappa_interval
from urbanverse_mjx.study.analysis import crossed_weights
from urbanverse_mjx.study.answers import COLUMNS, Answer
from urbanverse_mjx.study.plan import PAIR_CRITERIA, RATING_CRITERIA

#: Ten subjects, fourteen raters and five categories: the usual textbook example.
FOURTEEN_RATERS = np.array(
    [
        [0, 0, 0, 0, 14], [0, 2, 6, 4, 2], [0, 0, 3, 5, 6], [0, 3, 9, 2, 0], [2, 2, 8, 1, 1],
        [7, 7, 0, 0, 0], [3, 2, 6, 3, 0], [2, 5, 3, 2, 2], [6, 5, 2, 1, 0], [0, 2, 2, 3, 7],
    ]
)  # fmt: skip


def material(group: str, count: int, suffix: str = ".jpg") -> list[Material]:
    return [Material(f"{group}_{k}", group, f"{group[0]}{k}{suffix}") for k in range(count)]


def test_kappa_of_the_textbook_example() -> None:
    # P-bar = 0.378, P_e = 0.213.
    assert fleiss_kappa(FOURTEEN_RATERS) == pytest.approx(0.210, abs=5e-4)


def test_kappa_of_full_agreement_of_none_and_of_one_category() -> None:
    assert fleiss_kappa(np.array([[3, 0], [0, 3], [3, 0]])) == pytest.approx(1.0)
    # Two raters who always differ: P = 0, P_e = 1/2.
    assert fleiss_kappa(np.array([[1, 1], [1, 1]])) == pytest.approx(-1.0)
    assert np.isnan(fleiss_kappa(np.array([[3, 0], [3, 0]])))
    # Items of a single rating say nothing about agreement.
    assert fleiss_kappa(np.array([[3, 0], [0, 3], [1, 0]])) == pytest.approx(1.0)
    with pytest.raises(ValidationError, match="no item with two ratings"):
        fleiss_kappa(np.array([[1, 0], [0, 1]]))


def test_kappa_of_random_answers_is_zero_within_its_interval() -> None:
    rng = np.random.default_rng(0)
    counts = rng.multinomial(20, [0.5, 0.3, 0.2], 200)
    low, high = kappa_interval(counts) or (1.0, 0.0)
    assert low < 0.0 < high
    assert high - low < 0.05


def test_every_image_is_in_as_many_pairs_as_another_and_names_tell_nothing() -> None:
    rows = {"urbanverse": material("urbanverse", 3), "procedural": material("procedural", 4)}
    plan = plan_study(rows, material("oracle", 2, ".mp4"), pairs=7, catches=2, seed=1)
    pairs = [t for t in plan.trials if t.kind == "pair" and not t.catch]
    shown = [f for t in pairs for f in t.files]
    assert sorted(shown.count(m.file) for m in rows["urbanverse"]) == [2, 2, 3]
    assert sorted(shown.count(m.file) for m in rows["procedural"]) == [1, 2, 2, 2]
    assert all({plan.key[f]["group"] for f in t.files} == set(rows) for t in pairs)
    catches = [t for t in plan.trials if t.catch]
    assert [t.catch for t in catches] == ["equal", "equal", "2", "2"]
    assert all(t.files[0] == t.files[1] for t in catches if t.kind == "pair")
    assert StudyPlan.from_json(plan.to_json(), "plan") == plan
    assert plan_study(rows, [], pairs=7, seed=1) != plan_study(rows, [], pairs=7, seed=2)


def test_a_study_needs_something_to_show() -> None:
    with pytest.raises(ValidationError, match="groups of overview images"):
        plan_study({"urbanverse": material("urbanverse", 1), "procedural": []}, [])
    with pytest.raises(ValidationError, match="nothing to show"):
        plan_study({}, [], pairs=0)


def answers_of(plan: StudyPlan, people: int, better: float, seed: int = 0, careless: int = 0) -> list[Answer]:
    """Participants who prefer urbanverse with probability `better`, and rate it 4 or 5 and others 1 or 2; the last ones
    answer catch trials wrongly and prefer the other group."""
    rng, found = np.random.default_rng(seed), []
    for person in range(people):
        bad = person >= people - careless
        for trial in plan.trials:
            criteria = PAIR_CRITERIA if trial.kind == "pair" else RATING_CRITERIA
            first, second = (*trial.files, "")[:2]
            if trial.kind == "pair" and rng.random() < 0.5:
                first, second = second, first
            for criterion in criteria:
                ours = "A" if plan.key[first]["group"] == "urbanverse" else "B"
                other = "B" if ours == "A" else "A"
                if trial.catch:
                    answer = trial.catch if not bad else ("A" if trial.kind == "pair" else "5")
                elif trial.kind == "pair":
                    answer = other if bad or rng.random() >= better else ours
                else:
                    answer = str((4 if ours == "A" else 1) + int(rng.integers(2)))
                found.append(Answer(f"p{person}", trial.id, trial.kind, first, second, criterion, answer, 3.0))
    return found


@pytest.fixture
def plan() -> StudyPlan:
    rows = {"urbanverse": material("urbanverse", 10), "procedural": material("procedural", 10)}
    videos = [*material("urbanverse", 4, ".mp4"), *material("procedural", 4, ".mp4")]
    return plan_study(rows, videos, pairs=10, catches=3)


@pytest.mark.extended
def test_shares_and_means_are_recovered_and_careless_people_left_out(plan: StudyPlan) -> None:
    found = analyse(answers_of(plan, 24, 0.8, careless=4), plan)
    assert (found["participants"], len(found["excluded"])) == (20, 4)
    row = found["pairs"]["overall_realism"]
    shares = row["shares"]
    assert shares["urbanverse"]["low"] < 80.0 < shares["urbanverse"]["high"]
    assert shares["urbanverse"]["mean"] + shares["procedural"]["mean"] + shares["equal"]["mean"] == pytest.approx(
        100, abs=0.1
    )
    assert row["p"] < 0.001
    assert row["n"] == 200
    rated = found["ratings"]["overall_realism"]["groups"]
    assert rated["urbanverse"]["low"] < 4.5 < rated["urbanverse"]["high"]
    assert rated["procedural"]["high"] < 2.0
    with_careless = analyse([a for a in answers_of(plan, 24, 0.8, careless=4) if "catch" not in a.trial], plan)
    assert with_careless["pairs"]["overall_realism"]["shares"]["urbanverse"]["mean"] < shares["urbanverse"]["mean"] - 5


@pytest.mark.extended
def test_people_without_preference_give_a_large_p_and_no_agreement(plan: StudyPlan) -> None:
    row = analyse(answers_of(plan, 30, 0.5, seed=3), plan)["pairs"]["layout_coherence"]
    assert row["p"] > 0.05
    assert row["kappa_interval"][0] < 0.02
    sure = analyse(answers_of(plan, 5, 1.0), plan)["pairs"]["layout_coherence"]
    # All of five say the same: the interval still admits others.
    assert sure["shares"]["urbanverse"]["mean"] == 100.0
    assert sure["shares"]["urbanverse"]["low"] < 60.0
    assert sure["kappa"] is None


def test_the_interval_of_crossed_answers_is_wider_than_that_of_single_ones() -> None:
    """With answers that depend on the participant alone, the spread is that of participants, not of answers."""
    people = [f"p{k}" for k in range(16) for _ in range(25)]
    items = [f"t{k}" for _ in range(16) for k in range(25)]
    values = np.repeat(np.random.default_rng(0).normal(size=16), 25)
    weights = crossed_weights(people, items)
    means = (weights @ values) / weights.sum(1)
    assert means.std() == pytest.approx(values.std() / 4, rel=0.15)


def written(path: pathlib.Path, answers: list[Answer], **changed: str) -> pathlib.Path:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list[str](COLUMNS))
        writer.writeheader()
        for k, a in enumerate(answers):
            row = {"study": "s", "participant": a.participant, "trial": a.trial, "kind": a.kind, "first": a.first}
            row |= {
                "second": a.second,
                "criterion": a.criterion,
                "answer": a.answer,
                "seconds": "2.5",
                "position": str(k),
            }
            writer.writerow({**row, **(changed if k == 0 else {})})
    return path


def test_files_are_read_and_mistakes_named(plan: StudyPlan, tmp_path: pathlib.Path) -> None:
    answers = answers_of(plan, 1, 0.7)
    path = written(tmp_path / "a.csv", answers)
    assert [(a.trial, a.answer) for a in read_answers([path], plan)] == [(a.trial, a.answer) for a in answers]
    cases = {
        "trial 'x'": {"trial": "x"},
        "answer: found 'C'": {"answer": "C"},
        "criterion: found 'taste'": {"criterion": "taste"},
        "files 'z.jpg'": {"first": "z.jpg"},
        "seconds": {"seconds": "long"},
    }
    for text, changed in cases.items():
        with pytest.raises(ValidationError, match=text):
            read_answers([written(tmp_path / "b.csv", answers, **changed)], plan)
    with pytest.raises(ValidationError, match="a second answer of 'p0'"):
        read_answers([path, path], plan)
    (tmp_path / "c.csv").write_text("a,b\n1,2\n")
    with pytest.raises(ValidationError, match="columns a, b"):
        read_answers([tmp_path / "c.csv"], plan)
    with pytest.raises(ValidationError, match="cannot be read"):
        read_answers([tmp_path / "none.csv"], plan)


def test_only_careless_people_leave_nothing(plan: StudyPlan) -> None:
    with pytest.raises(ValidationError, match="all of them careless"):
        analyse(answers_of(plan, 2, 0.5, careless=2), plan)
    with pytest.raises(ValidationError, match="no answers"):
        analyse([], plan)


def test_a_trial_is_known_by_its_kind() -> None:
    body = StudyPlan((Trial("t", "pair", ("a", "b")),), {}).to_json()
    body["trials"][0]["kind"] = "taste"
    with pytest.raises(ValidationError, match="kind"):
        StudyPlan.from_json(body, "key")
