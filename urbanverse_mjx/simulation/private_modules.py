"""What to say where another package's private modules are not as ours knew them."""

from importlib import metadata

from ..datatypes import ValidationError
from ..datatypes.validation import fail


def missing(package: str, needed: str, purpose: str, error: ImportError) -> ValidationError:
    """The error for a private module or name of a package that cannot be imported.

    Args:
      package: its distribution's name. needed: versions of it that are known to have what is taken, as pip writes them.
      purpose: what it is taken for, a plural. error: what the import raised.
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
