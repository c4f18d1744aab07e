"""Recordings that are continued after an interruption: the files are those of one that was not interrupted."""

import errno
import fcntl
import functools
import json
import os
import pathlib
from collections.abc import Callable
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from tests.datasets.test_frame_files import RIG, WRITERS
from tests.datasets.test_frame_files import episode as frame_episode
from tests.support import recorded
from tests.support.recorded import FEATURES, RATE
from urbanverse_mjx.datasets import DatasetWriter, Feature, check_dataset, writer
from urbanverse_mjx.datasets.annotations import WITHOUT_VISIBLE, Annotation, SeenObject
from urbanverse_mjx.datasets.features import UNFINISHED, Episode
from urbanverse_mjx.datatypes import ValidationError, validation
from urbanverse_mjx.work_folder import lock_file

COUNT = 5
STILL = (1.0, 0.0, 0.0, 0.0)
SEEN = SeenObject(3, "b", "box", (1, 2, 5, 6), 16, 0.5, (1.0, 1.0, 1.0), (4.0, 0.0, 0.5), STILL, (0.0, 0.0, 4.0), STILL)


@pytest.fixture(autouse=True)
def small_files(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three episodes in a file, and every episode written at once, without waiting for the disk."""
    monkeypatch.setattr(validation, "sync", lambda _: None)
    monkeypatch.setattr(writer, "_FILE_EPISODES", 3)
    monkeypatch.setattr(writer, "_WRITE_EVERY", 0.0)


@functools.cache
def episode(number: int) -> Episode:
    """Episode `number` with annotations; the tasks take turns."""
    plain = recorded.episode(number, 3 + number % 2, f"go {number % 3}")
    seen = [Annotation(f"step {k}", (SEEN,) * (k % 3)) for k in range(len(plain))]
    return Episode(plain.task, plain.columns, plain.images, plain.videos, plain.image_stats, plain.record, seen)


def chosen(numbers: Any, done: int) -> Any:
    """Episodes to be written, given or after those that are done."""
    return numbers(done) if callable(numbers) else numbers


def lerobot(folder: pathlib.Path, numbers: Any, resume: bool = True, **changes: Any) -> None:
    arguments = {"features": FEATURES, "frames_per_second": RATE, "robot": "box", "origin": {"policy": "none"}}
    with DatasetWriter(folder, **{**arguments, **changes}, resume=resume) as out:
        for number in chosen(numbers, out.num_episodes):
            out.add(episode(number))


def frames(form: str) -> Callable[..., None]:
    def write(folder: pathlib.Path, numbers: Any, resume: bool = True, **changes: Any) -> None:
        arguments = {"rig": RIG, "origin": {"policy": "none"}}
        with WRITERS[form](folder, **{**arguments, **changes}, resume=resume) as out:
            for number in chosen(numbers, out.num_episodes):
                out.add(frame_episode(1 + number % 3))

    return write


@pytest.fixture(params=["lerobot", *WRITERS])
def write(request: pytest.FixtureRequest) -> Callable[..., None]:
    if request.param == "mcap":
        pytest.importorskip("foxglove_schemas_protobuf")
        pytest.importorskip("mcap_protobuf")
    return lerobot if request.param == "lerobot" else frames(request.param)


def bytes_of(folder: pathlib.Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def test_the_files_are_those_of_one_writing(write: Callable[..., None], tmp_path: pathlib.Path) -> None:
    """Interrupted after none, some, a full file, and all of the episodes; and continued once more than needed."""
    write(tmp_path / "whole", range(COUNT), resume=False)
    whole = bytes_of(tmp_path / "whole")
    for first in (0, 2, 3, COUNT):
        folder = tmp_path / str(first)
        write(folder, range(first), resume=False)
        write(folder, lambda done: range(done, COUNT))
        assert bytes_of(folder) == whole
    write(tmp_path / "2", [])
    assert bytes_of(tmp_path / "2") == whole


class Killed(OSError):
    """Ends a writer at once, as a full disk does."""


def killed_after(renames: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Lets so many files be replaced."""
    left, replace = iter(range(renames)), pathlib.Path.replace

    def counted(path: pathlib.Path, target: pathlib.Path) -> pathlib.Path:
        if next(left, None) is None:
            raise Killed
        return replace(path, target)

    monkeypatch.setattr(pathlib.Path, "replace", counted)


def test_after_a_kill_between_two_files(write: Callable[..., None], tmp_path: pathlib.Path) -> None:
    """Rows, frames and files behind the last complete episode go away. Every third moment: the files of a
    LeRobotDataset are eight, so that they differ from episode to episode."""
    write(tmp_path / "whole", range(4), resume=False)
    whole, tries = bytes_of(tmp_path / "whole"), 0
    for renames in range(0, 100, 3):
        folder = tmp_path / str(renames)
        with pytest.MonkeyPatch.context() as patch:
            killed_after(renames, patch)
            try:
                write(folder, range(4), resume=False)
            except Killed:
                # What a process leaves that is killed, and not one that ends with an error.
                (folder / UNFINISHED).mkdir(parents=True, exist_ok=True)
            else:
                break
        write(folder, lambda done: range(done, 4))
        assert bytes_of(folder) == whole, renames
        tries += 1
    assert 2 <= tries < 20


def test_a_short_end_leaves_nothing_of_a_killed_writing(tmp_path: pathlib.Path) -> None:
    """Continued without adding any episode."""
    lerobot(tmp_path / "four", range(4), resume=False)
    with pytest.MonkeyPatch.context() as patch:
        # All files of the fifth episode but meta/info.json.
        killed_after(4 * 8 + 7, patch)
        with pytest.raises(Killed):
            lerobot(tmp_path / "new", range(5), resume=False)
    assert check_dataset(tmp_path / "new").notes
    lerobot(tmp_path / "new", [])
    assert bytes_of(tmp_path / "new") == bytes_of(tmp_path / "four")


def refusals() -> list[tuple[Callable[..., None], dict[str, Any], str]]:
    other = {**FEATURES, "action": Feature("float32", (2,), ("a", "b"))}
    policy = r"--resume: found policy 'other', needed 'none' as in .*urbanverse.json; repeat the command"
    return [
        (lerobot, {"features": other}, "--resume: found another action, needed the features of"),
        (lerobot, {"robot": "tug"}, "--resume: found tug at 5 Hz, needed box at 5 Hz"),
        (lerobot, {"frames_per_second": 6}, "--resume: found box at 6 Hz"),
        (lerobot, {"origin": {"policy": "none", "a": {"b": 1}}}, "--resume: found a.b 1, needed None"),
        *((write, {"origin": {"policy": "other"}}, policy) for write in (lerobot, frames("coco"), frames("kitti"))),
    ]


@pytest.mark.parametrize(("write", "changes", "message"), refusals())
def test_another_recording_is_refused_and_left_alone(
    write: Callable[..., None], changes: dict[str, Any], message: str, tmp_path: pathlib.Path
) -> None:
    folder = tmp_path / "new"
    write(folder, range(2), resume=False)
    had = bytes_of(folder)
    with pytest.raises(ValidationError, match=message):
        write(folder, [2], **changes)
    assert bytes_of(folder) == had
    with pytest.raises(ValidationError, match="found a folder that is not empty, needed a new or empty folder"):
        write(folder, [2], resume=False)
    assert bytes_of(folder) == had


def of_policy(place: str, name: str, sha256: str) -> dict[str, Any]:
    return {"policy": place, "policy_content": {"name": name, "sha256": sha256}}


def test_a_policy_is_compared_by_its_content(write: Callable[..., None], tmp_path: pathlib.Path) -> None:
    """The newest policy of a run folder may be another one when the recording is continued."""
    folder = tmp_path / "new"
    write(folder, range(2), resume=False, origin=of_policy("runs/a", "000000000100", "a" * 64))
    had = bytes_of(folder)
    message = (
        r"--resume: found --policy 'runs/a' with the content of '000000000200' \(SHA-256 bbbbbbbbbbbb...\), needed "
        r"that of '000000000100' \(SHA-256 aaaaaaaaaaaa...\) as in .*urbanverse.json; pass --policy the checkpoint"
    )
    with pytest.raises(ValidationError, match=message):
        write(folder, [2], origin=of_policy("runs/a", "000000000200", "b" * 64))
    with pytest.raises(ValidationError, match=r"--resume: found policy 'planner' .*, needed 'runs/a' as in"):
        write(folder, [2], origin={"policy": "planner"})
    assert bytes_of(folder) == had
    # The same one, at another place.
    write(folder, [2], origin=of_policy("copies/b", "b", "a" * 64))
    write(tmp_path / "whole", range(3), resume=False, origin=of_policy("runs/a", "000000000100", "a" * 64))
    assert bytes_of(folder) == bytes_of(tmp_path / "whole")


def without_visible(folder: pathlib.Path) -> None:
    """Makes the annotations those of an earlier version."""
    for path in (folder / "annotations").rglob("*.parquet"):
        stored = pq.ParquetFile(path)
        groups = [stored.read_row_group(k).to_pylist() for k in range(stored.num_row_groups)]
        for row in (row for rows in groups for row in rows):
            row["objects"] = [{key: x for key, x in seen.items() if key != "visible"} for seen in row["objects"]]
        with pq.ParquetWriter(path, WITHOUT_VISIBLE) as out:
            for rows in groups:
                out.write_table(pa.Table.from_pylist(rows, WITHOUT_VISIBLE))


def test_objects_without_a_visible_share_are_sound_but_not_continued(tmp_path: pathlib.Path) -> None:
    """One file that is begun, or one that is full."""
    for count in (2, 3):
        folder = tmp_path / str(count)
        lerobot(folder, range(count), resume=False)
        without_visible(folder)
        had, found = bytes_of(folder), check_dataset(folder)
        assert found.problems == ()
        assert [note.partition(": ")[2][:25] for note in found.notes] == ["objects without `visible`"]
        with pytest.raises(ValidationError, match=r"found objects without `visible`, .* record into another folder"):
            lerobot(folder, [count])
        assert bytes_of(folder) == had


def test_other_versions_are_noted(write: Callable[..., None], tmp_path: pathlib.Path) -> None:
    folder = tmp_path / "new"
    write(folder, range(2), resume=False, origin={"policy": "none", "versions": {"jax": "1"}})
    for version in ("1", "2", "2"):
        write(folder, lambda done: [done], origin={"policy": "none", "versions": {"jax": version}})
    (origin,) = [body for name, body in bytes_of(folder).items() if name.endswith("urbanverse.json")]
    body = json.loads(origin)
    assert body["versions"] == {"jax": "1"}
    assert body["continued"] == [{"episodes": 3, "versions": {"jax": "2"}}]


def test_what_is_no_recording_is_refused(write: Callable[..., None], tmp_path: pathlib.Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(ValidationError, match="needed a recording of this --format, or a new folder"):
        write(tmp_path, [0])
    assert [p.name for p in tmp_path.iterdir()] == ["notes.txt"]


def test_one_process_at_a_time(write: Callable[..., None], tmp_path: pathlib.Path) -> None:
    folder = tmp_path / "new"
    write(folder, range(2), resume=False)
    had = bytes_of(folder)

    def while_it_is_open(done: int) -> list[int]:
        with pytest.raises(ValidationError, match="found another process that records into it, needed it alone"):
            write(folder, [2])
        return [done]

    write(folder, while_it_is_open)
    assert set(had) <= set(bytes_of(folder))
    assert not (folder / UNFINISHED).exists()


def test_a_file_system_without_locks_is_no_other_process(
    write: Callable[..., None], tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(*_: Any) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(fcntl, "flock", refused)
    with pytest.raises(OSError, match="No locks available"):
        write(tmp_path / "new", [0])


def test_a_lock_on_a_file_that_was_replaced_is_none(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The owner before removes the file, and another one locks a new file, before this one has its lock."""
    path, flock = tmp_path / "a" / "lock", fcntl.flock
    other: list[int] = []

    def overtaken(lock: int, kind: int) -> None:
        if not other:
            path.unlink()
            other.append(os.open(path, os.O_RDWR | os.O_CREAT))
            flock(other[0], kind)
        flock(lock, kind)

    with monkeypatch.context() as patch:
        patch.setattr(fcntl, "flock", overtaken)
        with pytest.raises(BlockingIOError):
            lock_file(path)
    os.close(other[0])
    own = lock_file(path)
    with pytest.raises(BlockingIOError):
        lock_file(path)
    path.unlink()
    os.close(own)


def test_a_damaged_recording_is_one_sentence(tmp_path: pathlib.Path) -> None:
    lerobot(tmp_path / "a", range(2), resume=False)
    (path,) = (tmp_path / "a/data").rglob("*.parquet")
    path.write_bytes(path.read_bytes()[:100])
    with pytest.raises(ValidationError, match="found a file that cannot be read"):
        lerobot(tmp_path / "a", [2])
    frames("coco")(tmp_path / "b", range(2), resume=False)
    (tmp_path / "b/annotations/captions.json").write_text("{")
    with pytest.raises(ValidationError, match=r"captions.json: found a file that cannot be read"):
        frames("coco")(tmp_path / "b", [2])
