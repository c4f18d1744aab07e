"""Finds and repairs missing or damaged parts of the index on this machine."""

from ..collision.hulls import HullStore
from ..collision.hulls import store_path as hulls_path
from ..meshes.base_shapes import shape_of
from ..previews.thumbnails import damaged
from ..records.catalogue import catalogue_hash, disagreements, leaf_counts
from ..records.index import load_index
from ..records.store import build_store, forget, inputs_key, load_store, recorded_content, store_path


def problems() -> list[str]:
    """One sentence per missing or damaged file; empty if there is none."""
    found = _of_catalogue()
    for record in load_index().records:
        try:
            shape_of(record)
        except ValueError as error:
            found.append(str(error))
            break
    if not HullStore.load(hulls_path()).hulls:
        found.append(f"{hulls_path().name}: no collision hulls; take the file from the repository again.")
    broken = damaged()
    if broken:
        found.append(f"thumbnails: {len(broken)} files are no whole images, first {broken[0].name}.")
    return found


def _of_catalogue() -> list[str]:
    if not store_path().is_file():
        return [f"catalogue {inputs_key()}: not built yet."]
    forget()
    try:
        table = load_store(store_path())
    except ValueError as error:
        return [str(error)]
    found = []
    if catalogue_hash(table) != recorded_content(table):
        found.append(f"{store_path().name}: its content is not what was written.")
    counts = {row["values"]: row["counts"] for row in table["category"].value_counts().to_pylist()}
    if counts != leaf_counts():
        found.append(f"{store_path().name}: {table.num_rows} records, needed {sum(leaf_counts().values())}.")
    wrong = disagreements(table)
    if wrong:
        uid, reason = next(iter(wrong.items()))
        found.append(f"{store_path().name}: the fields of {len(wrong)} records contradict each other; {uid}: {reason}.")
    return found


def repair() -> list[str]:
    """Builds an invalid catalogue again and drops broken thumbnails; returns the remaining faults."""
    if _of_catalogue():
        store_path().unlink(missing_ok=True)
        forget()
        build_store(show_progress=False)
    for path in damaged():
        path.unlink()
    return problems()
