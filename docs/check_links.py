#!/usr/bin/env python3
"""Checks the links between the Markdown files of the repository as GitHub follows them: is the file there, and the heading?

Sphinx checks the links of the site; this checks README.md and other pages that are read outside of it, too.
"""
import pathlib
import re
import sys

root = pathlib.Path(__file__).resolve().parent.parent


def text_of(page):
    return re.sub(r"^```.*?^```", "", page.read_text(), flags=re.DOTALL | re.MULTILINE)


def anchors_of(page):
    """What GitHub and MyST make of the headings: small letters, blanks as hyphens, no punctuation."""
    headings = re.findall(r"^#+ +(.*)$", text_of(page), flags=re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


generated = root / "docs" / "reference" / "api"
failures = 0
folders = ["*.md", "docs/**/*.md", ".github/*.md", "packaging/*.md", "paper/*.md"]
for page in sorted(page for pattern in folders for page in root.glob(pattern)):
    if generated in page.parents:
        continue
    for link in re.findall(r"\]\(([^)\s]+)\)", text_of(page)):
        if re.match(r"[a-z]+:", link):
            continue
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        is_good = target.exists() and (not anchor or anchor in anchors_of(target))
        if not is_good:
            failures += 1
            print(f"{page.relative_to(root)}: nothing at {link}", file=sys.stderr)
sys.exit(1 if failures else 0)
