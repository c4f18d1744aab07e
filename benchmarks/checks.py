"""Measures which share of the time of loading files their checks take: checksums, and bounds of indices.

    python -m benchmarks.checks --policy benchmarks/policies/coco_best

For the shipped streets' bank, the meshes of the cache and a policy: processor time of loading, s, and how much less it
is without the checks, each file in turns, medians of several times. For the compiled programs of Warp and JAX, which a
process loads once: that of the checks. Prints a JSON line each; exits with 1 where checks take 5 % or more.
"""

import argparse
import contextlib
import functools
import itertools
import json
import pathlib
import shutil
import statistics
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any
from unittest import mock

from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import AssetMesh, SceneBank, array_file, checksums, scene_bank
from urbanverse_mjx.work_folder import work_folder

LIMIT = 5.0  # %


def measured(
    name: str, loads: Sequence[Callable[[], object]], *checks: tuple[Any, str, Any], repeats: int
) -> dict[str, Any]:
    """A row: medians of loading all with their checks and without, each of them in turns.

    Args:
      checks: (module or class, name of a function in it, what it returns where nothing is wrong).
    """
    whole, rest = list[float](), list[float]()
    for _ in range(repeats):
        both = [0.0, 0.0]
        # Whichever is first reads a file into the processor's caches: each as often as the other.
        for order, load in itertools.product(((0, 1), (1, 0)), loads):
            for without in order:
                with contextlib.ExitStack() as stack:
                    for owner, function, answer in checks if without else ():
                        stack.enter_context(mock.patch.object(owner, function, lambda *_, answer=answer: answer))
                    both[without] += 0.5 * _seconds(load)
        whole.append(both[0])
        rest.append(both[1])
    share = statistics.median(1.0 - part / total for total, part in zip(whole, rest, strict=True))
    return row(name, statistics.median(whole), max(share, 0.0) * statistics.median(whole))


def _seconds(call: Callable[[], object]) -> float:
    begin = time.process_time()
    call()
    return time.process_time() - begin


def row(name: str, whole: float, part: float) -> dict[str, Any]:
    share = round(100.0 * part / whole, 2)
    return {"what": name, "loading_s": round(whole, 4), "checks_s": round(part, 4), "percent": share}


def bank_rows(paths: Sequence[pathlib.Path], repeats: int) -> Iterator[dict[str, Any]]:
    for path in paths:
        size = path.stat().st_size / 2**20
        checks = (array_file, "_is_sealed", True), (scene_bank, "check_bank", None)
        name = f"bank {path.name}, {size:.0f} MiB"
        yield measured(name, [functools.partial(SceneBank.load, path)], *checks, repeats=repeats)


def mesh_row(repeats: int) -> dict[str, Any]:
    """Meshes of the cache, written as this version writes them."""
    with work_folder("urbanverse-checks-") as folder:
        for path in sorted(settings.cache_dir("meshes").glob("*/[!.]*.npz"))[:500]:
            array_file.save(folder / path.name, array_file.load(path, "a mesh", ""))

        def load(path: pathlib.Path) -> None:
            found = array_file.load(path, "a mesh", "")
            found.pop("surface")
            AssetMesh(**found)

        loads = [functools.partial(load, path) for path in sorted(folder.glob("*.npz"))]
        if not loads:
            raise SystemExit("error: checks: found no mesh in the cache, needed some; `make streets` makes them.")
        checks = (array_file, "_is_sealed", True), (AssetMesh, "__post_init__", None)
        return measured(f"{len(loads)} meshes", loads, *checks, repeats=repeats)


def policy_row(folder: pathlib.Path, repeats: int) -> dict[str, Any]:
    """A policy, written as this version writes it: its files are compared with its seal, then read."""
    from urbanverse_mjx.training import policy, policy_files

    with work_folder("urbanverse-checks-") as work:
        copy = shutil.copytree(folder, work / "policy")
        policy.PolicySpec.load(copy).save(copy)
        load = functools.partial(policy.load_policy, copy)
        load()  # imports
        return measured(f"policy {folder.name}", [load], (policy_files, "check", None), repeats=repeats)


def warp_row() -> dict[str, Any]:
    """Warp's modules: all are compared when the package is imported; those of one engine are loaded."""
    import warp

    from urbanverse_mjx.simulation.kernel_cache import check_kernels

    cache = pathlib.Path(warp.config.kernel_cache_dir or "")
    begin = time.process_time()
    check_kernels(cache)
    part = time.process_time() - begin
    begin = time.process_time()
    _first_step("warp")
    whole = time.process_time() - begin
    return row(f"Warp, {len(list(cache.glob('wp_*')))} modules, until an engine's first step", whole + part, part)


def jax_row() -> dict[str, Any]:
    """JAX's programs: those used last are compared when a command starts; those of one environment are loaded."""
    from urbanverse_mjx.cli.main import main as command

    folder = settings.cache_dir("jax")
    files = [path for path in folder.glob("*-cache") if path.is_file()]
    listing = mock.patch.object(sys, "argv", ["urbanverse", "list-envs"])
    seconds = list[float]()
    changed_groups = checksums.changed_groups

    def timed(*given: Any, **options: Any) -> Any:
        begin = time.process_time()
        try:
            return changed_groups(*given, **options)
        finally:
            seconds.append(time.process_time() - begin)

    compare = mock.patch.object(checksums, "changed_groups", timed)
    with compare, listing, contextlib.redirect_stdout(sys.stderr):
        command()
    begin = time.process_time()
    _first_step("jax")
    whole = time.process_time() - begin
    size = sum(path.stat().st_size for path in files) / 2**20
    name = f"JAX, {len(files)} programs, {size:.0f} MiB, until an environment's first step"
    return row(name, whole + sum(seconds), sum(seconds))


def _first_step(impl: str) -> None:
    import jax
    import jax.numpy as jnp

    from urbanverse_mjx.envs import registry

    overrides = {"preset": "cpu", "vision": False, "impl": impl}
    env = registry.load("CocoNav", config_overrides=overrides)
    state = jax.jit(jax.vmap(env.reset))(jax.random.split(jax.random.key(0), 4))
    jax.block_until_ready(jax.jit(jax.vmap(env.step))(state, jnp.zeros((4, env.action_size))))


def main(argv: Sequence[str] | None = None) -> int:
    cli = argparse.ArgumentParser(prog="python -m benchmarks.checks", description=__doc__)
    cli.formatter_class = argparse.RawDescriptionHelpFormatter
    cli.add_argument("--banks", nargs="*", type=pathlib.Path, help="default: the shipped streets'")
    cli.add_argument("--policy", type=pathlib.Path, default=pathlib.Path("benchmarks/policies/coco_best"))
    cli.add_argument("--repeats", type=int, default=11, help="runs of the meshes; others are run three times as often")
    args = cli.parse_args(argv)
    settings.use_compilation_cache()
    wrong = False
    banks = args.banks or [settings.shipped_bank_path()]
    few, many = args.repeats, 3 * args.repeats
    rows = (lambda: bank_rows(banks, many), lambda: [mesh_row(few)], lambda: [policy_row(args.policy, many)])
    for part in (*rows, lambda: [warp_row()], lambda: [jax_row()]):
        for found in part():
            wrong |= found["percent"] >= LIMIT
            print(json.dumps(found), flush=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
