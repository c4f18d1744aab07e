"""Computes statistics of features as LeRobot stores them, per episode and merged over episodes.

Source: huggingface/lerobot, `src/lerobot/datasets/compute_stats.py`.
"""

from collections.abc import Mapping

import cv2
import numpy as np

#: Stored quantiles: name -> share.
QUANTILES = {"q01": 0.01, "q10": 0.10, "q50": 0.50, "q90": 0.90, "q99": 0.99}
Stats = dict[str, np.ndarray]


def of_numbers(rows: np.ndarray) -> Stats:
    """Returns statistics (D,) of (T, D) or (T,) numbers; count is (1,)."""
    rows = rows.reshape(len(rows), -1).astype(np.float64)
    body = {"min": rows.min(0), "max": rows.max(0), "mean": rows.mean(0), "std": rows.std(0)}
    quantiles = np.quantile(rows, list(QUANTILES.values()), axis=0)
    return {**body, "count": np.array([len(rows)]), **dict(zip(QUANTILES, quantiles, strict=True))}


def of_columns(columns: Mapping[str, np.ndarray]) -> dict[str, Stats]:
    """Returns `of_numbers` of each of several columns (T, ...) with the same T, computed together, which is faster."""
    flat = [np.asarray(column, np.float64).reshape(len(column), -1) for column in columns.values()]
    edges = np.cumsum([0, *(column.shape[1] for column in flat)])
    together = of_numbers(np.concatenate(flat, axis=1))
    return {
        name: {key: x if key == "count" else x[edges[k] : edges[k + 1]] for key, x in together.items()}
        for k, name in enumerate(columns)
    }


class PixelCounts:
    """Histograms of integer images, from which statistics by channel are computed.

    Args:
      channels: number of channels of the images.
      values: number of possible pixel values.
    """

    def __init__(self, channels: int, values: int) -> None:
        self._counts = np.zeros((channels, values), np.int64)
        self._images = 0

    def add(self, image: np.ndarray) -> None:
        """Counts an image (H, W, C) u8 or u16 of at most 2^24 pixels."""
        values = self._counts.shape[1]
        for channel, counts in enumerate(self._counts):
            # Unlike np.bincount, it leaves other threads of Python at work.
            found = cv2.calcHist([image], [channel], None, [values], [0, values])
            counts += found.ravel().astype(np.int64)
        self._images += 1

    def stats(self, scale: float) -> Stats:
        """Returns statistics (C, 1, 1) of the values divided by `scale`; count is the number of images, (1,)."""
        values = np.arange(self._counts.shape[1]) / scale
        total = self._counts.sum(1, keepdims=True)
        mean = self._counts @ values / total[:, 0]
        square = self._counts @ values**2 / total[:, 0]
        below = np.cumsum(self._counts, axis=1) / total
        body = {
            "min": values[(below > 0).argmax(1)],
            "max": values[(below >= 1.0).argmax(1)],
            "mean": mean,
            "std": np.sqrt(np.maximum(square - mean**2, 0.0)),
            **{name: values[(below >= share).argmax(1)] for name, share in QUANTILES.items()},
        }
        shaped = {name: x.reshape(-1, 1, 1) for name, x in body.items()}
        return {**shaped, "count": np.array([self._images])}


def merged(first: Mapping[str, np.ndarray], second: Mapping[str, np.ndarray]) -> Stats:
    """Returns the statistics of two parts together, exact except for quantiles, which the parts' quantiles do not
    determine.

    As in LeRobot's recorder, quantiles up to the median are the smaller of the two values, those above the larger.
    """
    counts = first["count"], second["count"]
    total = counts[0] + counts[1]
    mean = (first["mean"] * counts[0] + second["mean"] * counts[1]) / total
    spread = [(s["std"] ** 2 + (s["mean"] - mean) ** 2) * n for s, n in zip((first, second), counts, strict=True)]
    body = {
        "min": np.minimum(first["min"], second["min"]),
        "max": np.maximum(first["max"], second["max"]),
        "mean": mean,
        "std": np.sqrt((spread[0] + spread[1]) / total),
        "count": total,
    }
    for name, share in QUANTILES.items():
        body[name] = (np.minimum if share <= 0.5 else np.maximum)(first[name], second[name])
    return body
