"""make_site.py - the documents as a site that any browser opens from the disk.

Room:     client/man/site. Imports markdown (python3-markdown), and reference.py; runs
          mandoc. Where they are installed, pygments colours sources, doxygen makes the
          reference of pccd.h, and lunr (python3-lunr, libjs-lunr) the search.
Does:     turn PAGES, Markdown and manual pages, into HTML with one style; lead their
          links to each other; take along the pictures and sources that they name. Say
          what is left out, and why. A link that leads nowhere ends it with 1.
Does not: fetch anything, or need a server; only the search needs JavaScript.

    python3 make_site.py SOURCE_FOLDER BUILD_FOLDER SITE_FOLDER
"""

import html
import json
import os
import re
import shutil
import subprocess
import sys

import markdown
from reference import reference

try:
    import pygments
    import pygments.formatters
    import pygments.lexers
except ImportError:
    pygments = None
try:
    import lunr
except ImportError:
    lunr = None

LUNR = "/usr/share/javascript/lunr/lunr.min.js"
# Group in the menu (None: not in it), file in the source (of a manual page: in the
# build), name of the page, its title. A file that is not there belongs to a part that
# this tree does not have.
PAGES = [
    ("", "client/man/site/index.md", "index", "Getting started"),
    ("", "README.md", "overview", "Overview"),
    ("Recipes", "client/man/site/cloth.md", "cloth", "A cloth that holds"),
    ("Recipes", "client/man/site/game.md", "game", "A game's hits"),
    ("Recipes", "client/man/site/edge.md", "edge", "A planner's edge"),
    ("Recipes", "client/man/site/robot.md", "robot", "A robot in its cell"),
    ("Recipes", "client/man/site/jam.md", "jam", "Does it jam?"),
    ("Recipes", "client/man/site/bake.md", "bake", "Find where a bake intersects"),
    ("Recipes", "client/man/site/replay.md", "replay", "Replay a bad frame"),
    ("Recipes", "client/man/site/share.md", "share", "Share a world of two programs"),
    ("Guide", "client/man/pccd.7", "answer", "What an answer means"),
    ("Guide", "client/man/site/from.md", "from", "Coming from another library"),
    ("Guide", "client/README.md", "guide", "The guide"),
    ("Guide", "client/cpp/README.md", "cpp", "C++ and CMake"),
    ("Guide", "client/python/README.md", "python", "The Python package"),
    ("Guide", "client/blender/README.md", "blender", "Blender"),
    ("Guide", "client/ipc/README.md", "ipc", "ipc-toolkit"),
    ("Guide", "client/planner/README.md", "planner", "Planners"),
    ("Guide", "client/mpi/README.md", "mpi", "Many machines"),
    ("Reference", "client/lib/pccd.h", "pccd.h", "pccd.h by function"),
    ("Reference", "client/man/libpccd.3", "libpccd.3", "libpccd(3)"),
    ("Reference", "client/man/pccdctl.1", "pccdctl.1", "pccdctl(1)"),
    ("Reference", "client/man/pccdd.8", "pccdd.8", "pccdd(8)"),
    ("Reference", "client/man/pccd-load.1", "pccd-load.1", "pccd-load(1)"),
    ("Reference", "client/man/pccd-mpi.1", "pccd-mpi.1", "pccd-mpi(1)"),
    ("Reference", "client/man/libpccd-mpi.3", "libpccd-mpi.3", "libpccd-mpi(3)"),
    ("Reference", "client/man/pccd-protocol.7", "pccd-protocol.7", "pccd-protocol(7)"),
    ("Reference", "proto/PROTOCOL.md", "protocol", "Protocol"),
    ("Measurements", "bench/README.md", "measurements", "Measurements"),
    ("Measurements", "bench/peers/NEAR.md", "other-libraries", "Other libraries"),
    ("Measurements", "tests/README.md", "tests", "Tests"),
    *((None, f"bench/{name}/README.md", f"bench-{name}", f"Measurements: {name}")
      for name in ("counted", "growth", "model", "peers", "redis", "results")),
]
MANUAL = re.compile(r"\.[1-8]$")
LINK = re.compile(r'(<(?:a|img)\b[^>]*?\b(?:href|src)=")([^"]*)(")')
MENTION = re.compile(r"<(b|strong)>([\w-]+)</\1>\((\d)\)")
FUNCTION = re.compile(r"<(b|code)>(pccd_\w+)</\1>(?!</a>)")
HEADLINE = re.compile(r'<h([123])[^>]*?\bid="([^"]*)"[^>]*>(.*?)</h\1>', re.S)


def plain(body):
    """The words of a piece of HTML."""
    apart = re.sub(r"<(/?(p|t[dhr]|li|pre|h\d|d[td]|div)|br)\b[^>]*>", " ", body)
    return " ".join(html.unescape(re.sub(r"<[^>]*>", "", apart)).split())


def slug(title, _separator="-"):
    """The anchor of a headline, as in the links of our Markdown."""
    return re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")


class Site:
    def __init__(self, source, build, to):
        self.source, self.build, self.to = source, build, to
        self.pages = [page for page in PAGES if self.find(page[1])]
        self.names = {page[1]: page[2] + ".html" for page in self.pages}
        self.names.update({path + ".scd": name for path, name in self.names.items()
                           if MANUAL.search(path)})
        self.taken, self.anchors, self.wrong, self.left_out = {}, {}, [], []
        self.found = []  # what the search finds: title, link, words
        self.reference = reference(source)
        self.functions = set(re.findall(r'id="(pccd_\w+)"', self.reference or ""))
        for what, there in (("syntax colours: no python3-pygments", pygments),
                            ("the reference of pccd.h: no doxygen", self.reference),
                            ("the search: no python3-lunr, or no libjs-lunr",
                             self.searches())):
            self.left_out += [what] * (not there)
        with open(os.path.join(source, "client/man/site/page.html")) as file:
            self.frame = file.read()

    def find(self, path):
        """The file, below the build folder or the source."""
        folders = [self.build, self.source] if MANUAL.search(path) else [self.source]
        for folder in folders:
            if os.path.isfile(os.path.join(folder, path)):
                return os.path.join(folder, path)
        return None

    @staticmethod
    def searches():
        return bool(lunr) and os.path.isfile(LUNR)

    def body_of(self, path):
        if path.endswith(".h"):
            return self.reference or self.source_page(path)
        if MANUAL.search(path):
            command = ["mandoc", "-T", "html", "-O", "fragment", self.find(path)]
            made = subprocess.run(command, check=True, capture_output=True,
                                  text=True).stdout
            return MENTION.sub(self.mention, made)
        with open(self.find(path)) as file:
            text = file.read()
        return markdown.markdown(
            text, extensions=["tables", "fenced_code", "sane_lists", "toc"] +
            ["codehilite"] * bool(pygments),
            extension_configs={"toc": {"slugify": slug},
                               "codehilite": {"guess_lang": False}})

    def source_page(self, path):
        """A source as it is, in colours."""
        with open(os.path.join(self.source, path)) as file:
            text = file.read()
        made = f"<pre>{html.escape(text)}</pre>"
        if pygments:
            try:
                lexer = pygments.lexers.get_lexer_for_filename(path)
            except pygments.util.ClassNotFound:
                lexer = pygments.lexers.TextLexer()
            made = pygments.highlight(text, lexer, pygments.formatters.HtmlFormatter(
                cssclass="codehilite"))
        return f"<h1>{html.escape(path)}</h1>{made}"

    def mention(self, match):
        name = self.names.get(f"client/man/{match[2]}.{match[3]}")
        return f'<a href="{name}">{match[0]}</a>' if name else match[0]

    def to_reference(self, match):
        return (f'<a href="pccd.h.html#{match[2]}">{match[0]}</a>'
                if match[2] in self.functions else match[0])

    def lead(self, path, target):
        """Where a link of a page leads on the site."""
        if re.match(r"[a-z]+:", target) or target in self.names.values():
            return target
        file, _, anchor = target.partition("#")
        if not file:
            return target
        there = os.path.normpath(os.path.join(os.path.dirname(path), file))
        if there in self.names:
            return self.names[there] + ("#" + anchor if anchor else "")
        return self.take(path, there)

    def take(self, path, there):
        """A picture as it is, another file as a page of its own."""
        full = os.path.join(self.source, there)
        if there.startswith("..") or not os.path.isfile(full):
            self.wrong.append(f"{path}: no {there}")
            return "#"
        picture = re.search(r"\.(a?png|svg)$", there)
        name = there.replace("/", "-") + ("" if picture else ".html")
        if there not in self.taken:
            self.taken[there] = name
            if picture:
                shutil.copyfile(full, os.path.join(self.to, name))
            else:
                self.write(name, there, self.source_page(there))
        return name

    def menu(self, name):
        lines, group = [], None
        for its_group, _, its_name, title in self.pages:
            if its_group is None:
                continue
            if its_group != group:
                lines += ["</ul>"] * (group is not None)
                lines += [f"<h2>{its_group}</h2>"] * bool(its_group) + ["<ul>"]
                group = its_group
            here = ' aria-current="page"' if its_name + ".html" == name else ""
            lines.append(f'<li><a href="{its_name}.html"{here}>{html.escape(title)}</a>')
        return "\n".join(lines + ["</ul>"])

    def contents(self, body):
        """The headlines of a page, as links; nothing for a short page."""
        heads = [(level, anchor, plain(head)) for level, anchor, head in
                 HEADLINE.findall(body)][1:]
        if len(heads) < 3:
            return ""
        lines = [f'<li class="level{level}"><a href="#{anchor}">{html.escape(head)}</a>'
                 for level, anchor, head in heads]
        return ('<aside><details open><summary>On this page</summary><ul>' +
                "\n".join(lines) + "</ul></details></aside>")

    def index(self, name, title, body):
        """What the search finds: the pieces of a page between headlines."""
        parts = HEADLINE.split(body)
        self.found.append((title, name, plain(parts[0])))
        for anchor, head, piece in zip(parts[2::4], parts[3::4], parts[4::4]):
            self.found.append((f"{title}: {plain(head)}", f"{name}#{anchor}",
                               plain(piece)))

    def write_search(self):
        documents = [{"id": i, "title": title, "text": text}
                     for i, (title, _, text) in enumerate(self.found)]
        made = lunr.lunr(ref="id", fields=[{"field_name": "title", "boost": 10}, "text"],
                         documents=documents)
        shown = [(title, link, text[:200]) for title, link, text in self.found]
        with open(os.path.join(self.to, "found.js"), "w") as file:
            file.write(f"const found = {json.dumps(shown)};\n"
                       f"const serialised = {json.dumps(made.serialize())};\n")
        shutil.copy(LUNR, self.to)
        shutil.copy(os.path.join(self.source, "client/man/site/search.js"), self.to)
        self.write("search.html", "Search", '<h1>Search</h1><p id="count" role="status">'
                   '<noscript>The search needs JavaScript.</noscript></p>'
                   '<ol id="hits"></ol>' + "".join(f'<script src="{name}"></script>'
                             for name in ("lunr.min.js", "found.js", "search.js")))

    def write(self, name, title, body):
        self.anchors[name] = set(re.findall(r'\bid="([^"]*)"', body))
        page = self.frame
        if not self.searches():
            page = re.sub("<form.*?</form>", "", page)
        for key, value in (("TITLE", html.escape(title)), ("MENU", self.menu(name)),
                           ("CONTENTS", self.contents(body)), ("BODY", body)):
            page = page.replace(f"<!-- {key} -->", value)
        with open(os.path.join(self.to, name), "w") as file:
            file.write(page)

    def make(self):
        os.makedirs(self.to, exist_ok=True)
        links = []
        for _, path, name, title in self.pages:
            def lead(match, path=path, name=name):
                target = self.lead(path, html.unescape(match[2]))
                links.append((path, name + ".html", target))
                return match[1] + html.escape(target) + match[3]
            body = LINK.sub(lead, self.body_of(path))
            if path.endswith(".md") or MANUAL.search(path):
                body = FUNCTION.sub(self.to_reference, body)
            # A wide table is moved by itself where the page is narrow.
            body = body.replace("<table", '<div class="wide"><table')
            body = body.replace("</table>", "</table></div>")
            self.index(name + ".html", title, body)
            self.write(name + ".html", title, body)
        if self.searches():
            self.write_search()
        self.write_style()
        for path, name, target in links:
            file, _, anchor = target.partition("#")
            if anchor and not re.match(r"[a-z]+:", target) and \
                    anchor not in self.anchors.get(file or name, ()):
                self.wrong.append(f"{path}: no headline {anchor} in {file or name}")
        return self.wrong


    def write_style(self):
        with open(os.path.join(self.source, "client/man/site/style.css")) as file:
            text = file.read()
        if pygments:
            def colours(style):
                return pygments.formatters.HtmlFormatter(style=style).get_style_defs(
                    ".codehilite")
            text += (colours("xcode") + "\n@media (prefers-color-scheme: dark) {\n" +
                     colours("github-dark") + "\n}\n")
            text += ".codehilite { background: none !important; }\n"
        with open(os.path.join(self.to, "style.css"), "w") as file:
            file.write(text)


def main():
    if len(sys.argv) != 4:
        sys.exit("usage: make_site.py SOURCE_FOLDER BUILD_FOLDER SITE_FOLDER")
    site = Site(*sys.argv[1:])
    wrong = site.make()
    for line in wrong:
        print("make_site:", line, file=sys.stderr)
    for line in site.left_out:
        print("make_site: left out:", line, file=sys.stderr)
    print(f"{len(site.pages)} pages: {os.path.join(site.to, 'index.html')}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
