"""`Claim`: the folder of a dataset while one process writes it."""

import json
import os
import pathlib
import shutil
from collections.abc import Mapping
from typing import Any

from ..datatypes import validation as v
from ..work_folder import lock_file
from . import features as f

_LOCK = "lock"
#: Keys of a recording's origin that may differ when it is continued.
_MAY_CHANGE = ("versions", "continued")
#: Keys of what a policy holds, which decides where both origins have it, and of where it lies, which may then change.
_CONTENT, _PLACES = "policy_content.sha256", ("policy", "policy_content.name")


def require_new(folder: pathlib.Path) -> None:
    """Raises an error unless a path is new or an empty folder.

    Raises:
      ValidationError: the path is a file, or a folder that is not empty.
    """
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        what = "a folder that is not empty" if folder.is_dir() else "a file"
        hint = "choose another one, or continue its recording with --resume; nothing in it was changed"
        raise v.fail(str(folder), what, "a new or empty folder", hint)


def has_episodes(folder: pathlib.Path, listed: str) -> bool:
    """Whether a recording in a folder can be continued: the file that lists its complete episodes exists.

    Args:
      folder: that may hold a recording.
      listed: that file's path in the folder.

    Returns:
      False where the folder is new, empty, or was left before its first episode was complete: then it begins there.

    Raises:
      ValidationError: the folder holds something else.
    """
    if (folder / listed).is_file():
        return True
    if not (folder / f.UNFINISHED).is_dir():
        try:
            require_new(folder)
        except v.ValidationError as error:
            raise v.fail(
                str(folder), f"no file {listed}", "a recording of this --format, or a new folder", "check --out"
            ) from error
    return False


class Claim:
    """Holds the folder `.unfinished` of a dataset, for files that are not complete, and keeps other processes out.

    Args:
      folder: of the dataset.
      begun: whether it may hold something; else it must be new or empty.

    Raises:
      ValidationError: it is not empty, or another process writes into it.
    """

    def __init__(self, folder: pathlib.Path, begun: bool) -> None:
        if not begun:
            require_new(folder)
        self.folder, self.staging = folder, folder / f.UNFINISHED
        self._made = not folder.exists()
        try:
            self._lock = lock_file(self.staging / _LOCK)
        except BlockingIOError as error:
            raise v.fail(str(folder), "another process that records into it", "it alone", "wait for its end") from error

    def release(self) -> None:
        """Removes what is not complete, and a folder that was made for nothing."""
        shutil.rmtree(self.staging, ignore_errors=True)
        os.close(self._lock)
        if self._made and not any(self.folder.iterdir()):
            self.folder.rmdir()


def continued(path: pathlib.Path, origin: Mapping[str, Any], episodes: int) -> dict[str, Any]:
    """The origin of a recording that is continued: what it was, and from which episode on other versions went on.

    Args:
      path: of the origin's file.
      origin: of the recording that continues it.
      episodes: that are complete.

    Raises:
      ValidationError: they differ.
    """
    had, asked = v.read_json(path, "origin of a recording"), json.loads(json.dumps(origin))
    ours, theirs = _flat(had), _flat(asked)
    if _CONTENT in ours and _CONTENT in theirs:
        if ours[_CONTENT] != theirs[_CONTENT]:
            raise v.fail(
                "--resume",
                f"--policy {v.show(theirs['policy'])} with the content of {_policy(theirs)}",
                f"that of {_policy(ours)} as in {path}",
                "pass --policy the checkpoint that began the recording, or record into another folder",
            )
        ours, theirs = ({key: x for key, x in own.items() if key not in _PLACES} for own in (ours, theirs))
    differing = [key for key in sorted(ours.keys() | theirs.keys()) if ours.get(key) != theirs.get(key)]
    if differing:
        key = differing[0]
        more = f" (and {len(differing) - 1} more)" if len(differing) > 1 else ""
        raise v.fail(
            "--resume",
            f"{key} {v.show(theirs.get(key))}{more}",
            f"{v.show(ours.get(key))} as in {path}",
            "repeat the command that began the recording",
        )
    last = ([had] + list(had.get("continued", [])))[-1]
    if last.get("versions") != asked.get("versions"):
        step = {"episodes": episodes, "versions": asked["versions"]}
        return {**had, "continued": [*had.get("continued", []), step]}
    return had


def _policy(flat: Mapping[str, Any]) -> str:
    return f"{v.show(flat.get('policy_content.name'))} (SHA-256 {str(flat[_CONTENT])[:12]}...)"


def _flat(origin: Mapping[str, Any]) -> dict[str, Any]:
    """Dotted keys -> values that are no objects."""

    def parts(value: Any, prefix: str) -> dict[str, Any]:
        if not isinstance(value, dict) or not value:
            return {prefix: value}
        return {k: x for name, part in value.items() for k, x in parts(part, f"{prefix}.{name}".lstrip(".")).items()}

    return parts({key: value for key, value in origin.items() if key not in _MAY_CHANGE}, "")
