"""Features of a LeRobotDataset v3: the contents of one row, and an episode of rows.

Source of names and types: huggingface/lerobot, `src/lerobot/datasets/{utils,feature_utils,dataset_writer}.py`.
"""

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pyarrow as pa

from ..datatypes import validation as v
from .annotations import Annotation

#: The format's version in meta/info.json.
CODEBASE_VERSION = "v3.0"
#: Largest number of files in a folder `chunk-NNN`.
CHUNK_SIZE = 1000
_FILE = "chunk-{chunk_index:03d}/file-{file_index:03d}"
DATA_PATH = f"data/{_FILE}.parquet"
VIDEO_PATH = f"videos/{{video_key}}/{_FILE}.mp4"
EPISODES_PATH = f"meta/episodes/{_FILE}.parquet"
#: Annotations of the rows of the data file of the same number; an addition to the format, which readers ignore.
ANNOTATIONS_PATH = f"annotations/{_FILE}.parquet"
INFO_PATH, STATS_PATH, TASKS_PATH = "meta/info.json", "meta/stats.json", "meta/tasks.parquet"
#: Origin of the recording; an addition to the format, which readers ignore.
ORIGIN_PATH = "meta/urbanverse.json"
#: Folder of incomplete files, outside the folders that readers search.
UNFINISHED = ".unfinished"
IMAGE_AXES = ("height", "width", "channels")


@dataclasses.dataclass(frozen=True)
class Feature:
    """One column of the data, or one camera.

    Attributes:
      dtype: NumPy's name of the type, "video" (frames in an mp4) or "image" (PNG bytes in the parquet file).
      shape: of one row; (H, W, C) of images.
      names: names of its components, or of the axes of an image; None for a scalar.
      info: further keys of the format, such as those of a depth map.
    """

    dtype: str
    shape: tuple[int, ...]
    names: tuple[str, ...] | None = None
    info: Mapping[str, Any] | None = None

    @property
    def is_image(self) -> bool:
        """Whether the feature is a camera, as images or video."""
        return self.dtype in ("video", "image")

    @property
    def is_depth(self) -> bool:
        """Whether the pixels are distances; their statistics keep their unit."""
        return bool((self.info or {}).get("is_depth_map"))

    def to_json(self) -> dict[str, Any]:
        """Returns the feature's entry in meta/info.json."""
        body: dict[str, Any] = {"dtype": self.dtype, "shape": list(self.shape)}
        body["names"] = None if self.names is None else list(self.names)
        return body if self.info is None else body | {"info": dict(self.info)}

    @staticmethod
    def from_json(value: Any, where: str) -> "Feature":
        """Reads an entry of meta/info.json.

        Raises:
          ValidationError: no dtype or shape.
        """
        if not isinstance(value, Mapping) or not {"dtype", "shape"} <= set(value):
            raise v.fail(where, v.show(value), "a feature with dtype and shape")
        names, info = value.get("names"), value.get("info")
        shape = tuple(v.integer(n, f"{where}.shape", 1) for n in v.items(value["shape"], f"{where}.shape", 1))
        known = tuple(names) if isinstance(names, list) else None
        return Feature(v.text(value["dtype"], f"{where}.dtype"), shape, known, info or None)

    @property
    def arrow_type(self) -> pa.DataType:
        """Returns the Arrow type of its column in the data file, as the `datasets` library reads it."""
        if self.dtype == "image":
            return pa.struct([("bytes", pa.binary()), ("path", pa.string())])
        number = pa.from_numpy_dtype(np.dtype(self.dtype))
        return number if self.shape == (1,) else pa.list_(number, self.shape[0])


#: Columns that every dataset has, after its own features.
INDEX_FEATURES = {
    "timestamp": Feature("float32", (1,)),
    "frame_index": Feature("int64", (1,)),
    "episode_index": Feature("int64", (1,)),
    "index": Feature("int64", (1,)),
    "task_index": Feature("int64", (1,)),
}


@dataclasses.dataclass(frozen=True)
class Episode:
    """One episode to be written, T frames long.

    Attributes:
      task: the task in one sentence.
      columns: name -> (T, ...) numbers of each feature that is not an image.
      images: name -> T PNG files, of each "image".
      videos: name -> H.264 bytes of T frames, of each "video".
      image_stats: name -> statistics of images and videos.
      record: further columns of its row in meta/episodes; the same keys in every episode.
      annotations: of every frame, or none; the same in every episode.
    """

    task: str
    columns: Mapping[str, np.ndarray]
    images: Mapping[str, Sequence[bytes]] = dataclasses.field(default_factory=dict)
    videos: Mapping[str, bytes] = dataclasses.field(default_factory=dict)
    image_stats: Mapping[str, Mapping[str, np.ndarray]] = dataclasses.field(default_factory=dict)
    record: Mapping[str, str | int | float] = dataclasses.field(default_factory=dict)
    annotations: Sequence[Annotation] = ()

    def __len__(self) -> int:
        return len(next(iter(self.columns.values())))
