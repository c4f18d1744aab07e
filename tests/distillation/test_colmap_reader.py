"""A COLMAP model of others becomes a recording in metres, upright, with undistorted frames."""

import pathlib
import shutil

import numpy as np
import pytest
from PIL import Image
from scipy.spatial.transform import Rotation

from tests.distillation.test_perceive import CAMERA, HEIGHT, POSES, SOURCE, _frame, _Oracle
from urbanverse_mjx.datatypes import Camera, ValidationError
from urbanverse_mjx.distillation.perception import trajectory_error
from urbanverse_mjx.distillation.readers import read_colmap
from urbanverse_mjx.distillation.readers.colmap import _undistorted

#: The model's own unit (m) and axes.
UNIT, TURN = 0.137, Rotation.from_euler("xyz", [0.7, -1.9, 0.4]).as_matrix()


def write_model(folder: pathlib.Path, lens: str = "PINHOLE", below: str = "sparse/0", images: int = 9) -> pathlib.Path:
    """Writes the corridor's frames and a text model with points on its surfaces, seen by two frames each.

    With the lens SIMPLE_RADIAL the images are stretched: k1 = 0.1.
    """
    model = folder / below
    model.mkdir(parents=True, exist_ok=True)
    (folder / "images").mkdir()
    rng = np.random.default_rng(0)
    points, seen, tracks = [], [[] for _ in range(images)], list[list[str]]()
    for k in range(images):
        rgb, _, depth = _frame(POSES[k])
        if lens == "SIMPLE_RADIAL":
            rgb = bent(rgb)
        Image.fromarray(rgb).save(folder / "images" / f"f{k}.png")
        rows, columns = rng.integers(0, 180, 150), rng.integers(0, 320, 150)
        for row, column in zip(rows, columns, strict=True):
            if 0 < depth[row, column] < 20:
                ray = CAMERA.rays()[row, column] * depth[row, column]
                points.append(POSES[k][:3, 3] + POSES[k][:3, :3] @ ray)
    for number, point in enumerate(points):
        tracks.append([])
        for k in range(images):
            local = POSES[k][:3, :3].T @ (point - POSES[k][:3, 3])
            x, y = local[:2] / local[2] if local[2] > 0.1 else (9.0, 9.0)
            stretch = 1 + 0.1 * (x * x + y * y) if lens == "SIMPLE_RADIAL" else 1.0
            u, w = 210 * x * stretch + 160, 210 * y * stretch + 90
            if 0 < u < 320 and 0 < w < 180:
                tracks[number].append(f"{k + 1} {len(seen[k])}")
                seen[k].append((u, w, number + 1))
    parameters = "210 160 90 0.1" if lens == "SIMPLE_RADIAL" else "210 210 160 90"
    (model / "cameras.txt").write_text(f"1 {lens} 320 180 {parameters}\n")
    lines = []
    for k in range(images):
        back = (TURN @ POSES[k][:3, :3]).T
        x, y, z, w = Rotation.from_matrix(back).as_quat()
        shift = -back @ (TURN @ POSES[k][:3, 3]) / UNIT
        lines.append(f"{k + 1} {w} {x} {y} {z} {shift[0]} {shift[1]} {shift[2]} 1 f{k}.png")
        lines.append(" ".join(f"{u} {v} {number}" for u, v, number in seen[k]))
    (model / "images.txt").write_text("\n".join(lines) + "\n")
    body = []
    for number, point in enumerate(points):
        x, y, z = TURN @ point / UNIT
        body.append(f"{number + 1} {x} {y} {z} 0 0 0 0.1 {' '.join(tracks[number])}")
    (model / "points3D.txt").write_text("\n".join(body) + "\n")
    return folder


def bent(rgb: np.ndarray) -> np.ndarray:
    """The image of a lens with k1 = 0.1: a pixel at distance r (1 + 0.1 r^2) from the middle shows the ray at r."""
    far = CAMERA.rays()[..., :2]
    near = far.copy()
    for _ in range(30):
        near = far / (1.0 + 0.1 * (near**2).sum(-1, keepdims=True))
    columns = np.clip((near[..., 0] * 210 + 160).astype(int), 0, 319)
    rows = np.clip((near[..., 1] * 210 + 90).astype(int), 0, 179)
    return rgb[rows, columns]


@pytest.mark.extended
@pytest.mark.parametrize(("lens", "below"), [("PINHOLE", "sparse/0"), ("SIMPLE_RADIAL", "sparse")])
def test_a_model_becomes_metric_and_upright(tmp_path: pathlib.Path, lens: str, below: str) -> None:
    write_model(tmp_path / "model", lens, below)
    recording = read_colmap(tmp_path / "model", tmp_path / "out", _Oracle(1.3), SOURCE, HEIGHT, rate=2.0)
    assert (recording.id, len(recording), len(recording.registered)) == ("model", 9, 9)
    assert [frame.time_s for frame in recording.frames[:3]] == [0.0, 0.5, 1.0]
    error = trajectory_error(recording.poses(), POSES)
    assert error.rmse < 0.02
    assert error.turn < 0.2
    assert error.scale == pytest.approx(1.0, abs=0.02)
    assert recording.poses()[:, 2, 3] == pytest.approx([HEIGHT] * 9, abs=0.03)
    assert (recording.camera.fx, recording.camera.width, recording.camera.cx) == (210.0, 320, 160.0)
    off = np.abs(recording.rgb(4).astype(int) - _frame(POSES[4])[0])[10:-10, 10:-10]
    assert off.mean() < (0.5 if lens == "PINHOLE" else 6.0)
    depth = recording.depth(4)
    assert depth is not None
    true = _frame(POSES[4])[2]
    known = (true > 0) & (true < 20)
    assert np.median(np.abs(depth - true)[known] / true[known]) < 0.08


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """A sound model; each test spoils a copy of its own."""
    return write_model(tmp_path_factory.mktemp("written") / "model")


def _without_points(folder: pathlib.Path) -> None:
    lines = (folder / "sparse/0/images.txt").read_text().splitlines()
    (folder / "sparse/0/images.txt").write_text("".join(f"{line}\n\n" for line in lines[::2]))
    (folder / "sparse/0/points3D.txt").write_text("")


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (
            lambda p: [(p / "sparse/0" / f"{n}.txt").unlink() for n in ("cameras", "images", "points3D")],
            "no cameras.bin",
        ),
        (lambda p: (p / "images/f3.png").unlink(), "f3.png: found an unreadable image"),
        (lambda p: Image.new("RGB", (64, 36)).save(p / "images/f3.png"), "f3.png: found 64x36 pixels, needed 320x180"),
        (_without_points, "found 0 points on the ground"),
        (lambda p: (p / "sparse/0/points3D.txt").write_text(""), "found 0 points on the ground"),
    ],
)
def test_what_a_model_lacks_is_named(tmp_path: pathlib.Path, written: pathlib.Path, spoil, said: str) -> None:
    spoil(pathlib.Path(shutil.copytree(written, tmp_path / "model")))
    with pytest.raises(ValidationError, match=said):
        read_colmap(tmp_path / "model", tmp_path / "out", _Oracle(1.3), SOURCE, HEIGHT)
    assert not (tmp_path / "out" / "recording.json").exists()


@pytest.mark.parametrize(("name", "content"), [("images", None), ("points3D", b"\xff" * 500)])
def test_a_broken_binary_model_is_one_sentence(
    tmp_path: pathlib.Path, written: pathlib.Path, name: str, content: bytes | None
) -> None:
    """COLMAP's own exception is that of a missing key; a count that is too large it would follow for a minute."""
    import pycolmap  # before Pillow, its zlib breaks Pillow's

    model = pathlib.Path(shutil.copytree(written, tmp_path / "model")) / "sparse/0"
    whole = pycolmap.Reconstruction(str(model))
    for file in model.iterdir():
        file.unlink()
    whole.write(str(model))
    file = model / f"{name}.bin"
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2] if content is None else content)
    with pytest.raises(ValidationError, match="found a model that COLMAP cannot read"):
        read_colmap(tmp_path / "model", tmp_path / "out", _Oracle(1.3), SOURCE, HEIGHT)


def test_large_images_are_reduced_by_averaging(tmp_path: pathlib.Path) -> None:
    """A pattern of single pixels becomes its mean; one pixel of every nine would keep its contrast."""
    import pycolmap  # before Pillow, its zlib breaks Pillow's

    rows, columns = np.mgrid[:1620, :2880]
    pattern = np.where((rows + columns) % 2, 200, 100).astype(np.uint8)
    pattern[:, 1440:] += 50
    Image.fromarray(pattern).save(tmp_path / "large.png")
    lens = pycolmap.Camera(model="PINHOLE", width=2880, height=1620, params=[1890.0, 1890.0, 1440.0, 810.0])
    small = _undistorted(tmp_path / "large.png", lens, Camera(960, 540, 630.0, 630.0, 480.0, 270.0)).astype(int)
    assert small.shape == (540, 960, 3)
    assert np.abs(small[:, :478] - 150).max() < 8
    assert np.abs(small[:, 482:] - 200).max() < 8
    edge = small[:, 478:482].mean((0, 2))
    assert edge[1] < 165
    assert edge[2] > 185, "the edge stays in the middle"


def test_two_images_are_too_few(tmp_path: pathlib.Path) -> None:
    write_model(tmp_path / "model", images=2)
    with pytest.raises(ValidationError, match="found 2 images with a pose, needed at least 3"):
        read_colmap(tmp_path / "model", tmp_path / "out", _Oracle(1.3), SOURCE, HEIGHT)
