"""Joins banks for training and testing, and logs a training that is scored on unseen streets."""

import concurrent.futures
import json
import pathlib
import sys
import time
from collections.abc import Sequence
from typing import Any, NamedTuple

from benchmarks.lib.banks import first_scenes, joined
from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import SceneBank
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.evaluation.held_out import Suite


class Log:
    """Writes lines of log.jsonl in a folder, with the seconds since its creation."""

    def __init__(self, folder: pathlib.Path) -> None:
        self.folder, self.begin = folder, time.monotonic()
        folder.mkdir(parents=True, exist_ok=True)

    def __call__(self, **values: Any) -> None:
        line = json.dumps({"t": round(time.monotonic() - self.begin, 1), **values})
        with (self.folder / "log.jsonl").open("a", encoding="utf-8") as file:
            file.write(line + "\n")
        print(line, file=sys.stderr, flush=True)


def begin(folder: pathlib.Path) -> Log:
    """Opens the log of a training in a folder. From then on this process keeps what JAX compiles."""
    from benchmarks.lib.caching import keep_compiled

    keep_compiled()
    return Log(folder)


class Streets(NamedTuple):
    """bank: of all scenes. train: ids of those to train on. suite: episodes on the others."""

    bank: SceneBank
    train: list[str]
    suite: Suite


def load(
    train: Sequence[pathlib.Path],
    test: Sequence[pathlib.Path],
    holdout: Sequence[int],
    episodes: int,
    log: Log,
    first: int | None = None,
) -> Streets:
    """Joins banks; a bank's name is that of its folder.

    Args:
      train: banks to train on, without the last `holdout[i]` scenes of bank i, which are driven for validation.
      test: a bank named validation is driven for validation, others by their frozen protocols, or like validation sets
        if they have none.
      episodes: of each set without frozen protocol.
      first: number of scenes of each bank to train on, those that are held out included; default: all.
    """
    with concurrent.futures.ThreadPoolExecutor() as pool:  # unpacking runs in several threads
        banks = list(pool.map(SceneBank.load, [*train, *test]))
    trained, tests = banks[: len(train)], banks[len(train) :]
    if first is not None:  # every scene that is there costs memory, whether it is trained on or not
        trained = [first_scenes(bank, min(first, bank.num_scenes)) for bank in trained]
    by_name = dict(zip((path.parent.name for path in test), tests, strict=True))
    bank = joined([*trained, *by_name.values()])
    own = [part.scene_ids for part in trained]
    ids = [name for part in own for name in part]
    held = {
        f"validation_{path.parent.name}": list(part)[-count:]
        for path, part, count in zip(train, own, holdout, strict=False)
        if count > 0
    }
    chosen = [name for name in ids if not any(name in names for names in held.values())]
    if "validation" in by_name:
        held["validation_composed"] = list(by_name.pop("validation").scene_ids)
    frozen = [name for name in by_name if (settings.protocol_root() / f"{name}.json").is_file()]
    held |= {name: list(part.scene_ids) for name, part in by_name.items() if name not in frozen}
    log(loaded=bank.num_scenes, trained=len(chosen), held={k: len(x) for k, x in held.items()}, frozen=frozen)
    return Streets(bank, chosen, Suite.of(bank, held, episodes, frozen))


def named_scenes(named: Sequence[str] | None, there: Sequence[str]) -> list[str]:
    """Returns the scenes that `--scenes` names, or all that are there to train on.

    Raises:
      SystemExit: one is not there.
    """
    unknown = sorted(set(named or ()) - set(there))
    if unknown:
        raise SystemExit(f"error: --scenes: found {unknown[0]!r}, needed ids of scenes in the banks to train on.")
    return list(named or there)


def steps_of(folder: pathlib.Path) -> int:
    """Returns the env-steps of the newest policy in a run folder, 0 without one: a run that was killed between its
    first state and the policy of it has none."""
    from urbanverse_mjx.training.policy import PolicySpec, latest_policy

    try:
        return PolicySpec.load(latest_policy(folder / "checkpoints")).steps
    except v.ValidationError:
        return 0


def brief(scores: dict[str, Any]) -> dict[str, Any]:
    """Returns the success rate with its interval, and the share of each result."""
    rate = scores["summary"]["SR"]
    return {k: round(rate[k], 1) for k in ("mean", "low", "high") if rate.get(k) is not None} | scores["ends"]


def save_result(folder: pathlib.Path, result: dict[str, Any]) -> None:
    """Writes result.json, whole or not at all; called once, after the last score, because a campaign takes a job whose
    result is there for done."""
    text = json.dumps(result)
    v.write_atomically(folder / "result.json", lambda path: path.write_text(text, encoding="utf-8"))
