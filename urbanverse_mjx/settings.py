"""The one place that reads the environment: where caches and data lie, and how many threads to use.

| variable | meaning | default |
| --- | --- | --- |
| `URBANVERSE_CACHE` | folder for what commands build (banks, meshes, kernels) | `$XDG_CACHE_HOME/urbanverse_mjx` |
| `XDG_CACHE_HOME` | folder of all caches | `~/.cache` |
| `URBANVERSE_ASSET_ROOT` | the asset index | `assets_index/` beside the package, else inside it |
| `URBANVERSE_SCENE_ROOT` | the shipped scenes | `scenes/` beside the package, else inside it |
| `URBANVERSE_PROTOCOL_ROOT` | the frozen benchmarks | `benchmarks/protocols/` beside the package, else inside it |
| `URBANVERSE_BANK` | the scene bank that environments load | in the cache, named by what it is made of |
| `URBANVERSE_VISION_URL` | OpenAI-compatible endpoint that describes imported assets, up to `/v1` | none: priors |
| `URBANVERSE_VISION_KEY` | its key, where it wants one | none |
| `URBANVERSE_VISION_MODEL` | the model it shall use | none: needed with the address |
| `URBANVERSE_THREADS` | worker threads on the CPU | the cores this process may use |
"""

import dataclasses
import hashlib
import os
import pathlib

_PACKAGE = pathlib.Path(__file__).resolve().parent
#: Rooms whose code decides what a bank holds.
_BANK_ROOMS = ("datatypes", "assets", "materialisation", "scene", "robots")


def cache_dir(*parts: str) -> pathlib.Path:
    """The cache folder, or a folder inside it. It is not created here."""
    own = os.environ.get("URBANVERSE_CACHE")
    if own:
        base = pathlib.Path(own)
    else:
        xdg = os.environ.get("XDG_CACHE_HOME")
        base = (pathlib.Path(xdg) if xdg else pathlib.Path.home() / ".cache") / "urbanverse_mjx"
    return base.expanduser().absolute().joinpath(*parts)


def asset_root() -> pathlib.Path:
    """Folder of the asset index.

    Raises:
      NounError: the folder named by `URBANVERSE_ASSET_ROOT`, or the one that belongs to the package, is not there.
    """
    return _data_root("assets_index", "URBANVERSE_ASSET_ROOT")


def imported_assets() -> pathlib.Path:
    """Folder of the assets that this user imported, in the cache. It is not created here."""
    return cache_dir("assets", "imported")


@dataclasses.dataclass(frozen=True)
class VisionEndpoint:
    """Where pictures are sent to be described; `key` is empty where the endpoint wants none."""

    url: str
    model: str
    key: str = dataclasses.field(default="", repr=False)


def vision_endpoint() -> VisionEndpoint | None:
    """The endpoint that the environment names, or None: without an address nothing is ever sent.

    Raises:
      NounError: an address that is not http or https, or no model beside it.
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
    """Folder of the shipped scenes.

    Raises:
      NounError: the folder named by `URBANVERSE_SCENE_ROOT`, or the one that belongs to the package, is not there.
    """
    return _data_root("scenes", "URBANVERSE_SCENE_ROOT")


def protocol_root() -> pathlib.Path:
    """Folder of the frozen benchmarks.

    Raises:
      NounError: the folder named by `URBANVERSE_PROTOCOL_ROOT`, or the one that belongs to the package, is not there.
    """
    return _data_root("benchmarks/protocols", "URBANVERSE_PROTOCOL_ROOT")


def default_bank_path() -> pathlib.Path:
    """File of the bank of the shipped scenes, which `urbanverse scene bank` writes and environments load.

    Unless `URBANVERSE_BANK` names a file, the name changes with the scenes, the asset index and the code that makes
    a bank of them: a stale bank is never found.

    Raises:
      NounError: the shipped scenes or the asset index are not there.
    """
    own = os.environ.get("URBANVERSE_BANK")
    if own:
        return pathlib.Path(own).expanduser().absolute()
    digest = hashlib.sha256()
    # Of the scenes the shipped streets alone: the library's sets lie a folder deeper.
    folders = [(scene_root(), "splits.json"), (scene_root(), "*/graph.json"), (asset_root(), "**/*")]
    folders += [(_PACKAGE / room, "**/*.py") for room in _BANK_ROOMS]
    for folder, pattern in folders:
        for path in sorted(p for p in folder.glob(pattern) if p.is_file() and "__pycache__" not in p.parts):
            digest.update(f"{folder.name}/{path.relative_to(folder).as_posix()}\0".encode())
            digest.update(hashlib.sha256(path.read_bytes()).digest())
    return cache_dir("banks", f"bank-{digest.hexdigest()[:16]}.npz")


def terrain_bank_path() -> pathlib.Path:
    """File of the terrain that robots learn to walk on; the name changes with the code that makes it."""
    digest = hashlib.sha256()
    for room in ("scene", "datatypes"):
        for path in sorted((_PACKAGE / room).rglob("*.py")):
            digest.update(hashlib.sha256(path.read_bytes()).digest())
    return cache_dir("banks", f"terrain-{digest.hexdigest()[:16]}.npz")


def num_threads() -> int:
    """Worker threads to use on the CPU, at least 1.

    Raises:
      NounError: `URBANVERSE_THREADS` is no whole number from 1 to 1024.
    """
    text = os.environ.get("URBANVERSE_THREADS", "").strip()
    if not text:
        # The cores of this process's affinity mask: fewer than os.cpu_count() inside most containers.
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
    # A clone keeps the data beside the package; a wheel carries it inside (pyproject.toml, force-include).
    beside, inside = _PACKAGE.parent / name, _PACKAGE / "_data" / name
    for path in (beside, inside):
        if path.is_dir() and (path == inside or (_PACKAGE.parent / "pyproject.toml").is_file()):
            return path
    raise _fail(f"{name}/", f"neither {beside} nor {inside}", "the shipped data", f"install again or set {variable}")


def _fail(where: str, found: str, needed: str, hint: str) -> ValueError:
    # Imported late: the nouns need numpy, and `urbanverse doctor` reads settings where numpy may be missing.
    from .datatypes.validation import fail

    return fail(where, found, needed, hint)
