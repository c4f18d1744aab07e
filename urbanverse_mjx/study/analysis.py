"""Shares, means, intervals and agreement of a study's answers."""

import collections
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from scipy import stats

from ..datatypes import validation as v
from ..evaluation.metrics import wilson_interval
from .agreement import fleiss_kappa, kappa_interval
from .answers import Answer
from .plan import CHOICES, CRITERIA, StudyPlan

#: Participants with a larger share of wrong catch answers are left out.
MOST_WRONG = 0.34
_DRAWS, _SEED = 4000, 0


def analyse(answers: Sequence[Answer], plan: StudyPlan) -> dict[str, Any]:
    """Results of a study, catch trials and careless participants left out.

    Intervals (95 %) are of a bootstrap that samples participants and, independently, scenes, since answers of one
    participant, and answers on one scene, are alike. "p" of preferences is of Wilcoxon's signed-rank test over
    participants (Bonferroni-Holm over the criteria is left to the reader). Kappa is Fleiss', with an interval over
    trials.

    Returns:
      "participants", "excluded" (id -> wrong and all catch answers), "pairs" (criterion -> group -> share in percent,
      and "equal", "p", "kappa"), "ratings" and "fidelity" (criterion -> "groups" with mean, low, high, n, and "kappa").

    Raises:
      ValidationError: no answers, or none left.
    """
    if not answers:
        raise v.fail("study", "no answers", "at least one participant's file", "name the CSV files")
    catch = {trial.id: trial.catch for trial in plan.trials if trial.catch}
    wrong = _wrong(answers, catch)
    excluded = {name: [w, n] for name, (w, n) in sorted(wrong.items()) if n and w / n > MOST_WRONG}
    kept = [a for a in answers if a.trial not in catch and a.participant not in excluded]
    if not kept:
        raise v.fail("study", f"{len(excluded)} participants, all of them careless", "some answers", "ask more people")
    everyone = {a.participant for a in answers}
    return {
        "participants": len(everyone) - len(excluded),
        "excluded": excluded,
        "pairs": _by_criterion(kept, "pair", lambda rows: _preference(rows, plan)),
        "ratings": _by_criterion(kept, "rating", lambda rows: _rating(rows, plan)),
        "fidelity": _by_criterion(kept, "fidelity", lambda rows: _rating(rows, plan)),
    }


def _wrong(answers: Sequence[Answer], catch: dict[str, str]) -> dict[str, tuple[int, int]]:
    """Participant -> wrong and all answers to catch trials."""
    found = {a.participant: (0, 0) for a in answers}
    for a in answers:
        if a.trial in catch:
            bad, all_ = found[a.participant]
            found[a.participant] = bad + (a.answer != catch[a.trial]), all_ + 1
    return found


def _by_criterion(answers: Sequence[Answer], kind: str, of: Callable[[list[Answer]], Any]) -> dict[str, Any]:
    found = {}
    for criterion in CRITERIA[kind]:
        rows = [a for a in answers if a.kind == kind and a.criterion == criterion]
        if rows:
            found[criterion] = of(rows)
    return found


def _preference(rows: list[Answer], plan: StudyPlan) -> dict[str, Any]:
    groups = sorted({plan.key[f]["group"] for a in rows for f in (a.first, a.second)})
    preferred = []
    for a in rows:
        file = {"A": a.first, "B": a.second}.get(a.answer)
        preferred.append("equal" if file is None else plan.key[file]["group"])
    people, trials = [a.participant for a in rows], [a.trial for a in rows]
    weights = crossed_weights(people, trials)
    shares = {}
    for name in (*groups, "equal"):
        flags = np.array([100.0 * (p == name) for p in preferred])
        # Where nobody or everybody says so, a bootstrap has no spread: the interval is at least that of people who
        # answer once each.
        low, high = wilson_interval(round(flags.mean() / 100 * len(set(people))), len(set(people)))
        shares[name] = _mean(flags, weights, (100 * low, 100 * high) if flags.std() == 0 else None)
    sides = np.array([0.0 if p == "equal" else 1.0 if p == groups[0] else -1.0 for p in preferred])
    by_person = np.array([sides[np.array(people) == name].mean() for name in sorted(set(people))])
    p = float(stats.wilcoxon(by_person).pvalue) if np.any(by_person != 0) else 1.0
    # Kappa over groups rather than sides, since sides are drawn anew for each participant.
    return {"shares": shares, "n": len(rows), "p": p, **_kappa(trials, preferred, (*groups, "equal"))}


def _rating(rows: list[Answer], plan: StudyPlan) -> dict[str, Any]:
    group_of = [plan.key[a.second or a.first]["group"] for a in rows]
    values = np.array([float(a.answer) for a in rows])
    found = {}
    for name in sorted(set(group_of)):
        own = np.array([g == name for g in group_of])
        part = [a for a, mine in zip(rows, own, strict=True) if mine]
        weights = crossed_weights([a.participant for a in part], [a.trial for a in part])
        found[name] = {**_mean(values[own], weights), "n": int(own.sum())}
    return {"groups": found, **_kappa([a.trial for a in rows], [a.answer for a in rows], CHOICES["rating"])}


def crossed_weights(people: Sequence[str], items: Sequence[str]) -> np.ndarray:
    """(draws, n) how often each answer counts if participants and items are both sampled with replacement (Owen 2007,
    "The pigeonhole bootstrap", Annals of Applied Statistics 1(2))."""
    rng = np.random.default_rng(_SEED)
    weight = np.ones((_DRAWS, len(people)))
    for names in (people, items):
        ids, which = np.unique(np.asarray(names), return_inverse=True)
        weight *= rng.multinomial(len(ids), np.full(len(ids), 1.0 / len(ids)), _DRAWS)[:, which.ravel()]
    return weight


def _mean(values: np.ndarray, weights: np.ndarray, least: tuple[float, float] | None = None) -> dict[str, float]:
    total = weights.sum(1)
    means = (weights @ values)[total > 0] / total[total > 0]
    low, high = np.percentile(means, [2.5, 97.5])
    if least is not None:
        low, high = min(low, least[0]), max(high, least[1])
    return {"mean": round(float(values.mean()), 2), "low": round(float(low), 2), "high": round(float(high), 2)}


def _kappa(trials: Sequence[str], answers: Sequence[str], choices: Sequence[str]) -> dict[str, Any]:
    """Fleiss' kappa and its interval, None where it is not defined."""
    rows: dict[str, collections.Counter[str]] = collections.defaultdict(collections.Counter)
    for trial, answer in zip(trials, answers, strict=True):
        rows[trial][answer] += 1
    counts = np.array([[row[c] for c in choices] for row in rows.values()])
    if (counts.sum(1) < 2).all():
        return {"kappa": None, "kappa_interval": None}
    kappa, interval = fleiss_kappa(counts), kappa_interval(counts)
    return {
        "kappa": round(kappa, 3) if np.isfinite(kappa) else None,
        "kappa_interval": None if interval is None else [round(x, 3) for x in interval],
    }
