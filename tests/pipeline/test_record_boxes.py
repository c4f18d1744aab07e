"""Boxes and captions of recorded frames against the instance image and a pinhole camera."""

import itertools
import pathlib
import types
from typing import Any

import cv2
import mujoco
import numpy as np
import pyarrow.parquet as pq
import pytest

from tests.pipeline.test_recording import OPTIONS, SIZE, drawn_env, table_of, use
from tests.support.agent_appearances import BOXES, with_box_agents
from urbanverse_mjx import pipeline
from urbanverse_mjx.datasets.annotations import annotations_table, check_annotations, runs_of
from urbanverse_mjx.datatypes import AgentMotion, SceneBank
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.pipeline.recording.boxes import Boxes, spoken
from urbanverse_mjx.pipeline.recording.driving import Driven, Steps
from urbanverse_mjx.pipeline.recording.readings import CAMERA_POSE, intrinsics
from urbanverse_mjx.robots import make_coco

CORNERS = np.array([*itertools.product((-0.5, 0.5), repeat=3)])


@pytest.fixture(scope="module")
def recorded(small_bank: SceneBank, tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    env = drawn_env(small_bank, {"episode_length": 8})
    with pytest.MonkeyPatch.context() as patch:
        use(env, patch)
        folder = tmp_path_factory.mktemp("boxes") / "new"
        sensors = ("instance", "camera_pose", "boxes")
        pipeline.record(folder, pipeline.RecordOptions(**{**vars(OPTIONS), "sensors": sensors}))
    return folder


def seen_in(folder: pathlib.Path) -> list[dict[str, Any]]:
    return pq.read_table(folder / "annotations/chunk-000/file-000.parquet").to_pylist()


@pytest.mark.extended
def test_boxes_enclose_the_pixels_of_the_instance_image(recorded: pathlib.Path, small_bank: SceneBank) -> None:
    assert pipeline.check_dataset(recorded).problems == ()
    rows, seen, objects, hidden = table_of(recorded), seen_in(recorded), 0, 0
    assert len(seen) == len(rows["index"])
    ground = {i for i, name in enumerate(small_bank.meta["categories"]) if name.startswith("ground:")}
    for k, frame in enumerate(seen):
        stored = rows["observation.images.instance"][k]["bytes"]
        image = cv2.imdecode(np.frombuffer(stored, np.uint8), cv2.IMREAD_UNCHANGED)
        assert image is not None
        category = small_bank.slot_category[rows["scene_index"][k]]
        expected = {int(n) for n in np.unique(image) if n >= 3 and int(category[n - 3]) not in ground}
        assert {item["label"] for item in frame["objects"]} == expected
        for item in frame["objects"]:
            y, x = np.nonzero(image == item["label"])
            assert item["box"] == [x.min(), y.min(), x.max() + 1, y.max() + 1]
            assert item["pixels"] == len(x)
            hidden += item["visible"] < 0.8
            assert 0.0 < item["visible"] <= 1.0
        objects += len(expected)
    assert objects > 40
    assert 5 < hidden < objects - 5


def test_boxes_in_space_project_around_those_in_the_image(recorded: pathlib.Path) -> None:
    """Corners through the camera, by its pose and by the stored place in its frame."""
    rows, robot = table_of(recorded), make_coco()
    env_model = drawn_model(robot.mjcf)
    k = intrinsics(env_model, robot.camera, *SIZE)
    tight = []
    for pose, frame in zip(np.array(rows[CAMERA_POSE]), seen_in(recorded), strict=True):
        turn = rotations.matrix_f64(pose[3:])
        for item in frame["objects"]:
            own = CORNERS * item["size"]
            world = own @ rotations.matrix_f64(np.array(item["quaternion_world"])).T + item["position_world"]
            camera = own @ rotations.matrix_f64(np.array(item["quaternion_camera"])).T + item["position_camera"]
            np.testing.assert_allclose((world - pose[:3]) @ turn, camera, atol=1e-4)
            if camera[:, 2].min() < 0.05:
                continue
            pixel = camera[:, :2] / camera[:, 2:] * [k["fx"], k["fy"]] + [k["cx"], k["cy"]]
            left, top, right, bottom = item["box"]
            assert pixel[:, 0].min() - 1 <= left < right <= pixel[:, 0].max() + 1
            assert pixel[:, 1].min() - 1 <= top < bottom <= pixel[:, 1].max() + 1
            low, high = np.clip(pixel.min(0), 0, SIZE[::-1]), np.clip(pixel.max(0), 0, SIZE[::-1])
            tight.append((right - left) * (bottom - top) / max(np.prod(high - low), 1.0))
    assert len(tight) > 40
    # Boxes of whole objects are as large as those of their pixels, but for solids that fill theirs badly.
    assert np.quantile(tight, 0.8) > 0.6


def drawn_model(mjcf: str) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(mjcf)


def test_captions_name_what_is_in_view(recorded: pathlib.Path) -> None:
    for frame in seen_in(recorded):
        names = {spoken(item["category"]) for item in frame["objects"]}
        said = frame["caption"]
        assert said.startswith(("The robot is on the ", "In view", "No object"))
        for name in ("box", "wedge", "cylinder"):
            assert name not in said or name in names
        assert ("No object is in view." in said) == (not frame["objects"])
    assert any("° to the left" in frame["caption"] for frame in seen_in(recorded))


def test_agents_are_told_apart(small_bank: SceneBank) -> None:
    """Two people beside one another: boxes of their own size at their own place; the robot looks along +x."""
    bank, robot = with_box_agents(small_bank), make_coco()
    model = drawn_model(robot.mjcf)
    kinds = bank.agents["kind"]
    rows = [kinds.index("pedestrian"), kinds.index("car")]
    env: Any = types.SimpleNamespace(bank=bank, mj_model=model, robot=robot, agent_appearances=rows)
    place = np.array([[[5.0, 1.0, 0.0], [9.0, -2.0, 0.0]]])
    numbers: Any = (place, np.array([[0.0, 1.0]]), 0 * place, np.zeros((1, 2)), np.ones((1, 2), bool))
    agents = AgentMotion(*numbers)
    identity = np.tile([1.0, 0.0, 0.0, 0.0], (1, model.nbody, 1))
    steps = Steps(*[None] * len(Steps._fields))._replace(
        xpos=np.zeros((1, model.nbody, 3)), xquat=identity, agents=agents
    )
    driven = Driven(0, 0, 0, steps, "goal", 1.0)
    labels = np.full((6, 8), -1)
    labels[2:4, 1:3], labels[3:6, 4:8] = -3, -4
    coverage = np.zeros(bank.slot_mesh.shape[1] + 2, int)
    coverage[-2:] = 8, 12
    seen = Boxes(env, masks=True).annotate(driven, 0, labels, coverage)
    first, second = sorted(seen.objects, key=lambda item: item.name)
    assert (first.name, first.label, first.category, first.box) == ("agent_0", 2, "agent:pedestrian", (1, 2, 3, 4))
    assert (second.name, second.category, second.pixels) == ("agent_1", "agent:car", 12)
    assert (first.pixels, first.visible, second.visible) == (4, 0.5, 1.0)
    np.testing.assert_allclose(second.size, BOXES["car"], atol=1e-5)
    np.testing.assert_allclose(first.position_world, [5.0, 1.0, BOXES["pedestrian"][2] / 2], atol=1e-5)
    assert "pedestrian 5.1 m 11° to the left, car 9.2 m 13° to the right" in seen.caption
    assert all(sum(runs) == labels.size for runs in seen.runs)


def test_runs_are_lengths_down_the_columns() -> None:
    assert runs_of(np.array([[False, True], [True, True]])) == [1, 3]
    assert runs_of(np.array([[True, False], [True, False]])) == [0, 2, 2]


def test_the_check_finds_a_box_outside_the_image(recorded: pathlib.Path) -> None:
    table = pq.read_table(recorded / "annotations/chunk-000/file-000.parquet")
    assert not [*check_annotations(table, 0, table.num_rows, SIZE, "f")]
    assert "index" in next(check_annotations(table, 5, table.num_rows, SIZE, "f"))
    assert "needed one in the image" in next(check_annotations(table, 0, table.num_rows, (3, 3), "f"))
    assert "rows" in next(check_annotations(annotations_table([], 0), 0, 1, SIZE, "f"))
