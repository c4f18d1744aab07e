"""`python -m urbanverse_mjx.citygen.craft`: says what is wrong in CraftBench's scenes; `--out` writes their graphs."""

import argparse
import pathlib
import sys

from . import BUILDERS, write


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=pathlib.Path, help="folder for <id>/graph.json; nothing is written without it")
    parser.add_argument("--only", nargs="*", default=[""], help="beginnings of the ids wanted, 03 for example")
    args = parser.parse_args()
    wrong = 0
    for scene_id in [s for s in BUILDERS if s.startswith(tuple(args.only))]:
        canvas = BUILDERS[scene_id]()
        for problem in canvas.problems():
            sys.stderr.write(f"{scene_id}: {problem}\n")
            wrong += 1
        graph = canvas.graph()
        if args.out:
            write(graph, args.out / scene_id / "graph.json")
        sys.stdout.write(f"{scene_id}: {len(graph.objects)} objects, {len(graph.ground)} regions\n")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
