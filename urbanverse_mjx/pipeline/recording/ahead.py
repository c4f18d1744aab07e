"""Works on the next items of an iterator while the ones before are used."""

import queue
import threading
from collections.abc import Iterator
from types import TracebackType


class Ahead[Item]:
    """Runs an iterator in a thread of its own, which is so many items ahead of whoever takes them; as a context manager
    it ends with the block, as soon as the item that is being made is done.

    Args:
      items: used by that thread alone from then on.
      count: of items that may wait.

    Raises:
      Exception: at the next item, what the iterator raised.
    """

    def __init__(self, items: Iterator[Item], count: int = 1) -> None:
        self._items = items
        self._ready: queue.Queue[tuple[Item] | BaseException | None] = queue.Queue(count)
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run, name="ahead", daemon=True)
        self._thread.start()

    def _run(self) -> None:
        try:
            for item in self._items:
                self._put((item,))
                if self._stopped.is_set():
                    return
            self._put(None)
        except BaseException as error:
            self._put(error)

    def _put(self, item: tuple[Item] | BaseException | None) -> None:
        while not self._stopped.is_set():
            try:
                self._ready.put(item, timeout=0.1)
            except queue.Full:
                continue
            return

    def __iter__(self) -> Iterator[Item]:
        while (found := self._ready.get()) is not None:
            if isinstance(found, BaseException):
                raise found
            yield found[0]

    def __enter__(self) -> "Ahead[Item]":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._stopped.set()
        self._thread.join()
