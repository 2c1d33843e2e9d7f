#!/usr/bin/env python3
"""Puts a built site beside those of other versions, and writes what all of them share.

    docs/versions.py SITE                    the list of the folders of SITE, and the page that leads to the newest release
    docs/versions.py SITE NAME HTML          the same, after the folder HTML has become the version NAME
    docs/versions.py SITE NAME HTML ADDRESS  the same for a site at ADDRESS, with what needs to know where it is

SITE/versions.json names the versions, releases first, the newest at their head; SITE/index.html leads to the first; SITE/404.html is for
pages that are not there. With an address SITE/sitemap.xml lists the pages of the first version, and every page names itself in the newest
version that has it, so that a search on the web finds that one.
"""
import html
import json
import pathlib
import re
import shutil
import sys


def order(name):
    """Releases by their numbers, the newest first, and a candidate behind its release; then other names."""
    numbers = re.fullmatch(r"v(\d+)\.(\d+)\.(\d+)(.*)", name)
    return (0, *(-int(one) for one in numbers.groups()[:3]), numbers[4] != "", name) if numbers else (1, 0, 0, 0, False, name)


def versions(site):
    return sorted((folder.parent.name for folder in site.glob("*/index.html")), key=order)


def plain_page(head, body):
    return ('<!doctype html>\n<html lang="en">\n<meta charset="utf-8">\n<meta name="viewport" content="width=device-width">\n'
            f'<meta name="color-scheme" content="light dark">\n<title>Gridlock</title>\n{head}\n{body}\n</html>\n')


def pages_of(folder):
    """The pages of a version, from its folder on, but for the playground, which is one program."""
    pages = (page.relative_to(folder).as_posix() for page in folder.rglob("*.html"))
    return sorted(page for page in pages if not page.startswith("playground/"))


def name_newest(site, names, address):
    """Puts into the head of each page its address in the newest version that has it, in place of what it said before."""
    newest = {page: name for name in reversed(names) for page in pages_of(site / name)}
    for name in names:
        for page in pages_of(site / name):
            file = site / name / page
            text = re.sub(r'<link rel="canonical"[^>]*>', "", file.read_text())
            link = f'<link rel="canonical" href="{html.escape(f"{address}/{newest[page]}/{page}")}">'
            file.write_text(text.replace("<head>", f"<head>{link}", 1))
    locations = "".join(f"<url><loc>{html.escape(f'{address}/{names[0]}/{page}')}</loc></url>\n" for page in pages_of(site / names[0]))
    (site / "sitemap.xml").write_text('<?xml version="1.0" encoding="UTF-8"?>\n<urlset xmlns="http://www.sitemaps.org/schemas/sitemap/0.9">\n'
                                      f"{locations}</urlset>\n")


def write(site, address):
    names = versions(site)
    if not names:
        sys.exit(f"{site} has no folder of a version with an index.html")
    (site / "versions.json").write_text(json.dumps(names) + "\n")
    (site / "index.html").write_text(plain_page(f'<meta http-equiv="refresh" content="0; url={names[0]}/index.html">',
                                                f'<p><a href="{names[0]}/index.html">Gridlock {names[0]}</a>'))
    # It is shown at any depth: links begin at the address of the site, at the root of its host where that is not known.
    items = "".join(f'<li><a href="{name}/index.html">{name}</a> (<a href="{name}/search.html">search</a>)\n' for name in names)
    style = "body { font: 1.1em/1.5 system-ui, sans-serif; max-width: 34em; margin: 10vh auto; padding: 0 1em; }"
    (site / "404.html").write_text(plain_page(
        f'<base href="{html.escape(address or "")}/">\n<style>{style}</style>',
        f"<main>\n<h1>This page is not here</h1>\n<p>It may have another name, or be in another version of Gridlock:\n<ul>\n{items}</ul>\n</main>"))
    (site / ".nojekyll").touch()  # GitHub leaves out folders that begin with _ without it
    if address:
        name_newest(site, names, address)


def main():
    if len(sys.argv) not in (2, 4, 5):
        sys.exit(__doc__)
    site = pathlib.Path(sys.argv[1])
    site.mkdir(parents=True, exist_ok=True)
    if len(sys.argv) > 2:
        name, built = sys.argv[2], pathlib.Path(sys.argv[3])
        if not re.fullmatch(r"[A-Za-z0-9][\w.-]*", name):
            sys.exit(f"{name} cannot be the folder of a version: letters, digits, points and hyphens can")
        shutil.rmtree(site / name, ignore_errors=True)
        shutil.copytree(built, site / name)
    write(site, sys.argv[4].rstrip("/") if len(sys.argv) > 4 else None)


if __name__ == "__main__":
    main()
