// Shared by the pages of runs and sweeps: parts of the page, readable numbers, charts.
"use strict";

const kColours = ["#2f6db5", "#d1782b", "#3a923a", "#a23b72", "#7a5fb5", "#8c6d46", "#c2467d", "#6b6b6b", "#9aa320", "#25a1a8"];
const charts = [];

// Records an error in an attribute of the page, for those who do not see the console.
window.addEventListener("error", (event) => { document.body.dataset.error = event.message; });

/// The charts need the page's font by name, because they measure text themselves.
function chartBase() {
  return { animation: false, color: kColours, textStyle: { fontFamily: getComputedStyle(document.body).fontFamily } };
}

function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

/// Adds a section to the page and returns the element for its content.
function addSection(title, explanation, wide = false) {
  const section = element("section", wide ? { class: "wide" } : {}, element("h2", {}, title));
  if (explanation) section.append(element("p", {}, explanation));
  document.getElementById("page").append(section);
  return section;
}

/// 1234567 -> "1.235 M"
function forPeople(value, unit = "") {
  if (typeof value !== "number" || !isFinite(value)) return String(value);
  const size = Math.abs(value);
  const [scale, prefix] = size >= 1e12 ? [1e12, "T"] : size >= 1e9 ? [1e9, "G"] : size >= 1e6 ? [1e6, "M"]
    : size >= 1e4 ? [1e3, "k"] : size >= 0.01 || size === 0 ? [1, ""] : size >= 1e-3 ? [1e-3, "m"]
    : size >= 1e-6 ? [1e-6, "µ"] : size >= 1e-9 ? [1e-9, "n"] : [1, ""];
  const scaled = value / scale;
  const digits = Number.isInteger(scaled) ? String(scaled) : Number(scaled.toPrecision(4)).toString();
  return prefix + unit ? `${digits} ${prefix}${unit}` : digits;
}

function percent(share) {
  return `${(100 * share).toFixed(share < 0.1 ? 2 : 1)} %`;
}

function addChart(section, option) {
  const place = element("div", { class: "chart" });
  section.append(place);
  const chart = echarts.init(place, null, { renderer: "svg" });
  chart.setOption({ ...chartBase(), ...option });
  charts.push(chart);
  return chart;
}

/// Horizontal bars for rows of [label, value], the longest on top; if there are too many, the shortest are
/// joined into one. `label` formats a value.
function addBars(section, rows, label) {
  const kMost = 14;
  const falling = rows.filter((row) => row[1] > 0).sort((a, b) => b[1] - a[1]);
  const rest = falling.length > kMost ? falling.splice(kMost - 1) : [];
  if (rest.length) falling.push([`${rest.length} others`, rest.reduce((sum, row) => sum + row[1], 0)]);
  const sorted = falling.reverse();
  const chart = addChart(section, {
    grid: { left: 24, right: 100, top: 8, bottom: 8, containLabel: true },
    tooltip: { trigger: "item", formatter: (item) => `${item.name}: ${label(item.value)}` },
    xAxis: { type: "value", axisLabel: { formatter: (value) => forPeople(value), hideOverlap: true } },
    yAxis: { type: "category", data: sorted.map((row) => row[0]), axisLabel: { width: 190, overflow: "truncate" } },
    series: [{ type: "bar", data: sorted.map((row) => row[1]), barMaxWidth: 26,
               label: { show: true, position: "right", formatter: (item) => label(item.value) } }],
  });
  chart.getDom().style.height = `${Math.max(160, 60 + 30 * sorted.length)}px`;
  chart.resize();
}

/// A table. Cells hold numbers, except in the first column and where a cell is { text }.
function addTable(section, head, rows) {
  const cell = (value) => typeof value === "object" && value !== null
    ? element("td", { class: value.class || "text" }, value.text)
    : element("td", {}, typeof value === "number" ? forPeople(value) : String(value ?? ""));
  section.append(element("div", { class: "scroll" }, element("table", {},
    element("thead", {}, element("tr", {}, ...head.map((name, i) => element("th", rows.length && typeof rows[0][i] === "object" ? { class: "text" } : {}, name)))),
    element("tbody", {}, ...rows.map((row) => element("tr", {}, ...row.map(cell)))))));
}

function addFigures(figures) {
  const list = element("div", { class: "figures" });
  for (const [value, meaning] of figures)
    list.append(element("div", {}, element("b", {}, value), element("span", {}, meaning)));
  addSection("In short", "", true).append(list);
}

function addSelect(controls, title, choices, chosen, changed) {
  const select = element("select", { "aria-label": title });
  for (const [value, text] of choices) select.append(element("option", { value }, text));
  select.value = chosen;
  select.addEventListener("change", () => changed(select.value));
  controls.append(element("label", {}, title, select));
  return select;
}

function showPage() {
  const data = JSON.parse(document.getElementById("data").textContent);
  document.getElementById("title").textContent = data.title;
  if (data.sweep) showSweep(data.sweep); else showRun(data.run, data.image);
  window.addEventListener("resize", () => charts.forEach((chart) => chart.resize()));
  document.body.dataset.charts = charts.length;
}
