"""Readers of other people's recordings, on small files made here in the format they document."""

import json
import pathlib

import numpy as np
import pytest
from PIL import Image
from scipy.spatial.transform import Rotation

from urbanverse_mjx.assets import load_index
from urbanverse_mjx.datatypes import KIND_INDEX, Detection, Recording, Source, ValidationError
from urbanverse_mjx.datatypes.recording import SKY
from urbanverse_mjx.distillation.perception import FrameObservation
from urbanverse_mjx.distillation.readers import Kitti360Options, read_authors_tree, read_kitti360
from urbanverse_mjx.distillation.readers.kitti360_labels import CLASSES

SEQUENCE = "2013_05_28_drive_0000_sync"
WIDTH, HEIGHT, FOCAL = 64, 24, 40.0
#: A car 4 m long, 2 m wide and 1.5 m high, 10 m before the first camera and 1 m to its right, turned by 20°.
CAR_SIZE, CAR_YAW = np.array([4.0, 2.0, 1.5]), np.radians(20.0)
CAMERA_HEIGHT = 1.55
ORIGIN = np.array([1000.0, 3000.0, 115.0])
#: Our camera axes (x right, y down, z ahead) in KITTI-360's IMU (x ahead, y left, z up here, as the file states).
T_IMU_CAMERA = np.array([[0, 0, 1, 0.8], [-1, 0, 0, 0.3], [0, -1, 0, 1.0], [0, 0, 0, 1]], float)
R_RECT = Rotation.from_euler("xyz", [0.5, -0.3, 0.2], degrees=True).as_matrix()


def text_of(values: np.ndarray) -> str:
    return " ".join(f"{x:.9f}" for x in np.ravel(values))


def write_kitti(root: pathlib.Path) -> dict[int, np.ndarray]:
    """A sequence of frames 0, 5 and 7, of which 5 has no image; returns T_world_camera (rectified) by frame."""
    calibration = root / "calibration"
    calibration.mkdir(parents=True)
    P = np.array([[FOCAL, 0, 31.5, 0], [0, FOCAL, 11.5, 0], [0, 0, 1, 0]])
    (calibration / "perspective.txt").write_text(
        "calib_time: 01-Jan-2013\n"
        f"S_rect_00: {WIDTH} {HEIGHT}\nR_rect_00: {text_of(R_RECT)}\nP_rect_00: {text_of(P)}\n"
        f"S_rect_01: {WIDTH} {HEIGHT}\nR_rect_01: {text_of(np.eye(3))}\nP_rect_01: {text_of(P)}\n"
    )
    turn = np.eye(4)
    turn[:3, :3] = R_RECT
    mounted = T_IMU_CAMERA @ turn  # so that the rectified camera faces straight ahead
    lines = [f"image_{k:02d}: {text_of(mounted[:3])}" for k in range(4)]
    (calibration / "calib_cam_to_pose.txt").write_text("\n".join(lines) + "\n")
    (calibration / "calib_cam_to_velo.txt").write_text(text_of(T_IMU_CAMERA[:3]) + "\n")
    poses, cameras = [], {}
    for frame, along in ((0, 0.0), (5, 1.0), (7, 2.0)):
        T = np.eye(4)
        T[:3, 3] = ORIGIN + [along, 0, 0]
        poses.append(f"{frame} {text_of(T[:3])}")
        cameras[frame] = T @ T_IMU_CAMERA
    folder = root / "data_poses" / SEQUENCE
    folder.mkdir(parents=True)
    (folder / "poses.txt").write_text("\n".join(poses) + "\n")
    labels = root / "data_2d_semantics" / "train" / SEQUENCE / "image_00"
    images = root / "data_2d_raw" / SEQUENCE / "image_00" / "data_rect"
    for path in (labels / "semantic", labels / "instance", images):
        path.mkdir(parents=True)
    for frame in (0, 7):
        semantic = np.full((HEIGHT, WIDTH), 23, np.uint8)
        semantic[12:] = 7
        semantic[16:, :10] = 8
        instance = semantic.astype(np.uint16) * 1000
        car = car_pixels(cameras[frame])
        semantic[car], instance[car] = 26, 26 * 1000 + 3
        instance[0, 0] = 11 * 1000  # a building without an instance number
        Image.fromarray(semantic).save(labels / "semantic" / f"{frame:010d}.png")
        Image.fromarray(instance).save(labels / "instance" / f"{frame:010d}.png")
        rgb = np.full((HEIGHT, WIDTH, 3), 50 + frame, np.uint8)
        Image.fromarray(rgb).save(images / f"{frame:010d}.png")
    boxes = root / "data_3d_bboxes" / "train"
    boxes.mkdir(parents=True)
    (boxes / f"{SEQUENCE}.xml").write_text(boxes_text())
    return cameras


def car_center() -> np.ndarray:
    camera_position = ORIGIN + T_IMU_CAMERA[:3, 3]
    return camera_position + [10.0, -1.0, -CAMERA_HEIGHT + CAR_SIZE[2] / 2]


def car_entry(T_world_camera: np.ndarray) -> np.ndarray:
    """(H, W) how far along the camera's axis each ray enters the car, inf where it passes by: slabs, in its axes."""
    v, u = np.mgrid[0:HEIGHT, 0:WIDTH]
    rays = np.stack([(u - 31.5) / FOCAL, (v - 11.5) / FOCAL, np.ones_like(u)], -1) @ T_world_camera[:3, :3].T
    c, s = np.cos(CAR_YAW), np.sin(CAR_YAW)
    turn = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    camera_position, rays = turn @ (T_world_camera[:3, 3] - car_center()), rays @ turn.T
    with np.errstate(divide="ignore"):
        a, b = (-CAR_SIZE / 2 - camera_position) / rays, (CAR_SIZE / 2 - camera_position) / rays
    enter, leave = np.minimum(a, b).max(-1), np.maximum(a, b).min(-1)
    return np.where((enter <= leave) & (enter > 0), enter, np.inf)


def car_pixels(T_world_camera: np.ndarray) -> np.ndarray:
    return np.isfinite(car_entry(T_world_camera))


def boxes_text() -> str:
    c, s = np.cos(CAR_YAW), np.sin(CAR_YAW)
    transform = np.eye(4)
    transform[:3, :3] = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.diag(CAR_SIZE)
    transform[:3, 3] = car_center()
    cube = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])

    def matrix(name: str, values: np.ndarray) -> str:
        rows, cols = values.shape
        return (
            f'<{name} type_id="opencv-matrix"><rows>{rows}</rows><cols>{cols}</cols><dt>f</dt>'
            f"<data>\n{text_of(values)}</data></{name}>"
        )

    def node(number: int, kind: int, instance: int, timestamp: int) -> str:
        return (
            f"<object{number}><index>{number}</index><label>x</label><semanticId>{kind}</semanticId>"
            f"<instanceId>{instance}</instanceId><category>c</category><timestamp>{timestamp}</timestamp>"
            f"<start_frame>0</start_frame><end_frame>9</end_frame>{matrix('transform', transform)}"
            f"{matrix('vertices', cube)}{matrix('faces', np.zeros((12, 3)))}</object{number}>"
        )

    # A static car (box id 13), one that moves and holds at another frame, and a class without images.
    return (
        '<?xml version="1.0"?>\n<opencv_storage>'
        + node(1, 13, 3, -1)
        + node(2, 13, 4, 99)
        + node(3, 77, 1, -1)
        + "<object4><index>4</index></object4></opencv_storage>\n"
    )


def test_every_class_has_a_leaf_of_ours_and_a_number_of_its_own():
    leaves = set(load_index().leaves)
    assert {c.label for c in CLASSES if c.label} <= leaves
    for numbers in ([c.id for c in CLASSES], [c.box_id for c in CLASSES if c.box_id >= 0]):
        assert len(numbers) == len(set(numbers))


def test_kitti360_becomes_a_recording(tmp_path: pathlib.Path):
    cameras = write_kitti(tmp_path / "kitti")
    made = read_kitti360(tmp_path / "kitti", tmp_path / "out", Kitti360Options(SEQUENCE))
    recording = Recording.load(tmp_path / "out")
    assert recording.to_json() == made.to_json()
    assert [f.time_s for f in recording.frames] == [0.0, 0.7]
    assert (recording.camera.fx, recording.camera.cx, recording.camera.cy) == (FOCAL, 32.0, 12.0)
    first = recording.poses()[0]
    np.testing.assert_allclose(first[:3, 3], 0.0, atol=1e-6)
    np.testing.assert_allclose(first[:3, :3], cameras[0][:3, :3], atol=1e-6)
    np.testing.assert_allclose(recording.poses()[1][:3, 3], [2.0, 0, 0], atol=1e-6)
    for row, frame in enumerate((0, 7)):
        assert recording.frames[row].detections == (Detection("car", 1.0, "car_3"),)
        masks, surfaces, depth = recording.masks(row), recording.surfaces(row), recording.depth(row)
        assert masks is not None
        assert surfaces is not None
        assert depth is not None
        car = car_pixels(cameras[frame])
        assert 20 < car.sum() < 400
        np.testing.assert_array_equal(masks == 0, car)
        assert set(np.unique(surfaces[~car])) == {SKY, KIND_INDEX["road"], KIND_INDEX["sidewalk"]}
        np.testing.assert_allclose(depth[car], car_entry(cameras[frame])[car], atol=0.01)
        below = ~car & (surfaces == KIND_INDEX["road"])
        v = np.nonzero(below)[0]
        level = CAMERA_HEIGHT * FOCAL / (v + 0.5 - 12.0)
        np.testing.assert_allclose(depth[below], np.where(level < 40, level, 0), atol=0.01)
        assert (depth[surfaces == SKY] == 0).all()
        assert abs(int(recording.rgb(row)[0, 0, 0]) - 50 - frame) <= 2
    (obj,) = json.loads((tmp_path / "out" / "boxes.json").read_text())
    np.testing.assert_allclose(obj["center"], car_center() - ORIGIN - T_IMU_CAMERA[:3, 3], atol=1e-5)
    np.testing.assert_allclose(obj["size"], CAR_SIZE, atol=1e-5)
    assert obj["yaw"] == pytest.approx(CAR_YAW)
    assert (obj["id"], obj["label"]) == ("car_3", "car")


def test_kitti360s_laser_gives_depth(tmp_path: pathlib.Path):
    cameras = write_kitti(tmp_path / "kitti")
    scans = tmp_path / "kitti" / "data_3d_raw" / SEQUENCE / "velodyne_points" / "data"
    scans.mkdir(parents=True)
    for frame in (0, 7):
        # The laser sits where the cameras' frame of reference does: a point 8 m ahead, one behind, a nearer one.
        points = np.array([[0, 0, 8.0], [0, 0, -5.0], [0.01, 0.0, 6.0]]) @ T_IMU_CAMERA[:3, :3].T + T_IMU_CAMERA[:3, 3]
        np.c_[points, np.zeros(3)].astype("<f4").tofile(scans / f"{frame:010d}.bin")
    made = read_kitti360(tmp_path / "kitti", tmp_path / "out", Kitti360Options(SEQUENCE))
    depth = made.depth(0)
    assert depth is not None
    assert depth[12, 32] == pytest.approx(6.0, abs=0.01)
    assert depth[12, 34] == pytest.approx(6.0, abs=0.01)
    assert depth[0, 0] == 0
    assert len(cameras) == 3
    (scans / f"{7:010d}.bin").write_bytes(b"12345")
    with pytest.raises(ValidationError, match="5 bytes"):
        read_kitti360(tmp_path / "kitti", tmp_path / "again", Kitti360Options(SEQUENCE))
    assert not (tmp_path / "again" / "recording.json").exists()


@pytest.mark.parametrize(
    ("file", "content", "said"),
    [
        ("calibration/perspective.txt", "S_rect_00: 64 24\n", "no P_rect_00"),
        (f"data_poses/{SEQUENCE}/poses.txt", "0 1 2 nan\n", "3 numbers"),
        (f"data_poses/{SEQUENCE}/poses.txt", "3 " + "1 " * 12, "no image of them"),
        (f"data_3d_bboxes/train/{SEQUENCE}.xml", "<a><b>", "no XML"),
        (f"data_2d_semantics/train/{SEQUENCE}/image_00/instance/0000000000.png", "x", "no readable image"),
    ],
)
def test_broken_kitti360_is_one_sentence(tmp_path: pathlib.Path, file: str, content: str, said: str):
    write_kitti(tmp_path / "kitti")
    (tmp_path / "kitti" / file).write_text(content)
    with pytest.raises(ValidationError, match=said):
        read_kitti360(tmp_path / "kitti", tmp_path / "out", Kitti360Options(SEQUENCE))
    assert not (tmp_path / "out" / "recording.json").exists()


class OneCar:
    """Predictor a car in the middle of every image and road below."""

    def __call__(self, rgb: np.ndarray, focal: float, /) -> FrameObservation:
        assert focal == 30.0
        surfaces, masks = np.zeros(rgb.shape[:2], np.uint8), np.full(rgb.shape[:2], -1, np.int32)
        surfaces[20:], masks[8:16, 10:20] = KIND_INDEX["road"], 0
        return FrameObservation(surfaces, masks, (Detection("car", 0.9),))


def write_authors(root: pathlib.Path, frames: int = 3) -> np.ndarray:
    """Their tree with the first camera's frame as world (y down), as MASt3R gives it; returns the poses."""
    for name in ("images", "depth", "conf", "poses", "segmentations_2d"):
        (root / name).mkdir(parents=True)
    poses = np.tile(np.eye(4), (frames, 1, 1))
    poses[:, 2, 3] = np.arange(frames)  # one metre ahead a frame
    for k in range(frames):
        Image.fromarray(np.full((60, 80, 3), 10 * k, np.uint8)).save(root / "images" / f"{k:06d}.png")
        depth = np.full((30, 40), 5.0 + k, np.float32)
        depth[0, 0] = np.nan
        np.save(root / "depth" / f"{k:06d}.npy", depth)
        conf = np.ones((30, 40), np.float32) * 3
        conf[:, :4] = 1.0
        np.save(root / "conf" / f"{k:06d}.npy", conf)
        np.save(root / "poses" / f"{k:06d}.npy", poses[k].astype(np.float32))
    (root / "camera.yaml").write_text("fx: 30.0\nfy: 31.0\ncx: 20.0\ncy: 15.0\n")
    (root / "config_params.json").write_text("{}")
    (root / "distilled_scene_graph.pkl.gz").write_bytes(b"never opened")
    return poses


def test_the_authors_tree_becomes_a_recording(tmp_path: pathlib.Path):
    write_authors(tmp_path / "tokyo")
    source = Source("tokyo.mp4", "CC BY", "Tokyo", "Japan")
    made = read_authors_tree(tmp_path / "tokyo", tmp_path / "out", OneCar(), source, rate=2.0)
    recording = Recording.load(tmp_path / "out")
    assert recording.to_json() == made.to_json()
    assert (recording.id, recording.source) == ("tokyo", source)
    assert (recording.camera.width, recording.camera.height, recording.camera.fy) == (40, 30, 31.0)
    assert [f.time_s for f in recording.frames] == [0.0, 0.5, 1.0]
    poses = recording.poses()
    np.testing.assert_allclose(poses[:, :3, 1], np.tile([0, 0, -1.0], (3, 1)), atol=1e-6)  # down is -z
    np.testing.assert_allclose(np.linalg.norm(np.diff(poses[:, :2, 3], axis=0), axis=1), 1.0, atol=1e-6)
    depth = recording.depth(2)
    assert depth is not None
    assert depth[15, 20] == pytest.approx(7.0, abs=0.01)
    assert depth[0, 0] == 0
    assert (depth[:, :4] == 0).all()
    assert recording.frames[1].detections == (Detection("car", 0.9),)
    # One file with all poses, and a matrix for the lens, are the same.
    for path in (tmp_path / "tokyo" / "poses").iterdir():
        path.unlink()
    np.save(tmp_path / "tokyo" / "poses" / "all.npy", _ahead(3))
    (tmp_path / "tokyo" / "camera.yaml").write_text("K: [[30, 0, 20], [0, 31, 15], [0, 0, 1]]\n")
    again = read_authors_tree(tmp_path / "tokyo", tmp_path / "again", OneCar(), source, rate=2.0)
    assert again.to_json() == made.to_json()


def _ahead(frames: int) -> np.ndarray:
    poses = np.tile(np.eye(4), (frames, 1, 1))
    poses[:, 2, 3] = np.arange(frames)
    return poses


@pytest.mark.parametrize("broken", ["pose", "lens", "count", "depth", "folder"])
def test_a_broken_tree_of_theirs_is_one_sentence(tmp_path: pathlib.Path, broken: str):
    root = tmp_path / "tokyo"
    write_authors(root)
    if broken == "pose":
        np.save(root / "poses" / "000001.npy", np.full((4, 4), np.nan))
    elif broken == "lens":
        (root / "camera.yaml").write_text("fx: 30\n")
    elif broken == "count":
        (root / "depth" / "000001.npy").unlink()
    elif broken == "depth":
        (root / "depth" / "000001.npy").write_bytes(b"\x93NUMPY")
    else:
        root = tmp_path / "none"
    words = {"pose": "pose 1", "lens": "fields fx", "count": "2 depth maps", "depth": "no readable array"}
    with pytest.raises(ValidationError, match=words.get(broken, "no such files")):
        read_authors_tree(root, tmp_path / "out", OneCar(), Source("a", "b", "c", "d"))
    assert not (tmp_path / "out" / "recording.json").exists()
