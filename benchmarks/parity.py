"""Measures the differences between the engines and C MuJoCo.

    python -m benchmarks.parity --impl all --json

drives robots through the shipped streets (recompiled, with C MuJoCo in each saved `scene.xml`) and through box streets,
each engine with all drives of a suite in one batch: free driving, ramps, kerbs, grazing and head-on hits, gaps too
narrow for the robot, and drives aimed at objects at any angle. One JSON line holds, per engine and suite, the largest
difference before the first contact and one second after it, in which scene, drive and second, the physics steps between
the onsets, and other differences. The exit status is 1 if a tolerance of the design is exceeded: 1 mm before contact,
onset within one physics step, one second later 5 mm in the median and 50 mm at most, no hit in one engine alone, and no
episode that would end for another reason.

    python -m benchmarks.parity --keep FOLDER                     # C MuJoCo's part, on a machine that can compile
    scenes python -m benchmarks.parity --kept FOLDER --impl warp --json # on a GPU machine with only the runtime
"""

import argparse
import collections
import dataclasses
import json
import pathlib
import sys
from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np

from urbanverse_mjx.datatypes import RobotSpec, SceneBank, ValidationError
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.simulation.engines import make_engine
from urbanverse_mjx.simulation.parity import c_mujoco
from urbanverse_mjx.work_folder import work_folder

CONTROL_DT = 0.2
ENGINES = ("warp", "warp-fused", "jax")
TOLERANCES = {"before_contact_max_mm": 1.0, "onset_max_steps": 1, "after_1s_median_mm": 5.0, "after_1s_max_mm": 50.0}
NEVER = ("hit_flags_differ", "objects_differ", "ends_differ")
#: Figures that are reported with the drive and time of their maximum.
LARGEST = ("before_contact", "after_1s")


@dataclasses.dataclass(frozen=True)
class Suite:
    """Drives in some scenes with C MuJoCo's results."""

    bank: SceneBank
    drives: c_mujoco.Drives
    expected: c_mujoco.Trace

    def save(self, folder: pathlib.Path) -> None:
        """Writes `bank.npz` and `truth.npz`."""
        folder.mkdir(parents=True, exist_ok=True)
        self.bank.save(folder / "bank.npz")
        expected_ = {**vars(self.expected), "driven": self.expected.qpos}
        expected_["objects"] = json.dumps([sorted(o) for o in self.expected.objects])
        np.savez_compressed(folder / "truth.npz", **{**expected_, **vars(self.drives)})

    @staticmethod
    def load(folder: pathlib.Path) -> "Suite":
        """Reads a folder written by `save`; raises `ValidationError` for any other."""
        try:
            with np.load(folder / "truth.npz") as file:
                kept = {name: file[name] for name in file.files}
            drives = c_mujoco.Drives(kept["scene"], kept["qpos"], kept["ctrl"], tuple(str(k) for k in kept["kind"]))
            objects = tuple(frozenset(o) for o in json.loads(str(kept["objects"])))
            trace = c_mujoco.Trace(kept["driven"], kept["hit"], objects, kept["ground"], kept["met"])
        except (OSError, KeyError, ValueError) as error:
            needed = "a folder written by `python -m benchmarks.parity --keep`"
            raise ValidationError(f"{folder} holds no kept suite ({error}); {needed} is needed.") from error
        return Suite(SceneBank.load(folder / "bank.npz"), drives, trace)


def parse(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.parity", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--impl", choices=(*ENGINES, "all"), default="all")
    parser.add_argument("--graphs", type=pathlib.Path, nargs="+", help="scene graphs (default: the shipped streets)")
    parser.add_argument("--robot", choices=("differential", "ackermann"), default="differential")
    parser.add_argument("--drives", type=int, default=60, help="in the scene graphs; 0 leaves them out")
    parser.add_argument("--boxes", type=int, default=20, help="box streets, one drive each; 0 leaves them out")
    parser.add_argument("--seconds", type=float, default=4.0, help="of each drive")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--keep", type=pathlib.Path, help="folder for the suites and C MuJoCo's part; no engine runs")
    parser.add_argument("--kept", type=pathlib.Path, help="folder that --keep wrote, instead of driving in C MuJoCo")
    parser.add_argument("--json", action="store_true", help="print one JSON line")
    arguments = parser.parse_args(argv)
    if min(arguments.drives, arguments.boxes) < 0 or arguments.drives + arguments.boxes < 1:
        parser.error("--drives and --boxes must not be negative, and one of them positive")
    if arguments.seconds < CONTROL_DT:
        parser.error(f"--seconds must be at least {CONTROL_DT:g}")
    return arguments


def make_suite(
    bank: SceneBank, scenes: Sequence[mujoco.MjSpec], robot: RobotSpec, count: int, seconds: float, seed: int
) -> Suite:
    """Returns `count` drives that cycle through all kinds and scenes, simulated in C MuJoCo."""
    drives = c_mujoco.mixed_drives(bank, robot, count, round(seconds / CONTROL_DT), CONTROL_DT, seed)
    models = [c_mujoco.reference_model(scene, robot) for scene in scenes]
    return Suite(bank, drives, c_mujoco.drive_reference(models, robot, drives, CONTROL_DT))


# The scene compiler is imported on use: a machine with stored suites lacks it.


def street_suite(arguments: argparse.Namespace, robot: RobotSpec) -> Suite:
    """Returns drives in scene graphs, compiled into a temporary folder."""
    from urbanverse_mjx.pipeline import compile_graph, shipped_scenes
    from urbanverse_mjx.scene import pack_bank

    graphs, splits = shipped_scenes()
    if arguments.graphs:
        graphs, splits = arguments.graphs, ["train"] * len(arguments.graphs)
    with work_folder("urbanverse-parity-") as work:
        folders = [pathlib.Path(work) / str(i) for i in range(len(graphs))]
        for graph, folder in zip(graphs, folders, strict=True):
            compile_graph(graph, folder, arguments.seed)
        scenes = [mujoco.MjSpec.from_file(str(folder / "scene.xml")) for folder in folders]
        return make_suite(
            pack_bank(folders, splits), scenes, robot, arguments.drives, arguments.seconds, arguments.seed
        )


def box_suite(arguments: argparse.Namespace, robot: RobotSpec) -> Suite:
    """As many worlds as scenes, all at once."""
    from tests.support.box_bank import box_bank, box_scenes
    from urbanverse_mjx.scene.mjcf import scene_spec

    scenes = [scene_spec(scene) for scene in box_scenes(arguments.boxes, arguments.seed)]
    bank = box_bank(arguments.boxes, arguments.seed)
    return make_suite(bank, scenes, robot, arguments.boxes, arguments.seconds, arguments.seed)


def judge(suite: Suite, found: c_mujoco.Trace, robot: RobotSpec) -> dict[str, Any]:
    """Returns the figures of one engine in one suite, the location of their maxima, and the exceeded tolerances."""
    figures = c_mujoco.compare(suite.expected, found, robot).summary()
    for name in LARGEST:
        drive = figures[f"{name}_worst_drive"]
        if drive is not None:
            figures[f"{name}_worst_scene"] = suite.bank.scene_ids[suite.drives.scene[drive]]
            figures[f"{name}_worst_kind"] = suite.drives.kind[drive]
    broken = [name for name, limit in TOLERANCES.items() if (figures[name] or 0) > limit]
    broken += [name for name in NEVER if figures[name]]
    return {**figures, "kinds": dict(collections.Counter(suite.drives.kind)), "broken": broken}


def make_suites(arguments: argparse.Namespace, robot: RobotSpec) -> dict[str, Suite]:
    """Returns the suites by name, stored ones if there are any."""
    makers = {"boxes": (arguments.boxes, box_suite), "streets": (arguments.drives, street_suite)}
    asked = {name: make for name, (count, make) in makers.items() if count}
    if arguments.kept is not None:
        return {name: Suite.load(arguments.kept / name) for name in asked}
    return {name: make(arguments, robot) for name, make in asked.items()}


def measure(arguments: argparse.Namespace) -> dict[str, Any]:
    robot = make_coco(arguments.robot)
    suites = make_suites(arguments, robot)
    if arguments.keep is not None:
        for name, suite in suites.items():
            suite.save(arguments.keep / name)
        return {"benchmark": "parity", "robot": robot.name, "kept": str(arguments.keep), "engines": {}, "broken": []}
    result: dict[str, Any] = {"benchmark": "parity", "robot": robot.name, "engines": {}}
    for impl in ENGINES if arguments.impl == "all" else (arguments.impl,):
        result["engines"][impl] = {}
        for name, suite in suites.items():
            engine = make_engine(suite.bank, robot, impl=impl, control_dt=CONTROL_DT)
            result["engines"][impl][name] = judge(suite, c_mujoco.drive_engine(engine, suite.bank, suite.drives), robot)
    result["largest"] = largest(result["engines"])
    result["broken"] = sorted(
        f"{impl} {name}: {what}"
        for impl, parts in result["engines"].items()
        for name, part in parts.items()
        for what in part["broken"]
    )
    return result


def largest(engines: dict[str, dict[str, dict[str, Any]]]) -> dict[str, str]:
    """Returns text with the largest difference before and after contact and its location."""
    words = {}
    for name in LARGEST:
        found = [
            (part[f"{name}_max_mm"], impl, suite, part)
            for impl, parts in engines.items()
            for suite, part in parts.items()
            if part[f"{name}_worst_drive"] is not None
        ]
        if found:
            worst, impl, suite, part = max(found, key=lambda row: row[0])
            words[name] = (
                f"{worst:g} mm: {impl}, {suite}, scene {part[f'{name}_worst_scene']}, "
                f"drive {part[f'{name}_worst_drive']} ({part[f'{name}_worst_kind']}), "
                f"{part[f'{name}_worst_time_s']:g} s"
            )
    return words


def main(argv: list[str] | None = None) -> int:
    arguments = parse(argv)
    try:
        result = measure(arguments)
    except ValidationError as error:
        print(f"parity: {error}", file=sys.stderr)
        return 2
    if arguments.json:
        print(json.dumps(result))
    else:
        for impl, parts in result["engines"].items():
            for suite, figures in parts.items():
                print(f"{impl}, {suite}:")
                print("\n".join(f"  {name}: {value}" for name, value in figures.items()))
        print("\n".join(f"largest difference, {name}: {text}" for name, text in result.get("largest", {}).items()))
        print(f"broken: {', '.join(result['broken']) or 'none'}")
    return 1 if result["broken"] else 0


if __name__ == "__main__":
    sys.exit(main())
