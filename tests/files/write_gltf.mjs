// write_gltf.mjs - has gltf-transform, gltf-pipeline and obj2gltf write the scenes as glTF.
//
// Room:     tests/files. Needs Node, and in the folder that NODE_MODULES names: @gltf-transform/core,
//           @gltf-transform/functions, @gltf-transform/extensions, meshoptimizer, draco3dgltf,
//           gltf-pipeline, obj2gltf; scenes.json and the OBJ files of scenes.py.
// Does:     each way of glTF to say where surfaces are: modes, sparse, quantised, instanced and
//           compressed accessors, turned and scaled nodes, morph targets, skins, animations of each
//           interpolation. A file is SCENE.WAY.ENDING, the two of a motion SCENE.WAY.0.ENDING and .1.
// Usage:    node write_gltf.mjs SCENES FOLDER

import fs from "node:fs";
import path from "node:path";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";

const modules = path.resolve(process.env.NODE_MODULES ?? "node_modules");
const require = createRequire(path.join(modules, "x.js"));
const load = async (name) => import(pathToFileURL(require.resolve(name)).href);
const versionOf = (name) =>
    JSON.parse(fs.readFileSync(path.join(modules, name, "package.json"), "utf8")).version;

const [source, target] = process.argv.slice(2);
const scenes = JSON.parse(fs.readFileSync(path.join(source, "scenes.json"), "ascii"));
const { Document, NodeIO, Primitive } = await load("@gltf-transform/core");
const functions = await load("@gltf-transform/functions");
const extensions = await load("@gltf-transform/extensions");
const { MeshoptDecoder, MeshoptEncoder } = await load("meshoptimizer");
const draco = await load("draco3dgltf");

const folderOf = (name) => {
    const folder = path.join(target, `${name.replace(/^@|\/core$/g, "")}-${versionOf(name)}`);
    fs.mkdirSync(folder, { recursive: true });
    return folder;
};
const folder = folderOf("@gltf-transform/core");
await MeshoptEncoder.ready;
const io = new NodeIO().registerExtensions(extensions.ALL_EXTENSIONS).registerDependencies({
    "meshopt.encoder": MeshoptEncoder,
    "meshopt.decoder": MeshoptDecoder,
    "draco3d.encoder": await (draco.default ?? draco).createEncoderModule(),
    "draco3d.decoder": await (draco.default ?? draco).createDecoderModule(),
});

const triangles = (thing) =>
    thing.faces.flatMap((f) => f.slice(2).map((_, k) => [f[0], f[k + 1], f[k + 2]]));

// A document of a scene at t, each thing a node; `moved` is how a thing is moved.
function build(name, t, moved = "node") {
    const document = new Document();
    const buffer = document.createBuffer();
    const scene = document.createScene();
    for (const thing of scenes[name].things) {
        const shift = thing.move.map((m) => m * t);
        const at = moved === "vertices" ? thing.vertices.map((v) => v.map((x, k) => x + shift[k]))
                                        : thing.vertices;
        const positions = document.createAccessor().setType("VEC3").setBuffer(buffer)
            .setArray(new Float32Array(at.flat()));
        const indices = document.createAccessor().setType("SCALAR").setBuffer(buffer)
            .setArray(new Uint16Array(triangles(thing).flat()));
        const primitive = document.createPrimitive().setAttribute("POSITION", positions)
            .setIndices(indices);
        const node = document.createNode(thing.name)
            .setMesh(document.createMesh(thing.name).addPrimitive(primitive));
        if (moved === "node") {
            node.setTranslation(shift);
        }
        scene.addChild(node);
    }
    return document;
}

const primitives = (document) => document.getRoot().listMeshes().flatMap((m) => m.listPrimitives());
const scene = (document) => document.getRoot().listScenes()[0];
const buffer = (document) => document.getRoot().listBuffers()[0];

async function keep(document, name, where = folder) {
    await io.write(path.join(where, name), document);
}

// One file, or two if the scene moves, of what `change` makes of the document.
async function still(name, way, change, ending = "glb", moved = "node") {
    for (const t of scenes[name].right.moves ? [0, 1] : [0]) {
        const document = build(name, t, moved);
        await change(document);
        await keep(document, scenes[name].right.moves ? `${name}.${way}.${t}.${ending}`
                                                      : `${name}.${way}.${ending}`);
    }
}

// All triangles as one strip, joined by triangles without area.
function strip(document) {
    for (const primitive of primitives(document)) {
        const list = [...primitive.getIndices().getArray()];
        const indices = list.slice(0, 3);
        for (let k = 3; k < list.length; k += 3) {
            const [a, b, c] = list.slice(k, k + 3);
            // Each triangle begins at an even place, so that none is turned over.
            indices.push(indices.at(-1), a, ...(indices.length % 2 ? [a] : []), a, b, c);
        }
        primitive.setMode(Primitive.Mode.TRIANGLE_STRIP);
        primitive.getIndices().setArray(new Uint16Array(indices));
    }
}

// Each triangle a fan of its own: as many primitives as triangles.
function fans(document) {
    for (const mesh of document.getRoot().listMeshes()) {
        const [primitive] = mesh.listPrimitives();
        const list = primitive.getIndices().getArray();
        mesh.removePrimitive(primitive);
        for (let k = 0; k < list.length; k += 3) {
            mesh.addPrimitive(primitive.clone().setMode(Primitive.Mode.TRIANGLE_FAN).setIndices(
                document.createAccessor().setType("SCALAR").setBuffer(buffer(document))
                    .setArray(new Uint16Array(list.slice(k, k + 3)))));
        }
    }
}

// The spikes of "rain" are one mesh at four places.
function share(document) {
    const [, first, ...others] = scene(document).listChildren();
    others.forEach((node, k) => {
        const [x, y, z] = node.getTranslation();
        node.setMesh(first.getMesh()).setTranslation([x + k + 1, y, z]);
    });
}

function under(document, matrix) {
    const parent = document.createNode("Parent").setMatrix(matrix);
    for (const node of scene(document).listChildren()) {
        scene(document).removeChild(node);
        parent.addChild(node);
    }
    scene(document).addChild(parent);
}

const turned = [0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 3, 5, 7, 1]; // by 90 degrees, twice the size
const skewed = [1, 0, 0, 0, 0.5, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
const mirrored = [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

const half = [0, 0.5, 1];

// An animation of `path` of a node, with its keys.
function animate(document, node, path, times, values, interpolation = "LINEAR", type = "VEC3") {
    const make = (kind, array) => document.createAccessor().setType(kind).setBuffer(buffer(document))
        .setArray(new Float32Array(array));
    const sampler = document.createAnimationSampler().setInput(make("SCALAR", times))
        .setOutput(make(type, values)).setInterpolation(interpolation);
    const channel = document.createAnimationChannel().setTargetNode(node).setTargetPath(path)
        .setSampler(sampler);
    document.createAnimation("Move").addSampler(sampler).addChannel(channel);
}

const moving = (document, name) => {
    const k = scenes[name].things.findIndex((one) => one.turn || one.move.some((m) => m !== 0));
    return [document.getRoot().listNodes()[k], scenes[name].things[k]];
};

function byTranslation(document, name, interpolation = "LINEAR") {
    const [node, { move }] = moving(document, name);
    if (interpolation === "CUBICSPLINE") { // tangents that make it linear
        const values = half.flatMap((t) => [...move, ...move.map((m) => m * t), ...move]);
        animate(document, node, "translation", half, values, interpolation);
    } else {
        animate(document, node, "translation", half, half.flatMap((t) => move.map((m) => m * t)),
            interpolation);
    }
}

function byMorph(document, name, sparse = false) {
    const [node, { move, vertices }] = moving(document, name);
    const target = document.createPrimitiveTarget("Down").setAttribute("POSITION",
        document.createAccessor().setType("VEC3").setBuffer(buffer(document))
            .setArray(new Float32Array(vertices.flatMap(() => move))).setSparse(sparse));
    node.getMesh().setWeights([0]).listPrimitives()[0].addTarget(target);
    animate(document, node, "weights", half, half, "LINEAR", "SCALAR");
}

// Two joints, each with half of the weight; the node's own place must not count.
function bySkin(document, name) {
    const [node, { move, vertices }] = moving(document, name);
    const accessor = (type, array) => document.createAccessor().setType(type)
        .setBuffer(buffer(document)).setArray(array);
    const joints = [1, 2].map((k) => document.createNode(`Joint${k}`).setTranslation([0, 0, k]));
    joints.forEach((joint) => scene(document).addChild(joint));
    const skin = document.createSkin("Skin").setInverseBindMatrices(accessor("MAT4",
        new Float32Array([1, 2].flatMap((k) => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -k, 1]))));
    joints.forEach((joint) => skin.addJoint(joint));
    node.setSkin(skin).setTranslation([7, 8, 9]);
    node.getMesh().listPrimitives()[0]
        .setAttribute("JOINTS_0", accessor("VEC4",
            new Uint8Array(vertices.flatMap(() => [0, 1, 0, 0]))))
        .setAttribute("WEIGHTS_0", accessor("VEC4",
            new Float32Array(vertices.flatMap(() => [0.5, 0.5, 0, 0]))));
    joints.forEach((joint, j) => animate(document, joint, "translation", half,
        half.flatMap((t) => move.map((m, k) => m * t + (k === 2 ? j + 1 : 0)))));
}

function byRotation(document, name, interpolation = "LINEAR") {
    const [node] = moving(document, name);
    const at = (k) => [0, 0, Math.sin(k * Math.PI / 16), Math.cos(k * Math.PI / 16)];
    const keys = [0, 1, 2, 3, 4];
    animate(document, node, "rotation", keys, keys.flatMap(at), interpolation, "VEC4");
}

for (const name of ["cube", "two", "cloth", "drop", "pass", "rain"]) {
    const nothing = () => undefined;
    await still(name, "plain", nothing);
    await still(name, "plain", nothing, "gltf");
    await still(name, "vertices", nothing, "glb", "vertices");
    await still(name, "fans", fans);
    await still(name, "strip", strip);
    await still(name, "turned", (d) => under(d, turned));
    await still(name, "mirrored", (d) => under(d, mirrored));
    await still(name, "skewed", (d) => under(d, skewed));
    await still(name, "unweld", (d) => d.transform(functions.unweld()));
    await still(name, "sparse", (d) => d.transform(functions.sparse({ ratio: 1 })), "glb", "vertices");
    await still(name, "quantize", (d) => d.transform(
        functions.quantize({ quantizationVolume: "scene" })));
    await still(name, "quantize-mesh", (d) => d.transform(functions.quantize()));
    if (name !== "pass") { // whose edges pass nearer to each other than that
        await still(name, "quantize-8", (d) => d.transform(
            functions.quantize({ quantizePosition: 8, quantizationVolume: "scene" })));
    }
    await still(name, "meshopt", (d) => d.transform(functions.meshopt({ encoder: MeshoptEncoder })));
    await still(name, "draco", (d) => d.transform(functions.draco()));
    await still(name, "flatten", (d) => d.transform(functions.flatten(), functions.join()));
}
await still("rain", "shared", share);
await still("rain", "instances", (d) => { share(d); return d.transform(functions.instance({ min: 2 })); });
for (const name of ["drop", "pass"]) {
    for (const [way, change] of [
        ["location", (d) => byTranslation(d, name)],
        ["step", (d) => byTranslation(d, name, "STEP")],
        ["spline", (d) => byTranslation(d, name, "CUBICSPLINE")],
        ["morph", (d) => byMorph(d, name)],
        ["morph-sparse", (d) => byMorph(d, name, true)],
        ["skin", (d) => bySkin(d, name)],
        ["resample-location", (d) => { byTranslation(d, name); return d.transform(functions.resample()); }],
        ["turned-location", (d) => { byTranslation(d, name); under(d, turned); }],
        ["quantize-morph", (d) => { byMorph(d, name); return d.transform(functions.quantize()); }],
        ["quantize-skin", (d) => { bySkin(d, name); return d.transform(functions.quantize()); }],
    ]) {
        for (const ending of ["glb", "gltf"]) {
            const document = build(name, 0);
            await change(document);
            await keep(document, `${name}.${way}.${ending}`);
        }
    }
}
for (const [way, change] of [
    ["rotation", (d) => byRotation(d, "swing")],
    ["rotation-resample", (d) => { byRotation(d, "swing"); return d.transform(functions.resample()); }],
]) {
    const document = build("swing", 0);
    await change(document);
    await keep(document, `swing.${way}.glb`);
}

const obj2gltf = require("obj2gltf");
const pipeline = require("gltf-pipeline");
const objFolder = folderOf("obj2gltf");
const pipeFolder = folderOf("gltf-pipeline");
const isPair = (name) => scenes[name].right.moves;
// Where three corners of a polygon are on a line, obj2gltf leaves a triangle without area, whose
// corner really touches another one's side.
const left = ["swing", "ell", "slope"];
for (const file of fs.readdirSync(source).filter((f) => f.endsWith(".obj"))) {
    const [name, t] = file.split(".");
    if (left.includes(name)) {
        continue;
    }
    const named = (way, ending) => `${name}.${way}${isPair(name) ? `.${t}` : ""}.${ending}`;
    const from = path.join(source, file);
    fs.writeFileSync(path.join(objFolder, named("binary", "glb")), await obj2gltf(from, { binary: true }));
    const gltf = await obj2gltf(from);
    fs.writeFileSync(path.join(objFolder, named("inside", "gltf")), JSON.stringify(gltf));
    if (["cube", "drop", "pass"].includes(name)) {
        const clone = () => JSON.parse(JSON.stringify(gltf));
        fs.writeFileSync(path.join(pipeFolder, named("binary", "glb")),
            (await pipeline.gltfToGlb(clone())).glb);
        const separate = await pipeline.processGltf(clone(), { separate: true });
        fs.writeFileSync(path.join(pipeFolder, named("separate", "gltf")), JSON.stringify(separate.gltf));
        for (const [other, bytes] of Object.entries(separate.separateResources)) {
            fs.writeFileSync(path.join(pipeFolder, other), bytes);
        }
        const squeezed = await pipeline.gltfToGlb(clone(), { dracoOptions: { compressionLevel: 7 } });
        fs.writeFileSync(path.join(pipeFolder, named("draco", "glb")), squeezed.glb);
    }
}
