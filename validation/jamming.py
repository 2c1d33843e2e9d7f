#!/usr/bin/env python3
"""The study of jamming, judged: fails where any of its claims differs from what was published.

    PYTHONPATH=build/python validation/jamming.py quick|full DIRECTORY
"""

import sys

from gridlock_studies import jam


def main(extent, directory):
    made = jam.make(directory, extent, overwrite=True, progress=lambda share, what: None)
    for claim in made.claims:
        print(f"{claim.verdict.value:<12} {claim.where}: {claim.statement}\n             {claim.measured}")
    for note in made.notes:
        print(f"note: {note}")
    differing = sum(claim.verdict is jam.Verdict.DIFFERS for claim in made.claims)
    print(f"{len(made.claims) - differing} of {len(made.claims)} claims do not differ; {made.seconds:.0f} s; {directory}/report.html")
    return 1 if differing or made.notes else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
