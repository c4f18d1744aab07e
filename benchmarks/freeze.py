"""Freezes a benchmark: writes the list of its scenes and episodes.

    python -m benchmarks.freeze craftbench --bank BANK --extra 03_residential... 12_courtyard...

writes benchmarks/protocols/NAME.json with 64 episodes of every scene of a bank, spread evenly over the scene's episode
table, in random order, with their seeds and the scene's canonical hash. The same bank, name and seed give the same
file. `--half` keeps to paths within the first half of each scene, at most 100 m of it, under the name NAME_half. Prints
one JSON line. Existing lists are replaced only with --force, which makes them a different benchmark, numbered with
`--version`. `--pin` keeps the episodes of a list and updates the digests of its scenes and robots.
"""

import argparse
import dataclasses
import json
import pathlib
import re
import sys

from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.evaluation.frozen import Protocol, freeze
from urbanverse_mjx.pipeline.benchmarking import benchmark_bank, pinned_robots

FOLDER = pathlib.Path(__file__).parent / "protocols"
EPISODES, HALF = 64, 100.0


def version_of(name: str) -> int:
    """The version in a name that ends in "_v" and a number; 1 without one."""
    found = re.search(r"_v([1-9]\d*)$", name)
    return int(found[1]) if found else 1


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.freeze", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("name", help="of the benchmark, which is that of its set of scenes")
    parser.add_argument("--bank", type=pathlib.Path, help="bank of its scenes; default: the set's own")
    parser.add_argument("--extra", nargs="*", default=[], help="ids of scenes that the protocol `paper` leaves out")
    parser.add_argument("--half", action="store_true", help="half-length paths, under the name NAME_half")
    parser.add_argument("--episodes", type=int, default=EPISODES)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=pathlib.Path, default=FOLDER, help="folder of the list")
    parser.add_argument("--version", type=int, help="of the benchmark; default: that in its name (NAME_v2), else 1")
    parser.add_argument("--force", action="store_true", help="replace a list that is there")
    parser.add_argument("--pin", action="store_true", help="keep the list; pin today's scenes and robots")
    args = parser.parse_args(argv)
    name = f"{args.name}_half" if args.half else args.name
    path = args.out / f"{name}.json"
    try:
        if path.exists() and not (args.force or args.pin):
            raise ValidationError(f"{path}: found a frozen list, needed none; --force replaces it.")
        bank = SceneBank.load(args.bank) if args.bank else benchmark_bank(args.name)
        if args.pin:
            protocol = Protocol.load(path)
        else:
            protocol = freeze(name, bank, args.episodes, args.seed, args.extra, HALF if args.half else None)
            protocol = dataclasses.replace(protocol, version=args.version or version_of(args.name))
        protocol = protocol.pinned(bank, pinned_robots())
        protocol.save(path)
    except ValidationError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    print(json.dumps({"list": str(path), "scenes": len(protocol.scenes), "hash": protocol.content_hash()}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
