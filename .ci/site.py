"""Hooks of mkdocs.

Patterns in the navigation become the pages that they match, CHANGELOG.md and the notebooks join the site, and a page
that loads a script, a style or a font from another host is reported (an error with `--strict`).
"""

import json
import logging
import pathlib
import re
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

_log = logging.getLogger("mkdocs.hooks.site")
_FOREIGN = re.compile(
    r"""<(?:script|img|iframe)[^>]+src="?https?:[^>]+>|<link[^>]+rel="?(?:stylesheet|preconnect)[^>]+https?:[^>]+>"""
)
#: It lies in the repository's root, outside the folder of the site, and its links start there.
CHANGES = "CHANGELOG.md"


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Replaces patterns such as `decisions/*.md`, so that a new page needs no entry of its own."""
    docs = pathlib.Path(config.docs_dir)
    named = set(_names(config.nav))
    config.nav = _expanded(config.nav, docs, named)
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Adds the list of changes, and a page for each notebook, which lies beside it to be taken away."""
    text = (pathlib.Path(config.config_file_path).parent / CHANGES).read_text(encoding="utf-8")
    files.append(File.generated(config, CHANGES, content=text.replace("](docs/", "](")))
    docs = pathlib.Path(config.docs_dir)
    for path in sorted(docs.glob("**/*.ipynb")):
        name = path.relative_to(docs).with_suffix(".md").as_posix()
        files.append(File.generated(config, name, content=notebook_page(path)))
    return files


def notebook_page(path: pathlib.Path) -> str:
    """A notebook without its outputs, as Markdown; links to other notebooks lead to their pages."""
    parts = []
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        text = "".join(cell["source"])
        parts.append(f"```python\n{text}\n```" if cell["cell_type"] == "code" else text.replace(".ipynb)", ".md)"))
    title, rest = parts[0], parts[1:]
    return "\n\n".join([title, f"[This page as a notebook]({path.name})", *rest]) + "\n"


def on_page_markdown(markdown: str, page: Page, **_: Any) -> str:
    """Leads links to notebooks to their pages; a notebook's own page keeps the one to its file."""
    if page.file.src_uri.startswith("notebooks/"):
        return markdown
    return re.sub(r"\]\(([^)\s]+)\.ipynb\)", r"](\1.md)", markdown)


def on_post_page(output: str, page: Page, config: MkDocsConfig) -> str:
    """Holds the site to what can be read without a network."""
    del config
    for found in _FOREIGN.findall(output):
        _log.warning("%s loads from another host: %s", page.file.src_uri, found)
    return output


def _names(entry: Any) -> list[str]:
    """All files and patterns of an entry of the navigation."""
    if isinstance(entry, str):
        return [entry]
    children = entry.values() if isinstance(entry, dict) else entry
    return [name for child in children for name in _names(child)]


def _expanded(entry: Any, docs: pathlib.Path, named: set[str]) -> Any:
    if isinstance(entry, dict):
        return {title: _expanded(child, docs, named) for title, child in entry.items()}
    if isinstance(entry, list):
        return [page for child in entry for page in _listed(_expanded(child, docs, named))]
    if "*" not in entry:
        return entry
    pages = (path.with_suffix(".md") if path.suffix == ".ipynb" else path for path in docs.glob(entry))
    found = sorted(path.relative_to(docs).as_posix() for path in pages)
    return [name for name in found if name not in named]


def _listed(pages: Any) -> list[Any]:
    return pages if isinstance(pages, list) else [pages]
