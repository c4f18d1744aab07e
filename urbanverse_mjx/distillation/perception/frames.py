"""Samples frames of one size from a video or a folder of images and leaves out unusable ones."""

import collections
import dataclasses
import itertools
import os
import pathlib
import struct
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import cv2
import numpy as np
from PIL import Image, ImageOps

from ...datatypes import validation as v
from ...datatypes.recording import IMAGE_SUFFIXES, UNREADABLE
from .privacy import Blur
from .screening import Measures, ScreenLimits, measure, screen, turned

FILE = "frames.json"
#: Marker file in a folder whose frames are not complete.
_UNFINISHED = ".unfinished-frames"
SCHEMA = "urbanverse.frames/1"

#: EXIF 2.3, section 4.6: the sub-directory of camera settings, and in it FocalLengthIn35mmFilm (mm, 0 = unknown).
_EXIF, _FOCAL_35MM = 0x8769, 0xA405
#: mm, 35-mm equivalents of the focal lengths that the reconstruction accepts (`MappingOptions`).
FOCAL_RANGE = (10.0, 75.0)
#: Ratio up to which stated focal lengths are those of one lens without zoom.
_SAME_LENS = 1.05
#: Share of its stated length below which a video counts as cut off, and s that have to be missing.
_MIN_SHARE, _MIN_MISSING = 0.95, 0.5


@dataclasses.dataclass(frozen=True)
class SamplingOptions:
    """Options of the sampling.

    Attributes:
      rate: frames per second; of a folder's images, images per second.
      candidates: images of a video that are compared for each frame; the sharpest is kept.
      short_side: pixels; larger images are scaled down to it.
      max_frames: longer videos are sampled at a lower rate; folders with more images are an error.
      allow_truncated: whether a video that ends before its stated length is used as far as it goes.
      limits: thresholds of the screening.
    """

    rate: float = 2.0
    candidates: int = 3
    short_side: int = 540
    max_frames: int = 720
    allow_truncated: bool = False
    limits: ScreenLimits = dataclasses.field(default_factory=ScreenLimits)

    def __post_init__(self) -> None:
        v.number(self.rate, "frames per second", above=0.0, maximum=60.0)
        v.integer(self.candidates, "candidates", 1, 30)
        v.integer(self.short_side, "short side", 64, 4096)
        v.integer(self.max_frames, "max frames", 2, 100_000)


@dataclasses.dataclass(frozen=True)
class Frames:
    """Frames on disk.

    Attributes:
      folder: of the images.
      names: PNG files in it.
      time_s: s of each since the video's beginning.
      width, height: pixels of all.
      dropped: time (s) and reason of each frame left out.
      blur: name of the detector of blurred regions, or None without blurring.
      focal: focal length in pixels of these frames that the images' EXIF data state, or None.
    """

    folder: pathlib.Path
    names: tuple[str, ...]
    time_s: tuple[float, ...]
    width: int
    height: int
    dropped: tuple[tuple[float, str], ...] = ()
    blur: str | None = None
    focal: float | None = None

    def __len__(self) -> int:
        return len(self.names)

    def rgb(self, index: int) -> np.ndarray:
        """(H, W, 3) u8."""
        with Image.open(self.folder / self.names[index]) as image:
            return np.asarray(image.convert("RGB"))

    def lost(self) -> str:
        """A clause for messages about the dropped frames."""
        counts = collections.Counter(reason for _, reason in self.dropped)
        return ", ".join(f"{n} {reason}" for reason, n in counts.most_common()) or "none"

    def to_json(self) -> dict[str, Any]:
        body = dataclasses.asdict(self)
        return {"schema": SCHEMA, **{k: x for k, x in body.items() if k != "folder"}}


def sample(
    source: str | os.PathLike[str],
    folder: pathlib.Path,
    options: SamplingOptions | None = None,
    blur: Blur | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Frames:
    """Writes the usable frames of a video or of a folder of images, and `frames.json`.

    Args:
      source: a video of any container that FFmpeg (inside OpenCV) reads, or a folder of images in the order of
        their names.
      folder: is created, and emptied of earlier frames.
      blur: makes faces and plates unreadable before anything is written.

    Raises:
      ValidationError: no video, one that ends early, no images, images of different sizes, fewer than two usable
        frames, or no write access.
    """
    options = options or SamplingOptions()
    source = pathlib.Path(source)
    groups, total = _folder(source, options) if source.is_dir() else _video(source, options)
    _empty(folder)
    names, times, measures, turns = [], [], [], []
    before: Measures | None = None
    for k, group in enumerate(groups):
        seen = [measure(rgb) for _, rgb in group]
        pairs = itertools.pairwise([before, *seen] if before is not None else seen)
        # The sum of image shifts between neighbouring candidates is the share that left the view.
        turns.append(sum(turned(a, b) for a, b in pairs))
        before = seen[-1]
        best = int(np.argmax([m.sharpness for m in seen]))
        measures.append(seen[best])
        times.append(round(group[best][0], 4))
        names.append(f"{k:06d}.png")
        rgb = group[best][1]
        Image.fromarray(rgb if blur is None else blur(rgb)).save(folder / names[-1], compress_level=3)
        if progress is not None:
            progress(k + 1, max(total, k + 1))
    reasons = screen(measures, turns, options.limits)
    kept = [k for k, reason in enumerate(reasons) if reason is None]
    for k in set(range(len(names))) - set(kept):
        (folder / names[k]).unlink()
    dropped = tuple((times[k], reason) for k, reason in enumerate(reasons) if reason is not None)
    if len(kept) < 2:
        lost = collections.Counter(reason for _, reason in dropped)
        found = f"{len(kept)} usable frames of {len(names)} ({', '.join(f'{n} {r}' for r, n in lost.items()) or 'all'})"
        raise v.fail(str(source), found, "at least two", "film longer, in daylight, while you walk")
    with Image.open(folder / names[kept[0]]) as image:
        width, height = image.size
    frames = Frames(
        folder,
        tuple(names[k] for k in kept),
        tuple(times[k] for k in kept),
        width,
        height,
        dropped,
        None if blur is None else blur.name,
        _stated_focal(source, width, height) if source.is_dir() else None,
    )
    v.write_json(folder / FILE, frames.to_json())
    (folder / _UNFINISHED).unlink()
    return frames


def photograph(
    source: pathlib.Path, folder: pathlib.Path, options: SamplingOptions | None = None, blur: Blur | None = None
) -> Frames:
    """Writes a single image as the only frame, upright and scaled like frames of a video, and `frames.json`.

    Raises:
      ValidationError: the image cannot be read, is too dark or has no contrast, or there is no write access.
    """
    options = options or SamplingOptions()
    try:
        with Image.open(source) as image:
            stated = _stated_equivalent(image)
            rgb = _scaled(np.asarray(ImageOps.exif_transpose(image).convert("RGB")), options.short_side)
    except UNREADABLE as error:
        raise v.fail(str(source), f"an unreadable image ({error})", "a whole one", "copy it again") from error
    seen = measure(rgb)
    if seen.bright < options.limits.dark or seen.sharpness < options.limits.flat:
        found = "a dark image" if seen.bright < options.limits.dark else "an image without detail"
        raise v.fail(str(source), found, "a street in daylight", "take another photograph")
    _empty(folder)
    Image.fromarray(rgb if blur is None else blur(rgb)).save(folder / "000000.png")
    height, width = rgb.shape[:2]
    focal = None if stated is None else round(focal_pixels(stated, width, height), 3)
    name = None if blur is None else blur.name
    frames = Frames(folder, ("000000.png",), (0.0,), width, height, (), name, focal)
    v.write_json(folder / FILE, frames.to_json())
    (folder / _UNFINISHED).unlink()
    return frames


def load(folder: pathlib.Path) -> Frames:
    """Frames that `sample` wrote.

    Raises:
      ValidationError: no record, or one of another version.
    """
    names = [f.name for f in dataclasses.fields(Frames) if f.name != "folder"]
    body = dict(v.mapping(v.read_json(folder / FILE, "frames"), FILE, ["schema", *names]))
    v.choice(body.pop("schema"), "schema", (SCHEMA,))
    tuples = {name: tuple(body[name]) for name in ("names", "time_s")}
    dropped = tuple((time, reason) for time, reason in body["dropped"])
    return Frames(**{**body, **tuples, "folder": folder, "dropped": dropped})


def focal_pixels(equivalent: float, width: int, height: int) -> float:
    """Focal length in pixels of an image of `width` x `height` pixels.

    Args:
      equivalent: mm, focal length with the same diagonal angle on film of 36 x 24 mm (CIPA DCG-001).
    """
    return equivalent * float(np.hypot(width, height) / np.hypot(36.0, 24.0))


def _stated_focal(folder: pathlib.Path, width: int, height: int) -> float | None:
    """pixels, the focal length by the EXIF data of a folder's images; None where an image has none, they differ, or it
    is outside `FOCAL_RANGE`: some programs write the true focal length instead of the equivalent."""
    stated = []
    for file in _images_of(folder):
        with Image.open(file) as image:
            equivalent = _stated_equivalent(image)
        if equivalent is None:
            return None
        stated.append(equivalent)
    if not stated or max(stated) > _SAME_LENS * min(stated):
        return None
    usual = float(np.median(stated))
    if not FOCAL_RANGE[0] <= usual <= FOCAL_RANGE[1]:
        return None
    return round(focal_pixels(usual, width, height), 3)


def _stated_equivalent(image: Image.Image) -> float | None:
    """mm, 35-mm equivalent focal length by the EXIF data of an image; None where it is absent, 0 or no number."""
    try:
        equivalent = float(image.getexif().get_ifd(_EXIF)[_FOCAL_35MM])
    except (KeyError, TypeError, ValueError, struct.error, *UNREADABLE):
        return None
    return equivalent if 0.0 < equivalent < np.inf else None


def _images_of(folder: pathlib.Path) -> list[pathlib.Path]:
    return sorted(path for path in folder.iterdir() if path.suffix.lower() in IMAGE_SUFFIXES)


Group = Sequence[tuple[float, np.ndarray]]


def _video(path: pathlib.Path, options: SamplingOptions) -> tuple[Iterator[Group], int]:
    """Groups of neighbouring images, one group per frame, and their approximate number."""
    video = _opened(path)
    fps, count = video.get(cv2.CAP_PROP_FPS), video.get(cv2.CAP_PROP_FRAME_COUNT)
    duration = count / fps if fps > 0 and count > 0 else 0.0
    rate = min(options.rate, fps or options.rate, options.max_frames / duration if duration > 0 else options.rate)
    each = max(1, min(options.candidates, int(fps / rate))) if fps > 0 else 1
    stated = None if options.allow_truncated else _Stated(path, round(count), duration)
    images = itertools.islice(_images(video, rate * each, options.short_side, stated), options.max_frames * each)
    return _grouped(images, each), min(options.max_frames, max(1, round(duration * rate)))


def _opened(path: pathlib.Path) -> cv2.VideoCapture:
    if not path.is_file():
        raise v.fail(str(path), "no such file", "a video or a folder of images", "check the path")
    video = cv2.VideoCapture(str(path), cv2.CAP_FFMPEG)
    if not video.isOpened():
        if _lacks_index(path):
            found = "an MP4 without its index (moov), as a recording that was cut off leaves behind"
            raise v.fail(str(path), found, "the whole file", "copy it again, or repair it")
        raise v.fail(str(path), "something that OpenCV reads no image from", "a video", "play it to check")
    return video


def _lacks_index(path: pathlib.Path) -> bool:
    """Whether a file consists of boxes of an MP4 (ISO/IEC 14496-12, section 4.2) but the one that finds the images."""
    found, end = [], path.stat().st_size
    with path.open("rb") as file:
        while file.tell() + 8 <= end:
            start = file.tell()
            size, kind = struct.unpack(">I4s", file.read(8))
            if size == 1 and start + 16 <= end:
                (size,) = struct.unpack(">Q", file.read(8))
            found.append(kind)
            if size < 8 or size > end - start:  # 0: to the end of the file
                break
            file.seek(start + size)
    return found[:1] == [b"ftyp"] and b"moov" not in found


@dataclasses.dataclass(frozen=True)
class _Stated:
    """What a video's header says of it: number of images, and duration in s; 0 if it says nothing."""

    path: pathlib.Path
    images: int
    duration: float

    def check(self, images: int, end: float) -> None:
        """Compares with the images that could be decoded, the last of which ends at `end` s.

        Both have to fall short: where a header has no number of images, it is the duration times the mean rate, and the
        times of some containers are those of decoding.

        Raises:
          ValidationError: the video is cut off.
        """
        short = _MIN_SHARE * self.duration > end and self.duration - end > _MIN_MISSING
        if short and images < _MIN_SHARE * self.images:
            found = f"{end:.1f} of the {self.duration:.1f} s that its header states"
            hint = f"copy it again, or do without the missing {self.duration - end:.1f} s by --allow-truncated"
            raise v.fail(str(self.path), found, "the whole film", hint)


def _images(
    video: cv2.VideoCapture, rate: float, short_side: int, stated: _Stated | None = None
) -> Iterator[tuple[float, np.ndarray]]:
    """Yields time (s) and RGB of the images nearest to every 1 / `rate` s; images in between are decoded and
    dropped.

    Raises:
      ValidationError: the video ends before its stated length.
    """
    period = 1.0 / (video.get(cv2.CAP_PROP_FPS) or rate)
    first, time, due, count = None, -period, 0, 0
    try:
        while video.grab():
            count += 1
            stamp = video.get(cv2.CAP_PROP_POS_MSEC) / 1000.0
            first = stamp if first is None else first
            # Time stamps of AVI are those of decoding: all are late by the same time, and 0 at the end of the file.
            time = stamp - first if stamp - first > time else time + period
            if (time + period / 2) * rate < due:
                continue
            due = int((time + period / 2) * rate) + 1
            whole, bgr = video.retrieve()
            if whole:
                yield time, _scaled(cv2.cvtColor(bgr, cv2.COLOR_BGR2RGB), short_side)
        if stated is not None:
            stated.check(count, time + period)
    finally:
        video.release()


def _scaled(rgb: np.ndarray, short_side: int) -> np.ndarray:
    """An image (H, W, 3) u8 reduced to a shorter side of at most `short_side` px by area averaging."""
    height, width = rgb.shape[:2]
    factor = short_side / min(height, width)
    if factor >= 1.0:
        return rgb
    return cv2.resize(rgb, (round(width * factor), round(height * factor)), interpolation=cv2.INTER_AREA)


def _grouped(images: Iterator[tuple[float, np.ndarray]], each: int) -> Iterator[Group]:
    while group := list(itertools.islice(images, each)):
        yield group


def _folder(path: pathlib.Path, options: SamplingOptions) -> tuple[Iterator[Group], int]:
    files = _images_of(path)
    if not files:
        raise v.fail(str(path), "no image", f"files ending in {', '.join(IMAGE_SUFFIXES)}", "check the path")
    if len(files) > options.max_frames:
        raise v.fail(str(path), f"{len(files)} images", f"at most {options.max_frames}", "leave out some")

    def images() -> Iterator[Group]:
        size = None
        for k, file in enumerate(files):
            try:
                with Image.open(file) as image:
                    rgb = ImageOps.exif_transpose(image).convert("RGB")
            except UNREADABLE as error:
                raise v.fail(str(file), f"an unreadable image ({error})", "a whole one", "leave it out") from error
            size = size or rgb.size
            if rgb.size != size:
                needed = "{}x{} as the first has".format(*size)
                raise v.fail(str(file), "{}x{} pixels".format(*rgb.size), needed, "scale it")
            yield [(k / options.rate, _scaled(np.asarray(rgb), options.short_side))]

    return images(), len(files)


def _empty(folder: pathlib.Path) -> None:
    """Makes a folder, and removes earlier frames there; images that are not known to be frames are an error."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        earlier = list(folder.glob("[0-9]" * 6 + ".png"))
        if earlier and not any((folder / name).is_file() for name in (FILE, _UNFINISHED)):
            raise v.fail(str(earlier[0]), "an image that is no frame", "a new folder for the frames", "choose another")
        (folder / _UNFINISHED).touch()
        for old in [*earlier, folder / FILE]:
            old.unlink(missing_ok=True)
    except OSError as error:
        raise v.fail(str(folder), f"no way to write there ({error.strerror})", "a folder to write into") from error
