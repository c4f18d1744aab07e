"""Checks that a camera moved past near and far objects, before poses are estimated from its frames."""

import dataclasses

import cv2
import numpy as np

from ...datatypes import validation as v
from .frames import Frames


@dataclasses.dataclass(frozen=True)
class ParallaxOptions:
    """Conditions under which frames show no parallax.

    Chosen manually: the upper quartile of the shares is 0.002 for a pan and a zoom over a photograph and 0.010 for a
    turn in a corridor; it is 0.06 along a wall, 0.12 along the corridor, and 0.5 for two sets of photographs.

    Attributes:
      frames: number of frames, evenly spaced, each compared with the later ones in `steps`.
      steps: distances, in frames, of the compared pairs.
      side: pixels, longer side of the frames that are compared; smaller frames are compared as they are.
      min_matches: fewest matches of a pair that is judged.
      min_shift: least median shift of the matches, as a share of the longer side; without it a pair says nothing.
      tolerance: error of matches, as a share of the longer side, as parallax is an angle: in pixels of the compared
        frames a wall in frames of 320 x 180 would have 0.02, and as a share of the width an upright film a third of the
        tolerance of the same film on its side.
      min_pairs: fewest pairs from which anything is concluded.
      min_share: least share of matches off the best homography in the upper quarter of the pairs. A camera that only
        turns or zooms, and any film of a flat image, has 0 but for false matches.
    """

    frames: int = 12
    steps: tuple[int, ...] = (1, 3, 6)
    side: int = 640
    min_matches: int = 60
    min_shift: float = 0.02
    tolerance: float = 2.0 / 640.0
    min_pairs: int = 3
    min_share: float = 0.03


_OPTIONS = ParallaxOptions()


def check_parallax(frames: Frames) -> None:
    """Compares pairs of frames. Frames with too few matches are left to the reconstruction, which names that.

    Raises:
      ValidationError: one homography explains nearly all matches of the pairs.
    """
    shares = parallax_shares(frames)
    if len(shares) >= _OPTIONS.min_pairs and np.quantile(shares, 0.75) < _OPTIONS.min_share:
        flat, pairs = 100.0 * (1.0 - float(np.quantile(shares, 0.75))), v.counted(len(shares), "pairs of frames")
        raise v.fail(
            str(frames.folder),
            f"no parallax (a turn or a flat image explains {flat:.0f} % of the matches in {pairs})",
            "a camera that moves past near and far objects",
            "walk or drive along the street instead of turning, zooming or filming an image",
        )


def parallax_shares(frames: Frames) -> np.ndarray:
    """(p,) for every pair of frames that can be judged, the share of its geometrically consistent matches that are off
    the best homography."""
    starts = np.unique(np.linspace(0, len(frames) - 1, min(_OPTIONS.frames, len(frames))).round().astype(int))
    seen: dict[int, tuple[np.ndarray, np.ndarray]] = {}

    def features(number: int) -> tuple[np.ndarray, np.ndarray]:
        if number not in seen:
            seen[number] = _features(frames.rgb(number))
        return seen[number]

    shares = []
    for first in starts.tolist():
        for step in _OPTIONS.steps:
            if first + step < len(frames):
                share = _off_homography(*features(first), *features(first + step))
                if share is not None:
                    shares.append(share)
    return np.array(shares)


def _features(rgb: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(k, 2) positions as shares of the longer side, and descriptors (k, 128), of SIFT features."""
    factor = _OPTIONS.side / max(rgb.shape[:2])
    grey = cv2.cvtColor(rgb, cv2.COLOR_RGB2GRAY)
    if factor < 1.0:
        grey = cv2.resize(grey, None, fx=factor, fy=factor, interpolation=cv2.INTER_AREA)
    points, descriptors = cv2.SIFT.create(1500).detectAndCompute(grey, None)
    if descriptors is None:
        return np.zeros((0, 2), np.float32), np.zeros((0, 128), np.float32)
    return np.array([p.pt for p in points], np.float32) / max(grey.shape), descriptors


def _off_homography(a: np.ndarray, one: np.ndarray, b: np.ndarray, other: np.ndarray) -> float | None:
    """Share of the consistent matches of two frames that no homography explains; None if they do not tell."""
    if min(len(a), len(b)) < _OPTIONS.min_matches:
        return None
    pairs = cv2.BFMatcher(cv2.NORM_L2).knnMatch(one, other, k=2)
    # Lowe, "Distinctive image features from scale-invariant keypoints", 2004, section 7.1.
    good = [m for m, second in pairs if m.distance < 0.75 * second.distance]
    if len(good) < _OPTIONS.min_matches:
        return None
    p, q = a[[m.queryIdx for m in good]], b[[m.trainIdx for m in good]]
    if np.median(np.linalg.norm(p - q, axis=1)) < _OPTIONS.min_shift:
        return None
    cv2.setRNGSeed(0)
    _, consistent = cv2.findFundamentalMat(p, q, cv2.FM_RANSAC, _OPTIONS.tolerance, 0.999, 2000)
    if consistent is None or consistent.sum() < _OPTIONS.min_matches:
        return None
    kept = consistent.ravel() > 0
    # 1.5 times the tolerance: the fundamental matrix measures errors along one direction alone.
    _, explained = cv2.findHomography(
        p[kept], q[kept], cv2.RANSAC, 1.5 * _OPTIONS.tolerance, maxIters=2000, confidence=0.999
    )
    return None if explained is None else 1.0 - float(explained.mean())
