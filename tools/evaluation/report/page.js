// The page: data, filter, sections, viewer, keys.

const data = JSON.parse(document.getElementById('data').textContent);
const measures = data.measures;
const byId = (id) => document.getElementById(id);
const nameOf = (object) => (data.objects[object] ? data.objects[object].name : `object ${object}`);

// Items that can be looked at one by one. `what`: the instance, the detection, or the frame itself.
const misses = [], alarms = [], frames = [];
data.frames.forEach((frame, f) => {
  frames.push({ kind: 'frame', id: `frame-${f}`, frame, what: frame, cause: '' });
  frame.instances.forEach((what, i) => {
    if (what.counts && !what.hit) misses.push({ kind: 'miss', id: `miss-${f}-${i}`, frame, what, cause: what.cause });
  });
  frame.detections.forEach((what, i) => {
    if (what.verdict === 'false') alarms.push({ kind: 'alarm', id: `alarm-${f}-${i}`, frame, what, cause: what.cause });
  });
});

const CAUSE_ORDER = ['no lines', 'no hypothesis', 'ranked out', 'wrong pose', 'rejected', 'found', 'not searched',
  'duplicate', 'wrong distance', 'other object', 'clutter'];
const hueOf = (cause) => [215, 262, 300, 28, 350, 120, 0, 190, 160, 45, 85][CAUSE_ORDER.indexOf(cause)] || 0;

// --- filter ---

const filter = { scene: '', object: '', cause: '' };
const passes = (item) => {
  if (filter.scene !== '' && String(item.frame.scene) !== filter.scene) return false;
  if (item.kind === 'frame') {
    const inside = [...item.frame.instances, ...item.frame.detections];
    const counted = inside.filter((x) => (x.counts && !x.hit) || x.verdict === 'false');
    return (filter.object === '' || inside.some((x) => String(x.object) === filter.object)) &&
      (filter.cause === '' || counted.some((x) => x.cause === filter.cause && (filter.object === '' || String(x.object) === filter.object)));
  }
  if (filter.object !== '' && String(item.what.object) !== filter.object) return false;
  return filter.cause === '' || (item.cause === filter.cause && !item.what.hit);
};

function applyFilter() {
  for (const [items, section] of [[misses, 'misses'], [alarms, 'alarms'], [frames, 'frames']]) {
    let shown = 0;
    for (const item of items) {
      const pass = passes(item);
      byId(item.id).hidden = !pass;
      shown += pass;
    }
    document.querySelector(`#${section} .count`).textContent = shown === items.length ? shown : `${shown} of ${items.length}`;
  }
  for (const row of document.querySelectorAll('#instance-table tbody tr')) row.hidden = !passes(row.item);
  byId('filter-count').textContent = Object.values(filter).some(Boolean)
    ? `${misses.filter(passes).length} misses, ${alarms.filter(passes).length} false alarms` : '';
  for (const button of document.querySelectorAll('#causes button')) button.setAttribute('aria-pressed', button.dataset.cause === filter.cause);
}

function setFilter(field, value) {
  filter[field] = value;
  byId('filter-' + field).value = value;
  applyFilter();
}

function makeFilters() {
  const scenes = [...new Set(data.frames.map((f) => f.scene))];
  const causes = CAUSE_ORDER.filter((c) => [...misses, ...alarms].some((item) => item.cause === c));
  const fill = (field, values) => {
    const select = byId('filter-' + field);
    select.append(el('option', { value: '' }, 'all'), ...values.map(([value, text]) => el('option', { value }, text)));
    select.addEventListener('change', () => setFilter(field, select.value));
  };
  fill('scene', scenes.map((s) => [s, String(s)]));
  fill('object', Object.keys(data.objects).map((id) => [id, `${id} ${nameOf(id)}`]));
  fill('cause', causes.map((c) => [c, c]));
  byId('filters').addEventListener('reset', (event) => {
    event.preventDefault();
    for (const field of Object.keys(filter)) setFilter(field, '');
  });
  byId('filters').addEventListener('submit', (event) => event.preventDefault());
}

// --- tables ---

// `columns`: [heading, value of a row for sorting, text (optional), class]. Numbers sort by size, falling first.
function sortableTable(rows, columns, summary) {
  const isText = ([, value]) => rows.length > 0 && typeof value(rows[0]) === 'string';
  const body = el('tbody', {}), heads = columns.map((column, k) => el('th', { scope: 'col', class: isText(column) ? 'left' : null },
    el('button', { type: 'button', on: { click: () => sortBy(k) } }, column[0])));
  const cell = (row) => (column, k) => {
    const [, value, text] = column, v = value(row);
    return el(k === 0 ? 'th' : 'td', { class: isText(column) ? 'left' : null }, text ? text(row) : isNumber(v) ? String(v) : v ?? '–');
  };
  const lines = rows.map((row) => {
    const line = el('tr', {}, columns.map(cell(row)));
    line.item = row.item;
    return [line, row];
  });
  const compare = (a, b) => (typeof a === 'string' || typeof b === 'string' ? String(a ?? '').localeCompare(String(b ?? ''), undefined, { numeric: true }) : (isNumber(a) ? a : -Infinity) - (isNumber(b) ? b : -Infinity));
  function sortBy(k) {
    const falling = heads[k].getAttribute('aria-sort') === 'ascending';
    heads.forEach((h) => h.removeAttribute('aria-sort'));
    heads[k].setAttribute('aria-sort', falling ? 'descending' : 'ascending');
    lines.sort(([, a], [, b]) => (falling ? -1 : 1) * compare(columns[k][1](a), columns[k][1](b)));
    body.append(...lines.map(([line]) => line));
  }
  body.append(...lines.map(([line]) => line));
  return el('table', {}, el('thead', {}, el('tr', {}, heads)), body,
    summary ? el('tfoot', {}, el('tr', {}, columns.map(cell(summary)))) : null);
}

function objectTable() {
  const rows = Object.entries(measures.per_object).map(([id, score]) => ({ name: `${id} ${nameOf(id)}`, score }));
  const bins = Object.keys(measures.total.recall_by_visibility);
  return sortableTable(rows, [
    ['Object', (r) => r.name],
    ['Instances', (r) => r.score.instances], ['Hits', (r) => r.score.true_positives], ['False', (r) => r.score.false_positives],
    ['Recall', (r) => r.score.recall, (r) => percent(r.score.recall)],
    ['Precision', (r) => r.score.precision, (r) => percent(r.score.precision)],
    ...bins.map((b) => [`Visible ${b.replace('-', '–')}`, (r) => r.score.recall_by_visibility[b].recall,
      (r) => { const c = r.score.recall_by_visibility[b]; return c.n ? `${percent(c.recall)} of ${c.n}` : '–'; }]),
    ['Median mm', (r) => r.score.median_translation_mm, (r) => fixed(r.score.median_translation_mm, 2)],
    ['Median deg', (r) => r.score.median_rotation_deg, (r) => fixed(r.score.median_rotation_deg, 2)],
    ['AR MSSD', (r) => r.score.AR_MSSD, (r) => fixed(r.score.AR_MSSD, 3)],
    ['AR MSPD', (r) => r.score.AR_MSPD, (r) => fixed(r.score.AR_MSPD, 3)],
  ], { name: 'All', score: measures.total });
}

function instanceTable() {
  const rows = data.frames.flatMap((frame) => frame.instances.filter((i) => i.counts).map((what) => (
    { what, frame, item: { kind: 'instance', frame, what, cause: what.cause } })));
  return sortableTable(rows, [
    ['Scene/image', (r) => `${r.frame.scene}/${r.frame.image}`],
    ['Object', (r) => nameOf(r.what.object)],
    ['Visible', (r) => r.what.visible, (r) => percent(r.what.visible)],
    ['Range m', (r) => r.what.pose && r.what.pose.range_m, (r) => fixed(r.what.pose && r.what.pose.range_m, 2)],
    ['Outcome', (r) => (r.what.hit ? 'found' : r.what.cause), (r) => (r.what.hit ? 'found' : badge(r.what.cause))],
    ['Score', (r) => r.what.score, (r) => fixed(r.what.score, 2)],
    ['MSSD mm', (r) => r.what.mssd_mm, (r) => fixed(r.what.mssd_mm, 1)],
    ['Translation mm', (r) => r.what.translation_mm, (r) => fixed(r.what.translation_mm, 2)],
    ['Rotation deg', (r) => r.what.rotation_deg, (r) => fixed(r.what.rotation_deg, 2)],
    ['Edges found', (r) => r.what.trace && r.what.trace.found_edges, (r) => (r.what.trace ? `${r.what.trace.found_edges} of ${r.what.trace.visible_edges}` : '–')],
  ]);
}

function stageTable() {
  const frame = measures.stages.frame.wall_ms.p50 || 1;
  const rows = Object.entries(measures.stages).map(([name, t]) => ({ name, wall: t.wall_ms, cpu: t.cpu_ms }));
  const time = (r, key) => [key, (x) => x.wall[key], (x) => fixed(x.wall[key], 2)];
  return sortableTable(rows.filter((r) => r.name !== 'frame'), [
    ['Stage, ms', (r) => r.name], time('', 'p50'), time('', 'p99'), time('', 'max'),
    ['CPU p50', (r) => r.cpu.p50, (r) => fixed(r.cpu.p50, 2)],
    ['Share', (r) => r.wall.p50, (r) => el('span', { class: 'meter' }, el('span', { style: `width:${Math.min(100, 100 * r.wall.p50 / frame)}%` }))],
  ], rows.find((r) => r.name === 'frame'));
}

function listTable() {
  const rows = Object.entries(measures.lists).map(([name, list]) => ({ name: name.replace('_', ' '), ...list }));
  return sortableTable(rows, [
    ['List', (r) => r.name], ['Capacity', (r) => r.capacity], ['Median', (r) => r.p50], ['High water', (r) => r.high_water],
    ['Dropped', (r) => r.dropped, (r) => el('span', { class: r.dropped ? 'warn' : '' }, String(r.dropped))],
    ['Use', (r) => r.high_water / Math.max(1, r.capacity), (r) => el('span', { class: 'meter' }, el('span', { style: `width:${Math.min(100, 100 * r.high_water / Math.max(1, r.capacity))}%` }))],
  ]);
}

// --- sections ---

function tiles() {
  const t = measures.total, frame = measures.stages.frame.wall_ms, nees = t.nees && t.nees.coverage;
  const tile = (figure, name, note) => el('div', { class: 'tile' }, el('b', {}, figure), el('span', {}, name), el('small', {}, note));
  return [
    tile(percent(t.recall), 'recall', `${t.true_positives} of ${t.instances} instances`),
    tile(percent(t.precision), 'precision', `${t.false_positives} false in ${measures.frames} frames`),
    tile(`${fixed(t.median_translation_mm, 1)} mm`, 'median error', `${fixed(t.median_rotation_deg, 2)} deg, of the hits`),
    tile(fixed(measures.calibration.expected_error, 3), 'calibration error', 'score against share right'),
    tile(nees ? percent(nees['95']) : '–', 'NEES coverage', 'should be 95 %'),
    tile(`${fixed(frame.p50, 1)} ms`, 'frame, median', `p99 ${fixed(frame.p99, 1)} ms`),
  ];
}

function causeBar() {
  const counts = CAUSE_ORDER.map((cause) => [cause, misses.filter((m) => m.cause === cause).length]).filter(([, n]) => n);
  return el('div', { class: 'cause-bar' }, counts.map(([cause, n]) => el('button', { type: 'button', 'data-cause': cause,
    style: `flex-grow:${n};--hue:${hueOf(cause)}`, title: CAUSES[cause], on: { click: () => setFilter('cause', filter.cause === cause ? '' : cause) } },
    el('b', {}, String(n)), ' ', cause)));
}

function thumbnail(item) {
  const { frame } = item, missed = frame.instances.filter((i) => i.counts && !i.hit).length;
  const wrong = frame.detections.filter((d) => d.verdict === 'false').length, hits = frame.detections.filter((d) => d.verdict === 'hit').length;
  return el('button', { type: 'button', class: 'thumbnail', id: item.id, on: { click: () => openViewer(item) } },
    picture(frame, wholeFrame(frame), { shown: ['found', 'truth'], caption: `scene ${frame.scene} image ${frame.image}` }),
    el('span', {}, `${frame.scene}/${frame.image}`, el('small', {}, ` ${hits} found`, missed ? el('span', { class: 'missed' }, ` · ${missed} missed`) : null, wrong ? el('span', { class: 'false' }, ` · ${wrong} false`) : null)));
}

function legend() {
  return [['hit', 'found'], ['false', 'false alarm'], ['met', 'truth, found'], ['missed', 'truth, missed'], ['nearest', 'nearest candidate'], ['ignored', 'too hidden to count']]
    .map(([kind, name]) => el('span', { class: 'wire ' + kind }, name));
}

// --- viewer ---

let viewed = null;  // item
let eye = 'left';
const listOf = (item) => ({ miss: misses, alarm: alarms, frame: frames })[item.kind].filter((x) => x === item || passes(x));

// Puts the item's picture into the viewer. `window`: what of it; the eye's own shift comes on top.
function drawViewed(window) {
  const drawing = picture(viewed.frame, window, { focus: viewed.kind === 'miss' ? viewed.what : null, caption: placeOf(viewed), eye });
  makeZoomable(drawing, viewed.frame);
  byId('viewer-picture').replaceChildren(drawing);
  showLayers();
  fitText(drawing);
}

function openViewer(item) {
  viewed = item;
  eye = 'left';
  const list = listOf(item);
  const kind = { miss: 'miss', alarm: 'false alarm', frame: 'frame' }[item.kind];
  byId('viewer-title').textContent = (item.kind === 'frame' ? placeOf(item) : titleOf(item)) + ` — ${kind} ${list.indexOf(item) + 1} of ${list.length}`;
  byId('viewer-side').replaceChildren(...[item.kind === 'frame' ? null : badge(item.cause), ...detailsOf(item), depthScale(item.frame)].filter(Boolean));
  if (!byId('viewer').open) byId('viewer').showModal();
  const box = item.kind === 'frame' ? null : item.what.pose && item.what.pose.box;
  drawViewed(windowAround(item.frame, box));
  showEye();
}

// The same things through the other eye, at the same place of the screen.
function switchEye() {
  if (!viewed.frame.pictures.right) return;
  const window = byId('viewer-picture').firstChild.getAttribute('viewBox').split(' ').map(Number);
  const shift = viewed.what.pose ? meanDisparity(viewed.what.pose.seen) : 0;
  eye = eye === 'left' ? 'right' : 'left';
  window[0] += eye === 'right' ? -shift : shift;
  drawViewed(window);
  showEye();
}

function showEye() {
  byId('viewer-eye').textContent = eye === 'left' ? 'Left image' : 'Right image';
  byId('viewer-eye').hidden = !viewed.frame.pictures.right;
}

function stepViewer(by) {
  const list = listOf(viewed), next = list[list.indexOf(viewed) + by];
  if (next) openViewer(next);
}

function showLayers() {
  const drawing = byId('viewer-picture').firstChild;
  if (drawing) for (const layer of LAYERS) drawing.classList.toggle('no-' + layer.id, !layer.on);
}

// What the colours of the 3D lines mean in this frame.
function depthScale(frame) {
  const { near, far } = depthRange(frame);
  return near ? el('p', { class: 'depth-scale quiet' }, `3D lines: ${fixed(near, 2)} m`, el('span', {}), `${fixed(far, 2)} m`) : null;
}

function toggleLayer(k) {
  LAYERS[k].on = !LAYERS[k].on;
  byId('layer-' + LAYERS[k].id).checked = LAYERS[k].on;
  showLayers();
}

function makeViewer() {
  byId('layers').append(...LAYERS.map((layer, k) => el('label', { title: `Key ${k + 1}` },
    el('input', { type: 'checkbox', id: 'layer-' + layer.id, checked: layer.on, on: { change: () => { layer.on = !layer.on; showLayers(); } } }), layer.name)));
  byId('viewer-previous').addEventListener('click', () => stepViewer(-1));
  byId('viewer-next').addEventListener('click', () => stepViewer(1));
  byId('viewer-eye').addEventListener('click', switchEye);
  byId('viewer-close').addEventListener('click', () => byId('viewer').close());
  byId('viewer').addEventListener('close', () => { const back = viewed && byId(viewed.id); if (back) back.focus({ preventScroll: false }); });
}

// --- keys ---

let current = -1;  // index into the misses that pass the filter
function stepMiss(by) {
  const shown = misses.filter(passes);
  if (!shown.length) return;
  const focused = shown.findIndex((m) => byId(m.id) === document.activeElement);
  current = Math.min(shown.length - 1, Math.max(0, (focused >= 0 ? focused : current) + by));
  const card = byId(shown[current].id);
  card.focus({ preventScroll: true });
  card.scrollIntoView({ block: 'center', behavior: 'instant' });
}

function toggleTheme() {
  const root = document.documentElement;
  const now = root.dataset.theme || (matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light');
  root.dataset.theme = now === 'dark' ? 'light' : 'dark';
}

function onKey(event) {
  if (event.ctrlKey || event.altKey || event.metaKey || /^(INPUT|SELECT|TEXTAREA)$/.test(event.target.tagName)) return;
  const open = byId('viewer').open, key = event.key.toLowerCase();
  if (open && /^[1-6]$/.test(key)) toggleLayer(Number(key) - 1);
  else if (open && (key === 'arrowright' || key === 'n')) stepViewer(1);
  else if (open && (key === 'arrowleft' || key === 'p')) stepViewer(-1);
  else if (open && key === 'r') switchEye();
  else if (!open && key === 'n') stepMiss(1);
  else if (!open && key === 'p') stepMiss(-1);
  else if (key === 't') toggleTheme();
  else return;
  event.preventDefault();
}

function start() {
  byId('title').textContent = data.dataset;
  byId('subtitle').textContent = `${measures.frames} frames, ${measures.negative_frames} of them without objects · ` +
    `${Object.values(data.objects).map((o) => o.name).join(', ')} · a hit has MSSD below 0.1 diameters; instances less than ${percent(measures.min_visib)} visible do not count`;
  byId('tiles').append(...tiles());
  byId('objects').append(objectTable());
  byId('causes').append(causeBar());
  const none = (text) => el('p', { class: 'empty' }, text);
  byId('miss-cards').append(...(misses.length ? misses.map(card) : [none('Nothing was missed.')]));
  byId('alarm-cards').append(...(alarms.length ? alarms.map(card) : [none('No false alarm.')]));
  byId('legend').append(...legend());
  byId('thumbnails').append(...frames.map(thumbnail));
  byId('charts').append(...drawCharts(measures, data.frames.flatMap((f) => f.instances).filter((i) => i.counts && i.pose)));
  byId('instance-table').append(instanceTable());
  document.querySelector('#instances .count').textContent = measures.total.instances;
  byId('stage-table').append(stageTable());
  byId('list-table').append(listTable());
  makeFilters();
  makeViewer();
  applyFilter();
  byId('theme').addEventListener('click', toggleTheme);
  document.addEventListener('keydown', onKey);
}

start();
