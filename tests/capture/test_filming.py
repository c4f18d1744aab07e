"""Captures contain the scene's ground truth: geometry, labels, poses and the graph agree with each other."""

import pathlib

import numpy as np
import pytest
import shapely

from urbanverse_mjx.capture import FilmOptions, PathOptions, film_scene, ground_truth, true_graph, true_objects, walk
from urbanverse_mjx.capture.path import camera_poses
from urbanverse_mjx.capture.street import street_grid
from urbanverse_mjx.datatypes import GROUND_KINDS, Recording, SceneBank, SceneGraph, ValidationError
from urbanverse_mjx.datatypes.ground import polygon_area

SMALL = FilmOptions(width=160, height=90, samples=1, shadows=False)


@pytest.fixture(scope="module")
def filmed(small_bank: SceneBank, tmp_path_factory: pytest.TempPathFactory) -> Recording:
    return film_scene(small_bank, 1, tmp_path_factory.mktemp("walk"), PathOptions(frames=6), SMALL)


def world_points(recording: Recording, frame: int) -> np.ndarray:
    depth, pose = recording.depth(frame), recording.frames[frame].pose
    assert depth is not None
    assert pose is not None
    return (recording.camera.rays() * depth[..., None]) @ pose[:3, :3].T + pose[:3, 3]


@pytest.mark.extended
def test_masked_depth_lies_in_the_true_box(filmed: Recording, small_bank: SceneBank) -> None:
    ground_truth = {t.id: t for t in true_objects(small_bank, 1)}
    checked = 0
    for i, frame in enumerate(filmed.frames):
        masks, points = filmed.masks(i), world_points(filmed, i)
        assert masks is not None
        for k, detection in enumerate(frame.detections):
            assert detection.track is not None
            true = ground_truth[detection.track]
            assert detection.label == true.label
            c, s = np.cos(true.yaw), np.sin(true.yaw)
            local = (points[masks == k] - true.center) @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
            # Depth is written in steps of 5 mm; a grazed face is off by a few of them.
            assert (np.abs(local) <= np.array(true.size) / 2 + 0.03).all(), true.id
            checked += 1
    assert checked > 10


def test_ground_depth_lies_on_the_ground(filmed: Recording, small_bank: SceneBank) -> None:
    street = street_grid(small_bank, 1)
    for i in range(len(filmed)):
        surfaces, points = filmed.surfaces(i), world_points(filmed, i)
        assert surfaces is not None
        ground = (surfaces > 0) & (surfaces < 255) & (np.linalg.norm(points - points.mean((0, 1)), axis=-1) < 30)
        cells = street.cell(points[ground][:, :2])
        off = np.abs(street.height[tuple(cells.T)] - points[ground][:, 2])
        # Cells on a kerb hold one of its two heights.
        assert np.nanquantile(off, 0.9) < 0.03
        depth = filmed.depth(i)
        assert depth is not None
        assert (depth[surfaces == 255] == 0).all()


def test_the_camera_walks_where_one_can_walk(small_bank: SceneBank) -> None:
    path = walk(small_bank, 0)
    street = street_grid(small_bank, 0)
    place = path.T_world_camera[:, :3, 3]
    cells = tuple(street.cell(place[:, :2]).T)
    assert (street.clearance[cells] > 0.2).all()
    np.testing.assert_allclose(place[:, 2] - street.height[cells], 1.5, atol=0.2)
    steps = np.linalg.norm(np.diff(place[:, :2], axis=0), axis=1)
    assert steps.max() < 1.5
    # Both sides of the street, from end to end.
    assert np.ptp(place[:, 0]) > 45.0
    assert place[:, 1].min() < -4.0 < 4.0 < place[:, 1].max()
    assert len(walk(small_bank, 0, PathOptions(frames=500)).time_s) == 500


def test_camera_axes() -> None:
    (pose,) = camera_poses(np.array([[1.0, 2.0, 3.0]]), np.array([np.pi / 2]), np.radians(10.0))
    np.testing.assert_allclose(pose[:3, 0], [1, 0, 0], atol=1e-12)  # its view is along +y, so its right is +x
    assert pose[2, 2] == pytest.approx(np.sin(np.radians(10.0)))
    assert pose[2, 1] < -0.9  # its down is down


def test_the_true_graph_is_written_beside(filmed: Recording, small_bank: SceneBank) -> None:
    graph = SceneGraph.load(filmed.folder / "truth.json")
    assert {o.id for o in graph.objects} == {o.id for o in true_objects(small_bank, 1)}
    kinds = {r.kind for r in graph.ground}
    assert {"road", "sidewalk", "crosswalk"} <= kinds
    assert len(graph.camera_path) == len(filmed)
    assert Recording.load(filmed.folder) == filmed


def test_bad_wishes_are_one_sentence(small_bank: SceneBank, tmp_path: pathlib.Path) -> None:
    with pytest.raises(ValidationError, match="scene: found 9"):
        film_scene(small_bank, 9, tmp_path)
    with pytest.raises(ValidationError, match="camera path"):
        PathOptions(speed=0.0)
    with pytest.raises(ValidationError, match="fovy"):
        FilmOptions(fovy=4.0)


def test_a_walker_turns_about_in_seconds_not_between_two_frames(small_bank: SceneBank) -> None:
    def fastest(turn_time: float) -> float:
        path = walk(small_bank, 0, PathOptions(rate=4.0, sway=0.0, turn_time=turn_time))
        return float(np.abs(np.diff(np.unwrap(path.plan()[:, 3]))).max()) * 4.0

    # The path comes back along itself: half a turn, in a quarter of a second or spread over three.
    assert fastest(0.0) > np.radians(300.0)
    assert fastest(3.0) < np.radians(90.0)


#: Triangles of a pavement, in single precision, whose union has a spike at (66.36, 6.48).
SPIKED = (
    (
        (66.35505104064941, 6.4792962074279785),
        (84.95557045936584, 8.270322561264038),
        (66.19799995422363, 9.478000044822693),
    ),
    (
        (66.35499954223633, 6.479000091552734),
        (66.35506629943848, 6.479006290435791),
        (66.35505104064941, 6.4792962074279785),
    ),
    (
        (110.7859992980957, 15.34600019454956),
        (106.70800018310547, 14.953999996185303),
        (110.93600082397461, 13.78600001335144),
    ),
    (
        (111.2229995727539, 10.799999997019768),
        (110.93600082397461, 13.78600001335144),
        (106.85799980163574, 13.39299988746643),
    ),
    (
        (66.19799995422363, 9.478000044822693),
        (66.35499954223633, 6.479000091552734),
        (66.35505104064941, 6.4792962074279785),
    ),
    (
        (106.85799980163574, 13.39299988746643),
        (110.93600082397461, 13.78600001335144),
        (106.70800018310547, 14.953999996185303),
    ),
    (
        (66.19799995422363, 9.478000044822693),
        (84.95557045936584, 8.270322561264038),
        (106.85799980163574, 13.39299988746643),
    ),
    (
        (111.2229995727539, 10.799999997019768),
        (106.85799980163574, 13.39299988746643),
        (84.95557045936584, 8.270322561264038),
    ),
)


def test_true_ground_of_single_precision_has_no_spikes(small_bank: SceneBank, monkeypatch: pytest.MonkeyPatch) -> None:
    tops = np.array(SPIKED)
    tops = np.concatenate([tops, np.full((*tops.shape[:2], 1), 0.18)], -1)
    kind = GROUND_KINDS.index("sidewalk")
    monkeypatch.setattr(ground_truth, "ground_tops", lambda bank, scene: [(7, kind, tops)])
    (region,) = true_graph(small_bank, 0).ground
    assert region.id == "sidewalk_7_0"
    assert polygon_area(region.polygon) == pytest.approx(shapely.area(shapely.polygons(tops[..., :2])).sum(), rel=1e-3)
