"""H.264 encoding with ffmpeg: one process per episode, then joined into mp4 files without encoding again."""

import errno
import pathlib
import signal
import subprocess
import threading

import imageio_ffmpeg
import numpy as np

from ..datatypes import ValidationError

#: Every second frame is a key frame, as in LeRobot, because readers decode single frames.
KEYFRAME_EVERY = 2
_CRF = 23


def pixel_format(height: int, width: int) -> str:
    """Returns yuv420p, which every player reads, or yuv444p for an odd side, which chroma subsampling does not
    allow."""
    return "yuv444p" if height % 2 or width % 2 else "yuv420p"


def _ffmpeg(*arguments: str) -> list[str]:
    return [imageio_ffmpeg.get_ffmpeg_exe(), "-hide_banner", "-loglevel", "error", *arguments]


class Encoder:
    """Encodes frames of one size as they arrive, without B-frames, so that files can be joined by appending bytes.

    Args:
      height, width: pixels.
      frames_per_second: of the video.
    """

    def __init__(self, height: int, width: int, frames_per_second: int) -> None:
        raw = ("-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", str(frames_per_second))
        # One thread, so that the bytes do not depend on the machine's number of cores.
        codec = ("-c:v", "libx264", "-preset", "veryfast", "-crf", str(_CRF), "-threads", "1", "-bf", "0")
        form = ("-g", str(KEYFRAME_EVERY), "-pix_fmt", pixel_format(height, width), "-f", "h264", "pipe:1")
        pipe = subprocess.PIPE
        self._process = subprocess.Popen(
            _ffmpeg(*raw, "-i", "pipe:0", *codec, *form), stdin=pipe, stdout=pipe, stderr=pipe
        )
        self._parts: list[bytes] = []
        # The output is read while frames are written; otherwise a pipe fills up and blocks.
        self._reader = threading.Thread(target=self._read, name="video", daemon=True)
        self._reader.start()

    def _read(self) -> None:
        assert self._process.stdout is not None
        self._parts.append(self._process.stdout.read())

    def write(self, frame: np.ndarray) -> None:
        """Adds a frame (H, W, 3) u8."""
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(np.ascontiguousarray(frame).tobytes())
        except BrokenPipeError:
            raise self._failure() from None

    def close(self) -> None:
        """Closes the input; the encoder finishes in the background."""
        assert self._process.stdin is not None
        try:
            self._process.stdin.close()
        except BrokenPipeError:
            raise self._failure() from None

    def result(self) -> bytes:
        """Waits for the encoder and returns the H.264 bytes.

        Raises:
          ValidationError: ffmpeg failed.
        """
        self._reader.join()
        if self._process.wait() != 0:
            raise self._failure()
        self._error_output()
        return b"".join(self._parts)

    def stop(self) -> None:
        """Kills the process."""
        self._process.kill()
        self._process.wait()

    def _error_output(self) -> str:
        assert self._process.stderr is not None
        with self._process.stderr as errors:
            return errors.read().decode(errors="replace").strip()

    def _failure(self) -> ValidationError:
        self._process.wait()
        return ValidationError(f"video: found an ffmpeg that failed ({self._error_output()}), needed one with libx264.")


def write_mp4(path: pathlib.Path, encoded: bytes, frames_per_second: int) -> None:
    """Writes H.264 bytes as an mp4 in which frame k is shown at k / frames_per_second s.

    Raises:
      OSError: the disk is full, or the file exceeds a size limit.
      ValidationError: ffmpeg failed for another reason.
    """
    source = ("-f", "h264", "-framerate", str(frames_per_second), "-i", "pipe:0")
    # Omits ffmpeg's version from the file.
    target = ("-c", "copy", "-fflags", "+bitexact", "-movflags", "+faststart", "-f", "mp4", "-y", str(path))
    done = subprocess.run(_ffmpeg(*source, *target), input=encoded, capture_output=True, check=False)
    said = done.stderr.decode(errors="replace").strip()
    if done.returncode == -signal.SIGXFSZ or "File too large" in said:
        raise OSError(errno.EFBIG, "File too large", str(path))
    if "No space left" in said:
        raise OSError(errno.ENOSPC, "No space left on device", str(path))
    if done.returncode != 0:
        raise ValidationError(f"{path}: found an ffmpeg that failed ({said}), needed one that writes mp4.")


def count_frames(path: pathlib.Path) -> int:
    """Returns the number of frames of a video.

    Raises:
      ValidationError: ffmpeg cannot read it.
    """
    null = ("-map", "0:v:0", "-c", "copy", "-progress", "pipe:1", "-f", "null", "-")
    done = subprocess.run(_ffmpeg("-i", str(path), *null), capture_output=True, text=True, check=False)
    numbers = [line.partition("=")[2] for line in done.stdout.splitlines() if line.startswith("frame=")]
    if done.returncode != 0 or not numbers:
        said = (done.stderr.strip().splitlines() or ["no video in it"])[-1]
        raise ValidationError(f"{path}: found a file that ffmpeg cannot read ({said}), needed a video.")
    return int(numbers[-1])


def read_frames(path: pathlib.Path, count: int, height: int, width: int) -> np.ndarray:
    """The first `count` frames of a video as (count, height, width, 3) u8; another size is averaged by area.

    Raises:
      ValidationError: ffmpeg cannot read it, or it has fewer frames.
    """
    form = ("-vf", f"scale={width}:{height}:flags=area", "-frames:v", str(count), "-f", "rawvideo", "-pix_fmt", "rgb24")
    command = _ffmpeg("-i", str(path), "-map", "0:v:0", *form, "pipe:1")
    done = subprocess.run(command, capture_output=True, check=False)
    found = len(done.stdout) // (height * width * 3)
    if done.returncode != 0 or found < count:
        reason = (done.stderr.decode(errors="replace").strip().splitlines() or [f"{found} frames"])[-1]
        raise ValidationError(f"{path}: found a video of which ffmpeg reads {reason}, needed {count} frames.")
    return np.frombuffer(done.stdout, np.uint8).reshape(found, height, width, 3)[:count]
