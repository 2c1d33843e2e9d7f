#!/usr/bin/env python3
"""Checks paper.md: each number is in a quotation of the repository, and each citation has its entry.

A comment `<!-- docs/page.md: quoted text -->` beneath a paragraph or figure names where its numbers come from. The text has to be in the page,
and each number of the paragraph in one of its quotations. Each cited key has an entry in paper.bib, each entry is cited, and
has a doi or a note why it has none. Sections and length are what the journal asks for, https://joss.readthedocs.io/en/latest/paper.html.
"""
import pathlib
import re
import sys

here = pathlib.Path(__file__).resolve().parent
root = here.parent
sections = ["Summary", "Statement of need", "State of the field", "Software design", "Research impact statement", "AI usage disclosure",
            "Acknowledgements", "References"]
min_words, max_words = 750, 1750
number = re.compile(r"(?<![\w.])\d[\d.,]*(?:·10)?[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]*(?<![.,])")


def faults_of(text):
    """The faults of the numbers of the paper."""
    body = text.split("---", 2)[2]
    for paragraph in re.split(r"\n\n(?!<!--)", body):
        quotations = re.findall(r"<!-- ([\w./-]+): (.*?) -->", paragraph)
        for page, quotation in quotations:
            if quotation not in " ".join((root / page).read_text().split()):
                yield f"{page} has no longer: {quotation}"
        sentences = re.sub(r"<!--.*?-->|`[^`]*`|@\w+|\]\([^)]*\)|\\\w+\{\w+\}|AVX-512", "", paragraph)
        for found in number.findall(sentences):
            if not any(found in number.findall(quotation) for _, quotation in quotations):
                yield f"no quotation has the number {found}: {sentences.strip()[:60]} …"


def faults_of_citations(text, bibliography):
    cited = set(re.findall(r"@(\w+)", re.sub(r"<!--.*?-->", "", text.split("---", 2)[2])))
    entries = dict(re.findall(r"^@\w+\{(\w+),\n(.*?)^\}", bibliography, re.DOTALL | re.MULTILINE))
    yield from (f"paper.bib has no entry {key}" for key in sorted(cited - entries.keys()))
    yield from (f"nobody cites {key}" for key in sorted(entries.keys() - cited))
    for key, entry in entries.items():
        if not re.search(r"doi = \{10\.\d{4,}/\S+\}|note = \{.*no doi", entry):
            yield f"{key} has no doi, and no note why"


def faults_of_form(text):
    body = re.sub(r"<!--.*?-->", "", text.split("---", 2)[2])
    found = re.findall(r"^# (.*)$", body, re.MULTILINE)
    if found != sections:
        yield f"the sections are {found}, not {sections}"
    if not min_words <= len(body.split()) <= max_words:
        yield f"{len(body.split())} words, not {min_words} to {max_words}"


if __name__ == "__main__":
    text = (here / "paper.md").read_text()
    faults = [*faults_of_form(text), *faults_of(text), *faults_of_citations(text, (here / "paper.bib").read_text())]
    for fault in faults:
        print(fault, file=sys.stderr)
    sys.exit(1 if faults else 0)
