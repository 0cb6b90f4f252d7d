# SPDX-License-Identifier: BSD-2-Clause
"""The text format of tests/oracle/data: comments, then cases of words and number arrays."""

import numpy as np


def write(path, help_text, blocks):
    """blocks: list of (case name, {key: word}, {key: array [rows][cols]}); 17 digits."""
    with open(path, "w", encoding="ascii") as f:
        for line in help_text.splitlines():
            f.write(("# " + line).rstrip() + "\n")
        for name, words, arrays in blocks:
            f.write(f"\ncase {name}\n")
            for key, word in words.items():
                f.write(f"word {key} {word}\n")
            for key, values in arrays.items():
                values = np.atleast_2d(np.asarray(values, float))
                f.write(f"array {key} {values.shape[0]} {values.shape[1]}\n")
                for row in values:
                    for start in range(0, len(row), 10):
                        f.write(" ".join(f"{x + 0.0:.17g}" for x in row[start:start + 10]) + "\n")


def read(path):
    """The blocks of a file, as given to `write`."""
    with open(path, encoding="ascii") as f:
        tokens = iter(" ".join(line for line in f if not line.startswith("#")).split())
    blocks = []
    for token in tokens:
        if token == "case":
            blocks.append((next(tokens), {}, {}))
        elif token == "word":
            key = next(tokens)
            blocks[-1][1][key] = next(tokens)
        else:
            key, rows, cols = next(tokens), int(next(tokens)), int(next(tokens))
            blocks[-1][2][key] = np.array([float(next(tokens)) for _ in range(rows * cols)]).reshape(rows, cols)
    return blocks
