// One card for each miss and each false alarm: a crop, the cause and the figures behind it.

const CAUSES = {
  'no lines': 'Too few of its edges were found as segments, or none of them got a depth.',
  'no hypothesis': 'Its lines were there, but no pair of them gave a pose within 0.3 diameters.',
  'ranked out': 'A hypothesis was near enough, but the shortened list of sets no longer held it.',
  'wrong pose': 'A set was near enough, but what came out of refinement is 0.1 diameters off or more.',
  'rejected': 'A right candidate was verified and scored too low, or lost its edges to a stronger one.',
  'found': 'The trace saw it reported; the measures matched that report to another instance.',
  'not searched': 'The recognizer was not asked for this object.',
  'duplicate': 'On an instance that another detection had already found.',
  'wrong distance': 'Covers a true instance in the image, but nearer or farther: the size was taken wrong.',
  'other object': 'On another known object.',
  'clutter': 'On something that is no known object.',
};
const ALARM_WRONG_POSE = 'On an instance of its object, but 0.1 diameters off or more.';

// --- misses: the stages as a ladder, passed until one lost the object ---

const REACH = { hypothesis: 0.3, set: 0.2, candidate: 0.1 };  // in diameters; as the evaluation's causes

function poseStep(name, traced, reach, extra) {
  if (!traced) return { name, passed: false, text: 'none' };
  return { name, passed: traced.error_d < reach,
    text: `${fixed(traced.error_d, 2)} d off, rank ${traced.rank + 1}${extra ? ', ' + extra : ''}` };
}

function ladder(instance) {
  const t = instance.trace;
  if (!t) return null;
  const steps = [
    { name: 'lines', passed: t.found_edges >= 2 && t.deep_edges > 0,
      text: `${t.found_edges} of ${t.visible_edges} edges, ${t.deep_edges} in 3D` },
    poseStep('hypothesis', t.hypothesis, REACH.hypothesis),
    poseStep('line set', t.set, REACH.set),
    poseStep('refined', t.candidate, REACH.candidate),
    { name: 'score', passed: Boolean(instance.hit),
      text: t.candidate && t.candidate.error_d < REACH.candidate ? fixed(t.candidate.score, 3) : '–' },
  ];
  const lost = { 'no lines': 0, 'no hypothesis': 1, 'ranked out': 2, 'wrong pose': 3, 'rejected': 4 }[instance.cause];
  return el('ol', { class: 'ladder' }, steps.map((s, i) => el('li', { class: (s.passed ? 'passed' : 'failed') + (i === lost ? ' lost' : '') },
    el('b', {}, s.name), el('span', {}, s.text))));
}

// Terms of the evidence; `names` from the recognizer.
function evidenceTable(evidence) {
  if (!evidence) return null;
  return el('dl', { class: 'evidence' }, Object.entries(evidence).map(([name, value]) =>
    el('div', {}, el('dt', {}, name.replace('_', ' ')), el('dd', {}, Number.isInteger(value) ? String(value) : fixed(value, Math.abs(value) < 10 ? 2 : 1)))));
}

const badge = (cause) => el('span', { class: 'badge', style: `--hue:${hueOf(cause)}` }, cause);

function missDetails(item) {
  const i = item.what;
  return [
    el('p', { class: 'why' }, CAUSES[i.cause] || ''),
    ladder(i),
    i.candidate ? el('details', {}, el('summary', {}, 'Evidence of the nearest candidate'), evidenceTable(i.candidate.evidence)) : null,
    el('p', { class: 'quiet' }, isNumber(i.mssd_mm) ? `nearest report of this object: ${fixed(i.mssd_mm, 0)} mm off (MSSD)` : 'no report of this object in the frame'),
  ];
}

// --- false alarms ---

function nearestTruth(item) {
  const d = item.what, instances = item.frame.instances;
  const lines = [];
  if (d.nearest === null) lines.push(`no ${nameOf(d.object)} in this frame`);
  else {
    const error = d.nearest_error_d >= 9 ? '9 diameters off or more' : `${fixed(d.nearest_error_d, 2)} diameters off`;
    lines.push(`nearest true ${nameOf(d.object)}: ${error}, ${percent(instances[d.nearest].visible)} visible`);
  }
  if (d.covered !== null) lines.push(`covers a true one at ${fixed(d.range_ratio, 2)} times its distance`);
  if (d.other !== null) lines.push(`lies on the ${nameOf(instances[d.other].object)}`);
  return el('ul', { class: 'facts' }, lines.map((line) => el('li', {}, line)));
}

function alarmDetails(item) {
  return [
    el('p', { class: 'why' }, item.cause === 'wrong pose' ? ALARM_WRONG_POSE : CAUSES[item.cause] || ''),
    nearestTruth(item),
    evidenceTable(item.what.evidence),
  ];
}

// --- both ---

const placeOf = (item) => `${item.frame.scene}/${item.frame.image}`;

const titleOf = (item) => `${nameOf(item.what.object)} · ${whereOf(item)}`;

function whereOf(item) {
  const what = item.what, range = what.pose ? ` · ${fixed(what.pose.range_m, 2)} m` : '';
  const share = item.kind === 'miss' ? `${percent(what.visible)} visible` : `score ${fixed(what.score, 2)}`;
  return `${placeOf(item)} · ${share}${range}`;
}

const detailsOf = (item) => (item.kind === 'miss' ? missDetails(item) : item.kind === 'alarm' ? alarmDetails(item) : frameDetails(item));

function card(item) {
  const box = item.what.pose ? item.what.pose.box : null;
  const shown = item.kind === 'miss' ? ['truth', 'found', 'candidate'] : ['found', 'truth'];
  return el('article', { class: `card ${item.kind}`, id: item.id, tabindex: '0', on: {
    keydown: (event) => { if (event.key === 'Enter' && event.target.id === item.id) openViewer(item); } } },
    el('button', { type: 'button', class: 'crop', title: 'Enlarge', tabindex: '-1', on: { click: () => openViewer(item) } },
      picture(item.frame, windowAround(item.frame, box), { focus: item.kind === 'miss' ? item.what : null, shown, caption: titleOf(item) })),
    el('div', { class: 'text' },
      el('h3', {}, nameOf(item.what.object), ' ', badge(item.cause)),
      el('p', { class: 'where' }, whereOf(item)),
      detailsOf(item)));
}

// What a whole frame's side panel says.
function frameDetails(item) {
  const { frame } = item;
  const row = (pose, text, cause) => el('li', { class: cause }, text);
  return [
    el('ul', { class: 'facts' },
      frame.instances.map((i) => row(i, `${nameOf(i.object)}, ${percent(i.visible)} visible: ` +
        (!i.counts ? 'does not count' : i.hit ? `found, score ${fixed(i.score, 2)}, ${fixed(i.translation_mm, 1)} mm, ${fixed(i.rotation_deg, 2)} deg` : `missed (${i.cause})`),
        instanceKind(i))),
      frame.detections.filter((d) => d.verdict === 'false').map((d) => row(d, `${nameOf(d.object)} reported with ${fixed(d.score, 2)}: false (${d.cause})`, 'false'))),
    el('p', { class: 'quiet' }, `${frame.segments.length / 4} segments, ${frame.lines.length / 6} of them with depth`),
  ];
}
