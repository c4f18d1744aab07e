"""`urbanverse assets`: queries the asset index, and rebuilds its contents."""

import difflib
import json
from collections.abc import Sequence
from typing import Annotated, Any, Literal

import tyro

from ._options import json_object, parse_subcommand

#: The collections of `assets.selection.libraries`.
Kind = Literal["object", "sky", "road", "sidewalk"]
#: A label of words.
Text = Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="TEXT")]


def list_assets(leaf: Annotated[str | None, tyro.conf.arg(metavar="NAME")] = None) -> None:
    """List the base shapes and the assets you imported, or those of one leaf category.

    Args:
      leaf: a leaf of the ontology, e.g. "bollard".
    """
    from ..assets import full_index

    index = full_index()
    _print_table(index.by_leaf(leaf) if leaf else index.records)


def find(label: Text) -> None:
    """Show the leaf and the base shapes to which a label of a scene graph is matched.

    Args:
      label: name of the object from a detector or a person, e.g. "trash can".
    """
    from ..assets import full_index, match_label

    index = full_index()
    leaf = match_label(label)
    records = index.by_label(label)
    print(f"{label!r} is the leaf {leaf!r}")
    if records and index.stand_in(leaf) != leaf:
        print(f"no asset of this leaf yet; {index.stand_in(leaf)!r} is used instead")
    _print_table(records)
    if not records:
        near = difflib.get_close_matches(leaf, index.leaves, n=3, cutoff=0.0)
        print(f"no asset of this leaf yet; the nearest leaves with assets are {', '.join(near)}")


def show(label: Text, as_json: Annotated[bool, tyro.conf.arg(name="json")] = False) -> None:
    """Show the leaf of a free label: its records, median sizes and mass, and the values for filters.

    Args:
      label: free text, e.g. "cafe parasol".
      as_json: print JSON instead.
    """
    from ..assets.selection.overview import overview
    from ..assets.selection.search import full_library

    found = overview(label, full_library())
    if as_json:
        print(json.dumps(found, ensure_ascii=False))
        return
    size = " x ".join(f"{found['median'][side]:.3g}" for side in ("length", "width", "height"))
    print(f"{label!r} is the leaf {found['leaf']!r} ({' / '.join(found['category'][:2])}), score {found['score']:.2f}")
    print(f"records: {found['records']}, of them {found['base_shapes']} base shapes as the recipes make them")
    print(f"median: {size} m (length x width x height), {found['median']['mass']:.3g} kg")
    for name, (low, high) in found["ranges"].items():
        print(f"  {name:<12} {low:.3g} to {high:.3g}")
    for name, counts in found["values"].items():
        print(f"  {name:<20} " + ", ".join(f"{word} {n}" for word, n in counts.items()))
    if found["others"]:
        print("also near: " + ", ".join(f"{leaf} {score:.2f}" for leaf, score in found["others"]))


def search(
    query: Annotated[str | None, tyro.conf.Positional, tyro.conf.arg(metavar="[TEXT]")] = None,
    library: Kind = "object",
    filters: Annotated[str, tyro.conf.arg(aliases=["-f"], metavar="JSON")] = "{}",
    count: int = 20,
) -> None:
    """Search all objects, skies or ground materials by free text and filters.

    Args:
      query: free text, e.g. "a red wooden chair".
      library: what to search.
      filters: JSON object of filters, e.g. '{"mass_range": [1, 5], "movable": true}'.
      count: number of results to print.
    """
    from ..assets.selection import libraries
    from ..assets.selection.search import full_library

    conditions = json_object(filters, "--filters")
    chosen = full_library() if library == "object" else libraries.library(library)
    uids = chosen.get_uids_conditioned(query=query, top_k=count, **conditions)
    rows = chosen.load_annotations(uids[:count]).values()
    if library == "object":
        _print_rows(rows)
    else:
        print("\n".join(f"{row['uid']:<44} {row['description']}" for row in rows))
    if query is None:
        print(f"{len(uids)} records; filters are {', '.join(chosen.filters())}")


def explain(
    field: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="NAME")], library: Kind = "object"
) -> None:
    """Explain a field of an annotation: its meaning, unit and source.

    Args:
      field: its name, e.g. "required_force", or "turbidity" of a sky.
      library: the collection of the field.
    """
    from ..assets.selection import libraries

    print(libraries.library(library).explain_annotation(field))


def match(label: Text, size: tuple[float, float, float], count: int = 5) -> None:
    """Match an object of a scene graph: label and box to the assets that fit best.

    Args:
      label: free text.
      size: along its heading, across and up, m.
      count: number of results to print.
    """
    from ..assets.selection.matching import Matcher
    from ..assets.selection.search import full_library

    for found in Matcher(full_library()).match(label, size, count=count):
        print(f"{found.uid:<44} distortion {found.distortion:.3f}  yaw {found.yaw:.2f} rad")


def check(repair: bool = False) -> None:
    """Check the built parts of the index on this machine.

    Args:
      repair: also rebuild damaged parts.
    """
    from ..assets.selection import integrity, libraries

    # A damaged catalogue cannot be opened, so this check does not load it.
    problems = integrity.repair() if repair else integrity.problems()
    for name in ("sky", "road", "sidewalk"):
        collection = libraries.library(name)
        problems += collection.repair() if repair else collection.check_integrity()
    print("\n".join(dict.fromkeys(problems)) or "all is well")


def _print_rows(rows: Any) -> None:
    for row in rows:
        size = " x ".join(f"{side:.2f}" for side in row["extent_xyz"])
        print(f"{row['uid']:<44} {size:<22} {row['mass']:>9.1f}  {row['description']}")


def _print_table(records: Sequence) -> None:
    from ..assets.records.store import as_catalogued

    print(f"{'uid':<44} {'along x across x up, m':<22} {'mass, kg':>9}  description")
    _print_rows(r.to_json() for r in as_catalogued(records))


#: Commands that query the index; `assets.__main__.COMMANDS` holds those that build it.
COMMANDS = {
    "list": list_assets,
    "find": find,
    "show": show,
    "search": search,
    "explain": explain,
    "match": match,
    "check": check,
}


def main(argv: Sequence[str]) -> int:
    """Runs `urbanverse assets`."""
    from ..assets import __main__ as maintenance

    parse_subcommand({**COMMANDS, **maintenance.COMMANDS}, argv, "urbanverse assets")
    return 0
