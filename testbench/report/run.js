// The page of one run: its statistics file, and its image if there is one.
"use strict";

const kCauses = {
  poly: "kernels on the PE array", stolen: "kernels slowed down by PIO", mono: "mono instructions",
  data_cache: "data cache misses", semaphore: "semaphores", transfer_call: "starting transfers",
  wait_load: "waiting for loads", wait_save: "waiting for saves", wait_pio_queue: "PIO queue full",
  wait_host: "waiting for the host", thread_switch: "thread switches",
};

/// A firmware outside the tree says what it counts its work in.
function rates(run) {
  if ("rays" in run)
    return [[forPeople(run.rays / run.simulated_seconds), "rays/s"], [forPeople(run.segments / run.simulated_seconds), "path segments/s"]];
  if (!run.work) return [];
  return [[forPeople(run.work.per_second), `${run.work.unit}/s`], [forPeople(run.work.per_second_with_host), `${run.work.unit}/s with upload and download`]];
}

function showFigures(run, chip) {
  const figures = [
    ...rates(run),
    [forPeople(run.simulated_seconds, "s"), "simulated"],
    [forPeople(run.simulated_cycles), "cycles"],
    [percent(chip.pe_utilisation), "of them kernels on the PE array"],
    [percent(chip.simd_efficiency), "SIMD efficiency"],
    [percent(chip.exposed_pio_share), "waiting for PIO"],
    [forPeople(chip.ddr_bytes_per_second, "B/s"), "to and from DDR"],
  ];
  if (chip.energy) figures.push([forPeople(chip.energy.joules, "J"), "energy"]);
  if ("rays_per_joule" in run) figures.push([forPeople(run.rays_per_joule), "rays/J"]);
  else if (run.work) figures.push([forPeople(run.work.per_joule), `${run.work.unit}/J`]);
  addFigures(figures);
}

function showKernels(run, chip) {
  const kernels = chip.pe_array.kernels;
  const section = addSection("Kernels", "Cycles on the PE array, without those stolen by programmed I/O");
  addBars(section, kernels.map((kernel) => [kernel.name, kernel.cycles]),
          (cycles) => `${forPeople(cycles)} (${percent(cycles / run.simulated_cycles)})`);
  const hasWaits = kernels.some((kernel) => "exposed_wait_cycles" in kernel);
  addTable(section, ["kernel", "runs", "cycles", "SIMD efficiency", ...(hasWaits ? ["exposed wait"] : [])],
           kernels.map((kernel) => [{ text: kernel.name }, kernel.runs, kernel.cycles, percent(kernel.simd_efficiency),
                                    ...(hasWaits ? [kernel.exposed_wait_cycles] : [])]));
}

/// How full the ray bin is in each pass, which decides how many PEs are busy. Runs that did not count it show
/// kernels only.
function showTime(run, chip) {
  const intervals = run.counts && run.counts.rays_by_interval;
  if (!Array.isArray(intervals) || intervals.length < 2) return;
  const passes = run.counts.passes_per_interval;
  const slots = chip.pes * run.firmware.bin_blocks;
  const last = run.counts.passes - passes * (intervals.length - 1);
  const section = addSection("Utilisation over time", "Share of the bins' slots that hold a ray, by pass through the bins");
  addChart(section, {
    grid: { left: 8, right: 16, top: 16, bottom: 30, containLabel: true },
    tooltip: { trigger: "axis", formatter: (items) => `from pass ${forPeople(items[0].value[0])}: ${percent(items[0].value[1])}` },
    xAxis: { type: "value", name: "pass", nameLocation: "middle", nameGap: 26, max: run.counts.passes },
    yAxis: { type: "value", min: 0, max: 1, axisLabel: { formatter: percent } },
    series: [{ type: "line", step: "end", showSymbol: false, areaStyle: { opacity: 0.25 },
               data: intervals.map((rays, i) => [i * passes, rays / (slots * (i + 1 === intervals.length ? last : passes))]) }],
  });
}

/// Operations of a PE for one instruction of a class; a routine or a division counts as one.
function flopsOf(kernel) {
  if ("flops" in kernel) return kernel.flops;
  let flops = 0;
  for (const [name, count] of Object.entries(kernel.issued)) {
    if (!/^fp(32|64)_/.test(name)) continue;
    flops += count * (/vector4/.test(name) ? 4 : 1) * (/multiply_add/.test(name) ? 2 : 1);
  }
  return flops;
}

/// The roofline: floating-point work and the bytes moved for it, against the peaks of arithmetic and of each
/// path (Williams, Waterman and Patterson, Roofline, 2009).
function roofline(run, chip) {
  if (chip.roofline) {
    const roof = chip.roofline;
    return { flops: roof.flops_per_second, peak: roof.peak_flops_per_second,
             paths: ["pio", "clear_connect", "ddr"].filter((path) => roof[`peak_${path}_bytes_per_second`] > 0)
               .map((path) => ({ name: path, peak: roof[`peak_${path}_bytes_per_second`], intensity: roof[`flops_per_${path}_byte`] })) };
  }
  const clock = chip.clock_hz;
  const flops = chip.pes * chip.pe_array.kernels.reduce((sum, kernel) => sum + flopsOf(kernel) * kernel.simd_efficiency, 0);
  const path = (name, bytes, group) => ({ name, peak: run.chip_config[group].bytes_per_cycle * clock, intensity: flops / bytes });
  return { flops: flops / run.simulated_seconds, peak: 2 * chip.pes * clock,
           paths: [path("pio", chip.pio.bytes_mono_to_poly + chip.pio.bytes_poly_to_mono, "pio"),
                   path("ddr", chip.ddr.bytes_read + chip.ddr.bytes_written, "ddr")] };
}

function showRoofline(run, chip) {
  const roof = roofline(run, chip);
  const intensities = roof.paths.flatMap((path) => [path.intensity, roof.peak / path.peak]).filter((x) => x > 0 && isFinite(x));
  if (!(roof.flops > 0) || intensities.length === 0) return;
  const low = 10 ** Math.floor(Math.log10(Math.min(...intensities) / 3));
  const high = 10 ** Math.ceil(Math.log10(Math.max(...intensities) * 3));
  const section = addSection("Roofline",
    `${forPeople(roof.flops, "flop/s")} of at most ${forPeople(roof.peak, "flop/s")} (${percent(roof.flops / roof.peak)}); a path's slope is its bytes a second`);
  const lines = roof.paths.map((path) => ({
    name: path.name, type: "line", showSymbol: false,
    data: [[low, low * path.peak], [roof.peak / path.peak, roof.peak], [high, roof.peak]] }));
  const points = roof.paths.map((path, i) => ({
    name: `run, ${path.name} bytes`, type: "scatter", symbol: ["circle", "diamond", "triangle"][i % 3], symbolSize: 18 - 5 * i, itemStyle: { color: kColours[i], borderColor: "#000" },
    data: [[path.intensity, roof.flops]] }));
  addChart(section, {
    grid: { left: 8, right: 24, top: 64, bottom: 30, containLabel: true },
    legend: { top: 0, type: "scroll" },
    tooltip: { trigger: "item", formatter: (item) => `${item.seriesName}: ${forPeople(item.value[0])} flop/byte, ${forPeople(item.value[1], "flop/s")}` },
    xAxis: { type: "log", min: low, max: high, name: "flop/byte", nameLocation: "middle", nameGap: 26 },
    yAxis: { type: "log", min: 10 ** Math.floor(Math.log10(roof.flops / 3)), max: 10 ** Math.ceil(Math.log10(roof.peak)),
             axisLabel: { formatter: (value) => forPeople(value) }, name: "flop/s" },
    series: [...lines, ...points],
  });
}

function showEnergy(chip) {
  if (!chip.energy || !chip.energy.joules_by_cause) return;
  const section = addSection("Energy", `${forPeople(chip.energy.joules, "J")}; first-order, from counters times the chip's table`);
  addBars(section, Object.entries(chip.energy.joules_by_cause).map(([cause, joules]) => [cause.replaceAll("_", " "), joules]),
          (joules) => `${forPeople(joules, "J")} (${percent(joules / chip.energy.joules)})`);
}

function showTransfers(chip) {
  const section = addSection("Transfers and memory", "Counts of the programmed-I/O engine, the network and the DDR");
  const rows = [];
  const add = (name, counts) => {
    for (const [key, value] of Object.entries(counts)) {
      if (typeof value === "number") rows.push([{ text: `${name}, ${key.replaceAll("_", " ")}` }, value]);
      else if (value && typeof value === "object") add(`${name} ${key}`, value);
    }
  };
  for (const [name, key] of [["PIO", "pio"], ["network", "clear_connect"], ["DDR", "ddr"], ["host link", "host_link"]])
    if (chip[key]) add(name, chip[key]);
  addTable(section, ["count", "value"], rows);
}

/// What was run, without where.
function describeRun(run) {
  const firmware = run.firmware;
  if (firmware.options)
    return [firmware.name, ...Object.entries(firmware.options).map(([name, value]) => `${name} = ${value}`)].join(", ");
  return `${run.scene}, ${run.width} x ${run.height}, ${firmware.samples} samples a pixel, program ${firmware.program}, n = ${firmware.n}, ` +
    `buffering ${firmware.buffer}`;
}

/// The counters of a firmware's own.
function showCounters(run) {
  const counters = run.firmware.counters;
  if (!Array.isArray(counters) || counters.length === 0) return;
  addTable(addSection("Counters of the firmware", ""), ["counter", "value", "unit", "meaning"],
           counters.map((counter) => [{ text: counter.name }, counter.value, { text: counter.unit }, { text: counter.meaning }]));
}

/// Which unit held the run up: busy shares, and the reason in a line.
function showVerdict(chip) {
  if (!chip.verdict || !chip.verdict.busy) return;
  const section = addSection("Verdict", chip.verdict.reason, true);
  addBars(section, Object.entries(chip.verdict.busy).map(([unit, share]) => [unit.replaceAll("_", " "), share]), percent);
}

/// What each parameter of the chip does to the run: a tornado chart of the largest effects, and a table of all.
function showSensitivity(run) {
  const found = run.sensitivity;
  if (!found || !Array.isArray(found.parameters)) return;
  const change = (changed) => changed[`${found.order}_change`];
  const bars = [];
  for (const parameter of found.parameters) {
    const ran = parameter.runs.filter((changed) => !("error" in changed));
    const numbers = ran.filter((changed) => changed.kind !== "alternative");
    if (numbers.length) bars.push([`${parameter.name} ${parameter.value} → ${numbers.map((changed) => changed.value).join(", ")}`, numbers]);
    for (const other of ran.filter((changed) => changed.kind === "alternative")) bars.push([`${parameter.name} → ${other.value}`, [other]]);
  }
  const effect = ([, changes]) => Math.max(...changes.map((changed) => Math.abs(change(changed))));
  const shown = bars.filter((bar) => effect(bar) >= 0.0005).sort((a, b) => effect(b) - effect(a)).slice(0, 16).reverse();
  const section = addSection("What to change", `Change of the ${found.order} if one parameter of the chip is another: numbers ${percent(found.share)} less and more, other choices`, true);
  if (shown.length) {
    const series = [["lower", "less"], ["higher", "more"], ["alternative", "another choice"]].map(([kind, name]) => ({
      name, type: "bar", stack: kind, barGap: "-100%", barMaxWidth: 18,
      data: shown.map(([, changes]) => { const one = changes.find((changed) => changed.kind === kind); return one ? change(one) : null; }) }));
    const signed = (share) => (share > 0 ? "+" : "") + percent(share);
    const chart = addChart(section, {
      grid: { left: 24, right: 48, top: 32, bottom: 8, containLabel: true }, legend: { top: 0 },
      tooltip: { trigger: "axis", axisPointer: { type: "shadow" },
                 formatter: (items) => [items[0].name, ...items.filter((item) => item.value != null).map((item) => `${item.seriesName}: ${signed(item.value)}`)].join("<br>") },
      xAxis: { type: "value", axisLabel: { formatter: (share) => `${+(100 * share).toFixed(1)} %`, hideOverlap: true } },
      yAxis: { type: "category", data: shown.map(([name]) => name), axisLabel: { width: Math.min(340, document.body.clientWidth / 3), overflow: "truncate" }, axisLine: { onZero: false } },
      series });
    chart.getDom().style.height = `${90 + 26 * shown.length}px`;
    chart.resize();
  }
  addTable(section, ["parameter", "is", "unit", "changed to", "time", "energy"], found.parameters.flatMap((parameter) => parameter.runs.map((changed) => [
    { text: parameter.name }, { text: String(parameter.value) }, { text: parameter.unit }, { text: String(changed.value) },
    ..."error" in changed ? [{ text: changed.error, class: "error" }, ""] : [percent(changed.time_change), percent(changed.energy_change)]])));
}

function showRun(run, image) {
  document.getElementById("subtitle").textContent =
    `${describeRun(run)}, ${run.machine === "native" ? "native: no time was simulated" : `chip ${run.chip_preset}`}`;
  const chip = run.chip;
  if (chip) showFigures(run, chip);
  else if ("segments" in run) addFigures([[forPeople(run.segments), "path segments"], [forPeople(run.rays), "rays"]]);
  if (chip) showVerdict(chip);
  showSensitivity(run);
  if (image) addSection("Image", `SHA-256 of its pixels ${run.image_sha256.slice(0, 16)}…`).append(element("img", { src: image, alt: "The image of this run" }));
  showCounters(run);
  if (!chip) return;
  const cycles = addSection("Where the cycles went", "Every cycle of the control unit has one cause");
  addBars(cycles, Object.entries(chip.control_unit.cycles_by_cause).map(([cause, value]) => [kCauses[cause] || cause, value]),
          (value) => `${forPeople(value)} (${percent(value / run.simulated_cycles)})`);
  showKernels(run, chip);
  showTime(run, chip);
  showRoofline(run, chip);
  showEnergy(chip);
  showTransfers(chip);
}
