// write_three.mjs - has three.js write the scenes as OBJ, PLY, STL and glTF.
//
// Room:     tests/files. Needs Node and, in the folder that NODE_MODULES names, three; scenes.json
//           of scenes.py.
// Does:     also boxes and spheres as three.js makes them: with a vertex a normal, and with seams.
// Usage:    node write_three.mjs SCENES FOLDER

import fs from "node:fs";
import path from "node:path";
import { pathToFileURL } from "node:url";

const modules = path.resolve(process.env.NODE_MODULES ?? "node_modules", "three");
const load = (name) => import(pathToFileURL(path.join(modules, name)).href);
const THREE = await load("build/three.module.js");
const { GLTFExporter } = await load("examples/jsm/exporters/GLTFExporter.js");
const { OBJExporter } = await load("examples/jsm/exporters/OBJExporter.js");
const { PLYExporter } = await load("examples/jsm/exporters/PLYExporter.js");
const { STLExporter } = await load("examples/jsm/exporters/STLExporter.js");

// What the exporters ask of a browser.
globalThis.requestAnimationFrame ??= (call) => setTimeout(call, 0);
globalThis.FileReader ??= class {
    async readAsArrayBuffer(blob) {
        this.result = await blob.arrayBuffer();
        this.onloadend();
    }
    async readAsDataURL(blob) {
        this.result = `data:;base64,${Buffer.from(await blob.arrayBuffer()).toString("base64")}`;
        this.onloadend();
    }
};

const [source, target] = process.argv.slice(2);
const scenes = JSON.parse(fs.readFileSync(path.join(source, "scenes.json"), "ascii"));
const folder = path.join(target, `three-${THREE.REVISION}`);
fs.mkdirSync(folder, { recursive: true });

// A scene at t; each thing an object that is moved, its faces cut as fans (they are convex).
function build(name, t) {
    const scene = new THREE.Scene();
    for (const thing of scenes[name].things) {
        const geometry = new THREE.BufferGeometry();
        geometry.setAttribute("position",
            new THREE.BufferAttribute(new Float32Array(thing.vertices.flat()), 3));
        geometry.setIndex(thing.faces.flatMap((f) =>
            f.slice(2).flatMap((_, k) => [f[0], f[k + 1], f[k + 2]])));
        const mesh = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial());
        mesh.name = thing.name;
        mesh.position.set(...thing.move.map((m) => m * t));
        scene.add(mesh);
    }
    scene.updateMatrixWorld(true);
    return scene;
}

const own = (geometry) => {
    const scene = new THREE.Scene();
    scene.add(new THREE.Mesh(geometry, new THREE.MeshBasicMaterial()));
    return scene;
};

async function write(name, way, suffix, scene) {
    const put = (ending, what, more = "") => fs.writeFileSync(
        path.join(folder, `${name}.${way}${more}${suffix}.${ending}`),
        typeof what === "string" ? what : Buffer.from(what.buffer ?? what));
    put("obj", new OBJExporter().parse(scene));
    const ply = (options) => new Promise((done) => new PLYExporter().parse(scene, done, options));
    put("ply", await ply({}));
    put("ply", await ply({ binary: true }), "-big");
    put("ply", await ply({ binary: true, littleEndian: true }), "-little");
    put("stl", new STLExporter().parse(scene));
    put("stl", new STLExporter().parse(scene, { binary: true }), "-binary");
    put("glb", await new GLTFExporter().parseAsync(scene, { binary: true }));
    put("gltf", JSON.stringify(await new GLTFExporter().parseAsync(scene, {})));
}

for (const name of ["cube", "two", "cloth", "drop", "pass", "rain"]) {
    for (const t of scenes[name].right.moves ? [0, 1] : [0]) {
        await write(name, "plain", scenes[name].right.moves ? `.${t}` : "", build(name, t));
    }
}
await write("cube", "box", "", own(new THREE.BoxGeometry(2, 2, 2)));
await write("cloth", "plane", "", own(new THREE.PlaneGeometry(8, 8, 8, 8)));
await write("cloth", "unindexed", "", own(new THREE.PlaneGeometry(8, 8, 8, 8).toNonIndexed()));
await write("globe", "seam", "", own(new THREE.SphereGeometry(1, 16, 8)));

// Animations: keys of a place, of a turn, of a morph target.
for (const [name, way] of [["drop", "location"], ["pass", "location"], ["drop", "morph"],
    ["pass", "morph"], ["swing", "rotation"]]) {
    for (const binary of [true, false]) {
        const scene = build(name, 0);
        const k = scenes[name].things.findIndex((one) => one.turn || one.move.some((m) => m !== 0));
        const { move } = scenes[name].things[k];
        const mesh = scene.children[k];
        const tracks = [];
        if (way === "location") {
            tracks.push(new THREE.VectorKeyframeTrack(`${mesh.name}.position`, [0, 1],
                [0, 0, 0, ...move]));
        } else if (way === "rotation") {
            tracks.push(new THREE.QuaternionKeyframeTrack(`${mesh.name}.quaternion`, [0, 1],
                [0, 0, 0, 1, 0, 0, Math.SQRT1_2, Math.SQRT1_2]));
        } else {
            const { position } = mesh.geometry.attributes;
            mesh.geometry.morphAttributes.position = [new THREE.BufferAttribute(new Float32Array(
                [...position.array].map((_, i) => move[i % 3])), 3)];
            mesh.geometry.morphTargetsRelative = true;
            mesh.updateMorphTargets();
            tracks.push(new THREE.NumberKeyframeTrack(`${mesh.name}.morphTargetInfluences[0]`,
                [0, 1], [0, 1]));
        }
        const made = await new GLTFExporter().parseAsync(scene,
            { binary, animations: [new THREE.AnimationClip("Move", 1, tracks)] });
        fs.writeFileSync(path.join(folder, `${name}.${way}.${binary ? "glb" : "gltf"}`),
            binary ? Buffer.from(made) : JSON.stringify(made));
    }
}
