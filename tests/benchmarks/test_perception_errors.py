"""Why objects are missed: each reason is told from the others."""

import numpy as np
import pytest

from benchmarks import perception_errors
from benchmarks.perception_errors import Frame, by_group, objects_of, with_reference
from urbanverse_mjx.distillation.perception_model import classes
from urbanverse_mjx.distillation.perception_model.decode import decode
from urbanverse_mjx.distillation.perception_model.network import LEAF_STRIDE, Seen

NAMES = classes.names()
ROAD, CAR, POLE, PERSON = (NAMES.index(n) for n in ("road", "car", "street light", "pedestrian adult"))


def _logits(kinds: np.ndarray) -> np.ndarray:
    return 8.0 * np.identity(len(NAMES), np.float32)[kinds]


@pytest.fixture
def frame() -> Frame:
    """A car that is right, a pole taken for a person, and a person whose pixels point nowhere."""
    kinds, owner = np.full((60, 100), ROAD), np.full((60, 100), -1)
    for number, (rows, columns, kind) in enumerate(
        ((np.s_[10:30], np.s_[10:40], CAR), (np.s_[5:55], np.s_[60:62], POLE), (np.s_[20:50], np.s_[80:88], PERSON))
    ):
        kinds[rows, columns], owner[rows, columns] = kind, number
    offset, centre, _ = perception_errors._centres(owner)
    offset[owner == 2] = 3.0
    said = np.where(owner == 1, PERSON, kinds)
    leaves = np.zeros((60 // LEAF_STRIDE, 100 // LEAF_STRIDE, len(classes.leaves())), np.float32)
    return Frame(
        Seen(_logits(said), centre, offset, np.zeros((60, 100)), leaves), kinds, owner, np.full((60, 100), 6.0)
    )


def test_each_object_is_missed_for_its_own_reason(frame: Frame):
    car, pole, person = objects_of(frame, decode(frame.seen, 300.0))
    assert (car.kind, car.found_kind, car.iou) == (CAR, CAR, 1.0)
    assert (pole.kind, pole.found_kind, pole.iou, pole.thickness) == (POLE, PERSON, 1.0, 2.0)
    assert person.iou < 0.5
    assert person.as_object == 1.0
    rows = {row["objects"]: row for row in by_group([car, pole, person])}
    assert rows["thickness 0 to 2.5 px"]["whatever the class"] == "1.00"
    assert rows["thickness 0 to 2.5 px"]["whatever the score"] == "0.00"
    assert rows["others"]["number"] == 3
    assert rows["others"]["whatever the class"] == "0.67"
    assert rows["distance 5 to 10 m"]["number"] == 3


def test_the_reference_of_one_output_corrects_its_errors_alone(frame: Frame):
    found = {
        name: {x.kind: x for x in objects_of(frame, decode(seen, 300.0))}
        for name, seen in with_reference(frame).items()
    }

    def right(name: str) -> set[int]:
        return {kind for kind, x in found[name].items() if x.iou > 0.5 and x.found_kind == kind}

    assert right("none") == right("centres") == {CAR}
    assert right("offsets") == right("centres and offsets") == {CAR, PERSON}
    assert right("centres, offsets, object or not") == {CAR, PERSON}
    assert right("classes") == {CAR, POLE}
