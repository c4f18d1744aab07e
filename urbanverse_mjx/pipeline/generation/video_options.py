"""Metadata of a video and options of its perception."""

import dataclasses

#: How assets are chosen: by words and descriptors, or by CLIP and DINOv2.
RETRIEVALS = ("built-in", "neural")


@dataclasses.dataclass(frozen=True)
class VideoOptions:
    """Options of the stages before the distillation.

    Attributes:
      rate: frames taken per second.
      camera_height: m above the ground that the camera's carrier walks on, which determines the metric scale.
      perception: model that finds objects: "eye", the built-in one, or "foundation".
      models: folder of the latter's weights.
      detector: of the latter: "owlv2" (with SAM 2) or "sam3".
      second_opinion: published detector whose boxes are fused with the built-in model's objects, "nanodet"; None for
        none.
      blur: detector of faces and plates, which are made unreadable before a frame is stored; None for no blurring.
      focal: mm, 35-mm equivalent focal length of the lens; None for the images' EXIF data, else an estimate.
      allow_truncated: whether a film that ends before its stated length is used as far as it goes.
      licence, city, country: of the video, for the records; the country also for the side of the traffic.
    """

    rate: float = 2.0
    camera_height: float = 1.5
    blur: str | None = None
    licence: str = "unknown"
    city: str = "unknown"
    country: str = "unknown"
    perception: str = "eye"
    models: str | None = None
    allow_truncated: bool = False
    focal: float | None = None
    detector: str = "owlv2"
    second_opinion: str | None = None
