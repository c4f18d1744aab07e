"""Scenarios by UrbanSim's names: `clean` without objects, `static` with objects, `dynamic` with people and movable
objects.

`dynamic` adds the agents and objects of `config.crowd` and `config.movable`; see `dynamic` and `movables`.
"""

import dataclasses
from collections.abc import Sequence

import numpy as np
from jaxtyping import Int32
from ml_collections import ConfigDict

from ...datatypes import BankShards, PlacedBank, SceneBank, ValidationError

SCENARIOS = ("clean", "static", "dynamic")


def scenario_of(config: ConfigDict) -> str:
    """The scenario of an environment's config; "static" if it has none (older policies).

    Raises:
      ValidationError: the scenario is unknown.
    """
    name = config.get("scenario", "static")
    if name not in SCENARIOS:
        raise ValidationError(f"config.scenario: found {name!r}, needed one of {', '.join(SCENARIOS)}.")
    return name


def bank_for(scenario: str, bank: SceneBank) -> SceneBank:
    """The bank for a scenario; `clean` keeps only ground, sky and episodes."""
    if scenario != "clean":
        return bank
    ground = np.array([name.startswith("ground:") for name in bank.meta["categories"]] + [False])[bank.slot_category]
    return dataclasses.replace(
        bank,
        inst_hull=np.full_like(bank.inst_hull, -1),
        inst_object=np.full_like(bank.inst_object, -1),
        hull_grid=np.full_like(bank.hull_grid[..., :1], -1),
        slot_mesh=np.where(ground, bank.slot_mesh, -1),
        slot_movable=np.zeros_like(bank.slot_movable),
    )


def select_scenes(bank: SceneBank | BankShards, which: str | Sequence[str]) -> Int32[np.ndarray, " n"]:
    """(n,) i32, rows of the bank selected by a split ("train", "test", ...), "all", or ids (a list, or
    comma-separated)."""
    if isinstance(which, str) and which == "all":
        return np.arange(bank.num_scenes, dtype=np.int32)
    if isinstance(which, str) and which in bank.meta["splits"]:
        return bank.scenes_of(which)
    ids = which.split(",") if isinstance(which, str) else list(which)
    unknown = [s for s in ids if s not in bank.scene_ids] or ([which] if not ids else [])
    if unknown:
        splits, known = ", ".join(sorted(set(bank.meta["splits"]))), ", ".join(bank.scene_ids[:20])
        raise ValidationError(
            f"config.scenes: found {unknown[0]!r}, which names no scene, needed 'all', a split ({splits}) or "
            f"ids of its {bank.num_scenes} scenes ({known})."
        )
    return np.array([bank.scene_ids.index(s) for s in ids], np.int32)


def scenes_in_use(config: ConfigDict, bank: SceneBank) -> Int32[np.ndarray, " n"]:
    """(n,) i32, rows of the bank that an environment of a config has its episodes in.

    Raises:
      ValidationError: they do not exist.
    """
    if isinstance(bank, PlacedBank):
        return np.arange(bank.num_scenes, dtype=np.int32)
    return select_scenes(bank, config.scenes)


def check_places(config: ConfigDict) -> None:
    """Refuses configs whose tables do not change with the scenes of places (`schedule.places`).

    Raises:
      ValidationError: there are moving agents or objects, another task than point goals, an observation with tables
        of its own, or another schedule.
    """
    task, schedule = config.get("task", None), config.schedule
    name = "point_goal" if task is None else task.name
    known = {
        "config.task.name": (name, "point_goal"),
        "config.scenario": (scenario_of(config), "static"),
        "config.randomization.clutter": (config.randomization.get("clutter", 0), 0),
        "config.observations.clear_arcs": (config.get("observations", {}).get("clear_arcs", False), False),
        "config.schedule.resident_scenes": (schedule.resident_scenes, 0),
        "config.schedule.ramp_steps": (schedule.ramp_steps, 0),
        "config.schedule.learnable": (schedule.get("learnable", 0.0), 0.0),
    }
    for where, (found, needed) in known.items():
        if found != needed:
            raise ValidationError(
                f"{where}: found {found!r} together with schedule.places, needed {needed!r}; change it, or set "
                "schedule.places to 0, which keeps all scenes on the device."
            )
