"""`python -m urbanverse_mjx.citygen`: writes `scenes/<id>/graph.json` and `scenes/splits.json`."""

import argparse
import pathlib
import sys

from ..datatypes import validation as v
from . import BUILDERS, SPLITS, build


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("scenes"), help="folder of the scenes")
    parser.add_argument("--only", choices=sorted(BUILDERS), help="one street instead of all")
    args = parser.parse_args()
    for scene_id in [args.only] if args.only else BUILDERS:
        graph = build(scene_id)
        path = args.out / scene_id / "graph.json"
        graph.save(path)
        size = path.stat().st_size / 1e3
        sys.stdout.write(f"{path}: {len(graph.objects)} objects, {len(graph.ground)} regions, {size:.0f} kB\n")
    v.write_json(args.out / "splits.json", SPLITS)


if __name__ == "__main__":
    main()
