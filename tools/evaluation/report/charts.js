'use strict';
// Elements and charts. Text goes in as text nodes only: names in the data are never read as markup.

function build(create, tag, attributes, children) {
  const node = create(tag);
  for (const [name, value] of Object.entries(attributes || {})) {
    if (name === 'on') for (const [event, action] of Object.entries(value)) node.addEventListener(event, action);
    else if (value !== null && value !== undefined && value !== false) node.setAttribute(name, value === true ? '' : value);
  }
  node.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return node;
}
const el = (tag, attributes, ...children) => build((t) => document.createElement(t), tag, attributes, children);
const svg = (tag, attributes, ...children) =>
  build((t) => document.createElementNS('http://www.w3.org/2000/svg', t), tag, attributes, children);

const isNumber = (x) => typeof x === 'number' && Number.isFinite(x);
const fixed = (x, digits) => (isNumber(x) ? x.toFixed(digits) : '–');
const percent = (x, digits = 0) => (isNumber(x) ? (100 * x).toFixed(digits) + ' %' : '–');
const quantile = (values, share) => {
  const sorted = [...values].sort((a, b) => a - b);
  const at = share * (sorted.length - 1), low = Math.floor(at);
  return sorted.length ? sorted[low] + (at - low) * (sorted[Math.min(low + 1, sorted.length - 1)] - sorted[low]) : NaN;
};

// Round steps that give about `count` ticks.
function ticks(low, high, count) {
  const rough = (high - low) / count, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= rough * 0.999);
  const out = [];
  for (let v = Math.ceil(low / step - 1e-9) * step; v <= high + step * 1e-6; v += step) out.push(Number(v.toPrecision(12)));
  return out;
}

// A chart with axes. `x` and `y`: {from, to, label, format}. Returns the figure, its plot group and the two scales.
function chart(title, x, y, note) {
  const width = 400, height = 260, left = 46, right = 12, top = 10, bottom = 40;
  const X = (v) => left + (v - x.from) / (x.to - x.from) * (width - left - right);
  const Y = (v) => height - bottom - (v - y.from) / (y.to - y.from) * (height - top - bottom);
  const root = svg('svg', { viewBox: `0 0 ${width} ${height}`, class: 'chart', role: 'img', 'aria-label': title });
  for (const v of ticks(x.from, x.to, 6)) {
    root.append(svg('line', { class: 'grid', x1: X(v), x2: X(v), y1: top, y2: height - bottom }),
      svg('text', { class: 'tick', x: X(v), y: height - bottom + 15, 'text-anchor': 'middle' }, x.format ? x.format(v) : String(v)));
  }
  for (const v of ticks(y.from, y.to, 5)) {
    root.append(svg('line', { class: 'grid', x1: left, x2: width - right, y1: Y(v), y2: Y(v) }),
      svg('text', { class: 'tick', x: left - 7, y: Y(v) + 4, 'text-anchor': 'end' }, y.format ? y.format(v) : String(v)));
  }
  root.append(svg('text', { class: 'axis', x: (left + width - right) / 2, y: height - 6, 'text-anchor': 'middle' }, x.label),
    svg('text', { class: 'axis', x: 12, y: (top + height - bottom) / 2, 'text-anchor': 'middle',
      transform: `rotate(-90 12 ${(top + height - bottom) / 2})` }, y.label));
  const plot = svg('g', {});
  root.append(plot);
  const figure = el('figure', {}, el('figcaption', {}, el('b', {}, title), note ? el('span', { class: 'quiet' }, note) : null), root);
  return { figure, plot, X, Y, bottom: Y(y.from), top: Y(y.to) };
}

function emptyChart(title, why) {
  return el('figure', {}, el('figcaption', {}, el('b', {}, title)), el('p', { class: 'empty' }, why));
}

const path = (points, X, Y) => points.map(([x, y], i) => `${i ? 'L' : 'M'}${X(x).toFixed(1)} ${Y(y).toFixed(1)}`).join('');

// What holds for threshold t is the point with the lowest score that is still >= t: steps.
function steps(curve, key) {
  const rising = [...curve].reverse(), points = [[0, rising[0][key]]];
  rising.forEach((p, i) => points.push([p.threshold, p[key]], [p.threshold, (rising[i + 1] || p)[key]]));
  return points;
}

// `continued`: the same with the candidates that were not reported, which a lower threshold would have let pass.
function scoreCurve(curve, continued, instances) {
  const title = 'Precision and recall by threshold';
  if (!continued.length || !instances) return emptyChart(title, 'No detection that counts.');
  const lowest = curve.length ? curve[curve.length - 1].threshold : 1;
  const below = continued.filter((p) => p.threshold <= lowest);
  const c = chart(title, { from: 0, to: 1, label: 'threshold on the score' }, { from: 0, to: 1, label: 'share' },
    'solid: what was reported; dashed: what a lower threshold would add');
  for (const key of ['precision', 'recall']) {
    if (below.length) c.plot.append(svg('path', { class: `curve ${key} below`, d: path(steps(below, key), c.X, c.Y) }));
    if (!curve.length) continue;
    const reported = steps(curve, key).slice(1), at = reported[0];
    c.plot.append(svg('path', { class: 'curve ' + key, d: path(reported, c.X, c.Y) }),
      svg('text', { class: 'direct ' + key, x: c.X(at[0]) - 6, y: c.Y(at[1]) - 6, 'text-anchor': 'end' }, `${key} ${fixed(at[1], 2)}`));
  }
  for (const p of [...below, ...curve]) {
    c.plot.append(svg('circle', { class: 'probe', cx: c.X(p.threshold), cy: c.Y(p.recall), r: 6 },
      svg('title', {}, `threshold ${fixed(p.threshold, 3)}: precision ${fixed(p.precision, 2)}, recall ${fixed(p.recall, 2)}`)));
  }
  return c.figure;
}

function reliabilityDiagram(reported, candidates) {
  const title = 'Reliability of the score';
  if (!reported.bins.length && !candidates.bins.length) return emptyChart(title, 'No detection that counts.');
  const c = chart(title, { from: 0, to: 1, label: 'mean score' }, { from: 0, to: 1, label: 'share that is right' },
    `expected calibration error ${fixed(reported.expected_error, 3)} reported, ` +
    `${fixed(candidates.expected_error, 3)} all verified candidates; bars: 95 %`);
  c.plot.append(svg('path', { class: 'ideal', d: path([[0, 0], [1, 1]], c.X, c.Y) }));
  for (const [name, bins] of [['candidates', candidates.bins], ['reported', reported.bins]]) {
    for (const b of bins) {
      const x = c.X(b.mean_score);
      c.plot.append(svg('g', { class: 'bin ' + name },
        svg('line', { x1: x, x2: x, y1: c.Y(b.interval[0]), y2: c.Y(b.interval[1]) }),
        svg('circle', { cx: x, cy: c.Y(b.share_right), r: Math.min(9, 2.5 + Math.sqrt(b.n)) }),
        svg('title', {}, `${name} ${fixed(b.low, 1)}–${fixed(b.high, 1)}: ${b.n}, mean score ${fixed(b.mean_score, 2)}, right ${percent(b.share_right)}`)));
    }
  }
  c.plot.append(svg('text', { class: 'direct reported', x: c.X(0.03), y: c.Y(0.94) }, '● reported'),
    svg('text', { class: 'direct candidates', x: c.X(0.03), y: c.Y(0.87) }, '○ all verified candidates'));
  return c.figure;
}

// `expected`: density by value, drawn over the bars; `marks`: [value, text] as vertical lines.
function histogram(title, values, label, options) {
  const finite = values.filter((v) => isNumber(v) && v >= 0);
  if (!finite.length) return emptyChart(title, options.empty || 'No hits.');
  const to = options.to || Math.max(quantile(finite, 0.95) * 1.15, 1e-6), bins = options.bins || 20, width = to / bins;
  const counts = new Array(bins).fill(0);
  let beyond = 0;
  for (const v of finite) v < to ? ++counts[Math.floor(v / width)] : ++beyond;
  const density = options.expected ? counts.map((_, i) => finite.length * width * options.expected((i + 0.5) * width)) : [];
  const high = Math.max(...counts, ...density, 1) * 1.12;
  const c = chart(title, { from: 0, to, label: beyond ? `${label} (${beyond} beyond)` : label },
    { from: 0, to: high, label: 'hits', format: (v) => (Number.isInteger(v) ? String(v) : '') }, options.note);
  counts.forEach((n, i) => {
    if (!n) return;
    c.plot.append(svg('rect', { class: 'hist', x: c.X(i * width) + 0.75, width: c.X(width) - c.X(0) - 1.5, y: c.Y(n), height: c.bottom - c.Y(n) },
      svg('title', {}, `${fixed(i * width, 2)} to ${fixed((i + 1) * width, 2)}: ${n}`)));
  });
  if (density.length) c.plot.append(svg('path', { class: 'curve expected', d: path(density.map((d, i) => [(i + 0.5) * width, d]), c.X, c.Y) }));
  (options.marks || []).filter(([v]) => v <= to).forEach(([v, text], i) => {
    c.plot.append(svg('line', { class: 'mark', x1: c.X(v), x2: c.X(v), y1: c.top, y2: c.bottom }),
      svg('text', { class: 'direct', x: c.X(v) + 4, y: c.top + 12 + 14 * i }, text));
  });
  return c.figure;
}

// Instances by range, the found ones at the bottom of each bar.
function rangeChart(instances) {
  const title = 'Found and missed by range';
  if (!instances.length) return emptyChart(title, 'No instances.');
  const to = Math.ceil(Math.max(...instances.map((i) => i.pose.range_m)) * 4 + 1e-9) / 4, bins = Math.max(4, Math.round(to / 0.25)), width = to / bins;
  const found = new Array(bins).fill(0), all = new Array(bins).fill(0);
  for (const i of instances) {
    const bin = Math.min(bins - 1, Math.floor(i.pose.range_m / width));
    ++all[bin];
    if (i.hit) ++found[bin];
  }
  const c = chart(title, { from: 0, to, label: 'range, m' },
    { from: 0, to: Math.max(...all) * 1.12, label: 'instances', format: (v) => (Number.isInteger(v) ? String(v) : '') });
  all.forEach((n, i) => {
    const bar = (kind, low, high) => svg('rect', { class: kind, x: c.X(i * width) + 0.75, width: c.X(width) - c.X(0) - 1.5, y: c.Y(high), height: c.Y(low) - c.Y(high) },
      svg('title', {}, `${fixed(i * width, 2)} to ${fixed((i + 1) * width, 2)} m: ${found[i]} of ${n} found`));
    if (n) c.plot.append(bar('bar-found', 0, found[i]), bar('bar-missed', found[i], n));
  });
  return c.figure;
}

// Chi-square with 6 degrees of freedom.
const chiSquare6 = (x) => x * x * Math.exp(-x / 2) / 16;

function drawCharts(measures, instances) {
  const { errors, total } = measures, nees = total.nees || { n: 0 };
  const median = (values, unit) => [[quantile(values, 0.5), `median ${fixed(quantile(values, 0.5), 2)} ${unit}`]];
  return [
    scoreCurve(measures.score_curve, measures.continued_curve, total.instances),
    reliabilityDiagram(measures.calibration, measures.candidate_calibration),
    histogram('Translation error', errors.translation_mm, 'mm', { marks: median(errors.translation_mm, 'mm') }),
    histogram('Rotation error', errors.rotation_deg, 'deg', { marks: median(errors.rotation_deg, 'deg') }),
    histogram('Normalised error squared (NEES)', errors.nees, 'NEES', {
      to: 30, expected: chiSquare6, marks: [[12.592, '95 % quantile']], empty: 'No hit with a covariance.',
      note: nees.coverage ? `inside the 50 / 90 / 95 / 99 % regions: ${['50', '90', '95', '99'].map((k) => percent(nees.coverage[k])).join(', ')}; line: what an honest covariance gives` : null }),
    rangeChart(instances),
  ];
}
