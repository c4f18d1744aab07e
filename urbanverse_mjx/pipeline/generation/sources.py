"""Sources of `urbanverse gen`: a scene graph, a recording, a folder of frames, a video, or a photograph."""

import dataclasses
import hashlib
import pathlib

from PIL import Image

from ...datatypes import Recording, SceneGraph
from ...datatypes import validation as v
from ...datatypes.recording import FILE as RECORDING_FILE
from ...datatypes.recording import IMAGE_SUFFIXES, UNREADABLE

#: Streams of JPEG images, which begin like a single one.
_STREAM_SUFFIXES = (".mjpeg", ".mjpg")


@dataclasses.dataclass(frozen=True)
class Input:
    """A source: its kind ("graph", "recording", "frames", "video" or "photograph"), its path, and a key of its
    content."""

    kind: str
    path: pathlib.Path
    key: str


def recognise(source: str | pathlib.Path) -> Input:
    """Determines the kind of a source and makes all cheap checks.

    Raises:
      ValidationError: the source does not exist or is none of the kinds, or its graph or recording is invalid.
    """
    path = pathlib.Path(source).expanduser().absolute()
    if path.is_dir() and (path / RECORDING_FILE).is_file():
        recording = Recording.load(path)
        images = [path / name for f in recording.frames for name in (f.rgb, f.depth, f.masks, f.surfaces) if name]
        return Input("recording", path, _key(path / RECORDING_FILE, *images))
    if path.is_dir():
        frames = sorted(p for p in path.iterdir() if p.suffix.lower() in IMAGE_SUFFIXES)
        if not frames:
            found = "a folder without recording.json and without an image"
            raise v.fail(str(path), found, "a recording or frames", "name a video, a folder or graph.json")
        return Input("frames", path, _key(*frames))
    if not path.is_file():
        raise v.fail(str(path), "nothing", "a video, a folder of frames, a recording or graph.json", "check the path")
    if path.suffix.lower() == ".json":
        return Input("graph", path, SceneGraph.load(path).content_hash()[:16])
    if path.stat().st_size == 0:
        raise v.fail(str(path), "an empty file", "a video", "copy it again")
    content = _image_format(path)
    if content is not None:
        if path.suffix.lower() not in IMAGE_SUFFIXES:
            known = f".{content.lower()}" in IMAGE_SUFFIXES
            single = f"call the photograph {path.stem}.{content.lower()}" if known else "convert the photograph to PNG"
            hint = f"name the film, or {single} to make cousins of it alone"
            raise v.fail(str(path), f"a single {content} image", "a video", hint)
        return Input("photograph", path, _key(path))
    return Input("video", path, _key(path))


def _image_format(path: pathlib.Path) -> str | None:
    """The format (PNG, JPEG, ...) of an image, whatever the file is called; None for other files, and for videos whose
    first image Pillow reads: MPEG and MJPEG streams, animated GIF."""
    if path.suffix.lower() in _STREAM_SUFFIXES:
        return None
    try:
        with Image.open(path) as image:
            moving = image.format == "MPEG" or (image.format == "GIF" and getattr(image, "is_animated", False))
            return None if moving else image.format
    except UNREADABLE:
        return None


def _key(*files: pathlib.Path) -> str:
    """Hash of 16 hexadecimal digits over the contents of files, in this order.

    Raises:
      ValidationError: a file does not exist or cannot be read.
    """
    digest = hashlib.sha256()
    for path in files:
        try:
            with path.open("rb") as file:
                digest.update(hashlib.file_digest(file, "sha256").digest())
        except OSError as error:
            raise v.fail(str(path), str(error.strerror), "a file that can be read", "check its rights") from error
    return digest.hexdigest()[:16]
