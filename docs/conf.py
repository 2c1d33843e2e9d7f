"""The site: Markdown pages and notebooks by MyST-NB, the C++ interface by Doxygen and Breathe, the Python interface by autodoc.
./dev docs builds it.

Pages link to files of the repository as GitHub wants them (../../examples/…). On the site such a file is a download, and a
page of the repository's root is the chapter that includes it.
"""
import pathlib
import re
import sys

from breathe.renderer import sphinxrenderer

docs = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(docs))  # site_parts
repository = docs.parent

project = "Gridlock"
author = "The Gridlock developers"
copyright = author
release = "".join(re.search(r"project\(gridlock VERSION ([\d.]+).*?GRIDLOCK_VERSION \$\{PROJECT_VERSION\}([-\w]*)",
                            (repository / "CMakeLists.txt").read_text(), re.DOTALL).groups())
version = release

extensions = ["myst_nb", "breathe", "sphinx.ext.autodoc", "site_parts"]
root_doc = "index"
myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 4
exclude_patterns = ["requirements-docs.txt", "templates"]
# Notebooks are kept without results: they are run for the site, as they are by the tests.
nb_execution_mode = "force"
nb_execution_timeout = 120
nb_execution_raise_on_error = True
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
html_theme = "furo"
html_favicon = "mark.svg"
html_title = f"Gridlock {release}"
html_show_sphinx = False
html_static_path = ["site.css", "site.js"]
html_css_files = ["site.css"]
html_js_files = [("site.js", {"defer": "defer"})]
templates_path = ["templates"]
html_sidebars = {"**": ["sidebar/scroll-start.html", "sidebar/brand.html", "versions.html", "sidebar/search.html", "sidebar/navigation.html",
                        "sidebar/scroll-end.html"]}
highlight_language = "none"

breathe_projects = {"gridlock": str(repository / "build-docs" / "doxygen" / "xml")}
breathe_default_project = "gridlock"
breathe_default_members = ("members",)
cpp_index_common_prefix = ["gridlock::"]

# Some servers refuse programs that look at links.
linkcheck_ignore = [r"https://doi\.org/.*"]

# Pages of the repository's root, and the chapters of the site that include them.
root_pages = {
    "README.md": "index.md",
    "ARCHITECTURE.md": "contributing/architecture.md",
    "CONTRIBUTING.md": "contributing/contributing.md",
    "CHANGELOG.md": "contributing/changelog.md",
}


def link_chapters(app, docname, source):
    """Puts a page of the root into its chapter, and turns links to such pages into links to the chapters."""
    depth = docname.count("/")
    for page, chapter in root_pages.items():
        if source[0].startswith(f"```{{include}} ../../{page}\n"):
            text = (repository / page).read_text()
            source[0] = re.sub(r"\]\((?!https?:|#)", "](../../", text).replace("](../../docs/", "](../")
    for page, chapter in root_pages.items():
        source[0] = source[0].replace(f"]({'../' * (depth + 1)}{page}", f"]({'../' * depth}{chapter}")
    # A Markdown file of the repository that is no chapter is a download as any other: a link leads to no heading in it.
    source[0] = re.sub(rf"\]\(({'../' * (depth + 1)}[^.)#][^)#]*\.md)(#[^)]*)?\)", r"](path:\1)", source[0])


def write_api_pages(app):
    """Writes a page for each folder of include/gridlock, with every header of the folder. Git ignores these pages."""
    headers = sorted(path.relative_to(repository / "include") for path in repository.glob("include/gridlock/**/*.hpp")
                     if path.parent.name != "detail")
    pages = docs / "reference" / "api"
    pages.mkdir(exist_ok=True)
    wanted = {}
    for header in headers:
        room = header.parts[1] if len(header.parts) > 2 else "gridlock"
        wanted.setdefault(room, f"# `{room}`\n")
        wanted[room] += f"\n## `{header}`\n\n```{{doxygenfile}} {header}\n```\n"
    for page in pages.glob("*.md"):
        if page.stem not in wanted:
            page.unlink()
    for room, text in wanted.items():
        page = pages / f"{room}.md"
        if not page.exists() or page.read_text() != text:  # what has not changed is not built again
            page.write_text(text)


def render_content_of_namespace(self, node):
    """Breathe declares the namespace of a header anew on each page; the full names of its members are enough."""
    file_data = self.compound_parser.parse(node.refid)
    context = self.context.create_child_context(file_data)
    with sphinxrenderer.WithContext(self, context.create_child_context(file_data.compounddef)):
        return self.render(file_data, context)


make_initializer = sphinxrenderer.SphinxRenderer.make_initializer


def make_short_initializer(self, node):
    """Sphinx cannot read the body of a lambda as the value of a variable."""
    text = make_initializer(self, node)
    return "" if "[" in text else text


sphinxrenderer.SphinxRenderer.visit_namespace = render_content_of_namespace
sphinxrenderer.SphinxRenderer.make_initializer = make_short_initializer


def keep_bars(app, what, name, object, options, lines):
    """Formulas such as |Δr| in documentation strings mean no substitutions."""
    lines[:] = [line if line.startswith((" ", ">")) else line.replace("|", "\\|") for line in lines]


def setup(app):
    app.connect("autodoc-process-docstring", keep_bars)
    app.connect("builder-inited", write_api_pages)
    app.connect("source-read", link_chapters)
