"use strict";
const { columns, varies, outputs, rows: all, logs, command } = JSON.parse(document.getElementById("data").textContent);
const find = (id) => document.getElementById(id);
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const at = (name) => columns.indexOf(name);
// References are listed in other tables; here they are no samples.
const rows = all.filter((row) => row[at("role")] === "task");
const isNumber = (value) => typeof value === "number" && Number.isFinite(value);
const figure = (value) => value === null || value === undefined ? "–" : isNumber(value) ? String(Number(value.toPrecision(6))) : typeof value === "string" ? value : JSON.stringify(value);
const element = (name, text, parent) => {
    const made = document.createElement(name);
    if (text !== undefined) made.textContent = text;
    if (parent) parent.appendChild(made);
    return made;
};
const MOST_POINTS = 4000, MOST_LINES = 2000, MOST_ROWS = 200, MOST_BINS = 40, MOST_LINKED = 24;
const numeric = [...varies, ...outputs].filter((name) => rows.some((row) => isNumber(row[at(name)])));
const theories = { peak_moment_n_mm: "theory_peak_n_mm", fold_moment_n_mm: "theory_fold_n_mm", stiffness_n_mm: "theory_stiffness_n_mm" };
// The colour map viridis, at eight places.
const viridis = [[68, 1, 84], [70, 50, 127], [54, 92, 141], [39, 127, 142], [31, 161, 135], [74, 194, 109], [159, 218, 58], [253, 231, 37]];
const coloured = (share) => {
    const place = Math.min(Math.max(share, 0), 1) * (viridis.length - 1), low = Math.min(Math.floor(place), viridis.length - 2);
    return `rgb(${viridis[low].map((from, k) => Math.round(from + (place - low) * (viridis[low + 1][k] - from))).join(",")})`;
};
// Of many, every so-manyth: the choice is the same each time.
const thinned = (list, most) => list.length <= most ? list : list.filter((_, index) => Math.floor(index * most / list.length) !== Math.floor((index - 1) * most / list.length));
const range = (list, name) => {
    let [least, most] = [Infinity, -Infinity];
    for (const row of list) if (isNumber(row[at(name)])) [least, most] = [Math.min(least, row[at(name)]), Math.max(most, row[at(name)])];
    return [least, most];
};
const share = (value, [least, most]) => most > least ? (value - least) / (most - least) : 0.5;

// What is chosen on the axes of the parallel coordinates: shares of the range by name.
const brushes = new Map();
const ranges = new Map(numeric.map((name) => [name, range(rows, name)]));
const chosen = () => rows.filter((row) => [...brushes].every(([name, [low, high]]) => {
    const value = row[at(name)];
    return isNumber(value) && share(value, ranges.get(name)) >= low && share(value, ranges.get(name)) <= high;
}));

function options(id, names, first, none) {
    const select = find(id);
    if (none) element("option", none, select).value = "";
    for (const name of names) element("option", name, select).value = name;
    select.value = first ?? (none ? "" : names[0] ?? "");
    select.addEventListener("change", () => { if (id === "y") find("theory").value = outputs.includes(theories[select.value]) ? theories[select.value] : ""; draw(); });
}
const moving = varies.filter((name) => numeric.includes(name) && ranges.get(name)[0] < ranges.get(name)[1]);
const results = outputs.filter((name) => numeric.includes(name));
options("x", numeric, moving[0]);
options("y", results.length ? results : numeric);
options("theory", results, outputs.includes(theories[results[0]]) ? theories[results[0]] : "", "nothing");
options("hue", numeric, moving[1] ?? "", "nothing");
options("across", numeric, moving[0]);
options("up", numeric, moving[1] ?? moving[0]);

const charts = [];
const axis = (text) => ({ title: { display: true, text, color: css("--ink") }, ticks: { color: css("--soft") }, grid: { color: css("--line") } });
const told = (row) => [`task ${row[at("number")]}: ${row[at("ending")]}`, ...varies.map((name) => `${name} ${figure(row[at(name)])}`), ...outputs.map((name) => `${name} ${figure(row[at(name)])}`)];
const opened = (row) => {
    const log = row[at("log")];
    if (log) window.open(logs + encodeURIComponent(log), "_blank");
};
function chart(id, config) {
    charts.push(new Chart(find(id), { ...config, options: { animation: false, maintainAspectRatio: false, ...config.options } }));
}
function scatter(id, sets, x, y) {
    chart(id, { type: "scatter", data: { datasets: sets }, options: {
        parsing: false, normalized: true, scales: { x: axis(x), y: axis(y) },
        onClick: (_, hits, made) => hits[0] && opened(made.data.datasets[hits[0].datasetIndex].data[hits[0].index].row),
        plugins: { legend: { display: sets.length > 1 && sets.length <= 8, labels: { color: css("--ink"), usePointStyle: true } },
            tooltip: { callbacks: { label: (item) => told(item.raw.row) } } },
    } });
}
function response(list) {
    const [x, y, theory, hue] = ["x", "y", "theory", "hue"].map((id) => find(id).value);
    const whole = list.filter((row) => isNumber(row[at(x)]) && isNumber(row[at(y)]));
    const some = thinned(whole, MOST_POINTS);
    find("drawn").textContent = `${some.length < whole.length ? `${some.length} of ${whole.length} tasks are drawn, evenly chosen. ` : ""}A click on a point opens its log's file; its page: ${command}`;
    const colour = (row) => hue && isNumber(row[at(hue)]) ? coloured(share(row[at(hue)], ranges.get(hue))) : css("--accent");
    const points = (name) => some.filter((row) => isNumber(row[at(name)])).map((row) => ({ x: row[at(x)], y: row[at(name)], row })).sort((a, b) => a.x - b.x);
    // Where all else stands still along the axis, points make curves.
    const others = varies.filter((name) => name !== x);
    const curves = new Map();
    for (const point of points(y)) {
        const key = JSON.stringify(others.map((name) => point.row[at(name)]));
        curves.set(key, [...(curves.get(key) ?? []), point]);
    }
    const linked = varies.includes(x) && curves.size <= MOST_LINKED && curves.size < some.length;
    const label = (data) => others.length ? others.map((name) => `${name.split(".").pop()} ${figure(data[0].row[at(name)])}`).join(", ") : y;
    const sets = linked ? [...curves.values()].map((data) => ({ label: label(data), data, showLine: true, borderWidth: 1.5, borderColor: colour(data[0].row), backgroundColor: colour(data[0].row), pointRadius: 3 }))
        : [{ label: y, data: points(y), backgroundColor: points(y).map((point) => colour(point.row)), pointRadius: some.length > 500 ? 2 : 4 }];
    if (theory) {
        const drawn = linked ? [...curves.values()].map((curve) => curve.map(({ x, row }) => ({ x, y: row[at(theory)], row })).filter((point) => isNumber(point.y))) : [points(theory)];
        for (const data of drawn.filter((data) => data.length)) sets.push({ label: theory, data, showLine: linked, borderWidth: 1, borderDash: [5, 4], borderColor: linked ? colour(data[0].row) : css("--soft"), backgroundColor: "transparent", pointStyle: "triangle", pointRadius: 4 });
    }
    scatter("response", sets, x, theory ? `${y}; triangles: ${theory}` : y);
}
function surface(list) {
    const [x, y, z] = ["across", "up", "y"].map((id) => find(id).value);
    const some = thinned(list.filter((row) => [x, y, z].every((name) => isNumber(row[at(name)]))), MOST_POINTS);
    const [least, most] = range(some, z);
    find("ramp").style.background = `linear-gradient(to right, ${viridis.map((colour) => `rgb(${colour.join(",")})`).join(", ")})`;
    [find("least").textContent, find("most").textContent] = some.length ? [figure(least), `${figure(most)}  ${z}`] : ["", "nothing to show"];
    some.sort((a, b) => a[at(x)] - b[at(x)]);
    const data = some.map((row) => ({ x: row[at(x)], y: row[at(y)], row }));
    const radius = some.length > 500 ? 3 : some.length > 60 ? 6 : 10;
    scatter("surface", [{ label: z, data, pointStyle: "rect", clip: false, backgroundColor: some.map((row) => coloured(share(row[at(z)], [least, most]))), pointRadius: radius, borderWidth: 0 }], x, y);
}
function distribution(list) {
    const name = find("y").value;
    const values = list.map((row) => row[at(name)]).filter(isNumber).sort((a, b) => a - b);
    if (!values.length) {
        find("spread").textContent = `no task has ${name}`;
        return;
    }
    const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
    const deviation = Math.sqrt(values.reduce((sum, value) => sum + (value - mean) ** 2, 0) / Math.max(values.length - 1, 1));
    const quantile = (part) => { const place = part * (values.length - 1), low = Math.floor(place); return values[low] + (place - low) * ((values[low + 1] ?? values[low]) - values[low]); };
    find("spread").textContent = `${name} of ${values.length}: mean ${figure(mean)}, standard deviation ${figure(deviation)}; 5 % below ${figure(quantile(0.05))}, 5 % above ${figure(quantile(0.95))}`;
    const bins = Math.min(MOST_BINS, Math.max(1, Math.ceil(Math.sqrt(values.length)))), [least, most] = [values[0], values[values.length - 1]];
    const counts = new Array(most > least ? bins : 1).fill(0);
    for (const value of values) counts[Math.min(Math.floor(share(value, [least, most]) * counts.length), counts.length - 1)] += 1;
    const middle = (bin) => Number((least + (bin + 0.5) * (most - least) / counts.length).toPrecision(4));
    chart("distribution", { type: "bar", data: { labels: counts.map((_, bin) => middle(bin)), datasets: [{ data: counts, backgroundColor: css("--accent"), categoryPercentage: 1, barPercentage: 0.95 }] },
        options: { scales: { x: axis(name), y: { ...axis("tasks"), ticks: { color: css("--soft"), precision: 0 } } }, plugins: { legend: { display: false } } } });
}

const shownAxes = numeric.filter((name) => ranges.get(name)[0] < ranges.get(name)[1]).slice(0, 12);
let drag = null;
const places = (canvas) => {
    const [wide, high] = [canvas.clientWidth, canvas.clientHeight], step = wide / Math.max(shownAxes.length, 1);
    return { wide, high, top: 46, bottom: high - 22, of: (index) => (index + 0.5) * step, step };
};
function parallel(list) {
    const canvas = find("parallel"), ratio = window.devicePixelRatio || 1;
    canvas.style.width = canvas.style.height = "100%";
    [canvas.width, canvas.height] = [canvas.clientWidth * ratio, canvas.clientHeight * ratio];
    const pen = canvas.getContext("2d"), place = places(canvas), hue = find("y").value;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, place.wide, place.high);
    const height = (name, value) => place.bottom - share(value, ranges.get(name)) * (place.bottom - place.top);
    pen.lineWidth = 1;
    const some = thinned(list, MOST_LINES);
    pen.globalAlpha = some.length > 300 ? 0.35 : 0.8;
    for (const row of some) {
        pen.strokeStyle = isNumber(row[at(hue)]) ? coloured(share(row[at(hue)], ranges.get(hue))) : css("--soft");
        pen.beginPath();
        let begun = false;
        shownAxes.forEach((name, index) => {
            const value = row[at(name)];
            if (!isNumber(value)) { begun = false; return; }
            pen[begun ? "lineTo" : "moveTo"](place.of(index), height(name, value));
            begun = true;
        });
        pen.stroke();
    }
    pen.globalAlpha = 1;
    pen.textAlign = "center";
    shownAxes.forEach((name, index) => {
        const x = place.of(index), [least, most] = ranges.get(name);
        pen.strokeStyle = css("--ink");
        pen.beginPath(); pen.moveTo(x, place.top); pen.lineTo(x, place.bottom); pen.stroke();
        pen.fillStyle = css("--ink");
        pen.font = "11px system-ui, sans-serif";
        // Names in two rows, so that neighbours do not meet; cut to the room there is.
        const fits = (text) => { while (text.length > 4 && pen.measureText(text).width > 2 * place.step - 8) text = `${text.slice(0, -2)}…`; return text; };
        pen.fillText(fits(name.split(".").pop()), Math.min(Math.max(x, 40), place.wide - 40), index % 2 ? 26 : 12);
        pen.fillStyle = css("--soft");
        pen.fillText(figure(Number(most.toPrecision(4))), x, place.top - 4);
        pen.fillText(figure(Number(least.toPrecision(4))), x, place.bottom + 14);
        const brush = brushes.get(name);
        if (brush) {
            const [low, high] = brush.map((part) => place.bottom - part * (place.bottom - place.top));
            pen.fillStyle = "rgba(49, 104, 142, 0.35)";
            pen.fillRect(x - 7, high, 14, low - high);
        }
    });
}
function pointed(event) {
    const canvas = find("parallel"), box = canvas.getBoundingClientRect(), place = places(canvas);
    const index = Math.min(Math.max(Math.floor((event.clientX - box.left) / place.step), 0), shownAxes.length - 1);
    const part = (place.bottom - (event.clientY - box.top)) / (place.bottom - place.top);
    return { name: shownAxes[index], part: Math.min(Math.max(part, 0), 1) };
}
find("parallel").addEventListener("pointerdown", (event) => { drag = shownAxes.length ? pointed(event) : null; });
window.addEventListener("pointerup", (event) => {
    if (!drag) return;
    const end = pointed(event).part, [low, high] = [Math.min(drag.part, end), Math.max(drag.part, end)];
    if (high - low < 0.02) brushes.delete(drag.name); else brushes.set(drag.name, [low, high]);
    drag = null;
    draw();
});

let order = { column: at("number"), down: false };
function listed(list) {
    const table = find("tasks");
    table.replaceChildren();
    const shown = ["number", "ending", ...varies, ...outputs, "load_steps", "unknowns", "wall_s", "log", "reason"].filter((name) => at(name) >= 0);
    const head = element("tr", undefined, table);
    for (const name of shown) {
        const cell = element("th", at(name) === order.column ? `${name} ${order.down ? "▼" : "▲"}` : name, head);
        cell.style.cursor = "pointer";
        cell.addEventListener("click", () => { order = { column: at(name), down: order.column === at(name) && !order.down }; draw(); });
    }
    const by = (a, b) => a === b ? 0 : a === null ? 1 : b === null ? -1 : a < b ? -1 : 1;
    const sorted = [...list].sort((a, b) => (order.down && a[order.column] !== null && b[order.column] !== null ? -1 : 1) * by(a[order.column], b[order.column])).slice(0, MOST_ROWS);
    for (const row of sorted) {
        const line = element("tr", undefined, table);
        for (const name of shown) {
            const cell = element("td", undefined, line), log = row[at("log")];
            if (name === "number" && log) {
                const link = element("a", row[at("number")], cell);
                link.href = logs + encodeURIComponent(log);
            } else cell.textContent = name === "reason" ? (row[at(name)] ?? "").slice(0, 200) : figure(row[at(name)]);
        }
    }
    find("listed").textContent = `${sorted.length} of ${list.length} chosen of ${rows.length}; a number is the link to its log.`;
}
function draw() {
    charts.splice(0).forEach((made) => made.destroy());
    const list = chosen();
    response(list);
    surface(list);
    distribution(list);
    parallel(list);
    listed(list);
}
const endings = new Map();
for (const row of rows) endings.set(row[at("ending")], (endings.get(row[at("ending")]) ?? 0) + 1);
const references = all.length - rows.length;
find("lead").textContent = `${rows.length} tasks: ${[...endings].map(([word, count]) => `${count} ${word}`).join(", ")}${references ? `; ${references} references` : ""}`;
draw();
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
window.addEventListener("resize", () => parallel(chosen()));
