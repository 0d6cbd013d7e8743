"use strict";
const { report, state, subjects } = JSON.parse(document.getElementById("data").textContent);
const $ = (id) => document.getElementById(id);

// An element; children that are strings become text, never markup.
function el(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else if (value !== null && value !== undefined && value !== false) node.setAttribute(name, value === true ? "" : value);
  }
  node.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return node;
}
const count = (n, one, many) => `${n.toLocaleString("en")} ${n === 1 ? one : many || one + "s"}`;
const percent = (share) => (share === 0 ? "0\u00a0%" : share < 0.001 ? "<\u00a00.1\u00a0%" : `${(100 * share).toFixed(1)}\u00a0%`);
const STATES = { agree: "agrees", differ: "differs", partial: "not run" };
const badge = (word, text) => el("span", { class: `badge ${word}` }, text || STATES[word]);
const KINDS = ["position", "normal", "curvature"];

// One row for each subject of each case.
const subjectById = new Map(report.subjects.map((subject) => [subject.id, subject]));
const outcomeState = (outcome) => (outcome.error ? "partial" : outcome.pairs.every((pair) => pair.agree) && !outcome.bits?.unlike ? "agree" : "differ");
const otherBits = ({ bits }) => (bits?.first ? [`other bits than the CPU rasterizer's: ${bits.first}`] : []);
const shares = (pairs) => KINDS.map((kind) => Math.max(0, ...pairs.map((pair) => pair[kind].max)));
const rows = [];
for (const entry of report.cases) {
  for (const outcome of entry.outcomes) {
    const pairs = outcome.pairs;
    const across = pairs.map((pair) => pair.across_px).filter((px) => px[0] !== null).sort((a, b) => b[0] - a[0])[0];
    rows.push({
      entry, outcome, ...entry.key, subject: outcome.subject, state: outcomeState(outcome),
      covered: pairs.length ? pairs[0].covered : 0,
      differing: pairs.reduce((sum, pair) => sum + pair.differing, 0),
      unbounded: Math.max(0, ...pairs.map((pair) => pair.unbounded)),
      undecided: entry.undecided, shares: shares(pairs), across: across ? across[0] : 0,
      reasons: outcome.error ? [outcome.error] : [...new Set([...pairs.flatMap((pair) => pair.reasons), ...otherBits(outcome)])],
    });
  }
}
const missing = new Map(subjects.map((subject) => [subject.id, subject.missing]));
for (const { id, missing } of subjects) {
  for (const name of missing) {
    const [scene, viewpoint, technique, scheme] = name.split("/");
    const entry = report.cases.find((entry) => ["scene", "viewpoint", "technique", "scheme"].every((part, i) => entry.key[part] === name.split("/")[i]));
    const why = (entry && entry.error) || subjectById.get(id).failure || "not there";
    rows.push({ entry: null, outcome: null, scene, viewpoint, technique, scheme, subject: id, state: "partial", covered: 0, differing: 0, unbounded: 0, undecided: 0, shares: [0, 0, 0], across: 0, reasons: [why] });
  }
}

// ---- heading ----
const started = report.sources.map((source) => new Date(1000 * source.started_unix).toISOString().replace("T", " ").slice(0, 16) + " UTC").sort();
const parts = report.sources.length > 1 ? `${report.sources.length} runs merged` : report.shard.count > 1 ? `shard ${report.shard.index} of ${report.shard.count}` : "whole suite";
$("facts").textContent = [`Suite ${report.suite}`, parts, `program ${report.program}`, started[0]].join(" · ");
const failing = rows.filter((row) => row.state === "differ").length;
const absent = rows.filter((row) => row.state === "partial").length;
const words = {
  agree: ["Everything agrees.", `${count(rows.length, "case")} on ${count(subjects.length, "renderer")}, and every pixel is within its bound.`],
  differ: ["Something differs.", `${count(failing, "case")} of ${rows.length.toLocaleString("en")} ${failing === 1 ? "does" : "do"} not agree.`],
  partial: ["Partial.", `${count(absent, "case")} could not run or ${absent === 1 ? "is" : "are"} missing; ${count(failing, "case")} of the rest ${failing === 1 ? "differs" : "differ"}.`],
}[state];
$("verdict").className = `verdict ${state}`;
$("verdict").append(el("p", {}, el("strong", {}, words[0]), words[1]));
for (const note of report.notes) $("notes").append(el("li", {}, note));
const theme = $("theme");
const isDark = () => (document.documentElement.dataset.theme || (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light")) === "dark";
const labelTheme = () => { theme.textContent = isDark() ? "Light" : "Dark"; theme.setAttribute("aria-pressed", isDark()); theme.setAttribute("aria-label", "Dark colours"); };
theme.addEventListener("click", () => { document.documentElement.dataset.theme = isDark() ? "light" : "dark"; labelTheme(); });
labelTheme();

// ---- renderers ----
function fact(name, value) { return el("div", {}, el("dt", {}, name), el("dd", {}, value)); }
for (const { id, state } of subjects) {
  const subject = subjectById.get(id);
  const own = rows.filter((row) => row.subject === id && row.outcome);
  const sum = (name) => own.reduce((total, row) => total + row[name], 0).toLocaleString("en");
  const most = [0, 1, 2].map((kind) => Math.max(0, ...own.map((row) => row.shares[kind])));
  $("subjects").append(el("article", { class: "card" },
    el("div", { class: "top" }, el("h3", {}, subject.name), badge(state, state === "partial" ? "partial" : null)),
    el("p", { class: "quiet" }, [subject.kind === "cpu" ? "reference in f32, deterministic" : subject.kind, subject.driver, subject.backend, subject.host].filter(Boolean).join(" · ")),
    subject.failure ? el("p", { class: "why" }, subject.failure) : null,
    own.length ? el("dl", { class: "facts" },
      fact("Cases agree", `${own.filter((row) => row.state === "agree").length} / ${own.length + missing.get(id).length}`),
      fact("Pixels", sum("covered")), fact("Differ", sum("differing")), fact("Unbounded", sum("unbounded")), fact("Undecided", sum("undecided")),
      fact("Position budget", percent(most[0])), fact("Normal budget", percent(most[1])), fact("Curvature budget", percent(most[2]))) : null));
}

// ---- histograms ----
// Bars over equal bins from 0 to 1; heights are logarithmic, so that one pixel in a million shows.
function histogram(title, bins, what) {
  const most = Math.max(1, ...bins);
  const height = (n) => (n ? Math.max(3, (64 * Math.log(1 + n)) / Math.log(1 + most)) : 0);
  const total = bins.reduce((a, b) => a + b, 0);
  const last = bins.reduce((at, n, i) => (n ? i + 1 : at), 0) / bins.length;
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", `0 0 ${bins.length * 10} 70`);
  svg.setAttribute("preserveAspectRatio", "none");
  svg.setAttribute("role", "img");
  svg.setAttribute("aria-label", `${title}: ${count(total, what)}, all up to ${percent(last)} of the budget`);
  const shape = (name, attributes, text) => {
    const node = document.createElementNS(svg.namespaceURI, name);
    for (const key in attributes) node.setAttribute(key, attributes[key]);
    if (text) { const label = document.createElementNS(svg.namespaceURI, "title"); label.textContent = text; node.append(label); }
    svg.append(node);
  };
  shape("line", { x1: 0, x2: bins.length * 10, y1: 69.5, y2: 69.5 });
  bins.forEach((n, i) => shape("rect", { x: 10 * i + 0.75, width: 8.5, y: 69 - height(n), height: height(n) }, `${percent(i / bins.length)} to ${percent((i + 1) / bins.length)}: ${count(n, what)}`));
  return el("div", { class: "histogram" }, el("h3", {}, title), svg, el("div", { class: "ends" }, el("span", {}, "0"), el("span", {}, "100 %")));
}
const BINS = 20;
// Counted pixels where the comparison counts them, else one entry a comparison: its largest share.
function budgetBins(pairs, kind) {
  const counted = pairs.filter((pair) => pair[kind].histogram.length);
  const bins = Array(counted.length ? counted[0][kind].histogram.length : BINS).fill(0);
  for (const pair of counted) pair[kind].histogram.forEach((n, i) => { bins[i] += n; });
  if (!counted.length) for (const pair of pairs) bins[Math.min(BINS - 1, Math.floor(pair[kind].max * BINS))] += 1;
  return [bins, counted.length ? "pixel" : "comparison"];
}
const allPairs = report.cases.flatMap((entry) => entry.outcomes.flatMap((outcome) => outcome.pairs));
const perPixel = allPairs.some((pair) => pair.position.histogram.length);
$("budget-lead").textContent = `The share of the allowed error that was used: ${perPixel ? "pixels" : "the largest share of each comparison"}, by share. Heights are logarithmic.`;
for (const { id } of subjects) {
  const pairs = rows.filter((row) => row.subject === id && row.outcome).flatMap((row) => row.outcome.pairs);
  if (!pairs.length) continue;
  $("budget").append(el("article", { class: "card" }, el("h3", {}, subjectById.get(id).name),
    el("div", { class: "histograms" }, KINDS.map((kind) => histogram(kind[0].toUpperCase() + kind.slice(1), ...budgetBins(pairs, kind))))));
}

// ---- sorting, for every table of this page ----
function sortable(table, columns, draw) {
  const head = el("tr");
  const headers = columns.map((column) => {
    const button = el("button", { type: "button" }, column.title);
    const header = el("th", { scope: "col", class: column.number ? "number" : null, "aria-sort": "none" }, button);
    button.addEventListener("click", () => {
      const down = header.getAttribute("aria-sort") === "none" ? !!column.number : header.getAttribute("aria-sort") === "ascending";
      headers.forEach((other) => other.setAttribute("aria-sort", "none"));
      header.setAttribute("aria-sort", down ? "descending" : "ascending");
      const order = (a, b) => { const [x, y] = [column.value(a), column.value(b)]; return typeof x === "number" ? x - y : String(x).localeCompare(String(y), "en", { numeric: true }); };
      draw((a, b) => (down ? order(b, a) : order(a, b)));
    });
    return header;
  });
  head.append(...headers);
  table.append(el("thead", {}, head), el("tbody"));
}

// ---- scenes ----
const RANK = { agree: 0, differ: 1, partial: 2 };
const matrix = report.scenes.map((scene) => {
  const cells = subjects.map(({ id }) => {
    const own = rows.filter((row) => row.scene === scene.name && row.subject === id);
    const worst = own.reduce((word, row) => (RANK[row.state] > RANK[word] ? row.state : word), "agree");
    return { id, own, worst, agree: own.filter((row) => row.state === "agree").length, share: Math.max(0, ...own.flatMap((row) => row.shares)) };
  });
  return { scene, cells };
}).filter((line) => line.cells.some((cell) => cell.own.length));
const severity = (cell) => RANK[cell.worst] * 1e6 + (cell.own.length - cell.agree) * 10 + cell.share;
function drawMatrix(order) {
  const body = $("matrix").tBodies[0];
  body.replaceChildren(...[...matrix].sort(order).map(({ scene, cells }) => el("tr", {},
    el("th", { scope: "row" }, scene.name, el("small", {}, scene.stresses)),
    cells.map((cell) => el("td", {}, cell.own.length ? el("button", {
      type: "button", class: cell.worst, "aria-label": `${scene.name} on ${subjectById.get(cell.id).name}: ${cell.agree} of ${cell.own.length} agree; list them`,
      onclick: () => { $("find").value = scene.name; $("subject").value = cell.id; $("state").value = ""; $("technique").value = ""; drawList(); $("cases").scrollIntoView(); },
    }, `${cell.agree} / ${cell.own.length}`, el("small", {}, percent(cell.share))) : "–")))));
}
sortable($("matrix"), [{ title: "Scene", value: (line) => line.scene.name },
  ...subjects.map(({ id }, i) => ({ title: subjectById.get(id).name, value: (line) => -severity(line.cells[i]) }))], drawMatrix);
drawMatrix((a, b) => Math.max(...b.cells.map(severity)) - Math.max(...a.cells.map(severity)));

// ---- one case ----
const NAMES = { raycast: "ray caster", raster: "CPU rasterizer", gpu: "GPU", foreign: "renderer under test" };
function viewer(row) {
  const cpu = row.entry.outcomes.find((outcome) => subjectById.get(outcome.subject).kind === "cpu");
  const pictures = { raycast: row.entry.picture, raster: cpu && cpu.picture };
  const own = subjectById.get(row.outcome.subject).kind === "foreign" ? "foreign" : "gpu";
  if (row.outcome !== cpu) pictures[own] = row.outcome.picture;
  const shown = Object.keys(pictures).filter((name) => pictures[name]);
  if (shown.length < 2) return null;
  const images = [0, 1].map(() => el("img", { alt: "" }));
  const tags = ["left", "right"].map((side) => el("span", { class: `tag ${side}` }));
  const edge = el("span", { class: "edge" });
  const box = el("div", { class: "swipe" }, images[1], images[0], edge, tags);
  const slide = el("input", { type: "range", class: "slide", min: 0, max: 100, value: 50, "aria-label": "Swipe between the two pictures" });
  const move = () => { images[0].style.clipPath = `inset(0 ${100 - slide.value}% 0 0)`; edge.style.left = `${slide.value}%`; };
  slide.addEventListener("input", move);
  const last = shown[shown.length - 1];
  const sides = [shown[0], last].map((first, i) => {
    const select = el("select", { "aria-label": `Picture on the ${i ? "right" : "left"}` }, shown.map((name) => el("option", { value: name, selected: name === first }, NAMES[name])));
    const show = () => { images[i].src = pictures[select.value]; images[i].alt = `Isophotes by the ${NAMES[select.value]}`; tags[i].textContent = NAMES[select.value]; };
    select.addEventListener("change", show);
    show();
    return select;
  });
  move();
  const [width, height] = row.entry.size;
  const marks = new Map();
  for (const pixel of row.outcome.pairs.flatMap((pair) => pair.worst)) {
    const mark = el("span", { class: "mark", style: `left:${(100 * (pixel.x + 0.5)) / width}%;top:${(100 * (pixel.y + 0.5)) / height}%` });
    marks.set(`${pixel.x},${pixel.y}`, mark);
    box.append(mark);
  }
  return { node: el("div", {}, box, slide, el("div", { class: "sides" }, sides)), marks };
}
const vector = (values) => (values ? values.map((x) => (x === null ? "not finite" : Number(x.toPrecision(9)))).join(", ") : "–");
function stages(pixel, pair) {
  const value = { face: (s) => s.face, "u, v": (s) => vector(s.uv), S: (s) => vector(s.position), normal: (s) => vector(s.normal), "k1, k2": (s) => vector(s.curvature), t: (s) => vector([s.t]) };
  const cell = (side, get) => el("td", {}, side ? String(get(side)) : "nothing");
  return el("table", { class: "stages" },
    el("thead", {}, el("tr", {}, el("th", {}, "stage"), el("th", {}, NAMES[pair.reference] || pair.reference), el("th", {}, NAMES[pair.candidate] || pair.candidate))),
    el("tbody", {}, Object.entries(value).map(([name, get]) => el("tr", {}, el("th", { scope: "row" }, name), cell(pixel.reference, get), cell(pixel.candidate, get)))));
}
function worst(row, marks) {
  const [model, ...options] = row.entry.options.split(" ");
  const list = row.outcome.pairs.flatMap((pair) => pair.worst.map((pixel) => ({ pixel, pair })));
  if (!list.length) return el("div", {}, el("h3", {}, "Pixels that differ"), el("p", { class: "quiet" }, "None."));
  const values = el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Values of the chosen pixel" });
  const command = el("code", { tabindex: 0 });
  const choose = ({ pixel, pair }, button) => {
    values.replaceChildren(stages(pixel, pair));
    command.textContent = `isophote pixel ${model} ${pixel.x},${pixel.y} ${options.join(" ")}`;
    for (const mark of marks.values()) mark.classList.remove("chosen");
    const mark = marks.get(`${pixel.x},${pixel.y}`);
    if (mark) mark.classList.add("chosen");
    for (const other of table.querySelectorAll("button")) other.setAttribute("aria-pressed", other === button);
  };
  const table = el("table", {}, el("thead", {}, el("tr", {}, ["pixel", "pair", "cause", "times over", "what"].map((title) => el("th", {}, title)))),
    el("tbody", {}, list.map((item) => {
      const button = el("button", { type: "button", "aria-pressed": false, onclick: () => choose(item, button) }, `${item.pixel.x}, ${item.pixel.y}`);
      return el("tr", {}, el("td", {}, button), el("td", {}, `${item.pair.reference} | ${item.pair.candidate}`), el("td", {}, item.pixel.cause), el("td", { class: "number" }, item.pixel.excess === null ? "∞" : item.pixel.excess.toPrecision(3)), el("td", {}, item.pixel.detail));
    })));
  choose(list[0], table.querySelector("button"));
  return el("div", { class: "stack" }, el("h3", {}, "Pixels that differ, worst first"), el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Pixels that differ" }, table), values, command);
}
const px = (value) => (value === null ? "none" : value.toFixed(4));
function detail(row) {
  const [model, ...options] = row.entry.options.split(" ");
  const view = viewer(row);
  const maps = row.outcome.pairs.filter((pair) => pair.difference).map((pair) => el("figure", {},
    el("figcaption", {}, `${NAMES[pair.reference] || pair.reference} | ${NAMES[pair.candidate] || pair.candidate}`),
    el("img", { src: pair.difference, alt: `Map of differences, ${pair.reference} against ${pair.candidate}` })));
  const pairs = el("table", {}, el("thead", {}, el("tr", {}, ["pair", "full / partial / none", "across px (bound there, largest)", "S", "n", "k", ""].map((title) => el("th", {}, title)))),
    el("tbody", {}, row.outcome.pairs.map((pair) => el("tr", {}, el("th", { scope: "row" }, `${pair.reference} | ${pair.candidate}`), el("td", {}, pair.coverage.join(" / ")),
      el("td", {}, pair.across_px[0] === null ? "–" : `${pair.across_px[0].toFixed(4)} (${px(pair.across_px[1])}, ${px(pair.greatest_bound_px)})`), KINDS.map((kind) => el("td", {}, percent(pair[kind].max))), el("td", {}, badge(pair.agree ? "agree" : "differ"))))));
  return el("div", { class: "panel" },
    el("div", { class: "stack" }, view ? view.node : el("p", { class: "quiet" }, "No pictures are kept of an agreeing case but for the first view of each scene."),
      maps.length ? el("div", { class: "maps" }, maps) : null),
    el("div", { class: "stack" },
      el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Comparisons" }, pairs),
      el("div", { class: "histograms" }, KINDS.map((kind) => histogram(`Budget: ${kind}`, ...budgetBins(row.outcome.pairs, kind)))),
      row.outcome.error ? el("p", { class: "why" }, row.outcome.error) : worst(row, view ? view.marks : new Map()),
      el("div", {}, el("h3", {}, "Again"), el("code", { tabindex: 0 }, `isophote compare ${model} ${options.join(" ")}`))));
}

// ---- the list of cases ----
for (const { id } of subjects) $("subject").append(el("option", { value: id }, subjectById.get(id).name));
for (const technique of new Set(report.planned.map((key) => key.technique))) $("technique").append(el("option", { value: technique }, technique));
let listOrder = (a, b) => RANK[b.state] - RANK[a.state] || Math.max(...b.shares) - Math.max(...a.shares);
const share = (row, kind) => el("td", { class: "number" }, row.outcome ? percent(row.shares[kind]) : "–");
function line(row) {
  const open = row.outcome ? el("button", { type: "button", class: "open", "aria-expanded": false }, row.scene) : el("span", {}, row.scene);
  const node = el("tr", { class: "case" },
    el("td", {}, open), el("td", {}, row.viewpoint), el("td", {}, row.technique, " ", el("small", {}, row.scheme)), el("td", {}, subjectById.get(row.subject).name),
    el("td", {}, badge(row.state), row.reasons.map((reason) => el("div", { class: "reason" }, reason))),
    el("td", { class: "number" }, row.covered.toLocaleString("en")), el("td", { class: "number" }, String(row.differing)), el("td", { class: "number" }, String(row.unbounded)),
    share(row, 0), share(row, 1), share(row, 2), el("td", { class: "number" }, row.outcome ? row.across.toFixed(4) : "–"));
  open.addEventListener("click", () => {
    const next = node.nextElementSibling;
    const isOpen = open.getAttribute("aria-expanded") === "true";
    open.setAttribute("aria-expanded", !isOpen);
    if (isOpen) next.remove();
    else node.after(el("tr", { class: "detail" }, el("td", { colspan: 12 }, detail(row))));
  });
  return node;
}
function drawList(order) {
  if (order) listOrder = order;
  const [words, verdict, subject, technique] = ["find", "state", "subject", "technique"].map((id) => $(id).value);
  const wanted = words.toLowerCase().split(/\s+/).filter(Boolean);
  const shown = rows.filter((row) => {
    const text = [row.scene, row.viewpoint, row.technique, row.scheme, ...row.reasons].join(" ").toLowerCase();
    return wanted.every((word) => text.includes(word)) && (!verdict || row.state === verdict || (verdict === "failing" && row.state !== "agree")) && (!subject || row.subject === subject) && (!technique || row.technique === technique);
  });
  $("list").tBodies[0].replaceChildren(...shown.sort(listOrder).map(line));
  $("count").textContent = `${shown.length.toLocaleString("en")} of ${count(rows.length, "case")}`;
}
sortable($("list"), [
  { title: "Scene", value: (row) => row.scene }, { title: "View", value: (row) => row.viewpoint }, { title: "Technique", value: (row) => `${row.technique} ${row.scheme}` },
  { title: "Renderer", value: (row) => subjectById.get(row.subject).name }, { title: "Verdict", value: (row) => RANK[row.state] },
  { title: "Pixels", number: true, value: (row) => row.covered }, { title: "Differ", number: true, value: (row) => row.differing }, { title: "No bound", number: true, value: (row) => row.unbounded },
  { title: "S", number: true, value: (row) => row.shares[0] }, { title: "n", number: true, value: (row) => row.shares[1] }, { title: "k", number: true, value: (row) => row.shares[2] },
  { title: "Across px", number: true, value: (row) => row.across },
], drawList);
for (const id of ["find", "state", "subject", "technique"]) $(id).addEventListener("input", () => drawList());
$("filters").addEventListener("submit", (event) => event.preventDefault());
$("filters").addEventListener("reset", () => setTimeout(drawList));
drawList();
