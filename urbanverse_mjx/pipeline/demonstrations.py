"""Recorded episodes of `urbanverse record` as demonstrations for behaviour cloning."""

import collections
import dataclasses
import pathlib
from typing import TYPE_CHECKING, Any

import numpy as np

from ..datatypes import validation as v

if TYPE_CHECKING:
    from ..datasets import StoredDataset
    from ..envs import NavEnv
    from ..training.cloning import Demonstrations

#: Keys of the environment's config that give observations and actions their meaning.
_MEANING = ("action_mode", "goal_mode", "goal_observation_limit", "ctrl_dt", "drive")
#: Settings of the renderer by which images of one place look unlike each other.
_LOOKS = ("shading", "light", "shadows")
_STATE, _GOAL, _ACTION = "observation.state", "observation.environment_state", "action"


def load_demonstrations(folder: pathlib.Path, env: "NavEnv", first: int | None = None) -> "Demonstrations":
    """Episodes of a dataset as an environment's robot would see them.

    Images of another size than the environment's are averaged to it by area.

    Args:
      first: number of episodes, the first ones of the dataset; default: all.

    Raises:
      ValidationError: no dataset, none of this robot, task and rate, no episode or fewer than `first`, or files that
        cannot be read.
    """
    from ..datasets import StoredDataset
    from ..training.cloning import Demonstrations
    from ..training.networks import PIXELS

    stored = StoredDataset.open(folder)
    _check(stored, env)
    if first is not None and len(stored.episodes) < first:
        raise v.fail(str(folder), v.counted(len(stored.episodes), "episodes"), f"at least {first}", "record more")
    stored = dataclasses.replace(stored, episodes=stored.episodes[:first])
    height, width, _ = env.observation_size[PIXELS]
    rows = _rows(stored)
    pixels = _images(stored, int(height), int(width))
    obs = {PIXELS: pixels, "goal": rows[_GOAL], "proprio": rows[_STATE]}
    lengths = np.array([episode["length"] for episode in stored.episodes])
    begins = np.zeros(len(pixels), bool)
    begins[np.cumsum(lengths) - lengths] = True
    return Demonstrations(obs, np.clip(rows[_ACTION], -1.0, 1.0), begins)


def _check(stored: "StoredDataset", env: "NavEnv") -> None:
    """Whether observations and actions mean the same in the dataset and the environment."""
    from .recording.cameras import FRONT

    where, sizes = str(stored.folder), env.observation_size
    needed = {FRONT: 3, _STATE: int(sizes["proprio"][-1]), _GOAL: int(sizes["goal"][-1]), _ACTION: env.action_size}
    for name, size in needed.items():
        feature = stored.features.get(name)
        if feature is None or int(feature.shape[-1]) != size:
            found = "none" if feature is None else f"{v.show(list(feature.shape))}"
            raise v.fail(
                f"{where}: feature {name}", found, f"one of {size} values", "take a dataset of `urbanverse record`"
            )
    if not stored.episodes:
        raise v.fail(where, "no episode", "at least one")
    robot = stored.info.get("robot_type")
    if robot != env.robot.name:
        raise v.fail(
            f"{where}: robot_type", v.show(robot), repr(env.robot.name), "record with the same --env-name as you train"
        )
    if stored.rate != round(1.0 / env.dt):
        raise v.fail(f"{where}: fps", str(stored.rate), str(round(1.0 / env.dt)), "record with the same --preset")
    origin = stored.folder / "meta" / "urbanverse.json"
    recorded = v.read_json(origin, "origin of the dataset").get("environment_config", {}) if origin.is_file() else {}
    for name in _MEANING:
        ours, theirs = env.config.get(name), recorded.get(name)
        if recorded and ours != theirs:
            raise v.fail(f"{origin}: {name}", v.show(theirs), v.show(ours), "record with the same --preset")
    height, width, _ = sizes["pixels/front"]
    high, wide, _ = stored.features[FRONT].shape
    if abs(int(high) / int(wide) - height / width) > 0.02:
        hint = f"record with --size {height}x{width}"
        raise v.fail(f"{where}: images", f"{high}x{wide}", f"the proportions of {height}x{width}", hint)


def other_looks(folder: pathlib.Path, env: "NavEnv") -> str:
    """One sentence on images of a dataset that were drawn otherwise than an environment's, or "" where they were not.

    Sizes do not count, because images are averaged, and neither do settings that a dataset of another program leaves
    unsaid.
    """
    origin = folder / "meta" / "urbanverse.json"
    recorded = v.read_json(origin, "origin of the dataset").get("environment_config", {}) if origin.is_file() else {}
    theirs, ours = recorded.get("vision_config"), env.config.get("vision_config")
    if not isinstance(theirs, dict) or ours is None:
        return ""
    other = [name for name in _LOOKS if name in theirs and theirs[name] != ours.get(name)]
    if not other:
        return ""
    drawn, wanted = (", ".join(f"{name} {v.show(of.get(name))}" for name in other) for of in (theirs, ours))
    return (
        f"{folder}: the images were drawn with {drawn} (--preset {recorded.get('preset')}), but the policy "
        f"will see {wanted}; record with --preset {env.config.get('preset')}, unless that is meant."
    )


def _rows(stored: "StoredDataset") -> dict[str, np.ndarray]:
    """Columns (N, k) f32 of the episodes, in their order."""
    from ..datasets.reading import read_table

    columns = (_STATE, _GOAL, _ACTION)
    parts: dict[str, list[np.ndarray]] = collections.defaultdict(list)
    tables: dict[pathlib.Path, Any] = {}
    for episode in stored.episodes:
        path = stored.data_path(episode)
        if path not in tables:
            tables = {path: read_table(path, ["episode_index", *columns])}
        table = tables[path]
        own = np.flatnonzero(table["episode_index"].to_numpy() == episode["episode_index"])
        if len(own) != episode["length"]:
            raise v.fail(str(path), f"{len(own)} rows of episode {episode['episode_index']}", str(episode["length"]))
        for name in columns:
            part = table[name].slice(int(own[0]), len(own))
            parts[name].append(np.array(part.to_pylist(), np.float32))
    return {name: np.concatenate(found) for name, found in parts.items()}


def _images(stored: "StoredDataset", height: int, width: int) -> np.ndarray:
    """(N, height, width, 3) u8 of the episodes, in their order."""
    from ..datasets.video import read_frames
    from .recording.cameras import FRONT

    spans = [(stored.video_path(e, FRONT), _first_frame(stored, e, FRONT), int(e["length"])) for e in stored.episodes]
    out = np.empty((sum(length for *_, length in spans), height, width, 3), np.uint8)
    done, frames, opened = 0, np.empty(0), None
    for path, first, length in spans:
        if path != opened:
            most = max(start + n for other, start, n in spans if other == path)
            frames, opened = read_frames(path, most, height, width), path
        out[done : done + length] = frames[first : first + length]
        done += length
    return out


def _first_frame(stored: "StoredDataset", episode: dict[str, Any], camera: str) -> int:
    return round(float(episode[f"videos/{camera}/from_timestamp"]) * stored.rate)
