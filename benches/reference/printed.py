"""Holds numbers that a script computes against those that docs/verification.md prints."""

import sys

import numpy as np


class Page:
    """The numbers of one script, in the order in which they are computed."""

    def __init__(self):
        self.off = 0

    def holds(self, name, computed, printed, within):
        """Prints a row; `within` is the largest difference allowed, in the unit of the number."""
        computed = np.atleast_1d(np.asarray(computed, float)).ravel()
        printed = np.atleast_1d(np.asarray(printed, float)).ravel()
        if computed.shape != printed.shape:
            raise SystemExit(f"{name}: {computed.size} numbers computed, {printed.size} printed")
        apart = np.max(np.abs(computed - printed))
        is_held = bool(apart <= within)
        self.off += not is_held
        words = " ".join(f"{number:.7g}" for number in computed[:8])
        more = " ..." if computed.size > 8 else ""
        print(f"{'ok ' if is_held else 'OFF'} {name}: {words}{more}; {apart:.1e} from what is printed, {within:.0e} allowed")

    def end(self):
        """The exit status of the script: 1 if a number is off."""
        sys.exit(1 if self.off else 0)
