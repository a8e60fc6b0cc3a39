"""reference.py - the public headers as one page: every function, struct and enumeration.

Room:     client/man/site. Runs doxygen, which reads the headers.
Does:     turn doxygen's XML into HTML: a headline for each name, which is its anchor.
Does not: read C. Functions that follow each other under one comment share an entry.
"""

import glob
import html
import os
import subprocess
import tempfile
import xml.etree.ElementTree as tree

HEADERS = ["client/lib/pccd.h", "client/lib/pccd_near.h", "client/lib/pccd_batch.h",
           "client/lib/pccd_turning.h", "client/lib/pccd_points.h",
           "client/lib/pccd_rays.h", "client/lib/pccd_weld.h",
           "proto/common/pccd_types.h", "proto/common/pccd_daemon.h",
           "proto/common/pccd_trace.h"]
# Our comments begin with /* and stand before what they describe, or behind it on its
# line; a line of dashes begins a part of a header. Doxygen wants /** and /**<.
FILTER = (r"sed -E 's,^/\* (pccd[a-z_]*\.h) - (.),/** @file \1 \n * \u\2,;"
          r" s,^/\* -+ (.*[^ -]) -+ \*/$,/** @} */ /** @name \1 */ /** @{ */,;"
          r" s,^( *)/\* ,\1/** ,; s,([;\,{]) +/\* ,\1 /**< ,'")
SETTINGS = """
INPUT = {input}
FULL_PATH_NAMES = NO
INPUT_FILTER = "{filter}"
OUTPUT_DIRECTORY = {output}
GENERATE_HTML = NO
GENERATE_LATEX = NO
GENERATE_XML = YES
XML_PROGRAMLISTING = NO
EXTRACT_ALL = YES
JAVADOC_AUTOBRIEF = YES
OPTIMIZE_OUTPUT_FOR_C = YES
MACRO_EXPANSION = YES
PREDEFINED = _Static_assert(x,y)=
SORT_MEMBER_DOCS = NO
AUTOLINK_SUPPORT = YES
QUIET = YES
WARNINGS = NO
"""
TAGS = {"para": "p", "itemizedlist": "ul", "orderedlist": "ol", "listitem": "li",
        "computeroutput": "code", "emphasis": "em", "bold": "strong", "verbatim": "pre",
        "preformatted": "pre", "programlisting": "pre", "superscript": "sup"}
SIGNS = {"sp": " ", "ndash": "-", "mdash": "-", "linebreak": "<br>"}


class Reference:
    def __init__(self, source, folder):
        inputs = [os.path.join(source, header) for header in HEADERS]
        settings = SETTINGS.format(input=" ".join(f'"{path}"' for path in inputs),
                                   filter=FILTER.replace('"', r"\""), output=folder)
        subprocess.run(["doxygen", "-"], input=settings, text=True, check=True,
                       capture_output=True)
        self.files, self.structs, self.names = {}, {}, {}
        for path in sorted(glob.glob(os.path.join(folder, "xml", "*.xml"))):
            for compound in tree.parse(path).iter("compounddef"):
                self.take(compound)

    def take(self, compound):
        name = compound.findtext("compoundname")
        if compound.get("kind") == "file":
            self.files[name] = compound
        elif compound.get("kind") in ("struct", "union"):
            self.structs[compound.get("id")] = compound
            self.names[compound.get("id")] = name
        for member in compound.iter("memberdef"):
            if member.get("kind") in ("function", "enum", "define", "typedef"):
                self.names[member.get("id")] = member.findtext("name")

    def text(self, element):
        """What is said of something, as HTML."""
        if element is None:
            return ""
        parts = [html.escape(element.text or "")]
        for child in element:
            parts += [SIGNS.get(child.tag) or self.text(child),
                      html.escape(child.tail or "")]
        inner = "".join(parts)
        if element.tag == "ref" and element.get("refid") in self.names:
            return f'<a href="#{self.names[element.get("refid")]}">{inner}</a>'
        tag = TAGS.get(element.tag)
        return f"<{tag}>{inner}</{tag}>" if tag else inner

    def said(self, element):
        return (self.text(element.find("briefdescription")) +
                self.text(element.find("detaileddescription"))).strip()

    def entry(self, name, heads, body):
        signature = "".join(f"<span>{html.escape(head)}</span>" for head in heads)
        return (f'<h3 id="{name}"><code>{name}</code></h3>\n'
                f'<pre class="signature">{signature}</pre>\n{body}')

    def rows(self, members):
        lines = [f"<tr><td><code>{html.escape(head)}</code><td>{said}</tr>"
                 for head, said in members]
        return "<table>" + "\n".join(lines) + "</table>" if lines else ""

    def struct(self, compound):
        name = compound.findtext("compoundname")
        members = [(m.findtext("definition").replace(name + "::", "") +
                    (m.findtext("argsstring") or ""), self.said(m))
                   for m in compound.iter("memberdef")]
        return self.entry(name, ["struct " + name],
                          self.said(compound) + self.rows(members))

    def enum(self, member):
        name = member.findtext("name")
        values = [(v.findtext("name") + " " + (v.findtext("initializer") or ""),
                   self.said(v)) for v in member.findall("enumvalue")]
        return self.entry(name, ["enum " + name],
                          self.said(member) + self.rows(values))

    def functions(self, members):
        """Functions without words of their own share those of the one before."""
        groups = []
        for member in members:
            said = self.said(member)
            if said or not groups:
                groups.append(([], said))
            groups[-1][0].append(member)
        for group, said in groups:
            names = [member.findtext("name") for member in group]
            heads = [member.findtext("definition") + member.findtext("argsstring") + ";"
                     for member in group]
            anchors = "".join(f'<span id="{name}"></span>' for name in names[1:])
            yield self.entry(names[0], heads, anchors + said)

    def part(self, members):
        """A part of a header, in its order: enumerations, then functions."""
        in_order = sorted(members, key=lambda m: int(m.find("location").get("line")))
        for member in in_order:
            if member.get("kind") == "enum" and member.findtext("name"):
                yield self.enum(member)
        yield from self.functions([m for m in in_order if m.get("kind") == "function"])

    def page(self):
        parts = ["<h1>pccd.h by function</h1>"]
        for header in HEADERS:
            compound = self.files.get(os.path.basename(header))
            if compound is None:
                continue
            parts.append(f'<h2 id="{compound.findtext("compoundname")}">'
                         f'{compound.findtext("compoundname")}</h2>{self.said(compound)}')
            sections = sorted(compound.findall("sectiondef"), key=lambda s: min(
                int(m.find("location").get("line")) for m in s.findall("memberdef")))
            for section in sections:
                title = section.findtext("header")
                made = list(self.part(section.findall("memberdef")))
                if title and made:
                    parts.append(f"<h3>{html.escape(title)}</h3>")
                parts += made
            for inner in compound.findall("innerclass"):
                if inner.get("refid") in self.structs:
                    parts.append(self.struct(self.structs[inner.get("refid")]))
        return "\n".join(parts)


def reference(source):
    """The page; None without doxygen."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            return Reference(source, folder).page()
        except FileNotFoundError:
            return None
