"""Measures what the number of streets in a folder of shards costs a process that steps a few of them.

    python -m benchmarks.shards --banks craftbench_v2/bank.npz validation/bank.npz --scenes 8,64,256,1024 --take 8

For each number of scenes it writes a folder (`NAME.bank`), opens it, takes some scenes that are spread over it, and
runs `benchmarks.start` with the first ones in a process of its own. A JSON line each: bytes on disk, seconds and
processor seconds to open and to take, resident memory, and the stages' sums until the first step.

    python -m benchmarks.shards --banks validation/bank.npz --scenes 64 --num-envs 0 --places 8
    python -m benchmarks.shards --banks validation/bank.npz --scenes 1024 --num-envs 0 --places 64 \\
        --train "--num-envs 1024 --steps 20000000"                                                   # on a GPU

With --places it also trains on that many scenes of the folder at a time (`benchmarks.places`, with the options of
--train).

The scenes are those of the banks, again and again under other ids. A copy differs in every hull, mesh and texture
(their last bits change), so that nothing is shared between copies: that is what streets without a common asset need,
while real cousins share most of theirs (--shared: copies share all). Where the pages of the folder are in the system's
memory, nothing waits for a disk.
"""

import argparse
import dataclasses
import json
import pathlib
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from typing import Any

import numpy as np

from benchmarks.lib.memory import rss_mib
from urbanverse_mjx.datatypes import BankShards, BankShardsWriter, SceneBank, ValidationError
from urbanverse_mjx.work_folder import work_folder


def copied(bank: SceneBank, number: int, shared: bool) -> SceneBank:
    """The bank's scenes under other ids; copy 0 is the bank itself.

    Args:
      shared: whether hulls, meshes and textures stay the same; otherwise each has bytes that no other copy has.
    """
    if number == 0:
        return bank
    meta = {**bank.meta, "scene_ids": [f"{name}-{number}" for name in bank.scene_ids]}
    if shared:
        return dataclasses.replace(bank, meta=meta)
    texture = bank.texture_data.copy()
    # Every texture has at least 16 texels: its first two bytes become the number of the copy.
    starts = bank.texture_start[:-1]
    texture[starts], texture[starts + 1] = number & 255, number >> 8
    shift = np.float32(number * 2.0**-20)
    return dataclasses.replace(
        bank,
        meta=meta,
        texture_data=texture,
        mesh_vertices=bank.mesh_vertices + shift,
        mesh_uv=bank.mesh_uv + shift,
        hull_vertices=bank.hull_vertices + shift,
    )


def copies(paths: list[pathlib.Path], number: int, shared: bool) -> Iterator[SceneBank]:
    """Banks with `number` scenes in all, of which the last may be cut."""
    banks = [SceneBank.load(path) for path in paths]
    done = copy = 0
    while done < number:
        for bank in banks:
            some = bank if bank.num_scenes <= number - done else _first(bank, number - done)
            yield copied(some, copy, shared)
            done += some.num_scenes
            if done == number:
                return
        copy += 1


def _first(bank: SceneBank, number: int) -> SceneBank:
    """The first scenes of a bank."""
    with work_folder("urbanverse-shards-") as work:
        bank.save(work / "a.bank")
        return SceneBank.take(BankShards(work / "a.bank"), range(number))


def measure(folder: pathlib.Path, take: int) -> dict[str, Any]:
    """Opens a folder and takes scenes that are spread over it."""
    clocks = [(time.monotonic(), time.process_time())]

    def since() -> dict[str, float]:
        clocks.append((time.monotonic(), time.process_time()))
        wall, processor = (round(b - a, 4) for a, b in zip(*clocks[-2:], strict=True))
        return {"seconds": wall, "processor": processor}

    before = rss_mib()
    shards = BankShards(folder)
    opened = since()
    after = rss_mib()
    rows = np.unique(np.linspace(0, shards.num_scenes - 1, take).astype(int))
    bank = SceneBank.take(shards, rows)
    taken = since()
    return {
        "scenes": shards.num_scenes,
        "disk_mib": round(sum(file.stat().st_size for file in folder.iterdir()) / 2**20, 1),
        "index_mib": round((folder / "index.npz").stat().st_size / 2**20, 2),
        **shards.counts(),
        "open": {**opened, "rss_mib": round(after - before, 1)},
        "take": {
            **taken,
            "scenes": bank.num_scenes,
            "array_mib": round(sum(a.nbytes for a in bank.arrays().values()) / 2**20, 1),
            "rss_mib": round(rss_mib() - after, 1),
        },
    }


def first_step(folder: pathlib.Path, take: int, num_envs: int, impl: str) -> dict[str, Any]:
    """Sums of `benchmarks.start` in a process of its own.

    Raises:
      ValidationError: it failed.
    """
    options = ["--banks", str(folder), "--scenes", str(take), "--num-envs", str(num_envs), "--impl", impl]
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks.start", *options], stdout=subprocess.PIPE, text=True, check=False
    )
    if done.returncode:
        raise ValidationError(f"benchmarks.start: found exit status {done.returncode}, needed 0; see what it printed.")
    rows = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
    sums = {key: round(sum(row[key] for row in rows), 1) for key in ("seconds", "processor")}
    most = {key: max(row[key] for row in rows) for key in ("peak_rss_mib", "peak_device_mib") if key in rows[-1]}
    return {**sums, **most}


def trained(folder: pathlib.Path, places: int, options: list[str]) -> dict[str, Any]:
    """What `benchmarks.places` prints, in a process of its own.

    Raises:
      ValidationError: it failed.
    """
    command = [sys.executable, "-m", "benchmarks.places", "--folder", str(folder), "--places", str(places), *options]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    if done.returncode:
        raise ValidationError(f"benchmarks.places: found exit status {done.returncode}, needed 0; see what it printed.")
    return json.loads(done.stdout.splitlines()[-1])


def main(argv: list[str] | None = None) -> int:
    cli = argparse.ArgumentParser(prog="python -m benchmarks.shards", description=__doc__)
    cli.formatter_class = argparse.RawDescriptionHelpFormatter
    cli.add_argument("--banks", nargs="+", type=pathlib.Path, required=True)
    cli.add_argument("--scenes", type=lambda text: [int(n) for n in text.split(",")], default=[8, 64, 256, 1024])
    cli.add_argument("--take", type=int, default=8, help="scenes that the process steps")
    cli.add_argument("--shared", action="store_true", help="copies share hulls, meshes and textures")
    cli.add_argument("--num-envs", type=int, default=64, help="of the first step; 0 leaves it out")
    cli.add_argument("--impl", default="auto")
    cli.add_argument("--places", type=int, default=0, help="trains on that many scenes at a time; 0 leaves it out")
    cli.add_argument("--train", type=shlex.split, default=[], help="further options of benchmarks.places")
    cli.add_argument("--work", type=pathlib.Path, default=pathlib.Path(tempfile.gettempdir()), help="for the folders")
    args = cli.parse_args(argv)
    with work_folder("urbanverse-shards-", args.work) as work:
        for number in args.scenes:
            folder, begin = work / f"{number}.bank", time.process_time()
            with BankShardsWriter(folder) as writer:
                for bank in copies(args.banks, number, args.shared):
                    writer.add(bank.arrays(), bank.meta)
                    del bank
            row = {"write": {"processor": round(time.process_time() - begin, 1)}, **measure(folder, args.take)}
            if args.num_envs:
                row["first_step"] = first_step(folder, args.take, args.num_envs, args.impl)
            if args.places:
                row["places"] = trained(folder, args.places, args.train)
            print(json.dumps(row), flush=True)
            shutil.rmtree(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
