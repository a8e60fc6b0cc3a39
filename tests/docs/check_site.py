"""check_site.py - what a reader of the site meets.

Room:     tests/docs. Imports browser.py of tests/inspect.
Does:     follow every link of every page in $SITE; look for each function of the library
          in the reference; open pages in a headless Chromium of the width of a phone, and
          search there.
"""

import html.parser
import os
import re
import shutil
import tempfile
import unittest

from browser import Browser, is_here

SITE = os.environ["SITE"]
MAP = os.path.join(os.environ["top_srcdir"], "client/lib/libpccd.map")
WIDE = 400  # of a phone, in pixels


class Page(html.parser.HTMLParser):
    def __init__(self, name):
        super().__init__()
        self.anchors, self.links = set(), []
        with open(os.path.join(SITE, name)) as file:
            self.feed(file.read())

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        self.anchors.add(given.get("id"))
        self.links += [(tag, given[key]) for key in ("href", "src") if key in given]


class Site(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        names = [name for name in os.listdir(SITE) if name.endswith(".html")]
        cls.pages = {name: Page(name) for name in names}

    # If it failed, a reader would click and find nothing.
    def test_site__leads_somewhere(self):
        followed = 0
        for name, page in self.pages.items():
            for _, link in page.links:
                file, _, anchor = link.partition("#")
                if ":" in file:
                    continue
                followed += 1
                there = os.path.join(SITE, file or name)
                self.assertTrue(os.path.isfile(there), (name, link))
                if anchor:
                    self.assertIn(anchor, self.pages[file or name].anchors, (name, link))
        self.assertGreater(followed, 500)

    # If it failed, a page from a disk would need the network, or tell of its reader.
    def test_site__asks_nobody(self):
        for name, page in self.pages.items():
            for tag, link in page.links:
                self.assertTrue(tag == "a" or ":" not in link, (name, tag, link))

    # If it failed, nobody would find what is written.
    def test_site__has_every_document(self):
        menu = {link for _, link in self.pages["index.html"].links}
        for name in ("cloth game edge robot jam bake replay share answer guide protocol "
                     "measurements pccdctl.1 pccdd.8 libpccd.3").split():
            self.assertIn(name + ".html", menu)
            self.assertGreater(os.path.getsize(os.path.join(SITE, name + ".html")), 3000)

    @unittest.skipUnless(shutil.which("doxygen"), "no doxygen")
    # If it failed, a function would be described on no page, or could not be linked to.
    def test_site__has_every_function(self):
        with open(MAP) as file:
            names = re.findall(r"^ *(pccd_\w+);$", file.read(), re.M)
        self.assertGreater(len(names), 80)
        self.assertEqual(set(names) - self.pages["pccd.h.html"].anchors, set())

    @unittest.skipUnless(is_here(), "no chromium, or no chromedriver")
    @unittest.skipUnless(os.path.exists(os.path.join(SITE, "search.html")), "no lunr")
    # If it failed, a word would be looked for in vain, though it is on a page.
    def test_site__finds_what_is_searched(self):
        with tempfile.TemporaryDirectory() as folder:
            browser = Browser(folder, webgl=False)
            self.addCleanup(browser.close)
            for words, link in (("thickness", "guide.html#thickness"),
                                ("pccd_step_x1", "pccd.h.html#pccd_step_x1"),
                                ("xyzzy", None)):
                browser.open(os.path.join(SITE, "guide.html"))
                browser.run("const box = document.querySelector('input');"
                            "box.value = arguments[0]; box.form.submit();", words)
                browser.wait("return document.getElementById('count')?.textContent"
                             ".includes(arguments[0])", words)
                links = browser.run("return [...document.querySelectorAll('#hits a')]"
                                    ".map((a) => a.getAttribute('href'))")
                self.assertIn(link, links[:3] or [None], words)

    @unittest.skipUnless(is_here(), "no chromium, or no chromedriver")
    # If it failed, somebody with a phone would push pages to and fro to read a line.
    def test_site__fits_a_phone(self):
        with tempfile.TemporaryDirectory() as folder:
            browser = Browser(folder, webgl=False)
            self.addCleanup(browser.close)
            browser.resize(WIDE, 800)
            for name in sorted(self.pages):
                browser.open(os.path.join(SITE, name))
                wide = browser.run("return document.documentElement.scrollWidth")
                self.assertLessEqual(wide, WIDE, name)
