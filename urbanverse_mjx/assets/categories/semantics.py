"""Ranks leaves for a free label without a neural network: by names and synonyms, then by common letters and words.

The text embedding is TF-IDF over words and sequences of 3 to 5 letters within words. Every known name of a leaf (its
own, its synonyms, the labels of public vocabularies) is a document, and the similarity of a leaf is that of its most
similar name.
"""

import collections
import functools
import json
import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np
from scipy import sparse

from urbanverse_mjx.datatypes.text_features import text_features
from urbanverse_mjx.settings import asset_root

from . import ontology
from .labels import mapped_labels
from .ontology import UnknownLabelError

#: Scores of exact names and of nouns of phrases, which rank before embeddings.
EXACT_SCORE, GUESS_SCORE = 1.0, 0.9
MAX_EMBEDDING_SCORE = 0.79  # lower than `GUESS_SCORE` by more than a query can add for colours and materials


class TextEmbedder(Protocol):
    """Converts texts to vectors of length 1."""

    def __call__(self, texts: Sequence[str]) -> np.ndarray:
        """(n, d)."""
        ...


class NgramIndex:
    """Index of leaves by the letters and words of their names."""

    def __init__(self, names: Sequence[tuple[str, str]]) -> None:
        """Args: names: (name, leaf) documents."""
        self.leaves = tuple(ontology.categories())
        place = {leaf: k for k, leaf in enumerate(self.leaves)}
        self._leaf_of = np.array([place[leaf] for _, leaf in names])
        counts = [text_features(ontology.normalised(name)) for name, _ in names]
        frequency = collections.Counter(feature for count in counts for feature in count)
        self._column = {feature: k for k, feature in enumerate(frequency)}
        self._idf = np.array([math.log((1 + len(names)) / (1 + n)) + 1.0 for n in frequency.values()])
        self._documents = self._matrix(counts)

    def scores(self, label: str) -> np.ndarray:
        """(659,) cosine with the nearest name of each leaf."""
        query = self._matrix([text_features(ontology.normalised(label))])
        cosine = np.asarray((self._documents @ query.T).todense()).ravel()
        best = np.zeros(len(self.leaves))
        np.maximum.at(best, self._leaf_of, cosine)
        return best

    def _matrix(self, counts: Sequence[dict[str, float]]) -> sparse.csr_matrix:
        """One row of length 1 per text (of length 0 if it has no known feature)."""
        known = [[(self._column[f], x) for f, x in count.items() if f in self._column] for count in counts]
        columns = np.array([k for row in known for k, _ in row], dtype=np.int64)
        weights = np.array([x for row in known for _, x in row]) * self._idf[columns]
        rows = np.repeat(np.arange(len(known)), [len(row) for row in known])
        norm = np.sqrt(np.bincount(rows, weights**2, len(known)))
        return sparse.csr_matrix((weights / norm[rows], (rows, columns)), (len(known), len(self._column)))


def known_names() -> list[tuple[str, str]]:
    """Every known (name, leaf): leaves, synonyms, labels of vocabularies."""
    synonyms: dict[str, list[str]] = json.loads((asset_root() / "synonyms.json").read_text(encoding="utf-8"))
    names = [(leaf, leaf) for leaf in ontology.categories()]
    names += [(name, leaf) for leaf, others in synonyms.items() for name in others]
    for row in mapped_labels().values():
        if row.leaf is not None:
            names.append((row.label.rpartition("=")[2], row.leaf))
    return list(dict.fromkeys((ontology.normalised(name), leaf) for name, leaf in names))


@functools.cache
def default_index() -> NgramIndex:
    """The index of all known names."""
    return NgramIndex(known_names())


def rank_leaves(label: str, count: int = 5, embedder: TextEmbedder | None = None) -> list[tuple[str, float]]:
    """The leaves that a label most likely denotes, with scores, best first.

    A name or synonym scores 1, the noun of a phrase 0.9; all others by the embedding.

    Args:
      label: free text.
      count: how many.
      embedder: None for letters and words; see `neural.SentenceEmbedder`.

    Raises: UnknownLabelError: no word or letters in common with any name.
    """
    if embedder is None:
        scores = np.minimum(default_index().scores(label), MAX_EMBEDDING_SCORE)
    else:
        scores = _embedded(embedder, label)
    leaves = default_index().leaves
    place = {leaf: k for k, leaf in enumerate(leaves)}
    try:
        scores[place[ontology.match_label(label)]] = EXACT_SCORE
    except UnknownLabelError:
        try:
            scores[place[ontology.guess_leaf(label)]] = GUESS_SCORE
        except UnknownLabelError:
            if scores.max() <= 0.0:
                raise
    order = np.argsort(-scores, kind="stable")[:count]
    return [(leaves[k], float(scores[k])) for k in order if scores[k] > 0.0]


def _embedded(embedder: TextEmbedder, label: str) -> np.ndarray:
    leaves = default_index().leaves
    (query,) = embedder([label])
    return np.clip(_leaf_vectors(embedder) @ query, 0.0, MAX_EMBEDDING_SCORE)[: len(leaves)]


@functools.lru_cache(maxsize=2)
def _leaf_vectors(embedder: TextEmbedder) -> np.ndarray:
    return embedder([f"{leaf}, {middle}" for leaf, (_, middle, _) in ontology.categories().items()])
