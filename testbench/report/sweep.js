// The page of a sweep: results over its axes, the Pareto front, all points.
"use strict";

const kHeadline = ["rays_per_second", "segments_per_second", "work.per_second", "simulated_seconds", "chip.pe_utilisation", "chip.exposed_pio_share",
                   "pio_utilisation", "ddr_utilisation", "chip.ddr_bytes_per_second", "ddr_bytes_per_ray", "rays_per_joule", "work.per_joule"];
/// The results that count as costs of a ray, the most informative first.
const kCosts = ["chip.energy.joules", "chip.energy.watts", "total_sram_bytes", "chip.ddr_bytes_per_second", "ddr_bytes_per_ray", "pio_bytes_per_ray"];
const kMostSeries = 12;

/// What a point achieves a second: rays, or the work of a firmware outside the tree.
function gainOf(points) {
  return "rays_per_second" in points[0].results ? { key: "rays_per_second", title: "rays/s" } : { key: "work.per_second", title: "work/s" };
}

function unique(values) {
  return [...new Set(values)];
}

function isNumeric(values) {
  return values.every((value) => typeof value === "number");
}

/// The type of axis for values: logarithmic if they span more than a decade, so that equal ratios look equal.
function scaleOf(values) {
  if (!isNumeric(values)) return "category";
  return Math.min(...values) > 0 && Math.max(...values) / Math.min(...values) > 10 ? "log" : "value";
}

function describe(inputs, keys) {
  return keys.map((key) => `${key} = ${inputs[key]}`).join(", ");
}

class AxisPlot {
  constructor(sweep, points, names) {
    this.sweep = sweep;
    this.points = points;
    this.names = names;
    const numeric = sweep.axes.filter((axis) => isNumeric(this.valuesOf(axis[0])));
    const longest = (axes) => axes.reduce((a, b) => (this.valuesOf(b[0]).length > this.valuesOf(a[0]).length ? b : a));
    this.x = longest(numeric.length ? numeric : sweep.axes)[0];
    this.series = (sweep.axes.find((axis) => !axis.includes(this.x)) || [""])[0];
    this.y = kHeadline.find((name) => names.includes(name)) || names[0];
    this.filters = {};
    this.section = addSection("Over the axes", "Points that share all other values are joined", true);
    this.controls = element("div", { class: "controls" });
    this.section.append(this.controls);
    this.chart = addChart(this.section, {});
    this.show();
  }

  valuesOf(key) {
    return unique(this.sweep.points.map((point) => point.inputs[key]));
  }
  axisOf(key) {
    return this.sweep.axes.find((axis) => axis.includes(key)) || [];
  }

  showControls() {
    this.controls.replaceChildren();
    const again = (change) => (value) => { change(value); this.show(); };
    addSelect(this.controls, "result", this.names.map((name) => [name, name]), this.y, again((value) => { this.y = value; }));
    addSelect(this.controls, "along", this.sweep.keys.map((key) => [key, key]), this.x, again((value) => {
      this.x = value;
      if (this.axisOf(value).includes(this.series))
        this.series = (this.sweep.axes.find((axis) => !axis.includes(value)) || [""])[0];
    }));
    const others = this.sweep.axes.filter((axis) => !axis.includes(this.x));
    if (others.length)
      addSelect(this.controls, "a line for each", others.map((axis) => [axis[0], axis.join(", ")]), this.series,
                again((value) => { this.series = value; }));
    for (const axis of others.filter((other) => !other.includes(this.series))) {
      const values = this.valuesOf(axis[0]);
      if (!values.includes(this.filters[axis[0]])) this.filters[axis[0]] = values[0];
      addSelect(this.controls, axis[0], values.map((value, i) => [i, String(value)]), values.indexOf(this.filters[axis[0]]),
                again((value) => { this.filters[axis[0]] = values[value]; }));
    }
  }

  show() {
    this.showControls();
    const fixed = this.sweep.axes.map((axis) => axis[0]).filter((key) => !this.axisOf(this.x).includes(key) && key !== this.series);
    const chosen = this.points.filter((point) => fixed.every((key) => point.inputs[key] === this.filters[key]));
    const values = this.valuesOf(this.x);
    const scale = scaleOf(values);
    const place = (point) => (scale === "category" ? String(point.inputs[this.x]) : point.inputs[this.x]);
    const lines = this.series ? this.valuesOf(this.series) : [undefined];
    const series = lines.slice(0, kMostSeries).map((value) => ({
      name: this.series ? `${this.series} = ${value}` : this.y,
      type: "line", symbolSize: 7,
      data: chosen.filter((point) => !this.series || point.inputs[this.series] === value).map((point) => [place(point), point.results[this.y]]),
    }));
    this.chart.setOption({
      ...chartBase(),
      grid: { left: 8, right: 24, top: 60, bottom: 34, containLabel: true },
      legend: { top: 0, type: "scroll" },
      tooltip: { trigger: "item", formatter: (item) => `${item.seriesName}<br>${this.x} = ${item.value[0]}<br>${this.y} = ${forPeople(item.value[1])}` },
      xAxis: { type: scale, name: this.x, nameLocation: "middle", nameGap: 28, scale: true, axisLabel: { formatter: String },
               ...(scale === "log" ? { logBase: 2, min: Math.min(...values), max: Math.max(...values) } : {}),
               ...(scale === "category" ? { data: values.map(String) } : {}) },
      yAxis: { type: "value", name: this.y, nameTextStyle: { align: "left" }, scale: false,
               axisLabel: { formatter: (value) => forPeople(value) } },
      series,
    }, true);
  }
}

/// The Pareto front: the points for which no other has both less cost and more gain.
function paretoFront(points, cost, gain) {
  const sorted = [...points].sort((a, b) => cost(a) - cost(b) || gain(b) - gain(a));
  let best = -Infinity;
  return sorted.filter((point) => (gain(point) > best ? ((best = gain(point)), true) : false));
}

class ParetoPlot {
  constructor(sweep, points, costs) {
    this.sweep = sweep;
    this.points = points;
    this.costs = costs;
    this.gain = gainOf(points);
    this.cost = Object.keys(costs)[0];
    this.section = addSection("Pareto front", "What is done a second against what it costs; on the line are the points that no other beats in both", true);
    this.controls = element("div", { class: "controls" });
    this.section.append(this.controls);
    addSelect(this.controls, "cost", Object.keys(costs).map((name) => [name, name]), this.cost, (value) => { this.cost = value; this.show(); });
    this.chart = addChart(this.section, {});
    this.table = element("div");
    this.section.append(this.table);
    this.show();
  }

  show() {
    const cost = this.costs[this.cost];
    const title = this.gain.title;
    const gain = (point) => point.results[this.gain.key];
    const front = paretoFront(this.points, cost, gain);
    const dot = (point) => ({ value: [cost(point), gain(point)], name: describe(point.inputs, this.sweep.keys) });
    const scale = (values) => (scaleOf(values) === "log" ? "log" : "value");
    this.chart.setOption({
      ...chartBase(),
      grid: { left: 8, right: 24, top: 60, bottom: 34, containLabel: true },
      legend: { top: 0 },
      tooltip: { trigger: "item", formatter: (item) => `${item.name}<br>${this.cost} = ${forPeople(item.value[0])}<br>${title} = ${forPeople(item.value[1])}` },
      xAxis: { type: scale(this.points.map(cost)), name: this.cost, nameLocation: "middle", nameGap: 28, scale: true, axisLabel: { formatter: (value) => forPeople(value), hideOverlap: true } },
      yAxis: { type: scale(this.points.map(gain)), name: title, scale: true, axisLabel: { formatter: (value) => forPeople(value) } },
      series: [{ name: "all points", type: "scatter", symbolSize: 8, itemStyle: { opacity: 0.45 }, data: this.points.map(dot) },
               { name: "Pareto front", type: "line", step: "end", symbolSize: 9, data: front.map(dot) }],
    }, true);
    this.table.replaceChildren();
    addTable(this.table, [...this.sweep.keys, this.cost, title],
             front.map((point) => [...this.sweep.keys.map((key) => ({ text: String(point.inputs[key]) })), cost(point), gain(point)]));
  }
}

/// The costs that all points have and that differ between points.
function costsOf(points) {
  const costs = {};
  for (const name of kCosts) {
    const cost = (point) => point.results[name];
    const values = points.map(cost);
    if (isNumeric(values) && values.every(isFinite) && unique(values).length > 1) costs[name] = cost;
  }
  return costs;
}

function showPoints(sweep, names) {
  const columns = kHeadline.filter((name) => names.includes(name)).slice(0, 6);
  const section = addSection("All points", "", true);
  addTable(section, [...sweep.keys, ...columns, "status"], sweep.points.map((point) => [
    ...sweep.keys.map((key) => ({ text: String(point.inputs[key]) })),
    ...columns.map((name) => (point.results ? point.results[name] : "")),
    point.error ? { text: point.error, class: "error" } : { text: point.status }]));
}

function showSweep(sweep) {
  const points = sweep.points.filter((point) => point.results);
  const count = (status) => sweep.points.filter((point) => point.status === status).length;
  document.getElementById("subtitle").textContent = Object.entries(sweep.base).map(([key, value]) => `${key} = ${value}`).join(", ");
  const figures = [[count("done"), "points done"], [count("failed"), "failed"], [count("missing"), "not run yet"]].map(([number, text]) => [String(number), text]);
  if (points.length) {
    const gain = gainOf(points);
    const best = points.reduce((a, b) => (b.results[gain.key] > a.results[gain.key] ? b : a));
    if (gain.key in best.results)
      figures.push([forPeople(best.results[gain.key]), `${gain.title} at most: ${describe(best.inputs, sweep.keys)}`]);
  }
  addFigures(figures);
  const hasGain = points.length > 0 && points.every((point) => gainOf(points).key in point.results);
  if (points.length && sweep.axes.length) {
    const all = Object.keys(points[0].results);
    const names = [...kHeadline.filter((name) => all.includes(name)), ...all.filter((name) => !kHeadline.includes(name))];
    new AxisPlot(sweep, points, names);
    const costs = costsOf(points);
    if (hasGain && Object.keys(costs).length) new ParetoPlot(sweep, points, costs);
    showPoints(sweep, names);
  } else {
    showPoints(sweep, points.length ? Object.keys(points[0].results) : []);
  }
}
