"use strict";
const rows = JSON.parse(document.getElementById("data").textContent);
const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const hues = ["#31688e", "#8a8a8a", "#35b779", "#b73779", "#d97a1c", "#7e57c2", "#8d6e63", "#0097a7"];
const percent = (error) => error === null || error === undefined ? "" : `${Number((100 * error).toPrecision(3))} %`;
const element = (name, text, parent) => {
    const made = document.createElement(name);
    if (text !== undefined) made.textContent = text;
    if (parent) parent.appendChild(made);
    return made;
};
// The error on the side of the snap where it is larger; none below that of the reference itself.
const worst = (row, own) => {
    const sides = [row.error_before, row.error_after].map((error, side) => error === null ? null : Math.max(error, own[side] ?? 0));
    const known = sides.filter((error) => error !== null);
    return known.length ? Math.max(...known) : null;
};
const charts = [];
const structures = [...new Set(rows.map((row) => row.structure))];

function drawn(name, canvas) {
    const own = rows.find((row) => row.structure === name && row.error_of_reference)?.error_of_reference ?? [null, null];
    const runs = rows.filter((row) => row.structure === name && row.row && (row.role === "uniform" || row.role === "adaptive"));
    const points = runs.map((run) => ({
        x: run.row.wall_s, y: 100 * Math.max(worst(run.row, own) ?? NaN, 1e-8), run,
        note: `${run.run}, ${run.row.elements.join(" × ")} elements: ${percent(worst(run.row, own))}, ${run.row.wall_s.toPrecision(3)} s`,
    })).filter((point) => Number.isFinite(point.y));
    const families = new Map();
    for (const point of points) {
        const key = point.run.role === "adaptive" ? point.run.run : `${point.run.run}, ${point.run.row.elements[1]} across`;
        families.set(key, [...(families.get(key) ?? []), point]);
    }
    let best = Infinity;
    const front = [...points].sort((a, b) => a.x - b.x).filter((point) => point.y < best && ((best = point.y), true));
    const sets = [...families].map(([label, data], index) => ({
        label, data: data.sort((a, b) => a.x - b.x), showLine: data.length > 1, borderColor: hues[index % hues.length], backgroundColor: hues[index % hues.length],
        pointStyle: data[0].run.role === "adaptive" ? "rectRot" : "circle", pointRadius: data[0].run.role === "adaptive" && families.size <= 14 ? 8 : 4, borderWidth: 1.5,
    }));
    sets.push({ label: "best for its time", data: front, showLine: true, borderColor: css("--soft"), borderDash: [4, 4], pointRadius: 0, borderWidth: 1.5 });
    // Round numbers, as many digits as they need.
    const tick = (value) => [1, 2, 5].some((digit) => value.toExponential(0).startsWith(`${digit}e`)) ? String(Number(value.toPrecision(2))) : "";
    const axis = (text) => ({ type: "logarithmic", title: { display: true, text, color: css("--ink") }, ticks: { color: css("--soft"), callback: tick }, grid: { color: css("--line") } });
    // Names that are too many for a legend stand in the table, and beside the point that is touched.
    const legend = { display: sets.length <= 14, labels: { color: css("--ink"), usePointStyle: true } };
    charts.push(new Chart(canvas, {
        type: "scatter", data: { datasets: sets },
        options: {
            animation: false, maintainAspectRatio: false, parsing: false,
            scales: { x: axis("wall time (s)"), y: axis("error (%)") },
            plugins: { legend, tooltip: { callbacks: { label: (item) => item.raw.note } } },
        },
    }));
}

function table(name, parent) {
    const holder = element("div", undefined, parent);
    holder.style.overflowX = "auto";
    const made = element("table", undefined, holder), head = element("tr", undefined, made);
    for (const title of ["run", "mesh", "unknowns", "before", "snap", "behind", "steps", "iterations", "wall s"]) element("th", title, head);
    const own = rows.find((row) => row.structure === name && row.error_of_reference)?.error_of_reference ?? [null, null];
    // None is known better than the reference.
    const known = (error, side) => error !== null && error !== undefined && error < (own[side] ?? 0) ? `< ${percent(own[side])}` : percent(error);
    for (const { run, role, row, error } of rows.filter((row) => row.structure === name && (row.row || row.error))) {
        const line = element("tr", undefined, made);
        const cells = error ? [run, error] : [run, row.elements.join(" × "), row.unknowns, role === "reference" ? "" : known(row.error_before, 0), row.jump_at?.toFixed(3) ?? "",
            role === "reference" ? "" : known(row.error_after, 1), row.steps, row.iterations, role === "uniform" || role === "adaptive" ? row.wall_s.toFixed(2) : ""];
        for (const cell of cells) element("td", cell, line);
    }
    const speeds = rows.filter((row) => row.structure === name && Object.keys(row.speed_up ?? {}).length);
    if (!speeds.length) return;
    const of = element("table", undefined, holder), first = element("tr", undefined, of), columns = Object.keys(speeds[0].speed_up);
    for (const title of ["speed-up over uniform", ...columns, "published"]) element("th", title, first);
    const ratio = (found) => !found ? "" : found.at_most === null ? `> ${found.at_least.toFixed(1)}` : found.at_least === found.at_most ? found.at_least.toFixed(1) : `${found.at_least.toFixed(1)} to ${found.at_most.toFixed(1)}`;
    for (const { run, speed_up, published } of speeds) {
        const line = element("tr", undefined, of);
        for (const cell of [run, ...columns.map((column) => ratio(speed_up[column])), published?.toFixed(1) ?? ""]) element("td", cell, line);
    }
}

const main = document.getElementById("structures");
const canvases = structures.map((name) => {
    const section = element("section", undefined, main);
    element("h2", name, section);
    const holder = element("div", undefined, section);
    holder.className = "chart";
    const canvas = element("canvas", undefined, holder);
    table(name, section);
    return canvas;
});
function draw() {
    charts.splice(0).forEach((chart) => chart.destroy());
    structures.forEach((name, index) => drawn(name, canvases[index]));
}
draw();
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
