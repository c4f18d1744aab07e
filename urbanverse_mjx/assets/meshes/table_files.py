"""Reads tables in Parquet files."""

import pathlib
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from urbanverse_mjx.datatypes import ValidationError


def read_rows(path: pathlib.Path, kind: str, cure: str) -> list[dict[str, Any]]:
    """The rows of a table.

    Args:
      kind: expected kind of file, for error messages.
      cure: advice in error messages.

    Raises:
      ValidationError: the file is cut off or damaged. Damage of files without checksums may remain unnoticed.
    """
    try:
        return pq.read_table(path, page_checksum_verification=True).to_pylist()
    except (pa.ArrowException, OSError, ValueError) as error:
        reason = " ".join(str(error).split())[:80]
        raise ValidationError(f"{path}: found a file that is not whole ({reason}), needed {kind}; {cure}.") from error
