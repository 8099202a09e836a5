"""Every link of the documentation leads somewhere: to a file of the tree, to a heading that is there.

usage: python3 test_links.py EQUIMAP
"""
import os
import re
import sys

TOP = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
LINK = re.compile(r"\[[^\]\n]*(?:\n[^\]\n]*)?\]\(([^)\s]+)\)")


def pages():
    """All pages, relative to the top of the tree."""
    for folder in (".", "docs"):
        for name in sorted(os.listdir(os.path.join(TOP, folder))):
            if name.endswith(".md"):
                yield os.path.normpath(os.path.join(folder, name))


def read(page):
    with open(os.path.join(TOP, page), encoding="utf-8") as stream:
        return stream.read()


def anchors(page):
    """The names that headings have as targets, in the manner of GitHub and GitLab."""
    text = re.sub(r"^```.*?^```", "", read(page), flags=re.M | re.S)
    found = set()
    for heading in re.findall(r"^#+ +(.*?) *$", text, flags=re.M):
        name = re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
        number = sum(1 for other in found if re.fullmatch(re.escape(name) + r"(-\d+)?", other))
        found.add(f"{name}-{number}" if number else name)
    return found


def broken(page):
    """The links of a page that lead nowhere."""
    for link in LINK.findall(read(page)):
        if re.match(r"[a-z]+:", link):
            continue
        path, _, anchor = link.partition("#")
        target = os.path.normpath(os.path.join(os.path.dirname(page), path)) if path else page
        if not os.path.exists(os.path.join(TOP, target)):
            yield f"{page}: {link}: there is no such file"
        elif anchor and anchor not in anchors(target):
            yield f"{page}: {link}: there is no such heading"


def main():
    found = list(pages())
    problems = [problem for page in found for problem in broken(page)]
    links = sum(len(LINK.findall(read(page))) for page in found)
    print("\n".join(problems + [f"{len(found)} pages, {links} links, {len(problems)} of them broken"]))
    return 1 if problems or links < 30 else 0


sys.exit(main())
