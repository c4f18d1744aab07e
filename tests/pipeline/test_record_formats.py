"""COCO, KITTI and MCAP: each read back by its own reader or by its documented columns."""

import dataclasses
import io
import itertools
import json
import pathlib
import sys
from typing import Any

import cv2
import numpy as np
import pyarrow.parquet as pq
import pytest
from scipy.spatial.transform import Rotation

from tests.pipeline.test_recording import OPTIONS, SIZE, drawn_env, use
from urbanverse_mjx import pipeline
from urbanverse_mjx.cli import main as cli
from urbanverse_mjx.datasets import coco, kitti
from urbanverse_mjx.datasets.annotations import SeenObject
from urbanverse_mjx.datasets.frame_files import Rig
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.envs import NavEnv
from urbanverse_mjx.geometry import rotations
from urbanverse_mjx.pipeline.recording.lidar import LidarOptions

EPISODES, STEPS = 3, 5
FRAMES = EPISODES * STEPS
CORNERS = np.array([*itertools.product((-0.5, 0.5), repeat=3)])
#: Rays enough that many meet every object near the robot.
LIDAR = LidarOptions(rings=24, azimuths=180, upper=20.0, lower=-50.0)


@pytest.fixture(scope="module")
def env(small_bank: SceneBank) -> NavEnv:
    return drawn_env(small_bank, {"episode_length": STEPS})


@pytest.fixture(scope="module")
def recorded(env: NavEnv, tmp_path_factory: pytest.TempPathFactory) -> dict[str, pathlib.Path]:
    """The same episodes in every format."""
    folder = tmp_path_factory.mktemp("formats")
    found = {}
    with pytest.MonkeyPatch.context() as patch:
        use(env, patch)
        for form, sensors in (("coco", ()), ("kitti", ()), ("mcap", ("all",)), ("lerobot", ("camera_pose", "boxes"))):
            if form == "mcap":
                pytest.importorskip("mcap_protobuf")
                pytest.importorskip("foxglove_schemas_protobuf")
                sensors = ("boxes", "lidar", "imu", "odometry", "contacts")
            options = {"format": form, "sensors": sensors, "num_episodes": EPISODES, "lidar": LIDAR}
            said = pipeline.record(folder / form, pipeline.RecordOptions(**{**vars(OPTIONS), **options}))
            assert (said["episodes"], said["frames"]) == (EPISODES, FRAMES)
            found[form] = folder / form
    return found


def annotations_of(recorded: dict[str, pathlib.Path]) -> list[dict[str, Any]]:
    return pq.read_table(recorded["lerobot"] / "annotations/chunk-000/file-000.parquet").to_pylist()


@pytest.mark.extended
@pytest.mark.filterwarnings("ignore:__array__ implementation:DeprecationWarning")
def test_coco_is_read_by_pycocotools(recorded: dict[str, pathlib.Path]) -> None:
    api = pytest.importorskip("pycocotools.coco")
    mask_of = pytest.importorskip("pycocotools.mask")
    per_frame = annotations_of(recorded)
    data, captions = (api.COCO(str(recorded["coco"] / name)) for name in (coco.INSTANCES, coco.CAPTIONS))
    numbers = sorted(data.getImgIds())
    assert len(numbers) == FRAMES == len(list((recorded["coco"] / "images").iterdir()))
    for number, frame in zip(numbers, per_frame, strict=True):
        image = data.loadImgs([number])[0]
        pixels = cv2.imread(str(recorded["coco"] / "images" / image["file_name"]))
        assert pixels is not None
        assert pixels.shape == (*SIZE, 3) == (image["height"], image["width"], 3)
        own = data.loadAnns(data.getAnnIds(imgIds=[number]))
        assert [a["name"] for a in own] == [item["name"] for item in frame["objects"]]
        for a, item in zip(own, frame["objects"], strict=True):
            mask = data.annToMask(a)
            assert mask.sum() == a["area"] == item["pixels"]
            assert a["visible"] == pytest.approx(item["visible"], abs=1e-4)
            # The box that the library computes of the mask is the stored one.
            np.testing.assert_array_equal(mask_of.toBbox(data.annToRLE(a)), a["bbox"])
            assert data.loadCats([a["category_id"]])[0]["name"] == item["category"]
        assert captions.loadAnns(captions.getAnnIds(imgIds=[number]))[0]["caption"] == frame["caption"]
    assert sum(len(frame["objects"]) for frame in per_frame) > 20


def calibration_of(path: pathlib.Path) -> dict[str, np.ndarray]:
    rows = (line.split(":") for line in path.read_text().splitlines())
    return {name: np.array(numbers.split(), float).reshape(3, -1) for name, numbers in rows}


def test_kitti_boxes_project_onto_those_in_the_image(recorded: dict[str, pathlib.Path]) -> None:
    """Corners made from the documented columns, through P2; the solids of these streets stand upright."""
    folder = recorded["kitti"] / "training"
    names = (recorded["kitti"] / kitti.IMAGE_SET).read_text().split()
    assert names == [f"{k:06d}" for k in range(FRAMES)]
    whole, inside, hidden = 0, [], set()
    for name in names:
        image = cv2.imread(str(folder / f"image_2/{name}.png"))
        assert image is not None
        assert image.shape == (*SIZE, 3)
        calib = calibration_of(folder / f"calib/{name}.txt")
        for line in (folder / f"label_2/{name}.txt").read_text().splitlines():
            kind, *numbers = line.split()
            truncated, occluded, alpha, left, top, right, bottom, h, w, length, x, y, z, turn = map(float, numbers)
            assert kind in ("Box", "Wedge", "Cylinder")
            hidden.add(occluded)
            assert alpha == pytest.approx((turn - np.arctan2(x, z) + np.pi) % (2 * np.pi) - np.pi, abs=1e-3)
            own = (CORNERS * [length, h, w] + [0.0, -0.5 * h, 0.0]).T
            c, s = np.cos(turn), np.sin(turn)
            corners = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]) @ own + np.array([[x], [y], [z]])
            inside += _hits(folder / f"velodyne/{name}.bin", calib, (x, y, z, turn), (length, h, w))
            if corners[2].min() < 0.1:
                continue
            pixel = calib["P2"] @ np.vstack([calib["R0_rect"] @ corners, np.ones(8)])
            pixel = pixel[:2] / pixel[2]
            assert pixel[0].min() - 1 <= left <= right <= pixel[0].max() + 1
            assert pixel[1].min() - 1 <= top <= bottom <= pixel[1].max() + 1
            size = np.clip(pixel.max(1), 0, SIZE[::-1]) - np.clip(pixel.min(1), 0, SIZE[::-1])
            if truncated == 0.0 and (right - left + 1) * (bottom - top + 1) > 0.6 * np.prod(size):
                whole += 1
    assert whole > 10
    assert {0, 1} <= hidden <= {0, 1, 2}
    assert sum(inside) > 50


def _hits(path: pathlib.Path, calib: dict[str, np.ndarray], place: Any, size: Any) -> list[int]:
    """How many points of the scan lie in a box of a label, all but touching it."""
    scan = np.fromfile(path, "<f4").reshape(-1, 4)
    assert (scan[:, 3] == 0).all()
    points = calib["Tr_velo_to_cam"] @ np.column_stack([scan[:, :3], np.ones(len(scan))]).T
    x, y, z, turn = place
    c, s = np.cos(turn), np.sin(turn)
    local = np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]]) @ (points - np.array([[x], [y - 0.5 * size[1]], [z]]))
    return [int((np.abs(local) <= 0.5 * np.array([size]).T + 0.01).all(0).sum())]


def test_a_label_of_a_known_place_has_kittis_axes() -> None:
    """10 m ahead and 2 m to the right, facing left: rotation_y of -pi is along -x; a camera 1.5 m high, tilted down."""
    rig = Rig(100, 200, (100.0, 100.0), (100.0, 50.0), 5, (0.0, 0.0, 0.5), ["car"])
    # T_world_camera: looks along world x (z ahead), x right = -y, y down = -z, then turned down by 0.2 about its x.
    turn = np.column_stack([[0, -1, 0], [0, 0, -1], [1, 0, 0]]) @ rotations.matrix_f64(
        np.array([np.cos(0.1), -np.sin(0.1), 0, 0])
    )
    quaternion = Rotation.from_matrix(turn).as_quat(scalar_first=True)
    camera = np.concatenate([[0.0, 0.0, 1.5], quaternion])
    level = kitti.levelled(quaternion)
    np.testing.assert_allclose(level, np.column_stack([[0, -1, 0], [0, 0, -1], [1, 0, 0]]), atol=1e-6)
    facing_left = tuple(rotations.from_yaw(np.float64(np.pi / 2)))
    car = SeenObject(
        *(3, "c", "car", (10, 20, 30, 40), 50, 0.9, (4.0, 2.0, 1.5)),
        *((10.0, -2.0, 0.75), facing_left, (0, 0, 9), (1, 0, 0, 0)),
    )
    kind, *numbers = kitti.label_line(car, camera, level, rig).split()
    shares = {1.0: "0", 0.9: "0", 0.89: "1", 0.5: "1", 0.49: "2", 0.01: "2"}
    seen = [kitti.label_line(dataclasses.replace(car, visible=share), camera, level, rig) for share in shares]
    assert [line.split()[2] for line in seen] == list(shares.values())
    assert kind == "Car"
    h, w, length, x, y, z, turned = map(float, numbers[7:])
    assert (h, w, length) == (1.5, 2.0, 4.0)
    np.testing.assert_allclose([x, y, z], [2.0, 1.5, 10.0], atol=1e-4)
    assert abs(turned) == pytest.approx(np.pi, abs=1e-3)
    # A point on the optical axis is in the image's middle.
    ahead = level.T @ (turn @ [0.0, 0.0, 5.0])
    pixel = kitti.projection(camera, level, rig) @ np.append(ahead, 1.0)
    np.testing.assert_allclose(pixel[:2] / pixel[2], [100.0, 50.0], atol=1e-4)


@pytest.mark.parametrize(
    ("category", "name"),
    [
        ("hatchback car", "Car"),
        ("taxi", "Car"),
        ("sedan", "Car"),
        ("agent:pedestrian", "Pedestrian"),
        ("pedestrian adult", "Pedestrian"),
        ("delivery_van", "Van"),
        ("street/furniture/trash bin", "TrashBin"),
        ("car park sign", "CarParkSign"),
        ("elderly person", "Pedestrian"),
    ],
)
def test_classes_are_one_word(category: str, name: str) -> None:
    assert kitti.kitti_class(category) == name


def test_mcap_is_read_by_its_readers(recorded: dict[str, pathlib.Path], env: NavEnv) -> None:
    reader = pytest.importorskip("mcap.reader")
    decoder = pytest.importorskip("mcap_protobuf.decoder")
    paths = sorted(recorded["mcap"].glob("*.mcap"))
    assert [p.name for p in paths] == [f"episode_{k:06d}.mcap" for k in range(EPISODES)]
    per_frame = annotations_of(recorded)
    for k, path in enumerate(paths):
        source = reader.make_reader(io.BytesIO(path.read_bytes()), decoder_factories=[decoder.DecoderFactory()])
        summary = source.get_summary()
        assert summary is not None
        counts = {c.topic: summary.statistics.channel_message_counts[i] for i, c in summary.channels.items()}
        assert set(counts.values()) == {STEPS}
        wanted = {"/tf", "/pose", "/camera/image", "/camera/calibration", "/lidar", "/objects", "/camera/boxes"}
        assert set(counts) == wanted | {"/caption", "/imu", "/action", "/odometry", "/contact_force"}
        (metadata,) = source.iter_metadata()
        assert metadata.metadata["result"] == "timeout"
        _check_messages(source, per_frame[k * STEPS : (k + 1) * STEPS])


def _check_messages(source: Any, per_frame: list[dict[str, Any]]) -> None:
    protobuf = ["/camera/image", "/objects", "/lidar", "/tf"]
    steps = dict.fromkeys(protobuf, 0)
    for _, channel, message, decoded in source.iter_decoded_messages(topics=protobuf):
        k = steps[channel.topic]
        steps[channel.topic] += 1
        assert message.log_time == k * 200_000_000
        if channel.topic == "/camera/image":
            image = cv2.imdecode(np.frombuffer(decoded.data, np.uint8), cv2.IMREAD_COLOR)
            assert image is not None
            assert image.shape == (*SIZE, 3)
        elif channel.topic == "/objects":
            assert [e.id for e in decoded.entities] == [item["name"] for item in per_frame[k]["objects"]]
        elif channel.topic == "/lidar":
            points = np.frombuffer(decoded.data, "<f4").reshape(-1, 3)
            assert len(points) > 100
            assert np.linalg.norm(points, axis=1).max() <= LIDAR.range + 1e-3
        else:
            assert [t.child_frame_id for t in decoded.transforms] == ["robot", "camera", "lidar"]
    for _, channel, message in source.iter_messages(topics=["/imu", "/caption"]):
        body = json.loads(message.data)
        if channel.topic == "/imu":
            assert np.isfinite([*body["angular_velocity"].values(), *body["linear_acceleration"].values()]).all()
        else:
            assert body["text"] in {item["caption"] for item in per_frame}


def test_missing_packages_and_sensors_are_one_sentence(
    capsys: pytest.CaptureFixture[str], tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = ["record", "--out", str(tmp_path / "new"), "--quiet"]
    assert cli.main([*out, "--format", "kitti", "--with", "depth"]) == 2
    assert "found 'depth', needed one of boxes, lidar, camera_pose for --format kitti" in capsys.readouterr().err
    monkeypatch.setitem(sys.modules, "mcap.writer", None)
    assert cli.main([*out, "--format", "mcap"]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert 'pip install "urbanverse_mjx[mcap]"' in said
    assert not (tmp_path / "new").exists()
