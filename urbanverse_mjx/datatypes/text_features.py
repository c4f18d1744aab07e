"""Words and letters of texts as numbers, without a neural network: for the search of assets and for goals in words."""

import collections
import math
import re

#: Lengths of the letter sequences.
LETTERS = (3, 4, 5)
#: A common whole word has more weight than its letters.
WORD_WEIGHT = 2.0


def text_features(text: str) -> dict[str, float]:
    """Words and the letter sequences in them, with marked ends, and their weights.

    Args:
      text: lower-case; a plural s at the end of a word is left out.
    """
    found: dict[str, float] = collections.defaultdict(float)
    for word in re.findall(r"[^\W_]+", text):
        stem = word[:-1] if len(word) > 3 and word.endswith("s") and not word.endswith("ss") else word
        found[f"w:{stem}"] += WORD_WEIGHT
        marked = f"<{stem}>"
        for length in LETTERS:
            for start in range(len(marked) - length + 1):
                found[marked[start : start + length]] += 1.0 / len(LETTERS)
    return {feature: 1.0 + math.log(x) if x > 1.0 else x for feature, x in found.items()}
