"""Metadata of a video and options of its perception."""

import dataclasses


@dataclasses.dataclass(frozen=True)
class VideoOptions:
    """Options of the stages in front of the distillation.

    Attributes:
      rate: frames taken per second.
      camera_height: m above the ground that is walked on: it gives the metric scale.
      perception: model that finds objects: "eye", the built-in one, or "foundation".
      models: folder of the latter.
      blur: detector of faces and plates that are made unreadable before a frame is stored; None: no blurring.
      licence, city, country: of the video, for the records.
    """

    rate: float = 2.0
    camera_height: float = 1.5
    blur: str | None = None
    licence: str = "unknown"
    city: str = "unknown"
    country: str = "unknown"
    perception: str = "eye"
    models: str | None = None
