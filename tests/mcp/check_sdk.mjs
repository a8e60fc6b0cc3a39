// check_sdk.mjs - pccdctl mcp by the client library that its users have.
//
// Room:     tests/mcp. Needs Node and, in the folder that NODE_MODULES names, what package.json
//           names. PCCDCTL, PCCD_DAEMON; the folder to open.
// Does:     call each tool as the library starts a server: with six variables of the environment.
//           It compares each answer with the tool's schema by itself. Prints "true" at the end.
import assert from "node:assert";
import path from "node:path";
import { pathToFileURL } from "node:url";

const modules = path.resolve(process.env.NODE_MODULES ?? "node_modules", "@modelcontextprotocol/sdk");
const load = async (name) => import(pathToFileURL(path.join(modules, "dist/esm/client", name)));
const { Client } = await load("index.js");
const { StdioClientTransport, getDefaultEnvironment } = await load("stdio.js");

const folder = process.argv[2];
const transport = new StdioClientTransport({
    command: process.env.PCCDCTL,
    args: ["mcp", "--write", "--daemon", process.env.PCCD_DAEMON, folder],
});
assert(!("XDG_RUNTIME_DIR" in getDefaultEnvironment()));
const client = new Client({ name: "check_sdk", version: "1" });
await client.connect(transport);
const { tools } = await client.listTools();
assert.deepStrictEqual(tools.map((tool) => tool.name),
    ["scene", "check", "near", "crossings", "sweep", "explain", "more", "record", "verify"]);

const call = async (name, args) => {
    const result = await client.callTool({ name, arguments: args });
    assert(JSON.stringify(result).length <= 2048, name);
    assert(!result.isError, JSON.stringify(result));
    return result.structuredContent;
};
const files = ["box%d.obj"];
const listed = await call("scene", {});
assert(listed.rows.some((row) => row.file === "box0.obj"));
await call("scene", { files: ["box%d.obj", "floor.obj"], output: "sdk.json" });
const checked = await call("check", { files, with: ["floor.obj"] });
assert.strictEqual(checked.verdict, "meets");
assert.strictEqual(checked.first.step, 3);
assert.strictEqual((await call("near", { files: ["box1.obj", "floor.obj"] })).distance_min, 6);
assert.strictEqual((await call("crossings", { files: ["box0.obj", "floor.obj"] })).verdict, "no");
assert.strictEqual((await call("sweep", { file: "hinge.json" })).verdict, "jams");
const rows = await call("more", { handle: checked.contacts_handle, offset: 2 });
assert.strictEqual(rows.row_count, checked.contacts);
const told = await call("explain", { handle: checked.contacts_handle, row: 0, picture: true });
const picture = await client.readResource({ uri: told.picture });
assert(Buffer.from(picture.contents[0].blob, "base64").subarray(1, 4).toString() === "PNG");
await call("record", { files: ["sdk.json"], output: "sdk.rec" });
assert.strictEqual((await call("verify", { recording: "sdk.rec" })).verdict, "pass");

const refused = await client.callTool({ name: "check", arguments: { files: ["../x.obj"] } });
assert(refused.isError && refused.content[0].text.includes("outside of the folder"));
await assert.rejects(client.callTool({ name: "nothing", arguments: {} }));
await client.ping();
await client.close();
console.log("true");
