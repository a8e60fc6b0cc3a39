// build.mjs - the sources of the page become one file.
//
// node build.mjs MODULES OUT: MODULES is the folder that holds node_modules. The page gets
// its script and its style inline, and a policy that lets it run nothing else: what stands in
// the data of a recording cannot become a script. The same sources give the same bytes.

import { createHash } from "node:crypto";
import { readFile, writeFile } from "node:fs/promises";
import { createRequire } from "node:module";
import path from "node:path";
import { fileURLToPath } from "node:url";

const [modules, out] = process.argv.slice(2);
const here = path.dirname(fileURLToPath(import.meta.url));
const nodeModules = path.resolve(modules, "node_modules");
const esbuild = createRequire(path.join(nodeModules, "x.js"))("esbuild");

async function bundle(entry) {
  const built = await esbuild.build({
    absWorkingDir: here,
    entryPoints: [entry],
    nodePaths: [nodeModules],
    bundle: true,
    minify: true,
    format: "iife",
    target: ["chrome100", "firefox100", "safari15.4"],
    legalComments: "none", // the licence is in the page as a whole
    write: false,
  });
  return built.outputFiles[0].text.trim();
}

const hash = (text) => `'sha256-${createHash("sha256").update(text).digest("base64")}'`;
const [template, script, style, licence] = await Promise.all([
  readFile(path.join(here, "src/index.html"), "utf8"),
  bundle("src/main.js"),
  bundle("src/style.css"),
  readFile(path.join(nodeModules, "three/LICENSE"), "utf8"),
]);
if (/<\/script|<!--/i.test(script) || /<\/style/i.test(style) || licence.includes("--")) {
  throw new Error("a part of the page would end the element that it stands in");
}
const policy = [
  "default-src 'none'",
  `script-src ${hash(script)}`,
  `style-src ${hash(style)}`,
  "img-src data:",
  "base-uri 'none'",
  "form-action 'none'",
].join("; ");
const parts = { policy, script, style, licence: licence.trim() };
const page = template.replace(/\{\{(\w+)\}\}/g, (_, name) => parts[name]);
if (page.split("<!--pccd:data-->").length !== 2) {
  throw new Error("the template needs one place for data");
}
await writeFile(out, page);
