# SPDX-License-Identifier: BSD-2-Clause
"""Numbers that a test program of the library has written, one array after the other."""
import numpy as np


class Numbers:
    """Take arrays of double numbers from a file in the order in which they were written."""

    def __init__(self, path):
        self.data = np.fromfile(path)
        self.at = 0

    def is_left(self):
        return self.at < len(self.data)

    def take(self, *shape):
        count = int(np.prod(shape))
        self.at += count
        return self.data[self.at - count:self.at].reshape(shape)
