"""Error for private modules of another package that have changed."""

from importlib import metadata

from ..datatypes import ValidationError
from ..datatypes.validation import fail


def missing(package: str, needed: str, purpose: str, error: ImportError) -> ValidationError:
    """The error for a private module or name of a package that cannot be imported.

    Args:
      package: its distribution's name.
      needed: versions of it that have the imported names, in pip's notation.
      purpose: their use, a plural.
      error: of the import.
    """
    try:
        found = f"version {metadata.version(package)}"
    except metadata.PackageNotFoundError:
        found = "no such package"
    name = getattr(error, "name_from", None)
    lacking = f"{error.name}.{name}" if name else str(error.name or error)
    return fail(
        package,
        f"{found}, without {lacking}",
        f"{package}{needed}, whose private modules give us {purpose}",
        f'pip install "{package}{needed}"',
    )
