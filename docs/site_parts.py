"""What the site has and Markdown has not: figures that run, a link to the page, a choice of versions, and links that start the notebooks.

An extension of Sphinx. In a page

    <!-- live: scene=melting&vary=disks.packing_fraction&chart=mean_displacement -->
    ![words](picture)

is a picture wherever Markdown is read. On the site, where ./dev build-web has made the page, it becomes a figure: a button under the picture
puts the playground with that set-up in its place, which runs. What follows "live:" is the part of an address of the playground behind "#":
the set-up, and what the figure has beside the picture (docs/how_to/playground.md). A picture live_….png is the figure at its end:
GRIDLOCK_WRITE_PICTURES=1 ./dev test-site takes it anew.
"""
import html
import pathlib
import re
import shutil

repository = pathlib.Path(__file__).resolve().parent.parent
page = repository / "build-web" / "page"
FIGURE = re.compile(r"<!-- live: (\S+) -->\n!\[(.*?)\]\((.*?)\)\n")


def has_page():
    return (page / "playground.html").is_file()


def github():
    """The owner and name of the repository as pyproject.toml has its address, where that is one of GitHub; else nothing."""
    address = re.search(r'^Repository = "https://github\.com/([^/"]+/[^/"]+?)(?:\.git)?/?"', (repository / "pyproject.toml").read_text(), re.MULTILINE)
    return address.group(1) if address else ""


def put_live_figures(app, docname, source):
    """Puts around the picture what site.js makes the buttons of, so that without JavaScript nothing is promised."""
    folder = "../" * docname.count("/") + "playground/"

    def figure(match):
        set_up, words, picture = match.groups()
        return (f'```{{raw}} html\n<div class="live-figure" data-folder="{folder}" data-set-up="#{html.escape(set_up)}">\n```\n'
                f"![{words}]({picture})\n\n```{{raw}} html\n</div>\n```\n")

    source[0] = FIGURE.sub(figure if has_page() else r"![\2](\3)\n", source[0])


def put_notebook_links(app, docname, source):
    """Rows of the list of notebooks get links that start them in Binder and in Colab."""
    if docname != "notebooks/index" or not github():
        return
    binder = f"https://mybinder.org/v2/gh/{github()}/main?labpath=docs/notebooks/"
    colab = f"https://colab.research.google.com/github/{github()}/blob/main/docs/notebooks/"

    def row(match):
        badges = " ".join(f'<a class="badge" href="{address}{match[2]}">{name}</a>' for name, address in (("Binder", binder), ("Colab", colab)))
        return f"{match[1]} {badges} |"

    source[0] = re.sub(r"^(\| \[.*?\]\((\w+\.ipynb)\) \|.*) \|$", row, source[0], flags=re.MULTILINE)


def say_what_there_is(app, pagename, templatename, context, doctree):
    context["has_page"] = has_page()


def copy_page(app, exception):
    if exception is None and app.builder.name == "html" and has_page():
        shutil.copytree(page, pathlib.Path(app.outdir) / "playground", dirs_exist_ok=True)


def setup(app):
    app.connect("source-read", put_live_figures)
    app.connect("source-read", put_notebook_links)
    app.connect("html-page-context", say_what_there_is)
    app.connect("build-finished", copy_page)
    return {"parallel_read_safe": True}
