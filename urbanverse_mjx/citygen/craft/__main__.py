"""`python -m urbanverse_mjx.citygen.craft`: writes `scenes/craftbench/<id>/graph.json` and says what is wrong."""

import argparse
import pathlib
import sys

from . import BUILDERS, write


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("scenes/craftbench"), help="folder of scenes")
    parser.add_argument("--only", nargs="*", default=[""], help="beginnings of the ids wanted, 03 for example")
    args = parser.parse_args()
    wrong = 0
    for scene_id in [s for s in BUILDERS if s.startswith(tuple(args.only))]:
        canvas = BUILDERS[scene_id]()
        for problem in canvas.problems():
            sys.stderr.write(f"{scene_id}: {problem}\n")
            wrong += 1
        graph = canvas.graph()
        path = write(graph, args.out / scene_id / "graph.json")
        size = path.stat().st_size / 1e3
        sys.stdout.write(f"{path}: {len(graph.objects)} objects, {len(graph.ground)} regions, {size:.0f} kB\n")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
