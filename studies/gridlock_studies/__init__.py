"""Studies made with the package ``gridlock``, and tools that they share: runs that are kept, chapters, claims with verdicts, pictures
and one page.

The studies are :mod:`gridlock_studies.paper`, :mod:`gridlock_studies.jam` and :mod:`gridlock_studies.melt`.
"""
