"""Lists declared packages and those that are not installed. Imports only the standard library."""

import importlib.metadata
import importlib.util
import pathlib
import re
import tomllib

#: Modules of packages that are also published under other names, such as `opencv-python`.
_MODULES = {"opencv-python-headless": "cv2"}
#: Packages that are only needed to make or show scenes and videos, not to train and evaluate with a bank.
MAKERS = frozenset({"coacd", "imageio-ffmpeg", "pycolmap", "usd-core", "viser", "websockets"})
#: Packages that `urbanverse deploy` needs.
ON_A_ROBOT = frozenset({"numpy", "onnxruntime", "pillow", "pyzmq", "tyro"})


def declared() -> list[str]:
    """The requirements of the default installation, e.g. "warp-lang==1.18.0".

    In a clone, `pyproject.toml` is used instead of the installed metadata, which may be outdated after a `git pull`.
    """
    project = pathlib.Path(__file__).parents[2] / "pyproject.toml"
    if project.is_file():
        return list(tomllib.loads(project.read_text(encoding="utf-8"))["project"]["dependencies"])
    try:
        lines = importlib.metadata.requires("urbanverse_mjx") or []
    except importlib.metadata.PackageNotFoundError:
        return []
    return [line for line in lines if "extra ==" not in line]


def name_of(requirement: str) -> str:
    """The package name of a requirement."""
    found = re.match(r"[A-Za-z0-9._-]+", requirement)
    return found.group() if found else requirement


def missing() -> list[str]:
    """Names of the declared packages that are not installed."""
    absent = []
    for name in map(name_of, declared()):
        try:
            importlib.metadata.distribution(name)
        except importlib.metadata.PackageNotFoundError:
            if name not in _MODULES or importlib.util.find_spec(_MODULES[name]) is None:
                absent.append(name)
    return absent
