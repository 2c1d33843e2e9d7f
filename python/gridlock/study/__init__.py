"""What studies are made with: runs that are kept, chapters, claims with verdicts, pictures and one page.

The studies are :mod:`gridlock.paper` and :mod:`gridlock.jam`.
"""
