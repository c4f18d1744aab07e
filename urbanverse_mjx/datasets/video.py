"""H.264 encoding with ffmpeg: one process per episode, then joined into mp4 files without encoding again."""

import errno
import pathlib
import signal
import subprocess
import threading
from collections.abc import Iterable, Sequence
from typing import IO

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


def encode(frames: Iterable[np.ndarray], height: int, width: int, frames_per_second: int) -> bytes:
    """H.264 bytes of frames (H, W, 3) u8, or of parts (t, H, W, 3).

    There are no B-frames, so that videos can be joined by appending bytes.

    Raises:
      ValidationError: ffmpeg failed.
    """
    raw = ("-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", str(frames_per_second))
    # One thread, so that the bytes do not depend on the machine's number of cores.
    codec = ("-c:v", "libx264", "-preset", "veryfast", "-crf", str(_CRF), "-threads", "1", "-bf", "0")
    form = ("-g", str(KEYFRAME_EVERY), "-pix_fmt", pixel_format(height, width), "-f", "h264", "pipe:1")
    done = _piped((*raw, "-i", "pipe:0", *codec, *form), (np.ascontiguousarray(frame).data for frame in frames))
    if done.returncode != 0:
        said = done.stderr.decode(errors="replace").strip()
        raise ValidationError(f"video: found an ffmpeg that failed ({said}), needed one with libx264.")
    return done.stdout


def _piped(arguments: Sequence[str], parts: Iterable[bytes | memoryview]) -> subprocess.CompletedProcess[bytes]:
    """Runs ffmpeg with parts of an input. Unlike `subprocess.run`, which cuts the input into pieces of 4 kB, it leaves
    other threads of Python at work."""
    pipe = subprocess.PIPE
    # In a process group of its own: Ctrl-C in a terminal ends the recording, which still writes what it has.
    with subprocess.Popen(_ffmpeg(*arguments), stdin=pipe, stdout=pipe, stderr=pipe, process_group=0) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        assert process.stderr is not None
        # Output is read while the input is written; otherwise a pipe fills up and blocks.
        found = [b"", b""]
        readers = [
            threading.Thread(target=_read, args=(stream, found, k), name="video", daemon=True)
            for k, stream in enumerate((process.stdout, process.stderr))
        ]
        for reader in readers:
            reader.start()
        try:
            for part in parts:
                process.stdin.write(part)
            process.stdin.close()
        except BrokenPipeError:
            pass  # Its exit status and its messages say why.
        except BaseException:
            process.kill()
            raise
        for reader in readers:
            reader.join()
    return subprocess.CompletedProcess(arguments, process.returncode, found[0], found[1])


def _read(stream: IO[bytes], found: list[bytes], k: int) -> None:
    found[k] = stream.read()


def write_mp4(path: pathlib.Path, encoded: Sequence[bytes], frames_per_second: int) -> None:
    """Writes H.264 bytes, joined, as an mp4 in which frame k is shown at k / frames_per_second s.

    Raises:
      OSError: the disk is full, or the file exceeds a size limit.
      ValidationError: ffmpeg failed for another reason.
    """
    source = ("-f", "h264", "-framerate", str(frames_per_second), "-i", "pipe:0")
    # Omits ffmpeg's version from the file.
    target = ("-c", "copy", "-fflags", "+bitexact", "-movflags", "+faststart", "-f", "mp4", "-y", str(path))
    done = _piped((*source, *target), encoded)
    said = done.stderr.decode(errors="replace").strip()
    if done.returncode == -signal.SIGXFSZ or "File too large" in said:
        raise OSError(errno.EFBIG, "File too large", str(path))
    if "No space left" in said:
        raise OSError(errno.ENOSPC, "No space left on device", str(path))
    if done.returncode != 0:
        raise ValidationError(f"{path}: found an ffmpeg that failed ({said}), needed one that writes mp4.")


def read_encoded(path: pathlib.Path, count: int) -> bytes:
    """The H.264 bytes of the first `count` frames of a file of `write_mp4`, the same as were written.

    Raises:
      ValidationError: ffmpeg cannot read it.
    """
    form = ("-map", "0:v:0", "-c", "copy", "-frames:v", str(count), "-bsf:v", "h264_mp4toannexb", "-f", "h264")
    done = subprocess.run(_ffmpeg("-i", str(path), *form, "pipe:1"), capture_output=True, check=False)
    if done.returncode != 0 or not done.stdout:
        said = (done.stderr.decode(errors="replace").strip().splitlines() or ["no video in it"])[-1]
        raise ValidationError(f"{path}: found a file that ffmpeg cannot read ({said}), needed a video.")
    return done.stdout


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
