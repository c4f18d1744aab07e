"""The trials of a study: pairs by preference, ratings, and catch trials; and the key that says what they show.

The paper's studies (its section "Human Evaluation Details"): pairs of overview images, one of a generated and one of a
procedural scene, judged by three criteria as A, B or equal; and walkthrough videos, rated from 1 to 5 by four criteria.
A third kind, fidelity, shows the plan of a source's layout beside a cousin from above, rated from 1 to 5.
"""

import dataclasses
import hashlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..datatypes import validation as v

SCHEMA = "urbanverse.study/1"
#: Criterion -> what participants read.
PAIR_CRITERIA = {
    "object_diversity": "Object diversity: how rich and representative are the objects of the street?",
    "layout_coherence": "Layout coherence: are objects arranged as in a real street?",
    "overall_realism": "Overall realism: how much does the scene look like a plausible real street?",
}
RATING_CRITERIA = {
    "overall_realism": "Overall realism",
    "asset_appropriateness": "The objects fit the place",
    "layout_realism": "The layout is that of a real street",
    "object_diversity": "Object diversity",
}
FIDELITY_CRITERIA = {"layout_fidelity": "How faithfully does the street on the right follow the plan on the left?"}
CRITERIA = {"pair": PAIR_CRITERIA, "rating": RATING_CRITERIA, "fidelity": FIDELITY_CRITERIA}
CHOICES = {"pair": ("A", "equal", "B"), "rating": tuple("12345"), "fidelity": tuple("12345")}
#: Kinds of catch trials and their only right answer: the same image twice, and a rating that the page names.
CATCHES = {"pair": "equal", "rating": "2"}


@dataclasses.dataclass(frozen=True)
class Material:
    """An image or video of a scene.

    Attributes:
      scene: id of the scene; group: what made it, such as "urbanverse".
      file: name in the page's folder `media`, which tells neither.
    """

    scene: str
    group: str
    file: str


def blind_name(scene: str, kind: str, seed: int, suffix: str) -> str:
    """A file name that tells neither scene nor group, the same for the same arguments."""
    return hashlib.sha256(f"{seed}/{kind}/{scene}".encode()).hexdigest()[:16] + suffix


@dataclasses.dataclass(frozen=True)
class Trial:
    """What is shown at once.

    Attributes:
      id: unique; kind: "pair", "rating" or "fidelity".
      files: one for ratings, two for the others. The page draws which one of a pair is on the left.
      catch: the right answer of a catch trial, else "".
    """

    id: str
    kind: str
    files: tuple[str, ...]
    catch: str = ""


@dataclasses.dataclass(frozen=True)
class StudyPlan:
    """A study.

    Attributes:
      trials: in no meaningful order: the page draws one for each participant.
      key: file -> {"scene", "group"}, which participants must not see.
    """

    trials: tuple[Trial, ...]
    key: dict[str, dict[str, str]]

    def to_json(self) -> dict[str, Any]:
        """The key's file: trials, and what their files show."""
        return {"schema": SCHEMA, "trials": [dataclasses.asdict(t) for t in self.trials], "key": self.key}

    @staticmethod
    def from_json(body: Any, where: str) -> "StudyPlan":
        """Reads what `to_json` gives.

        Raises:
          ValidationError: it is something else.
        """
        m = v.mapping(body, where, ("schema", "trials", "key"))
        v.choice(m["schema"], f"{where}: schema", (SCHEMA,))
        trials = []
        for row in v.items(m["trials"], f"{where}: trials"):
            t = v.mapping(row, f"{where}: trial", ("id", "kind", "files", "catch"))
            v.choice(t["kind"], f"{where}: kind", tuple(CRITERIA))
            trials.append(Trial(t["id"], t["kind"], tuple(t["files"]), t["catch"]))
        return StudyPlan(tuple(trials), dict(m["key"]))


def plan_study(
    overviews: Mapping[str, Sequence[Material]],
    videos: Sequence[Material],
    plans: Sequence[tuple[Material, Material]] = (),
    pairs: int = 100,
    catches: int = 3,
    seed: int = 0,
) -> StudyPlan:
    """Draws the trials of a study.

    Args:
      overviews: two groups -> images from above; each image is in as few pairs as possible.
      videos: to be rated, of any groups.
      plans: (plan of a source, its cousin from above).
      pairs: number of pairs of one image of each group; 0 for none.
      catches: number of catch trials of pairs, and of ratings, where there are any.
      seed: of the pairs.

    Raises:
      ValidationError: pairs are wanted, but there are not two groups with images; or nothing is shown at all.
    """
    if pairs and (len(overviews) != 2 or not all(overviews.values())):
        counts = {name: len(rows) for name, rows in overviews.items()}
        raise v.fail("study", f"groups of overview images {counts}", "two, each with an image", "name folders of both")
    rng = np.random.default_rng(seed)
    trials: list[Trial] = []
    if pairs:
        columns = [_repeated(rows, pairs, rng) for rows in overviews.values()]
        for number, (a, b) in enumerate(zip(*columns, strict=True)):
            trials.append(Trial(f"pair_{number:03d}", "pair", (a.file, b.file)))
        for number, shown in enumerate(_repeated(next(iter(overviews.values())), catches, rng)):
            trials.append(Trial(f"pair_catch_{number}", "pair", (shown.file, shown.file), CATCHES["pair"]))
    for number, video in enumerate(videos):
        trials.append(Trial(f"rating_{number:03d}", "rating", (video.file,)))
    for number, video in enumerate(_repeated(videos, catches if videos else 0, rng)):
        trials.append(Trial(f"rating_catch_{number}", "rating", (video.file,), CATCHES["rating"]))
    for number, (source, cousin) in enumerate(plans):
        trials.append(Trial(f"fidelity_{number:03d}", "fidelity", (source.file, cousin.file)))
    if not trials:
        raise v.fail("study", "nothing to show", "at least one pair, video or plan", "name folders of compiled scenes")
    shown = [*(m for rows in overviews.values() for m in rows), *videos, *(m for both in plans for m in both)]
    return StudyPlan(tuple(trials), {m.file: {"scene": m.scene, "group": m.group} for m in shown})


def _repeated(rows: Sequence[Material], count: int, rng: np.random.Generator) -> list[Material]:
    """`count` of the rows in random order, each as often as another but for one."""
    drawn: list[Material] = []
    while len(drawn) < count:
        drawn += [rows[k] for k in rng.permutation(len(rows))]
    return drawn[:count]
