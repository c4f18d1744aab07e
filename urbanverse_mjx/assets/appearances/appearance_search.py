"""Ranks skies and grounds by their thumbnails against crops of a video, as in the paper.

Grounds: pixel-wise mean squared error between crop and thumbnail. Skies: HSV histograms. The thumbnails are stored in
two sheets in the asset index (`ground_thumbnails.jpg`, `sky_thumbnails.jpg`) made by `build_thumbnails`, so ranking
generates no images.
"""

import dataclasses
import functools
import os
import pathlib
from collections.abc import Callable, Iterable, Sequence

import numpy as np
from PIL import Image, UnidentifiedImageError
from scipy import ndimage
from skimage.color import rgb2hsv

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.settings import asset_root

from .collection import Collection, as_filters
from .grounds import GroundRecord, ground_records, paint_ground
from .sky_maps import SkyRecord, paint_sky, sky_records
from .sky_maps.painting import preview, with_disc

#: (height, width) in pixels of a thumbnail; multiples of JPEG's 8-pixel blocks, so that neighbours on a sheet are
#: independent.
GROUND_THUMBNAIL, SKY_THUMBNAIL = (96, 96), (80, 160)
_COLUMNS = 18
#: Side, in pixels, of the images that are compared.
MATCH_SIZE = 32
#: Cells along a side of a ground descriptor: 4 · 4 · 3 mean colours and 4 · 4 contrasts are 64 numbers.
GROUND_CELLS = 4
#: Saturation below which a colour counts as grey; number of value bins of greys, and of hue, saturation and value bins
#: of other colours: 16 + 8 · 3 · 2 = 64 numbers.
_GREY_SATURATION = 0.10
_GREYS, _HUES, _SATURATIONS, _VALUES = 16, 8, (0.10, 0.25, 0.45), 2


def ground_thumbnail(uid: str) -> np.ndarray:
    """Generates the thumbnail (96, 96, 3) uint8 of a ground: the whole tile, lit from above."""
    return _shrunk(paint_ground(uid).preview, GROUND_THUMBNAIL)


def sky_thumbnail(uid: str) -> np.ndarray:
    """Generates the thumbnail (80, 160, 3) uint8 of a sky: the panorama with the sun's disc."""
    sky = paint_sky(uid, 160)
    return _shrunk(preview(with_disc(sky)), SKY_THUMBNAIL)


def _shrunk(image: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    return np.asarray(Image.fromarray(image).resize((size[1], size[0]), Image.Resampling.BOX))


_SHEETS: dict[
    str, tuple[Callable[[], Sequence[GroundRecord | SkyRecord]], Callable[[str], np.ndarray], tuple[int, int]]
]
_SHEETS = {
    "ground_thumbnails.jpg": (ground_records, ground_thumbnail, GROUND_THUMBNAIL),
    "sky_thumbnails.jpg": (sky_records, sky_thumbnail, SKY_THUMBNAIL),
}


def build_thumbnails(
    name: str, folder: str | os.PathLike[str] | None = None, progress: Callable[[Iterable], Iterable] = iter
) -> pathlib.Path:
    """Generates all thumbnails of a sheet (two minutes) and writes it, by default to the asset index."""
    records, paint, size = _SHEETS[v.choice(name, "sheet of thumbnails", _SHEETS)]
    all_of = records()
    sheet = np.zeros((-(-len(all_of) // _COLUMNS) * size[0], _COLUMNS * size[1], 3), np.uint8)
    for k, record in enumerate(progress(all_of)):
        row, column = k // _COLUMNS * size[0], k % _COLUMNS * size[1]
        sheet[row : row + size[0], column : column + size[1]] = paint(record.uid)
    target = pathlib.Path(folder) / name if folder else asset_root() / name
    return v.write_atomically(
        target, lambda p: Image.fromarray(sheet).save(p, "JPEG", quality=82, subsampling=0, optimize=True)
    )


@functools.cache
def _sheet(name: str) -> dict[str, np.ndarray]:
    """uid -> thumbnail, from the stored sheet.

    Raises:
      ValidationError: the sheet is missing, damaged, or does not fit the table.
    """
    records, _, (height, width) = _SHEETS[name]
    path = asset_root() / name
    cure = "`python -m urbanverse_mjx.assets.previews.appearance_sheets thumbnails` builds it"
    if not path.is_file():
        raise v.fail(name, "no file", "the sheet of thumbnails", cure)
    try:
        image = np.asarray(Image.open(path).convert("RGB"))
    except (OSError, UnidentifiedImageError) as error:
        raise v.fail(name, f"no whole image ({error})", "the sheet of thumbnails", cure) from error
    uids = [record.uid for record in records()]
    needed = (-(-len(uids) // _COLUMNS) * height, _COLUMNS * width)
    if image.shape[:2] != needed:
        raise v.fail(name, f"an image of {image.shape[:2]}", f"one of {needed}", cure)
    cells = image.reshape(-1, height, _COLUMNS, width, 3).swapaxes(1, 2).reshape(-1, height, width, 3)
    return dict(zip(uids, cells, strict=False))


@dataclasses.dataclass(frozen=True)
class StoredSheet:
    """The thumbnails of a sheet in the asset index, by its file's name."""

    name: str

    def load(self, uids: Sequence[str]) -> np.ndarray:
        """Thumbnails (n, h, w, 3) uint8.

        Raises:
          ValidationError: the sheet is missing, damaged, or does not fit the table.
        """
        return np.stack([_sheet(self.name)[uid] for uid in uids])

    def problems(self) -> list[str]:
        """A sentence about the fault of the file, if any."""
        _sheet.cache_clear()
        try:
            _sheet(self.name)
        except ValidationError as error:
            return [str(error)]
        return []

    def repair(self) -> None:
        """Generates the sheet again (about two minutes)."""
        build_thumbnails(self.name)
        _sheet.cache_clear()


_GROUND_FILTERS = as_filters(
    {
        "families": ("family", "words", "what it is laid of"),
        "materials": ("matter", "words", "row of the table of materials"),
        "colors": ("colour", "words", "colour of the dry surface"),
        "conditions": ("condition_group", "words", "weather, wear and repair"),
        "tile_size_range": ("tile_size_m", "range", "side of the tile, m"),
        "friction_coefficient_range": ("friction", "range", "static friction of a hard sole or tyre"),
    }
)
_SKY_FILTERS = as_filters(
    {
        "seasons": ("season", "words", "season"),
        "times": ("time", "words", "time of day"),
        "kinds": ("kind", "words", "kind of sky"),
        "weathers": ("weather", "words", "narrower kind"),
        "horizons": ("horizon", "words", "distant silhouette at the horizon"),
        "sun_elevation_range": ("sun_elevation", "range", "height of the sun (at night of the moon), degrees"),
        "turbidity_range": ("turbidity", "range", "haze: 1 pure air, 6 smog"),
        "cover_range": ("cover", "range", "share of the sky under clouds"),
        "snow": ("snow", "flag", "whether the land is white"),
    }
)
_SAID = {"uid": "name that stays the same over versions", "description": "one sentence, written from the other fields"}
_GROUND_MEANINGS = _SAID | {
    "kind": "road or sidewalk",
    "condition": "name of the weather or wear; `conditions` asks for the wider word",
    "unit_m": "spacing of bricks, slabs ... along u and v, m; nothing where there are none or lengths vary",
    "friction_reason": "how the friction follows from the dry material and the condition",
}
_SKY_MEANINGS = _SAID | {
    "sun_azimuth": "direction of the sun (at night of the moon), degrees counter-clockwise from +x; drawn from the uid",
    "exposure": "brightness of a white surface on the image, 0 to 1; of the time of day, darker under rain clouds",
}
_GROUND_LEVELS, _SKY_LEVELS = ("family", "matter"), ("kind", "weather")
_GROUND_SHEET, _SKY_SHEET = StoredSheet("ground_thumbnails.jpg"), StoredSheet("sky_thumbnails.jpg")
road, sidewalk = (
    Collection(
        f"{kind} material", ground_records(kind), _GROUND_LEVELS, _GROUND_FILTERS, _GROUND_MEANINGS, _GROUND_SHEET
    )
    for kind in ("road", "sidewalk")
)
sky = Collection("sky", sky_records(), _SKY_LEVELS, _SKY_FILTERS, _SKY_MEANINGS, _SKY_SHEET)


def library(name: str) -> Collection:
    """The collection "sky", "road" or "sidewalk".

    Raises:
      ValidationError: another name.
    """
    collections = {"sky": sky, "road": road, "sidewalk": sidewalk}
    return collections[v.choice(name, "collection", collections)]


@functools.cache
def _flat_grounds(kind: str) -> tuple[list[str], np.ndarray]:
    """Uids, and (n, 32 · 32 · 3) float32 pixels in [0, 1] of their thumbnails."""
    uids = [record.uid for record in ground_records(kind)]
    thumbnails = _sheet("ground_thumbnails.jpg")
    pixels = [_shrunk(thumbnails[uid], (MATCH_SIZE, MATCH_SIZE)).ravel() for uid in uids]
    return uids, np.stack(pixels).astype(np.float32) / 255.0


def rank_grounds(crops: np.ndarray | Sequence[np.ndarray], kind: str) -> list[tuple[str, float]]:
    """All materials of a kind by pixel-wise mean squared error against crops of the ground, best first.

    Args:
      crops: one or more (h, w, 3) uint8 sRGB images of only ground; each is scaled to 32 x 32 pixels, and the errors
        are averaged.
      kind: "road" or "sidewalk".

    Returns:
      (uid, mean squared error in [0, 1]).

    Raises:
      ValidationError: there is no crop, a crop has another shape, or the kind is unknown.
    """
    uids, thumbnails = _flat_grounds(v.choice(kind, "kind of ground", ("road", "sidewalk")))
    flat = np.stack([_shrunk(c, (MATCH_SIZE, MATCH_SIZE)).ravel() for c in _checked(crops)]).astype(np.float32) / 255.0
    # |a - b|^2 = |a|^2 - 2 ab + |b|^2, all pairs at once.
    squares = (flat**2).sum(1)[:, None] - 2 * flat @ thumbnails.T + (thumbnails**2).sum(1)[None, :]
    errors = squares.mean(0) / flat.shape[1]
    return [(uids[i], max(float(errors[i]), 0.0)) for i in np.argsort(errors, kind="stable")]


def ground_descriptor(crops: np.ndarray | Sequence[np.ndarray]) -> tuple[int, ...]:
    """Descriptor of crops of the ground: 64 8-bit numbers, the format of `GroundRegion.descriptor`.

    Each crop becomes 32 x 32 pixels, then 4 x 4 cells: 48 mean colours, and 16 times the standard deviation of the
    cell's luminance (doubled, at most 255), which measures the visible roughness independently of where the joints lie.
    Several crops are averaged: the errors |a - t|^2 of several crops a against one thumbnail t are that of their mean
    plus a term that does not depend on t.
    """
    cells = np.mean([_cells(crop) for crop in _checked(crops)], axis=0)
    return tuple(int(x) for x in np.round(np.clip(cells, 0.0, 255.0)))


def ground_crop_descriptor(crop: np.ndarray, mask: np.ndarray) -> tuple[int, ...]:
    """`ground_descriptor` of the largest square of an image (H, W, 3) uint8 that lies within a mask (H, W).

    Raises:
      ValidationError: an empty mask.
    """
    _checked(crop)
    padded = np.pad(np.asarray(mask, bool), 1)
    reach = ndimage.distance_transform_cdt(padded, "chessboard")[1:-1, 1:-1]
    if reach.max() < 1:
        raise v.fail("mask of the ground", "no pixel", "at least one")
    row, column = np.unravel_index(int(reach.argmax()), reach.shape)
    half = int(reach[row, column]) - 1
    return ground_descriptor(crop[row - half : row + half + 1, column - half : column + half + 1])


def _cells(crop: np.ndarray) -> np.ndarray:
    """(64,) see `ground_descriptor`."""
    small = _shrunk(crop, (MATCH_SIZE, MATCH_SIZE)).astype(np.float64)
    step = MATCH_SIZE // GROUND_CELLS
    cells = small.reshape(GROUND_CELLS, step, GROUND_CELLS, step, 3)
    contrast = (cells @ (0.2126, 0.7152, 0.0722)).std((1, 3))  # Rec. 709
    return np.concatenate([cells.mean((1, 3)).ravel(), 2.0 * contrast.ravel()])


@functools.cache
def _ground_descriptors(kind: str) -> tuple[list[str], np.ndarray]:
    uids = [record.uid for record in ground_records(kind)]
    thumbnails = _sheet("ground_thumbnails.jpg")
    return uids, np.array([ground_descriptor(thumbnails[uid]) for uid in uids], np.float64)


def ground_errors(descriptor: Sequence[int] | np.ndarray, others: np.ndarray) -> np.ndarray:
    """(n,) mean squared error in [0, 1] of a ground descriptor against (n, 64) others.

    Raises:
      ValidationError: not 64 numbers.
    """
    wanted = np.asarray(descriptor, np.float64)
    if wanted.shape != (64,):
        raise v.fail("ground descriptor", f"{wanted.shape} numbers", "64 numbers as `ground_descriptor` makes them")
    return ((np.asarray(others, np.float64) - wanted) ** 2).mean(-1) / 255.0**2


def rank_ground_descriptors(descriptor: Sequence[int] | np.ndarray, kind: str) -> list[tuple[str, float]]:
    """All materials of a kind by mean squared error against a `ground_descriptor`, best first: (uid, error in [0, 1]).

    Raises:
      ValidationError: not 64 numbers, or a kind other than "road" and "sidewalk".
    """
    uids, table = _ground_descriptors(v.choice(kind, "kind of ground", ("road", "sidewalk")))
    errors = ground_errors(descriptor, table)
    return [(uids[i], float(errors[i])) for i in np.argsort(errors, kind="stable")]


def _checked(crops: np.ndarray | Sequence[np.ndarray]) -> list[np.ndarray]:
    several = [crops] if isinstance(crops, np.ndarray) and crops.ndim == 3 else list(crops)
    if not several:
        raise v.fail("crops", "none", "at least one image")
    for crop in several:
        if not (isinstance(crop, np.ndarray) and crop.ndim == 3 and crop.shape[2] == 3 and crop.dtype == np.uint8):
            found = f"{crop.dtype} {crop.shape}" if isinstance(crop, np.ndarray) else v.show(crop)
            raise v.fail("crop", found, "a (h, w, 3) uint8 image")
    return several


def sky_descriptor(crops: np.ndarray | Sequence[np.ndarray]) -> tuple[int, ...]:
    """HSV histogram of crops of the sky: 64 8-bit numbers, the format of `SceneGraph.sky_descriptor`.

    16 value bins for nearly grey pixels, then 8 hues x 3 saturations x 2 values; each number is 255 times the square
    root of the bin's share (the Hellinger distance compares square roots).
    """
    bins = np.zeros(64)
    for crop in _checked(crops):
        bins += _hsv_shares(_shrunk(crop, (64, 128)).reshape(-1, 3))
    return _roots(bins)


def sky_crop_descriptor(crop: np.ndarray, mask: np.ndarray) -> tuple[int, ...]:
    """`sky_descriptor` of the pixels of an image (H, W, 3) uint8 within a mask (H, W).

    Only the upper half of the rows that the mask touches is used, as the paper uses the upper half of frames, because
    at the end of a street the sky extends down to haze and distant land.

    Raises:
      ValidationError: an empty mask.
    """
    _checked(crop)
    mask = np.asarray(mask, bool)
    rows = np.flatnonzero(mask.any(1))
    if not len(rows):
        raise v.fail("mask of the sky", "no pixel", "at least one")
    upper = slice(rows[0], rows[0] + max(1, (rows[-1] + 1 - rows[0]) // 2))
    return _roots(_hsv_shares(crop[upper][mask[upper]]))


def _hsv_shares(pixels: np.ndarray) -> np.ndarray:
    """(64,) shares of (n, 3) uint8 pixels in the bins of `sky_descriptor`."""
    hue, saturation, value = rgb2hsv(pixels[None])[0].T
    grey = np.minimum((value * _GREYS).astype(int), _GREYS - 1)
    deep = np.digitize(saturation, _SATURATIONS[1:])
    colour = (np.minimum((hue * _HUES).astype(int), _HUES - 1) * 3 + deep) * _VALUES + (value >= 0.6)
    counts = np.bincount(np.where(saturation < _GREY_SATURATION, grey, _GREYS + colour), minlength=64)
    return counts / counts.sum()


def _roots(shares: np.ndarray) -> tuple[int, ...]:
    return tuple(int(x) for x in np.round(np.sqrt(shares / shares.sum()) * 255))


@functools.cache
def _sky_descriptors() -> tuple[list[str], np.ndarray]:
    uids = [record.uid for record in sky_records()]
    thumbnails = _sheet("sky_thumbnails.jpg")
    # A street camera shows the sky up to about 45 degrees, which is the lower half of the upper half.
    half = SKY_THUMBNAIL[0] // 2
    return uids, np.array([sky_descriptor(thumbnails[uid][half // 2 : half]) for uid in uids], np.float64)


def own_ground_descriptor(uid: str) -> tuple[int, ...]:
    """The descriptor for which a material of the collection ("road/...", "sidewalk/...") ranks first.

    Raises:
      ValidationError: no such material.
    """
    uids, table = _ground_descriptors(v.choice(uid.partition("/")[0], "kind of ground", ("road", "sidewalk")))
    return tuple(int(x) for x in table[list(uids).index(v.choice(uid, "ground material", uids))])


def own_sky_descriptor(uid: str) -> tuple[int, ...]:
    """The descriptor for which a sky of the collection ranks first: that of its part in a street camera's image.

    Raises:
      ValidationError: no such sky.
    """
    uids, table = _sky_descriptors()
    return tuple(int(x) for x in table[uids.index(v.choice(uid, "sky", uids))])


def rank_skies(descriptor: Sequence[int]) -> list[tuple[str, float]]:
    """All skies by Hellinger distance of HSV histograms, best first: (uid, distance in [0, 1]).

    Args:
      descriptor: 64 numbers from `sky_descriptor`.

    Raises:
      ValidationError: not 64 numbers.
    """
    wanted = np.asarray(descriptor, np.float64)
    if wanted.shape != (64,) or not wanted.any():
        raise v.fail("sky descriptor", f"{wanted.shape} numbers", "64 numbers of which some are above 0")
    uids, table = _sky_descriptors()
    overlap = (table / np.linalg.norm(table, axis=1, keepdims=True)) @ (wanted / np.linalg.norm(wanted))
    distance = np.sqrt(np.clip(1.0 - overlap, 0.0, 1.0))
    return [(uids[i], float(distance[i])) for i in np.argsort(distance, kind="stable")]
