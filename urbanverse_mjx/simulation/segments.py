"""Tables on a Warp device in which pieces of different lengths come and go: each keeps a segment of rows.

In:   arrays on the host, a piece at a time. Out: tables that kernels read, and where a piece begins in them.
When: where scenes are exchanged while an environment is in use.

Rows that nobody reads are filled while kernels may read the others. Tables grow where no gap is long enough; kernels
are told where a table stands at each launch, and pieces stay at their rows.
"""

from collections.abc import Callable, Generator, Iterator, Mapping
from typing import Any

import numpy as np
import warp as wp

#: Share by which a table grows beyond what is needed.
_SPARE = 0.1
#: Bytes that are copied at once.
_PART = 4 << 20


class Segments:
    """Which rows of a table are taken.

    Attributes:
      size: rows of the table.
      taken: first row -> number of rows of each segment.
    """

    def __init__(self) -> None:
        self.size = 0
        self.taken: dict[int, int] = {}

    def take(self, number: int) -> int:
        """The first row of a free segment of `number` rows, in the first gap that is long enough, or at the end, where
        `size` grows."""
        at = 0
        for first in sorted(self.taken):
            if first - at >= number:
                break
            at = first + self.taken[first]
        if number:
            self.taken[at] = number
        if at + number > self.size:
            self.size = at + number + int(_SPARE * (at + number))
        return at

    def give_back(self, first: int) -> None:
        """Frees the segment that begins at a row; of no rows none is kept."""
        self.taken.pop(first, None)


class SegmentTables:
    """Tables of equally many rows on Warp's current device, whose segments stand at the same rows.

    Args:
      kinds: name -> type of an element, and elements in a row.

    Attributes:
      segments: the rows that are taken.
      tables: name -> array.
    """

    def __init__(self, kinds: Mapping[str, tuple[Any, int]]) -> None:
        self.device = wp.get_device()
        self.segments = Segments()
        self._kinds = dict(kinds)
        self.tables = {name: wp.zeros(width, dtype=kind) for name, (kind, width) in self._kinds.items()}
        self._rows = 1

    @property
    def num_bytes(self) -> int:
        """Of all tables."""
        return sum(table.capacity for table in self.tables.values())

    def take(self, number: int) -> int:
        """The first of `number` free rows; the tables may be other arrays afterwards."""
        first = self.segments.take(number)
        if self.segments.size > self._rows:
            for name, (kind, width) in self._kinds.items():
                longer = wp.empty(self.segments.size * width, dtype=kind, device=self.device)
                wp.copy(longer, self.tables[name], count=self._rows * width)
                self.tables[name] = longer
            self._rows = self.segments.size
            wp.synchronize_device(self.device)
        return first

    def write(self, name: str, first: int, values: np.ndarray) -> Iterator[None]:
        """Fills rows of a table from `first` on, a few megabytes at a time.

        Args:
          values: (rows, ...) of the elements' scalars.
        """
        kind, width = self._kinds[name]
        flat = np.ascontiguousarray(values).reshape(-1, *_shape_of(kind))
        at_once = max(_PART // max(flat[:1].nbytes, 1), 1)
        for begin in range(0, len(flat), at_once):
            put(self.tables[name], first * width + begin, flat[begin : begin + at_once])
            yield


def staged(device: Any, parts: Generator[None, None, Callable[[], None]]) -> Generator[None, None, Callable[[], None]]:
    """Goes through the parts of a copy on a Warp device, and returns the function that ends it, which runs there too.

    Between two parts Warp's current device is the caller's.
    """
    while True:
        with wp.ScopedDevice(device):
            try:
                next(parts)
            except StopIteration as done:
                commit: Callable[[], None] = done.value
                break
        yield

    def exchange() -> None:
        with wp.ScopedDevice(device):
            commit()

    return exchange


def _shape_of(kind: Any) -> tuple[int, ...]:
    return tuple(getattr(kind, "_shape_", ()))


def put(table: Any, first: int, values: np.ndarray) -> None:
    """Copies elements to a flat array on any device, and waits until they are there.

    Args:
      values: (n, ...) of its elements' scalars.
    """
    if not len(values):
        return
    if table.device.is_cpu:
        table.numpy()[first : first + len(values)] = values
        return
    host = wp.array(np.ascontiguousarray(values), dtype=table.dtype, device="cpu")
    wp.copy(table, host, dest_offset=first, count=len(values))
    wp.synchronize_device(table.device)


def put_row(table: Any, row: int, values: np.ndarray) -> None:
    """Copies a row of an array with several axes, as `put`."""
    size = int(np.prod(table.shape[1:], dtype=np.int64))
    flat = np.asarray(values).reshape(-1, *_shape_of(table.dtype))
    put(table.flatten(), row * size, flat)
