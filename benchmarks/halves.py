"""Cuts the built scenes of a set of the library into halves of about 100 m, and packs them into one bank.

    urbanverse scene library craftbench
    python -m benchmarks.halves craftbench --out runs/craftbench_halves

The halves are those of `urbanverse scene compile --half`, with routes planned and driven in each. An interrupted build
continues. A half without space for routes is left out and named in left_out.json. Writes scenes, left_out.json and then
bank.npz to `--out`.
"""

import argparse
import pathlib
import sys

from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import SceneLayout, ValidationError
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.pipeline.library.building import ROWS
from urbanverse_mjx.process_pool import results_as_completed
from urbanverse_mjx.scene import library


def build_halves(folder: pathlib.Path, out: pathlib.Path) -> dict[str, str]:
    """Compiles the halves of a compiled scene that are not in `out` yet; returns why halves are left out, by id."""
    from urbanverse_mjx.materialisation import index_of
    from urbanverse_mjx.pipeline.scenes import compile_layout
    from urbanverse_mjx.scene import CompiledScene, EpisodeRules
    from urbanverse_mjx.scene.halves import half_layouts

    left_out = {}
    for half in half_layouts(CompiledScene.load(folder).layout):
        if _complete(out / half.id, half):
            continue
        try:
            compile_layout(half, index_of(half), out / half.id, EpisodeRules(rows=ROWS), freeze_unstable=True)
        except ValidationError as error:
            left_out[half.id] = str(error)
    return left_out


def _complete(folder: pathlib.Path, half: SceneLayout) -> bool:
    """Whether a folder has a compiled scene of the same whole."""
    from urbanverse_mjx.scene import CompiledScene

    try:
        return CompiledScene.load(folder).layout.hashes["half_of"] == half.hashes["half_of"]
    except (ValidationError, OSError, KeyError):
        return False


def build(name: str, out: pathlib.Path, workers: int) -> None:
    """Writes the bank of the halves of a set.

    Raises:
      ValidationError: the set is not built, or no half has space for routes.
    """
    from urbanverse_mjx.datatypes import SceneBank
    from urbanverse_mjx.scene import pack_bank

    ids = SceneBank.load(library.bank_path(name)).scene_ids
    scenes = out / "scenes"
    tasks = [(library.folder(name) / library.SCENES / scene, scenes) for scene in ids]
    left_out: dict[str, str] = {}
    for done, (_, reasons) in enumerate(results_as_completed(build_halves, tasks, workers), 1):
        left_out |= reasons
        print(f"{done}/{len(tasks)} scenes cut", file=sys.stderr, flush=True)
    halves = [f"{scene}_Half_{number:02d}" for scene in ids for number in (1, 2)]
    folders = [scenes / half for half in halves if half not in left_out]
    if not folders:
        raise v.fail(f"set {name!r}", "no half with space for routes", "at least one")
    v.write_json(out / "left_out.json", left_out)
    pack_bank(folders, [library.scene_set(name).split] * len(folders)).save(out / library.BANK)


def arguments() -> argparse.Namespace:
    cli = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    cli.add_argument("set", help="of scenes/library.json")
    cli.add_argument("--out", type=pathlib.Path, required=True)
    cli.add_argument("--workers", type=int, default=settings.num_threads(), help="processes")
    return cli.parse_args()


def main() -> int:
    args = arguments()
    try:
        build(args.set, args.out, args.workers)
    except ValidationError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
