"""`python -m urbanverse_mjx.assets COMMAND`: builds, draws and exports assets; `--help` lists the commands."""

import pathlib
from typing import Annotated, Literal

import tyro
from rich.console import Console
from rich.progress import track

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.progress import Progress

from .exporting.export_command import export
from .importing.command import import_assets
from .previews.appearance_sheets import COMMANDS as APPEARANCES


def build(out: pathlib.Path | None = None) -> None:
    """Writes the catalogue of all 102,444 records as Parquet, into the cache by default.

    Args:
      out: file to write.
    """
    from .records.store import build_store, load_store, recorded_content, shipped_content

    path = build_store(out)
    table = load_store(path)
    meshes, content = table.num_rows - table["recipe"].null_count, recorded_content(table)
    Console().print(f"{path}: {table.num_rows} records, {meshes} with a mesh, content {content}", soft_wrap=True)
    if content != shipped_content():
        Console(stderr=True).print(
            f"the committed content is {shipped_content()}: the tables or the code have changed since; "
            "`urbanverse assets index` writes it anew.",
            soft_wrap=True,
        )


def index(jobs: int = 2) -> None:
    """Writes the files of assets_index/ that depend on the recipes: base shapes, their measures, and the catalogue's
    hash.

    Args:
      jobs: processes at once.
    """
    from .meshes.base_shapes import save_shapes
    from .records.base_build import build_base
    from .records.catalogue import build_catalogue
    from .records.index import save_index
    from .records.store import save_content

    with Progress() as progress:
        records, shapes = build_base(jobs, progress.task("base shapes"))
    path = save_index(records)
    measures = save_shapes(shapes)
    save_content(build_catalogue(records))
    content = records.content_hash()[:16]
    Console().print(
        f"{path.name}, {measures.name}: {len(records.records)} records of {len(records.leaves)} leaves, "
        f"content {content}"
    )


def hulls(
    jobs: int = 2,
    leaf: Annotated[str | None, tyro.conf.arg(metavar="NAME")] = None,
    again: bool = False,
    close: bool = False,
    layouts: tuple[pathlib.Path, ...] = (),
    keep_first: bool = False,
    revision: Literal[1, 2] = 1,
) -> None:
    """Makes missing collision hulls of records' meshes and drops unused hulls.

    Args:
      jobs: processes at once.
      leaf: only this leaf.
      again: also make existing hulls again (after a change of the decomposition).
      close: make closer hulls, of catalogue and regional buildings, instead of the first ones.
      layouts: folders of compiled scenes; closer hulls only of shapes that a robot can touch there.
      keep_first: make none, and store that the shapes of these scenes have no closer ones than the store has now;
        before a set is frozen.
      revision: of the store of closer hulls; version 2 of the benchmarks is frozen with the first.
    """
    from .collision.close_hulls import build_close
    from .collision.decompose import build_missing
    from .collision.within_reach import layouts_in

    if layouts and not close:
        raise ValidationError("--layouts: found it without --close, needed both; first hulls are made of all shapes.")
    if keep_first and (again or not layouts):
        raise ValidationError("--keep-first: found --again or no --layouts, needed --layouts alone.")
    if revision != 1 and not close:
        raise ValidationError("--revision: found it without --close, needed both; first hulls have no revisions.")
    if close:
        chosen = layouts_in(layouts) if layouts else None
        kind = "close" if revision == 1 else f"close-{revision}"
        build_close(leaf, jobs, again, Console().print, chosen, keep_first, kind)
    else:
        build_missing(jobs, leaf, again, Console().print)


def regional(jobs: int = 2) -> None:
    """Writes the index and the hulls of the regional buildings, which do not belong to the catalogue.

    Args:
      jobs: processes at once.
    """
    from .collision.hulls import regional_store_path
    from .collision.regional import build_regional
    from .records.regional import index_path

    with Progress() as progress:
        records, store = build_regional(jobs, progress.task("regional buildings"))
    count, size = sum(len(h) for h in store.hulls.values()), regional_store_path().stat().st_size
    Console().print(
        f"{index_path().name}: {len(records.records)} records; {regional_store_path().name}: "
        f"{len(store.hulls)} meshes, {count} hulls, {size} bytes"
    )


def sign_words(fonts: pathlib.Path) -> None:
    """Draws the words of regional shop signs anew, after `words.toml` has changed.

    Args:
      fonts: folder below which the Noto fonts lie (Debian: fonts-noto-core, fonts-noto-cjk).
    """
    from .recipes.building.regional.words import draw_words

    path = draw_words(fonts)
    Console().print(f"{path.name}: {path.stat().st_size} bytes")


def gallery(
    out: pathlib.Path | None = None, middle: Annotated[str | None, tyro.conf.arg(metavar="NAME")] = None
) -> None:
    """Draws a contact sheet per middle category (needs an OpenGL that renders off screen: MUJOCO_GL=egl or osmesa).

    Args:
      out: folder to write into; default: the cache.
      middle: only this category.
    """
    from urbanverse_mjx.settings import cache_dir

    from .previews.gallery import middle_sheets
    from .records.index import load_index

    folder = out or cache_dir("assets", "gallery")
    wanted = None if middle is None else [middle]
    paths = middle_sheets(load_index(), folder, wanted, lambda names: track(names, "contact sheets"))
    Console().print(f"{folder}: {len(paths)} contact sheets", soft_wrap=True)


def contact_sheet(out: pathlib.Path = pathlib.Path("docs/contact_sheet.png"), columns: int = 6) -> None:
    """Draws a tile per middle category, of the leaf with the most records (needs an OpenGL that renders off screen).

    Args:
      out: PNG to write.
      columns: tiles in a row.
    """
    from .previews import gallery
    from .records.index import load_index

    records = load_index()
    names = gallery.overview_leaves(records)
    path = gallery.contact_sheet(
        records, out, names, columns, (270, 160), progress=lambda leaves: track(leaves, "middle categories")
    )
    Console().print(f"{path}: {len(names)} middle categories, {path.stat().st_size} bytes")


def thumbnails(leaf: Annotated[str | None, tyro.conf.arg(metavar="NAME")] = None) -> None:
    """Draws the missing thumbnails of base shapes into the cache; can be interrupted and continued.

    Args:
      leaf: only this leaf.
    """
    from .previews.thumbnails import draw_missing, folder
    from .records.index import load_index

    records = load_index().records if leaf is None else load_index().by_leaf(leaf)
    with Progress() as progress:
        drawn, there = draw_missing(records, progress.task("thumbnails"))
    Console().print(f"{folder()}: {drawn} drawn, {there} were there", soft_wrap=True)


def labels(folder: pathlib.Path | None = None) -> None:
    """Writes assets_index/labels.csv, which maps every label of six public vocabularies to a leaf or to none.

    Args:
      folder: folder of the vocabularies' lists; without it, the labels of the stored table are mapped again.
    """
    from urbanverse_mjx.settings import asset_root

    from .categories.labels import map_labels, read_vocabularies, save_labels, stored_vocabularies

    rows = map_labels(stored_vocabularies() if folder is None else read_vocabularies(folder))
    path = save_labels(rows, asset_root() / "labels.csv")
    empty = sum(row.leaf is None for row in rows)
    Console().print(f"{path.name}: {len(rows)} labels, {empty} of them without a leaf")


#: Commands, also of `urbanverse assets`.
COMMANDS = {
    "build": build,
    "index": index,
    "hulls": hulls,
    "regional": regional,
    "sign-words": sign_words,
    "thumbnails": thumbnails,
    "gallery": gallery,
    "contact-sheet": contact_sheet,
    "export": export,
    "import": import_assets,
    **{f"looks-{name}": function for name, function in APPEARANCES.items()},
    "labels": labels,
}

if __name__ == "__main__":
    tyro.extras.subcommand_cli_from_dict(COMMANDS)
