"""Balls of sports, their seams painted on a sphere, and the round objects beside them."""

from collections.abc import Callable, Sequence

import numpy as np
from PIL import Image
from scipy.spatial.transform import Rotation

from ....meshes.mesh_builder import BuiltAsset, MeshBuilder
from ....meshes.palette import Color, rgb
from ....meshes.recipe import recipe
from ...shared.sizes import varied

WIDTH, HEIGHT = 192, 96  # pixels of a sphere's image; a seam is two to four of them wide
Painter = Callable[[np.ndarray], np.ndarray]


def directions() -> np.ndarray:
    """(HEIGHT, WIDTH, 3) unit vectors that the pixels of a sphere's image look along, row 0 at the top."""
    longitude = (np.arange(WIDTH) + 0.5) / WIDTH * 2 * np.pi
    latitude = (0.5 - (np.arange(HEIGHT) + 0.5) / HEIGHT) * np.pi
    lat, lon = np.meshgrid(latitude, longitude, indexing="ij")
    return np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], -1)


def painted(ground: Color, layers: Sequence[tuple[Color, np.ndarray]]) -> Image.Image:
    """A sphere's image: the ground, then each colour where its mask of (HEIGHT, WIDTH) in [0, 1] is set."""
    pixels = np.broadcast_to(np.array(rgb(ground), float), (HEIGHT, WIDTH, 3)).copy()
    for color, mask in layers:
        share = np.clip(mask, 0.0, 1.0)[..., None]
        pixels = pixels * (1 - share) + np.array(rgb(color), float) * share
    return Image.fromarray(pixels.round().astype(np.uint8), "RGB")


def line(distance: np.ndarray, half: float) -> np.ndarray:
    """A soft mask where |distance| < half (rad), a pixel wide at its edge."""
    return np.clip(0.5 + (half - np.abs(distance)) / (np.pi / HEIGHT), 0.0, 1.0)


def sphere(b: MeshBuilder, image: Image.Image, radius: float = 0.1, columns: int = 22, rows: int = 14) -> None:
    """A painted sphere about a plain one that closes it, standing on z = 0."""
    lat = np.linspace(-np.pi / 2, np.pi / 2, rows + 1)
    lon = np.linspace(0, 2 * np.pi, columns + 1)
    la, lo = np.meshgrid(lat, lon, indexing="ij")
    grid = radius * np.stack([np.cos(la) * np.cos(lo), np.cos(la) * np.sin(lo), np.sin(la)], -1)
    b.sheet(grid + [0, 0, radius], image=image)
    # Seams of an image leave the sheet open, so that it encloses no volume; the ball inside gives the volume.
    b.ball(0.985 * radius, (0, 0, radius), "dark grey", segments=columns, rings=rows)


def _tilted(points: np.ndarray, degrees: float) -> np.ndarray:
    """Directions in the frame of a ball rolled by a small angle, so that no seam is vertical."""
    return points @ Rotation.from_euler("xyz", (degrees, 0.6 * degrees, 0.4 * degrees), degrees=True).as_matrix().T


def _basketball(p: np.ndarray) -> np.ndarray:
    """Two great circles and two curves that lean away from the third."""
    x, y, z = p[..., 0], p[..., 1], p[..., 2]
    circles = np.maximum(line(np.arcsin(x), 0.03), line(np.arcsin(z), 0.03))
    curved = line(np.arcsin(np.clip(np.abs(y) - 0.5 - 0.42 * z**2, -1, 1)), 0.032)
    return np.maximum(circles, curved)


def _icosahedron() -> np.ndarray:
    g = (1 + 5**0.5) / 2
    corners = [(0, s, t * g) for s in (-1, 1) for t in (-1, 1)]
    points = np.array([np.roll(c, k) for c in corners for k in range(3)], float)
    return points / np.linalg.norm(points[0])


def _football(p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(black pentagons, seams) of the truncated icosahedron: 12 pentagons about its corners, hexagons between."""
    corners = _icosahedron()
    angle = np.arccos(np.clip(p @ corners.T, -1, 1))
    order = np.sort(angle, axis=-1)
    nearest = corners[np.argmin(angle, axis=-1)]
    # Towards each of the five neighbours the pentagon's edge lies where the corner's third of the edge was cut off.
    reach = np.full(p.shape[:2], -1.0)
    for corner in corners:
        along = corner - nearest * np.sum(nearest * corner, -1, keepdims=True)
        size = np.linalg.norm(along, axis=-1)
        neighbour = np.abs(np.sum(nearest * corner, -1) - 1 / 5**0.5) < 1e-6
        projected = np.sum(p * along, -1) / np.maximum(size, 1e-9) / np.maximum(np.sum(p * nearest, -1), 1e-9)
        reach = np.maximum(reach, np.where(neighbour, projected, -1.0))
    edge = np.arctan(reach) - 0.345
    pentagon = 0.5 - edge / (np.pi / HEIGHT)
    seam = line((order[..., 1] - order[..., 0]) / 2, 0.012) * (pentagon < 0.5)
    return pentagon, seam


def _folded_seam(count: int) -> np.ndarray:
    """(count, 3) unit vectors along the one closed seam of a tennis ball or a baseball.

    (1 - a) e^it + a e^-3it in the plane and 2 sqrt(a (1 - a)) sin 2t above it lie on the unit sphere for every a in
    (0, 1); a = 0.44 leaves the narrow waists of a real cover.
    """
    a, t = 0.44, np.arange(count) * (2 * np.pi / count)
    x, y = (1 - a) * np.cos(t) + a * np.cos(3 * t), (1 - a) * np.sin(t) - a * np.sin(3 * t)
    return np.stack([x, y, 2 * (a * (1 - a)) ** 0.5 * np.sin(2 * t)], 1)


def _tennis_curve(p: np.ndarray, half: float) -> np.ndarray:
    """A soft mask within `half` rad of the folded seam."""
    nearest = np.arccos(np.clip((p.reshape(-1, 3) @ _folded_seam(240).T).max(1), -1, 1)).reshape(p.shape[:2])
    return line(nearest, half)


def _stitches(p: np.ndarray) -> np.ndarray:
    """Short strokes along both sides of a baseball's seam, which has 108 double stitches."""
    beside = np.maximum(_tennis_curve(p, 0.1) - _tennis_curve(p, 0.03), 0)
    which = np.argmax(p.reshape(-1, 3) @ _folded_seam(108).T, 1).reshape(p.shape[:2])
    return beside * (which % 2 == 0)


def _volleyball(p: np.ndarray, inks: Sequence[Color]) -> list[tuple[Color, np.ndarray]]:
    """Six faces of a cube, each of three strips, neighbours crossing each other."""
    axis = np.argmax(np.abs(p), -1)
    across = (
        np.take_along_axis(p, ((axis + 1) % 3)[..., None], -1)[..., 0]
        / np.take_along_axis(np.abs(p), axis[..., None], -1)[..., 0]
    )
    strip = np.digitize(across, [-0.36, 0.36])
    order = np.sort(np.abs(p), -1)
    face_seam = line((order[..., 2] - order[..., 1]) / 2**0.5, 0.02)
    strip_seam = np.maximum(line((across - 0.36) * 0.8, 0.018), line((across + 0.36) * 0.8, 0.018))
    layers = [(inks[k], ((strip + axis) % 3 == k).astype(float)) for k in range(len(inks))]
    return [*layers, ("dark grey", np.maximum(face_seam, strip_seam))]


def _ball(
    rng: np.random.Generator, image: Image.Image, across: float, words: str, style: str, rough: float
) -> BuiltAsset:
    b = MeshBuilder(roughness=rough)
    sphere(b, image)
    return varied(b, rng, (across, across, across), words, style, jitter=0.0)


@recipe("basketball", 3, hulls=1, name="balls.basketball")
def basketball(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Orange, brown leather, red-white-blue."""
    p = _tilted(directions(), 18.0)
    style = ("orange", "brown leather", "three-coloured")[variant]
    layers: list[tuple[Color, np.ndarray]] = [("black", _basketball(p))]
    if variant == 2:
        sector = np.floor(np.arctan2(p[..., 2], p[..., 0]) / (np.pi / 2)).astype(int) % 3
        layers = [("signal red", (sector == 0) * 1.0), ("signal blue", (sector == 1) * 1.0), *layers]
    ground: Color = ("#d8742a", "#8a4a24", "white")[variant]
    return _ball(rng, painted(ground, layers), (0.243, 0.24, 0.2445)[variant], f"a basketball, {style}", style, 0.7)


@recipe("football", 3, hulls=1, name="balls.football")
def football(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """White with black pentagons, yellow with blue ones, white with red ones: balls of association football."""
    p = _tilted(directions(), 11.0)
    pentagon, seam = _football(p)
    ground, patch = (("white", "black"), ("signal yellow", "dark blue"), ("white", "signal red"))[variant]
    style = f"{ground} and {patch}"
    image = painted(ground, [("grey", seam), (patch, pentagon)])
    return _ball(rng, image, (0.22, 0.2165, 0.2225)[variant], f"a football, {style}", style, 0.5)


@recipe("volleyball", 3, hulls=1, name="balls.volleyball")
def volleyball(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """White, yellow and blue, white with red and green."""
    p = _tilted(directions(), 24.0)
    inks: tuple[Color, ...] = (
        ("white", "off white", "white"),
        ("signal yellow", "signal blue", "signal yellow"),
        ("white", "signal red", "green"),
    )[variant]
    style = ("white", "yellow and blue", "white, red and green")[variant]
    return _ball(
        rng, painted("white", _volleyball(p, inks)), (0.21, 0.207, 0.213)[variant], f"a volleyball, {style}", style, 0.6
    )


@recipe("baseball", 2, hulls=1, name="balls.baseball")
def baseball(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """New white ball, scuffed one; red stitches along the seam."""
    p = _tilted(directions(), 30.0)
    style = ("new", "scuffed")[variant]
    layers: list[tuple[Color, np.ndarray]] = [("light grey", _tennis_curve(p, 0.014)), ("signal red", _stitches(p))]
    if variant == 1:
        waves = rng.normal(0.0, 5.0, (8, 3))
        dirt = np.cos(np.einsum("hwc,kc->hwk", p, waves) + rng.uniform(0, 2 * np.pi, 8)).sum(-1)
        layers.insert(0, ("brown", 0.4 * np.clip(dirt - 1.2, 0.0, 1.0)))
    return _ball(rng, painted("white", layers), (0.0738, 0.0748)[variant], f"a {style} baseball", style, 0.7)


@recipe("sports ball", 3, hulls=1, name="balls.sports_ball")
def sports_ball(variant: int, rng: np.random.Generator) -> BuiltAsset:
    """Handball in two colours, tennis ball, bowling ball with its three holes."""
    style = ("handball", "tennis ball", "bowling ball")[variant]
    p = _tilted(directions(), 26.0)
    if style == "handball":
        pentagon, seam = _football(p)
        image = painted("light blue", [("dark blue", seam), ("signal red", pentagon)])
    elif style == "tennis ball":
        image = painted("#cfe23c", [("white", _tennis_curve(p, 0.05))])
    else:
        swirl = 0.5 + 0.5 * np.sin(6 * p[..., 0] + 4 * np.sin(5 * p[..., 2]) + 3 * p[..., 1])
        holes = np.zeros((HEIGHT, WIDTH))
        for hole in ((0.86, -0.05, 0.5), (0.86, 0.17, 0.48), (0.76, 0.08, 0.65)):
            at = np.array(hole) / np.linalg.norm(hole)
            holes = np.maximum(holes, line(np.arccos(np.clip(directions() @ at, -1, 1)), 0.09))
        image = painted("dark blue", [("purple", 0.7 * swirl), ("black", holes)])
    return _ball(rng, image, (0.15, 0.066, 0.217)[variant], f"a {style}", style, (0.6, 0.95, 0.15)[variant])
