"""From frames to a recording, over a corridor whose every pixel is known: poses, metric scale, depth, records."""

import dataclasses
import importlib
import json
import pathlib

import numpy as np
import pytest
from PIL import Image
from scipy import ndimage

from urbanverse_mjx.datatypes import GROUND_KINDS, Camera, Detection, Recording, Source, ValidationError
from urbanverse_mjx.datatypes.recording import SKY
from urbanverse_mjx.distillation.perception import (
    FrameObservation,
    Frames,
    Perception,
    StructureOptions,
    links,
    mapping,
    perceive,
    reconstruct,
    sample,
    trajectory_error,
)
from urbanverse_mjx.distillation.perception.bridges import Rebuild
from urbanverse_mjx.distillation.perception.densify import dense_depth, levels
from urbanverse_mjx.distillation.perception.metric import to_metric
from urbanverse_mjx.distillation.perception.parallax import check_parallax, parallax_shares
from urbanverse_mjx.distillation.perception.structure import Structure

CAMERA = Camera(320, 180, 210.0, 210.0, 160.0, 90.0)
HEIGHT, HALF, TOP = 1.2, 3.0, 4.0  # m: of the camera, of half the corridor's width, of its walls
SIDEWALK = GROUND_KINDS.index("sidewalk")
SOURCE = Source("corridor", "Apache-2.0", "none", "none")


def _texture(seed: int) -> np.ndarray:
    """(600, 600) f32 in [0, 1], 5 cm a texel; repeats."""
    rng = np.random.default_rng(seed)
    layers = [ndimage.zoom(rng.random((600 // s, 600 // s)), s, order=1) for s in (3, 8, 20)]
    return np.sum(layers, axis=0).astype(np.float32) / 3


TEXTURES = [_texture(k) for k in range(3)]


def _pose(along: float, yaw: float, pitch: float = -0.1) -> np.ndarray:
    """(4, 4) T_world_camera at x = along, y = 0.3 and `HEIGHT`; view along x rotated by yaw, up by pitch."""
    c, s = np.cos(yaw), np.sin(yaw)
    forward = np.array([c * np.cos(pitch), s * np.cos(pitch), np.sin(pitch)])
    right = np.array([s, -c, 0.0])
    pose = np.eye(4)
    pose[:3, :3] = np.stack([right, np.cross(forward, right), forward], -1)
    pose[:3, 3] = along, 0.3, HEIGHT
    return pose


def _frame(pose: np.ndarray, textures: list[np.ndarray] = TEXTURES) -> tuple[np.ndarray, FrameObservation, np.ndarray]:
    """Image (H, W, 3) u8, its observation, and true depth (H, W) m (0 = sky)."""
    rays = CAMERA.rays() @ pose[:3, :3].T
    _, y0, z0 = pose[:3, 3]
    with np.errstate(divide="ignore"):
        reach = np.stack([-z0 / rays[..., 2], (HALF - y0) / rays[..., 1], (-HALF - y0) / rays[..., 1]], -1)
    reach = np.where(reach > 0, reach, np.inf)
    which, depth = reach.argmin(-1), reach.min(-1)
    x, y, z = (pose[:3, 3] + depth[..., None] * rays).transpose(2, 0, 1)
    sky = (which > 0) & (z > TOP) | (depth > 60.0)
    image = np.zeros(which.shape, np.float32)
    for k, second in enumerate((y, z, z)):
        texel = [np.nan_to_num(v[which == k], posinf=0.0, neginf=0.0) / 0.05 for v in (x, second)]
        image[which == k] = ndimage.map_coordinates(textures[k], texel, order=1, mode="grid-wrap")
    rgb = np.repeat((255 * np.where(sky, 0.9, image)).astype(np.uint8)[..., None], 3, -1)
    surfaces = np.where(sky, SKY, np.where(which == 0, SIDEWALK, 0)).astype(np.uint8)
    masks = np.where(sky | (which == 0), -1, which - 1).astype(np.int32)
    walls = (Detection("house", 0.9), Detection("house", 0.8))
    return rgb, FrameObservation(surfaces, masks, walls), np.where(sky, 0.0, depth)


POSES = np.array([_pose(0.4 * k, 0.7 + 0.15 * np.sin(k / 1.5)) for k in range(9)])


@pytest.fixture(scope="module")
def frames(tmp_path_factory: pytest.TempPathFactory) -> Frames:
    folder = tmp_path_factory.mktemp("corridor")
    for k, pose in enumerate(POSES):
        Image.fromarray(_frame(pose)[0]).save(folder / f"{k}.png")
    return sample(folder, folder / "frames")


@pytest.fixture(scope="module")
def structure(frames: Frames) -> Structure:
    return reconstruct(frames, StructureOptions(features=1500))


class _Oracle:
    """A perfect predictor; `guess` distorts its depth, None: no depth."""

    def __init__(self, guess: float | None = None) -> None:
        self.calls, self.guess = 0, guess

    def __call__(self, rgb: np.ndarray, focal: float) -> FrameObservation:
        _, observation, depth = _frame(POSES[self.calls])
        self.calls += 1
        return (
            observation
            if self.guess is None
            else dataclasses.replace(observation, depth=(depth * self.guess).astype(np.float32))
        )


def _perceive(frames: Frames, structure: Structure, folder: pathlib.Path, guess: float | None = 1.3) -> Recording:
    perception = Perception(_Oracle(guess), lambda frames, progress: structure, HEIGHT)
    return perceive(frames, folder, perception, SOURCE, "corridor: north")


@pytest.mark.extended
def test_poses_focal_length_and_metric_scale_are_found(frames: Frames, structure: Structure, tmp_path: pathlib.Path):
    assert list(structure.registered) == list(range(9))
    assert structure.camera.fx == pytest.approx(CAMERA.fx, rel=0.03)
    recording = _perceive(frames, structure, tmp_path)
    error = trajectory_error(recording.poses(), POSES)
    assert error.scale == pytest.approx(1.0, abs=0.05)
    assert error.rmse < 0.1
    assert error.turn < 1.0
    assert recording.poses()[:, 2, 3] == pytest.approx([HEIGHT] * 9, abs=0.08)


@pytest.mark.extended
def test_some_frames_are_mapped_alone_with_the_known_lens(frames: Frames, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Structure | None] = []

    def part(structure: Structure, rebuild: Rebuild) -> Structure:
        asked.append(rebuild(2, 7))
        return structure

    monkeypatch.setattr(mapping, "bridged", part)
    whole = reconstruct(frames, StructureOptions(features=1500))
    found = asked[0]
    assert found is not None
    assert list(found.registered) == list(range(2, 8))
    assert found.camera.fx == whole.camera.fx
    assert trajectory_error(found.poses, POSES[2:8]).turn < 1.0


@pytest.mark.extended
def test_a_poster_in_two_corridors_does_not_link_them(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Frames 0 to 9 are in one corridor and 10 to 19 in another, with 2.5 x 2.5 m of the same wall in sight of both."""
    other = [_texture(k) for k in (10, 11, 12)]
    other[1][60:110, 20:70] = TEXTURES[1][60:110, 20:70]
    for k in range(20):
        pose = _pose(0.25 * k, 0.7 + 0.15 * np.sin(k / 1.5))
        Image.fromarray(_frame(pose, TEXTURES if k < 10 else other)[0]).save(tmp_path / f"{k:02d}.png")
    linked: list[np.ndarray] = []
    real = links.split

    def split(structure: Structure, own: np.ndarray, overlap: int) -> Structure:
        linked.append(structure.model)
        return real(structure, own, overlap)

    monkeypatch.setattr(links, "split", split)
    structure = reconstruct(sample(tmp_path, tmp_path / "frames"), StructureOptions(features=1500))
    assert list(structure.registered) == list(range(20))
    # COLMAP makes one model of them.
    assert (linked[0] == 0).all()
    np.testing.assert_array_equal(structure.model, np.repeat([0, 1], 10))


def test_the_metric_scale_is_told_when_frames_were_taken(
    frames: Frames, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[object] = []

    def stop(*args: object) -> None:
        told.extend(args)
        raise ValidationError("enough")

    module = importlib.import_module("urbanverse_mjx.distillation.perception.perceive")
    monkeypatch.setattr(module, "to_metric", stop)
    none = np.zeros(0, np.int32)
    rows = np.arange(9, dtype=np.int32)
    bare = Structure(
        CAMERA, 0.0, rows, POSES, np.zeros((0, 3)), none, none, np.zeros((0, 2), np.float32), 0.0, 0 * rows
    )
    with pytest.raises(ValidationError, match="enough"):
        _perceive(frames, bare, tmp_path)
    assert told[2] == HEIGHT
    np.testing.assert_array_equal(told[3], frames.time_s)


@pytest.mark.extended
@pytest.mark.parametrize("threads", [1, pytest.param(3, marks=pytest.mark.slow), 8])
def test_the_structure_does_not_depend_on_threads(
    frames: Frames, structure: Structure, threads: int, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setenv("URBANVERSE_THREADS", str(threads))
    other = reconstruct(frames, StructureOptions(features=1500))
    for field in dataclasses.fields(Structure):
        assert np.array_equal(getattr(structure, field.name), getattr(other, field.name)), field.name


@pytest.mark.extended
@pytest.mark.parametrize("seed", [1, pytest.param(5, marks=pytest.mark.slow)])
def test_a_short_clip_gets_a_lens_that_a_camera_has(tmp_path: pathlib.Path, seed: int):
    """Soft frames with noise, of which a long lens with k1 above 0.5 explains most matches best."""
    rng = np.random.default_rng(seed)
    textures = [_texture(10 * seed + k) for k in range(3)]
    step, swing, yaw = rng.uniform(0.3, 0.55), rng.uniform(0.05, 0.2), rng.uniform(0.3, 0.9)
    blur, noise = rng.uniform(0, 0.8), rng.uniform(0, 4)
    for k in range(9):
        image = _frame(_pose(step * k, yaw + swing * np.sin(k / 1.5)), textures)[0].astype(float)
        image = ndimage.gaussian_filter(image, (blur, blur, 0)) + rng.normal(0, noise, image.shape[:2])[..., None]
        Image.fromarray(image.clip(0, 255).astype(np.uint8)).save(tmp_path / f"{k}.png")
    structure = reconstruct(sample(tmp_path, tmp_path / "frames"), StructureOptions(features=1500))
    assert list(structure.registered) == list(range(9))
    assert structure.camera.fx == pytest.approx(CAMERA.fx, rel=0.1)
    assert abs(structure.distortion) < 0.1


@pytest.mark.parametrize("guess", [None, 1.3, 0.6])
def test_depth_is_held_to_points_and_ground(
    frames: Frames, structure: Structure, tmp_path: pathlib.Path, guess: float | None
):
    recording = _perceive(frames, structure, tmp_path, guess)
    for k in (0, 4, 8):
        _, observation, true = _frame(POSES[k])
        found = recording.depth(k)
        assert found is not None
        known = (true > 0) & (true < 25.0)
        error = np.abs(found - true) / np.maximum(true, 1e-9)
        assert np.median(error[known & (observation.surfaces == SIDEWALK)]) < 0.05
        assert (found[observation.surfaces == SKY] == 0).all()
        if guess is not None:
            assert np.median(error[known & (observation.masks >= 0)]) < 0.08


def test_the_recording_and_its_record_are_whole(frames: Frames, structure: Structure, tmp_path: pathlib.Path):
    _perceive(frames, structure, tmp_path)
    recording = Recording.load(tmp_path)
    assert recording.id == "corridor_north"
    assert recording.frames[2].detections == _frame(POSES[2])[1].detections
    masks = recording.masks(2)
    assert masks is not None
    assert np.array_equal(masks, _frame(POSES[2])[1].masks)
    record = json.loads((tmp_path / "perception.json").read_text())
    assert record["registered"] == 9
    assert record["ground_points"] >= 20
    assert record["frames"] == {"kept": 9, "dropped": [], "blurred_by": None}
    assert record["own_vehicle_percent"] == 0.0


def test_frames_without_a_pose_stay_in_the_recording_without_one(
    frames: Frames, structure: Structure, tmp_path: pathlib.Path
):
    keep = structure.frame != 8
    fewer = dataclasses.replace(
        structure,
        registered=structure.registered[:8],
        poses=structure.poses[:8],
        frame=structure.frame[keep],
        point=structure.point[keep],
        pixel=structure.pixel[keep],
        model=structure.model[:8],
    )
    recording = _perceive(frames, fewer, tmp_path)
    assert list(recording.registered) == list(range(8))
    assert recording.depth(8) is None


def test_without_ground_there_is_no_scale(frames: Frames, structure: Structure):
    with pytest.raises(ValidationError, match="found 0 points on the ground"):
        to_metric(structure, np.zeros(len(structure.frame), np.uint8), 1.5)


def _folder(path: pathlib.Path, images: list[np.ndarray]) -> Frames:
    path.mkdir()
    for k, image in enumerate(images):
        Image.fromarray(image).save(path / f"{k:03d}.png")
    return sample(path, path / "frames")


def _photograph() -> np.ndarray:
    """One large image of the corridor, (360, 640, 3) u8, sharp at every scale."""
    texture = (255 * _texture(7)[:360]).astype(np.uint8)
    return np.repeat(np.pad(texture, ((0, 0), (0, 40)), "wrap")[..., None], 3, -1)


@pytest.mark.parametrize("kind", ["pan", "zoom", "turn"])
def test_frames_without_parallax_are_refused_at_once(tmp_path: pathlib.Path, kind: str):
    photo = _photograph()
    if kind == "pan":
        images = [photo[6 * k : 6 * k + 180, 20 * k : 20 * k + 320] for k in range(9)]
    elif kind == "zoom":
        large = Image.fromarray(photo)
        boxes = [(10 * k, 5.625 * k, 640 - 10 * k, 360 - 5.625 * k) for k in range(9)]
        images = [np.asarray(large.resize((320, 180), Image.Resampling.BILINEAR, box)) for box in boxes]
    else:
        images = [_frame(_pose(0.0, 0.4 + 0.06 * k))[0] for k in range(9)]
    with pytest.raises(ValidationError, match=r"found no parallax .* needed a camera that moves past near and far"):
        reconstruct(_folder(tmp_path / "in", images))


def test_walks_have_parallax_even_along_a_wall(frames: Frames, tmp_path: pathlib.Path):
    check_parallax(frames)
    check_parallax(_folder(tmp_path / "in", [_frame(_pose(0.3 * k, 1.5))[0] for k in range(9)]))


@pytest.mark.extended
def test_parallax_does_not_depend_on_how_the_camera_was_held(tmp_path: pathlib.Path):
    walk = [_frame(pose)[0] for pose in POSES]
    turn = [_frame(_pose(0.0, 0.4 + 0.06 * k))[0] for k in range(9)]
    for name, images in (("walk", walk), ("turn", turn)):
        upright = [np.ascontiguousarray(np.rot90(image)) for image in images]
        shares = [parallax_shares(_folder(tmp_path / f"{name}{k}", x)) for k, x in enumerate((images, upright))]
        level, turned = (float(np.quantile(share, 0.75)) for share in shares)
        assert turned == pytest.approx(level, rel=0.15, abs=0.002)


@pytest.mark.extended
def test_a_given_focal_length_is_kept_and_a_stated_one_refined(frames: Frames):
    kept = reconstruct(frames, StructureOptions(features=1500, focal=200.0))
    assert kept.camera.fx == 200.0
    refined = reconstruct(frames, StructureOptions(features=1500, focal=200.0, exact=False))
    assert refined.camera.fx == pytest.approx(CAMERA.fx, rel=0.03)
    assert refined.camera.fx != 200.0


def test_frames_without_texture_give_no_poses(tmp_path: pathlib.Path):
    rng = np.random.default_rng(0)
    for k in range(3):
        Image.fromarray(rng.integers(0, 255, (60, 90, 3), dtype=np.uint8)).save(tmp_path / f"{k}.png")
    with pytest.raises(ValidationError, match="found poses for 0 of 3 frames"):
        reconstruct(sample(tmp_path, tmp_path / "frames"))


def test_a_object_stands_where_its_foot_meets_the_ground():
    """No points at all: a board 6 m away, guessed at 9 m, is pulled to its foot."""
    pose = _pose(0.0, 0.0, 0.0)
    rows, columns = np.mgrid[:180, :320]
    foot = CAMERA.cy + CAMERA.fy * HEIGHT / 6.0
    board = (np.abs(columns - 200) < 15) & (rows < foot) & (rows > foot - 40)
    surfaces = np.where(rows > CAMERA.cy, SIDEWALK, SKY).astype(np.uint8)
    surfaces[board] = 0
    guess = np.full(board.shape, 9.0, np.float32)
    observation = FrameObservation(surfaces, np.where(board, 0, -1).astype(np.int32), (Detection("bench"),), guess)
    none = np.zeros(0, np.int32)
    structure = Structure(
        CAMERA,
        0.0,
        np.array([0]),
        pose[None],
        np.zeros((0, 3)),
        none,
        none,
        np.zeros((0, 2), np.float32),
        0.0,
        np.zeros(1, np.int32),
    )
    ground = np.array([[x, y, 0.0] for x in range(1, 9) for y in (-1, 1)], float)
    metric = dataclasses.replace(_flat(pose), points=ground, ground=np.full(len(ground), SIDEWALK, np.uint8))
    depth = dense_depth(0, observation, structure, metric, levels(metric))
    assert np.median(depth[board]) == pytest.approx(6.0, rel=0.1)
    assert depth[175, 10] == pytest.approx(HEIGHT * CAMERA.fy / (175.5 - CAMERA.cy), rel=1e-3)


def _flat(pose: np.ndarray):
    from urbanverse_mjx.distillation.perception.metric import Metric

    one = np.ones(1)
    return Metric(np.zeros(1, int), one, pose[None], np.zeros((0, 3)), np.zeros(0, np.uint8), HEIGHT * one, 1)


def test_lens_distortion_is_taken_out():
    """A straight line that the lens bent is straight again."""
    none = np.zeros(0, np.int32)
    structure = Structure(
        CAMERA, -0.2, none, np.zeros((0, 4, 4)), np.zeros((0, 3)), none, none, np.zeros((0, 2), np.float32), 0.0, none
    )
    rays = CAMERA.rays()
    # The bent image: each of its pixels shows the ray whose distortion leads there (a few fixed-point steps).
    straight = rays[..., :2].copy()
    for _ in range(30):
        straight = rays[..., :2] / (1.0 - 0.2 * (straight**2).sum(-1, keepdims=True))
    bent = np.where(np.abs(straight[..., 1] + 0.25) < 0.012, 255, 0).astype(np.uint8)
    out = structure.straighten(np.repeat(bent[..., None], 3, -1))[..., 0].astype(float)
    assert _rise(out) < 1.0
    assert _rise(bent.astype(float)) > 2.0


def _rise(image: np.ndarray) -> float:
    """Rows between the highest and the lowest middle of the columns of an image (H, W) of one line."""
    middle = (image * np.arange(len(image))[:, None]).sum(0) / image.sum(0)
    return float(np.ptp(middle[20:300]))


def test_trajectory_error_knows_a_rigid_motion_from_drift():
    T = _pose(3.0, 1.0, 0.2)
    moved = T @ POSES
    same = trajectory_error(POSES, moved)
    assert same.rmse < 1e-9
    assert same.turn < 1e-5
    stretched = POSES.copy()
    stretched[:, :3, 3] *= 1.1
    assert trajectory_error(stretched, moved).scale == pytest.approx(1 / 1.1)
