"""How far the MJX engine parts from C MuJoCo in the shipped streets.

    python -m benchmarks.parity --drives 24 --json

compiles the streets, drives robots at what stands in the way, in C MuJoCo on each saved `scene.xml` and in the engine
in one batch, and prints one JSON line: the largest difference before the first contact and the drive it occurred in,
physics steps between the onsets, and the differences one second after the first contact (median and largest). The exit
status is 1 where a tolerance of the design is broken: 1 mm before contact, onset within one physics step, one second
later 5 mm in the median and 50 mm at most, and no hit in one engine alone.
"""

import argparse
import json
import pathlib
import sys
import tempfile

import mujoco

from urbanverse_mjx.cli.scene import compile_graph, shipped_scenes
from urbanverse_mjx.datatypes import NounError
from urbanverse_mjx.robots import make_coco
from urbanverse_mjx.scene import pack_bank
from urbanverse_mjx.simulation import truth
from urbanverse_mjx.simulation.jax_engine import JaxEngine

CONTROL_DT = 0.2
TOLERANCES = {"before_contact_max_mm": 1.0, "onset_max_steps": 1, "after_1s_median_mm": 5.0, "after_1s_max_mm": 50.0}


def parse(argv: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.parity", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--graphs", type=pathlib.Path, nargs="+", help="scene graphs (default: the shipped streets)")
    parser.add_argument("--robot", choices=("differential", "ackermann"), default="differential")
    parser.add_argument("--drives", type=int, default=24)
    parser.add_argument("--seconds", type=float, default=4.0, help="of each drive")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", action="store_true", help="print one JSON line")
    arguments = parser.parse_args(argv)
    if arguments.drives < 1 or arguments.seconds < CONTROL_DT:
        parser.error(f"--drives must be at least 1 and --seconds at least {CONTROL_DT:g}")
    return arguments


def measure(arguments: argparse.Namespace) -> dict[str, object]:
    graphs, splits = shipped_scenes()
    if arguments.graphs:
        graphs, splits = arguments.graphs, ["train"] * len(arguments.graphs)
    robot = make_coco(arguments.robot)
    with tempfile.TemporaryDirectory(prefix="urbanverse-parity-") as work:
        folders = [pathlib.Path(work) / str(i) for i in range(len(graphs))]
        for graph, folder in zip(graphs, folders, strict=True):
            compile_graph(graph, folder, arguments.seed)
        bank = pack_bank(folders, splits)
        models = [truth.truth_model(mujoco.MjSpec.from_file(str(f / "scene.xml")), robot) for f in folders]
    steps = round(arguments.seconds / CONTROL_DT)
    drives = truth.aimed_drives(bank, robot, arguments.drives, steps, CONTROL_DT, arguments.seed)
    expected = truth.drive_truth(models, robot, drives, CONTROL_DT)
    found = truth.drive_engine(JaxEngine(bank, robot, CONTROL_DT), bank, drives)
    report = truth.compare(expected, found, robot)
    figures = report.summary()
    names = [n for n in figures if n.endswith("worst_drive") and figures[n] is not None]
    broken = [name for name, limit in TOLERANCES.items() if (figures[name] or 0) > limit]
    broken += [name for name in ("hit_flags_differ", "objects_differ") if figures[name]]
    scenes = {n.replace("drive", "scene"): bank.scene_ids[drives.scene[figures[n]]] for n in names}
    return {"robot": robot.name, **figures, **scenes, "broken": broken}


def main(argv: list[str] | None = None) -> int:
    arguments = parse(argv)
    try:
        figures = measure(arguments)
    except NounError as error:
        print(f"parity: {error}", file=sys.stderr)
        return 2
    if arguments.json:
        print(json.dumps(figures))
    else:
        print("\n".join(f"{name}: {value}" for name, value in figures.items()))
    return 1 if figures["broken"] else 0


if __name__ == "__main__":
    sys.exit(main())
