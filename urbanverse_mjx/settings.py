"""Settings from environment variables: folders of caches and data, number of threads. No other module reads variables.

| variable | meaning | default | | --- | --- | --- | | `URBANVERSE_CACHE` | folder of built files (banks, meshes,
kernels) | `$XDG_CACHE_HOME/urbanverse_mjx` | | `XDG_CACHE_HOME` | folder of all caches | `~/.cache` | |
`URBANVERSE_ASSET_ROOT` | the asset index | `assets_index/` beside the package, else inside it | |
`URBANVERSE_SCENE_ROOT` | the shipped scenes | `scenes/` beside the package, else inside it | |
`URBANVERSE_PROTOCOL_ROOT` | the frozen benchmarks | `benchmarks/protocols/` beside the package, else inside it | |
`URBANVERSE_BANK` | the scene bank that environments load | the shipped streets, in the cache | |
`URBANVERSE_VISION_URL` | OpenAI-compatible endpoint that describes imported assets, up to `/v1` | none: priors | |
`URBANVERSE_VISION_KEY` | its key, if it needs one | none | | `URBANVERSE_VISION_MODEL` | its model | none: needed with
the address | | `URBANVERSE_THREADS` | worker threads on the CPU | the cores this process may use | |
`JAX_COMPILATION_CACHE_DIR` | where commands keep what JAX compiled; "" for nowhere | `jax/` in the cache folder |
| `JAX_LOCAL_DEVICE_IDS` | numbers of the GPUs of a process of a training over several hosts | all of its host |
"""

import dataclasses
import hashlib
import json
import os
import pathlib
import sys
from collections.abc import Mapping, Sequence
from importlib import metadata
from typing import Any

from . import versions

_PACKAGE = pathlib.Path(__file__).resolve().parent
#: Libraries whose versions are part of a bank's key, because they compute its contents.
_BANK_LIBRARIES = ("numpy", "scipy", "shapely", "mujoco", "jax")


def cache_dir(*parts: str) -> pathlib.Path:
    """The cache folder, or a folder inside it. It is not created here."""
    own = os.environ.get("URBANVERSE_CACHE")
    if own:
        base = pathlib.Path(own)
    else:
        xdg = os.environ.get("XDG_CACHE_HOME")
        base = (pathlib.Path(xdg) if xdg else pathlib.Path.home() / ".cache") / "urbanverse_mjx"
    return base.expanduser().absolute().joinpath(*parts)


def use_compilation_cache() -> pathlib.Path:
    """Lets JAX keep compiled programs in the cache folder, at most 4 GiB, and reuse them in later processes. Call it
    before JAX is imported; environment variables have priority.

    Returns:
      the folder that JAX uses.
    """
    os.environ.setdefault("JAX_COMPILATION_CACHE_DIR", str(cache_dir("jax")))
    os.environ.setdefault("JAX_COMPILATION_CACHE_MAX_SIZE", str(4 * 2**30))
    return pathlib.Path(os.environ["JAX_COMPILATION_CACHE_DIR"])


def use_blas_kernel(name: str) -> None:
    """Lets OpenBLAS take the kernel of this name in processes that begin after it, whatever their processor is; the
    environment variable `OPENBLAS_CORETYPE` has priority."""
    os.environ.setdefault("OPENBLAS_CORETYPE", name)


def set_xla_flags(flags: Mapping[str, str]) -> None:
    """Sets options of XLA that `XLA_FLAGS` does not have yet; XLA reads them when JAX first uses a device."""
    words = os.environ.get("XLA_FLAGS", "").split()
    known = {word.lstrip("-").partition("=")[0] for word in words}
    words += [f"--{name}={value}" for name, value in flags.items() if name not in known]
    os.environ["XLA_FLAGS"] = " ".join(words)


def has_all_gpus() -> bool:
    """Whether this process of a training over several hosts has all GPUs that it sees: not if
    `JAX_LOCAL_DEVICE_IDS` selects some, or Slurm or Open MPI started more processes than hosts."""
    if os.environ.get("JAX_LOCAL_DEVICE_IDS"):
        return False
    tasks = int(os.environ.get("SLURM_NTASKS", "1"))
    hosts = int(os.environ.get("SLURM_STEP_NUM_NODES", tasks))
    return tasks <= hosts and int(os.environ.get("OMPI_COMM_WORLD_LOCAL_SIZE", "1")) == 1


def asset_root() -> pathlib.Path:
    """Returns the folder of the asset index.

    Raises:
      ValidationError: the folder named by `URBANVERSE_ASSET_ROOT`, or the one that belongs to the package, is not
        there.
    """
    return _data_root("assets_index", "URBANVERSE_ASSET_ROOT")


def imported_assets() -> pathlib.Path:
    """Returns the folder of the user's imported assets, in the cache, without creating it."""
    return cache_dir("assets", "imported")


@dataclasses.dataclass(frozen=True)
class VisionEndpoint:
    """Endpoint of the vision model that describes images; `key` is empty if the endpoint needs none."""

    url: str
    model: str
    key: str = dataclasses.field(default="", repr=False)


def vision_endpoint() -> VisionEndpoint | None:
    """Returns the endpoint from the environment variables, or None; without an address nothing is sent.

    Raises:
      ValidationError: the address is not http or https, or no model is set.
    """
    url = os.environ.get("URBANVERSE_VISION_URL", "").strip().rstrip("/")
    if not url:
        return None
    if not url.startswith(("http://", "https://")):
        raise _fail("URBANVERSE_VISION_URL", repr(url), "an address with http or https", "unset it to use the priors")
    model = os.environ.get("URBANVERSE_VISION_MODEL", "").strip()
    if not model:
        raise _fail("URBANVERSE_VISION_MODEL", "nothing", "a model's name", "or unset URBANVERSE_VISION_URL")
    return VisionEndpoint(url, model, os.environ.get("URBANVERSE_VISION_KEY", "").strip())


def scene_root() -> pathlib.Path:
    """Returns the folder of the shipped scenes.

    Raises:
      ValidationError: the folder named by `URBANVERSE_SCENE_ROOT`, or the one that belongs to the package, is not
        there.
    """
    return _data_root("scenes", "URBANVERSE_SCENE_ROOT")


def protocol_root() -> pathlib.Path:
    """Returns the folder of the frozen benchmarks.

    Raises:
      ValidationError: the folder named by `URBANVERSE_PROTOCOL_ROOT`, or the one that belongs to the package, is not
        there.
    """
    return _data_root("benchmarks/protocols", "URBANVERSE_PROTOCOL_ROOT")


def chosen_bank_path() -> pathlib.Path | None:
    """Returns the bank file of `URBANVERSE_BANK`, or None."""
    own = os.environ.get("URBANVERSE_BANK")
    return pathlib.Path(own).expanduser().absolute() if own else None


def default_bank_path() -> pathlib.Path:
    """Returns the bank file that environments load: `URBANVERSE_BANK` if set, else `shipped_bank_path`."""
    return chosen_bank_path() or shipped_bank_path()


def shipped_bank_path() -> pathlib.Path:
    """Returns the cache file of the bank of the shipped scenes, named by its key.

    Raises:
      ValidationError: the shipped scenes or the asset index are missing.
    """
    # Only the shipped streets; the library's sets are one folder deeper.
    root = scene_root()
    files = sorted(p for pattern in ("splits.json", "*/graph.json") for p in root.glob(pattern) if p.is_file())
    return _bank_path("bank", [[p.relative_to(root).as_posix(), _file_digest(p)] for p in files])


def user_bank_path(
    graphs: Sequence[pathlib.Path], splits: Sequence[str], seed: int = 0, cousins: int = 1
) -> pathlib.Path:
    """Returns the cache file of a bank of other scene graphs, or of the shipped ones with another seed.

    Its prefix differs from that of the shipped scenes' bank, which it therefore never replaces.

    Raises:
      ValidationError: a graph is not a file, or the asset index is missing.
    """
    for path in graphs:
        if not path.is_file():
            raise _fail(str(path), "no such file", "a scene graph", "check the path")
    rows = [[_file_digest(path), split] for path, split in zip(graphs, splits, strict=True)]
    return _bank_path("user", {"graphs": rows, "seed": seed, "cousins": cousins})


def quick_bank_path(graphs: dict[str, str]) -> pathlib.Path:
    """Returns the cache file of a bank of the shipped streets and further scenes; graphs: content hash of each scene's
    graph."""
    return _bank_path("quick", {"shipped": bank_key(shipped_bank_path()), "graphs": graphs})


def bank_key(path: pathlib.Path) -> str:
    """Returns the key in the name of a cached bank, which is also stored in the bank (`SceneBank.meta["key"]`)."""
    return path.stem.rpartition("-")[2]


def terrain_bank_path(seed: int = 0, levels: int = 10) -> pathlib.Path:
    """Returns the cache file of the terrain for learning to walk; the name depends on its options and its code's
    version."""
    parts = {"seed": seed, "levels": levels, "code": versions.of("scenes")}
    return cache_dir("banks", f"terrain-{_digest(parts)}.npz")


def _bank_path(prefix: str, scenes: Any) -> pathlib.Path:
    """Returns a cache file whose name is a hash of all inputs of a bank, so that a stale bank is never found.

    Args:
      prefix: prefix of the name.
      scenes: JSON value with the digests of the graphs' files, and their options.
    """
    libraries = {name: _version(name) for name in _BANK_LIBRARIES}
    parts = {"scenes": scenes, "code": versions.of("bank"), "libraries": libraries, "assets": assets_digest()}
    return cache_dir("banks", f"{prefix}-{_digest(parts)}.npz")


def assets_digest() -> str:
    """Returns a digest (16 hexadecimal digits) of the names and bytes of all files of the asset index.

    Raises:
      ValidationError: see `asset_root`.
    """
    root = asset_root()
    files = sorted(p for p in root.rglob("*") if p.is_file())
    return _digest([[p.relative_to(root).as_posix(), _file_digest(p)] for p in files])


def _digest(parts: Any) -> str:
    """Returns a digest (16 hexadecimal digits) of a JSON value."""
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()[:16]


def _file_digest(path: pathlib.Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "none"


def use_processor_alone() -> None:
    """Keeps JAX and Warp to the processor in this process, before they have used a device: for workers, in each of
    which they would else take memory of a GPU."""
    os.environ["JAX_PLATFORMS"], os.environ["CUDA_VISIBLE_DEVICES"] = "cpu", ""
    if "jax" in sys.modules:  # it reads the variable when it is imported
        sys.modules["jax"].config.update("jax_platforms", "cpu")


def num_threads() -> int:
    """Returns the number of worker threads on the CPU, at least 1.

    Raises:
      ValidationError: `URBANVERSE_THREADS` is not a whole number from 1 to 1024.
    """
    text = os.environ.get("URBANVERSE_THREADS", "").strip()
    if not text:
        # The affinity mask of this process has fewer cores than os.cpu_count() in most containers.
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if not (text.isascii() and text.isdigit() and 1 <= int(text) <= 1024):
        raise _fail("URBANVERSE_THREADS", repr(text), "a whole number from 1 to 1024", "unset it to use every core")
    return int(text)


def _data_root(name: str, variable: str) -> pathlib.Path:
    own = os.environ.get(variable)
    if own:
        path = pathlib.Path(own).expanduser().absolute()
        if not path.is_dir():
            raise _fail(variable, str(path), "an existing folder", "unset it to use the shipped data")
        return path
    # In a clone the data is beside the package, in a wheel inside it (pyproject.toml, force-include).
    beside, inside = _PACKAGE.parent / name, _PACKAGE / "_data" / name
    for path in (beside, inside):
        if path.is_dir() and (path == inside or (_PACKAGE.parent / "pyproject.toml").is_file()):
            return path
    raise _fail(f"{name}/", f"neither {beside} nor {inside}", "the shipped data", f"install again or set {variable}")


def _fail(where: str, found: str, needed: str, hint: str) -> ValueError:
    # Imported here because the datatypes need numpy, and `urbanverse doctor` reads settings even if numpy is missing.
    from .datatypes.validation import fail

    return fail(where, found, needed, hint)
