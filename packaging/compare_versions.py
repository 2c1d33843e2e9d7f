#!/usr/bin/env python3
"""Compares what users see of two commits: settings, columns, commands, scenes, headers, names in C++ and in Python.

    packaging/compare_versions.py OLD [NEW]

It reads both from git, and prints what is gone, what has other values or another default, and how much is new; `--new` lists that
as well. Settings, columns and commands are those of docs/reference/, which a test compares with the program. Names in C++ are those
declared at the left margin of a public header; names in Python are those of `__all__`, with their parameters.
"""
import argparse
import ast
import pathlib
import re
import subprocess

root = pathlib.Path(__file__).resolve().parent.parent


def git(*arguments):
    return subprocess.run(["git", "-C", root, *arguments], check=True, capture_output=True, text=True).stdout


def files_of(commit, folder, ending):
    return [name for name in git("ls-tree", "-r", "--name-only", commit, folder).splitlines() if name.endswith(ending)]


def text_of(commit, path):
    return git("show", f"{commit}:{path}")


def rows_of(page):
    """The cells of each row of the tables of a page, with the heading above it."""
    table = ""
    for line in page.splitlines():
        if line.startswith("## "):
            table = line[3:].replace("`", "").strip("[] ")
        elif line.startswith("| `"):
            yield table, [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]


def settings(commit):
    """Settings with values and default; what they mean may be said in other words."""
    page = text_of(commit, "docs/reference/settings.md")
    return {".".join(filter(None, [table, cells[0].strip("`")])): f"{cells[1]}, default {cells[3]}"
            for table, cells in rows_of(page)}


def columns(commit):
    page = text_of(commit, "docs/reference/observables.md")
    return {cells[0].strip("`"): "" for table, cells in rows_of(page) if "series.csv" in table}


def commands(commit):
    return {name: "" for name in re.findall(r"^## `(.*)`$", text_of(commit, "docs/reference/command_line.md"), re.MULTILINE)}


def headers(commit):
    return {name: "" for name in files_of(commit, "include", ".hpp") if "/detail/" not in name}


def names_in_cpp(commit):
    type_name = r"^(?:class|struct|enum class|concept|using|union)\s+(?:\[\[\w+\]\]\s*)?(\w+)(?=[ ;:{=]|$)(?!\s*;)"
    function = r"^(?:\[\[nodiscard\]\] )?(?!return|using|template|namespace|static_assert)[\w:<>,&*\s]*?\b(\w+)\("
    names = {}
    for header in headers(commit):
        text = re.sub(r"//.*", "", text_of(commit, header))
        for name in re.findall(type_name, text, re.MULTILINE) + re.findall(function, text, re.MULTILINE):
            names[name] = ""
    return {name: "" for name in names if name not in ("alignas", "decltype", "requires")}


def names_in_python(commit):
    """The names of __all__, with the parameters of functions."""
    modules = [ast.parse(text_of(commit, path)) for path in files_of(commit, "python/gridlock", ".py")]
    functions = {node.name: ast.unparse(node.args) for module in modules for node in module.body
                 if isinstance(node, ast.FunctionDef)}
    package = files_of(commit, "python/gridlock/__init__.py", ".py")
    if not package:
        return {}
    for node in ast.parse(text_of(commit, package[0])).body:
        targets = node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []
        if any(isinstance(target, ast.Name) and target.id == "__all__" for target in targets):
            return {name: functions.get(name, "") for name in ast.literal_eval(node.value)}
    return {}


kinds = {
    "settings": settings,
    "columns of series.csv": columns,
    "commands": commands,
    "scenes": lambda commit: {name: "" for name in files_of(commit, "scenes", ".toml")},
    "headers": headers,
    "names in C++": names_in_cpp,
    "names in Python": names_in_python,
}


def main():
    parser = argparse.ArgumentParser(description="Compares what users see of two commits.")
    parser.add_argument("old")
    parser.add_argument("new", nargs="?", default="HEAD")
    parser.add_argument("--new", dest="lists_new", action="store_true", help="list what is new as well")
    options = parser.parse_args()
    for commit in options.old, options.new:
        if subprocess.run(["git", "-C", root, "rev-parse", "--quiet", "--verify", f"{commit}^{{commit}}"], capture_output=True).returncode:
            parser.error(f"this repository has no commit {commit}")
    for kind, find in kinds.items():
        old, new = find(options.old), find(options.new)
        print(f"## {kind}: {len(old)} before, {len(new)} now, {len(new.keys() - old.keys())} new\n")
        for name in sorted(old.keys() - new.keys()):
            print(f"- gone: {name}")
        for name in sorted(name for name in old.keys() & new.keys() if old[name] != new[name]):
            print(f"- changed: {name}: {old[name]} → {new[name]}")
        for name in sorted(new.keys() - old.keys()) if options.lists_new else []:
            print(f"- new: {name}")
        print()


if __name__ == "__main__":
    main()
