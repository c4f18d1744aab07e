"""A policy's arrays in fewer bytes: compressed with bytes of equal significance together, values the same to the bit.

Orbax compresses each array as it lies in memory. The first bytes of floating-point numbers, sign and exponent, differ
little between neighbours, but not where they alternate with the others. Readers notice no difference, because each
array's metadata names its compressor.
"""

import json
import pathlib
import shutil
from typing import Any

from ..work_folder import work_folder

#: Of Zarr, see https://zarr-specs.readthedocs.io/en/latest/v2/v2.0.html: 1 is the shuffle of bytes.
_COMPRESSOR = {"id": "blosc", "cname": "zstd", "clevel": 9, "shuffle": 1}
_METADATA = "/.zarray"
#: What Orbax stores the arrays in.
_STORED = ("manifest.ocdbt", "d", "ocdbt.process_*")


def pack_arrays(folder: pathlib.Path) -> None:
    """Stores the arrays of a folder that Orbax wrote anew. Nothing else may read or write it meanwhile.

    Args:
      folder: of one policy, without `policy.json`, whose checksums are of the files as they are now.
    """
    import tensorstore as ts

    with work_folder(".pack-", folder.absolute().parent) as work:
        packed = work / "arrays"
        source = _store(folder)
        arrays = [key.decode() for key in source.list().result() if key.decode().endswith(_METADATA)]
        # One transaction, so that all arrays come into one file.
        with ts.Transaction() as transaction:
            target = _store(packed, config={"max_inline_value_bytes": 100}).with_transaction(transaction)
            for key in arrays:
                name = key.removesuffix(_METADATA) + "/"
                metadata = json.loads(source.read(key).result().value) | {"compressor": _COMPRESSOR}
                before = ts.open({"driver": "zarr", "kvstore": _spec(folder, path=name)}).result()
                spec = {"driver": "zarr", "metadata": metadata}
                after = ts.open(spec, kvstore=target / name, create=True, transaction=transaction).result()
                after.write(before.read().result()).result()
        for path in [path for pattern in _STORED for path in folder.glob(pattern)]:
            shutil.rmtree(path) if path.is_dir() else path.unlink()
        for path in packed.iterdir():
            path.replace(folder / path.name)


def _spec(folder: pathlib.Path, **more: Any) -> dict[str, Any]:
    return {"driver": "ocdbt", "base": f"file://{folder.absolute()}/", **more}


def _store(folder: pathlib.Path, **more: Any) -> Any:
    import tensorstore as ts

    return ts.KvStore.open(_spec(folder, **more)).result()
