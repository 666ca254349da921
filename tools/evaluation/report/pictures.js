// A frame's picture as SVG: the camera's image and layers of lines and wireframes that can be switched and enlarged.

// The image as a blob: every picture of a frame shares it. Made when it is first seen.
const imageUrl = (() => {
  const urls = new Map();
  return (frame, eye) => {
    const uri = frame.pictures[eye];
    if (!urls.has(uri)) {
      const [head, body] = uri.split(',');
      const bytes = Uint8Array.from(atob(body), (c) => c.charCodeAt(0));
      urls.set(uri, URL.createObjectURL(new Blob([bytes], { type: head.slice(5, head.indexOf(';')) })));
    }
    return urls.get(uri);
  };
})();

// Segments of one eye: x0, y0, x1, y1 each.
function segmentPath(list) {
  let d = '';
  for (let i = 0; i + 3 < list.length; i += 4) d += `M${list[i]} ${list[i + 1]}L${list[i + 2]} ${list[i + 3]}`;
  return d;
}

// Lines in space: x0, y0, disparity0, x1, y1, disparity1 each; the right eye sees them shifted by their disparity.
function linePath(list, eye) {
  const right = eye === 'right' ? 1 : 0;
  let d = '';
  for (let i = 0; i + 5 < list.length; i += 6) {
    d += `M${(list[i] - right * list[i + 2]).toFixed(1)} ${list[i + 1]}L${(list[i + 3] - right * list[i + 5]).toFixed(1)} ${list[i + 4]}`;
  }
  return d;
}

const meanDisparity = (list) => {
  let sum = 0;
  for (let i = 2; i < list.length; i += 3) sum += list[i];
  return list.length ? sum / (list.length / 3) : 0;
};

const disparities = (frame) => frame.lines.filter((_, i) => i % 3 === 2).map((d) => Math.max(d, 1e-3));

// Depths, m, at the two ends of the colour scale; the few lines beyond take the end's colour.
function depthRange(frame) {
  const all = disparities(frame);
  return { near: frame.f_baseline / quantile(all, 0.95), far: frame.f_baseline / quantile(all, 0.05) };
}

// 3D lines by depth, near red to far blue on a scale that is even in disparity; one path a colour.
function depthLines(frame, eye) {
  const all = disparities(frame), near = quantile(all, 0.95), far = quantile(all, 0.05), byColour = new Map();
  for (let k = 0; 6 * k < frame.lines.length; ++k) {
    const mean = (all[2 * k] + all[2 * k + 1]) / 2;
    const share = Math.min(1, Math.max(0, (near - mean) / Math.max(near - far, 1e-9)));
    const hue = Math.round(share * 12) * 20;
    byColour.set(hue, (byColour.get(hue) || '') + linePath(frame.lines.slice(6 * k, 6 * k + 6), eye));
  }
  return [...byColour].map(([hue, d]) => svg('path', { d, stroke: `hsl(${hue} 95% 60%)` }));
}

function wireframe(pose, kind, eye, label) {
  const group = svg('g', { class: 'wire ' + kind },
    svg('path', { class: 'hidden', d: linePath(pose.hidden, eye) }), svg('path', { d: linePath(pose.seen, eye) }));
  if (label && pose.box) {
    const shift = eye === 'right' ? meanDisparity(pose.seen) : 0;
    group.append(svg('text', { x: pose.box[0] - shift, y: Math.max(12, pose.box[1] - 5) }, label));
  }
  return group;
}

const LAYERS = [
  { id: 'segments', name: '2D segments', on: false },
  { id: 'lines', name: '3D lines', on: false },
  { id: 'found', name: 'Found', on: true },
  { id: 'truth', name: 'Truth', on: true },
  { id: 'candidate', name: 'Nearest candidate', on: true },
  { id: 'labels', name: 'Labels', on: true },
];

const instanceKind = (i) => (!i.counts ? 'ignored' : i.hit ? 'met' : 'missed');

// The layers of a frame as one eye sees it. `focus`: an instance whose nearest candidate is shown.
function layersOf(frame, eye, focus) {
  const layer = (id, ...children) => svg('g', { class: 'layer ' + id }, ...children);
  const truth = (i) => wireframe(i.pose, instanceKind(i), eye, i.counts && !i.hit ? nameOf(i.object) + ' missed' : '');
  const found = (d) => wireframe(d.pose, d.verdict === 'false' ? 'false' : 'hit', eye, `${nameOf(d.object)} ${fixed(d.score, 2)}`);
  return [
    layer('segments', svg('path', { d: segmentPath(eye === 'left' ? frame.segments : []) })),
    layer('lines', ...depthLines(frame, eye)),
    layer('truth', ...frame.instances.filter((i) => i.pose).map(truth)),
    layer('candidate', focus && focus.candidate ? wireframe(focus.candidate, 'nearest', eye, '') : null),
    layer('found', ...frame.detections.map(found)),
  ];
}

const wholeFrame = (frame) => [0, 0, frame.width, frame.height];

// A window of 4:3 around a box, with room to see the surroundings.
function windowAround(frame, box) {
  if (!box) return wholeFrame(frame);
  const middle = [(box[0] + box[2]) / 2, (box[1] + box[3]) / 2];
  const width = Math.min(frame.width, Math.max(120, 1.5 * Math.max(box[2] - box[0], (box[3] - box[1]) * 4 / 3)));
  const height = width * 3 / 4;
  const clamp = (v, size, whole) => (size >= whole ? (whole - size) / 2 : Math.min(Math.max(v, 0), whole - size));
  return [clamp(middle[0] - width / 2, width, frame.width), clamp(middle[1] - height / 2, height, frame.height), width, height];
}

// Drawn when it comes near the screen: hundreds of frames open at once.
const drawWhenSeen = (() => {
  const waiting = new Map();
  const observer = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      if (!entry.isIntersecting) continue;
      observer.unobserve(entry.target);
      waiting.get(entry.target)();
      waiting.delete(entry.target);
    }
  }, { rootMargin: '600px' });
  return (node, draw) => { waiting.set(node, draw); observer.observe(node); };
})();

// `window`: x, y, width, height in pixels of the image. `shown`: ids of layers, null: as switched in the viewer.
function picture(frame, window, { focus = null, shown = null, caption = '', eye = 'left' } = {}) {
  const root = svg('svg', { viewBox: window.join(' '), class: 'picture', preserveAspectRatio: 'xMidYMid meet', role: 'img', 'aria-label': caption });
  if (shown) for (const layer of LAYERS) root.classList.toggle('no-' + layer.id, !shown.includes(layer.id));
  root.style.setProperty('--px', window[2] / 320);
  drawWhenSeen(root, () => root.append(
    svg('image', { href: imageUrl(frame, eye), x: 0, y: 0, width: frame.width, height: frame.height }), ...layersOf(frame, eye, focus)));
  return root;
}

// Keeps labels at one size on the screen, however far the picture is enlarged.
function fitText(root) {
  const [, , width, height] = root.getAttribute('viewBox').split(' ').map(Number);
  root.style.setProperty('--px', Math.max(width / (root.clientWidth || 900), height / (root.clientHeight || 700)));
}

// Wheel zooms about the pointer, dragging moves, a double click shows all.
function makeZoomable(root, frame) {
  const view = () => root.getAttribute('viewBox').split(' ').map(Number);
  const show = (box) => { root.setAttribute('viewBox', box.join(' ')); fitText(root); };
  const at = (event) => {
    const p = new DOMPoint(event.clientX, event.clientY).matrixTransform(root.getScreenCTM().inverse());
    return [p.x, p.y];
  };
  root.addEventListener('wheel', (event) => {
    event.preventDefault();
    const [x, y, w, h] = view(), [px, py] = at(event);
    const s = Math.min(frame.width * 1.2, Math.max(24, w * 1.0015 ** event.deltaY)) / w;
    show([px - (px - x) * s, py - (py - y) * s, w * s, h * s]);
  }, { passive: false });
  let grip = null;
  root.addEventListener('pointerdown', (event) => { grip = at(event); root.setPointerCapture(event.pointerId); });
  root.addEventListener('pointermove', (event) => {
    if (!grip) return;
    const [x, y, w, h] = view(), [px, py] = at(event);
    show([x + grip[0] - px, y + grip[1] - py, w, h]);
  });
  root.addEventListener('pointerup', () => { grip = null; });
  root.addEventListener('dblclick', () => show(wholeFrame(frame)));
}
