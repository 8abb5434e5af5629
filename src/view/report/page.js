"use strict";
const runs = JSON.parse(document.getElementById("data").textContent);
const find = (id) => document.getElementById(id);
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const hues = ["#31688e", "#d97a1c", "#35b779", "#b73779", "#7e57c2", "#8d6e63", "#0097a7", "#c0ca33"];
const hue = (index) => hues[index % hues.length];
const shortly = (value) => {
    if (!Number.isFinite(value)) return "–";
    const size = Math.abs(value);
    return size !== 0 && (size >= 1e5 || size < 1e-3) ? value.toExponential(2) : String(Number(value.toPrecision(4)));
};
const element = (name, text, parent) => {
    const made = document.createElement(name);
    if (text !== undefined) made.textContent = text;
    if (parent) parent.appendChild(made);
    return made;
};

// Elements along and across, of the only shell or of each.
const each = (elements) => Array.isArray(elements[0]) ? elements : [elements];
const sizes = (elements) => each(elements).map((counts) => counts.join(" × ")).join(" + ");

// Charts.

const charts = [];
function chart(id, across, up, datasets, more = {}) {
    const axis = (text, extra) => ({
        type: "linear", title: { display: true, text, color: css("--ink") },
        ticks: { color: css("--soft") }, grid: { color: css("--line") }, ...extra,
    });
    charts.push(new Chart(find(id), {
        type: "scatter",
        data: { datasets },
        options: {
            animation: false, maintainAspectRatio: false, parsing: false,
            scales: { x: axis(across, more.x), y: axis(up, more.y) },
            plugins: {
                legend: { labels: { color: css("--ink"), filter: (item) => !item.text.startsWith("_") } },
                tooltip: { callbacks: { label: (item) => item.raw.note ?? `${item.dataset.label}: ${shortly(item.raw.x)}, ${shortly(item.raw.y)}` } },
            },
        },
    }));
}
function line(run, index, value, extra = {}) {
    return {
        label: run.name, data: run.points.flatMap((point) => {
            const y = value(point);
            return y === null ? [] : [{ x: point.at, y, note: `${run.name}, step ${point.step}: ${shortly(point.at)}, ${shortly(y)}` }];
        }),
        showLine: true, borderColor: hue(index), backgroundColor: hue(index), borderWidth: 2, pointRadius: 1.5, ...extra,
    };
}
// A jump is no path: its stretch is dashed. Unstable stretches are dashed too.
function segments(run) {
    const shown = run.points.filter((point) => point.value !== null);
    return {
        borderDash: (context) => {
            // The first point is that at rest, but for load factors.
            const to = shown[context.p1DataIndex - (run.parameter === "load factor" ? 0 : 1)];
            return to && (to.jumped || !to.stable) ? [3, 4] : undefined;
        },
    };
}
function drawCharts() {
    charts.splice(0).forEach((drawn) => drawn.destroy());
    const across = runs[0].parameter;
    // A load factor is drawn over the probe, as books have it.
    const swapped = across === "load factor";
    const turned = (set) => swapped ? { ...set, data: set.data.map((point) => ({ ...point, x: point.y, y: point.x })) } : set;
    const critical = runs.flatMap((run, index) => {
        const marked = run.points.filter((point) => (point.critical || point.jumped) && point.value !== null);
        const note = (point) => `${run.name}, step ${point.step}: ${point.critical ?? "jumped to here"}`;
        const data = marked.map((point) => ({ x: point.at, y: point.value, note: note(point) }));
        return data.length ? [{ label: `_critical ${index}`, data, pointStyle: "rectRot", pointRadius: 6, backgroundColor: "#b73779", borderColor: hue(index) }] : [];
    });
    // What is at rest has no moment.
    const rest = (set) => swapped ? set : { ...set, data: [{ x: 0, y: 0, note: "at rest" }, ...set.data] };
    const path = runs.map((run, index) => rest(line(run, index, (p) => p.value, { segment: segments(run) })));
    const laws = runs.filter((run, index) => runs.findIndex((other) => JSON.stringify(other.laws) === JSON.stringify(run.laws)) === index).flatMap((run) => run.laws);
    const theory = laws.map((law, index) => ({
        label: law.name, data: law.points.map(([x, y]) => ({ x, y, note: `${law.name}: ${shortly(x)}, ${shortly(y)}` })), showLine: true, pointRadius: 0, borderWidth: 1.2,
        borderColor: css("--soft"), backgroundColor: css("--soft"), borderDash: index % 2 ? [2, 3] : [8, 5],
    }));
    const peaks = runs.flatMap((run, index) => run.peak ? [{ label: `_peak ${index}`, data: [{ x: run.peak[0], y: run.peak[1], note: `${run.name}, peak: ${shortly(run.peak[0])}, ${shortly(run.peak[1])}` }],
        pointStyle: "triangle", pointRadius: 6, backgroundColor: hue(index), borderColor: hue(index) }] : []);
    const [along, up] = swapped ? [runs[0].quantity, across] : [across, runs[0].quantity];
    chart("path", along, up, [...path, ...theory, ...critical, ...peaks].map(turned));
    chart("elements", across, "elements of the model", runs.map((run, index) => line(run, index, (p) => each(p.elements).reduce((sum, [along, across]) => sum + along * across, 0), { stepped: "after", pointRadius: 0 })), { y: { type: "logarithmic" } });
    chart("time", across, "wall time (s)", runs.map((run, index) => line(run, index, (p) => p.wall_s, { pointRadius: 0 })));
    chart("work", across, "iterations", runs.map((run, index) => line(run, index, (p) => p.iterations, { pointRadius: 0 })));
    chart("stored", across, "strain energy (N·mm)", runs.map((run, index) => line(run, index, (p) => p.energy, { pointRadius: 0 })));
}

// Shapes.

function numbers(text) {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    return new Uint16Array(bytes.buffer);
}
function places(shape, text) {
    const packed = numbers(text), out = new Float32Array(packed.length);
    for (let i = 0; i < packed.length; i++) {
        const [low, high] = shape.bounds[i % 3];
        out[i] = low + (high - low) * packed[i] / 65535;
    }
    return out;
}
// What has no value is grey.
function coloured(shape, frame, field) {
    const packed = numbers(frame.values[field]), out = new Float32Array(3 * packed.length), stops = shape.colours;
    const blanks = shape.fields[field].has_blanks, most = blanks ? 65534 : 65535;
    for (let i = 0; i < packed.length; i++) {
        if (blanks && packed[i] === 65535) { out.fill(0.75, 3 * i, 3 * i + 3); continue; }
        const place = packed[i] / most * (stops.length - 1), below = Math.min(Math.floor(place), stops.length - 2), part = place - below;
        for (let c = 0; c < 3; c++) {
            const channel = (stop) => (stops[stop] >> (16 - 8 * c)) & 255;
            out[3 * i + c] = ((1 - part) * channel(below) + part * channel(below + 1)) / 255;
        }
    }
    return out;
}
// Points of one shell follow those of another.
function quads(shape) {
    const list = [];
    let first = 0;
    for (const [n1, n2] of shape.counts) {
        const point = (i, j) => first + i * n2 + j;
        for (let i = 0; i + 1 < n1; i++) for (let j = 0; j + 1 < n2; j++) list.push([point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]);
        first += n1 * n2;
    }
    return list;
}
// Knot lines as pairs of points: those of one u have as many points as there are places across, and the others as many as along.
function pairs(shape, frame) {
    const coordinates = places(shape, frame.lines), out = [];
    let first = 0;
    const add = (from, count) => { for (let k = from; k + 1 < from + count; k++) for (const p of [k, k + 1]) out.push(coordinates[3 * p], coordinates[3 * p + 1], coordinates[3 * p + 2]); };
    shape.counts.forEach(([n1, n2], shell) => {
        const [l1, l2] = frame.line_counts[shell];
        for (let l = 0; l < l1; l++) add(first + l * n2, n2);
        first += l1 * n2;
        for (let l = 0; l < l2; l++) add(first + l * n1, n1);
        first += l2 * n1;
    });
    return new Float32Array(out);
}
const shaped = runs.filter((run) => run.shape && run.shape.frames.length);
let current = null;

function solid(canvas) {
    const { BufferAttribute, BufferGeometry, DirectionalLight, DoubleSide, HemisphereLight, LineBasicMaterial, LineSegments, Mesh, MeshStandardMaterial, OrbitControls, PerspectiveCamera, Scene, Vector3, WebGLRenderer } = THREE;
    let renderer;
    try { renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true }); } catch { return null; }
    renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    const scene = new Scene(), camera = new PerspectiveCamera(35, 1, 0.1, 1e6);
    camera.up.set(0, 0, 1);
    scene.add(new HemisphereLight(0xffffff, 0xbbbbbb, 2.6));
    const sun = new DirectionalLight(0xffffff, 1.0);
    scene.add(sun);
    const geometry = new BufferGeometry(), lines = new BufferGeometry();
    scene.add(new Mesh(geometry, new MeshStandardMaterial({ vertexColors: true, side: DoubleSide, roughness: 0.9, metalness: 0, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 })));
    scene.add(new LineSegments(lines, new LineBasicMaterial({ color: 0xffffff, transparent: true, opacity: 0.5 })));
    const controls = new OrbitControls(camera, canvas);
    controls.enableDamping = false;
    const draw = () => { sun.position.copy(camera.position); renderer.render(scene, camera); };
    controls.addEventListener("change", draw);
    const resize = () => {
        const { clientWidth: width, clientHeight: height } = canvas.parentElement;
        renderer.setSize(width, height, false);
        camera.aspect = width / Math.max(height, 1);
        camera.updateProjectionMatrix();
        draw();
    };
    const view = {
        look() {
            resize();
            // All steps fit, on a narrow screen too.
            const [low, high] = [0, 1].map((end) => new Vector3(...current.shape.bounds.map((bound) => bound[end])));
            const center = low.clone().add(high).multiplyScalar(0.5), radius = 0.5 * high.distanceTo(low) || 1;
            controls.target.copy(center);
            const half = Math.PI / 360 * camera.fov, narrower = Math.min(half, Math.atan(Math.tan(half) * camera.aspect));
            camera.position.copy(center).add(new Vector3(-0.5, -1, 0.55).setLength(radius / Math.sin(narrower)));
            camera.near = radius / 100;
            camera.far = radius * 100;
            camera.updateProjectionMatrix();
            controls.update();
            draw();
        },
        show(shape, frame, field) {
            const faces = quads(shape).flatMap(([a, b, c, d]) => [a, b, c, a, c, d]);
            geometry.setIndex(faces);
            geometry.setAttribute("position", new BufferAttribute(places(shape, frame.points), 3));
            geometry.setAttribute("color", new BufferAttribute(coloured(shape, frame, field).map((x) => x ** 2.2), 3));
            geometry.computeVertexNormals();
            lines.setAttribute("position", new BufferAttribute(pairs(shape, frame), 3));
            geometry.computeBoundingSphere();
            lines.computeBoundingSphere();
            draw();
        },
    };
    let turned = false;
    controls.addEventListener("start", () => { turned = true; });
    new ResizeObserver(() => turned || !current ? resize() : view.look()).observe(canvas.parentElement);
    return view;
}

// A still picture without WebGL: faces from back to front.
function still(canvas, shape, frame, field) {
    const width = 640, most = 400;
    const [ca, sa, ce, se] = [Math.cos(-1.08), Math.sin(-1.08), Math.cos(0.42), Math.sin(0.42)];
    const project = (x, y, z) => { const right = -sa * x + ca * y, near = ca * x + sa * y; return [right, -(ce * z - se * near), ce * near + se * z]; };
    const flat = (coordinates) => { const out = []; for (let i = 0; i < coordinates.length; i += 3) out.push(project(coordinates[i], coordinates[i + 1], coordinates[i + 2])); return out; };
    const points = flat(places(shape, frame.points)), colours = coloured(shape, frame, field);
    const xs = points.map((p) => p[0]), ys = points.map((p) => p[1]);
    const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    const scale = Math.min((width - 24) / (x1 - x0 || 1), (most - 24) / (y1 - y0 || 1));
    const height = Math.round(scale * (y1 - y0) + 24), context = canvas.getContext("2d");
    [canvas.width, canvas.height] = [width, height];
    const at = ([x, y]) => [width / 2 + scale * (x - 0.5 * (x0 + x1)), height / 2 + scale * (y - 0.5 * (y0 + y1))];
    const faces = quads(shape).map((corners) => [corners, corners.reduce((sum, p) => sum + points[p][2], 0)]).sort((a, b) => a[1] - b[1]);
    for (const [corners] of faces) {
        context.beginPath();
        corners.forEach((p, k) => { const [x, y] = at(points[p]); if (k) context.lineTo(x, y); else context.moveTo(x, y); });
        context.closePath();
        const rgb = [0, 1, 2].map((c) => Math.round(255 * corners.reduce((sum, p) => sum + colours[3 * p + c], 0) / 4));
        context.fillStyle = context.strokeStyle = `rgb(${rgb})`;
        context.lineWidth = 0.7;
        context.fill();
        context.stroke();
    }
    const knots = flat(pairs(shape, frame));
    context.strokeStyle = "rgba(255, 255, 255, 0.55)";
    context.lineWidth = 0.6;
    context.beginPath();
    for (let k = 0; k < knots.length; k += 2) { context.moveTo(...at(knots[k])); context.lineTo(...at(knots[k + 1])); }
    context.stroke();
}

const view = shaped.length ? solid(find("view")) : null;

function show() {
    const { shape } = current, frame = shape.frames[Number(find("step").value)], field = Number(find("field").value);
    if (view) view.show(shape, frame, field); else still(find("view"), shape, frame, field);
    find("at").textContent = `step ${frame.step}, ${frame.label}, ${sizes(frame.elements)} elements`;
    const { range, means } = shape.fields[field];
    find("low").textContent = shortly(range[0]);
    find("high").textContent = shortly(range[1]);
    find("means").textContent = means;
}
function stills() {
    const { shape } = current, field = Number(find("field").value), last = shape.frames.length - 1;
    const jumps = new Set(current.points.filter((point) => point.jumped).map((point) => point.step));
    const chosen = new Set([0, Math.round(last / 3), Math.round(2 * last / 3), last]);
    shape.frames.forEach((frame, index) => { if (jumps.has(frame.step) && chosen.size < 6) { chosen.add(index); if (index) chosen.add(index - 1); } });
    find("small").replaceChildren();
    for (const index of [...chosen].sort((a, b) => a - b)) {
        const figure = element("figure", undefined, find("small")), canvas = element("canvas", undefined, figure), frame = shape.frames[index];
        element("figcaption", `${frame.label}, ${sizes(frame.elements)} elements`, figure);
        still(canvas, shape, frame, field);
    }
}
function chooseRun() {
    current = shaped[Number(find("shape-run").value)];
    const { fields, frames, colours } = current.shape, kept = find("field").value || "0";
    find("field").replaceChildren();
    fields.forEach((field, index) => { element("option", field.title, find("field")).value = index; });
    find("field").value = kept < fields.length ? kept : "0";
    find("step").max = frames.length - 1;
    find("step").value = frames.length - 1;
    find("ramp").style.background = `linear-gradient(to right, ${colours.map((colour) => "#" + colour.toString(16).padStart(6, "0")).join(",")})`;
    show();
    if (view) view.look();
    stills();
}
let playing = null;
function play() {
    if (playing) { clearInterval(playing); playing = null; find("play").textContent = "play"; return; }
    find("play").textContent = "stop";
    const slider = find("step");
    if (slider.value === slider.max) slider.value = 0;
    playing = setInterval(() => { if (slider.value === slider.max) play(); else { slider.value = Number(slider.value) + 1; show(); } }, 120);
}

function tell() {
    find("lead").textContent = runs.map((run) => `${run.name}: ${run.points.length} load steps`).join("; ");
    runs.forEach((run, index) => run.snaps.forEach((snap) => { const item = element("li", (runs.length > 1 ? run.name + ": " : "") + "snap at " + snap, find("snaps")); item.style.color = runs.length > 1 ? hue(index) : ""; }));
    for (const run of runs) {
        element("h3", run.name, find("runs"));
        element("pre", run.summary, find("runs"));
        const list = element("dl", undefined, find("runs"));
        for (const [name, value] of run.origin) { element("dt", name, list); element("dd", value, list); }
        const details = element("details", undefined, find("runs"));
        element("summary", "scene", details);
        element("pre", run.scene, details);
    }
}

tell();
drawCharts();
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", drawCharts);
if (shaped.length) {
    shaped.forEach((run, index) => { element("option", run.name, find("shape-run")).value = index; });
    find("run-choice").hidden = shaped.length < 2;
    find("shape-run").addEventListener("change", chooseRun);
    find("field").addEventListener("change", () => { show(); stills(); });
    find("step").addEventListener("input", show);
    find("play").addEventListener("click", play);
    chooseRun();
} else {
    find("solid").hidden = find("meshes").hidden = true;
}
