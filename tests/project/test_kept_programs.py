"""Compiled programs of the tests: what is used stays, and the folder does not grow without end."""

import os
import pathlib

from tests.support.kept_programs import remove_least_recent


def test_what_was_read_last_is_kept(tmp_path: pathlib.Path) -> None:
    for name, read, written in (("old", 1, 1), ("read", 9, 1), ("new", 1, 8), ("middle", 5, 5)):
        path = tmp_path / f"jit_{name}-cache"
        path.write_bytes(bytes(100))
        os.utime(path, (read, written))
    (tmp_path / "other").write_bytes(bytes(1000))

    def left() -> set[str]:
        return {path.name for path in tmp_path.iterdir()}

    everything = left()
    remove_least_recent(tmp_path, 400)
    assert left() == everything
    remove_least_recent(tmp_path, 399)
    assert left() == everything - {"jit_old-cache"}
    remove_least_recent(tmp_path, 250)
    assert left() == {"jit_read-cache", "jit_new-cache", "other"}
    remove_least_recent(tmp_path / "absent", 0)
