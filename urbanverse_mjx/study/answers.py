"""Reads the CSV files that participants send."""

import csv
import dataclasses
import os
import pathlib
from collections.abc import Iterable

from ..datatypes import validation as v
from .plan import CHOICES, CRITERIA, StudyPlan

#: Columns of a file, as the page writes them.
COLUMNS = ("study", "participant", "trial", "kind", "first", "second", "criterion", "answer", "seconds", "position")


@dataclasses.dataclass(frozen=True)
class Answer:
    """One answer to one criterion of a trial.

    Attributes:
      participant, trial, kind, criterion: ids.
      first, second: files as shown from left to right; second is "" for ratings.
      answer: "A" (the left one), "equal", "B", or a number from 1 to 5.
      seconds: that the trial was shown.
    """

    participant: str
    trial: str
    kind: str
    first: str
    second: str
    criterion: str
    answer: str
    seconds: float


def read_answers(paths: Iterable[str | os.PathLike[str]], plan: StudyPlan) -> list[Answer]:
    """Answers of all files; a participant's second answer to the same question is refused.

    Raises:
      ValidationError: a file cannot be read, has other columns, or an answer that the study does not know.
    """
    trials = {trial.id: trial for trial in plan.trials}
    found: list[Answer] = []
    known: set[tuple[str, str, str]] = set()
    for path in map(pathlib.Path, paths):
        try:
            with path.open(newline="", encoding="utf-8-sig") as file:
                reader = csv.DictReader(file)
                rows, names = list(reader), tuple(reader.fieldnames or ())
        except (OSError, UnicodeDecodeError, csv.Error) as error:
            raise v.fail(
                str(path), "a file that cannot be read", "a CSV file of the page", "ask for it again"
            ) from error
        if names != COLUMNS:
            raise v.fail(str(path), f"columns {', '.join(names) or 'none'}", ", ".join(COLUMNS), "ask for it again")
        for number, row in enumerate(rows, 2):
            where = f"{path}: line {number}"
            if row["trial"] not in trials:
                raise v.fail(where, f"trial {row['trial']!r}", "one of this study", "take the key of the same study")
            trial = trials[row["trial"]]
            v.choice(row["criterion"], f"{where}: criterion", tuple(CRITERIA[trial.kind]))
            v.choice(row["answer"], f"{where}: answer", CHOICES[trial.kind])
            if sorted(x for x in (row["first"], row["second"]) if x) != sorted(trial.files):
                raise v.fail(where, f"files {row['first']!r} and {row['second']!r}", f"those of {trial.id}")
            key = row["participant"], trial.id, row["criterion"]
            if not row["participant"] or key in known:
                raise v.fail(where, f"a second answer of {key[0]!r} to {trial.id}", "one of each", "remove one file")
            known.add(key)
            try:
                seconds = float(row["seconds"])
            except ValueError as error:
                raise v.fail(f"{where}: seconds", repr(row["seconds"]), "a number") from error
            shown = row["first"], row["second"]
            found.append(Answer(key[0], trial.id, trial.kind, *shown, row["criterion"], row["answer"], seconds))
    return found
