"""Measures which share of the time of loading files their checks take: checksums, and bounds of indices.

    python -m benchmarks.checks --policy benchmarks/policies/coco_best

For the shipped streets' bank, the meshes of the cache, a policy, and the compiled programs of Warp and JAX: processor
time of loading and of the checks in it, s, the best of several runs. Prints a JSON line each; exits with 1 where checks
take 5 % or more.
"""

import argparse
import contextlib
import json
import pathlib
import sys
import time
import zipfile
from collections.abc import Callable, Iterator, Sequence
from typing import Any
from unittest import mock

from urbanverse_mjx import settings
from urbanverse_mjx.datatypes import AssetMesh, SceneBank, array_file, checksums, scene_bank

LIMIT = 5.0  # %


class Stopwatch:
    """Adds up the processor time of some functions."""

    def __init__(self) -> None:
        self.seconds = 0.0

    def around(self, function: Callable[..., Any]) -> Callable[..., Any]:
        def timed(*args: Any, **options: Any) -> Any:
            begin = time.process_time()
            try:
                return function(*args, **options)
            finally:
                self.seconds += time.process_time() - begin

        return timed


@contextlib.contextmanager
def timed(*places: tuple[Any, str]) -> Iterator[Stopwatch]:
    """Times the functions at these (module or class, name)."""
    watch = Stopwatch()
    with contextlib.ExitStack() as stack:
        for owner, name in places:
            stack.enter_context(mock.patch.object(owner, name, watch.around(getattr(owner, name))))
        yield watch


def measured(name: str, load: Callable[[], object], *checks: tuple[Any, str], repeats: int = 5) -> dict[str, Any]:
    """A row: what loading takes, and the checks among it, at the run that took least."""
    rows = []
    for _ in range(repeats):
        with timed(*checks) as watch:
            begin = time.process_time()
            load()
            rows.append((time.process_time() - begin, watch.seconds))
    whole, part = min(rows)
    return row(name, whole, part)


def row(name: str, whole: float, part: float) -> dict[str, Any]:
    share = round(100.0 * part / whole, 2)
    return {"what": name, "loading_s": round(whole, 4), "checks_s": round(part, 4), "percent": share}


def bank_rows(paths: Sequence[pathlib.Path]) -> Iterator[dict[str, Any]]:
    for path in paths:
        size = path.stat().st_size / 2**20
        checks = (array_file, "_is_sealed"), (zipfile, "crc32"), (scene_bank, "check_bank")
        yield measured(f"bank {path.name}, {size:.0f} MiB", lambda path=path: SceneBank.load(path), *checks)


def mesh_row() -> dict[str, Any]:
    files = sorted(settings.cache_dir("meshes").glob("*/*.npz"))[:500]

    def load() -> None:
        for path in files:
            found = array_file.load(path, "a mesh", "")
            found.pop("surface")
            AssetMesh(**found)

    return measured(
        f"{len(files)} meshes", load, (array_file, "_is_sealed"), (zipfile, "crc32"), (AssetMesh, "__post_init__")
    )


def policy_row(folder: pathlib.Path) -> dict[str, Any]:
    """A policy: its files are compared with its seal, then read."""
    from urbanverse_mjx.training import policy, policy_files

    def load() -> None:
        policy.load_policy(folder)

    load()  # imports
    return measured(f"policy {folder.name}", load, (policy_files, "check"))


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
    with timed((checksums, "changed_groups")) as watch, listing, contextlib.redirect_stdout(sys.stderr):
        command()
    begin = time.process_time()
    _first_step("jax")
    whole = time.process_time() - begin
    size = sum(path.stat().st_size for path in files) / 2**20
    name = f"JAX, {len(files)} programs, {size:.0f} MiB, until an environment's first step"
    return row(name, whole + watch.seconds, watch.seconds)


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
    args = cli.parse_args(argv)
    settings.use_compilation_cache()
    wrong = False
    banks = args.banks or [settings.shipped_bank_path()]
    rows = (lambda: bank_rows(banks), lambda: [mesh_row()], lambda: [policy_row(args.policy)])
    for part in (*rows, lambda: [warp_row()], lambda: [jax_row()]):
        for found in part():
            wrong |= found["percent"] >= LIMIT
            print(json.dumps(found), flush=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
