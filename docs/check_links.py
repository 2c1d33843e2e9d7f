#!/usr/bin/env python3
"""Checks the links between pages: is the file there, and the heading?

    docs/check_links.py       those between the Markdown files of the repository, as GitHub follows them
    docs/check_links.py SITE  those between the pages of a built site, with their pictures, scripts and styles
"""
import functools
import html.parser
import pathlib
import re
import sys
import urllib.parse

root = pathlib.Path(__file__).resolve().parent.parent


def text_of(page):
    return re.sub(r"^```.*?^```", "", page.read_text(), flags=re.DOTALL | re.MULTILINE)


def anchors_of(page):
    """What GitHub and MyST make of the headings: small letters, blanks as hyphens, no punctuation."""
    headings = re.findall(r"^#+ +(.*)$", text_of(page), flags=re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def faults_of_repository():
    generated = root / "docs" / "reference" / "api"
    folders = ["*.md", "docs/**/*.md", ".github/*.md", "packaging/*.md", "paper/*.md"]
    for page in sorted(page for pattern in folders for page in root.glob(pattern)):
        if generated in page.parents:
            continue
        for link in re.findall(r"\]\(([^)\s]+)\)", text_of(page)):
            if re.match(r"[a-z]+:", link):
                continue
            path, _, anchor = link.partition("#")
            target = (page.parent / path).resolve() if path else page
            if not target.exists() or (anchor and anchor not in anchors_of(target)):
                yield f"{page.relative_to(root)}: nothing at {link}"


class Links(html.parser.HTMLParser):
    """What a page leads to, and the places in it that others can lead to."""

    def __init__(self, text):
        super().__init__()
        self.targets, self.places = set(), set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.places |= {attributes[one] for one in ("id", "name") if attributes.get(one)}
        self.targets |= {attributes[one] for one in ("href", "src") if attributes.get(one)}


links_of = functools.cache(lambda page: Links(page.read_text()))


def faults_of_site(site):
    for page in sorted(site.rglob("*.html")):
        for link in sorted(links_of(page).targets):
            parts = urllib.parse.urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = page.parent / urllib.parse.unquote(parts.path) if parts.path else page
            # What follows # in a link to the playground is a set-up.
            is_place = parts.fragment and target.suffix == ".html" and target.parent.name != "playground"
            if not target.is_file() or (is_place and urllib.parse.unquote(parts.fragment) not in links_of(target.resolve()).places):
                yield f"{page.relative_to(site)}: nothing at {link}"


faults = list(faults_of_site(pathlib.Path(sys.argv[1]).resolve()) if len(sys.argv) > 1 else faults_of_repository())
for fault in faults:
    print(fault, file=sys.stderr)
sys.exit(1 if faults else 0)
