"""Drawn episodes become videos and image files, in threads of their own while the next ones are driven and drawn."""

import collections
import concurrent.futures
import dataclasses
import itertools
import threading
from collections.abc import Callable, Iterable, Mapping, Sequence
from types import TracebackType

import cv2
import numpy as np

from ...datasets.annotations import Annotation
from ...datasets.statistics import PixelCounts, Stats
from ...datasets.video import encode
from .boxes import Boxes
from .cameras import FRONT, MOST, SENSORS, Drawn, as_colours, numbered
from .driving import Driven
from .lidar import LIDAR, Lidar

#: Images of which pixels are counted for the statistics: every fourth.
_STATISTICS_STRIDE = 4
#: Bytes of images that may wait: drawn ones to be encoded, and encoded ones to be written.
_MAX_WAITING = 512 * 2**20


@dataclasses.dataclass(frozen=True)
class Filmed:
    """A driven episode and its images: H.264 bytes, PNG files by feature, statistics by feature, and annotations, one a
    frame, if any. colours: image files of each frame, and scans: points (n, 3) m of each, for formats of single frames,
    which have none of the first three."""

    driven: Driven
    video: bytes
    images: dict[str, list[bytes]]
    stats: dict[str, Stats]
    annotations: list[Annotation]
    colours: list[bytes] = dataclasses.field(default_factory=list)
    scans: list[np.ndarray] = dataclasses.field(default_factory=list)

    @property
    def nbytes(self) -> int:
        """Of images and scans."""
        files = itertools.chain(*self.images.values(), self.colours)
        return len(self.video) + sum(map(len, files)) + sum(scan.nbytes for scan in self.scans)


@dataclasses.dataclass(frozen=True)
class Encoding:
    """How episodes are encoded.

    Attributes:
      rate: frames a second.
      sensors: of `SENSORS`, besides colour.
      colours: "h264", or "png" or "jpg" for a file a frame.
      lidar: None where no scans are stored as points.
      boxes: annotates every frame; None for no annotations.
    """

    rate: int
    sensors: Sequence[str]
    colours: str = "h264"
    lidar: Lidar | None = None
    boxes: Boxes | None = None

    def __call__(self, driven: Driven, drawn: Drawn) -> Filmed:
        """Encodes an episode."""
        annotations: list[Annotation] = []
        if self.boxes is not None:
            seen = zip(*(itertools.chain.from_iterable(drawn[name]) for name in ("object", "coverage")), strict=True)
            annotations = [self.boxes.annotate(driven, step, *images) for step, images in enumerate(seen)]
        rgb = drawn["rgb"]
        if self.colours != "h264":
            files = [image_file(image, self.colours) for part in rgb for image in part]
            scans = [self.lidar.points(x) for part in drawn["lidar"] for x in part] if self.lidar is not None else []
            return Filmed(driven, b"", {}, {}, annotations, files, scans)
        images, stats = {}, {FRONT: _statistics(itertools.chain.from_iterable(rgb), 3, 256, 255.0)}
        for sensor in self.sensors:
            name, output, offset = SENSORS[sensor]
            normal = sensor == "normal"
            own = [as_colours(x) if normal else numbered(x, offset) for part in drawn[output] for x in part]
            images[name] = [image_file(image, "png") for image in own]
            scale = 1.0 if name in (SENSORS["depth"][0], LIDAR) else 255.0
            stats[name] = _statistics(own, 3 if normal else 1, 256 if normal else MOST + 1, scale)
        height, width = rgb[0].shape[1:3]
        return Filmed(driven, encode(rgb, height, width, self.rate), images, stats, annotations)


def image_file(image: np.ndarray, kind: str) -> bytes:
    """A file of an image (H, W, 3) u8 RGB or (H, W); kind: png, or jpg of high quality."""
    form = (".jpg", [cv2.IMWRITE_JPEG_QUALITY, 95]) if kind == "jpg" else (".png", [])
    done, body = cv2.imencode(form[0], image[..., ::-1] if image.ndim == 3 else image, form[1])
    assert done
    return body.tobytes()


def _statistics(images: Iterable[np.ndarray], channels: int, values: int, scale: float) -> Stats:
    """As LeRobot has them: colours and labels divided by 255, distances as they are."""
    counts = PixelCounts(channels, values)
    for image in itertools.islice(images, 0, None, _STATISTICS_STRIDE):
        counts.add(np.ascontiguousarray(image))
    return counts.stats(scale)


@dataclasses.dataclass
class _Entry:
    """An episode that waits; size: bytes of its images."""

    size: int
    filmed: concurrent.futures.Future[Filmed] | None = None


class EpisodeWriting:
    """Encodes episodes in several threads and writes them in their order in one; as a context manager it ends when all
    of them are written, whatever ended the block.

    Args:
      encode: an episode, of its own alone.
      write: takes encoded episodes in their order.
      threads: that encode.
      waiting: bytes from which `add` waits, of images that are drawn, or encoded, and not yet written.

    Raises:
      Exception: at the next `add`, or at the end, what `encode` or `write` raised; later episodes are dropped.
    """

    def __init__(
        self,
        encode: Callable[[Driven, Drawn], Filmed],
        write: Callable[[Filmed], None],
        threads: int,
        waiting: int = _MAX_WAITING,
    ) -> None:
        self._encode, self._write, self._most = encode, write, waiting
        self._pool = concurrent.futures.ThreadPoolExecutor(threads, "encode")
        self._changed = threading.Condition()
        self._queue: collections.deque[_Entry] = collections.deque()
        self._bytes, self._closed = 0, False
        self._error: BaseException | None = None
        self._writer = threading.Thread(target=self._run, name="write", daemon=True)
        self._writer.start()

    def add(self, driven: Driven, drawn: Mapping[str, list[np.ndarray]]) -> None:
        """Takes an episode; waits while too much is under way."""
        size = sum(part.nbytes for parts in drawn.values() for part in parts)
        with self._changed:
            self._changed.wait_for(lambda: self._error or not self._bytes or self._bytes + size <= self._most)
            if self._error is not None:
                raise self._error
            self._bytes += size
            entry = _Entry(size)
            entry.filmed = self._pool.submit(self._encoded, entry, driven, dict(drawn))
            self._queue.append(entry)
            self._changed.notify_all()

    def _encoded(self, entry: "_Entry", driven: Driven, drawn: Drawn) -> Filmed:
        """Encodes an episode, which then takes less memory."""
        filmed = self._encode(driven, drawn)
        with self._changed:
            self._bytes += filmed.nbytes - entry.size
            entry.size = filmed.nbytes
            self._changed.notify_all()
        return filmed

    def wait(self) -> None:
        """Waits until everything that was added is written."""
        with self._changed:
            self._changed.wait_for(lambda: self._error or not self._queue)
            if self._error is not None:
                raise self._error

    def _run(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._queue or self._closed)
                if not self._queue:
                    return
                entry = self._queue[0]
            try:
                if self._error is None and entry.filmed is not None:
                    self._write(entry.filmed.result())
            except BaseException as error:
                self._error = error
            with self._changed:
                self._queue.popleft()
                self._bytes -= entry.size
                self._changed.notify_all()

    def __enter__(self) -> "EpisodeWriting":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        with self._changed:
            self._closed = True
            self._changed.notify_all()
        try:
            self._writer.join()
        except BaseException as second:
            # A second Ctrl-C: the episode that is being written is the last.
            self._error = second
            self._writer.join()
            raise
        self._pool.shutdown(cancel_futures=True)
        if self._error is not None and error is None:
            raise self._error
